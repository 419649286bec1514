"""Parts of springs and cords."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.model.model import NONE, Model
from sandbox.numeric import Integers
from sandbox.picture.points import PointPool
from sandbox.show.drawing import wheels_of
from sandbox.show.joints import tie_of
from sandbox.show.points import Part, point, short


def springs(model: Model) -> Iterator[Part]:
    """Coils between two points, spirals about hinges.

    ``d`` is the drive that sets the stiffness, ``own`` the stiffness besides; of a one-sided spring
    ``side`` and ``rest`` say when it acts.
    """
    springs, joints, ties = model.springs, model.joints, model.ties
    for k, name in enumerate(springs.name):
        a, b = springs.bodies[k].tolist()
        part: Part = {"l": "springs", "n": name, **tie_of(ties.spring[k])}
        if springs.drive[k] != NONE and springs.stiffness[k]:
            part |= {"d": int(springs.drive[k]), "own": short(springs.stiffness[k])}
        law = springs.law[k]
        if law is not None and law.side:
            part |= {"side": int(law.side), "rest": short(springs.rest[k])}
        if springs.straight[k]:
            yield {"k": "coil", **part, "a": point(a, springs.anchor[k, 0]),
                   "b": point(b, springs.anchor[k, 1])}
            continue
        joint = int(springs.joint[k])
        if ties.joint[joint] != NONE:
            part["tie2"] = int(ties.joint[joint])
        yield {"k": "spiral", **part, "a": a, "b": b, "at": point(b, joints.anchor[joint, 1]),
               "sense": int(joints.sense[joint]), "zero": short(joints.zero[joint])}


def shown_pieces(model: Model) -> list[Integers]:
    """Of each cord the straight pieces whose tensions are shown, among those of all.

    Where no guide holds it all carry the same: the last one tells for all.
    """
    tendons = model.tendons
    found = []
    for k in range(len(tendons.name)):
        own = np.flatnonzero(tendons.stretch_tendon == k)
        found.append(own if len(tendons.gripped(k)) else own[-1:])
    return found


def cord_wheels(model: Model) -> Iterator[Part]:
    """Wheels of guides that no circle of their bodies shows, the largest first."""
    pool = PointPool()
    wheels = wheels_of(model, pool)
    pool.close()
    for wheel in wheels:
        yield {"k": "wheel", "l": "tendons", "at": point(*pool.place(wheel.centre)),
               "s": short(wheel.radius), "f": wheel.style, "spoke": wheel.marked}


def cords(model: Model) -> Iterator[Part]:
    """Cords over their guides ``g``: ``[body, x, y, radius, side, around]``.

    Side is +1 right of the way; a cord goes all ``around`` a wheel where that is 1.

    ``c`` are the columns of ``tension`` of its pieces, of a cord without friction one for all.
    ``off`` are guides that it lifts off with their columns of ``lifted``, ``grips`` those that hold
    it with their columns of ``slip``.
    """
    tendons, column = model.tendons, 0
    for k, pieces in enumerate(shown_pieces(model)):
        spec = model.mechanism.tendons[k]
        where = tendons.guides(k)
        guides = [[*point(body, at), short(guide.radius), 1 if guide.side == "right" else -1,
                   int(turns > 0)]
                  for body, at, guide, turns in zip(
                      tendons.guide_body[where], tendons.guide_at[where], spec.path,
                      tendons.guide_turns[where], strict=True)]
        part: Part = {"k": "cord", "l": "tendons", "n": tendons.name[k], "g": guides,
                      "c": list(range(column, column + len(pieces))),
                      **tie_of(model.ties.tendon[k])}
        column += len(pieces)
        if spec.closed:
            part["closed"] = 1
        if spec.lifting:
            part["off"] = [[guide, int(c)] for guide, c in
                           zip(spec.lifting, tendons.loose(k), strict=True)]
        if spec.gripping:
            part["grips"] = [[guide, int(c)] for guide, c in
                             zip(spec.gripping, tendons.gripped(k), strict=True)]
        if tendons.stiffener[k] != NONE:
            part |= {"d": int(tendons.stiffener[k]), "own": short(tendons.stiffness[k])}
        yield part
