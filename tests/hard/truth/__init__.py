"""Closed forms and integrations in the fewest coordinates: numpy, scipy, a benchmark's numbers.

Nothing here of what computes in sandbox.
"""
