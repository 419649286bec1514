"""Bodies that lie in each other at t = 0: pairs that may touch and are deeper than is negligible.

Shapes are sorted along the axis on which they lie further apart, so that each is held against
those only whose boxes reach into its own. In a heap of shapes in one place that is still every
pair of them; no more than :data:`MOST_LOOKED` are looked at (and :data:`MOST_BOXES` pairs of
boxes), and where that is not all of them it is told.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
import pymunk

from sandbox.engine.inspect_words import NEGLIGIBLE, look, mm
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import solids as solids_of

MOST_LOOKED = 20_000
"""Pairs of shapes that are held against each other."""
MOST_BOXES = 50_000_000
"""Pairs of boxes."""
MOST_TOLD = 100
"""Overlaps that are told; of further ones how many there are."""


class Overlaps(NamedTuple):
    """What a look at all shapes at t = 0 finds."""

    problems: list[Problem]
    near: int
    """Pairs of bodies, of those looked at, that may touch and whose shapes' boxes meet."""


def overlaps(model: Model, allowed: Flags) -> Overlaps:
    """Bodies that lie in each other; ``allowed`` are the pairs that may touch, [nb, nb]."""
    holders, solids, owner = _solids(model)
    looked, whole, depths = 0, True, dict[tuple[int, int], float]()
    for i, others, last in _neighbours(_boxes(solids), owner, allowed):
        whole = whole and not last and len(others) <= MOST_LOOKED - looked
        others = others[:MOST_LOOKED - looked]
        looked += len(others)
        for j in others.tolist():
            pair = (int(min(owner[i], owner[j])), int(max(owner[i], owner[j])))
            depths[pair] = max(_depth(solids[i], solids[j]), depths.get(pair, 0.0))
    del holders  # not before
    return Overlaps(list(_problems(model.bodies.name, depths, looked, whole=whole)), len(depths))


def _problems(
    names: tuple[str, ...], depths: dict[tuple[int, int], float], looked: int, *, whole: bool,
) -> Iterator[Problem]:
    found = [(pair, depth) for pair, depth in sorted(depths.items()) if depth > NEGLIGIBLE]
    for (a, b), depth in found[:MOST_TOLD]:
        yield look("overlap", f"$.bodies[{a}]", names[a], f"overlaps {names[b]!r} by {mm(depth)} "
                   "at t = 0", "move one of them, or add a contact rule with \"collide\": false")
    if len(found) > MOST_TOLD or not whole:
        more = f"{len(found) - MOST_TOLD} more bodies overlap" if whole \
            else "further bodies may overlap"
        yield look("overlap", "$.bodies", "bodies", f"{more} at t = 0",
                   "" if whole else f"{looked} pairs of shapes were looked at")


def _solids(model: Model) -> tuple[list[pymunk.Body], list[pymunk.Shape], Integers]:
    """What holds shapes, which lasts no longer; all shapes at t = 0; the body of each."""
    holders, solids, owner = [], [], []
    for i, body in enumerate(model.mechanism.bodies):
        holder = pymunk.Body(body_type=pymunk.Body.STATIC)
        holder.position, holder.angle = body.at, body.angle
        holders.append(holder)
        for shape in body.shapes:
            for piece, _ in solids_of(shape):
                solids.append(make_shape(holder, piece, (0.0, 0.0)))
                owner.append(i)
    return holders, solids, np.array(owner, dtype=np.int64)


def _boxes(solids: list[pymunk.Shape]) -> Array:
    """Left, bottom, right, top of each shape [m], [n, 4]."""
    boxes = [solid.cache_bb() for solid in solids]
    return np.array([(box.left, box.bottom, box.right, box.top) for box in boxes]).reshape(-1, 4)


def _neighbours(
    boxes: Array, owner: Integers, allowed: Flags,
) -> Iterator[tuple[int, Integers, bool]]:
    """Each shape with later ones whose boxes touch its own and whose bodies may touch its own.

    True with the last one where more boxes were left than may be held against each other.
    """
    if not len(boxes):
        return
    axis = int(np.ptp(boxes[:, 1] + boxes[:, 3]) > np.ptp(boxes[:, 0] + boxes[:, 2]))
    order = np.argsort(boxes[:, axis], kind="stable")
    low, high = boxes[order, :2], boxes[order, 2:]
    ends = np.searchsorted(low[:, axis], high[:, axis], side="right")
    seen = 0
    for place, end in enumerate(ends.tolist()):
        window = slice(place + 1, min(end, place + 1 + MOST_BOXES - seen))
        seen += max(window.stop - window.start, 0)
        over = window.stop < end
        across = 1 - axis
        meets = ((low[window, across] <= high[place, across])
                 & (high[window, across] >= low[place, across])
                 & allowed[owner[order[place]], owner[order[window]]])
        if over or meets.any():
            yield int(order[place]), order[window][meets], over
        if over:
            return


def _depth(one: pymunk.Shape, other: pymunk.Shape) -> float:
    """How deep two shapes are in each other [m]; 0 if they are not.

    Chipmunk gives points of overlap only, with a sign that hangs on which shape comes first.
    """
    try:
        points = one.shapes_collide(other).points
    except AssertionError:  # what pymunk has for no point at all
        return 0.0
    return max((abs(point.distance) for point in points), default=0.0)
