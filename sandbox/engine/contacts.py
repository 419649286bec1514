"""Contacts of a step: points with a normal, a gap, curvatures, and the impulses of the last step.

pymunk's shapes are larger by a margin, so that contacts are found before they close: their gap is
then positive. Where bodies move farther in a step than their margins, the step is searched in
parts: shapes that meet in it are contacts, with the normal and arms of that instant. Impulses and
sliding of the last step are found again by the two shapes and pymunk's number of the feature.
Outlines that are not convex are several shapes to pymunk; contacts at their seams are left out, by
the normal (:mod:`sandbox.scene.outlines.rings`).

Each shape is the set of all points within a radius of a *core*: a point (circle), a line (capsule),
a polygon, or a curve of quintic spans for which pymunk has a polygon of chords. Between straight
features pymunk's points and normal are exact; on a curve Newton's method starts from them.

Every feature has a curvature k / d, positive where the surface is convex: (0, 1) of a side, (1, r)
of a corner or circle with the radius r, (κ, 1 + κ r) of a curve. Replacing both surfaces by
their circles of curvature gives the second derivative of the gap while both bodies keep their
velocities,

    c = ω_a² n·r_a - ω_b² n·r_b + [k_a k_b s² + 2 s (k_a d_b ω_b + k_b d_a ω_a)
        - (ω_b - ω_a)² d_a d_b - g (k_b d_a ω_a² + k_a d_b ω_b²)] / (k_a d_b + k_b d_a + k_a k_b g)

with the normal n from a to b, the sliding speed s along (-n_y, n_x), the gap g and the arms r.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.native import call_step
from sandbox.numeric import Array, Integers, Records

AT_CORNER = 1e-4  # distance from a corner, as a share of the margin, that counts as none
CONFORMING = 0.05  # minimum sum of two curvatures, as a share of their magnitudes
ITERATIONS = 40
CONVERGED = 1e-12  # change of the parameter of a span in one iteration
SAME_WAY = 0.5  # the least cosine between pymunk's normal and the exact one
SAME_PLACE = 1e-6  # distance below which contacts of two shapes are the same [m]
ON_CURVE = -1  # the feature of all contacts on a curve
ASKEW = 1e-6  # tolerance of normals [rad]: pymunk finds them to about 1e-9
MAX_PARTS = 1000  # of a step that are searched
SHALLOW = 0.01  # overlap in the path of a fast body that is left out, as a share of the margins
PASSING = 5  # parts above which bodies may pass each other: they approach by half a thickness
CHECKED = 256  # number of pairs of bodies up to which their bounds are checked before pymunk does
DROPPED, EXACT, AS_FOUND = 0, 1, 2  # states of a contact of pymunk on a curve


@kernel
def on_span(span: Any, w: float) -> Any:
    """Point of a span and its first two derivatives, all in the body's frame."""
    x = span["x0"] + w * (span["x1"] + w * (span["x2"] + w * (
        span["x3"] + w * (span["x4"] + w * span["x5"]))))
    y = span["y0"] + w * (span["y1"] + w * (span["y2"] + w * (
        span["y3"] + w * (span["y4"] + w * span["y5"]))))
    dx = span["x1"] + w * (2 * span["x2"] + w * (
        3 * span["x3"] + w * (4 * span["x4"] + w * 5 * span["x5"])))
    dy = span["y1"] + w * (2 * span["y2"] + w * (
        3 * span["y3"] + w * (4 * span["y4"] + w * 5 * span["y5"])))
    ddx = 2 * span["x2"] + w * (6 * span["x3"] + w * (12 * span["x4"] + w * 20 * span["x5"]))
    ddy = 2 * span["y2"] + w * (6 * span["y3"] + w * (12 * span["y4"] + w * 20 * span["y5"]))
    return x, y, dx, dy, ddx, ddy


@kernel
def nearest_start(spans: Records, first: int, last: int, x: float, y: float) -> int:
    """The span that begins nearest to a point."""
    best, found = math.inf, first
    for k in range(first, last):
        d = (spans[k]["x0"] - x) ** 2 + (spans[k]["y0"] - y) ** 2
        if d < best:
            best, found = d, k
    return found


@kernel
def _slope(span: Any, w: float, to_point: bool, x: float, y: float) -> Any:
    """First and second derivative of (distance to (x, y))^2 / 2 or height along it; speed^2."""
    px, py, dx, dy, ddx, ddy = on_span(span, w)
    if to_point:
        square = dx * dx + dy * dy
        return (px - x) * dx + (py - y) * dy, square + (px - x) * ddx + (py - y) * ddy, square
    return x * dx + y * dy, x * ddx + y * ddy, math.hypot(dx, dy)


@kernel
def descend(spans: Records, k: int, to_point: bool, x: float, y: float) -> Any:
    """Local minimum along a curve from the start of span ``k``: span, parameter, if a corner."""
    w = 0.0
    for _ in range(ITERATIONS):
        slope, bend, scale = _slope(spans[k], w, to_point, x, y)
        least = 0.05 * scale if to_point else 0.0
        step = -slope / (bend if bend > least else scale)
        step = min(1.0, max(-1.0, step))
        w += step
        if 0.0 <= w <= 1.0:
            if abs(step) < CONVERGED:
                return k, w, False
            continue
        forward = w > 1.0
        w = 1.0 if forward else 0.0
        there, corner = _beyond(spans, k, forward)
        if there < 0:
            return k, w, True
        if corner:
            slope, _, _ = _slope(spans[there], 1.0 - w, to_point, x, y)
            if (slope >= 0.0) if forward else (slope <= 0.0):
                return k, w, True
        elif abs(step) < CONVERGED:
            return k, w, False
        k, w = there, 1.0 - w
    return k, w, False


@kernel
def _beyond(spans: Records, k: int, forward: bool) -> Any:
    """The span after span ``k`` or before it, -1 at an end; whether there is a corner between."""
    if forward:
        there = spans[k]["after"]
        return there, bool(there < 0 or spans[there]["corner"])
    return spans[k]["before"], bool(spans[k]["corner"])


@kernel
def rotated(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector turned counter-clockwise."""
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


@kernel
def gap_acceleration(table: int, t: Any) -> float:
    """Second derivative of the gap of a TOUCH while its bodies keep their velocities [m/s^2]."""
    body, a, b, nx, ny, gap = at.body(table), t["a"], t["b"], t["nx"], t["ny"], t["gap"]
    ka, da, kb, db = t["ka"], t["da"], t["kb"], t["db"]
    wa, wb = body[a, 5], body[b, 5]
    # of the surfaces' points, half a gap from the middle
    rax, ray = t["ax"] - gap / 2 * nx, t["ay"] - gap / 2 * ny
    rbx, rby = t["bx"] + gap / 2 * nx, t["by"] + gap / 2 * ny
    ux, uy = body[b, 3] - wb * rby, body[b, 4] + wb * rbx
    s = ny * (body[a, 3] - wa * ray - ux) - nx * (body[a, 4] + wa * rax - uy)
    total, size = ka * db + kb * da, abs(ka * db) + abs(kb * da)
    if size == 0.0:
        return 0.0
    turning = (ka * kb * s * s + 2.0 * s * (ka * db * wb + kb * da * wa)
               - (wb - wa) ** 2 * da * db - gap * (kb * da * wa * wa + ka * db * wb * wb))
    return float(wa * wa * (nx * rax + ny * ray) - wb * wb * (nx * rbx + ny * rby)
                 + turning / max(total + ka * kb * gap, CONFORMING * size))


@kernel
def straight_curvature(table: int, shape: Any, px: float, py: float, nx: float, ny: float) -> Any:
    """Curvature k / d of a shape without a curve at (px, py), from the centre of mass."""
    vertices, radius = at.vertices(table), shape["radius"]
    first, last = shape["vertex"], shape["vertex_end"]
    if last - first == 1:  # a drive may change the radius of a circle
        x, y = rotated(vertices[first, 0], vertices[first, 1], at.body(table)[shape["body"], 2])
        return 1.0, math.hypot(px - x, py - y)
    x, y = rotated(px - radius * nx, py - radius * ny, -at.body(table)[shape["body"], 2])
    k = _nearest_vertex(vertices, first, last, x, y)
    if math.hypot(vertices[k, 0] - x, vertices[k, 1] - y) < AT_CORNER * shape["margin"]:
        return 1.0, radius
    return 0.0, 1.0


@kernel
def _nearest_vertex(vertices: Array, first: int, last: int, x: float, y: float) -> int:
    best, found = math.inf, first
    for k in range(first, last):
        d = (vertices[k, 0] - x) ** 2 + (vertices[k, 1] - y) ** 2
        if d < best:
            best, found = d, k
    return found


@kernel
def exchange(found: Any) -> None:
    """Exchange the two bodies of a FOUND."""
    found["shape_a"], found["shape_b"] = found["shape_b"], found["shape_a"]
    found["ax"], found["bx"] = found["bx"], found["ax"]
    found["ay"], found["by"] = found["by"], found["ay"]
    found["ka"], found["kb"] = found["kb"], found["ka"]
    found["da"], found["db"] = found["db"], found["da"]
    found["nx"], found["ny"] = -found["nx"], -found["ny"]


@entry_point("curves", default=AS_FOUND)
def on_curves(table: int, i: int) -> int:
    """Make the FOUND ``i`` exact if a curve is involved; DROPPED, EXACT or AS_FOUND."""
    found, shapes = at.raw(table)[i], at.shapes(table)
    first, second = shapes[found["shape_a"]]["span"] >= 0, shapes[found["shape_b"]]["span"] >= 0
    if first and second:
        return _two_curves(table, found)
    if first:
        return _curve_and_straight(table, found)
    if not second:
        return AS_FOUND
    exchange(found)
    state = _curve_and_straight(table, found)
    exchange(found)
    return state


@kernel
def _curve_and_straight(table: int, found: Any) -> int:
    """As :func:`on_curves`, of a curve a and a shape b that has none."""
    body, spans, vertices = at.body(table), at.spans(table), at.vertices(table)
    curve, other = at.shapes(table)[found["shape_a"]], at.shapes(table)[found["shape_b"]]
    a, b, nx, ny = curve["body"], other["body"], found["nx"], found["ny"]
    first, last = other["vertex"], other["vertex_end"]
    apart_x, apart_y = body[b, 0] - body[a, 0], body[b, 1] - body[a, 1]
    x, y = rotated(found["ax"], found["ay"], -body[a, 2])
    start = nearest_start(spans, curve["span"], curve["span_end"], x, y)
    x, y = rotated(found["bx"], found["by"], -body[b, 2])
    vertex, radius = _nearest_vertex(vertices, first, last, x, y), other["radius"]
    if last - first == 1:
        radius = math.hypot(x - vertices[vertex, 0], y - vertices[vertex, 1])
    else:
        side, mx, my = _facing_side(vertices, first, last, *rotated(-nx, -ny, -body[b, 2]))
        after = side + 1 if side + 1 < last else first
        wx, wy = rotated(mx, my, body[b, 2])
        hx, hy = rotated(wx, wy, -body[a, 2])
        k, w, corner = descend(spans, start, False, hx, hy)
        px, py, _, _, ddx, ddy = on_span(spans[k], w)
        px, py = rotated(px, py, body[a, 2])
        qx, qy = rotated(px - apart_x, py - apart_y, -body[b, 2])
        ex, ey = vertices[after, 0] - vertices[side, 0], vertices[after, 1] - vertices[side, 1]
        qx, qy = qx - vertices[side, 0], qy - vertices[side, 1]
        along = (qx * ex + qy * ey) / (ex * ex + ey * ey)
        if 0.0 <= along <= 1.0 and (corner or hx * ddx + hy * ddy > 0.0):
            height = mx * qx + my * qy - radius
            found["bx"], found["by"] = px - apart_x - height * wx, py - apart_y - height * wy
            found["kb"], found["db"] = 0.0, 1.0
            return _place_on_curve(table, found, k, w, corner, -wx, -wy)
        vertex = side if along < 0.0 else after if along > 1.0 else vertex
    bx, by = rotated(vertices[vertex, 0], vertices[vertex, 1], body[b, 2])
    x, y = rotated(bx + apart_x, by + apart_y, -body[a, 2])
    k, w, corner = descend(spans, start, True, x, y)
    px, py, dx, dy, _, _ = on_span(spans[k], w)
    wx, wy = (x - px, y - py) if corner else (dy, -dx)
    length = math.hypot(wx, wy)
    if length == 0.0:
        return AS_FOUND
    wx, wy = rotated(wx / length, wy / length, body[a, 2])
    if not corner and not curve["closed"] and wx * nx + wy * ny < 0.0:
        wx, wy = -wx, -wy
    found["bx"], found["by"] = bx - radius * wx, by - radius * wy
    found["kb"], found["db"] = 1.0, radius
    return _place_on_curve(table, found, k, w, corner, wx, wy)


@kernel
def _facing_side(vertices: Array, first: int, last: int, x: float, y: float) -> Any:
    """The side of a line or polygon whose outer normal is nearest to (x, y), and that normal."""
    best, side, mx, my = -2.0, first, 0.0, 0.0
    for k in range(first, last if last - first > 2 else first + 1):
        after = k + 1 if k + 1 < last else first
        ex, ey = vertices[after, 0] - vertices[k, 0], vertices[after, 1] - vertices[k, 1]
        length = math.hypot(ex, ey)
        ux, uy = ey / length, -ex / length
        if last - first == 2 and ux * x + uy * y < 0.0:
            ux, uy = -ux, -uy
        if ux * x + uy * y > best:
            best, side, mx, my = ux * x + uy * y, k, ux, uy
    return side, mx, my


@kernel
def _place_on_curve(
    table: int, found: Any, k: int, w: float, corner: bool, nx: float, ny: float,
) -> int:
    """Put the point of body a of a FOUND onto its curve, where its outer normal is (nx, ny)."""
    body, curve = at.body(table), at.shapes(table)[found["shape_a"]]
    if nx * found["nx"] + ny * found["ny"] < SAME_WAY:
        return AS_FOUND if corner else DROPPED
    a, radius = curve["body"], curve["radius"]
    x, y, dx, dy, ddx, ddy = on_span(at.spans(table)[k], w)
    found["ka"], found["da"] = 1.0, radius
    if not corner:
        sx, sy = rotated(dy, -dx, body[a, 2])
        side = 1.0 if sx * nx + sy * ny > 0.0 else -1.0
        bend = side * (dx * ddy - dy * ddx) / math.hypot(dx, dy) ** 3
        found["ka"], found["da"] = bend, 1.0 + radius * bend
    x, y = rotated(x, y, body[a, 2])
    found["ax"], found["ay"] = x + radius * nx, y + radius * ny
    found["nx"], found["ny"] = nx, ny
    b = at.shapes(table)[found["shape_b"]]["body"]
    return EXACT if _nearest(body, found, a, b) else DROPPED


@kernel
def gap_of(body: Array, found: Any, a: int, b: int) -> float:
    """How far the surfaces of a FOUND are apart [m]."""
    return float((body[b, 0] + found["bx"] - body[a, 0] - found["ax"]) * found["nx"]
                 + (body[b, 1] + found["by"] - body[a, 1] - found["ay"]) * found["ny"])


@kernel
def _nearest(body: Array, found: Any, a: int, b: int) -> bool:
    """Whether the distance is a minimum, not a maximum."""
    ka, da, kb, db = found["ka"], found["da"], found["kb"], found["db"]
    return bool(ka * db + kb * da + ka * kb * gap_of(body, found, a, b) > 0.0)


@kernel
def _two_curves(table: int, found: Any) -> int:
    """As :func:`on_curves`, of two curves: Newton's method on both arc lengths."""
    body, spans = at.body(table), at.spans(table)
    one, two = at.shapes(table)[found["shape_a"]], at.shapes(table)[found["shape_b"]]
    a, b, nx, ny = one["body"], two["body"], found["nx"], found["ny"]
    apart_x, apart_y = body[b, 0] - body[a, 0], body[b, 1] - body[a, 1]
    ka = nearest_start(spans, one["span"], one["span_end"],
                        *rotated(found["ax"], found["ay"], -body[a, 2]))
    kb = nearest_start(spans, two["span"], two["span_end"],
                        *rotated(found["bx"], found["by"], -body[b, 2]))
    wa = wb = 0.0
    side_a = _side_of(body, spans[ka], one, nx, ny)
    side_b = _side_of(body, spans[kb], two, -nx, -ny)
    for _ in range(ITERATIONS):
        ax, ay, atx, aty, bend_a, speed_a = _frame_on(body, a, spans[ka], wa, side_a)
        bx, by, btx, bty, bend_b, speed_b = _frame_on(body, b, spans[kb], wb, side_b)
        ex, ey = apart_x + bx - ax, apart_y + by - ay
        off, gap, along = ex * atx + ey * aty, ex * aty - ey * atx, atx * btx + aty * bty
        turn = math.atan2(aty * btx - atx * bty, -along)
        below = bend_a * along - (1.0 + bend_a * gap) * bend_b
        size = CONFORMING * (abs(bend_a) + abs(bend_b))
        below = min(below, -size) if size > 0.0 else -1.0
        wa, ka, stuck_a, still_a = _advance(
            spans, ka, wa, side_a * (along * turn - bend_b * off) / below / speed_a)
        wb, kb, stuck_b, still_b = _advance(
            spans, kb, wb, side_b * ((1.0 + bend_a * gap) * turn - bend_a * off) / below / speed_b)
        if still_a and still_b:
            break
    if stuck_a or stuck_b:
        return AS_FOUND
    ax, ay, atx, aty, bend_a, _ = _frame_on(body, a, spans[ka], wa, side_a)
    bx, by, _, _, bend_b, _ = _frame_on(body, b, spans[kb], wb, side_b)
    if aty * nx - atx * ny < SAME_WAY:
        return DROPPED
    nx, ny = aty, -atx
    found["nx"], found["ny"] = nx, ny
    found["ax"], found["ay"] = ax + one["radius"] * nx, ay + one["radius"] * ny
    found["bx"], found["by"] = bx - two["radius"] * nx, by - two["radius"] * ny
    found["ka"], found["da"] = bend_a, 1.0 + bend_a * one["radius"]
    found["kb"], found["db"] = bend_b, 1.0 + bend_b * two["radius"]
    return EXACT if _nearest(body, found, a, b) else DROPPED


@kernel
def _side_of(body: Array, span: Any, shape: Any, nx: float, ny: float) -> float:
    """On which side of a curve a normal leads away: 1 outside of a closed one."""
    _, _, dx, dy, _, _ = on_span(span, 0.0)
    x, y = rotated(dy, -dx, body[shape["body"], 2])
    return 1.0 if shape["closed"] or x * nx + y * ny > 0.0 else -1.0


@kernel
def _frame_on(body: Array, b: int, span: Any, w: float, side: float) -> Any:
    """Point and unit tangent in the world, from the centre of mass; curvature; speed over w."""
    x, y, dx, dy, ddx, ddy = on_span(span, w)
    speed = math.hypot(dx, dy)
    x, y = rotated(x, y, body[b, 2])
    tx, ty = rotated(side * dx / speed, side * dy / speed, body[b, 2])
    return x, y, tx, ty, side * (dx * ddy - dy * ddx) / speed ** 3, speed


@kernel
def _advance(spans: Records, k: int, w: float, step: float) -> Any:
    """Move along a curve by at most one span: parameter, span, if at a corner, if converged."""
    still = abs(step) < CONVERGED
    w += min(1.0, max(-1.0, step))
    if 0.0 <= w <= 1.0:
        return w, k, False, still
    forward = w > 1.0
    w = 1.0 if forward else 0.0
    there, corner = _beyond(spans, k, forward)
    if corner:
        return w, k, True, still
    return 1.0 - w, there, False, still


@kernel
def search(table: int, h: float) -> tuple[bool, int]:
    """Whether shapes may be near one another; the parts in which to search the step for meetings.

    They are not near if a line separates those of each pair of bodies; many pairs are not checked.
    """
    pairs, boxes, body, friction = (
        at.neighbors(table), at.boxes(table), at.body(table), at.friction(table))
    near, parts, fast = len(pairs) > CHECKED, 1, _bound(table, h)
    if near:
        for a in range(len(boxes)):
            path, x0, y0, x1, y1 = (
                boxes[a, 5], boxes[a, 0], boxes[a, 1], boxes[a, 2], boxes[a, 3])
            for b in range(a if fast else 0):
                apart = max(max(x0 - boxes[b, 2], boxes[b, 0] - x1),
                            max(y0 - boxes[b, 3], boxes[b, 1] - y1), 0.0)
                if apart < path + boxes[b, 5] and friction[a, b] >= 0.0:
                    parts = max(parts, _parts(h, body, boxes, a, b))
        return near, parts
    for k in range(len(pairs)):
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
        far_x, far_y = max(x1 - x, x - x0), max(y1 - y, y - y0)
        reach = math.sqrt(far_x * far_x + far_y * far_y)
        boxes[b, 4], boxes[b, 6] = margin, reach
        boxes[b, 5] = h * (math.sqrt(body[b, 3] ** 2 + body[b, 4] ** 2)
                           + abs(body[b, 5]) * reach) - margin
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


@entry_point("shapes")
def overlapped(table: int, h: float, parts: int) -> bool:
    """Whether shapes overlap on the way of pymunk's bodies from the last pose, in equal parts."""
    found = False
    for j in range(1, parts + 1):
        at.near(table)[0] = 0
        call_step(at.step(table), at.space(table), h / parts)
        found |= _overlapped(table, h, j * h / parts - h)
    return found


@entry_point("shapes")
def find_ahead(table: int, h: float, parts: int) -> None:
    """Add the points of shapes that are not near at the pose but meet in the step, where they meet.

    pymunk's bodies are led along the step in equal parts, and back to where two shapes meet.
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
def _overlapped(table: int, h: float, now: float) -> bool:
    """Whether shapes overlap that touch or should have, at an instant after the pose (< 0).

    Bodies that an impact has displaced are where they seem only from its instant on.
    """
    raw, touches, last = at.raw(table), at.touches(table), at.near(table)[0]
    shapes, faces, body = at.shapes(table), at.faces(table), at.body(table)
    for i in range(last if last <= len(raw) else 0):
        one, two, nx, ny = (shapes[raw[i]["shape_a"]], shapes[raw[i]["shape_b"]],
                            raw[i]["nx"], raw[i]["ny"])
        a, b = one["body"], two["body"]
        deep = (at.friction(table)[a, b] >= 0.0
                and 4.0 * _approach(table, raw[i], now)[0] < -one["margin"] - two["margin"]
                and _faced(one, faces, body[a, 2] + now * body[a, 5], nx, ny)
                and _faced(two, faces, body[b, 2] + now * body[b, 5], -nx, -ny))
        for k in range(at.touching(table)[0] if deep else 0):
            t = touches[k]
            deep &= not (t["bounce"] > 0.0 and t["instant"] > now + h
                         and (t["a"] == a or t["a"] == b or t["b"] == a or t["b"] == b))
        if deep:
            return True
    return False


@kernel
def _new_overlap(table: int, kept: int, now: float) -> int:
    """The first FOUND where shapes overlap of which none is among the first ``kept``; or -1."""
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
    """Whether a FOUND is of these two shapes."""
    return bool((found["shape_a"] == a and found["shape_b"] == b)
                or (found["shape_a"] == b and found["shape_b"] == a))


@kernel
def _meeting(table: int, kept: int, i: int, low: float, high: float) -> tuple[float, int]:
    """Lead pymunk's bodies from the instant ``high`` back to that at which two shapes meet.

    These are the shapes of the FOUND ``i``, apart at ``low``. The instant; how many FOUND are kept
    with those of the meeting.
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
    raw, shapes, order, out = at.raw(table), at.shapes(table), at.order(table), at.found(table)
    body = at.body(table)
    old, belts, touching, n = at.touches(table), at.belts(table), at.touching(table), 0
    for k in range(_sort_found(table)):
        found = raw[order[k]]
        if found["ahead"] == 0.0:
            n += _locate(table, order[k], n)
            continue
        a, b = shapes[found["shape_a"]]["body"], shapes[found["shape_b"]]["body"]
        xa, ya, ta, xb, yb, tb = (
            body[a, 0], body[a, 1], body[a, 2], body[b, 0], body[b, 1], body[b, 2])
        for j in range(3):
            body[a, j] += found["ahead"] * body[a, 3 + j]
            body[b, j] += found["ahead"] * body[b, 3 + j]
        n += _locate(table, order[k], n)
        body[a, 0], body[a, 1], body[a, 2], body[b, 0], body[b, 1], body[b, 2] = (
            xa, ya, ta, xb, yb, tb)
    guess = 0
    for k in range(n):
        w, now = _last(old, touching[0], guess, out[k]), out[k]
        now["belt"] = -(belts[now["a"]] + belts[now["b"]])
        if w >= 0:
            last = old[w]
            now["normal"], now["tangent"] = last["normal"], last["tangent"]
            now["mode"], now["listed"] = last["mode"], last["listed"]
            now["phase"], now["sums"] = last["phase"], last["sums"]
            now["stretch"] = last["stretch"]
            guess = w + 1
    for k in range(n):
        old[k] = out[k]
    touching[0] = n


@kernel
def _locate(table: int, i: int, n: int) -> int:
    """Make the FOUND ``i`` the contact ``n`` of the step; 1, or 0 if it is none.

    Its bodies stand where it was found. The gap at the pose of the step is that which they close on
    the way there as the surfaces now lie.
    """
    found, shapes, body, out = at.raw(table)[i], at.shapes(table), at.body(table), at.found(table)
    nx, ny = found["nx"], found["ny"]
    found["ka"], found["da"] = straight_curvature(
        table, shapes[found["shape_a"]], found["ax"], found["ay"], nx, ny)
    found["kb"], found["db"] = straight_curvature(
        table, shapes[found["shape_b"]], found["bx"], found["by"], -nx, -ny)
    if found["da"] == 0.0 and found["db"] == 0.0:  # corners of sides that lie on each other
        found["ka"], found["da"] = 0.0, 1.0
    state = on_curves(table, i)
    if state == DROPPED:
        return 0
    t = out[n]
    _contact(found, state, shapes, body, at.friction(table), at.restitution(table), t)
    if state == EXACT and _repeated(out, n):
        return 0
    t["acceleration"], t["static"] = gap_acceleration(table, t), at.static(table)[t["a"], t["b"]]
    if t["ahead"] > 0.0:
        t["gap"] -= t["ahead"] * gap_rate(body, t)
        t["acceleration"] = 0.0
    return 1


@kernel
def gap_rate(body: Array, t: Any) -> float:
    """Rate of the gap of a TOUCH [m/s]."""
    a, b = t["a"], t["b"]
    return float(
        t["nx"] * (body[b, 3] - body[b, 5] * t["by"] - body[a, 3] + body[a, 5] * t["ay"])
        + t["ny"] * (body[b, 4] + body[b, 5] * t["bx"] - body[a, 4] - body[a, 5] * t["ax"]))


@kernel
def _sort_found(table: int) -> int:
    """Points of bodies that may touch, from their surfaces: their number, and ``order`` of them."""
    raw, shapes, faces, body = at.raw(table), at.shapes(table), at.faces(table), at.body(table)
    friction, order, n = at.friction(table), at.order(table), 0
    for i in range(at.near(table)[0]):
        if friction[shapes[raw[i]["shape_a"]]["body"], shapes[raw[i]["shape_b"]]["body"]] < 0.0:
            continue
        one, two = shapes[raw[i]["shape_a"]], shapes[raw[i]["shape_b"]]
        nx, ny = raw[i]["nx"], raw[i]["ny"]
        a, b, ahead = one["body"], two["body"], raw[i]["ahead"]
        if not (_faced(one, faces, body[a, 2] + ahead * body[a, 5], nx, ny)
                and _faced(two, faces, body[b, 2] + ahead * body[b, 5], -nx, -ny)):
            continue
        raw[i]["ax"] -= one["margin"] * nx
        raw[i]["ay"] -= one["margin"] * ny
        raw[i]["bx"] += two["margin"] * nx
        raw[i]["by"] += two["margin"] * ny
        if one["body"] > two["body"]:  # the normal leads to the body with the higher number
            exchange(raw[i])
        order[n] = i
        n += 1
    _sort(raw, order, n)
    return n


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
def _sort(raw: Records, order: Integers, n: int) -> None:
    """Sort the numbers of ``n`` contacts (Shell's method)."""
    gap = 1
    while gap < n // 3:
        gap = 3 * gap + 1
    while gap > 0:
        for k in range(gap, n):
            i, j = order[k], k
            while j >= gap and _after(raw, order[j - gap], i):
                order[j] = order[j - gap]
                j -= gap
            order[j] = i
        gap //= 3


@kernel
def _after(raw: Records, i: int, j: int) -> bool:
    """Whether contact i comes after contact j: by lower shape, higher one, feature, number."""
    one, other = raw[i], raw[j]
    low, low_other = min(one["shape_a"], one["shape_b"]), min(other["shape_a"], other["shape_b"])
    high = max(one["shape_a"], one["shape_b"])
    high_other = max(other["shape_a"], other["shape_b"])
    if low != low_other:
        return bool(low > low_other)
    if high != high_other:
        return bool(high > high_other)
    return bool(one["feature"] > other["feature"] or (one["feature"] == other["feature"] and i > j))


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
    out["a"], out["b"], out["gap"], out["distance"], out["ahead"] = a, b, gap, gap, found["ahead"]
    out["ka"], out["da"], out["kb"], out["db"] = (
        found["ka"], found["da"], found["kb"], found["db"])
    out["nx"], out["ny"] = found["nx"], found["ny"]
    out["ax"] = (found["ax"] + body[b, 0] + found["bx"] - body[a, 0]) / 2
    out["ay"] = (found["ay"] + body[b, 1] + found["by"] - body[a, 1]) / 2
    out["bx"] = (found["bx"] + body[a, 0] + found["ax"] - body[b, 0]) / 2
    out["by"] = (found["by"] + body[a, 1] + found["ay"] - body[b, 1]) / 2
    out["friction"], out["restitution"] = friction[a, b], restitution[a, b]
    out["normal"] = out["tangent"] = out["bounce"] = out["drag"] = out["gap_shift"] = 0.0
    out["mode"] = out["listed"] = out["late"] = out["phase"] = 0
    out["sums"] = -1
    out["stretch"] = out["bias"] = out["soft"] = out["bias_along"] = out["soft_along"] = 0.0
