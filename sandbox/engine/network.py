"""Lengths of cords over guides, and how they change with the bodies.

A guide is a circle of radius 0 or more. Walking along direction u with left
normal n, a circle whose centre lies right of the path has sign s = +1, left
s = -1; the cord touches it at p = c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2
for a stretch between two circles. Every stretch pulls its two bodies at these
points, which also gives a wound-on end its torque s r T.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine.kernel import either, kernel
from sandbox.kinds.elements import GRAZE
from sandbox.numeric import Array, Records


@either
def _near(angle: float, last: float) -> float:
    """``angle`` plus the whole turns that bring it closest to ``last``."""
    return angle + 2 * math.pi * math.floor((last - angle) / (2 * math.pi) + 0.5)


@kernel
def measure(
    cord: Any, guides: Records, memory: Records, results: Records, pose: Array, start: bool,
) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3] (centres of mass); fills its rows of J.

    ``guides``, ``memory`` and ``results`` are GUIDE, GUIDE_STATE and GUIDE_RESULT of all
    guides; ``start`` fixes how often the cord goes round its wheels. Tables are made with that from
    Python: no kernel may be called then, or it would be compiled in every process.
    """
    length = 0.0
    first, last = cord["first"], cord["last"]
    for i in range(first, last):
        results[i]["jx"] = results[i]["jy"] = results[i]["jt"] = 0.0
    angle_in = angle_out = 0.0
    for i in range(first, last - 1):
        a, b, on_a, on_b = guides[i], guides[i + 1], results[i], results[i + 1]
        qa, qb = pose[a["body"]], pose[b["body"]]
        ca, sa, cb, sb = math.cos(qa[2]), math.sin(qa[2]), math.cos(qb[2]), math.sin(qb[2])
        ax, ay = ca * a["x"] - sa * a["y"], sa * a["x"] + ca * a["y"]
        bx, by = cb * b["x"] - sb * b["y"], sb * b["x"] + cb * b["y"]
        dx, dy = qb[0] + bx - qa[0] - ax, qb[1] + by - qa[1] - ay
        ra, rb = a["radius"], b["radius"]
        offset = ra - rb
        distance = math.hypot(dx, dy)
        straight = math.sqrt(max(distance * distance - offset * offset, 1e-24))
        square = straight * straight + offset * offset
        ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
        nx, ny = -uy, ux
        length += straight
        on_a["jx"] -= ux
        on_a["jy"] -= uy
        on_a["jt"] -= (ax + ra * nx) * uy - (ay + ra * ny) * ux
        on_b["jx"] += ux
        on_b["jy"] += uy
        on_b["jt"] += (bx + rb * nx) * uy - (by + rb * ny) * ux
        angle = math.atan2(ny, nx)
        if i == first:
            angle_out = angle
            if ra != 0.0 and not cord["closed"]:
                length -= ra * _unwound(angle - qa[2], memory[i], start)
        elif ra != 0.0:
            length += abs(ra) * _wrapped(a, angle_in - angle, memory[i], start)
        if rb != 0.0 and i == last - 2:
            length += (abs(rb) * _wrapped(b, angle - angle_out, memory[i + 1], start)
                       if cord["closed"] else rb * _unwound(angle - qb[2], memory[i + 1], start))
        angle_in = angle
    return length


@either
def _wrapped(guide: Any, turn: float, memory: Any, start: bool) -> float:
    """The angle by which a cord lies on a wheel [rad] over which its direction turns by so much."""
    wrap = turn if guide["radius"] > 0 else -turn
    # a cord that just touches its wheel must not go once round it by rounding
    wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE + 2 * math.pi * guide["turns"] if start
            else _near(wrap, memory["wrap"]))
    memory["wrap"] = wrap
    return wrap


@either
def _unwound(angle: float, memory: Any, start: bool) -> float:
    """How far the point where a wound cord leaves its wheel has gone since t = 0 [rad]."""
    psi = angle if start else _near(angle, memory["wrap"])
    memory["wrap"] = psi
    if start:
        memory["wrap0"] = psi
    return float(psi - memory["wrap0"])


@kernel
def wound_up(cord: Any, guides: Records, memory: Records) -> float:
    """How much of a cord the wheels at its ends have wound up since t = 0 [m], as last measured."""
    first, last = cord["first"], cord["last"] - 1
    return float(guides[last]["radius"] * (memory[last]["wrap"] - memory[last]["wrap0"])
                 - guides[first]["radius"] * (memory[first]["wrap"] - memory[first]["wrap0"]))
