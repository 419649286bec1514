"""Paths: smooth curves by their arc length, as the pin of a slot runs along them.

A place on a path is an arc length from its first point. An open path continues straight beyond its
ends. Its spans are those of :mod:`sandbox.scene.outlines.curves`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.outlines.curves import curvature, on_spans, spans_of

ABSCISSAE, WEIGHTS = np.polynomial.legendre.leggauss(5)
"""Quadrature of arc lengths, as in :mod:`sandbox.engine.paths`."""
ITERATIONS = 30
SAMPLES = 16
"""Points of each span from which the search for the nearest place starts."""


@dataclass(frozen=True)
class Path:
    """A smooth curve in the frame of a body."""

    nodes: Array
    """x, y, direction, curvature, [n, 4]; not finite where the curve turns back on itself."""
    closed: bool

    @cached_property
    def terms(self) -> Array:
        """Polynomials of its spans, [k, 12]."""
        return spans_of(self.nodes, closed=self.closed).terms

    @cached_property
    def starts(self) -> Array:
        """Arc lengths at the starts of the spans, and the whole length [m], [k + 1]."""
        count = len(self.terms)
        return np.append(0.0, np.cumsum(_arc(self.terms, np.ones(count))))

    @property
    def is_smooth(self) -> bool:
        """Whether it has a direction everywhere: nowhere does it turn back on itself."""
        if not np.isfinite(self.nodes).all():
            return False
        terms, count = self.terms, len(self.terms)
        first = np.array([on_spans(terms, np.full(count, w))[1]
                          for w in np.linspace(0.0, 1.0, 16 * SAMPLES + 1)])
        along = (first[1:] * first[:-1]).sum(axis=2)
        return bool((along > 0.0).all())

    @property
    def length(self) -> float:
        """Whole length [m]."""
        return float(self.starts[-1])

    def at(self, place: Array) -> tuple[Array, Array, Array]:
        """Points [n, 2] m, unit tangents [n, 2] and curvatures [n] 1/m at arc lengths [n].

        The curvature is positive where the path turns to the left.
        """
        place = np.asarray(np.mod(place, self.length) if self.closed else place)
        k = np.clip(np.searchsorted(self.starts, place, side="right") - 1, 0, len(self.terms) - 1)
        terms, lengths = self.terms[k], np.diff(self.starts)[k]
        ahead = place - self.starts[k]
        within = np.clip(ahead, 0.0, lengths)
        w = within / lengths
        for _ in range(4):
            speed = np.hypot(*on_spans(terms, w)[1].T)
            w = np.clip(w + (within - _arc(terms, w)) / speed, 0.0, 1.0)
        point, first, second = on_spans(terms, w)
        tangent = first / np.hypot(*first.T)[:, None]
        beyond = ahead - within
        return (point + beyond[:, None] * tangent, tangent,
                np.where(beyond == 0.0, curvature(first, second), 0.0))

    def nearest(self, point: Array) -> float:
        """Arc length of the place nearest to a point [2] of the body's frame [m]."""
        grid = np.linspace(self.starts[:-1], self.starts[1:], SAMPLES, endpoint=False).ravel()
        grid = grid if self.closed else np.append(grid, self.length)
        best = grid[np.argmin(np.hypot(*(self.at(grid)[0] - point).T))]
        for _ in range(ITERATIONS):
            foot, tangent, bend = (one[0] for one in self.at(np.array([best])))
            off = point - foot
            left = tangent[0] * off[1] - tangent[1] * off[0]
            best += float(tangent @ off) / max(1.0 - bend * left, 0.1)
        return float(best % self.length if self.closed else best)


def _arc(terms: Array, w: Array) -> Array:
    """Arc lengths of spans [k, 12] up to parameters [k]."""
    at = (np.multiply.outer(ABSCISSAE, w) + w) / 2
    speed = [np.hypot(*on_spans(terms, one)[1].T) for one in at]
    return np.asarray(WEIGHTS @ speed * w / 2)


def path_through(points: tuple[tuple[float, float], ...], *, closed: bool) -> Path:
    """The smooth path through points [m]: the quintic spline over the chords' lengths.

    Its curvature is exact to fourth order in the distance of the points, that of a cubic spline
    only to second order. Fewer than six points of an open path have a spline of lower degree.
    """
    from scipy.interpolate import make_interp_spline

    ring = np.array([*points, points[0]] if closed else points)
    at = np.append(0.0, np.cumsum(np.hypot(*np.diff(ring, axis=0).T)))
    degree = 5 if closed or len(points) > 5 else 3 if len(points) > 3 else 2
    spline = make_interp_spline(at, ring, degree, bc_type="periodic" if closed else None)
    first, second = (spline(at[:len(points)], order) for order in (1, 2))
    with np.errstate(invalid="ignore", divide="ignore"):
        return Path(np.column_stack([points, np.arctan2(first[:, 1], first[:, 0]),
                                     curvature(first, second)]), closed)
