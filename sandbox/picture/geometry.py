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

COIL_TURNS = 5
_FRACTIONS = np.linspace(0, 1, 30)


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


def tangent(c1: XY, r1: float, s1: int, c2: XY, r2: float, s2: int) -> tuple[XY, XY] | None:
    """Where a straight cord from wheel 1 to wheel 2 leaves and arrives.

    With u the direction of the cord and n its left normal, the points are
    ``c + s r n``; s is +1 for a wheel whose centre lies right of the path, -1
    for one left of it, and n . (c2 - c1) = s1 r1 - s2 r2. None where no such
    line exists: one wheel within the other.
    """
    dx, dy = c2[0] - c1[0], c2[1] - c1[1]
    distance = math.hypot(dx, dy)
    offset = s1 * r1 - s2 * r2
    if distance <= abs(offset) or distance == 0.0:
        return None
    m = offset / distance
    k = math.sqrt(1 - m * m)
    ex, ey = dx / distance, dy / distance
    nx, ny = m * ex - k * ey, m * ey + k * ex
    return ((c1[0] + s1 * r1 * nx, c1[1] + s1 * r1 * ny),
            (c2[0] + s2 * r2 * nx, c2[1] + s2 * r2 * ny))


def _fine(radius: float) -> float:
    """Angle [rad] between corners a tenth of a pixel or less off an arc of a radius in pixels."""
    return min(0.2, 2 * math.sqrt(0.2 / max(radius, 1e-9)))


def wheel_arc(centre: XY, radius: float, sense: int, arrive: XY, leave: XY, *,
              around: bool = False) -> list[XY]:
    """Corners of the cord on a wheel between two tangent points, ends left out.

    ``sense`` is +1 for a wheel right of the path (walked clockwise), -1 left; ``around`` of a cord
    that goes all around it as well.
    """
    a = math.atan2(arrive[1] - centre[1], arrive[0] - centre[0])
    b = math.atan2(leave[1] - centre[1], leave[0] - centre[0])
    sweep = (sense * (a - b)) % math.tau
    if sweep > math.tau - 1e-6:
        sweep = 0.0
    sweep += math.tau if around else 0.0
    steps = max(1, math.ceil(sweep / _fine(radius)))
    angles = [a - sense * sweep * k / steps for k in range(1, steps)]
    return [(centre[0] + radius * math.cos(q), centre[1] + radius * math.sin(q)) for q in angles]


def cord_path(centres: list[XY], radii: list[float], senses: list[int],
              wound: float = 0.0, *, closed: bool = False) -> list[XY]:
    """The cord over all wheels as a polyline; a radius of 0 is a plain point.

    At an end with a radius the cord is wound on: it ends at its tangent point,
    or ``wound`` [rad] further round the wheel. The last guide of a ``closed`` one is
    its first.
    """
    path: list[XY] = []
    for piece in cord_pieces(centres, radii, senses, wound, closed=closed):
        path += piece[1:] if path and path[-1] == piece[0] else piece
    return path


def cord_pieces(centres: list[XY], radii: list[float], senses: list[int],
                wound: float = 0.0, *, closed: bool = False, around: Sequence[int] = (),
                ) -> list[list[XY]]:
    """The same, straight piece by straight piece, each with half of its arcs on wheels.

    Of wheels that it goes all ``around`` arcs have a whole turn more.
    """
    pieces: list[list[XY]] = []
    for i in range(len(centres) - 1):
        j = i + 1
        line = tangent(centres[i], radii[i], senses[i], centres[j], radii[j], senses[j])
        leave, arrive = line if line is not None else (centres[i], centres[j])
        if i and radii[i] > 0:
            arc = wheel_arc(centres[i], radii[i], senses[i], pieces[-1][-1], leave,
                            around=i in around)
            pieces[-1] += arc[:len(arc) // 2 + 1]
            pieces.append([*arc[len(arc) // 2:], leave, arrive])
        else:
            pieces.append([leave, arrive])
    if closed and radii[0] > 0:
        arc = wheel_arc(centres[0], radii[0], senses[0], pieces[-1][-1], pieces[0][0],
                        around=0 in around)
        pieces[-1] += arc[:len(arc) // 2 + 1]
        pieces[0] = [*arc[len(arc) // 2:], *pieces[0]]
    if wound and radii[0] > 0 and not closed:
        pieces[0] = wound_on(centres[0], pieces[0][0], senses[0] * wound)[::-1] + pieces[0]
    if wound and radii[-1] > 0 and not closed:
        pieces[-1] += wound_on(centres[-1], pieces[-1][-1], -senses[-1] * wound)
    return pieces


def wound_on(centre: XY, start: XY, sweep: float) -> list[XY]:
    """Corners of an arc about ``centre`` that goes on from ``start`` through ``sweep`` [rad]."""
    x, y = start[0] - centre[0], start[1] - centre[1]
    steps = max(1, math.ceil(abs(sweep) / _fine(math.hypot(x, y))))
    angles = [sweep * k / steps for k in range(1, steps + 1)]
    return [(centre[0] + x * math.cos(q) - y * math.sin(q),
             centre[1] + x * math.sin(q) + y * math.cos(q)) for q in angles]


def coil_template() -> Array:
    """A zig-zag along (0, 0) to (1, 0): column 0 the fraction of the length, column 1 the side."""
    ends = 0.16
    steps = 2 * COIL_TURNS
    along = ends + (1 - 2 * ends) * (np.arange(steps) + 0.5) / steps
    side = np.where(np.arange(steps) % 2 == 0, 1.0, -1.0)
    inner = np.column_stack((along, side))
    return np.vstack((np.array([[0, 0], [ends, 0]]), inner, np.array([[1 - ends, 0], [1, 0]])))


def along_lines(template: Array, start: Array, end: Array, width: Array) -> Array:
    """``template`` [m, 2] laid from ``start`` to ``end`` [n, 2]: [n, m, 2].

    Column 0 of the template counts in lengths of the line, column 1 in ``width`` [n].
    """
    d = end - start
    length = np.maximum(np.hypot(d[:, 0], d[:, 1]), 1e-12)
    normal = np.column_stack((-d[:, 1], d[:, 0])) / length[:, None]
    return np.asarray(start[:, None] + template[None, :, :1] * d[:, None]
                      + width[:, None, None] * template[None, :, 1:] * normal[:, None])


def spiral(sweep: float, start: float, inner: float, outer: float) -> Array:
    """A spiral about (0, 0) from ``inner`` to ``outer`` radius through ``sweep`` [rad]."""
    angle = start + sweep * _FRACTIONS
    radius = inner + (outer - inner) * _FRACTIONS
    return np.column_stack((radius * np.cos(angle), radius * np.sin(angle)))


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


def sagging(start: XY, end: XY, length: float, steps: int = 12) -> list[XY]:
    """A slack rope of ``length`` between two points (y down), as a parabola.

    The depth follows from the arc length of a flat parabola,
    length = span (1 + 8/3 (depth / span)^2), held below half the rope.
    """
    span = math.hypot(end[0] - start[0], end[1] - start[1])
    depth = math.sqrt(max(length - span, 0.0) * span * 3 / 8) if span > 0 else length / 2
    depth = min(depth, length / 2)
    points = []
    for k in range(steps + 1):
        s = k / steps
        points.append((start[0] + s * (end[0] - start[0]),
                       start[1] + s * (end[1] - start[1]) + 4 * depth * s * (1 - s)))
    return points


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
