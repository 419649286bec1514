"""Teeth of gears and racks: how far apart the flanks of two wheels are, and where they push.

An involute flank is met along the common tangent of the base circles, of radius r cos(pressure
angle), which a cord would run along that is wound off one and on the other: crossed where the
wheels lie side by side, open where one runs inside the other. So the way along the line of action
is such a cord's length (:mod:`sandbox.engine.network`), for any distance of the centres, and teeth
push where it would pull. Either of the two tangents is the line of action of one flank. Of a rack
the line of action turns with the rack.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine.kernel import kernel
from sandbox.engine.records import GEAR, RACK
from sandbox.numeric import Array


@kernel
def _ahead(h: float, body: Array, velocity: Array, b: int) -> Any:
    """Pose x, y, angle of a body where ``velocity`` leads in ``h``; cosine, sine of the angle."""
    angle = body[b, 2] + h * velocity[b, 2]
    return (body[b, 0] + h * velocity[b, 0], body[b, 1] + h * velocity[b, 1], angle,
            math.cos(angle), math.sin(angle))


@kernel
def toothed(joint: Any) -> bool:
    """Whether a JOINT keeps teeth together."""
    return bool(joint["keeps"] == GEAR or joint["keeps"] == RACK)


@kernel
def flank(joint: Any, side: float, h: float, body: Array, velocity: Array) -> Any:
    """A flank of a JOINT where ``velocity`` [nb, 3] leads from the poses of the step in ``h``.

    Returns:
        gap [m] of the teeth on this ``side`` (+1 or -1), were there no play; of the row that keeps
        it: direction x, y of the push on b, moments of the push on a and on b for 1 N [m].
    """
    xa, ya, angle_a, ca, sa = _ahead(h, body, velocity, joint["a"])
    xb, yb, angle_b, cb, sb = _ahead(h, body, velocity, joint["b"])
    ax, ay = ca * joint["ax"] - sa * joint["ay"], sa * joint["ax"] + ca * joint["ay"]
    bx, by = cb * joint["bx"] - sb * joint["by"], sb * joint["bx"] + cb * joint["by"]
    dx, dy = xb + bx - xa - ax, yb + by - ya - ay
    start = joint["start"] if side > 0.0 else joint["start_back"]
    if joint["keeps"] == RACK:
        gx, gy = cb * joint["gx"] - sb * joint["gy"], sb * joint["gx"] + cb * joint["gy"]
        along, across = side * joint["tilt_c"], joint["tilt_s"]
        ux, uy = along * gx + across * gy, along * gy - across * gx
        r = -side * joint["ra"]
        gap = ux * dx + uy * dy + r * (angle_a - angle_b) - start
        px, py = ax - r * uy, ay + r * ux
        qx, qy = px + xa - xb, py + ya - yb
        return gap, ux, uy, py * ux - px * uy, qx * uy - qy * ux
    ra, rb, push = side * joint["ra"], side * joint["rb"], joint["push"]
    offset = ra - rb
    straight = math.sqrt(max(dx * dx + dy * dy - offset * offset, 1e-24))
    square = straight * straight + offset * offset
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    angle = math.atan2(uy, ux)
    gap = straight - ra * (angle - angle_a) + rb * (angle - angle_b) - start
    turn = 2.0 * math.pi * offset
    gap -= turn * math.floor(gap / turn + 0.5)
    px, py, qx, qy = ax - ra * uy, ay + ra * ux, bx - rb * uy, by + rb * ux
    return (push * gap, push * ux, push * uy, push * (py * ux - px * uy),
            push * (qx * uy - qy * ux))


@kernel
def rolled(joint: Any, h: float, body: Array, velocity: Array) -> float:
    """How far two circles are from where they roll to, along them [m]; as :func:`flank`."""
    xa, ya, angle_a, ca, sa = _ahead(h, body, velocity, joint["a"])
    xb, yb, angle_b, cb, sb = _ahead(h, body, velocity, joint["b"])
    dx = xb + cb * joint["bx"] - sb * joint["by"] - xa - ca * joint["ax"] + sa * joint["ay"]
    dy = yb + sb * joint["bx"] + cb * joint["by"] - ya - sa * joint["ax"] - ca * joint["ay"]
    ra, rb = joint["ra"], joint["rb"]
    way = ra * angle_a + rb * angle_b - (ra + rb) * math.atan2(dy, dx) - joint["start"]
    turn = 2.0 * math.pi * (ra + rb)
    return float(way - turn * math.floor(way / turn + 0.5))
