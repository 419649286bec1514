"""The question of a search, and its running: runs points at the step and at half of it."""

from __future__ import annotations

import json
import math
import os
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import write_atomic
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.figure.sweeps import FoundLine
from sandbox.numeric import Array
from sandbox.scene.read.limits import Limits, over
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.sweeps.job import DONE, STEP, Keep, Log, Point, SweepRow
from sandbox.sweeps.plan import Plan, make_plan
from sandbox.sweeps.processes import check_workers
from sandbox.sweeps.sweep import study_data
from sandbox.sweeps.table import draw_table, make_table
from sandbox.sweeps.vary import Axis, Distribution, Points, Range, Values, number_of, values_at
from sandbox.sweeps.workers import Evaluator
from sandbox.values.spec import Spec
from sandbox.values.units import parse_quantity, unfit
from sandbox.wording import WrongValueError, listed, or_near, quoted, told_of

RESULT, FIGURE, FOUND = "search.json", "search.png", "found.png"
DIFFERENCE = 1e-5
"""Of quantiles, by which slopes are computed."""
Scene = str | os.PathLike[str] | Mapping[str, Any]
Quantiles = Array | Sequence[Sequence[float]]
Number = TypeVar("Number", float, Array)
_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class RefusedError(SandboxError):
    """A search that is impossible; known before anything runs."""

    code = "bad-search"


class Result:
    """The result of a search."""

    certified: bool
    certificate: str

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """The result in words."""
        same = "the same" if self.certified else "NOT the same"
        return [*self._lines(), f"half the step: {same}; {self.certificate}"]

    def _lines(self) -> list[str]:
        raise NotImplementedError


# -- the question --------------------------------------------------------------------


@dataclass(frozen=True)
class Question:
    """A scene, its varied paths, and the results of its runs.

    A point is given by a quantile from 0 to 1 of the values of each path.
    """

    plan: Plan
    """A sweep of the ends of all ranges."""
    source: SceneSource
    """The study as it was written."""
    folder: Path
    """To which file names are relative."""

    @property
    def name(self) -> str:
        """Name of the study, or of its scene."""
        return self.plan.name

    @property
    def kept(self) -> dict[str, str]:
        """SI units of the results, by name."""
        return {name: self.plan.units.get(name, "") for name in self.plan.job.keep}

    @property
    def study(self) -> dict[str, Any]:
        """The data of a study file with the same scene, paths and results."""
        return dict(self.plan.written)

    @cached_property
    def over(self) -> dict[str, Values]:
        """The values of all varied paths."""
        return self.plan.spec.over

    @property
    def paths(self) -> tuple[str, ...]:
        """All varied paths."""
        return tuple(self.over)

    def unit(self, path: str) -> str:
        """The SI unit of a path; empty for none."""
        return self.plan.units.get(path, "")

    def of_kind(self, kind: type[Range] | type[Distribution] | type[tuple[Any, ...]]) -> list[str]:
        """Paths with ranges, distributions or lists (tuples)."""
        return [path for path, each in self.over.items() if isinstance(each, kind)]

    def points(self, quantiles: Quantiles) -> list[Point]:
        """Values of all paths at quantiles, [n, paths]."""
        table = np.asarray(quantiles, dtype=float)
        columns = [values_at(each, table[:, k]) for k, each in enumerate(self.over.values())]
        return [dict(zip(self.over, values, strict=True))
                for values in zip(*columns, strict=True)]

    def numbers(self, quantiles: Quantiles) -> Array:
        """The same in SI, [n, paths]; nan for texts."""
        found = [map(number_of, point.values()) for point in self.points(quantiles)]
        return np.array([[value if isinstance(value, float) else np.nan for value in row]
                         for row in found])

    def slopes(self, quantiles: Array) -> Array:
        """Derivative of each path's number [SI] by its quantile, [paths], at quantiles [paths]."""
        ends = np.clip([quantiles - DIFFERENCE, quantiles + DIFFERENCE], 0, 1)
        low, high = self.numbers(ends)
        return np.asarray((high - low) / (ends[1] - ends[0]))


def make_question(
    scene: Scene, *, vary: Mapping[str, Any] | None = None,
    keep: Mapping[str, Any] | list[str] | None = None, set: Mapping[str, Any] | None = None,
    limits: Limits | None = None,
) -> Question:
    """The question of a study file, or of a scene and the arguments of a sweep.

    Args:
        scene: a scene; without ``vary``, a study file.
        vary: ranges (``"2 N:8 N"``), distributions and lists by path.
        keep: results of each run.
        set: further changes of the scene, in all runs.
        limits: of the scene.
    """
    if vary is None and not isinstance(scene, Mapping):
        return read_question(scene, limits)
    found = _question(SceneSource(study_data(scene, vary=vary or {}, keep=keep, set=set)), limits)
    if problems := [Problem(
            "bad-study",
            f"{quoted(path)} has a count, {each.count}, and a search chooses its points itself",
            allowed="the range without its count") for path, each in found.over.items()
            if isinstance(each, Range) and each.count]:
        raise SceneError(problems)
    return found


def read_question(study: Scene, limits: Limits | None = None) -> Question:
    """The question of a study: a file or data."""
    if isinstance(study, Mapping):
        return _question(SceneSource(dict(study)), limits)
    file = Path(study)
    return _question(read_source(file, limits=limits), limits, file.parent, file.stem)


def _question(
    source: SceneSource, limits: Limits | None, folder: Path = Path(), name: str = "",
) -> Question:
    if isinstance(source.data, dict):
        source = replace(source, data={"audit": False, **source.data})
    plan = make_plan(source, limits, folder=folder, name=name, search=True)
    if STEP in plan.points.paths:
        raise SceneError([Problem("bad-search",
                                  f"a search does not vary {STEP}: it is halved to see whether "
                                  "the result depends on it")], source.name)
    return Question(plan, source, folder)


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
    if row.status != DONE or not wanted:
        return row.holds
    margins = [each.excess(value_of(row, each.name)) for each in wanted]
    return None if any(map(math.isnan, margins)) else all(margin <= 0 for margin in margins)


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
    """Runs the points of a search; nothing is written before the first run."""

    def __init__(self, question: Question, place: Where, stack: ExitStack) -> None:
        self.question, self.out, self._place, self._stack = question, place.out, place, stack
        self._job = question.plan.job
        self._visited: dict[str, Point] = {}
        self._halved: set[str] = set()

    @property
    def count(self) -> int:
        """Different runs so far, at both steps."""
        return len(self._visited) + len(self._halved)

    def keep(self, results: Mapping[str, Keep]) -> None:
        """Keep further results, before the first run."""
        self._job = replace(self._job, keep={**self._job.keep, **results})

    def check_runs(self, runs: int) -> None:
        """Refuse more runs than the limit."""
        if problems := list(over(self._job.limits, "runs", runs, "search",
                                 "the search has {count} runs")):
            raise SceneError(problems)

    @cached_property
    def _log(self) -> Log:
        check_workers(self._place.workers)
        folder = self.out or Path(self._stack.enter_context(
            tempfile.TemporaryDirectory(prefix="sandbox-search-")))
        return self._stack.enter_context(Log(folder))

    @cached_property
    def _evaluator(self) -> Evaluator:
        return Evaluator(self._job, self._log, self._stack, workers=self._place.workers,
                         on_row=self._place.on_row)

    def rows(self, quantiles: Quantiles, *, halved: bool = False) -> list[SweepRow]:
        """The rows at quantiles of the paths, [n, paths], in their order; or at half the step."""
        points = self.question.points(quantiles)
        names = [json.dumps(dict(point)) for point in points]
        if halved:
            step = self.question.plan.loaded.mechanism.run.step / 2
            points = [{**point, STEP: step} for point in points]
            self._halved.update(names)
        else:
            self._visited.update(zip(names, points, strict=True))
        return self._evaluator.rows(points)

    def values(
        self, names: Sequence[str], quantiles: Quantiles, *, halved: bool = False,
    ) -> Array:
        """Results by name, [n, names]; nan for no value."""
        return np.array([[value_of(row, name) for name in names]
                         for row in self.rows(quantiles, halved=halved)])

    def write(
        self, kind: str, options: Spec, found: Result, *, wanted: tuple[Condition, ...] = (),
        line: FoundLine | None = None, **more: Any,
    ) -> None:
        """Write the table of all points with its figure, and ``search.json``.

        Args:
            kind: of the search.
            options: of the search.
            found: the result.
            wanted: conditions: a column of the table, and colours of the figure.
            line: what was found on a path, for the figure.
            more: further entries of the result.
        """
        if self.out is None:
            return
        points = list(self._visited.values())
        plan = replace(self.question.plan, job=self._job, points=Points([[
            Axis(path, [point[path] for point in points]) for path in self.question.paths]]))
        table = make_table(plan, self._log.rows())
        held = table.holds
        if wanted:
            worst = np.max([each.excess(table.kept[each.name]) for each in wanted], axis=0)
            held = np.where(table.done & np.isfinite(worst), worst <= 0, np.nan)
            table.met = held
        table.write(self.out)
        if kind != "fit":  # it keeps whole curves, and has a figure of its own
            draw_table(table, self.out / FIGURE, held=held, found=line,
                       condition=" and ".join(each.text for each in wanted))
        given = {name: option for name, option in plain_data(options.model_dump()).items()
                 if option not in (None, [], {}, "")}
        write_atomic(self.out / RESULT, json.dumps({
            "search": kind, "study": {**self.question.study, "search": {kind: given}},
            "versions": {"sandbox": __version__}, "units": plan.units,
            "found": plain_data(asdict(found) | more)},  # type: ignore[call-overload]
            indent=2, ensure_ascii=False) + "\n")


def plain_data(value: Any) -> Any:
    """Data for JSON; null for what is not finite."""
    if isinstance(value, Mapping):
        return {str(key): plain_data(each) for key, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain_data(value.tolist())
    if isinstance(value, list | tuple):
        return [plain_data(each) for each in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
