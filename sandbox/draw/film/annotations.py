"""What is written and drawn beside things on wish: frames, a grid, bars."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.bars import PinnedBar
from sandbox.draw.film.camera import round_length
from sandbox.draw.film.canvas import Canvas, Label, Moment, Spots, spots_at
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.joints import SHORT, TELLING
from sandbox.draw.film.links import bar_busy, bar_spots
from sandbox.draw.film.palette import AXES, FAINT_INK, HAIRLINE, PIN_RING, tension_colour
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import number
from sandbox.draw.film.tensions import Tensions

XY = tuple[float, float]
AXIS = 26.0
"""Length of an axis [points]."""
PITCH = 70.0
"""Lines of the grid are at least this far apart [points]."""
MOST_LINES = 200
FAR = 1e9
"""So many lines from the origin, and farther, there are none."""
BAND = 5.4
"""Width of a bar's band [points]."""


class AxesDrawer:
    """Draws x and y of bodies' frames."""

    def __init__(self, bodies: Sequence[int], pool: PointPool) -> None:
        self._frames = [pool.add(body, [(0.0, 0.0), (1e-3, 0.0)]).start for body in bodies]

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All of them, with the axes' names."""
        length = AXIS * canvas.unit
        for frame in self._frames:
            at = moment.points[frame]
            # from the world: a millimetre may be less than a pixel's digits show
            x, y = (moment.world[frame + 1] - moment.world[frame]).tolist()
            size = math.hypot(x, y) or 1.0
            for name, (dx, dy) in (("x", (x / size, -y / size)), ("y", (-y / size, -x / size))):
                tip = (at[0] + length * dx, at[1] + length * dy)
                canvas.touch_path((at, tip), 7)
                clip.polygon(canvas.surface, AXES, arrow(
                    at, tip, 1.3 * canvas.unit, 7 * canvas.unit))
                far = tuple((tip[k] + 7 * canvas.unit * (dx, dy)[k]) / canvas.enlarged
                            for k in (0, 1))
                canvas.labels.append(Label(name, spots_at((far[0], far[1])), AXES))


class GridDrawer:
    """Draws lines of equal x and of equal y, with their numbers at the left and below."""

    def __init__(self, canvas: Canvas) -> None:
        # the largest round length below twice and a half the least pitch is never less than that
        self._step = round_length(min(2.5 * PITCH * canvas.unit / canvas.camera.scale, 1e300))
        self._unit, self._factor = ("m", 1.0) if self._step >= 0.1 else ("mm", 1e3)

    def _lines(self, canvas: Canvas, stage: pygame.Rect) -> Iterator[tuple[int, int, bool, float]]:
        """Axis, number of steps from 0, whether it is the last one, place [finished pixels]."""
        k = canvas.enlarged
        (x0, y1), (x1, y0) = canvas.camera.to_world(np.array(
            [(stage.left * k, stage.top * k), (stage.right * k, stage.bottom * k)])).tolist()
        for axis, low, high in ((0, x0, x1), (1, y0, y1)):
            if not abs(low) + abs(high) < FAR * self._step:
                continue
            first, last = math.ceil(low / self._step), math.floor(high / self._step)
            for n in range(first, min(last, first + MOST_LINES) + 1):
                at = canvas.camera.to_pixels(np.array([n * self._step] * 2))
                yield axis, n, n == last, float(at[axis]) / k

    def draw(self, canvas: Canvas, stage: pygame.Rect) -> None:
        """The lines, on a ``stage`` of the finished picture."""
        k = canvas.enlarged
        for axis, n, _, at in self._lines(canvas, stage):
            start, end = ((at, stage.top), (at, stage.bottom)) if axis == 0 else (
                (stage.left, at), (stage.right, at))
            clip.line(canvas.surface, HAIRLINE, (start[0] * k, start[1] * k),
                      (end[0] * k, end[1] * k), canvas.width(1.8 if n == 0 else 0.9))

    def write(self, canvas: Canvas, stage: pygame.Rect) -> None:
        """Their numbers, with the unit at the last of either axis."""
        unit = canvas.unit / canvas.enlarged
        for axis, n, is_last, at in self._lines(canvas, stage):
            word = f"{n * self._step * self._factor:.6g}{' ' + self._unit if is_last else ''}"
            canvas.labels.append(Label(word, _at_edge(stage, axis, at, unit), FAINT_INK))


def _at_edge(stage: pygame.Rect, axis: int, at: float, unit: float) -> Spots:
    """Where the number of a line stands: below or left of the picture, on it or beside it."""
    def spots(half_x: float, half_y: float) -> list[XY]:
        aside, off = half_x + 5 * unit, half_y + 2 * unit
        if axis == 0:
            return [(at, stage.bottom - off), (at - aside, stage.bottom - off)]
        return [(stage.left + aside, at), (stage.left + aside, at - off)]

    return spots


class BarDrawer:
    """Draws a band from pin to pin of bodies, in the colour of what they carry."""

    def __init__(self, bars: Sequence[PinnedBar], carried: Tensions, pool: PointPool) -> None:
        self._carried = carried
        self._ends = [pool.add(bar.body, list(bar.ends)).start for bar in bars]

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The bands; of a few the tensions too, negative where they push."""
        carried = self._carried
        told = 0 < len(self._ends) <= TELLING and carried.largest > 0
        for k, place in enumerate(self._ends):
            tension = float(carried.bars[moment.sample, k])
            a, b = moment.points[place], moment.points[place + 1]
            canvas.polyline(PIN_RING, (a, b), BAND)
            canvas.polyline(tension_colour(carried.level(tension)), (a, b), BAND - 1.8)
            if told and math.dist(a, b) > SHORT * canvas.unit:
                bar_busy(canvas, a, b)
                text = f"{number(tension, carried.largest)} N"
                canvas.labels.append(Label(text, bar_spots(canvas, a, b)))
