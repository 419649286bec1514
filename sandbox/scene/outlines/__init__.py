"""Outlines: their faults, convex pieces and normals; curves, cams and drawings."""
