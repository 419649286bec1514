"""The differential against equations (4)-(7): the root goes the mean of its leaves' ways."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, Figure, Worst, missing
from sandbox.kinds.arrays import Array
from sandbox.samples.cords import lengths
from sandbox.scene.elements.joints import Slot
from sandbox.scene.elements.settings import Group
from sandbox.scene.geometry import pose_of, to_world

NAME, SOURCE = "differential", "(4)-(7)"


def differential_figure(evidence: Evidence) -> Figure:
    """Every rocker and wheel of every tree: its pivot's way against that of its two strings."""
    groups = [group for group in evidence.layout.mechanism.groups
              if group.kind in ("rocker_tree", "pulley_tree")]
    if not groups:
        return missing(NAME, why="there is no tree of rockers or pulleys", source=SOURCE)
    few, worst, left_out = evidence.few, Worst(), []
    for group in groups:
        for name in group.bodies:
            reason = _compare(few, group, name, worst)
            if reason:
                left_out.append(f"{name}: {reason}")
    return worst.figure(
        NAME, "m", source=SOURCE, none="; ".join(left_out[:2]),
        why="way of each pivot against the mean of its two strings' ways, weighted by their arms, "
            "{count} rockers or wheels, worst: {where}; the strings' slant is allowed"
            + (f"; left out: {'; '.join(left_out[:2])}" if left_out else ""))


@dataclass
class _String:
    """A string at a rocker or wheel: its arm, and its way on the far side."""

    arm: float
    way: Array
    allowed: Array


def _compare(few: Evidence, group: Group, name: str, worst: Worst) -> str:
    """Add one rocker or wheel; a reason if it cannot be compared."""
    layout, frames = few.layout, few.loads.frames
    body = layout.number[name]
    slot = next((joint for joint in layout.mechanism.joints
                 if isinstance(joint, Slot) and joint.b == name), None)
    if slot is None:
        return "it does not slide on a slot"
    frame = layout.number[slot.a]
    direction = np.subtract(slot.end, slot.start) / np.hypot(*np.subtract(slot.end, slot.start))
    c, s = frames.cos[frame, 0], frames.sin[frame, 0]
    pull = np.array([c * direction[0] - s * direction[1], s * direction[0] + c * direction[1]])
    strings = [found for tendon in range(len(layout.mechanism.tendons))
               if (found := _string(few, tendon, body, pull)) is not None]
    if len(strings) != 2:
        return f"it has {len(strings)} strings that are tendons, not 2"
    start = layout.mechanism.bodies[body]
    own = pull[0] * (frames.x[body] - start.at[0]) + pull[1] * (frames.y[body] - start.at[1])
    one, two = strings
    # arms count to either side: the pivot's way is the mean, weighted by the other's arm
    total = one.arm - two.arm
    if abs(total) < 1e-12:
        return "its strings pull at one place"
    mean = (one.arm * two.way - two.arm * one.way) / total
    allowed = np.maximum(one.allowed, two.allowed) + few.shift + ROUNDING
    worst.add(name, np.abs(own - mean), allowed)
    return ""


def _string(few: Evidence, tendon: int, body: int, pull: Array) -> _String | None:
    """The string of a tendon that ends on ``body``, pulled by it; None if it does not.

    Its way is what the cord gives on the far side of its last stretch: the
    guide there moves along the pull, and what the path before shortens. What
    its slant takes off its length along the pull is allowed.
    """
    loads, guides = few.loads, few.loads.guides
    rows = np.flatnonzero(guides.tendon == tendon)
    last = int(guides.first[rows[-1]]) + 1
    if guides.body[last] != body:
        return None
    bodies = few.layout.mechanism.bodies
    at0 = np.array(to_world(pose_of(bodies[body]), tuple(guides.at[last]))) - bodies[body].at
    across = np.array([-pull[1], pull[0]])
    arm = float(across @ at0 + guides.radius[last])
    far = last - 1
    path = lengths(loads.frames, guides, loads.cords)[tendon]
    row = int(rows[-1])
    straight = loads.cords.length[row]
    point0 = np.array(to_world(pose_of(bodies[int(guides.body[far])]), tuple(guides.at[far])))
    end0 = np.array(bodies[body].at) + at0
    offset = float(guides.radius[far] - guides.radius[last])
    straight0 = float(np.sqrt(np.sum((end0 - point0)**2) - offset**2))
    before = path - straight
    if guides.radius[last]:  # what a wheel has let go is not part of the path before
        before = before - _let_go(few, tendon)
    moved = (pull[0] * (loads.cords.start.x[row] - point0[0])
             + pull[1] * (loads.cords.start.y[row] - point0[1]))
    # the cord's own length now: its stretch T / k is no fault of the rocker
    way = moved + few.run.arrays["tendon_length"][:, tendon] - before - straight0
    along = np.abs(pull[0] * loads.cords.x[row] + pull[1] * loads.cords.y[row])
    slant = straight * (1 - along)
    return _String(arm, way, slant + few.shift + ROUNDING)


def _let_go(few: Evidence, tendon: int) -> Array:
    """Length that the wheel at a tendon's end has let go [m], [n]."""
    loads, guides = few.loads, few.loads.guides
    total = lengths(loads.frames, guides, loads.cords)[tendon]
    rows = np.flatnonzero(guides.tendon == tendon)
    return np.asarray(total - loads.cords.length[rows].sum(axis=0))
