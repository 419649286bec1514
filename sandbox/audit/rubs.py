"""Figure of dry friction in pins and slots: within its bound, against the motion, or holding."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS, EXACT, STILL, Figure, Worst, peak, whole
from sandbox.model.ties import held_one
from sandbox.numeric import Array, Flags

SOLVED = 1e-9
"""Share of the fastest that bounded rows see by which their rates may be off."""
HELD, FADED = 1e-10, 0.01
"""How strongly impulses are held to the last, and how much of these fades (docs/engine.md)."""
MEASURED = 1e-13
"""A change of rates [m/s, rad/s] for which what a joint carries is not measured again."""


def rub_figures(evidence: Evidence) -> Iterator[Figure]:
    """Friction of every joint that rubs against Coulomb's law."""
    model, a, worst = evidence.model, evidence.run.arrays, Worst()
    joints, count = model.joints, len(model.joints.name)
    pushes = evidence.loads.rub_pushes
    rates = -evidence.loads.lengthening(pushes, count, evidence.velocity_after)
    for j in joints.rubbed.tolist():
        if not model.bodies.free[joints.bodies[j]].any():
            continue
        friction, holds = a["joint_friction"][:, j], a["joint_sticks"][:, j] == 1.0
        sliding = joints.friction[j] + joints.rubbing[j] * carried(evidence, j)
        gone = ~held_one(model.ties.joint[j], a["held"])
        most, largest = joints.static[j] * sliding, whole(joints.static[j] * sliding)
        alone = _alone(evidence, j)
        unsure = EXACT + MEASURED / (evidence.h * alone.min() * largest)
        name = joints.name[j]
        worst.add(f"bound of {name}", np.maximum(np.abs(friction) - most, 0.0) / largest, unsure)
        rate, fast = rates[j], 1 + peak(rates[j])
        low, high = _breaking_away(holds, rate, sliding, most)
        short = np.maximum(low - np.abs(friction), np.abs(friction) - high)
        worst.add(f"slip of {name}", np.where(holds, 0.0, np.maximum(short, 0.0)) / largest,
                  unsure, ~gone)
        wrong = np.where(holds, np.abs(rate), np.maximum(rate * np.sign(friction), 0.0))
        held = HELD * alone * evidence.h * 2 * peak(friction)
        worst.add(name, wrong / fast, SOLVED + (
            STILL[joints.kind[j].rubs == "N m"] + DIGITS / evidence.h + held
            + evidence.h * _bend(evidence, j)) / fast, ~gone)
    yield worst.figure(
        "joint.friction", "", source="|F| <= μ N, against the motion",
        none="no joint has dry friction",
        why="dry friction of joints against its bound from what they carry, its sense against the "
            "motion at the end of the step, none of that where it holds, {count:comparison}, "
            "worst: {where}")


def _breaking_away(
    holds: Flags, rate: Array, sliding: Array, most: Array,
) -> tuple[Array, Array]:
    """Least and largest friction where it slips, [n]: that of sliding, or a share of both bounds.

    The latter where it may have begun to slip in this step (:mod:`sandbox.engine.breakaway`): it
    held in the sample before, or slipped the other way.
    """
    begins = np.append(True, holds[:-1] | (rate[1:] * rate[:-1] < 0))
    some = begins * (most - sliding) / 2
    return np.maximum(sliding - some, 0.0), sliding + some


def carried(evidence: Evidence, joint: int) -> Array:
    """What a joint carries and friction hangs on [N], [n]: of a groove what is across it."""
    force = evidence.run.arrays["joint_force"][:, joint]
    if evidence.model.joints.kind[joint].keeps != "groove":
        return np.asarray(np.hypot(force[:, 0], force[:, 1]))
    x, y = evidence.loads.groove_direction(joint)
    return np.asarray(np.abs(x * force[:, 1] - y * force[:, 0]))


def _alone(evidence: Evidence, joint: int) -> Array:
    """What friction of 1 N s or 1 N m s makes of the rate of two bodies that nothing joins, [n]."""
    pushes, weights = evidence.loads.rub_pushes, evidence.loads.weights
    found = np.zeros(evidence.loads.frames.samples)
    for k in np.flatnonzero(pushes.element == joint).tolist():
        mass, _, inertia = weights[pushes.body[k]].tolist()
        if mass:
            found += (pushes.x[k]**2 + pushes.y[k]**2) / mass + pushes.moment[k]**2 / inertia
    return found


def _bend(evidence: Evidence, joint: int) -> Array | float:
    """How fast the way along a groove bends away from its tangent as bodies turn [m/s^2], [n]."""
    joints, frames = evidence.model.joints, evidence.loads.frames
    if joints.kind[joint].keeps != "groove":
        return 0.0
    a, b = joints.bodies[joint].tolist()
    at, v = frames.anchors[1], evidence.velocity
    reach = np.hypot(at.x[joint] - frames.centre_x[a], at.y[joint] - frames.centre_y[a])
    speed = np.hypot(v[0, b] - v[0, a], v[1, b] - v[1, a])
    arm = np.hypot(at.arm_x[joint], at.arm_y[joint])
    turn = np.abs(v[2, a]) + np.abs(v[2, b])
    grows = evidence.h * (np.abs(frames.acceleration[2, a]) + np.abs(frames.acceleration[2, b]))
    return np.asarray((turn + grows) * ((turn + grows) * (reach + arm) + 2 * speed))
