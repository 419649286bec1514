"""Surfaces that run: small marks that go along the outline of their body."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.geometry import shape_points
from sandbox.draw.film.palette import BACKGROUND, DRIVE
from sandbox.numeric import Array

APART = 34.0
"""Distance of marks along the outline [units of the canvas], more or less: they fit round it."""
SIZE = 6.0
"""Length of a mark and half its width [units of the canvas]."""


@dataclass(frozen=True)
class _Outline:
    """One shape of a body that runs."""

    drive: int
    body: int
    corners: Array
    """In the body's frame, closed, [n + 1, 2] m."""
    along: Array
    """Way from the first corner to each [m], [n + 1]."""


class BeltDrawer:
    """Draws the marks of all surfaces that run, at where they have come to."""

    def __init__(self, run: Filmed) -> None:
        drives, values, time = run.model.drives, run.arrays["drive_value"], run.time
        steps = np.diff(time, prepend=0.0)[:, None]
        self._time = time
        self._speed = np.nan_to_num(drives.sense) * values
        self._way = np.cumsum(steps * self._speed, axis=0)
        """Counter-clockwise [m], [n, nd]."""
        self._outlines = []
        for drive in drives.giving("surface").tolist():
            body = int(drives.target[drive])
            for shape in run.mechanism.bodies[body].shapes:
                points = shape_points(shape)
                corners = np.vstack([points, points[:1]])
                along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))])
                self._outlines.append(_Outline(drive, body, corners, along))

    def _gone(self, moment: Moment, drive: int) -> float:
        """How far a surface has run until a moment [m], counter-clockwise."""
        late = moment.time - float(self._time[moment.sample])
        return float(self._way[moment.sample, drive] + late * self._speed[moment.sample, drive])

    def key(self, moment: Moment) -> bytes:
        """Equal for moments at which all marks are at the same places."""
        return b"".join(np.float64(self._gone(moment, one.drive)).tobytes()
                        for one in self._outlines)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All marks; they point the way that the surface runs."""
        for one in self._outlines:
            whole = float(one.along[-1])
            count = max(3, round(whole * canvas.camera.scale / (APART * canvas.unit)))
            at = (self._gone(moment, one.drive) + whole / count * np.arange(count)) % whole
            side = np.clip(np.searchsorted(one.along, at, side="right") - 1, 0,
                           len(one.corners) - 2)
            step = one.corners[side + 1] - one.corners[side]
            step = step / np.maximum(np.hypot(*step.T), 1e-12)[:, None]
            place = one.corners[side] + (at - one.along[side])[:, None] * step
            x, y, angle = moment.pose[one.body]
            c, s = np.cos(angle), np.sin(angle)
            turn = np.array([[c, s], [-s, c]])
            pixels = canvas.camera.to_pixels(place @ turn + (x, y))
            ways = step @ turn * (1.0, -1.0)
            sign = -1.0 if self._speed[moment.sample, one.drive] < 0 else 1.0
            for spot, way in zip(pixels, ways, strict=True):
                _mark(canvas, spot, sign * way, sign)


def _mark(canvas: Canvas, at: Array, way: Array, inward: float) -> None:
    """An arrow head on the inner side of the outline; ``way`` is a direction in pixels."""
    size = SIZE * canvas.unit
    inside = inward * np.array([way[1], -way[0]]) * size  # left of the way round, y down
    middle = at + 0.75 * inside
    corners = [middle + size * way, middle - 0.6 * size * way + 0.7 * inside,
               middle - 0.6 * size * way - 0.7 * inside]
    spots = [(float(corner[0]), float(corner[1])) for corner in corners]
    clip.polygon(canvas.surface, DRIVE, spots)
    clip.lines(canvas.surface, BACKGROUND, spots, canvas.width(0.6), closed=True)
    canvas.touch((float(at[0]), float(at[1])), 2.5 * SIZE)


def belt_symbol(canvas: Canvas, x: float, y: float, width: float) -> None:
    """A mark for the legend."""
    _mark(canvas, np.array([x + width / 2, y - 0.75 * SIZE * canvas.unit]), np.array([1.0, 0.0]),
          -1.0)
