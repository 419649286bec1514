"""The ways that points of bodies have gone, with marks of time."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.marked import PIECES, Place, round_interval
from sandbox.draw.film.palette import TRACE
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
    """Draws the way of each traced point since t = 0, and the point."""

    def __init__(self, run: Filmed, places: Sequence[Place], pool: PointPool,
                 canvas: Canvas) -> None:
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
        for way in self._ways:
            tip = moment.points[way.tip]
            count = int(np.searchsorted(way.samples, moment.sample, side="right"))
            passed = canvas.camera.to_pixels(way.places[max(0, count - MOST):count])
            # piece by piece: one outline around a way that crosses itself has holes
            for piece in pairwise([*((x, y) for x, y in passed.tolist()), tip]):
                canvas.polyline(TRACE, piece, WIDTH)
            self._draw_marks(canvas, moment, way)
            canvas.disc(TRACE, tip, 1.5 * WIDTH)

    def _draw_marks(self, canvas: Canvas, moment: Moment, way: _Way) -> None:
        past = int(np.searchsorted(self._times, moment.time * (1 + 1e-9), side="right"))
        last = (math.inf, math.inf)
        for x, y in canvas.camera.to_pixels(way.marks[:past]).tolist():
            if math.isfinite(x + y) and not math.dist(last, (x, y)) < APART * canvas.unit:
                canvas.touch((x, y), MARK + 1)
                canvas.disc(TRACE, (x, y), MARK)
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
