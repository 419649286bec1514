"""A thousand short runs by a sweep, and the same simulations in one bare loop; the first result."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.measure import Figure
from sandbox.engine.compiling import processors

SCENE, PATH = "single_finger", "parameters.pull"
LEAST = 0.95
"""Of what all processors can do."""
FIRST = 2.0
"""Seconds until the first row is there, start-up included."""
LOOP = """
import sys
import sandbox
for k in range(int(sys.argv[1])):
    pull = 2 + 6 * k / (int(sys.argv[1]) - 1)
    run = sandbox.simulate(sandbox.load_scene("{scene}", overrides={{"{path}": pull}}))
    float(run["finger.tendon.tension"][-1]), [verdict.ok for verdict in run.verdicts]
"""


def figures(*, quick: bool = False) -> list[Figure]:
    """The share of all processors that a sweep uses, against a loop in one process beside it."""
    runs = 20 if quick else 1000
    with tempfile.TemporaryDirectory() as folder:
        bare = _seconds([sys.executable, "-c", LOOP.format(scene=SCENE, path=PATH), str(runs)])
        began = time.perf_counter()
        process = subprocess.Popen(
            [sys.executable, "-m", "sandbox", "sweep", SCENE, "--vary", f"{PATH}=2:8:{runs}",
             "--keep", "finger.tendon.tension", "--no-audit", "--quiet", "--out", folder])
        rows = Path(folder, "rows", "00000.jsonl")
        while process.poll() is None and not (rows.exists() and rows.stat().st_size):
            time.sleep(0.005)
        first = time.perf_counter() - began
        process.wait()
        swept = time.perf_counter() - began
    share = bare / swept / min(processors(), runs)
    return [Figure("one bare loop", bare, "s"), Figure("the sweep", swept, "s"),
            Figure("share of all processors", share, "", least=LEAST),
            Figure("first row", first, "s", most=FIRST)]


def _seconds(words: list[str]) -> float:
    began = time.perf_counter()
    subprocess.run(words, check=True)
    return time.perf_counter() - began
