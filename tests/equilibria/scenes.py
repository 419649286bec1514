"""Small scenes whose equilibria are known in closed form."""

from __future__ import annotations

import math
from typing import Any

G = 9.81
RUN = {"duration": 1.0, "step": 1e-3}
WALL = {"name": "wall", "motion": "fixed"}
MASS, ARM, RADIUS = 0.2, 0.1, 0.01
INERTIA = MASS * ARM**2 + MASS * RADIUS**2 / 2
"""Of the bob about the hinge [kg m^2]."""


def pendulum(stiffness: float, *, rest_angle: float = 0.0) -> dict[str, Any]:
    """A bob on a hinge, straight up at 0, held there by a rotary spring."""
    return {
        "format": 1, "run": RUN, "gravity": [0, -G],
        "bodies": [WALL, {"name": "bob", "at": [0, ARM], "mass": MASS,
                          "shapes": [{"type": "circle", "radius": RADIUS}]}],
        "joints": [{"type": "pin", "name": "hinge", "a": "wall", "b": "bob", "on_a": [0, 0],
                    "on_b": [0, -ARM]}],
        "springs": [{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": stiffness,
                     "rest_angle": rest_angle}]}


def hanging(stiffness: float, mass: float, **spring: float) -> dict[str, Any]:
    """A weight on a spring that is 0.2 m long without it."""
    return {
        "format": 1, "run": RUN, "gravity": [0, -G],
        "bodies": [WALL, {"name": "weight", "at": [0, -0.2], "mass": mass,
                          "shapes": [{"type": "circle", "radius": 0.01}]}],
        "springs": [{"type": "linear", "name": "spring", "a": "wall", "b": "weight",
                     "on_a": [0, 0], "on_b": [0, 0], "stiffness": stiffness, **spring}]}


def on_slope(friction: float, slope: float) -> dict[str, Any]:
    """A box on a plane that falls to the right."""
    x, y = math.cos(slope), math.sin(slope)
    return {
        "format": 1, "run": RUN, "gravity": [0, -G], "materials": {"m": {"friction": friction}},
        "bodies": [{"name": "plane", "motion": "fixed", "angle": -slope, "material": "m",
                    "shapes": [{"type": "box", "size": [1, 0.1], "at": [0, -0.05]}]},
                   {"name": "box", "mass": 0.5, "angle": -slope, "material": "m",
                    "at": [0.02 * y, 0.02 * x],
                    "shapes": [{"type": "box", "size": [0.06, 0.04]}]}]}
