"""A search at work: its points run or found in the log, and at half the step to certify it."""

from __future__ import annotations

import contextlib
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import write_atomic
from sandbox.draw.figure.sweeps import FoundLine
from sandbox.errors import SceneError
from sandbox.numeric import Array, Integers
from sandbox.scene.read.limits import over
from sandbox.search.criteria import Condition, RefusedError, held, value_of
from sandbox.search.question import Question
from sandbox.sweeps.drawing import draw
from sandbox.sweeps.evaluator import Evaluator
from sandbox.sweeps.job import STEP, SweepRow
from sandbox.sweeps.log import Log
from sandbox.sweeps.points import Axis, Override
from sandbox.sweeps.searching import KEY, MOST_SEED
from sandbox.sweeps.table import SweepTable, table_of

RESULT, FIGURE, FOUND = "search.json", "search.png", "found.png"
Point = Mapping[str, Override]


@dataclass(frozen=True)
class Where:
    """Where a search runs and what it leaves behind."""

    out: Path | None = None
    """Rows are kept there and found again, and the table goes there; nowhere by default."""
    workers: int = 0
    """Processes; as many as there are processors by default."""
    cluster: str = ""
    """Address of a Dask scheduler to be used in their place."""
    heard: Callable[[SweepRow], None] | None = None
    """Is told each row that was run."""


@dataclass(frozen=True)
class Visited:
    """Points of a search as those of a sweep."""

    paths: tuple[str, ...]
    listed: Sequence[Point]
    one_grid: bool = False

    def __len__(self) -> int:
        return len(self.listed)

    def __getitem__(self, run: int) -> dict[str, Override]:
        return dict(self.listed[run])

    def places(self, path: str) -> Integers:
        """Which of the values of a path each run has, [n]."""
        return np.arange(len(self))

    @property
    def axes(self) -> tuple[Axis, ...]:
        """Every path with its values."""
        return tuple(Axis(path, [point[path] for point in self.listed]) for path in self.paths)


def affordable(question: Question, runs: int, seed: int) -> None:
    """See that a search asks for no more runs than it may, and for a seed that all libraries take.

    Raises:
        SceneError: more runs than the limit.
        RefusedError: another seed.
    """
    if problems := list(over(question.plan.job.limits, "runs", runs, "search",
                             "the search has {count} runs")):
        raise SceneError(problems)
    if not 0 <= seed <= MOST_SEED:
        raise RefusedError(f"a seed is a number from 0 to {MOST_SEED}, not {seed}")


class Asking:
    """Runs what a search wants to know; made by :func:`asking`."""

    def __init__(self, question: Question, evaluator: Evaluator, log: Log) -> None:
        self.question, self._evaluator, self._log = question, evaluator, log
        self._visited: list[Point] = []

    def rows(
        self, shares: Array | Sequence[Sequence[float]], *, halved: bool = False,
    ) -> list[SweepRow]:
        """The rows at shares of the space, [n, paths], in their order; at half the step, too."""
        points: list[Point] = list(self.question.space.points(shares))
        if halved:
            step = self.question.plan.loaded.mechanism.run.step / 2
            points = [{**point, STEP: step} for point in points]
        else:
            self._visited += points
        return self._evaluator.rows(points)

    def values(
        self, names: Sequence[str], shares: Array | Sequence[Sequence[float]], *,
        halved: bool = False,
    ) -> Array:
        """What is kept under names, [n, names]; nan where there is none."""
        return np.array([[value_of(row, name) for name in names]
                         for row in self.rows(shares, halved=halved)])

    def table(self, wanted: tuple[Condition, ...] = ()) -> SweepTable:
        """The table of all points at the scene's own step, in the order they were asked for.

        With a column that says of which runs holds what is ``wanted``, if anything is.
        """
        once = {json.dumps(dict(point)): point for point in self._visited}
        plan = replace(self.question.plan, points=Visited(
            self.question.space.paths, list(once.values())))
        table = table_of(plan, self._log.rows())
        if wanted:
            table.met = held(table, wanted)
        return table

    def leave(
        self, directory: Path, kind: str, result: Mapping[str, Any], *,
        wanted: tuple[Condition, ...] = (), line: FoundLine | None = None, **words: Any,
    ) -> None:
        """Write the table of all points with its figure, and what was asked and found.

        A fit keeps curves, of which this figure shows nothing; a map has a figure of its own.

        Args:
            directory: where to.
            kind: of the search.
            result: what was found.
            wanted: what must hold: a column of the table, and colours of points of the figure.
            line: what was found on a path, for the figure.
            words: what the search was asked besides, as its study file would say it.
        """
        table = self.table(wanted)
        table.write(directory)
        if kind not in ("fit", "robustness"):
            draw(table, directory / FIGURE, held=held(table, wanted), found=line,
                 condition=" and ".join(each.text for each in wanted))
        plan = self.question.plan
        write_atomic(directory / RESULT, json.dumps({
            "search": kind, "study": self._study(kind, words),
            "versions": {"sandbox": __version__},
            "units": plan.units, "found": plain_data(result)}, indent=2, ensure_ascii=False) + "\n")


    def _study(self, kind: str, words: Mapping[str, Any]) -> dict[str, Any]:
        """The study file that asks the same."""
        question = self.question
        said = {name: word for name, word in plain_data(words).items()
                if word is not None and word not in ([], {}, "")}
        return {**question.plan.written, "vary": question.source.data["vary"], KEY: {kind: said}}


@contextlib.contextmanager
def asking(question: Question, where: Where) -> Iterator[Asking]:
    """A search at work, while the context lasts.

    Raises:
        OutputError: the directory cannot be written, or another process is at it.
        SandboxError: no workers, more than are begun, or a cluster that cannot be used.
    """
    with contextlib.ExitStack() as open_:
        folder = where.out or Path(open_.enter_context(
            tempfile.TemporaryDirectory(prefix="sandbox-search-")))
        log = Log(folder)
        evaluator = Evaluator(question.plan.job, log, workers=where.workers, cluster=where.cluster,
                              heard=where.heard)
        open_.enter_context(log)  # now that nothing is refused
        yield Asking(question, open_.enter_context(evaluator), log)


def plain_data(value: Any) -> Any:
    """Data that JSON can hold: what is not finite is null."""
    if isinstance(value, Mapping):
        return {str(key): plain_data(each) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        return plain_data(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain_data(each) for each in value]
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, (int, np.integer)):
        return int(value)
    if isinstance(value, (float, np.floating)):
        return float(value) if np.isfinite(value) else None
    return value
