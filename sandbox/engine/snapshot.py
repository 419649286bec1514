"""What a sample keeps of the tables, copied by compiled code into one row of the sampler."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sandbox.engine.native import call_for_real

Array = NDArray[np.float64]
Records = NDArray[Any]


class Snapshot(NamedTuple):
    """Memory for the raw numbers of samples, an axis of samples before all others.

    ``state`` [nb, 6] and ``before`` [nb, 3] hold velocities after and before the
    step, ``predicted`` [nb, 3] the pose at which forces were worked out;
    ``springs`` and ``spans`` [e, 4] length, force, work and the step's share of
    it; ``dampers`` and ``actions`` [e, 3] torque, work, share;
    ``impulses`` the sizes of all joints' and stops' impulses [N s, N m s].
    """

    state: Array
    before: Array
    predicted: Array
    springs: Array
    spans: Array
    dampers: Array
    actions: Array
    impulses: Array


def make_snapshot(
    samples: int, bodies: int, springs: int, spans: int, dampers: int, actions: int, impulses: int,
) -> Snapshot:
    """Memory for so many samples of so many elements."""
    shapes = ((bodies, 6), (bodies, 3), (bodies, 3), (springs, 4), (spans, 4), (dampers, 3),
              (actions, 3), (impulses,))
    return Snapshot(*(np.empty((samples, *shape)) for shape in shapes))


@njit(cache=True)
def take(
    kept: Snapshot, n: int, state: Array, before: Array, predicted: Array,
    springs: Records, spans: Records, dampers: Records, actions: Records,
    get_impulse: int, handles: NDArray[np.int64],
) -> None:
    """Copy the step just made into row ``n`` of ``kept``.

    ``handles`` are addresses of the constraints whose impulse ``get_impulse`` tells.
    """
    kept.state[n] = state
    kept.before[n] = before
    kept.predicted[n] = predicted
    for i in range(len(springs)):
        s = springs[i]
        kept.springs[n, i, 0], kept.springs[n, i, 1] = s["length"], s["force"]
        kept.springs[n, i, 2], kept.springs[n, i, 3] = s["work"], s["gain"]
    for i in range(len(spans)):
        t = spans[i]
        kept.spans[n, i, 0], kept.spans[n, i, 1] = t["length"], t["tension"]
        kept.spans[n, i, 2], kept.spans[n, i, 3] = t["work"], t["gain"]
    for i in range(len(dampers)):
        d = dampers[i]
        kept.dampers[n, i, 0], kept.dampers[n, i, 1], kept.dampers[n, i, 2] = (
            d["torque"], d["work"], d["gain"])
    for i in range(len(actions)):
        s = actions[i]
        kept.actions[n, i, 0], kept.actions[n, i, 1], kept.actions[n, i, 2] = (
            s["torque"], s["work"], s["gain"])
    for i in range(len(handles)):
        kept.impulses[n, i] = call_for_real(get_impulse, handles[i])
