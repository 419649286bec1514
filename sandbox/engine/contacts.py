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

from sandbox.engine import curves
from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.rows import turned
from sandbox.numeric import Array, Integers, Records

AT_CORNER = 1e-4  # distance from a corner, as a share of the margin, that counts as none
SAME_PLACE = 1e-6  # distance below which contacts of two shapes are the same [m]
ON_CURVE = -1  # the feature of all contacts on a curve
ASKEW = 1e-6  # tolerance of normals [rad]: pymunk finds them to about 1e-9


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
                 + turning / max(total + ka * kb * gap, curves.CONFORMING * size))


@kernel
def straight_curvature(table: int, shape: Any, px: float, py: float, nx: float, ny: float) -> Any:
    """Curvature k / d of a shape without a curve at (px, py), from the centre of mass."""
    vertices, radius = at.vertices(table), shape["radius"]
    first, last, b = shape["vertex"], shape["vertex_end"], shape["body"]
    c, s = turned(at.ahead(table), b, at.body(table)[b, 2])
    if last - first == 1:  # a drive may change the radius of a circle
        x, y = vertices[first, 0], vertices[first, 1]
        return 1.0, math.hypot(px - (c * x - s * y), py - (s * x + c * y))
    px, py = px - radius * nx, py - radius * ny
    x, y = c * px + s * py, c * py - s * px
    k = curves.nearest_vertex(vertices, first, last, x, y)
    if math.hypot(vertices[k, 0] - x, vertices[k, 1] - y) < AT_CORNER * shape["margin"]:
        return 1.0, radius
    return 0.0, 1.0


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
        body[a, 0], body[a, 1], body[a, 2] = xa, ya, ta
        body[b, 0], body[b, 1], body[b, 2] = xb, yb, tb
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

    Its bodies stand where it was found. The gap at the pose of the step is extrapolated from there
    at the present rate.
    """
    found, shapes, body, out = at.raw(table)[i], at.shapes(table), at.body(table), at.found(table)
    nx, ny = found["nx"], found["ny"]
    found["ka"], found["da"] = straight_curvature(
        table, shapes[found["shape_a"]], found["ax"], found["ay"], nx, ny)
    found["kb"], found["db"] = straight_curvature(
        table, shapes[found["shape_b"]], found["bx"], found["by"], -nx, -ny)
    if found["da"] == 0.0 and found["db"] == 0.0:  # corners of sides that lie on each other
        found["ka"], found["da"] = 0.0, 1.0
    state, t = curves.on_curves(table, i), out[n]
    if state == curves.DROPPED:
        return 0
    sa, sb = found["shape_a"], found["shape_b"]
    a, b = shapes[sa]["body"], shapes[sb]["body"]
    t["shape_a"], t["shape_b"], t["feature"] = sa, sb, found["feature"]
    if state == curves.EXACT:
        t["shape_a"], t["shape_b"] = shapes[sa]["leader"], shapes[sb]["leader"]
        t["feature"] = ON_CURVE
    t["gap"] = t["distance"] = curves.gap_of(body, found, a, b)
    t["a"], t["b"], t["ahead"] = a, b, found["ahead"]
    t["ka"], t["da"], t["kb"], t["db"] = found["ka"], found["da"], found["kb"], found["db"]
    t["nx"], t["ny"] = found["nx"], found["ny"]
    # its force acts in the middle of the gap
    t["ax"] = (found["ax"] + body[b, 0] + found["bx"] - body[a, 0]) / 2
    t["ay"] = (found["ay"] + body[b, 1] + found["by"] - body[a, 1]) / 2
    t["bx"] = (found["bx"] + body[a, 0] + found["ax"] - body[b, 0]) / 2
    t["by"] = (found["by"] + body[a, 1] + found["ay"] - body[b, 1]) / 2
    t["normal"] = t["tangent"] = t["bounce"] = t["drag"] = t["gap_shift"] = 0.0
    t["stretch"] = t["bias"] = t["soft"] = t["bias_along"] = t["soft_along"] = 0.0
    t["mode"] = t["listed"] = t["late"] = t["phase"] = 0
    t["sums"] = -1
    same = _last(out, n, 0, t) if state == curves.EXACT else -1
    if same >= 0 and abs(out[same]["ax"] - t["ax"]) + abs(out[same]["ay"] - t["ay"]) < SAME_PLACE:
        return 0  # of another piece of the curve
    t["friction"], t["restitution"] = at.friction(table)[a, b], at.restitution(table)[a, b]
    t["acceleration"], t["static"] = gap_acceleration(table, t), at.static(table)[a, b]
    if t["ahead"] > 0.0:
        t["gap"] -= t["ahead"] * gap_rate(at.before(table), t)
        t["acceleration"] = 0.0
    return 1


@kernel
def gap_rate(velocity: Array, t: Any) -> float:
    """Rate of the gap of a TOUCH as bodies move with ``velocity`` [nb, 3] [m/s]."""
    a, b, v = t["a"], t["b"], velocity
    return float(t["nx"] * (v[b, 0] - v[b, 2] * t["by"] - v[a, 0] + v[a, 2] * t["ay"])
                 + t["ny"] * (v[b, 1] + v[b, 2] * t["bx"] - v[a, 1] - v[a, 2] * t["ax"]))


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
        if not (faced(one, faces, body[a, 2] + ahead * body[a, 5], nx, ny)
                and faced(two, faces, body[b, 2] + ahead * body[b, 5], -nx, -ny)):
            continue
        raw[i]["ax"] -= one["margin"] * nx
        raw[i]["ay"] -= one["margin"] * ny
        raw[i]["bx"] += two["margin"] * nx
        raw[i]["by"] += two["margin"] * ny
        if one["body"] > two["body"]:  # the normal leads to the body with the higher number
            curves.exchange(raw[i])
        order[n] = i
        n += 1
    _sort(raw, order, n)
    return n


@kernel
def faced(shape: Any, faces: Records, angle: float, nx: float, ny: float) -> bool:
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
    """The contact with the same shapes and feature as ``now``, or -1; on a curve the nearest."""
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
    return (low, high, one["feature"], i) > (low_other, high_other, other["feature"], j)
