"""Outlines, paths and points as plain arrays [m] or [pixels], cut to a picture.

pygame walks every pixel of a shape, also outside of the picture, and takes only numbers of a C int.
"""

from __future__ import annotations

import math
from collections.abc import Container, Sequence
from itertools import pairwise

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.bodies import Box, Capsule, Circle, Polygon, Polyline, Shape, Solid
from sandbox.scene.geometry import solids

XY = tuple[float, float]
Edges = tuple[float, float, float, float]  # left, top, right, bottom [pixels]
FAR = 1e12  # coordinates beyond this are moved there [pixels]
TOUCHING = 1e-7  # shapes that are no farther apart touch [m]


def arc_steps(radius: float, error: float, least: int = 4) -> int:
    """Sides that show half a circle no further than ``error`` from its true line."""
    return max(least, math.ceil(math.pi / (2 * math.acos(max(0.0, 1 - error / radius)))))


def capsule_outline(start: XY, end: XY, radius: float, steps: int = 16) -> Array:
    """Corners of a capsule, counter-clockwise, [2 * (steps + 1), 2]."""
    along = math.atan2(end[1] - start[1], end[0] - start[0])
    far = along + np.linspace(-math.pi / 2, math.pi / 2, steps + 1)
    arc = [np.column_stack((np.cos(a), np.sin(a))) * radius for a in (far, far + math.pi)]
    return np.concatenate((np.asarray(end) + arc[0], np.asarray(start) + arc[1]))


def turned_area(ring: Array) -> float:
    """Twice the area of a ring [n, 2], negative where it is clockwise."""
    x, y = ring.T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def polygon_grown(corners: Array, by: float) -> Array:
    """An outline [n, 2], each side moved outwards ``by`` (inwards when negative)."""
    if turned_area(corners) < 0:
        corners = corners[::-1]
    side = np.roll(corners, -1, axis=0) - corners
    normal = np.column_stack((side[:, 1], -side[:, 0])) / np.hypot(*side.T)[:, None]
    before = np.roll(normal, 1, axis=0)
    cosine = np.maximum((normal * before).sum(axis=1), -0.75)
    return np.asarray(corners + by * (normal + before) / (1 + cosine)[:, None])


def shape_points(*shapes: Shape, grow: float = 0.0) -> Array:
    """Points between which shapes lie, in their body's frame [n, 2] m, grown by ``grow``."""
    return np.concatenate([shape_outline(solid, grow) for shape in shapes for solid in (
        [part for part, _ in solids(shape)] if isinstance(shape, Polyline) else [shape])])


def shape_outline(shape: Solid, grow: float = 0.0, error: float = 0.0) -> Array:
    """Corners of a shape [n, 2] m, grown by ``grow``; arcs within ``error`` [m] if it is given."""
    if isinstance(shape, Capsule | Circle):
        radius = max(shape.radius + grow, 1e-9)
        ends = (shape.start, shape.end) if isinstance(shape, Capsule) else (shape.at, shape.at)
        return capsule_outline(*ends, radius, arc_steps(radius, error) if error else 16)
    if isinstance(shape, Box):
        half = np.array(shape.size) / 2 + grow
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        c, s = math.cos(shape.angle), math.sin(shape.angle)
        return np.asarray(corners @ np.array([[c, s], [-s, c]]) + np.array(shape.at))
    return polygon_grown(np.array(shape.points), grow)


def united(shapes: Sequence[Shape], changing: Container[int]) -> list[int]:
    """The convex shapes of a body that touch others of it and lie in none.

    Shapes inside others, such as hubs, keep their outline, and so do circles that a drive changes.
    """
    rings = {k: shape_outline(shape) for k, shape in enumerate(shapes)
             if k not in changing and not isinstance(shape, Polyline)
             and (not isinstance(shape, Polygon) or shape.whole)}
    outer = [k for k in rings if not any(
        _holds(rings[other], rings[k]) for other in rings
        if other != k and not (other > k and _holds(rings[k], rings[other])))]
    touching = {(a, b) for a in outer for b in outer if a != b and not (  # no side separates them
        _depths(rings[a], rings[b]).max(axis=0) < -TOUCHING).any()}
    return [a for a in outer if any({(a, b), (b, a)} <= touching for b in outer)]


def bare_outlines(shapes: Sequence[Shape], error: float, *, turns: bool) -> list[Array]:
    """Lines [n, 2] m of shapes without a fill: the outline of all of them together.

    A shape inside another one is drawn whole; circles that turn have a radius. ``error`` [m] is the
    largest distance from round lines.
    """
    rings = [shape_outline(solid, 0.0, error) for shape in shapes for solid, _ in solids(shape)]
    rings = [ring if turned_area(ring) >= 0 else ring[::-1] for ring in rings]
    found: list[Array] = []
    for i, ring in enumerate(rings):
        others = [other for other in rings[:i] + rings[i + 1:] if not _holds(other, ring)]
        open_end = False
        for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            parts = _outside(start, end, others)
            for a, b in parts:
                piece = np.array([start + a * (end - start), start + b * (end - start)])
                if open_end and a == 0.0:
                    found[-1] = np.concatenate([found[-1], piece[1:]])
                else:
                    found.append(piece)
            open_end = bool(parts) and parts[-1][1] == 1.0
    return found + [np.array([shape.at, (shape.at[0] + shape.radius, shape.at[1])])
                    for shape in shapes if turns and isinstance(shape, Circle)]


def _outside(start: Array, end: Array, rings: Sequence[Array]) -> list[XY]:
    """The parts of a side, from 0 to 1 along it, that lie in no ring and on no seam with one."""
    free = [(0.0, 1.0)]
    for ring in rings:
        at, to = _depths(ring, np.array([start, end]))
        along = np.roll(ring, -1, axis=0) - ring
        along = along[np.hypot(*along.T) > 0]
        on_it = np.maximum(np.abs(at), np.abs(to)) <= TOUCHING
        least = np.where(on_it, -np.inf, TOUCHING)
        if (on_it & (along @ (end - start) > 0)).any() or (
                (np.abs(to - at) < 1e-15) & (at < least)).any():
            continue  # a side of both, with both on the same hand; or outside of the ring
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = (least - at) / (to - at)
        low = max(0.0, float(np.max(cross[(to > at) & ~on_it], initial=0.0)))
        high = min(1.0, float(np.min(cross[(to < at) & ~on_it], initial=1.0)))
        if high > low:
            free = [part for a, b in free for part in ((a, min(b, low)), (max(a, high), b))
                    if part[1] - part[0] > 1e-9]
    return free


def _depths(ring: Array, points: Array) -> Array:
    """How deep points [n, 2] lie behind each side of a convex outline [m], [n, sides]."""
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(*side.T)
    side, start = side[length > 0] / length[length > 0, None], ring[length > 0]
    way = points[:, None] - start
    return np.asarray(np.sign(turned_area(ring)) * (
        side[:, 0] * way[..., 1] - side[:, 1] * way[..., 0]))


def _holds(ring: Array, other: Array) -> bool:
    return bool((_depths(ring, other) >= -TOUCHING).all())


def arrow(tail: XY, tip: XY, shaft: float, head: float) -> list[XY]:
    """The corners of an arrow: widths of its shaft and length of its head, at most 0.62 of all."""
    dx, dy = tip[0] - tail[0], tip[1] - tail[1]
    length = math.hypot(dx, dy) or 1e-12
    ux, uy = dx / length, dy / length
    head = min(head, 0.62 * length)
    half, wide = shaft / 2, max(shaft * 0.5, 0.45 * head)
    bx, by = tip[0] - ux * head, tip[1] - uy * head
    nx, ny = -uy, ux
    return [(tail[0] + nx * half, tail[1] + ny * half), (bx + nx * half, by + ny * half),
            (bx + nx * wide, by + ny * wide), tip, (bx - nx * wide, by - ny * wide),
            (bx - nx * half, by - ny * half), (tail[0] - nx * half, tail[1] - ny * half)]


def dashes(path: Sequence[XY], dash: float, gap: float) -> list[tuple[XY, XY]]:
    """``path`` cut into dashes; the pattern runs on through its corners."""
    pieces: list[tuple[XY, XY]] = []
    offset, period = 0.0, dash + gap
    for (x0, y0), (x1, y1) in pairwise(path):
        length = math.hypot(x1 - x0, y1 - y0)
        if length == 0.0:
            continue
        ux, uy = (x1 - x0) / length, (y1 - y0) / length
        at = -(offset % period)
        while at < length:
            a, b = max(at, 0.0), min(at + dash, length)
            if b > a:
                pieces.append(((x0 + ux * a, y0 + uy * a), (x0 + ux * b, y0 + uy * b)))
            at += period
        offset += length
    return pieces


def ribbon(path: Sequence[XY], width: float) -> list[XY]:
    """The outline of a line of constant ``width``; mitres reach at most 1.5 widths."""
    corners = path if len(path) == 2 else [
        p for k, p in enumerate(path) if not k or math.dist(p, path[k - 1]) > 1e-9]
    half = width / 2
    if len(corners) < 3:
        (x0, y0), (x1, y1) = path[0], path[-1]
        half /= math.hypot(x1 - x0, y1 - y0) or 1.0
        dx, dy = (y1 - y0) * half, (x0 - x1) * half
        return [(x0 - dx, y0 - dy), (x1 - dx, y1 - dy), (x1 + dx, y1 + dy), (x0 + dx, y0 + dy)]
    normals = []
    for (x0, y0), (x1, y1) in pairwise(corners):
        length = math.hypot(x1 - x0, y1 - y0)
        normals.append((-(y1 - y0) / length, (x1 - x0) / length))
    left, right = [], []
    for k, (x, y) in enumerate(corners):
        ax, ay = normals[max(k - 1, 0)]
        bx, by = normals[min(k, len(normals) - 1)]
        grow = half / max(1 + ax * bx + ay * by, 0.67)
        dx, dy = grow * (ax + bx), grow * (ay + by)
        left.append((x + dx, y + dy))
        right.append((x - dx, y - dy))
    return left + right[::-1]


def within(points: Sequence[XY], edges: Edges) -> bool:
    """Whether all points, none of them NaN, are within the edges."""
    left, top, right, bottom = edges
    return all(left <= x <= right and top <= y <= bottom for x, y in points)


def cut_polygon(corners: Sequence[XY], edges: Edges) -> list[XY]:
    """A polygon's corners within the edges (Sutherland and Hodgman); none if one is NaN."""
    if within(corners, edges):
        return [*corners]
    found = [(min(max(x, -FAR), FAR), min(max(y, -FAR), FAR)) for x, y in corners
             if not math.isnan(x + y)]
    if len(found) < len(corners):
        return []
    for axis, limit, sign in ((0, edges[0], 1), (1, edges[1], 1), (0, edges[2], -1),
                              (1, edges[3], -1)):
        before, found = found, []
        for k, point in enumerate(before):
            last = before[k - 1]
            inside, outside = (sign * (p[axis] - limit) >= 0 for p in (point, last))
            if inside != outside:
                w = (limit - last[axis]) / (point[axis] - last[axis])
                found.append((last[0] + w * (point[0] - last[0]),
                              last[1] + w * (point[1] - last[1])))
            if inside:
                found.append(point)
    return found


def cut_line(start: XY, end: XY, edges: Edges) -> tuple[XY, XY] | None:
    """The piece of a line within the edges; None if there is none."""
    found = cut_polygon((start, end), edges)
    sx, sy = (math.copysign(1.0, b - a) for a, b in zip(start, end, strict=True))
    found.sort(key=lambda at: sx * at[0] + sy * at[1])
    return (found[0], found[-1]) if found else None


def large_circle(centre: XY, radius: float, edges: Edges) -> list[XY]:
    """The visible part of a far larger circle as a polygon: nothing, all or a piece.

    The arc is measured from its point nearest to the picture, which keeps digits.
    """
    if math.isnan(centre[0] + centre[1] + radius):
        return []
    left, top, right, bottom = edges
    reach, middle = math.hypot(right - left, bottom - top) / 2, np.array(
        [(left + right) / 2, (top + bottom) / 2])
    way, radius = middle - np.clip(centre, -FAR, FAR), min(radius, FAR)
    distance = math.hypot(*way)
    if distance - radius > reach:
        return []
    if radius - distance > reach:
        return [(left, top), (right, top), (right, bottom), (left, bottom)]
    out = way / distance
    angle = math.asin(min(1.0, reach / distance)) * np.linspace(-1.0, 1.0, 129)
    arc = middle + np.outer(radius - distance - 2 * radius * np.sin(angle / 2) ** 2, out) \
        + np.outer(radius * np.sin(angle), (-out[1], out[0]))
    return [(x, y) for x, y in np.concatenate([arc, arc[[-1, 0]] - 4 * reach * out]).tolist()]
