"""Does inputs in a process of their own: ``python -m tests.fuzz.worker FIRST LAST [recordings]``.

It tells each seed before it begins with it and how that ended, a line of JSON each, so that who
reads them knows which input killed it.
"""

from __future__ import annotations

import json
import resource
import sys
from dataclasses import asdict

from tests.fuzz.trial import attempt, warm

MEGABYTES = 500
"""By which inputs may raise the most memory that the process has had."""


def main(first: int, last: int, *, recording: bool = False) -> None:
    """Do the seeds from ``first`` to before ``last``."""
    warm()
    began = _peak()
    for seed in range(first, last):
        _tell({"begins": seed})
        outcome = asdict(attempt(seed, recording=recording))
        grown = _peak() - began
        if grown > MEGABYTES:
            outcome["fault"] = outcome["fault"] or f"took {grown:.0f} MB"
        _tell(outcome)
        if grown > MEGABYTES:
            return  # what is measured is a peak: the next inputs need a process that had none


def _peak() -> float:
    """The most memory that this process has had [MB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def _tell(what: dict[str, object]) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), recording="recordings" in sys.argv)
