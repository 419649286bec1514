"""What broke in a run, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.kinds.elements import HELD_ABOVE
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
    events = {event.name: event for event in run.mechanism.events}
    let_go = []
    for happened in run.info.events:
        event = events[happened.event]
        let_go.append((happened.time, event.release))
        if event.lasts is not None:  # at its end it lets go of what it took up
            let_go.append((happened.time + event.lasts, event.take_up))
    springs = run.model.springs
    turning = set(run.model.ties.spring[~springs.straight].tolist())
    apart = float(time[1] - time[0]) if len(time) > 1 else np.inf
    told = 0
    for sample, tie in zip(samples.tolist(), which.tolist(), strict=True):
        name, at = ties.name[tie], float(time[sample])
        drive = int(ties.drive[tie])
        driven = drive >= 0 and bool(
            (run.arrays["drive_value"][sample - 1:sample + 1, drive] <= HELD_ABOVE).any())
        if driven or not np.isfinite(ties.breaks_at[tie]) or any(
                name in names and abs(at - instant) <= 1.5 * apart for instant, names in let_go):
            continue
        told += 1
        if told <= MOST:
            unit = "N m" if tie in turning else "N"
            yield f"{name} broke at its load of {ties.breaks_at[tie]:g} {unit}, t = {at:.6g} s"
    if told > MOST:
        yield f"{told - MOST} more broke after that"
