"""What surfaces that run give: friction on what touches them, times their speed."""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.numeric import Array


def surface_power(evidence: Evidence, drive: int) -> Array:
    """From the forces of contacts and the drive's speed [W], [n].

    A row's force is on its ``body``, and its normal points into that; of the body that runs the
    outer normal is that way where it is the ``other``. To its left, counter-clockwise, it runs.
    """
    a, drives = evidence.run.arrays, evidence.model.drives
    body, force, normal = int(drives.target[drive]), a["contact_force"], a["contact_normal"]
    along = normal[:, 0] * force[:, 1] - normal[:, 1] * force[:, 0]
    on = (a["contact_body"] == body) | (a["contact_other"] == body)
    rubbed = np.bincount(a["contact_sample"][on], weights=along[on],
                         minlength=len(evidence.run))
    return np.asarray(drives.sense[drive] * a["drive_value"][:, drive] * rubbed)
