"""Equations (32)-(33): reactions by the recursion, by cuts, and by the impulses of the solver."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import links_between, pose, to_world
from sandbox.mechanics.dynamics import (
    acceleration_matrix,
    couple_action,
    external_action,
    force_action,
    gravity_matrix,
    hinge_reactions,
    inertia_matrix,
    transmitted_actions,
)
from sandbox.mechanics.motion import origin_acceleration
from sandbox.mechanics.reactions import gather_loads, joint_reactions
from sandbox.mechanics.springs import end_forces
from sandbox.mechanics.tendon import guide_forces
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import BODIES, HINGES, G, finger
from sandbox.study.reference_fingers import SET_G
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.verification.cases.closing import gaps

CENTRES: Array = np.array([(length / 2, 0.0) for length in SET_G.lengths])
"""Of mass, in the phalanges' frames [m]."""


class Load(NamedTuple):
    """A force on a phalanx."""

    body: int
    point: Array
    """Where it acts, in the phalanx's frame [m], shape [2]."""
    force: Array
    """In the world [N], shape [n, 2]."""


def reactions(run: Recording, gravity: tuple[float, float]) -> tuple[Array, Array]:
    """Forces on the phalanges at their hinges [N] [n, 3, 2], and moments left over [N m] [n, 3]."""
    frames, omega, a = _motion(run)
    rotation = frames[..., :2, :2]
    own = np.einsum("...ji,...j->...i", rotation, a[..., :2])
    hinge = origin_acceleration(own, omega, a[..., 2], CENTRES)
    pull = np.einsum("...ji,j->...i", rotation, np.array(gravity))
    applied = couple_action(_friction(run))
    for load in _loads(run, frames):
        applied[:, load.body] += _action(frames[:, load.body], load)
    phi = external_action(
        acceleration_matrix(omega, a[..., 2], hinge),
        inertia_matrix(np.array(SET_G.masses), CENTRES, np.array(SET_G.inertias)),
        gravity=gravity_matrix(pull), applied=applied)
    found = hinge_reactions(transmitted_actions(phi, links_between(frames)), frames)
    return found.force, found.moment


def reactions_by_cuts(run: Recording, gravity: tuple[float, float]) -> Array:
    """The same forces [N] [n, 3, 2] by d'Alembert on all that lies beyond a hinge, in the world."""
    frames, _, a = _motion(run)
    loads, samples = _loads(run, frames), len(run)
    centres = to_world(frames, CENTRES)
    at = np.concatenate([to_world(frames[:, load.body, None], load.point[None])[:, 0]
                         for load in loads])
    force, moment = gather_loads(
        centres, np.repeat([load.body for load in loads], samples), at,
        np.concatenate([load.force for load in loads]),
        sample=np.tile(np.arange(samples), len(loads)))
    masses = np.array(SET_G.masses)
    return joint_reactions(
        frames[..., :2, 2], centres, a[..., :2], a[..., 2], masses, np.array(SET_G.inertias),
        force + masses[:, None] * np.array(gravity), moment + _friction(run)).force


def _motion(run: Recording) -> tuple[Array, Array, Array]:
    """Frames [n, 3, 3, 3], angular velocities [n, 3], accelerations [n, 3, 3] of the phalanges."""
    index = [run.catalogue.elements[name].index for name in BODIES]
    at, a = run.arrays["body_pose"][:, index], run.arrays["body_acceleration"][:, index]
    frames = pose(at[..., 0], at[..., 1], at[..., 2])
    return frames, run.arrays["body_velocity"][:, index, 2], a


def _loads(run: Recording, frames: Array) -> list[Load]:
    """What tendon and springs do to the phalanges."""
    palm = np.broadcast_to(np.eye(3), (len(run), 1, 3, 3))
    carriers = np.concatenate([palm, frames], axis=1)
    guides = np.array(SET_G.guides)
    pulls = guide_forces(to_world(carriers, guides),
                         np.repeat(run["finger.tendon.tension"][:, None], 3, axis=1))
    loads = [Load(i, guides[i + 1], pulls[:, i + 1]) for i in range(3)]
    for i in range(3):
        hinge_at = (0.0 if i == 0 else SET_G.lengths[i - 1], 0.0)
        near_at, far_at = np.add(SET_G.before[i], hinge_at), np.array(SET_G.after[i])
        near = to_world(carriers[:, i:i + 1], near_at[None])[:, 0]
        far = to_world(frames[:, i:i + 1], far_at[None])[:, 0]
        on_near, on_far = end_forces(near, far, run[f"finger.spring{i + 1}.force"])
        loads.append(Load(i, far_at, on_far))
        if i:
            loads.append(Load(i - 1, near_at, on_near))
    return loads


def _friction(run: Recording) -> Array:
    """Moments of the hinges' viscous friction on the phalanges, counter-clockwise [N m], [n, 3]."""
    damping = np.stack([run.arrays["joint_damping"][:, run.catalogue.elements[hinge].index]
                        for hinge in HINGES], axis=1)
    beyond = np.concatenate([damping[:, 1:], np.zeros((len(run), 1))], axis=1)
    return np.asarray(beyond - damping)  # the joints' sense is clockwise


def _action(frames: Array, load: Load) -> Array:
    own = np.einsum("...ji,...j->...i", frames[..., :2, :2], load.force)
    return force_action(own, np.broadcast_to(load.point, own.shape))


def _dynamics() -> Findings:
    gravity = (2.0, -G)
    run = simulate(finger(SET_G, pull=3.0, duration=0.06, step=5e-4, stops=False,
                          gravity=gravity, run={"sample_rate": 2000.0}))
    force, moment = reactions(run, gravity)
    cuts = reactions_by_cuts(run, gravity)
    size = np.linalg.norm(force, axis=2)
    checks, curves = [], []
    ms = 1e3 * run.time
    for i, hinge in enumerate(HINGES):
        solver = run[f"{hinge}.reaction"]
        checks.append(Check(
            f"reaction of {hinge}: largest relative difference", "1", 0.0,
            float((np.abs(size[:, i] - solver) / solver.max()).max()), 1e-6,
            "what the project asks of reactions in motion"))
        curves += [Curve(f"{hinge}, (32)–(33)", ms, size[:, i]),
                   Curve(f"{hinge}, solver", ms[::6], solver[::6], "points")]
    arm = size.max() * max(SET_G.lengths)
    checks.append(Check("moment left over at the hinges, of reaction times phalanx", "1", 0.0,
                        float(np.abs(moment).max() / arm),
                        float(gaps(run).sum(axis=1).max() / max(SET_G.lengths)),
                        "an ideal hinge carries no moment; the solver's two halves of a hinge act "
                        "as far apart as the hinge gapes"))
    checks.append(Check("the recursion against cuts through the hinges, of the largest reaction",
                        "1", 0.0, float(np.abs(force - cuts).max() / size.max()), 1e-13,
                        "some hundred operations on the largest force that occurs"))
    return Findings(checks, [Panel("Reactions of the hinges", "time [ms]", "reaction [N]",
                                   curves)])


CASES = (
    Case("reactions", "Joint reactions by recursion", "(32)–(33)",
         "finger of Set G closing freely under 3 N and gravity for 0.06 s, h = 0.5 ms",
         "size of the reactions from recorded accelerations, tension, springs and damping with "
         "the impulse / h of the solver's joints, and with sums over all that lies beyond a hinge",
         _dynamics),
)
