"""The differential against equations (4)-(7): the root moves by its leaves' mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, Figure, Worst, missing
from sandbox.numeric import Array
from sandbox.samples.cords import lengths, wound_up
from sandbox.scene.elements.settings import Group
from sandbox.scene.geometry import pose_of, to_world

NAME, SOURCE = "differential", "(4)-(7)"


def differential_figure(evidence: Evidence) -> Figure:
    """Every rocker and wheel of every tree: its pivot's displacement against its two strings'."""
    groups = [group for group in evidence.model.mechanism.groups
              if group.kind in ("rocker_tree", "pulley_tree")]
    if not groups:
        return missing(NAME, why="there is no tree of rockers or pulleys", source=SOURCE)
    worst, left_out = Worst(), []
    for group in groups:
        for name in group.bodies:
            reason = _compare(evidence, group, name, worst)
            if reason:
                left_out.append(f"{name}: {reason}")
    return worst.figure(
        NAME, "m", source=SOURCE, none="; ".join(left_out[:2]),
        why="way of each pivot against the mean of its two strings' ways, weighted by their arms, "
            "{count:rocker or wheel|rockers or wheels}, worst: {where}; the strings' slant "
            "is allowed"
            + (f"; left out: {'; '.join(left_out[:2])}" if left_out else ""))


@dataclass
class _String:
    """A string at a rocker or wheel: its arm, and its displacement on the far side [m]."""

    arm: float
    displacement: Array
    allowed: Array


def _compare(evidence: Evidence, group: Group, name: str, worst: Worst) -> str:
    """Add one rocker or wheel; a reason if it cannot be compared."""
    model, frames = evidence.model, evidence.loads.frames
    joints, body = model.joints, model.names.body[name]
    slots = [j for j in joints.keeping("groove") if joints.bodies[j, 1] == body]
    if not slots:
        return "it does not slide on a slot"
    frame = joints.bodies[slots[0], 0]
    along = joints.groove[slots[0], 1] - joints.groove[slots[0], 0]
    direction = along / np.hypot(*along)
    c, s = frames.cos[frame, 0], frames.sin[frame, 0]
    pull = np.array([c * direction[0] - s * direction[1], s * direction[0] + c * direction[1]])
    strings = [found for tendon in range(len(model.tendons.name))
               if (found := _string(evidence, tendon, body, pull)) is not None]
    if len(strings) != 2:
        return f"it has {len(strings)} strings that are tendons, not 2"
    x, y, _ = model.bodies.pose[body]
    own = pull[0] * (frames.x[body] - x) + pull[1] * (frames.y[body] - y)
    one, two = strings
    # arms count to either side: the pivot's displacement is the mean, weighted by the other's arm
    total = one.arm - two.arm
    if abs(total) < 1e-12:
        return "its strings pull at one place"
    mean = (one.arm * two.displacement - two.arm * one.displacement) / total
    allowed = np.maximum(one.allowed, two.allowed) + evidence.closed + ROUNDING
    worst.add(name, np.abs(own - mean), allowed)
    return ""


def _string(evidence: Evidence, tendon: int, body: int, pull: Array) -> _String | None:
    """The string of a tendon that ends on ``body``, pulled by it; None if it does not.

    Its displacement is what the cord gives on the far side of its last stretch: the
    guide there moves along the pull, and what the path before shortens. What
    its slant takes off its length along the pull is allowed.
    """
    loads, tendons = evidence.loads, evidence.model.tendons
    last = int(tendons.first[tendon + 1]) - 1
    if tendons.guide_body[last] != body:
        return None
    place = evidence.model.bodies.pose[body, :2]
    at0 = _at_start(evidence, last) - place
    across = np.array([-pull[1], pull[0]])
    arm = float(across @ at0 + tendons.guide_radius[last])
    far = last - 1
    path = lengths(loads.frames, loads.cords)[tendon]
    row = int(np.flatnonzero(tendons.stretch_tendon == tendon)[-1])
    straight = loads.cords.length[row]
    point0, end0 = _at_start(evidence, far), place + at0
    offset = float(tendons.guide_radius[far] - tendons.guide_radius[last])
    straight0 = float(np.sqrt(np.sum((end0 - point0)**2) - offset**2))
    # what a wheel at the end has wound up is not part of the path before
    before = path - straight - wound_up(loads.frames, loads.cords, tendon, last=True)
    moved = (pull[0] * (loads.cords.start.x[row] - point0[0])
             + pull[1] * (loads.cords.start.y[row] - point0[1]))
    # the cord's own length now: its stretch T / k is no fault of the rocker
    displacement = moved + evidence.run.arrays["tendon_length"][:, tendon] - before - straight0
    along = np.abs(pull[0] * loads.cords.x[row] + pull[1] * loads.cords.y[row])
    slant = straight * (1 - along)
    return _String(arm, displacement, slant + evidence.closed + ROUNDING)


def _at_start(evidence: Evidence, guide: int) -> Array:
    """Where a guide's centre is at t = 0, in the world [m]."""
    x, y = evidence.model.tendons.guide_at[guide]
    body = evidence.model.mechanism.bodies[evidence.model.tendons.guide_body[guide]]
    return np.array(to_world(pose_of(body), (float(x), float(y))))
