"""``python -m tests.fuzz [--count N] [--first SEED] [--show SEED]``, from the top of a checkout."""

from __future__ import annotations

import argparse
import collections
import json
import queue
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Generator, Iterator

from tests.fuzz import recordings
from tests.fuzz.inputs import make
from tests.fuzz.trial import Outcome

HANG = 30.0
"""After which a process that says nothing is ended [s]; an input that takes 5 s is told anyway."""
START = 300.0
"""The same before the first input, while the engine is compiled."""


def main(words: list[str] | None = None) -> int:
    """Try inputs, print every one with a fault, and return 1 if there is one."""
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz", description=(
        "Scenes of strangers: each is made from its seed, read, looked over, run for some steps, "
        "saved, loaded and drawn. Faults are exceptions, a process that dies, more than 5 s, "
        "more than 500 MB."))
    parser.add_argument("--count", type=int, default=1000, metavar="N", help="how many inputs")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="the first seed")
    parser.add_argument("--recordings", action="store_true",
                        help="saved runs in place of scenes; each is loaded, looked at, judged, "
                             "audited, plotted, saved again and drawn")
    parser.add_argument("--show", type=int, metavar="SEED", help="print an input and end")
    options = parser.parse_args(words)
    if options.show is not None:
        sys.stdout.buffer.write(recordings.make(options.show)["run.npz"] if options.recordings
                                else make(options.show))
        return 0
    stages: collections.Counter[str] = collections.Counter()
    faults, began = 0, time.perf_counter()
    for outcome in outcomes(options.first, options.first + options.count,
                            recording=options.recordings):
        stages[outcome.stage] += 1
        if outcome.fault:
            faults += 1
            print(f"seed {outcome.seed}: {outcome.stage}: {outcome.fault}", flush=True)
    print(f"{sum(stages.values())} inputs from seed {options.first} on, {faults} faults, "
          f"{time.perf_counter() - began:.0f} s; how far they came: "
          + ", ".join(f"{stage} {count}" for stage, count in stages.most_common()))
    return 1 if faults else 0


def outcomes(first: int, last: int, *, recording: bool = False) -> Iterator[Outcome]:
    """Of every seed in order, by as many processes as it takes: one that dies is replaced."""
    while first < last:
        seed = first
        for outcome in _by_one_process(first, last, recording=recording):
            yield outcome
            seed = outcome.seed + 1
        first = seed if seed > first else first + 1


def _by_one_process(first: int, last: int, *, recording: bool) -> Iterator[Outcome]:
    """Until it is done, dies or hangs, which is the last outcome then."""
    words = [sys.executable, "-m", "tests.fuzz.worker", str(first), str(last),
             *(["recordings"] if recording else [])]
    with tempfile.TemporaryFile("w+") as errors, subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=errors, text=True) as process:
        seed = yield from _listened(process, first)
        process.wait()
        errors.seek(0)
        last_words = (errors.read().strip().splitlines() or [""])[-1][:200]
    if process.returncode and seed is None:
        raise SystemExit(f"the worker cannot begin: {last_words}")
    if seed is not None and seed >= 0:
        yield Outcome(seed, "dies", 0.0,
                      f"the process ended with {process.returncode}: {last_words}")


def _listened(process: subprocess.Popen[str], first: int) -> Generator[Outcome, None, int | None]:
    """What a process tells; the seed that it did not end with, -1 if it ended with all."""
    lines: queue.Queue[str | None] = queue.Queue()
    listener = threading.Thread(target=_listen, args=(process, lines))
    listener.start()
    seed, wait = None, START
    try:
        while (line := lines.get(timeout=wait)) is not None:
            told = json.loads(line)
            if "begins" in told:
                seed, wait = int(told["begins"]), HANG
            else:
                seed = -1
                yield Outcome(**told)
    except queue.Empty:
        process.kill()
        yield Outcome(first if seed is None else seed, "hangs", wait, "no end of it")
        seed = -1
    listener.join()
    return seed


def _listen(process: subprocess.Popen[str], lines: queue.Queue[str | None]) -> None:
    assert process.stdout is not None
    for line in process.stdout:
        lines.put(line)
    lines.put(None)


if __name__ == "__main__":
    sys.exit(main())
