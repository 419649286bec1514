"""Helpers of all inspections: diagnostics, tolerances, formatted numbers."""

from __future__ import annotations

import math

from sandbox.errors import Problem

NEGLIGIBLE = 1e-5
"""Gaps and overlaps up to this [m] are what a scene written in hundredths of a mm may have."""
STRAIGHT = 1e-9
"""Two points nearer than this are one [m]."""


def error(code: str, path: str, element: str, message: str, advice: str) -> Problem:
    """An error: the scene cannot be simulated."""
    return Problem(code, message, path, element=element, advice=advice)


def look(code: str, path: str, element: str, message: str, advice: str = "") -> Problem:
    """A warning: the scene can be simulated, but probably not as intended."""
    return Problem(code, message, path, element=element, advice=advice, severity="warning")


def mm(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.4g} mm"


def fitting(length: float) -> str:
    """A length [m] in millimetres that is to be written as it stands: to far below a gap."""
    return f"{length * 1e3:.8g} mm"


def deg(angle: float) -> str:
    """An angle [rad] in degrees."""
    return f"{math.degrees(angle):.4g} deg"
