"""How far from the plane of a contact a corner may be that presses."""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import DIGITS
from sandbox.numeric import Array
from sandbox.samples import patches


def pressed(evidence: Evidence, row: int) -> Array | None:
    """The places between which a contact row of the one sample may press.

    As :func:`sandbox.samples.patches.pressed` has them, to what the engine may leave.
    """
    a, h = evidence.run.arrays, evidence.h
    pair = int(a["contact_body"][row]), int(a["contact_other"][row])
    pose, velocity = a["body_pose"][0, pair], a["body_velocity"][0, pair]
    size = float(np.abs(pose[:, :2]).max())
    near = evidence.near + 8 * DIGITS * size + h * float(np.hypot(*velocity[:, :2].T).sum())
    return patches.pressed(evidence.run, row, near)
