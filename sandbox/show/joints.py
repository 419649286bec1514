"""Parts of joints: grooves, what lies between two points, stops, marks; what may be let go."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.model.model import NONE, Model
from sandbox.picture.elements.joints import JOINTS, is_rail
from sandbox.picture.elements.links import TELLING, reach_of
from sandbox.picture.run_data import RunData
from sandbox.picture.tensions import tensions_of
from sandbox.show.points import Part, point, short


def tie_of(number: Any) -> Part:
    """Which column of ``held`` says whether it is there."""
    return {} if int(number) == NONE else {"tie": int(number)}


def _common(model: Model, joint: int) -> Part:
    return {"l": "joints", "n": model.joints.name[joint], **tie_of(model.ties.joint[joint])}


def _ends(model: Model, joint: int) -> Part:
    (a, b), (on_a, on_b) = model.joints.bodies[joint], model.joints.anchor[joint]
    return {"a": point(a, on_a), "b": point(b, on_b)}


def grooves(model: Model) -> tuple[list[Part], list[Part]]:
    """Grooves beside their body's shapes, or in the ground, and those cut into bodies."""
    rails: list[Part] = []
    cut: list[Part] = []
    joints = model.joints
    for joint in joints.grooved.tolist():
        body = int(joints.bodies[joint, 0])
        start, end = (point(body, at) for at in joints.groove[joint])
        rail = is_rail(model, joint)
        ground = rail and bool(model.bodies.fixed[body])
        (rails if rail else cut).append(
            {"k": "rail" if ground else "groove", **_common(model, joint), "a": start, "b": end})
    return rails, cut


def links(run: RunData) -> Iterator[Part]:
    """Rods, ropes and cylinders, ``told`` if with numbers; then what runs in grounds."""
    model = run.model
    joints, drives = model.joints, model.drives
    driven = {int(drives.target[i]) for i in drives.giving("push")}
    told = len(tensions_of(run).loaded) <= TELLING
    for k, joint in enumerate(run.mechanism.joints):
        kind = JOINTS[joint.type].link
        if kind:
            low, high = reach_of(run, k)
            yield {"k": kind, **_common(model, k), **_ends(model, k), "j": k, "told": told,
                   "reach": [short(low), short(high)],
                   **({"driven": k in driven} if joints.kind[k].line else {})}
    for k in joints.grooved.tolist():
        body = int(joints.bodies[k, 0])
        if is_rail(model, k) and model.bodies.fixed[body]:
            start, end = (point(body, at) for at in joints.groove[k])
            yield {"k": "roller", **_common(model, k), "a": start, "e": end,
                   "b": _ends(model, k)["b"], "turns": bool(joints.turns[k])}


def stops(run: RunData) -> Iterator[Part]:
    """Wedges at hinges whose stops may act; ``j`` their columns of ``stop``."""
    model, centre = run.model, run.arrays["body_centre"]
    joints = model.joints
    for column, k in enumerate(joints.stopped.tolist()):
        a, b = joints.bodies[k].tolist()
        yield {"k": "stop", **_common(model, k), "at": _ends(model, k)["b"], "j": column,
               "a": point(a, centre[a]), "b": point(b, centre[b]), "sense": int(joints.sense[k])}


def joint_marks(model: Model) -> Iterator[Part]:
    """Collars of dry friction, then pins, small rings and squares."""
    for column, k in enumerate(model.joints.rubbed.tolist()):
        yield {"k": "collar", **_common(model, k), "at": _ends(model, k)["b"], "j": column}
    for k, joint in enumerate(model.mechanism.joints):
        kind = JOINTS[joint.type].mark
        if kind:
            yield {"k": kind, **_common(model, k), **_ends(model, k)}


def latches(model: Model) -> Iterator[Part]:
    """Diamonds where what may be let go begins."""
    ties, joints, springs, tendons = model.ties, model.joints, model.springs, model.tendons

    def mark(tie: Any, name: str, body: Any, at: Any) -> Part:
        return {"k": "latch", "l": "joints", "n": name, "held": int(tie), "at": point(body, at)}

    for k in np.flatnonzero(ties.joint >= 0).tolist():
        yield mark(ties.joint[k], joints.name[k], joints.bodies[k, 0], joints.anchor[k, 0])
    for k in np.flatnonzero(ties.spring >= 0).tolist():
        of = int(springs.joint[k])
        where = (springs.bodies[k, 0], springs.anchor[k, 0]) if springs.straight[k] else (
            joints.bodies[of, 0], joints.anchor[of, 0])
        yield mark(ties.spring[k], springs.name[k], *where)
    for k in np.flatnonzero(ties.tendon >= 0).tolist():
        first = tendons.guides(k).start
        yield mark(ties.tendon[k], tendons.name[k], tendons.guide_body[first],
                   tendons.guide_at[first])
