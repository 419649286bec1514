"""The engine held against equations, closed forms and independent solutions, as a report."""
