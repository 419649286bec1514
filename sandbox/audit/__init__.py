"""A recording checked against the laws of mechanics, from its numbers alone."""
