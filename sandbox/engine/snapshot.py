"""What a sample keeps of a step, copied by compiled code into one row of the sampler."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numba import njit

from sandbox.engine.native import call_for_real
from sandbox.engine.state import Constants, Result, State
from sandbox.numeric import Array, Integers


class Snapshot(NamedTuple):
    """Memory for the raw numbers of samples, an axis of samples before all others.

    ``work`` counts up to the end of the step, ``step_work`` is that step's part of it [J].
    """

    body: Array
    """Poses, and velocities after the step, [n, nb, 6]."""
    before: Array
    """Velocities before the step, [n, nb, 3]."""
    pose: Array
    """Predicted, [n, nb, 3]."""
    springs: Array
    """Length [m], force [N], work, step_work, [n, ns, 4]."""
    cords: Array
    """Length [m], tension [N], work, step_work, [n, nt, 4]."""
    dampers: Array
    """Torque [N m], work, step_work, [n, nh, 3]."""
    actions: Array
    """Torque [N m], work, step_work, [n, na, 3]."""
    impulses: Array
    """Sizes of the impulses of all joints and stops [N s, N m s]."""


def make_snapshot(samples: int, constants: Constants, impulses: int) -> Snapshot:
    """Memory for so many samples of a run, with so many impulses in each."""
    bodies = len(constants.inverse_mass)
    shapes = ((bodies, 6), (bodies, 3), (bodies, 3), (len(constants.springs), 4),
              (len(constants.cords), 4), (len(constants.dampers), 3),
              (len(constants.actions), 3), (impulses,))
    return Snapshot(*(np.empty((samples, *shape)) for shape in shapes))


@njit(cache=True, inline="always")
def take(
    kept: Snapshot, n: int, state: State, result: Result, get_impulse: int, handles: Integers,
) -> None:
    """Copy the step just made into row ``n`` of ``kept``.

    ``handles`` are addresses of the constraints whose impulse ``get_impulse`` gives.
    """
    for i in range(len(state.body)):  # an assignment of arrays would compile its error messages
        for j in range(6):
            kept.body[n, i, j] = state.body[i, j]
        for j in range(3):
            kept.before[n, i, j] = state.before[i, j]
            kept.pose[n, i, j] = result.pose[i, j]
    for i in range(len(result.springs)):
        s = result.springs[i]
        kept.springs[n, i, 0], kept.springs[n, i, 1] = s["length"], s["force"]
        kept.springs[n, i, 2], kept.springs[n, i, 3] = state.springs[i]["work"], s["step_work"]
    for i in range(len(result.cords)):
        t = result.cords[i]
        kept.cords[n, i, 0], kept.cords[n, i, 1] = t["length"], t["tension"]
        kept.cords[n, i, 2], kept.cords[n, i, 3] = state.cords[i]["work"], t["step_work"]
    for i in range(len(result.dampers)):
        d = state.dampers[i]
        kept.dampers[n, i, 0], kept.dampers[n, i, 1] = d["torque"], d["work"]
        kept.dampers[n, i, 2] = result.dampers[i]["step_work"]
    for i in range(len(result.actions)):
        a = result.actions[i]
        kept.actions[n, i, 0], kept.actions[n, i, 1] = a["torque"], state.actions[i]["work"]
        kept.actions[n, i, 2] = a["step_work"]
    for i in range(len(handles)):
        kept.impulses[n, i] = call_for_real(get_impulse, handles[i])
