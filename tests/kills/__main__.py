"""``python -m tests.kills [--seed N] [--kills N] [--only KIND]``, from the top of a checkout.

One process loads everything and makes a copy of itself for every writer, so that
kills fall into the work and not into imports.
"""

from __future__ import annotations

import argparse
import os
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path

from sandbox.cli.entry import invoke
from sandbox.recording.recording import Recording
from tests.kills.look import Whole, contents, files_fault, run_fault

SCENE = "single_finger"
LENGTHS = {"old": "run.duration=0.2", "new": "run.duration=0.3", "other": "run.duration=0.25"}
"""The runs that there are; each leaves other numbers."""
LATE = 1.15
"""Kills fall up to this many times the undisturbed duration; the last ones come too late."""


class Bench:
    """A temporary directory with whole runs to hold others against, and a seeded generator."""

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder, self.random = folder, random.Random(seed)
        self.target = folder / "target"
        for name in LENGTHS:
            self.run(name, folder / name)
        self.runs = {name: Recording.load(folder / name) for name in LENGTHS}
        for name, run in self.runs.items():
            run.save(folder / "saved" / name)
        self.whole: Whole = {
            f"{name}{how}": contents(folder / how.strip() / name)
            for name in LENGTHS for how in ("", " saved")}

    def save(self, name: str) -> None:
        """``Recording.save``: numbers and audit, no pictures."""
        self.runs[name].save(self.target)

    @staticmethod
    def run(name: str, folder: Path) -> None:
        """``sandbox run``: simulate, save, draw, audit."""
        if invoke(["run", SCENE, "--set", LENGTHS[name], "--out", str(folder),
                   "--quiet"]) not in (0, 1):
            raise RuntimeError(f"the run {name} failed")

    def fresh(self, *, old: bool) -> None:
        """An empty target, or one with the old run in it."""
        shutil.rmtree(self.target, ignore_errors=True)
        if old:
            shutil.copytree(self.folder / "old", self.target)
        else:
            self.target.mkdir()


def started(work: Callable[[], None]) -> int:
    """A copy of this process that does something and ends; its number."""
    sys.stdout.flush()
    child = os.fork()
    if child:
        return child
    code = 70
    try:
        silent = os.open(os.devnull, os.O_WRONLY)
        os.dup2(silent, 1)
        os.dup2(silent, 2)
        work()
        code = 0
    finally:
        os._exit(code)


def duration(work: Callable[[], None]) -> float:
    """How long it takes undisturbed [s]."""
    began = time.perf_counter()
    _, status = os.waitpid(started(work), 0)
    if status:
        raise RuntimeError(f"it fails without any kill: {status}")
    return time.perf_counter() - began


def killed(works: Sequence[Callable[[], None]], delays: Sequence[float]) -> None:
    """Start all at once, kill each after its delay [s]; infinite for one that may go on."""
    began = time.perf_counter()
    children = [started(work) for work in works]
    for delay, child in sorted(zip(delays, children, strict=True)):
        if delay < float("inf"):
            time.sleep(max(0.0, began + delay - time.perf_counter()))
            os.kill(child, signal.SIGKILL)
    for child in children:
        os.waitpid(child, 0)


def trial_of_runs(bench: Bench, work: Callable[[str], None], names: Sequence[str]) -> \
        Callable[[], tuple[str, str]]:
    """One or more writers of runs into one directory, with an old run in it or not."""
    bench.fresh(old=True)
    longest = duration(lambda: work(names[0]))

    def trial() -> tuple[str, str]:
        bench.fresh(old=bench.random.random() < 0.7)
        delays = [bench.random.uniform(0, LATE * longest * len(names)) for _ in names]
        if len(names) > 1 and bench.random.random() < 0.5:
            delays[0] = float("inf")
        killed([lambda name=name: work(name) for name in names], delays)  # type: ignore[misc]
        found, fault = run_fault(bench.target, bench.whole)
        if not fault:
            work(names[0])
            after, fault = run_fault(bench.target, bench.whole)
            left = [path.name for path in bench.target.iterdir() if path.name.startswith(".")]
            if not fault and (after.split()[0] != names[0] or left):
                fault = f"the next run left {after} and {left}"
        return found, fault

    return trial


def trial_of_files(bench: Bench, *words: str) -> Callable[[], tuple[str, str]]:
    """A command that writes single files below ``--out``, into an empty directory."""
    def work() -> None:
        if invoke(words) not in (0, 1):
            raise RuntimeError

    bench.fresh(old=False)
    longest = duration(work)
    whole = contents(bench.target)

    def trial() -> tuple[str, str]:
        bench.fresh(old=False)
        killed([work], [bench.random.uniform(0, LATE * longest)])
        return files_fault(bench.target, whole)

    return trial


def trials(bench: Bench) -> dict[str, Callable[[], Callable[[], tuple[str, str]]]]:
    """What is killed, by its kind."""
    old = str(bench.folder / "old")
    return {
        "run": lambda: trial_of_runs(bench, lambda name: bench.run(name, bench.target), ["new"]),
        "two runs": lambda: trial_of_runs(
            bench, lambda name: bench.run(name, bench.target), ["new", "other"]),
        "save": lambda: trial_of_runs(bench, bench.save, ["new"]),
        "two saves": lambda: trial_of_runs(bench, bench.save, ["new", "other"]),
        "render": lambda: trial_of_files(
            bench, "render", old, "--out", str(bench.target / "film.gif")),
    }


def main(words: list[str] | None = None) -> int:
    """Kill, look, print a line for each kind, and return 1 if anything was taken for whole."""
    parser = argparse.ArgumentParser(prog="python -m tests.kills", description=(
        "SIGKILL at random moments of everything that writes: what is left has to be the old "
        "run whole, the new one whole, or marked incomplete."))
    parser.add_argument("--seed", type=int, help="of the moments; told, chosen by chance")
    parser.add_argument("--kills", type=int, default=200, help="how many (200)")
    parser.add_argument("--only", action="append", metavar="KIND", help="kinds of writers")
    options = parser.parse_args(words)
    seed = options.seed if options.seed is not None else random.SystemRandom().randrange(10**6)
    print(f"seed {seed}", flush=True)
    began, faults = time.perf_counter(), 0
    with tempfile.TemporaryDirectory(prefix="sandbox-kills-") as folder:
        bench = Bench(Path(folder), seed)
        kinds = {kind: make for kind, make in trials(bench).items()
                 if not options.only or kind in options.only}
        for rank, (kind, make) in enumerate(kinds.items()):
            trial, seen = make(), Counter[str]()
            for number in range(rank, options.kills, len(kinds)):
                found, fault = trial()
                seen[found] += 1
                if fault:
                    faults += 1
                    print(f"{kind} {number}: {fault}", flush=True)
            told = ", ".join(f"{count} {found}" for found, count in sorted(seen.items()))
            print(f"{kind:10} {sum(seen.values()):4} kills: {told}", flush=True)
    print(f"{faults} faults, {time.perf_counter() - began:.0f} s")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
