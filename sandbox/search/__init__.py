"""Searches over runs of a scene: thresholds, fits, optimisation, sensitivity (docs/searches.md)."""

from sandbox.search.searches import best, fit, sensitivity, study, threshold

__all__ = ["best", "fit", "sensitivity", "study", "threshold"]
