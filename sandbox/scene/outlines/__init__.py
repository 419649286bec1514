"""Outlines: what is wrong with one, its convex pieces, which way it faces, where it comes from."""
