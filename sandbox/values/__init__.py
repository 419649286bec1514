"""What stands in a field: numbers with units, signals over time, expressions."""
