"""Equations (32)-(33): reactions by the recursion against the impulses of pymunk's solver."""

from __future__ import annotations

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
from sandbox.mechanics.springs import end_forces
from sandbox.mechanics.tendon import guide_forces
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import BODIES, HINGES, G, finger
from sandbox.study.reference_fingers import SET_G
from sandbox.verification.cases.case import Case, Check, Findings
from sandbox.verification.cases.closing import gaps


def reactions(run: Recording, gravity: tuple[float, float]) -> tuple[Array, Array]:
    """Forces on the phalanges at their hinges [N] [n, 3, 2], and moments left over [N m] [n, 3]."""
    index = [run.catalogue.elements[name].index for name in BODIES]
    at, a = run.arrays["body_pose"][:, index], run.arrays["body_acceleration"][:, index]
    frames = pose(at[..., 0], at[..., 1], at[..., 2])
    turn = frames[..., :2, :2]
    omega = run.arrays["body_velocity"][:, index, 2]
    centre = np.array([(length / 2, 0.0) for length in SET_G.lengths])
    own = np.einsum("...ji,...j->...i", turn, a[..., :2])
    hinge = origin_acceleration(own, omega, a[..., 2], centre)
    pull = np.einsum("...ji,j->...i", turn, np.array(gravity))
    phi = external_action(
        acceleration_matrix(omega, a[..., 2], hinge),
        inertia_matrix(np.array(SET_G.masses), centre, np.array(SET_G.inertias)),
        gravity=gravity_matrix(pull), applied=_loads(run, frames))
    found = hinge_reactions(transmitted_actions(phi, links_between(frames)), frames)
    return found.force, found.moment


def _loads(run: Recording, frames: Array) -> Array:
    """The applied actions of tendon, springs and hinge friction, in the frames, [n, 3, 3, 3]."""
    n = len(run)
    palm = np.broadcast_to(np.eye(3), (n, 1, 3, 3))
    carriers = np.concatenate([palm, frames], axis=1)
    eyes = to_world(carriers, np.array(SET_G.guides))
    pulls = guide_forces(eyes, np.repeat(run["finger.tendon.tension"][:, None], 3, axis=1))
    total = np.zeros((n, 3, 3, 3))
    total += _action(frames, pulls[:, 1:], np.array(SET_G.guides)[1:])
    damping = np.stack([run.arrays["joint_damping"][:, run.catalogue.elements[hinge].index]
                        for hinge in HINGES], axis=1)
    for i in range(3):
        hinge_at = (0.0 if i == 0 else SET_G.lengths[i - 1], 0.0)
        near_at = np.add(SET_G.before[i], hinge_at)
        near = to_world(carriers[:, i:i + 1], near_at[None])[:, 0]
        far = to_world(frames[:, i:i + 1], np.array(SET_G.after[i])[None])[:, 0]
        on_near, on_far = end_forces(near, far, run[f"finger.spring{i + 1}.force"])
        total[:, i] += _action(frames[:, i], on_far, np.array(SET_G.after[i]))
        total[:, i] += couple_action(-damping[:, i])  # the joints' sense is clockwise
        if i:
            total[:, i - 1] += _action(frames[:, i - 1], on_near, near_at)
            total[:, i - 1] += couple_action(damping[:, i])
    return total


def _action(frames: Array, force: Array, point: Array) -> Array:
    own = np.einsum("...ji,...j->...i", frames[..., :2, :2], force)
    return force_action(own, np.broadcast_to(point, own.shape))


def _dynamics() -> Findings:
    gravity = (2.0, -G)
    run = simulate(finger(SET_G, pull=3.0, duration=0.06, step=5e-4, stops=False,
                          gravity=gravity, run={"sample_rate": 2000.0}))
    force, moment = reactions(run, gravity)
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
    return Findings(checks, [Panel("Reactions of the hinges", "time [ms]", "reaction [N]",
                                   curves)])


CASES = (
    Case("reactions", "Joint reactions by recursion", "(32)–(33)",
         "finger of Set G closing freely under 3 N and gravity for 0.06 s, h = 0.5 ms",
         "size of the reactions from recorded accelerations, tension, springs and damping with "
         "the impulse / h of the solver's joints", _dynamics),
)
