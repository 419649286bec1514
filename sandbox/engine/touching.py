"""Contacts as pymunk finds them in a step, made into points with a gap, a normal and a memory.

pymunk's shapes stand out by a margin, so that a contact is seen before it is one: its gap is then
positive, and the step may close it and no more. What it was in the last step, its impulses and
whether it slid, is found again by the two shapes and pymunk's number of the feature.

Outlines that are not convex are several shapes to pymunk, whose seams are no surface: what it
finds there is left out, by the normal (:mod:`sandbox.scene.outlines.pieces`).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Records

ASKEW = 1e-6
"""By how much a normal may miss those of a surface, an angle: pymunk finds it to 1e-9 or so."""


@kernel
def rows_for(limits: int, motors: int, slips: int, rubs: int, contacts: int) -> int:
    """How many bounded rows there may be of so many elements and points that are near."""
    return limits + motors + 2 * (slips + rubs + contacts)


@kernel
def short(table: int) -> bool:
    """Whether there is no room for all that was found near one another in this step.

    Contacts that are hit work in the second half.
    """
    count = at.near(table)[0]
    rows = rows_for(len(at.limits(table)), len(at.motors(table)), len(at.slips(table)),
                    len(at.rubs(table)), count)
    return bool(count > len(at.raw(table)) or 2 * rows + 4 > len(at.rows(table)))


@entry_point("shapes")
def list_touches(table: int) -> None:
    """Note the points of bodies that may touch, in an order of their own.

    pymunk finds them in one that hangs on addresses in memory.
    """
    raw, count, shapes = at.raw(table), at.near(table)[0], at.shapes(table)
    friction, restitution, body = at.friction(table), at.restitution(table), at.body(table)
    old, order, out, touching = (
        at.touches(table), at.order(table), at.found(table), at.touching(table))
    old_count, n = touching[0], 0
    for i in range(count):
        if friction[shapes[raw[i]["shape_a"]]["body"], shapes[raw[i]["shape_b"]]["body"]] < 0.0:
            continue
        if not _on_surfaces(table, i):
            continue
        j = n
        while j > 0 and _after(raw, shapes, order[j - 1], i):
            order[j] = order[j - 1]
            j -= 1
        order[j] = i
        n += 1
    guess = 0
    for k in range(n):
        _oriented(raw[order[k]], shapes, body, friction, restitution, out[k])
        for z in range(old_count):
            w = (guess + z) % old_count
            if _same(old[w], out[k]):
                for_next(old[w], out[k])
                guess = w + 1
                break
    belts = at.belts(table)
    for k in range(n):
        out[k]["belt"] = -(belts[out[k]["a"]] + belts[out[k]["b"]])
        old[k] = out[k]
    touching[0] = n


@kernel
def _on_surfaces(table: int, i: int) -> bool:
    """Whether what pymunk found is where both shapes are the surfaces of their outlines."""
    shapes, found, body, faces = at.shapes(table), at.raw(table)[i], at.body(table), at.faces(table)
    one, two = shapes[found["shape_a"]], shapes[found["shape_b"]]
    nx, ny = found["nx"], found["ny"]
    return bool(_faced(one, faces, body[one["body"], 2], nx, ny)
                and _faced(two, faces, body[two["body"], 2], -nx, -ny))


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
def for_next(last: Any, now: Any) -> None:
    """What a contact remembers of the last step."""
    now["normal"], now["tangent"] = last["normal"], last["tangent"]
    now["mode"], now["listed"] = last["mode"], last["listed"]


@kernel
def _same(one: Any, other: Any) -> bool:
    return bool(one["shape_a"] == other["shape_a"] and one["shape_b"] == other["shape_b"]
                and one["feature"] == other["feature"])


@kernel
def _after(raw: Records, shapes: Records, i: int, j: int) -> bool:
    """Whether contact i comes after contact j: by shapes, then by the feature."""
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
def _oriented(
    raw: Any, shapes: Records, body: Array, friction: Array, restitution: Array, out: Any,
) -> None:
    """From the body with the lower number to the other, the margins taken off."""
    sa, sb = raw["shape_a"], raw["shape_b"]
    nx, ny = raw["nx"], raw["ny"]
    ax, ay, bx, by = raw["ax"], raw["ay"], raw["bx"], raw["by"]
    a, b = shapes[sa]["body"], shapes[sb]["body"]
    # from centres to places in the world
    ax, ay, bx, by = ax + body[a, 0], ay + body[a, 1], bx + body[b, 0], by + body[b, 1]
    ma, mb = shapes[sa]["margin"], shapes[sb]["margin"]
    gap = (bx - ax) * nx + (by - ay) * ny + ma + mb
    # both surfaces' points, and in the middle of them the one that the force acts in
    mx = (ax - ma * nx + bx + mb * nx) / 2
    my = (ay - ma * ny + by + mb * ny) / 2
    if a > b:
        sa, sb, a, b, nx, ny = sb, sa, b, a, -nx, -ny
    out["shape_a"], out["shape_b"], out["feature"] = sa, sb, raw["feature"]
    out["a"], out["b"], out["nx"], out["ny"], out["gap"] = a, b, nx, ny, gap
    out["ax"], out["ay"] = mx - body[a, 0], my - body[a, 1]
    out["bx"], out["by"] = mx - body[b, 0], my - body[b, 1]
    out["friction"], out["restitution"] = friction[a, b], restitution[a, b]
    out["normal"] = out["tangent"] = out["bounce"] = out["rub"] = 0.0
    out["mode"] = out["listed"] = out["late"] = 0
