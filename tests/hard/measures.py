"""What is measured of runs of several trials."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from tests.hard.trial import AtMost, Measure

GRAVITY = 9.81


def late(run: Recording, seconds: float) -> np.ndarray:
    """Which samples belong to the last so many seconds."""
    return run.time > run.info.step * run.info.steps - seconds


def energy(run: Recording, gravity: float = GRAVITY) -> np.ndarray:
    """Kinetic and of weight [J], of all bodies that move, shape [n]."""
    moving = np.isfinite(run.arrays["body_mass"])
    m, inertia = run.arrays["body_mass"][moving], run.arrays["body_inertia"][moving]
    pose, centre = run.arrays["body_pose"][:, moving], run.arrays["body_centre"][moving]
    velocity = run.arrays["body_velocity"][:, moving]
    turn = pose[..., 2]
    height = pose[..., 1] + np.sin(turn) * centre[:, 0] + np.cos(turn) * centre[:, 1]
    kinetic = 0.5 * (velocity[..., :2]**2).sum(axis=-1) @ m + 0.5 * velocity[..., 2]**2 @ inertia
    return np.asarray(kinetic + gravity * height @ m)


def gap(run: Recording) -> float:
    """Largest distance between what a pin holds together, as a share of the mechanism's size."""
    joints = run.model.joints
    pivots = joints.pivots
    pose, anchor = run.arrays["body_pose"], joints.anchor[pivots]
    ends = []
    for side in (0, 1):
        at = pose[:, joints.bodies[pivots, side]]
        turned = np.exp(1j * at[..., 2]) * (anchor[:, side] @ [1, 1j])
        ends.append(at[..., 0] + 1j * at[..., 1] + turned)
    size = np.hypot(np.ptp(ends[1].real, axis=1), np.ptp(ends[1].imag, axis=1)).max()
    return float(np.abs(ends[1] - ends[0]).max() / size)


GAP = Measure("gap of pins", "", gap)


def closed(step: float) -> AtMost:
    """Pins stay closed at a step [s]."""
    return AtMost(GAP.name, step, 1e-6, "asked: of the mechanism's size")
