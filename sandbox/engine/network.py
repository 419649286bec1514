"""Lengths of cords over guides, and how they change with the bodies.

A guide is a circle of radius 0 or more. Walking along direction u with left
normal n, a circle whose centre lies right of the path has sign s = +1, left
s = -1; the cord touches it at p = c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2
for a stretch between two circles. Every stretch pulls its two bodies at these
points, which also gives a wound-on end its torque s r T. A wheel that would have to hold
the cord back, for it lies on it by less than no angle, is left out: there the cord is off it.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.elements.element import GRAZE
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Records

ASIDE = -math.pi / 2
"""Where the angle of a cord that begins off its wheel is counted from [rad]: it is above - pi."""


@kernel
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
    length = _along(cord, guides, memory, results, pose, start)
    if cord["lifts"] and not start:
        for _ in range(2 * (cord["last"] - cord["first"])):
            if not _lay(cord, guides, memory, pose):
                break
            length = _along(cord, guides, memory, results, pose, start)
    return length


@kernel
def _along(
    cord: Any, guides: Records, memory: Records, results: Records, pose: Array, start: bool,
) -> float:
    """The length over the guides that the cord lies on, as :func:`measure` has it."""
    length = 0.0
    first, last = cord["first"], cord["last"]
    for i in range(first, last):
        results[i]["jx"] = results[i]["jy"] = results[i]["jt"] = 0.0
    angle_in = angle_out = 0.0
    i = first
    while i < last - 1:
        j = i + 1
        while memory[j]["lifted"]:  # the last one never is
            j += 1
        a, b, on_a, on_b = guides[i], guides[j], results[i], results[j]
        ra, rb = a["radius"], b["radius"]
        straight, ux, uy, ax, ay, bx, by = _stretch(a, b, pose)
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
                length -= ra * _unwound(angle - pose[a["body"], 2], memory[i], start)
        elif ra != 0.0:
            length += abs(ra) * _wrapped(a, angle_in - angle, memory[i], start)
        if rb != 0.0 and j == last - 1:
            length += (abs(rb) * _wrapped(b, angle - angle_out, memory[j], start)
                       if cord["closed"]
                       else rb * _unwound(angle - pose[b["body"], 2], memory[j], start))
        angle_in = angle
        i = j
    return length


@kernel
def _stretch(
    a: Any, b: Any, pose: Array,
) -> tuple[float, float, float, float, float, float, float]:
    """Length of the cord between two guides [m], its direction; the guides from their centres."""
    qa, qb = pose[a["body"]], pose[b["body"]]
    ca, sa, cb, sb = math.cos(qa[2]), math.sin(qa[2]), math.cos(qb[2]), math.sin(qb[2])
    ax, ay = ca * a["x"] - sa * a["y"], sa * a["x"] + ca * a["y"]
    bx, by = cb * b["x"] - sb * b["y"], sb * b["x"] + cb * b["y"]
    dx, dy = qb[0] + bx - qa[0] - ax, qb[1] + by - qa[1] - ay
    offset = a["radius"] - b["radius"]
    distance = math.hypot(dx, dy)
    straight = math.sqrt(max(distance * distance - offset * offset, 1e-24))
    square = straight * straight + offset * offset
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    return straight, ux, uy, ax, ay, bx, by


@kernel
def _lay(cord: Any, guides: Records, memory: Records, pose: Array) -> bool:
    """Take the cord off the wheel that it would have to push from, or lay it on one; whether so.

    The angle by which it lies on a wheel goes on below 0 where it is off, as if it were on: it is
    back on where that is above 0 again. One that comes round an end of the cord to its other side
    is a whole turn away from that. Of several the one that is furthest from right is changed.
    """
    worst, which, before = 0.0, -1, cord["first"]
    for i in range(cord["first"] + 1, cord["last"] - 1):
        if not guides[i]["lifts"]:
            before = i
            continue
        if not memory[i]["lifted"]:
            before = i
            wrong = -memory[i]["wrap"] - GRAZE
        else:
            after = i + 1
            while memory[after]["lifted"]:
                after += 1
            on, off = _stretch(guides[before], guides[i], pose), _stretch(
                guides[i], guides[after], pose)
            turn = math.atan2(on[1], -on[2]) - math.atan2(off[1], -off[2])
            wrong = _wrapped(guides[i], turn, memory[i], False)
        if wrong > worst:
            worst, which = wrong, i
    if which >= 0:
        memory[which]["lifted"] = 1 - memory[which]["lifted"]
    return which >= 0


@kernel
def _wrapped(guide: Any, turn: float, memory: Any, start: bool) -> float:
    """The angle by which a cord lies on a wheel [rad] over which its direction turns by so much."""
    wrap = turn if guide["radius"] > 0 else -turn
    # a cord that just touches its wheel must not go once round it by rounding
    wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE + 2 * math.pi * guide["turns"] if start
            else _near(wrap, memory["wrap"]))
    memory["wrap"] = wrap
    return wrap


@kernel
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
