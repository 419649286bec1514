"""Equilibria of a mechanism: found without waiting, judged, followed along a parameter."""
