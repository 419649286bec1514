"""The figure of loads: each again from the scene's law, with the recorded poses and velocities.

    F(x, v, a, t) at the sample,   or   F(x + h v, v, a, t) with the velocities half a step on

in each step one of the two (docs/engine.md); of buoyancy always the first.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import EXACT, ROUNDING, Figure, Worst, lost_rate, whole
from sandbox.model.motion import load_at
from sandbox.numeric import Array


def load_figures(evidence: Evidence) -> Iterator[Figure]:
    """Forces and torques of all loads against their laws."""
    model, worst = evidence.model, Worst()
    for i, name in enumerate(model.loads.name):
        _compare(evidence, worst, i, name)
    yield worst.figure(
        "load.law", "", source="F = F(x, v, a, t)", none="there is no load",
        why="forces and torques of {count:load on a body|loads on bodies} from the recorded poses, "
            "velocities and accelerations, share of the largest of each, worst: {where}")


def _compare(evidence: Evidence, worst: Worst, i: int, name: str) -> None:
    a, loads, frames = evidence.run.arrays, evidence.model.loads, evidence.loads.frames
    body, h, n = int(loads.body[i]), evidence.h, frames.samples
    found = np.stack([a["load_force"][:, i, 0], a["load_force"][:, i, 1], a["load_torque"][:, i]])
    pose = np.stack([frames.centre_x[body], frames.centre_y[body], frames.angle[body]])
    acceleration, best = frames.acceleration[:, body], np.full((3, n), np.inf)
    error, allowed = best.copy(), best.copy()
    for velocity, ahead in ((evidence.velocity[:, body], 0.0),
                            (evidence.velocity_after[:, body], h)):
        if ahead and loads.law[i] is None:
            continue
        given = pose + ahead * velocity, velocity, acceleration
        law = load_at(evidence.model, i, *given, evidence.run.time)
        may = _may(evidence, i, given, law, ahead)
        most = max(whole(found[0]), whole(found[1]))  # a torque's rounding is that of its force
        size = np.array([[most]] * 2 + [[max(whole(found[2]), most * ROUNDING / EXACT)]])
        may = may + EXACT * size
        ratio = np.abs(found - law) / may
        closer = np.nan_to_num(ratio.max(axis=0), nan=np.inf) < best.max(axis=0)
        best, error, allowed = (np.where(closer, new, old) for new, old in (
            (ratio, best), (np.abs(found - law) / size, error), (may / size, allowed)))
    k, each = best.argmax(axis=0), np.arange(n)
    worst.add(name, error[k, each], allowed[k, each])


def _may(
    evidence: Evidence, i: int, given: tuple[Array, Array, Array], law: Array, ahead: float,
) -> Array:
    """What rounding of all that is recorded may make of a load, found by trying, [3, n]."""
    pose, velocity, acceleration = given
    may = np.zeros_like(law)
    for k in range(3):
        rate = lost_rate(velocity[k], turning=k == 2)
        off = np.zeros((3, 1))
        off[k] = 1.0
        size = float(np.abs(pose[k]).max(initial=0.0))
        for d in (-1.0, 1.0):
            moved = (pose + d * off * (ROUNDING * max(1.0, size) + ahead * rate),
                     velocity + d * off * rate, acceleration + d * off * 2 * rate / evidence.h)
            for tried in ((moved[0], velocity, acceleration), (pose, moved[1], acceleration),
                          (pose, velocity, moved[2])):
                other = load_at(evidence.model, i, *tried, evidence.run.time)
                may = np.fmax(may, np.abs(other - law))
    return may
