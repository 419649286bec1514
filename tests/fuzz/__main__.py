"""``python -m tests.fuzz [--count N] [--first SEED] [--recordings] [--show SEED]``."""

from __future__ import annotations

import argparse
import sys
from collections import Counter

from tests.fuzz import recordings
from tests.fuzz.inputs import make
from tests.fuzz.trial import attempt


def main(words: list[str] | None = None) -> int:
    """Try inputs, print every one with a fault, and return 1 if there is one."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("--count", type=int, default=1000, help="how many inputs")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--recordings", action="store_true", help="saved runs instead of scenes")
    parser.add_argument("--show", type=int, metavar="SEED", help="print an input and end")
    options = parser.parse_args(words)
    if options.show is not None:
        sys.stdout.buffer.write(recordings.make(options.show)["run.npz"] if options.recordings
                                else make(options.show))
        return 0
    stages, faults = Counter[str](), 0
    for seed in range(options.first, options.first + options.count):
        print(f"\r{seed}", end="", file=sys.stderr, flush=True)  # the last one if it kills us
        outcome = attempt(seed, recording=options.recordings)
        stages[outcome.stage] += 1
        if outcome.fault:
            faults += 1
            print(f"\rseed {outcome.seed}: {outcome.stage}: {outcome.fault}", flush=True)
    print(f"\r{faults} faults; last stages: {dict(stages.most_common())}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
