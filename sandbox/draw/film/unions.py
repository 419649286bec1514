"""Which shapes of a body are drawn as one, without seams. Nothing here draws."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from sandbox.draw.film.geometry import shape_outline
from sandbox.numeric import Array
from sandbox.scene.elements.bodies import Polygon, Polyline, Shape

TOUCHING = 1e-7
"""Shapes that are no farther apart touch [m]."""


def united(shapes: Sequence[Shape], changing: Collection[int]) -> list[int]:
    """The numbers of those convex shapes of a body that touch others of it and lie in none.

    What lies in another, such as a hub, is seen by its own outline, and so are circles that a drive
    changes and shapes of several pieces.
    """
    single = {k: shape for k, shape in enumerate(shapes)
              if k not in changing and not isinstance(shape, Polyline)
              and (not isinstance(shape, Polygon) or shape.whole)}
    rings = {k: shape_outline(shape) for k, shape in single.items()}
    outer = [k for k in rings if not any(
        _holds(rings[other], rings[k]) for other in rings
        if other != k and not (other > k and _holds(rings[k], rings[other])))]
    return [k for k in outer if any(
        other != k and _touch(rings[k], rings[other]) for other in outer)]


def _depths(ring: Array, points: Array) -> Array:
    """How deep points [n, 2] lie behind each side of a convex outline [m], [n, sides]."""
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(*side.T)
    side, start = side[length > 0] / length[length > 0, None], ring[length > 0]
    way = points[:, None] - start
    x, y = ring.T
    turns = np.sign(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return np.asarray(turns * (side[:, 0] * way[..., 1] - side[:, 1] * way[..., 0]))


def _holds(ring: Array, other: Array) -> bool:
    """Whether one convex outline lies in another."""
    return bool((_depths(ring, other) >= -TOUCHING).all())


def _touch(one: Array, other: Array) -> bool:
    """Whether two convex outlines meet: no side of either has all of the other before it."""
    return all(bool((_depths(a, b).max(axis=0) >= -TOUCHING).all())
               for a, b in ((one, other), (other, one)))
