"""Closed forms and integrations in the fewest coordinates: numpy and scipy, nothing of sandbox."""
