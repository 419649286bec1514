"""What broke in a run, in words."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.samples.stored import Stored

MOST = 8
"""How many are told one by one."""


def broken(run: Stored) -> Iterator[str]:
    """A sentence for each joint, spring and tendon that let go at its load, in order of time."""
    ties, springs = run.model.ties, run.model.springs
    turning = {ties.name[tie] for tie in ties.spring[~springs.straight].tolist() if tie >= 0}
    known = {name: float(most) for name, most in zip(ties.name, ties.breaks_at, strict=True)}
    broke = [one for one in run.info.broke if one.event in known]
    for one in broke[:MOST]:
        unit = "N m" if one.event in turning else "N"
        yield f"{one.event} broke at its load of {known[one.event]:g} {unit}, t = {one.time:.6g} s"
    if len(broke) > MOST:
        yield f"{len(broke) - MOST} more broke after that"
