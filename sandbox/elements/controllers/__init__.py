"""Controllers: what reads quantities of the running mechanism and sets its drives."""
