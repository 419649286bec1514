"""Overlapping bodies at t = 0: pairs that may touch, with a depth that is not negligible.

Shapes are sorted along the longer axis, so that each is compared only with those whose boxes
overlap its own. At most :data:`MOST_LOOKED` pairs of shapes (and :data:`MOST_BOXES` pairs of
boxes) are compared; the report says if this is not all of them.
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
"""Largest number of compared pairs of shapes."""
MOST_BOXES = 50_000_000
"""Largest number of compared pairs of boxes."""
MOST_REPORTED = 100
"""Largest number of reported overlaps; further ones are counted."""


class Overlaps(NamedTuple):
    """Overlaps of all shapes at t = 0."""

    problems: list[Problem]
    near: int
    """Compared pairs of bodies that may touch and whose boxes overlap."""


def overlaps(model: Model, allowed: Flags) -> Overlaps:
    """Overlapping bodies; ``allowed`` are the pairs that may touch, [nb, nb]."""
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
    for (a, b), depth in found[:MOST_REPORTED]:
        yield look("overlap", f"$.bodies[{a}]", names[a], f"overlaps {names[b]!r} by {mm(depth)} "
                   "at t = 0", "move one of them, or add a contact rule with \"collide\": false")
    if len(found) > MOST_REPORTED or not whole:
        more = f"{len(found) - MOST_REPORTED} more bodies overlap" if whole \
            else "further bodies may overlap"
        yield look("overlap", "$.bodies", "bodies", f"{more} at t = 0",
                   "" if whole else f"{looked} pairs of shapes were compared")


def _solids(model: Model) -> tuple[list[pymunk.Body], list[pymunk.Shape], Integers]:
    """Bodies that keep the shapes alive; all shapes at t = 0; the body of each."""
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
    """Each shape with the later ones whose boxes overlap and whose bodies may touch it.

    True with the last one if the limit of pairs was reached.
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
    """Depth of the overlap of two shapes [m]; 0 if there is none.

    The sign of Chipmunk's distances depends on the order of the shapes.
    """
    try:
        points = one.shapes_collide(other).points
    except AssertionError:  # pymunk raises it if there is no point
        return 0.0
    return max((abs(point.distance) for point in points), default=0.0)
