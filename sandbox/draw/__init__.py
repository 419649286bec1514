"""Plots of a recording with matplotlib."""
