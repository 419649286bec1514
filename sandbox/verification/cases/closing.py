"""The motion that the geometric cases share: the finger of Set G closing freely under 3 N."""

from __future__ import annotations

from functools import cache

import numpy as np

from sandbox.engine.simulate import simulate
from sandbox.mechanics.chain import pose, to_world, transforms
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import BODIES, HINGES, finger
from sandbox.study.reference_fingers import SET_G

MECHANISM = "finger of Set G, straight, closing freely under 3 N for 0.06 s, h = 0.5 ms"


@cache
def closing() -> Recording:
    """The run, sampled every step."""
    return simulate(finger(SET_G, pull=3.0, duration=0.06, step=5e-4, stops=False,
                           run={"sample_rate": 2000.0}))


def angles(run: Recording) -> Array:
    """Of the joints [rad], shape [n, 3]."""
    return np.stack([run[f"{hinge}.angle"] for hinge in HINGES], axis=1)


def origins(run: Recording) -> Array:
    """Where the engine has the phalanges' near hinges [m], shape [n, 3, 2]."""
    return np.stack([np.stack([run[f"{body}.x"], run[f"{body}.y"]], axis=1)
                     for body in BODIES], axis=1)


def gaps(run: Recording) -> Array:
    """How far the engine's hinges have drifted apart [m], shape [n, 3].

    The angle between two bodies is right however far their hinge gapes, so a
    length over a hinge is off by the hinge's gap, a point by those before it.
    """
    ends = np.zeros((len(run), 3, 2))
    at = origins(run)
    for i in range(1, 3):
        angle = run[f"{BODIES[i - 1]}.angle"]
        along = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        ends[:, i] = at[:, i - 1] + SET_G.lengths[i - 1] * along
    return np.asarray(np.linalg.norm(at - ends, axis=2))


def gap_bounds(run: Recording) -> Array:
    """How far a step may move the hinges apart [m], shape [3].

    A body moves along its velocity for h: its hinge, r from the centre of mass, leaves its circle
    by r (omega h)^2 / 2, which the solve allows for with the omega of the step before; what is left
    is r omega alpha h^3 across and, of the sine, r (omega h)^3 / 6 along. The next step closes it.
    """
    spin = np.stack([np.zeros(len(run)), *(run[f"{body}.omega"] for body in BODIES)])
    faster = np.stack([np.zeros(len(run)), *(run[f"{body}.alpha"] for body in BODIES)])
    half = np.array([0.0, *SET_G.lengths]) / 2
    left = half[:, None] * run.info.step**3 * (np.abs(spin * faster) + np.abs(spin)**3 / 6)
    return np.asarray((left[:-1] + left[1:]).max(axis=1))


def segments(run: Recording) -> Array:
    """Distances between the tendon's guides where the engine has them [m], shape [n, 3]."""
    at = origins(run)
    angle = np.stack([run[f"{body}.angle"] for body in BODIES], axis=1)
    palm = np.broadcast_to(np.eye(3), (len(run), 1, 3, 3))
    frames = np.concatenate([palm, pose(at[..., 0], at[..., 1], angle)], axis=1)
    eyes = to_world(frames, np.array(SET_G.guides))
    return np.asarray(np.linalg.norm(np.diff(eyes, axis=1), axis=2))


def closed_tips(run: Recording) -> Array:
    """Far ends of the phalanges by (31) [m], shape [n, 3, 2]."""
    far = np.stack([np.array(SET_G.lengths), np.zeros(3)], axis=1)
    return to_world(transforms(angles(run), SET_G.lengths), far)
