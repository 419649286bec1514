"""Outlines, paths and points as plain arrays [m] or [pixels]; what reaches far is cut.

pygame walks every pixel of a shape, also outside of the picture, and takes no numbers beyond those
of a C int. Coordinates that are not finite are dropped here, for all painters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sandbox.numeric import Array
from sandbox.scene.bodies import Box, Capsule, Circle, Polyline, Shape, Solid
from sandbox.scene.geometry import solids

XY = tuple[float, float]


def arc_steps(radius: float, error: float) -> int:
    """Sides that show half a circle no further than ``error`` from its true line."""
    return max(4, math.ceil(math.pi / (2 * math.acos(max(0.0, 1 - error / radius)))))


def capsule_outline(start: XY, end: XY, radius: float, steps: int = 16) -> Array:
    """Corners of a capsule, counter-clockwise, [2 * (steps + 1), 2]."""
    along = math.atan2(end[1] - start[1], end[0] - start[0])
    far = along + np.linspace(-math.pi / 2, math.pi / 2, steps + 1)
    near = far + math.pi
    arc = [np.column_stack((np.cos(a), np.sin(a))) * radius for a in (far, near)]
    return np.concatenate((np.asarray(end) + arc[0], np.asarray(start) + arc[1]))


def polygon_grown(corners: Array, by: float) -> Array:
    """An outline [n, 2], each side moved outwards ``by`` (inwards when negative)."""
    x, y = corners.T
    if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) < 0:
        corners = corners[::-1]
    side = np.roll(corners, -1, axis=0) - corners
    normal = np.column_stack((side[:, 1], -side[:, 0])) / np.hypot(*side.T)[:, None]
    before = np.roll(normal, 1, axis=0)
    cosine = np.maximum((normal * before).sum(axis=1), -0.75)
    return np.asarray(corners + by * (normal + before) / (1 + cosine)[:, None])


def shape_points(shape: Shape, grow: float = 0.0) -> Array:
    """Points between which a shape lies, in its body's frame [n, 2] m, grown by ``grow``."""
    if isinstance(shape, Polyline):
        return np.concatenate([shape_outline(solid, grow) for solid, _ in solids(shape)])
    return shape_outline(shape, grow)


def shape_outline(shape: Solid, grow: float = 0.0, error: float = 0.0) -> Array:
    """Corners of a shape in its body's frame [n, 2] m, grown outwards by ``grow``.

    Arcs stay within ``error`` [m] of their true line where it is given.
    """
    if isinstance(shape, Capsule | Circle):
        radius = max(shape.radius + grow, 1e-9)
        ends = ((shape.start, shape.end) if isinstance(shape, Capsule)
                else (shape.at, shape.at))
        return capsule_outline(*ends, radius, arc_steps(radius, error) if error else 16)
    if isinstance(shape, Box):
        half = np.array(shape.size) / 2 + grow
        corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * half
        c, s = math.cos(shape.angle), math.sin(shape.angle)
        return np.asarray(corners @ np.array([[c, s], [-s, c]]) + np.array(shape.at))
    return polygon_grown(np.array(shape.points), grow)


def arrow(tail: XY, tip: XY, shaft: float, head: float) -> list[XY]:
    """The seven corners of an arrow whose point lies at ``tip``.

    ``shaft`` is the shaft's width and ``head`` the head's length, which shrinks
    for an arrow shorter than 1.6 heads.
    """
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


def dashes(path: list[XY], dash: float, gap: float) -> list[tuple[XY, XY]]:
    """``path`` cut into dashes; the pattern runs on through its corners."""
    pieces: list[tuple[XY, XY]] = []
    offset = 0.0
    period = dash + gap
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


def _bar(start: XY, end: XY, width: float) -> list[XY]:
    """The outline of one straight line."""
    (x0, y0), (x1, y1) = start, end
    half = width / 2 / (math.hypot(x1 - x0, y1 - y0) or 1.0)
    dx, dy = (y1 - y0) * half, (x0 - x1) * half
    return [(x0 - dx, y0 - dy), (x1 - dx, y1 - dy), (x1 + dx, y1 + dy), (x0 + dx, y0 + dy)]


def ribbon(path: Sequence[XY], width: float) -> list[XY]:
    """The outline of a line of even ``width`` along ``path``, mitred at its corners.

    Mitres reach at most 1.5 widths; points that repeat are skipped.
    """
    if len(path) == 2:
        return _bar(path[0], path[1], width)
    corners = [p for k, p in enumerate(path) if not k or math.dist(p, path[k - 1]) > 1e-9]
    if len(corners) < 3:
        return _bar(path[0], path[-1], width)
    half = width / 2
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


Edges = tuple[float, float, float, float]
"""Left, top, right, bottom [pixels]."""
FAR = 1e12
"""Coordinates beyond this are moved there [pixels]."""
ARC = 128
"""Sides of the visible piece of a very large circle."""


def within(points: Sequence[XY], edges: Edges) -> bool:
    """Whether all points are within the edges; NaN is not."""
    left, top, right, bottom = edges
    return all(left <= x <= right and top <= y <= bottom for x, y in points)


def _held(points: Sequence[XY]) -> list[XY]:
    """The points within :data:`FAR`; none if one of them is NaN."""
    if any(math.isnan(x) or math.isnan(y) for x, y in points):
        return []
    return [(min(max(x, -FAR), FAR), min(max(y, -FAR), FAR)) for x, y in points]


def cut_polygon(corners: Sequence[XY], edges: Edges) -> list[XY]:
    """A polygon's corners within the edges (Sutherland and Hodgman)."""
    found = _held(corners)
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
    """The piece of a line within the edges (Liang and Barsky); None if there is none."""
    ends = _held((start, end))
    if not ends:
        return None
    (x, y), (dx, dy) = ends[0], (ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
    first, last = 0.0, 1.0
    for step, room in ((-dx, x - edges[0]), (-dy, y - edges[1]), (dx, edges[2] - x),
                       (dy, edges[3] - y)):
        if step == 0:
            if room < 0:
                return None
        elif step < 0:
            first = max(first, room / step)
        else:
            last = min(last, room / step)
    if first > last:
        return None
    return (x + first * dx, y + first * dy), (x + last * dx, y + last * dy)


def large_circle(centre: XY, radius: float, edges: Edges) -> list[XY]:
    """What the edges show of a circle that is far larger, as a polygon: nothing, all or a piece.

    The arc is measured from its point nearest to the picture: differences of numbers as large as
    the radius would have no digits left.
    """
    left, top, right, bottom = edges
    reach = math.hypot(right - left, bottom - top) / 2
    middle = (left + right) / 2, (top + bottom) / 2
    held = _held([centre])
    if not held or math.isnan(radius):
        return []
    radius = min(radius, FAR)
    x, y = middle[0] - held[0][0], middle[1] - held[0][1]
    distance = math.hypot(x, y)
    if distance - radius > reach:
        return []
    if radius - distance > reach:
        return [(left, top), (right, top), (right, bottom), (left, bottom)]
    ux, uy = x / distance, y / distance
    half = math.asin(min(1.0, reach / distance))
    arc = []
    for k in range(ARC + 1):
        angle = half * (2 * k / ARC - 1)
        out = radius - distance - 2 * radius * math.sin(angle / 2) ** 2
        along = radius * math.sin(angle)
        arc.append((middle[0] + out * ux - along * uy, middle[1] + out * uy + along * ux))
    deep = [(px - 4 * reach * ux, py - 4 * reach * uy) for px, py in (arc[-1], arc[0])]
    return [*arc, *deep]




class PointPool:
    """Points in body frames; each drawer adds its own and gets back where they are kept."""

    def __init__(self) -> None:
        self._bodies: list[NDArray[np.intp]] = []
        self._points: list[Array] = []
        self._count = 0

    def add(self, body: int, points: Array | list[XY]) -> slice:
        """Keep ``points`` [n, 2] m of ``body``; the slice finds them in :meth:`world`."""
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        self._bodies.append(np.full(len(points), body, dtype=np.intp))
        self._points.append(points)
        self._count += len(points)
        return slice(self._count - len(points), self._count)

    def close(self) -> None:
        """Join what was added; nothing may be added later."""
        sizes = [len(points) for points in self._points if len(points)]
        self._starts = np.cumsum([0, *sizes[:-1]]) if sizes else np.zeros(0, np.intp)
        self._body = np.concatenate([np.zeros(0, np.intp), *self._bodies])
        self._local = np.concatenate([np.zeros((0, 2)), *self._points])

    def world(self, pose: Array) -> Array:
        """All points [n, 2] m for ``pose`` [nb, 3] (x, y, angle), or [s, n, 2] for [s, nb, 3]."""
        c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
        at = pose[..., self._body, :]
        c, s = c[..., self._body], s[..., self._body]
        x, y = self._local.T
        return np.stack((at[..., 0] + c * x - s * y, at[..., 1] + s * x + c * y), axis=-1)

    def place(self, number: int) -> tuple[int, XY]:
        """The body of a pooled point, and the point in its frame [m]."""
        x, y = self._local[number].tolist()
        return int(self._body[number]), (x, y)

    def boxes(self, pixels: Array) -> Array:
        """Left, top, right and bottom [k, 4] of every set of points that was added together."""
        if not len(self._starts):
            return np.zeros((0, 4))
        return np.hstack((np.minimum.reduceat(pixels, self._starts, axis=0),
                          np.maximum.reduceat(pixels, self._starts, axis=0)))


def moved(point: XY, pose: tuple[float, float, float]) -> XY:
    """A point of a body's frame in the world [m]."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return (float(pose[0] + c * point[0] - s * point[1]),
            float(pose[1] + s * point[0] + c * point[1]))
