"""What is measured of runs of several trials."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from tests.hard.trial import AtMost, Measure


def late(run: Recording, seconds: float) -> np.ndarray:
    """Which samples belong to the last so many seconds."""
    return run.time > run.info.step * run.info.steps - seconds


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
