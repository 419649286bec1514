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


def four_bar() -> dict[str, Any]:
    """Crank 60, coupler 140, rocker 100, ground 160 mm under gravity, links with weight."""
    a, b, c, d = 0.06, 0.14, 0.10, 0.16
    crank = math.radians(40)
    p = (a * math.cos(crank), a * math.sin(crank))
    q = meeting(p, b, (d, 0.0), c)
    links = (("crank", (0.0, 0.0), p, 0.05), ("coupler", p, q, 0.12), ("rocker", (d, 0.0), q, 0.08))
    bodies = [{"name": name, "at": list(one), "mass": mass,
               "angle": math.atan2(two[1] - one[1], two[0] - one[0]),
               "shapes": [{"type": "capsule", "end": [math.dist(one, two), 0], "radius": 0.004}]}
              for name, one, two, mass in links]
    joints = [{"type": "pin", "name": name, "a": one, "b": two, "on_b": [far, 0]}
              for name, one, two, far in (("o", "wall", "crank", 0), ("p", "crank", "coupler", 0),
                                          ("q", "coupler", "rocker", c), ("e", "wall", "rocker", 0))
              ]
    return {"format": 1, "run": RUN, "gravity": [0, -G], "bodies": [WALL, *bodies],
            "joints": joints, "contacts": [{"between": ["*", "*"], "collide": False}]}


def meeting(
    one: tuple[float, float], r: float, two: tuple[float, float], s: float, side: float = 1.0,
) -> tuple[float, float]:
    """Where circles about two points cross, to the left of the way from one to the other."""
    d = math.dist(one, two)
    along = (r * r - s * s + d * d) / (2 * d)
    up = side * math.sqrt(r * r - along * along)
    x, y = (two[0] - one[0]) / d, (two[1] - one[1]) / d
    return one[0] + along * x - up * y, one[1] + along * y + up * x


def four_bar_height(crank: float) -> float:
    """Weight times height of the linkage of :func:`four_bar`, over g [kg m]."""
    a, b, c, d = 0.06, 0.14, 0.10, 0.16
    p = (a * math.cos(crank), a * math.sin(crank))
    q = meeting(p, b, (d, 0.0), c, SIDE)
    return 0.05 * p[1] / 2 + 0.12 * (p[1] + q[1]) / 2 + 0.08 * q[1] / 2


SIDE = 1.0
"""On which side of the way from the crank's end to the ground the coupler meets the rocker."""


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
