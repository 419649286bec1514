"""Contacts as pymunk finds them in a step, made into points with a gap, a normal and a memory.

pymunk's shapes stand out by a margin, so that a contact is seen before it is one: its gap is then
positive, and the step may close it and no more. What it was in the last step, its impulses and
whether it slid, is found again by the two shapes and pymunk's number of the feature.

Outlines that are not convex are several shapes to pymunk, whose seams are no surface: what it
finds there is left out, by the normal (:mod:`sandbox.scene.outlines.rings`). Of a curve the
pieces are polygons of chords; the contact itself is on the curve
(:mod:`sandbox.engine.narrow_phase`).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.narrow_phase import (
    DROPPED,
    EXACT,
    SAME_PLACE,
    exchange,
    gap_acceleration,
    gap_of,
    on_curves,
    straight_curvature,
)
from sandbox.numeric import Array, Records

ON_CURVE = -1  # the feature of all contacts on a curve
ASKEW = 1e-6
"""By how much a normal may miss those of a surface, an angle: pymunk finds it to 1e-9 or so."""


@kernel
def rows_for(limits: int, motors: int, slips: int, frictions: int, contacts: int) -> int:
    """How many bounded rows there may be of so many elements and points that are near."""
    return limits + motors + 2 * (slips + frictions + contacts)


@kernel
def short(table: int) -> bool:
    """Whether there is no room for all that was found; contacts that are hit take as much again."""
    count = at.near(table)[0]
    rows = rows_for(len(at.limits(table)), len(at.motors(table)), len(at.slips(table)),
                    len(at.dry_friction(table)), count)
    return bool(count > len(at.raw(table)) or 2 * rows + 4 > len(at.rows(table)))


@entry_point("shapes")
def list_contacts_of_step(table: int) -> None:
    """Note the points of bodies that may touch, in an order that does not depend on memory."""
    raw, count, shapes, faces = at.raw(table), at.near(table)[0], at.shapes(table), at.faces(table)
    friction, restitution, body = at.friction(table), at.restitution(table), at.body(table)
    old, order, out, touching = (
        at.touches(table), at.order(table), at.found(table), at.touching(table))
    old_count, n = touching[0], 0
    for i in range(count):
        if friction[shapes[raw[i]["shape_a"]]["body"], shapes[raw[i]["shape_b"]]["body"]] < 0.0:
            continue
        one, two = shapes[raw[i]["shape_a"]], shapes[raw[i]["shape_b"]]
        nx, ny = raw[i]["nx"], raw[i]["ny"]
        if not (_faced(one, faces, body[one["body"], 2], nx, ny)
                and _faced(two, faces, body[two["body"], 2], -nx, -ny)):
            continue
        raw[i]["ax"] -= one["margin"] * nx
        raw[i]["ay"] -= one["margin"] * ny
        raw[i]["bx"] += two["margin"] * nx
        raw[i]["by"] += two["margin"] * ny
        if one["body"] > two["body"]:  # the normal leads to the body with the higher number
            exchange(raw[i])
        j = n
        while j > 0 and _after(raw, order[j - 1], i):
            order[j] = order[j - 1]
            j -= 1
        order[j] = i
        n += 1
    near, n = n, 0
    for k in range(near):
        found = raw[order[k]]
        nx, ny = found["nx"], found["ny"]
        found["ka"], found["da"] = straight_curvature(
            table, shapes[found["shape_a"]], found["ax"], found["ay"], nx, ny)
        found["kb"], found["db"] = straight_curvature(
            table, shapes[found["shape_b"]], found["bx"], found["by"], -nx, -ny)
        if found["da"] == 0.0 and found["db"] == 0.0:  # corners of sides that lie on each other
            found["ka"], found["da"] = 0.0, 1.0
        state = on_curves(table, order[k])
        if state == DROPPED:
            continue
        _contact(found, state, shapes, body, friction, restitution, out[n])
        if state == EXACT and _repeated(out, n):
            continue
        out[n]["acceleration"] = gap_acceleration(table, out[n])
        out[n]["static"] = at.static(table)[out[n]["a"], out[n]["b"]]
        n += 1
    guess = 0
    for k in range(n):
        w = _last(old, old_count, guess, out[k])
        if w >= 0:
            last, now = old[w], out[k]
            now["normal"], now["tangent"] = last["normal"], last["tangent"]
            now["mode"], now["listed"] = last["mode"], last["listed"]
            now["phase"], now["sums"] = last["phase"], last["sums"]
            now["stretch"] = last["stretch"]
            guess = w + 1
    belts = at.belts(table)
    for k in range(n):
        out[k]["belt"] = -(belts[out[k]["a"]] + belts[out[k]["b"]])
        old[k] = out[k]
    touching[0] = n


@kernel
def _faced(shape: Any, faces: Records, angle: float, nx: float, ny: float) -> bool:
    """Whether a shape is the surface of its outline where its outer normal is (nx, ny)."""
    if shape["first"] < 0:
        return True
    c, s = math.cos(angle), math.sin(angle)
    x, y = c * nx + s * ny, c * ny - s * nx
    for k in range(shape["first"], shape["last"]):
        x0, y0, x1, y1 = faces[k]["x0"], faces[k]["y0"], faces[k]["x1"], faces[k]["y1"]
        if (x0 * y - y0 * x >= -ASKEW and x * y1 - y * x1 >= -ASKEW
                and x * (x0 + x1) + y * (y0 + y1) > 0.0):
            return True
    return False


@kernel
def _last(old: Records, count: int, guess: int, now: Any) -> int:
    """Which contact of the last step this one was, or -1; on a curve the nearest of the shapes."""
    best, found = math.inf, -1
    for z in range(count):
        w = (guess + z) % count
        last = old[w]
        if (last["shape_a"] == now["shape_a"] and last["shape_b"] == now["shape_b"]
                and last["feature"] == now["feature"]):
            if now["feature"] != ON_CURVE:
                return w
            away = abs(last["ax"] - now["ax"]) + abs(last["ay"] - now["ay"])
            if away < best:
                best, found = away, w
    return found


@kernel
def _repeated(touches: Records, n: int) -> bool:
    """Whether the same contact on a curve was found before: of another piece of it."""
    now = touches[n]
    for k in range(n):
        other = touches[k]
        if (other["shape_a"] == now["shape_a"] and other["shape_b"] == now["shape_b"]
                and other["feature"] == ON_CURVE
                and abs(other["ax"] - now["ax"]) + abs(other["ay"] - now["ay"]) < SAME_PLACE):
            return True
    return False


@kernel
def _after(raw: Records, i: int, j: int) -> bool:
    """Whether contact i comes after contact j: by the lower shape, the higher one, the feature."""
    one, other = raw[i], raw[j]
    low, low_other = min(one["shape_a"], one["shape_b"]), min(other["shape_a"], other["shape_b"])
    high = max(one["shape_a"], one["shape_b"])
    high_other = max(other["shape_a"], other["shape_b"])
    if low != low_other:
        return bool(low > low_other)
    if high != high_other:
        return bool(high > high_other)
    return bool(one["feature"] > other["feature"])


@kernel
def _contact(
    found: Any, state: int, shapes: Records, body: Array, friction: Array, restitution: Array,
    out: Any,
) -> None:
    """A TOUCH with nothing known of the last step; its force acts in the middle of the gap."""
    sa, sb = found["shape_a"], found["shape_b"]
    a, b = shapes[sa]["body"], shapes[sb]["body"]
    gap = gap_of(body, found, a, b)
    out["shape_a"], out["shape_b"], out["feature"] = sa, sb, found["feature"]
    if state == EXACT:
        out["shape_a"], out["shape_b"] = shapes[sa]["leader"], shapes[sb]["leader"]
        out["feature"] = ON_CURVE
    out["a"], out["b"], out["gap"] = a, b, gap
    out["ka"], out["da"], out["kb"], out["db"] = (
        found["ka"], found["da"], found["kb"], found["db"])
    out["nx"], out["ny"] = found["nx"], found["ny"]
    out["ax"] = (found["ax"] + body[b, 0] + found["bx"] - body[a, 0]) / 2
    out["ay"] = (found["ay"] + body[b, 1] + found["by"] - body[a, 1]) / 2
    out["bx"] = (found["bx"] + body[a, 0] + found["ax"] - body[b, 0]) / 2
    out["by"] = (found["by"] + body[a, 1] + found["ay"] - body[b, 1]) / 2
    out["friction"], out["restitution"] = friction[a, b], restitution[a, b]
    out["normal"] = out["tangent"] = out["bounce"] = out["drag"] = out["led"] = 0.0
    out["mode"] = out["listed"] = out["late"] = out["phase"] = 0
    out["sums"] = -1
    out["stretch"] = out["want"] = out["soft"] = out["want_along"] = out["soft_along"] = 0.0
