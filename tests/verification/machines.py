"""Mechanisms from plain elements: see :mod:`sandbox.study.machines`."""

from sandbox.study.machines import BODIES, HINGES, G, cord, finger, fixed, mass, mechanism

__all__ = ["BODIES", "HINGES", "G", "cord", "finger", "fixed", "mass", "mechanism"]
