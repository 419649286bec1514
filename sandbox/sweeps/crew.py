"""How many worker processes there are."""

from __future__ import annotations

import os

from sandbox.errors import SandboxError

MOST_EACH = 4
"""Workers for each processor, at most: a run keeps one busy, and a worker takes some 200 MB."""


def processors() -> int:
    """How many this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


def crew_of(workers: int) -> int:
    """How many workers are begun where so many are asked for; of 0 one for each processor.

    Raises:
        SandboxError: more than :data:`MOST_EACH` for each processor, or fewer than none.
    """
    most = MOST_EACH * processors()
    if not 0 <= workers <= most:
        raise SandboxError(f"{workers} worker processes are not begun (allowed: 1 to {most}, "
                           f"{MOST_EACH} for each processor)", code="limit-exceeded")
    return workers or processors()
