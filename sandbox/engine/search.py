"""The search for shapes that are near, and for those that meet on the path of fast bodies.

Bodies that move farther in a step than the margins of their shapes are led along it in parts.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.contacts import AT_CORNER, SAME_PLACE, faced
from sandbox.engine.curves import ITERATIONS
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.native import call_step
from sandbox.numeric import Array

MAX_PARTS = 1000  # of a step that are searched
SHALLOW = 0.01  # overlap in the path of a fast body that is left out, as a share of the margins
PASSING = 5  # parts above which the last path is checked: shapes may move half their thickness
CHECKED = 256  # number of pairs of bodies up to which their bounds are checked before pymunk does


@kernel
def search(table: int, h: float) -> tuple[bool, int]:
    """Whether shapes may be near one another, and in how many parts to search the step.

    Shapes are not near if a line separates the bodies of each pair; many pairs are not checked.
    """
    pairs, boxes, body = at.neighbors(table), at.boxes(table), at.body(table)
    near, parts, fast = len(pairs) > CHECKED, 1, _bound(table, h)
    for k in range(len(pairs)):
        if near and not fast:
            break
        a, b = pairs[k, 0], pairs[k, 1]
        apart = max(max(boxes[a, 0] - boxes[b, 2], boxes[b, 0] - boxes[a, 2]),
                    max(boxes[a, 1] - boxes[b, 3], boxes[b, 1] - boxes[a, 3]))
        if fast and max(apart, 0.0) < boxes[a, 5] + boxes[b, 5]:
            parts = max(parts, _parts(h, body, boxes, a, b))
        if not near and apart <= 0.0:
            x, y = body[b, 0] - body[a, 0], body[b, 1] - body[a, 1]
            near = _reach(table, a, x, y) + _reach(table, b, -x, -y) >= x * x + y * y
    return near or parts > 1, parts


@kernel
def _bound(table: int, h: float) -> bool:
    """Bounds, margins and paths of all bodies, into ``boxes``; whether any path is beyond these."""
    boxes, shapes, vertices = at.boxes(table), at.shapes(table), at.vertices(table)
    body, turn, last, fast = at.body(table), at.turn(table), -1, False
    for b in range(len(boxes)):
        boxes[b, 5] = -math.inf
    for k in range(len(shapes)):  # those of a body one after the other
        b, margin = shapes[k]["body"], shapes[k]["margin"]
        r = shapes[k]["radius"] + margin + SAME_PLACE
        c, s, x0, y0, x1, y1 = turn[b, 0], turn[b, 1], math.inf, math.inf, -math.inf, -math.inf
        for i in range(shapes[k]["vertex"], shapes[k]["vertex_end"]):
            x, y = c * vertices[i, 0] - s * vertices[i, 1], s * vertices[i, 0] + c * vertices[i, 1]
            x0, y0, x1, y1 = min(x0, x), min(y0, y), max(x1, x), max(y1, y)
        x, y = body[b, 0], body[b, 1]
        x0, y0, x1, y1 = x + x0 - r, y + y0 - r, x + x1 + r, y + y1 + r
        if b == last:
            x0, y0 = min(x0, boxes[b, 0]), min(y0, boxes[b, 1])
            x1, y1 = max(x1, boxes[b, 2]), max(y1, boxes[b, 3])
            margin = min(margin, boxes[b, 4])
        boxes[b, 0], boxes[b, 1], boxes[b, 2], boxes[b, 3], last = x0, y0, x1, y1, b
        boxes[b, 4], boxes[b, 5] = margin, 0.0
        reach = max(x1 - x, x - x0) + max(y1 - y, y - y0)  # no less, and without a root
        fast |= h * (abs(body[b, 3]) + abs(body[b, 4]) + abs(body[b, 5]) * reach) > margin
    return fast and _paths(h, body, boxes)


@kernel
def _paths(h: float, body: Array, boxes: Array) -> bool:
    """Paths beyond the margins, and reaches, into ``boxes``; whether any path is."""
    fast = False
    for b in range(len(boxes)):
        if boxes[b, 5] == 0.0:  # it has shapes
            far_x = max(boxes[b, 2] - body[b, 0], body[b, 0] - boxes[b, 0])
            far_y = max(boxes[b, 3] - body[b, 1], body[b, 1] - boxes[b, 1])
            reach = math.sqrt(far_x * far_x + far_y * far_y)
            boxes[b, 6] = reach
            boxes[b, 5] = h * (math.sqrt(body[b, 3] ** 2 + body[b, 4] ** 2)
                               + abs(body[b, 5]) * reach) - boxes[b, 4]
            fast |= boxes[b, 5] > 0.0
    return fast


@kernel
def _parts(h: float, body: Array, boxes: Array, a: int, b: int) -> int:
    """Parts of a step in which two bodies approach by no more than their margins.

    The motion of one is that relative to the other, which turns: of the two the shorter path.
    """
    x, y, turn = body[b, 0] - body[a, 0], body[b, 1] - body[a, 1], h * body[a, 5]
    dx, dy = h * (body[b, 3] - body[a, 3]), h * (body[b, 4] - body[a, 4])
    other, margins = h * body[b, 5], boxes[a, 4] + boxes[b, 4]
    to_a = (math.sqrt((dx + turn * y) ** 2 + (dy - turn * x) ** 2)
            + abs(other - turn) * boxes[b, 6])
    to_b = (math.sqrt((dx + other * y) ** 2 + (dy - other * x) ** 2)
            + abs(other - turn) * boxes[a, 6])
    return int(min(math.ceil(min(to_a, to_b) / margins), MAX_PARTS))


@kernel
def _reach(table: int, b: int, x: float, y: float) -> float:
    """How far a body extends along (x, y) from its centre of mass, times the length of that."""
    shapes, vertices, turn, size = (
        at.shapes(table), at.vertices(table), at.turn(table), math.hypot(x, y))
    x, y = turn[b, 0] * x + turn[b, 1] * y, turn[b, 0] * y - turn[b, 1] * x
    farthest = -math.inf
    for k in range(len(shapes)):
        if shapes[k]["body"] == b:
            r = shapes[k]["radius"] + shapes[k]["margin"] + SAME_PLACE
            for i in range(shapes[k]["vertex"], shapes[k]["vertex_end"]):
                farthest = max(farthest, x * vertices[i, 0] + y * vertices[i, 1] + r * size)
    return farthest


@entry_point("shapes")
def overlapped(table: int, h: float, parts: int) -> bool:
    """Whether shapes overlap on the way of pymunk's bodies from the last pose, in equal parts."""
    found = False
    for j in range(1, parts + 1):
        at.near(table)[0] = 0
        call_step(at.step(table), at.space(table), h / parts)
        found |= _overlapped(table, h, j * h / parts - h)
    return found


@kernel
def _overlapped(table: int, h: float, now: float) -> bool:
    """Whether shapes overlap by a quarter of their margins at an instant before the pose (< 0).

    An impact displaces the pose of its bodies: they are compared only after its instant.
    """
    raw, touches, last = at.raw(table), at.touches(table), at.near(table)[0]
    shapes, faces, body = at.shapes(table), at.faces(table), at.body(table)
    for i in range(last if last <= len(raw) else 0):
        one, two, nx, ny = (shapes[raw[i]["shape_a"]], shapes[raw[i]["shape_b"]],
                            raw[i]["nx"], raw[i]["ny"])
        a, b = one["body"], two["body"]
        deep = (at.friction(table)[a, b] >= 0.0
                and 4.0 * _approach(table, raw[i], now)[0] < -one["margin"] - two["margin"]
                and faced(one, faces, body[a, 2] + now * body[a, 5], nx, ny)
                and faced(two, faces, body[b, 2] + now * body[b, 5], -nx, -ny))
        for k in range(at.touching(table)[0] if deep else 0):
            t = touches[k]
            deep &= not (t["bounce"] > 0.0 and t["instant"] > now + h
                         and (t["a"] == a or t["a"] == b or t["b"] == a or t["b"] == b))
        if deep:
            return True
    return False


@entry_point("shapes")
def find_ahead(table: int, h: float, parts: int) -> None:
    """Add contact points of shapes that are apart at the pose but meet within the step.

    pymunk's bodies move along the step in equal parts, and back to each instant of a meeting.
    """
    near, kept, part = at.near(table), at.near(table)[0], h / parts
    at.touching(table)[2] = 1
    for j in range(1, parts + 1):
        call_step(at.step(table), at.space(table), part)
        i = _new_overlap(table, kept, j * part)
        while i >= 0:
            now, end = _meeting(table, kept, i, max(j - 2, 0) * part, j * part)
            near[0] = end
            call_step(at.step(table), at.space(table), j * part - now)
            i = _new_overlap(table, end, j * part) if end > kept else -1
            kept = end
        if near[0] > len(at.raw(table)):
            at.touching(table)[2] = 2
            return
        near[0] = kept


@kernel
def _new_overlap(table: int, kept: int, now: float) -> int:
    """Index of the first point of two overlapping shapes without a point among the first ``kept``.

    It is -1 if there is no such point.
    """
    raw, shapes, last = at.raw(table), at.shapes(table), at.near(table)[0]
    for i in range(kept, last if last <= len(raw) else 0):
        a, b = raw[i]["shape_a"], raw[i]["shape_b"]
        allowed = -SHALLOW * (shapes[a]["margin"] + shapes[b]["margin"])
        new = (_approach(table, raw[i], now)[0] < allowed
               and at.friction(table)[shapes[a]["body"], shapes[b]["body"]] >= 0.0)
        for k in range(kept if new else 0):
            new &= not _of(raw[k], a, b)
        if new:
            return i
    return -1


@kernel
def _of(found: Any, a: int, b: int) -> bool:
    return bool((found["shape_a"] == a and found["shape_b"] == b)
                or (found["shape_a"] == b and found["shape_b"] == a))


@kernel
def _meeting(table: int, kept: int, i: int, low: float, high: float) -> tuple[float, int]:
    """Move pymunk's bodies back from the instant ``high`` to that at which two shapes meet.

    These are the shapes of point ``i``, which are apart at ``low``. Newton's method, with bisection
    as a safeguard, finds the instant. Returns it, and the number of points with those of the
    meeting added after the first ``kept``.
    """
    raw, near, shapes, now, end = at.raw(table), at.near(table), at.shapes(table), high, kept
    a, b = raw[i]["shape_a"], raw[i]["shape_b"]
    tolerance = AT_CORNER * (shapes[a]["margin"] + shapes[b]["margin"])
    for k in range(ITERATIONS):
        gap, rate, end = math.inf, 0.0, kept
        for i in range(kept, min(near[0], len(raw))):
            if _of(raw[i], a, b):
                raw[end] = raw[i]
                raw[end]["ahead"] = now
                g, r = _approach(table, raw[end], now)
                if g < gap:
                    gap, rate = g, r
                end += 1
        if abs(gap) <= tolerance or (gap < 0.0 and k >= ITERATIONS - 2):
            break
        if gap < 0.0:
            high = now
        else:
            low = now
        then = now - gap / rate if rate < 0.0 and gap < math.inf else low
        if k == ITERATIONS - 2:
            then = high
        elif not low < then < high:
            then = (low + high) / 2
        near[0] = kept
        call_step(at.step(table), at.space(table), then - now)
        now = then
    return now, end


@kernel
def _approach(table: int, found: Any, now: float) -> tuple[float, float]:
    """The gap of a FOUND at the instant ``now`` after the pose [m], and its rate [m/s]."""
    body, one, two = (
        at.body(table), at.shapes(table)[found["shape_a"]], at.shapes(table)[found["shape_b"]])
    a, b, nx, ny = one["body"], two["body"], found["nx"], found["ny"]
    ux, uy = body[b, 3] - body[a, 3], body[b, 4] - body[a, 4]
    gap = ((body[b, 0] - body[a, 0] + now * ux + found["bx"] - found["ax"]) * nx
           + (body[b, 1] - body[a, 1] + now * uy + found["by"] - found["ay"]) * ny
           + one["margin"] + two["margin"])
    rate = (nx * (ux - body[b, 5] * found["by"] + body[a, 5] * found["ay"])
            + ny * (uy + body[b, 5] * found["bx"] - body[a, 5] * found["ax"]))
    return float(gap), float(rate)
