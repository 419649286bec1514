"""Names of bodies, each on or beside its own body and never nearer to another one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.draw.film.canvas import XY, Canvas, Label, Moment, Spots
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.joints import joined_points
from sandbox.draw.film.palette import FAINT_INK
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.wheels import wheel_pictures
from sandbox.numeric import Array

PLACES = 16
"""Of a body's outline so many points are looked at for room beside them, more or less."""
GAP = 3.0
"""Between a name and the outline beside which it stands [points]."""
CLEAR = 2.0
"""A name is nearer to its own body than to any other by so much at least [points]."""
STEP = 4.0
"""Outlines are measured at points that lie no farther apart [points]."""
MOST = 4000
"""Points at which an outline is measured, at most."""


def outlines(run: Filmed) -> list[list[Array]]:
    """Of each body the closed outlines of its shapes and wheels, in its frame [n, 2] m.

    Of one that has neither, its anchors, each as a point.
    """
    found = [[shape_points(shape) for shape in body.shapes] for body in run.mechanism.bodies]
    for i, wheels in wheel_pictures(run.model).items():
        found[i] += [(wheel.outline if wheel.rim is None else wheel.rim) + wheel.centre
                     for wheel in wheels]
    for i, points in joined_points(run.model).items():
        if not found[i]:
            found[i] = [np.asarray(point, dtype=float).reshape(1, 2) for point in points]
    return found


class NameDrawer:
    """Names of bodies, beside or on them."""

    def __init__(self, run: Filmed, bodies: list[int]) -> None:
        self._names = [(run.mechanism.bodies[body].name, body) for body in bodies]
        self._pool, self._where = PointPool(), list[list[slice]]()
        self._centre = list[int]()
        for i, closed in enumerate(outlines(run) if bodies else ()):
            self._centre.append(self._pool.add(i, run.arrays["body_centre"][i]).start)
            self._where.append([self._pool.add(i, each) for each in closed])
        self._pool.close()

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """Where there is room, farther off on a line."""
        if not self._names:
            return
        pixels = canvas.camera.to_pixels(self._pool.world(moment.pose)) / canvas.enlarged
        unit = canvas.unit / canvas.enlarged
        seen = [_Silhouette([pixels[where] for where in closed], unit) for closed in self._where]
        for name, body in self._names:
            others = [other for k, other in enumerate(seen) if k != body]
            centre = pixels[self._centre[body]]
            near = [centre, *seen[body].places] if seen[body].has(centre) else (
                seen[body].places or [centre])
            x, y = max(near, key=lambda at: _least(others, at, 0.0, 0.0) - (at is not centre))
            canvas.labels.append(Label(
                name, _beside(seen[body], others, near, unit), FAINT_INK,
                at=(float(x), float(y)), alone=True))


class _Silhouette:
    """Outlines of a body on the finished picture [pixels]."""

    def __init__(self, closed: list[Array], unit: float) -> None:
        self._closed = [each for each in closed if np.isfinite(each).all()]
        self._points = np.concatenate([np.zeros((0, 2)), *(
            _fine(each, STEP * unit) for each in self._closed)])
        every = np.concatenate([np.zeros((0, 2)), *self._closed])
        self.box: list[float] = [*every.min(axis=0, initial=np.inf).tolist(),
                                 *every.max(axis=0, initial=-np.inf).tolist()]
        self.places: list[Array] = list(every[::max(1, len(every) // PLACES)])

    def has(self, at: Array) -> bool:
        """Whether a point lies within any of the outlines."""
        return any(_within(each, at) for each in self._closed)

    def distance(self, at: Array, half_x: float, half_y: float) -> float:
        """From a text with its middle there, of half this width and height; 0 where it is on it."""
        if self.has(at):
            return 0.0
        if not len(self._points):
            return float("inf")
        away = np.maximum(np.abs(self._points - at) - (half_x, half_y), 0.0)
        return float(np.hypot(*away.T).min())


def _fine(closed: Array, step: float) -> Array:
    """Points along a closed outline, no farther apart than ``step``."""
    if len(closed) < 2:
        return closed
    after = np.roll(closed, -1, axis=0)
    count = np.ceil(np.hypot(*(after - closed).T) / step)
    count = np.clip(count, 1, max(1, MOST // len(closed))).astype(int)
    return np.concatenate([
        a + (b - a) * (np.arange(n) / n)[:, None]
        for a, b, n in zip(closed, after, count.tolist(), strict=True)])


def _within(closed: Array, at: Array) -> bool:
    """Whether a point is within a closed outline, by how often a ray to the right crosses it."""
    if len(closed) < 3:
        return False
    (x0, y0), (x1, y1) = closed.T, np.roll(closed, -1, axis=0).T
    crosses = (y0 > at[1]) != (y1 > at[1])
    rise = np.where(crosses, y1 - y0, 1.0)
    return bool(np.count_nonzero(crosses & (at[0] < x0 + (at[1] - y0) / rise * (x1 - x0))) % 2)


def _least(others: list[_Silhouette], at: Array, half_x: float, half_y: float,
           most: float = float("inf")) -> float:
    """The distance to the nearest of others, or ``most``; those farther off are not measured."""
    x, y = at.tolist()
    for other in others:
        left, low, right, high = other.box
        aside = max(left - x - half_x, x - half_x - right, 0.0)
        off = max(low - y - half_y, y - half_y - high, 0.0)
        if aside < most and off < most:
            most = min(most, other.distance(at, half_x, half_y))
    return most


def _beside(own: _Silhouette, others: list[_Silhouette], places: list[Array], unit: float) -> Spots:
    """Middles for a text, on or about ``places`` of a body, nearer to it than to all others."""
    def spots(half_x: float, half_y: float) -> Iterator[XY]:
        aside, off = half_x + GAP * unit, half_y + GAP * unit
        for at in places:
            for dx, dy in ((0, -off), (0, off), (aside, 0), (-aside, 0), (0, 0),
                           (aside, -off), (-aside, -off), (aside, off), (-aside, off)):
                middle = at + np.array((dx, dy))
                far = own.distance(middle, half_x, half_y)
                limit = far + CLEAR * unit
                if _least(others, middle, half_x, half_y, limit) >= limit:
                    yield float(middle[0]), float(middle[1])

    return spots
