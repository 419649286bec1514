"""The ways that points of bodies have gone, with marks of time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.canvas import Canvas, Label, Moment, around
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.marked import PIECES, Place, round_interval, trace_colours, trace_names
from sandbox.draw.film.palette import Colour
from sandbox.draw.film.points import PointPool
from sandbox.numeric import Array

WIDTH = 1.8
FINEST = 3.0
"""Pieces of a way are at least this long [points]."""
MOST = 5000
"""Pieces that are drawn of a way, the latest ones."""
MARK = 3.0
"""Radius of a mark of time [points]."""
APART = 9.0
"""Marks of time are left out that are nearer to the last one [points]."""


class _Way(NamedTuple):
    """Where a point was, [k, 2] m each, and the pooled point itself."""

    samples: NDArray[np.intp]
    places: Array
    marks: Array
    """After every whole interval of time."""
    tip: int


class TraceDrawer:
    """Draws the way of each traced point since t = 0, and the point; of several with names."""

    def __init__(self, run: Filmed, places: Sequence[Place], pool: PointPool,
                 canvas: Canvas, named: Sequence[int] = ()) -> None:
        """``named`` are bodies whose names stand beside them already."""
        bodies = [body for body, _ in places]
        self.colours = trace_colours(run.model, bodies)
        self._names = ["" if body in named else name for body, name in zip(
            bodies, trace_names(run.model, bodies), strict=True)]
        self.interval = round_interval(float(run.time[-1] - run.time[0]))
        """Between marks of time [s]."""
        first = math.floor(float(run.time[0]) / self.interval * (1 - 1e-9)) + 1.0
        marks = (first + np.arange(2 * PIECES)) * self.interval
        self._times = marks[marks <= run.time[-1] * (1 + 1e-9)]
        self._ways: list[_Way] = []
        for body, at in places:
            alone = PointPool()
            alone.add(body, [at])
            alone.close()
            world = alone.world(run.arrays["body_pose"])[:, 0]
            samples = _apart(world, FINEST * canvas.unit / canvas.camera.scale)
            spots: Array = np.stack([np.interp(self._times, run.time, world[:, k]) for k in (0, 1)],
                                    axis=1)
            self._ways.append(_Way(samples, world[samples], spots, pool.add(body, [at]).start))

    @property
    def any(self) -> bool:
        """Whether there is any way."""
        return bool(self._ways)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The ways up to now; what is still to come is not shown."""
        for way, colour, name in zip(self._ways, self.colours, self._names, strict=True):
            tip = moment.points[way.tip]
            count = int(np.searchsorted(way.samples, moment.sample, side="right"))
            passed = canvas.camera.to_pixels(way.places[max(0, count - MOST):count])
            # piece by piece: one outline around a way that crosses itself has holes
            for piece in pairwise([*((x, y) for x, y in passed.tolist()), tip]):
                canvas.polyline(colour, piece, WIDTH)
            self._draw_marks(canvas, moment, way, colour)
            canvas.disc(colour, tip, 1.5 * WIDTH)
            if name and math.isfinite(tip[0] + tip[1]):
                at = tip[0] / canvas.enlarged, tip[1] / canvas.enlarged
                canvas.labels.append(Label(name, around(canvas, *at), colour, at=at))

    def _draw_marks(self, canvas: Canvas, moment: Moment, way: _Way, colour: Colour) -> None:
        past = int(np.searchsorted(self._times, moment.time * (1 + 1e-9), side="right"))
        last = (math.inf, math.inf)
        for x, y in canvas.camera.to_pixels(way.marks[:past]).tolist():
            if math.isfinite(x + y) and not math.dist(last, (x, y)) < APART * canvas.unit:
                canvas.touch((x, y), MARK + 1)
                canvas.disc(colour, (x, y), MARK)
                last = (x, y)


def _apart(points: Array, least: float) -> NDArray[np.intp]:
    """Numbers of the samples [n, 2] that are ``least`` apart, each from the last one."""
    kept: list[int] = []
    last = (math.inf, math.inf)
    for k, at in enumerate(map(tuple, points.tolist())):
        if math.isfinite(at[0] + at[1]) and not math.dist(last, at) < least:
            kept.append(k)
            last = at
    return np.array(kept, dtype=np.intp)
