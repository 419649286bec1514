"""The start of a run: half a step before t = 0, on its later path.

Poses belong to t = (k - 1/2) h and velocities to t = k h, so the first pose of the leapfrog is
that of t = -h/2. With the pose x0 and the velocity v0 of t = 0 and the acceleration a there it is

    x = x0 - h/2 v0 + h^2/8 a

which leads to x0 + h/2 v0 + h^2/8 a in the first step. That step gives a = (v1 - v0) / h; it is
repeated, because joints that are still open falsify it. An impact is no acceleration: a body that
is hit is not moved, and a motor's speed is reduced by its difference from the hinge's in trials.
"""

from __future__ import annotations

import numpy as np

from sandbox.engine.advance import UNKEPT, advance
from sandbox.engine.coordinates import rate
from sandbox.engine.memory import Memory
from sandbox.engine.records import PACED
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.numeric import Array

TIMES = 3  # each trial multiplies the error of a by some h


def start(world: World, tables: Tables, memory: Memory, drive: Array, speeds: Array) -> bool:
    """Put the bodies where the first step begins; False if a trial step lacked room."""
    first = world.body.copy()
    free = tables.constants.inverse_mass[:, 0] > 0
    saved, trial_drive = tables.saved(), drive[:1].copy()
    joints, motors = tables.elements.joints, tables.elements.motors
    for trial in range(TIMES):
        advance(memory.address, memory.h, trial_drive, speeds, UNKEPT, UNKEPT)
        if trial == 0:
            kept_speed = ((motors["mode"] == 0) & np.isfinite(motors["maximum"])
                          & np.isnan(motors["slope"]) & (motors["law"] == PACED))
            for motor in motors[kept_speed]:
                speed = motor["sense"] * rate(joints[motor["joint"]], first[:, 3:])
                at_start = (2 * drive[0] - drive[-1])[motor["drive"]]
                trial_drive[0, motor["drive"]] -= at_start - speed
        enough = not tables.state.touching[1]
        gained = memory.h / 8 * (world.velocity - first[:, 3:])
        hit = tables.state.touches["bounce"][:tables.state.touching[0]].any()
        for array, value in saved:
            array[...] = value
        shift = np.where(free[:, None] & np.isfinite(gained) & ~hit, gained, 0.0)
        world.place(first[:, :3] + shift, first[:, 3:])
        if not enough:
            return False
    return True
