"""``python -m tests.growth``: how long ``check`` takes for scenes of n, 2 n and 4 n things.

Each scene is read and looked over in a process of its own, so that its memory is its own. What
takes more than its share (1 s and :data:`SHARE` for each MB of the file, beyond what a small
scene takes) or too much memory is marked, and the exit code is 1.
"""

from __future__ import annotations

import argparse
import json
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tests.growth.scenes import SCENES

MEMORY = 500.0
"""Of a check [MB]."""
FLOOR = 0.2
"""Seconds that even a small scene may take."""


def measure(path: str) -> None:
    """Print what a check of one file takes: seconds, MB, problems."""
    from sandbox.cli.check import report_of

    report_of("single_finger", {}, {})  # modules are loaded, and caches have what all scenes need
    began = time.perf_counter()
    report = report_of(path, {}, {})
    seconds = time.perf_counter() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    print(json.dumps([seconds, peak, len(report["errors"]) + len(report["findings"])]))


def main() -> int:
    """Measure the chosen kinds; 1 if one takes more than its share."""
    parser = argparse.ArgumentParser(prog="python -m tests.growth", description=__doc__)
    parser.add_argument("--count", type=int, default=500, help="n of the smallest scene")
    parser.add_argument("--times", type=int, nargs="+", default=[1, 2, 4])
    parser.add_argument("--only", default="", help="kinds with this in their name")
    parser.add_argument("--limit", type=float, default=60, help="seconds a check may take")
    parser.add_argument("--measure", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.measure:
        measure(given.measure)
        return 0
    slow = 0
    with tempfile.TemporaryDirectory() as folder:
        for kind in SCENES:
            if given.only in kind:
                slow += _kind(kind, given, Path(folder) / "scene.json")
    return int(slow > 0)


def _kind(kind: str, given: argparse.Namespace, path: Path) -> bool:
    cells, marked = [], False
    for times in given.times:
        path.write_text(SCENES[kind](given.count * times))
        size = path.stat().st_size / 1e6
        command = [sys.executable, "-m", "tests.growth", "--measure", str(path)]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=given.limit,
                                  check=True)
            seconds, peak, count = json.loads(done.stdout.splitlines()[-1])
        except subprocess.TimeoutExpired:
            seconds, peak, count = given.limit, 0.0, -1
        except subprocess.CalledProcessError as error:
            cells.append(error.stderr.strip().splitlines()[-1][:100])
            marked = True
            continue
        marked |= seconds > FLOOR + size or peak > MEMORY
        cells.append(f"{size:6.3f} MB {seconds:7.3f} s {peak:5.0f} MB {count:5d}")
    print(f"{'!' if marked else ' '} {kind:32}", " | ".join(cells), flush=True)
    return marked


if __name__ == "__main__":
    sys.exit(main())
