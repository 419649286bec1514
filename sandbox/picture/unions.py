"""Which shapes of a body are drawn as one, without seams. Nothing here draws."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.geometry import shape_outline
from sandbox.scene.elements.bodies import Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import solids

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


def bare_outlines(shapes: Sequence[Shape], error: float, *, turns: bool) -> list[Array]:
    """What is drawn of shapes without a fill: lines [n, 2] m.

    Their outlines without the parts that lie in others of them, but all of one that lies whole in
    another; of circles that turn a radius, which shows it. ``error`` [m] is how far lines may be
    from round ones.
    """
    rings = [_ccw(shape_outline(solid, 0.0, error)) for shape in shapes
             for solid, _ in solids(shape)]
    found: list[Array] = []
    for i, ring in enumerate(rings):
        others = [other for other in rings[:i] + rings[i + 1:] if not _holds(other, ring)]
        open_end = False
        for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            parts = _outside(start, end, others)
            for a, b in parts:
                piece = np.array([start + a * (end - start), start + b * (end - start)])
                if open_end and a == 0.0:
                    found[-1] = np.concatenate([found[-1], piece[1:]])
                else:
                    found.append(piece)
            open_end = bool(parts) and parts[-1][1] == 1.0
    return found + [np.array([shape.at, (shape.at[0] + shape.radius, shape.at[1])])
                    for shape in shapes if turns and isinstance(shape, Circle)]


def _ccw(ring: Array) -> Array:
    x, y = ring.T
    return ring if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) >= 0 else ring[::-1]


def _outside(start: Array, end: Array, rings: Sequence[Array]) -> list[tuple[float, float]]:
    """The parts of a side, from 0 to 1 along it, that lie in no ring and on no seam with one."""
    free = [(0.0, 1.0)]
    for ring in rings:
        at, to = _depths(ring, np.array([start, end]))
        along = np.roll(ring, -1, axis=0) - ring
        along = along[np.hypot(*along.T) > 0]
        on_it = np.maximum(np.abs(at), np.abs(to)) <= TOUCHING
        if (on_it & (along @ (end - start) > 0)).any():
            continue  # a side of both, with both on the same hand
        least = np.where(on_it, -np.inf, TOUCHING)
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = (least - at) / (to - at)
        if ((np.abs(to - at) < 1e-15) & (at < least)).any():
            continue
        low = max(0.0, float(np.max(cross[(to > at) & ~on_it], initial=0.0)))
        high = min(1.0, float(np.min(cross[(to < at) & ~on_it], initial=1.0)))
        if high > low:
            free = [part for a, b in free for part in ((a, min(b, low)), (max(a, high), b))
                    if part[1] - part[0] > 1e-9]
    return free


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
