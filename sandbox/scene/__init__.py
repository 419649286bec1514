"""Scene models, loading and expansion to a mechanism."""
