"""Outlines and paths as plain arrays [m] or [pixels]; nothing here draws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.elements.bodies import Box, Capsule, Circle, Polyline, Shape, Solid
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
