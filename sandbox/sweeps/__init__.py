"""Many runs of one scene with values varied."""

CSV, PARQUET, SPEC, FIGURE = "table.csv", "table.parquet", "sweep.json", "sweep.png"
"""Files of a sweep."""
