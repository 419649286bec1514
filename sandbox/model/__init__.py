"""The mechanism as arrays, and the catalogue of its quantities."""
