"""Copies of the checkout to be made wrong, and the tests run in them.

Each worker has a tree of its own. Numba keeps compiled kernels by the place, the size and the
time of their source; a mutant gets a fresh copy of a warm cache, so that what is compiled of it is
thrown away with it and nothing else has to be compiled again.
"""

from __future__ import annotations

import os
import resource
import shutil
import signal
import subprocess
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from tests.mutation.places import Mutation

CHECKOUT = Path(__file__).resolve().parents[2]
PACKAGE = CHECKOUT / "sandbox"
NOT_COPIED = ("__pycache__", ".git", ".venv", ".*_cache", ".hypothesis", "renders", "build", "dist")
NEAR = {
    "audit": ("audit", "verification/test_audit.py", "samples", "cli/test_run.py"),
    "control": ("control", "engine", "scene", "paper"),
    "engine": ("engine", "verification", "recording", "scenes"),
    "kinds": ("kinds", "model", "engine", "scene", "recording", "export", "test_architecture.py"),
    "mechanics": ("mechanics", "audit", "control", "verification", "paper"),
    "model": ("model", "recording", "samples", "scene", "engine"),
    "recording": ("recording", "samples", "audit", "engine", "cli"),
    "samples": ("samples", "audit", "recording", "verification", "engine"),
    "scene": ("scene", "engine", "control", "export", "scenes"),
}
"""Tests that are asked about a room's mutants, after those of the same name: likeliest first."""
EVERYWHERE = ("verification", "scenes", "samples", "recording", "model", "export", "study", "cli")
"""Those that are asked as well, if wished."""
MEMORY = 6 * 2**30
"""A mutant that asks for more [bytes] is stopped."""
TIMES, SPARE = 5.0, 60.0
"""A stage hangs that takes so many times what it takes without a mutant, and so much more [s]."""


@dataclass(frozen=True)
class Outcome:
    """What the tests said about a mutant: ``killed``, ``timeout`` or ``survived``."""

    mutation: Mutation
    state: str
    by: str
    """The test that noticed."""
    seconds: float


def stages(file: str, *, whole: bool) -> list[str]:
    """Files and folders of tests to be run one after the other for a mutant of ``file``."""
    tests = CHECKOUT / "tests"
    room, stem = file.split("/")[0], Path(file).stem
    own = [path for path in sorted(tests.rglob("test_*.py"))
           if path.stem == f"test_{stem}" or path.stem.startswith(f"test_{stem}_")]
    own.sort(key=lambda path: path.parent.name != room)
    found = [f"tests/{path.relative_to(tests)}" for path in own]
    wide = (*NEAR.get(room, (room,)), *(EVERYWHERE if whole else ()))
    found += [f"tests/{name}" for name in wide if (tests / name).exists()]
    return list(dict.fromkeys(found))


class Baseline:
    """How long each stage may take, found out once by running it without a mutant."""

    def __init__(self) -> None:
        self._took: dict[str, float] = {}
        self._one = threading.Lock()

    def limit(self, stage: str, tree: Tree) -> float:
        """Time [s] after which a stage counts as hanging.

        Raises:
            RuntimeError: its tests fail without a mutant.
        """
        with self._one:
            if stage not in self._took:
                began = time.monotonic()
                code, by = tree.unharmed(stage)
                if code not in (0, 5):
                    raise RuntimeError(f"tests fail without a mutant: {by or stage}")
                self._took[stage] = time.monotonic() - began
            return TIMES * self._took[stage] + SPARE


class Tree:
    """One copy of the checkout with compiled kernels of its own."""

    def __init__(self, folder: Path, baseline: Baseline, *, whole: bool) -> None:
        self.root, self.warm, self.cache = folder / "tree", folder / "warm", folder / "cache"
        self.baseline, self.whole = baseline, whole
        shutil.copytree(CHECKOUT, self.root, ignore=shutil.ignore_patterns(*NOT_COPIED))
        self.warm.mkdir()
        self._pytest(["tests/engine/test_simulate.py"], self.warm, limit=600.0)

    def judge(self, mutation: Mutation) -> Outcome:
        """Make one mutation and run its tests, stage by stage, until one fails."""
        began = time.monotonic()
        for stage in stages(mutation.file, whole=self.whole):
            limit = self.baseline.limit(stage, self)
            code, by = self._mutated(mutation, stage, limit)
            if code not in (0, 5):  # 5: no test in there
                state = "timeout" if code is None else "killed"
                return Outcome(mutation, state, by or stage, time.monotonic() - began)
        return Outcome(mutation, "survived", "", time.monotonic() - began)

    def unharmed(self, stage: str) -> tuple[int | None, str]:
        """Exit code and failure of a stage without a mutant."""
        return self._pytest([stage], self.warm, limit=3600.0)

    def _mutated(self, mutation: Mutation, stage: str, limit: float) -> tuple[int | None, str]:
        """Run one stage with the mutation made, and put everything back."""
        path = self.root / "sandbox" / mutation.file
        source, stat = path.read_text(), path.stat()
        path.write_text(mutation.of(source))
        # later than any compiled copy of the file, which is told apart by its second and size
        os.utime(path, (stat.st_mtime + 10, stat.st_mtime + 10))
        shutil.copytree(self.warm, self.cache)
        try:
            return self._pytest([stage], self.cache, limit=limit)
        finally:
            shutil.rmtree(self.cache)
            path.write_text(source)
            os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))

    def _pytest(self, which: list[str], cache: Path, *, limit: float) -> tuple[int | None, str]:
        """Exit code, None where it took longer than ``limit``, and the first test that failed."""
        shutil.rmtree(self.root / ".hypothesis", ignore_errors=True)  # no memory of failures
        run = subprocess.Popen(
            [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", "--tb=no",
             "--hypothesis-seed=0", *which],
            cwd=self.root, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
            env={**os.environ, "PYTHONPATH": str(self.root), "NUMBA_CACHE_DIR": str(cache)},
            start_new_session=True, preexec_fn=_bounded)
        try:
            said, _ = run.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(run.pid, signal.SIGKILL)
            run.communicate()
            return None, ""
        failed = [line.split()[1] for line in said.splitlines()
                  if line.startswith(("FAILED ", "ERROR "))]
        return run.returncode, failed[0] if failed else ""


def _bounded() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
