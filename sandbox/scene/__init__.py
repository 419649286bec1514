"""What a scene says: models, loading, expansion. No engine here."""
