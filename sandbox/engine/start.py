"""How a run starts: half a step before t = 0, on the path that it will take.

Poses belong to t = (k - 1/2) h and velocities to t = k h, so the first pose of the leapfrog is
that of t = -h/2. With the pose x0 and the velocity v0 of t = 0 and the acceleration a there it is

    x = x0 - h/2 v0 + h^2/8 a

which leads to x0 + h/2 v0 + h^2/8 a in the first step. What a is the first step itself tells,
(v1 - v0) / h; it is made a few times over, because joints that were not yet closed falsify it.
"""

from __future__ import annotations

import numpy as np

from sandbox.engine.advance import advance
from sandbox.engine.memory import Memory
from sandbox.engine.tables import WORKSPACE, Tables
from sandbox.engine.world import World
from sandbox.numeric import Array

TIMES = 3
"""Each leaves of the error of a the share that the first pose's error had in it, some h."""


def start(world: World, tables: Tables, memory: Memory, drive: Array, speeds: Array) -> bool:
    """Put the bodies of a run where its first step begins; False for no room to find out where.

    Nothing is moved where a body is hit in the first step: that is no acceleration.

    Args:
        world: with all bodies half a step back along their velocities.
        tables: of the run.
        memory: of the run.
        drive: values of the drives in the first step, [1, nd].
        speeds: velocities of scheduled bodies after it, [1, ns, 3].
    """
    first = world.body.copy()
    free = tables.constants.inverse_mass[:, 0] > 0
    results = tables.result._asdict()
    changing = [*tables.state, *(results[name] for name in results if name not in WORKSPACE)]
    kept = [array.copy() for array in changing]
    shift = np.zeros((len(first), 3))
    for _ in range(TIMES):
        advance(memory.table, memory.h, drive, speeds)
        enough = not tables.state.touching[1]
        gained = memory.h / 8 * (world.velocity - first[:, 3:])
        hit = tables.state.touches["bounce"][:tables.state.touching[0]].any()
        for array, value in zip(changing, kept, strict=True):
            array[...] = value
        shift = np.where(free[:, None] & np.isfinite(gained) & ~hit, gained, 0.0)
        world.place(first[:, :3] + shift, first[:, 3:])
        if not enough:
            return False
    return True
