"""One mechanism run at several steps, and its quantities at instants that all of them share.

Poses of a run with step h belong to t = (k - 1/2) h, so runs at h and h/2 have
no instant in common. A refined run is therefore sampled every step, and its
quantities are read at the coarse run's instants through the cubic of the four
nearest samples: an error of fourth order, below what is looked for. Where four
samples jump, as at a touch (their third difference is then as large as the
second), the cubic is kept within their range.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.scene.elements.controllers import every
from sandbox.scene.mechanism import Mechanism


def refined(mechanism: Mechanism, *, parts: int = 1) -> Mechanism:
    """The mechanism with a step ``parts`` times finer.

    Sampled every step if finer; otherwise as it was. Controllers and events keep the rates that
    they have at the mechanism's own step, also where that is the one nearest to 1 kHz.
    """
    run = mechanism.run
    update: dict[str, float] = {}
    if parts > 1:
        step = run.step / parts
        update = {"step": step, "sample_rate": 1 / step}
    kept: dict[str, Any] = {
        kind: tuple(each.model_copy(update={"rate": 1 / (every(each.rate, run.step) * run.step)})
                    for each in getattr(mechanism, kind)) for kind in ("controllers", "events")}
    return mechanism.model_copy(update={"run": run.model_copy(update=update), **kept})


def at_instants(time: Array, values: Array, wanted: Array) -> Array:
    """``values`` [n] at ``time`` [n], evenly spaced, read at the instants ``wanted`` [m].

    Raises:
        ValueError: fewer than four samples.
    """
    if len(time) < 4:
        raise ValueError(f"time must hold at least 4 samples, got {len(time)}")
    spacing = (time[-1] - time[0]) / (len(time) - 1)
    place = (wanted - time[0]) / spacing
    first = np.clip(np.floor(place).astype(int) - 1, 0, len(time) - 4)
    u = place - first
    near = values[first[:, None] + np.arange(4)]
    weights = np.stack([
        -(u - 1) * (u - 2) * (u - 3) / 6, u * (u - 2) * (u - 3) / 2,
        -u * (u - 1) * (u - 3) / 2, u * (u - 1) * (u - 2) / 6], axis=1)
    read = (weights * near).sum(axis=1)
    bend = np.abs(np.diff(near, n=2, axis=1)).max(axis=1)
    jumps = np.abs(np.diff(near, n=3, axis=1))[:, 0] > 0.5 * bend
    kept = np.clip(read, near.min(axis=1), near.max(axis=1))
    return np.asarray(np.where(jumps & (u >= 0) & (u <= 3), kept, read))
