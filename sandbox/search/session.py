"""A running search: runs points, at the step and at half of it, and writes the result."""

from __future__ import annotations

import contextlib
import json
import math
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import write_atomic
from sandbox.errors import SandboxError, SceneError
from sandbox.figure.sweeps import FoundLine
from sandbox.numeric import Array
from sandbox.scene.read.limits import over
from sandbox.search.question import Point, Question
from sandbox.sweeps.job import DONE, STEP, SweepRow
from sandbox.sweeps.log import Log
from sandbox.sweeps.points import Points
from sandbox.sweeps.spec import MAX_SEED
from sandbox.sweeps.table import SweepTable, draw_table, make_table
from sandbox.sweeps.workers import Evaluator
from sandbox.values.units import parse_quantity, unfit
from sandbox.wording import WrongValueError, listed, or_near, quoted

RESULT, FIGURE, FOUND = "search.json", "search.png", "found.png"
Number = TypeVar("Number", float, Array)
_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class RefusedError(SandboxError):
    """A search that is impossible; known before anything runs."""

    code = "bad-search"


# -- conditions ----------------------------------------------------------------------


@dataclass(frozen=True)
class Condition:
    """A limit of a result."""

    name: str
    below: bool
    limit: float
    """[SI]."""
    text: str
    """As it was written."""

    def excess(self, value: Number) -> Number:
        """Distance beyond the limit, [SI]; negative where the condition holds."""
        return value - self.limit if self.below else self.limit - value


def parse_conditions(texts: Iterable[str], kept: Mapping[str, str]) -> tuple[Condition, ...]:
    """Conditions of texts such as ``"moved < 1 mm"``.

    Args:
        texts: the conditions.
        kept: SI units of results by name.

    Raises:
        RefusedError: no condition, an unknown result, or a unit of another dimension.
    """
    found = []
    for text in texts:
        match = _RELATION.fullmatch(text)
        if match is None:
            raise RefusedError(f"{quoted(text)} is not a condition (allowed: \"moved < 1 mm\" with "
                               "a kept quantity and <, <=, > or >=)")
        name, relation, written = match.groups()
        check_result(name, kept)
        try:
            limit = parse_quantity(written, None)
        except WrongValueError as error:
            raise RefusedError(f"{quoted(text)}: {error}") from None
        check_unit(limit, kept[name], f"{quoted(text)}: {name}")
        found.append(Condition(name, relation in ("<", "<="), float(limit), text))
    return tuple(found)


def check_unit(value: float, unit: str, what: str) -> None:
    """Refuse a number with a unit of another dimension than ``unit`` [SI]."""
    if wrong := unfit(value, unit):
        raise RefusedError(f"{what} is in {unit}, and {wrong}")


def check_result(name: str, kept: Mapping[str, str]) -> None:
    """Refuse a name that is no result."""
    if name not in kept:
        raise RefusedError(f"no run keeps {quoted(name)}{or_near(name, kept)} "
                           f"(kept: {listed(list(kept)) or 'nothing'})")


def check_effort(question: Question, runs: int, seed: int) -> None:
    """Refuse more runs than the limit, and seeds that the libraries do not take."""
    if problems := list(over(question.plan.job.limits, "runs", runs, "search",
                             "the search has {count} runs")):
        raise SceneError(problems)
    if not 0 <= seed <= MAX_SEED:
        raise RefusedError(f"a seed is a number from 0 to {MAX_SEED}, not {seed}")


def value_of(row: SweepRow, name: str) -> float:
    """A result of a run; nan if it has no value."""
    value = row.kept.get(name)
    return math.nan if value is None else value


def failure_of(row: SweepRow) -> str:
    """Why a run has no answer."""
    return f"{row.status}: {row.reason}" if row.status != DONE else row.reason


def main_failure(rows: Iterable[SweepRow]) -> str:
    """Why most of these runs have no answer, after a colon; empty if all have one."""
    reasons = Counter(filter(None, map(failure_of, rows)))
    return f": {reasons.most_common(1)[0][0]}" if reasons else ""


def row_holds(row: SweepRow, wanted: Sequence[Condition]) -> bool | None:
    """Whether all conditions hold in a run, by default its expectations; None if unknown."""
    if row.status != DONE:
        return None
    if not wanted:
        return row.holds
    margins = [each.excess(value_of(row, each.name)) for each in wanted]
    return None if any(map(math.isnan, margins)) else all(margin <= 0 for margin in margins)


def _table_holds(table: SweepTable, wanted: Sequence[Condition]) -> Array:
    """The same of all runs of a table, [n]: 1, 0, or nan."""
    if not wanted:
        return table.holds
    worst = np.max([each.excess(table.kept[each.name]) for each in wanted], axis=0)
    return np.where(table.done & np.isfinite(worst), worst <= 0, np.nan)


# -- running -------------------------------------------------------------------------


@dataclass(frozen=True)
class Where:
    """Where a search runs, and where its files go."""

    out: Path | None = None
    """Directory of rows, which are not run again, and of the table; None for nowhere."""
    workers: int | str = 0
    """Number of processes, 0 for one for each processor; or the address of a Dask scheduler."""
    on_row: Callable[[SweepRow], None] = lambda row: None
    """Called with each row that was run."""


class Session:
    """Runs the points of a search; see :func:`open_session`."""

    def __init__(self, question: Question, evaluator: Evaluator, log: Log) -> None:
        self.question, self._evaluator, self._log = question, evaluator, log
        self._visited: list[Point] = []

    def rows(
        self, quantiles: Array | Sequence[Sequence[float]], *, halved: bool = False,
    ) -> list[SweepRow]:
        """The rows at quantiles of the space, [n, paths], in their order; or at half the step."""
        points = self.question.space.points(quantiles)
        if halved:
            step = self.question.plan.loaded.mechanism.run.step / 2
            points = [{**point, STEP: step} for point in points]
        else:
            self._visited += points
        return self._evaluator.rows(points)

    def values(
        self, names: Sequence[str], quantiles: Array | Sequence[Sequence[float]], *,
        halved: bool = False,
    ) -> Array:
        """Results by name, [n, names]; nan for no value."""
        return np.array([[value_of(row, name) for name in names]
                         for row in self.rows(quantiles, halved=halved)])

    def write(
        self, directory: Path, kind: str, result: Mapping[str, Any], *,
        wanted: tuple[Condition, ...] = (), line: FoundLine | None = None, **options: Any,
    ) -> None:
        """Write the table of all points with its figure, and ``search.json``.

        Args:
            directory: for the files.
            kind: of the search.
            result: what was found.
            wanted: conditions: a column of the table, and colours of the figure.
            line: what was found on a path, for the figure.
            options: of the search, as in a study file.
        """
        once = {json.dumps(dict(point)): point for point in self._visited}
        plan = replace(self.question.plan, points=Points.listed(
            self.question.space.paths, list(once.values())))
        table = make_table(plan, self._log.rows())
        held = _table_holds(table, wanted)
        if wanted:
            table.met = held
        table.write(directory)
        if kind != "fit":  # it keeps whole curves, and has a figure of its own
            draw_table(table, directory / FIGURE, held=held, found=line,
                       condition=" and ".join(each.text for each in wanted))
        given = {name: option for name, option in plain_data(options).items()
                 if option not in (None, [], {}, "")}
        write_atomic(directory / RESULT, json.dumps({
            "search": kind, "study": {**self.question.study, "search": {kind: given}},
            "versions": {"sandbox": __version__}, "units": plan.units,
            "found": plain_data(result)}, indent=2, ensure_ascii=False) + "\n")


@contextlib.contextmanager
def open_session(question: Question, where: Where) -> Iterator[Session]:
    """A running search, as a context.

    Raises:
        OutputError: the directory cannot be written, or another process uses it.
        SandboxError: workers cannot start, or the cluster cannot be used.
    """
    with contextlib.ExitStack() as stack:
        folder = where.out or Path(stack.enter_context(
            tempfile.TemporaryDirectory(prefix="sandbox-search-")))
        log = Log(folder)
        evaluator = Evaluator(question.plan.job, log, workers=where.workers, on_row=where.on_row)
        stack.enter_context(log)  # nothing is written before all is checked
        yield Session(question, stack.enter_context(evaluator), log)


def step_check(same: bool, detail: str) -> str:
    """The line about half the step."""
    return f"half the step: {'the same' if same else 'NOT the same'}; {detail}"


def plain_data(value: Any) -> Any:
    """Data for JSON; null for what is not finite."""
    if isinstance(value, Mapping):
        return {str(key): plain_data(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain_data(value.tolist())
    if isinstance(value, list | tuple):
        return [plain_data(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
