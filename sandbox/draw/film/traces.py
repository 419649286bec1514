"""The ways that points of bodies have gone, as the view asks for them."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.canvas import Canvas, Filmed, Moment
from sandbox.draw.film.palette import TRACE
from sandbox.draw.film.points import PointPool
from sandbox.numeric import Array
from sandbox.scene.elements.settings import View

WIDTH = 1.8
FINEST = 3.0
"""Pieces of a way are at least this long [points]."""
MOST = 5000
"""Pieces that are drawn of a way, the latest ones."""


class _Way(NamedTuple):
    """Where a point was: samples [n], their pixels [n, 2], and the pooled point itself."""

    samples: NDArray[np.intp]
    pixels: Array
    tip: int


class TraceDrawer:
    """Draws the way of each traced point since t = 0, and the point."""

    def __init__(self, run: Filmed, view: View, pool: PointPool, canvas: Canvas) -> None:
        names = [body.name for body in run.mechanism.bodies]
        self._ways: list[_Way] = []
        for trace in view.traces:
            body = names.index(trace.body)
            alone = PointPool()
            alone.add(body, [trace.at])
            alone.close()
            world = alone.world(run.arrays["body_pose"])[:, 0]
            pixels = canvas.camera.to_pixels(world)
            samples = _apart(pixels, FINEST * canvas.unit)
            self._ways.append(_Way(samples, pixels[samples], pool.add(body, [trace.at]).start))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The ways up to now; what is still to come is not shown."""
        for way in self._ways:
            tip = moment.points[way.tip]
            count = int(np.searchsorted(way.samples, moment.sample, side="right"))
            passed = [(x, y) for x, y in way.pixels[max(0, count - MOST):count].tolist()]
            # piece by piece: one outline around a way that crosses itself has holes
            for piece in pairwise([*passed, tip]):
                canvas.polyline(TRACE, piece, WIDTH)
            canvas.disc(TRACE, tip, 1.5 * WIDTH)


def _apart(pixels: Array, least: float) -> NDArray[np.intp]:
    """Numbers of the samples [n, 2] that are ``least`` pixels apart, each from the last one."""
    kept: list[int] = []
    last = (math.inf, math.inf)
    for k, at in enumerate(map(tuple, pixels.tolist())):
        if math.isfinite(at[0] + at[1]) and not math.dist(last, at) < least:
            kept.append(k)
            last = at
    return np.array(kept, dtype=np.intp)
