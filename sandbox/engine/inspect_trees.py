"""How far differentials can go: until a rocker turns over, or a pivot's slot ends.

The ends of a rocker with arms a and b, at a tilt theta from across the pull, are (a + b) sin(theta)
apart along it. So the two strings of one rocker can have gone different ways by a + b and no
more: there the rocker lies along the pull, and beyond it no longer divides it. A wheel winds its
strings on and turns as far as they want.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np

from sandbox.engine.inspect_words import mm
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.geometry import to_body, to_world
from sandbox.wording import listed


def reaches(model: Model) -> Iterator[str]:
    """A line for every tree of rockers or pulleys: ``tree: …``."""
    for group in model.mechanism.groups:
        if group.kind not in ("rocker_tree", "pulley_tree"):
            continue
        words = [*_rockers(model, group.bodies), *_slots(model, group.bodies)]
        if words:
            yield f"{group.name}: {'; '.join(words)}"


def _rockers(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    widths: dict[str, list[str]] = {}
    for name in names:
        ends = list(_ends(model, model.names.body[name]))
        if len(ends) == 2:
            widths.setdefault(mm(float(np.hypot(*(ends[0] - ends[1])))), []).append(name)
    if widths:
        told = ", ".join(f"{width} ({listed(named, most=4)})" for width, named in widths.items())
        yield f"a rocker turns over where its strings have gone differently far, by {told}"


def _ends(model: Model, body: int) -> Iterator[Array]:
    """Where strings end on a rocker, in its frame [m]."""
    tendons, joints = model.tendons, model.joints
    for last in tendons.first[1:] - 1:
        if tendons.guide_body[last] == body and not tendons.guide_radius[last]:
            yield tendons.guide_at[last]
    for joint in joints.keeping("range"):
        if joints.bodies[joint, 1] == body:
            yield joints.anchor[joint, 1]


def _slots(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    room = list(chain.from_iterable(_room(model, model.names.body[name]) for name in names))
    if room:
        ahead, behind = (min(way) for way in zip(*room, strict=True))
        yield f"its slots end after {mm(ahead)} along the pull and {mm(behind)} against it"


def _room(model: Model, body: int) -> Iterator[tuple[float, float]]:
    """How far a pivot can go in its slot from where it starts, on and back [m]."""
    joints, pose = model.joints, model.bodies.pose
    for joint in joints.keeping("groove"):
        frame, slider = joints.bodies[joint].tolist()
        if slider == body:
            start, end = joints.groove[joint]
            point = to_world(tuple(pose[slider]), tuple(joints.anchor[joint, 1]))
            length = float(np.hypot(*(end - start)))
            gone = float((to_body(tuple(pose[frame]), point) - start) @ (end - start)) / length
            yield length - gone, gone
