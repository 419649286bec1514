"""Mechanisms from plain elements: see :mod:`sandbox.study.plain_mechanisms`."""

from sandbox.study.plain_mechanisms import BODIES, HINGES, G, cord, finger, fixed, mass, mechanism

__all__ = ["BODIES", "HINGES", "G", "cord", "finger", "fixed", "mass", "mechanism"]
