"""The command as a user waits for it: processes, imports and files included."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

from benchmarks.measure import Figure, interleaved


def process(*words: str, cache: str = "") -> float:
    """Wall time of a Python process [s] that does its work (1: an expectation failed).

    ``cache`` is a folder for compiled code in place of the usual one.
    """
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache} if cache else None
    began = time.perf_counter()
    done = subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False,
                          env=environment)
    spent = time.perf_counter() - began
    if done.returncode not in (0, 1):
        raise SystemExit(f"{' '.join(words)} exited {done.returncode}: {done.stderr}")
    return spent


def figures(*, quick: bool = False) -> list[Figure]:
    """The whole of ``sandbox run`` after the first time, and how fast it starts."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["-m", "sandbox", "run", "single_finger" if quick else "adaptive_grasp",
                 "--out", str(Path(folder) / "run")]
        first = process(*words, cache=folder)
        process(*words)  # compiles and caches
        whole, = interleaved([partial(process, *words)], 1 if quick else 5)
    version, click = interleaved(
        [partial(process, "-m", "sandbox", "--version"), partial(process, "-c", "import click")],
        2 if quick else 15)
    return [
        Figure("sandbox run, GIF included", whole, "s", most=3.0),
        Figure("first sandbox run, which compiles / a later one", first / whole, "", most=8.0),
        Figure("sandbox --version / import click", version / click, "", most=2.5),
        Figure("  sandbox --version", 1e3 * version, "ms"),
    ]
