"""Searches over runs of a scene: thresholds, fits, the best, what matters, maps of what holds.

They are described in docs/searches.md and docs/robustness.md.
"""

from sandbox.search.searches import best, fit, robustness, sensitivity, threshold

__all__ = ["best", "fit", "robustness", "sensitivity", "threshold"]
