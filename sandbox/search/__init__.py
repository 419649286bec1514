"""Searches over runs of a scene: thresholds, fits, the best, what matters (docs/searches.md)."""

from sandbox.search.searches import best, fit, sensitivity, threshold

__all__ = ["best", "fit", "sensitivity", "threshold"]
