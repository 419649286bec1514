"""Studies: runs compared with one another, and with closed forms and independent solutions."""
