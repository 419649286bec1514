"""How long cylinders are at t = 0, and how much fluid a line holds then."""

from __future__ import annotations

import math
from collections.abc import Mapping

from sandbox.elements.fluids import Cylinder, Line
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import pose_of, to_world


def volume_of(line: Line, bodies: Mapping[str, Body]) -> float:
    """Of a line [m^3]; 0 where neither it nor its cylinders tell."""
    if line.volume is not None:
        return line.volume
    return math.fsum(chamber.area * length_of(chamber, bodies) for chamber in line.chambers
                     if isinstance(chamber, Cylinder) and not chamber.pulls)


def length_of(chamber: Cylinder, bodies: Mapping[str, Body]) -> float:
    """Between the two points of a cylinder [m]."""
    return math.dist(to_world(pose_of(bodies[chamber.a]), chamber.on_a),
                     to_world(pose_of(bodies[chamber.b]), chamber.on_b))
