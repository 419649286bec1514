"""Values of fields: numbers with units, signals over time, expressions."""
