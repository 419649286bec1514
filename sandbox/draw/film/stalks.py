"""Points of bodies that lie beside their shapes: a thin line leads from each to the body."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.geometry import shape_outline
from sandbox.draw.film.palette import ROLES, Colour
from sandbox.draw.film.points import PointPool
from sandbox.model.model import NONE, Model
from sandbox.scene.geometry import solids

XY = tuple[float, float]
WIDTH = 2.2
"""Of a line in points."""
WHEELS = ("gear", "rack", "roll")
"""What joints keep that hold wheels, not points."""


def beside(model: Model, body: int, at: XY) -> XY | None:
    """Where the shapes of a body are nearest to a point beside them, in its frame [m].

    None if the point lies in one of them, or there are none.
    """
    found: list[tuple[float, XY]] = []
    for shape in model.mechanism.bodies[body].shapes:
        for solid, _ in solids(shape):
            start = np.asarray(shape_outline(solid))
            side = np.roll(start, -1, axis=0) - start
            way = np.array(at) - start
            turn = side[:, 0] * way[:, 1] - side[:, 1] * way[:, 0]
            if (turn >= 0).all() or (turn <= 0).all():
                return None
            square = np.maximum((side**2).sum(axis=1), 1e-300)
            share = np.clip((way * side).sum(axis=1) / square, 0.0, 1.0)
            nearest = start + share[:, None] * side
            gap = np.hypot(*(nearest - at).T)
            k = int(gap.argmin())
            found.append((float(gap[k]), (float(nearest[k, 0]), float(nearest[k, 1]))))
    return min(found)[1] if found else None


def stalks(model: Model) -> dict[int, list[tuple[XY, XY]]]:
    """Of each body the points beside its shapes that joints, springs and cylinders hold, [m].

    In its own frame, each with the place of the body that is nearest to it.
    """
    joints, springs, lines = model.joints, model.springs, model.lines
    grooved, ends = set(joints.grooved.tolist()), set[tuple[int, XY]]()
    for k, kind in enumerate(joints.kind):
        if kind.keeps not in WHEELS:
            ends |= {(int(joints.bodies[k, end]), (float(x), float(y)))
                     for end, (x, y) in enumerate(joints.anchor[k]) if end or k not in grooved}
    for bodies, points in ((springs.bodies[springs.straight], springs.anchor[springs.straight]),
                           (lines.bodies[lines.joint == NONE], lines.anchor[lines.joint == NONE])):
        ends |= {(int(body), (float(x), float(y)))
                 for body, (x, y) in zip(bodies.ravel(), points.reshape(-1, 2), strict=True)}
    found: dict[int, list[tuple[XY, XY]]] = {}
    for body, at in sorted(ends):
        nearest = beside(model, body, at)
        if nearest is not None:
            found.setdefault(body, []).append((at, nearest))
    return found


def far_feet(model: Model, least: float) -> dict[int, list[XY]]:
    """Of fixed bodies the points that lie more than ``least`` [m] beside their shapes."""
    return {body: [at for at, nearest in pairs if math.dist(at, nearest) > least]
            for body, pairs in stalks(model).items() if model.bodies.fixed[body]}


class StalkDrawer:
    """Draws the lines of bodies that move, below them."""

    def __init__(self, model: Model, pool: PointPool, shown: Sequence[int]) -> None:
        """``shown`` are the bodies whose lines are drawn."""
        self._lines: list[tuple[slice, Colour]] = [
            (pool.add(body, list(pair)), ROLES[model.mechanism.bodies[body].role].edge)
            for body, pairs in stalks(model).items()
            if not model.bodies.fixed[body] and body in shown for pair in pairs]

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All of them."""
        for where, colour in self._lines:
            canvas.polyline(colour, moment.points[where], WIDTH)
