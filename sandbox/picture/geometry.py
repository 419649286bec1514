"""Outlines, paths and points as plain arrays [m] or [pixels], cut to a picture.

pygame walks every pixel of a shape, also outside of the picture, and takes only numbers of a C int.
"""

from __future__ import annotations

import math
from collections.abc import Container, Sequence
from itertools import pairwise

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.bodies import Capsule, Circle, Polygon, Polyline, Shape, Solid
from sandbox.scene.geometry import corners, solids

XY = tuple[float, float]
Edges = tuple[float, float, float, float]  # left, top, right, bottom [pixels]
MAX_COORDINATE = 1e12  # coordinates beyond this are moved there [pixels]
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
    return polygon_grown(np.array(corners(shape)), grow)


def united(shapes: Sequence[Shape], changing: Container[int]) -> list[int]:
    """The convex shapes of a body that lie in no other of them, if there are several."""
    rings = {k: shape_outline(shape) for k, shape in enumerate(shapes)
             if k not in changing and not isinstance(shape, Polyline)
             and (not isinstance(shape, Polygon) or shape.whole)}
    outer = [k for k in rings if not any(
        holds(rings[other], rings[k]) for other in rings
        if other != k and not (other > k and holds(rings[k], rings[other])))]
    return outer if len(outer) > 1 else []


def holds(ring: Array, other: Array) -> bool:
    """Whether all points [n, 2] lie behind each side of a convex outline."""
    side = np.roll(ring, -1, axis=0) - ring
    side, start = side[side.any(axis=1)], ring[side.any(axis=1)]
    way = other[:, None] - start
    depth = (side[:, 0] * way[..., 1] - side[:, 1] * way[..., 0]) / np.hypot(*side.T)
    return bool((np.sign(turned_area(ring)) * depth >= -TOUCHING).all())


def arrow(tail: XY, tip: XY, shaft: float, head: float) -> list[XY]:
    """The corners of an arrow: widths of its shaft and length of its head, at most 0.62 of all."""
    start, end = complex(*tail), complex(*tip)
    length = abs(end - start) or 1e-12
    way, head = (end - start) / length, min(head, 0.62 * length)
    neck, half = end - head * way, shaft / 2
    sides = [(start, half), (neck, half), (neck, max(half, 0.45 * head)), (end, 0.0)]
    corners = [*(at + 1j * wide * way for at, wide in sides),
               *(at - 1j * wide * way for at, wide in sides[-2::-1])]
    return [(z.real, z.imag) for z in corners]


def dashes(path: Sequence[XY], dash: float, gap: float) -> list[list[XY]]:
    """``path`` cut into dashes; the pattern runs on through its corners."""
    pieces: list[list[XY]] = []
    offset, period = 0.0, dash + gap
    for start, end in pairwise(complex(*at) for at in path):
        length = abs(end - start)
        for at in np.arange(-(offset % period), length, period).tolist():
            ends = [start + (end - start) * far / length
                    for far in (max(at, 0.0), min(at + dash, length))]
            if at + dash > 0:
                pieces.append([(z.real, z.imag) for z in ends])
        offset += length
    return pieces


def thick_line(start: XY, end: XY, width: float) -> list[XY]:
    """The corners of a straight line of some ``width``."""
    a, b = complex(*start), complex(*end)
    side = 0.5j * width * (b - a) / (abs(b - a) or 1.0)
    return [(z.real, z.imag) for z in (a + side, b + side, b - side, a - side)]


def within(points: Sequence[XY], edges: Edges) -> bool:
    """Whether all points, none of them NaN, are within the edges."""
    left, top, right, bottom = edges
    return all(left <= x <= right and top <= y <= bottom for x, y in points)


def cut_polygon(corners: Sequence[XY], edges: Edges) -> list[XY]:
    """A polygon's corners within the edges (Sutherland and Hodgman); none if one is NaN."""
    if within(corners, edges):
        return [*corners]
    if np.isnan(corners).any():
        return []
    found: list[XY] = np.clip(corners, -MAX_COORDINATE, MAX_COORDINATE).tolist()
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
    """The visible part of a far larger circle as a polygon; none if a number is NaN."""
    left, top, right, bottom = edges
    x, y = np.clip(centre, -MAX_COORDINATE, MAX_COORDINATE).tolist()
    way = (left + right) / 2 - x, (top + bottom) / 2 - y
    reach, distance = math.hypot(right - left, bottom - top) / 2, math.hypot(*way)
    spread = math.asin(reach / distance) if distance > reach else math.pi
    angle = math.atan2(way[1], way[0]) + spread * np.linspace(-1.0, 1.0, 129)
    size = min(radius, MAX_COORDINATE)
    return cut_polygon([(x, y), *zip((x + size * np.cos(angle)).tolist(),
                                     (y + size * np.sin(angle)).tolist(), strict=True)], edges)
