"""What broke in a run, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.samples.stored import Stored

MOST = 8
"""How many are told one by one."""


def broken(run: Stored) -> Iterator[str]:
    """A sentence for each joint, spring and tendon that let go at its load, in order of time.

    What an event let go in the same sample is not among them: the run tells of the event.
    """
    held = run.arrays["held"]
    if not held.size or not len(run):
        return
    ties, time = run.model.ties, run.time
    before = np.vstack([ties.held[None], held[:-1] > 0])
    samples, which = np.nonzero(before & ~(held > 0))
    released = {event.name: event.release for event in run.mechanism.events if event.release}
    let_go = [(happened.time, released[happened.event]) for happened in run.info.events
              if happened.event in released]
    apart = float(time[1] - time[0]) if len(time) > 1 else np.inf
    told = 0
    for sample, tie in zip(samples.tolist(), which.tolist(), strict=True):
        name, at = ties.name[tie], float(time[sample])
        if not np.isfinite(ties.breaks_at[tie]) or any(
                name in names and abs(at - instant) <= 1.5 * apart for instant, names in let_go):
            continue
        told += 1
        if told <= MOST:
            yield f"{name} broke at its load of {ties.breaks_at[tie]:g}, t = {at:.6g} s"
    if told > MOST:
        yield f"{told - MOST} more broke after that"
