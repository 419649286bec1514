"""Exact contacts on curves of quintic spans, for which pymunk has polygons of chords.

Between straight features pymunk's points and normal are exact; on a curve Newton's method starts
from them. Every feature gets a curvature k / d (:mod:`sandbox.engine.contacts`).
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Records

CONFORMING = 0.05  # minimum sum of two curvatures, as a share of their magnitudes
ITERATIONS = 40
CONVERGED = 1e-12  # change of the parameter of a span in one iteration
SAME_WAY = 0.5  # minimum cosine between pymunk's normal and the exact one
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
def nearest_vertex(vertices: Array, first: int, last: int, x: float, y: float) -> int:
    """The vertex nearest to a point."""
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
    vertex, radius = nearest_vertex(vertices, first, last, x, y), other["radius"]
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
    return _nearest(body, found, a, at.shapes(table)[found["shape_b"]]["body"])


@kernel
def gap_of(body: Array, found: Any, a: int, b: int) -> float:
    """How far the surfaces of a FOUND are apart [m]."""
    return float((body[b, 0] + found["bx"] - body[a, 0] - found["ax"]) * found["nx"]
                 + (body[b, 1] + found["by"] - body[a, 1] - found["ay"]) * found["ny"])


@kernel
def _nearest(body: Array, found: Any, a: int, b: int) -> int:
    """EXACT if the distance is a minimum; DROPPED if it is a maximum."""
    ka, da, kb, db = found["ka"], found["da"], found["kb"], found["db"]
    minimum = ka * db + kb * da + ka * kb * gap_of(body, found, a, b) > 0.0
    return EXACT if minimum else DROPPED


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
    return _nearest(body, found, a, b)


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
    return (w, k, True, still) if corner else (1.0 - w, there, False, still)
