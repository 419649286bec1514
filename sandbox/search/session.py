"""A search: its study, its options, and its runs at the time step and at half of it."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from textwrap import shorten
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import json_text, write_atomic
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.figure.sweeps import FoundLine
from sandbox.numeric import Array
from sandbox.scene.read.limits import Limits, over
from sandbox.sweeps.job import DONE, STEP, Log, Point, SweepRow, run_id
from sandbox.sweeps.plan import Checks, Study, read_study
from sandbox.sweeps.processes import check_workers
from sandbox.sweeps.spec import Range, number_of, points_of, values_at
from sandbox.sweeps.table import draw_table, make_table
from sandbox.sweeps.workers import make_workers
from sandbox.values.paths import JsonPath, path_text
from sandbox.values.units import parse_quantity, unfit
from sandbox.wording import WrongValueError, listed, or_near, quoted

RESULT, FIGURE, FOUND = "search.json", "search.png", "found.png"
SEEDED = ("best", "sensitivity")  # searches whose seed may be that of the study
Quantiles = Array | Sequence[Sequence[float]]
_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class RefusedError(SandboxError):
    """A search that is impossible; ``path`` is the place within its options."""

    code = "bad-search"

    def __init__(self, message: str, *path: str | int) -> None:
        super().__init__(message)
        self.path: JsonPath = path


@dataclass(frozen=True, repr=False, kw_only=True)
class Result:
    """The result of a search."""

    runs: int
    certified: bool  # Whether the result is the same at half the step
    certificate: str  # Details of this check

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {shorten(self.lines[0], 100, placeholder='…')}>"

    @property
    def lines(self) -> list[str]:
        """The result in words."""
        same = "the same" if self.certified else "NOT the same"
        return [*self._lines(), f"half the step: {same}; {self.certificate}"]

    def _lines(self) -> list[str]:
        raise NotImplementedError


@dataclass(frozen=True)
class Condition:
    """A limit [SI] of a result."""

    name: str
    below: bool
    limit: float
    text: str

    def excess(self, rows: Sequence[SweepRow]) -> Array:
        """Distances beyond the limit [SI], [n]; negative where the condition holds."""
        values = results(rows, [self.name])[:, 0]
        return values - self.limit if self.below else self.limit - values


class Session:
    """A study, its search of a ``kind`` with ``given`` options, and the runs of the search.

    A point is given by a quantile from 0 to 1 of the values of each path. Nothing is written before
    the first run.
    """

    def __init__(
        self, study: Study, limits: Limits | None = None, kind: str = "",
        given: Mapping[str, Any] | None = None,
    ) -> None:
        source = read_study(study, limits)
        data = source.data
        self.source, self.kind, self.options = source, kind, dict(given or {})
        own = data.get("search", {kind: {}} if kind else None)
        if own is None:
            raise RefusedError('the study has no key "search": add the kind of search')
        if isinstance(own, dict) and len(own) == 1 and isinstance(own[(*own,)[0]], dict):
            (self.kind, written), = own.items()
            if kind not in ("", self.kind):
                raise self.wrong(RefusedError(f"the study is a search of the kind {self.kind}, "
                                              f"not {kind}"), key=True)
            if "seed" in data and self.kind in SEEDED:
                self.options["seed"] = data["seed"]
            self.options |= written
            if source.path and isinstance(written.get("data"), str):
                self.options["data"] = str(source.path.parent / written["data"])
            own = {self.kind: self.options}
        source = replace(source, data={"audit": False, **data, "search": own})
        self.plan = Checks(source, limits, search=True).plan()
        if STEP in self.plan.spec.over:
            raise SceneError([Problem("bad-search", f"a search does not vary {STEP}: it is halved "
                                      "to see whether the result depends on it")], source.name)
        self.spec = getattr(self.plan.spec.search, self.kind)
        self.job = self.plan.job
        self.over = self.plan.spec.over
        for path, each in self.over.items() if not (source.path or "search" in data) else ():
            if isinstance(each, Range) and each.count:
                raise SceneError([Problem(
                    "bad-study", f"{quoted(path)} has a count, {each.count}, and a search chooses "
                    "its points itself", allowed="the range without its count")])
        self.paths = tuple(self.over)
        self.units = self.plan.units  # SI, of paths and results; empty for none
        self.out: Path | None = None  # of the rows, which are not run again, and of the table
        self.workers: int | str = 0
        self.on_row: Callable[[SweepRow], None] = lambda row: None
        self.stack = ExitStack()
        self.visited: dict[str, Point] = {}
        self.halved: set[str] = set()  # ids of runs at half the step

    def wrong(self, error: RefusedError, *, key: bool = False) -> SceneError:
        """The error with its place in the study."""
        path: JsonPath = ("search", self.kind, *error.path)
        if len(error.path) == 2 and isinstance(self.options[str(error.path[0])], str):
            path = path[:-1]  # one text in place of a list
        return SceneError([Problem(error.code, str(error), path_text(path),
                                   *self.source.where(path, key=key))], self.source.name)

    def of_kind(self, *kinds: type[Any]) -> list[str]:
        """Paths with ranges, distributions or lists (tuples)."""
        return [path for path, each in self.over.items() if isinstance(each, kinds)]

    def points(self, quantiles: Quantiles) -> list[Point]:
        """Values of all paths at quantiles, [n, paths]."""
        columns = np.asarray(quantiles, dtype=float).T
        return points_of([{path: values_at(values, column) for (path, values), column
                           in zip(self.over.items(), columns, strict=True)}])

    def numbers(self, quantiles: Quantiles) -> Array:
        """The same in SI, [n, paths]; nan for texts."""
        return np.array([[value if isinstance(value := number_of(written), float) else np.nan
                          for written in point.values()] for point in self.points(quantiles)])

    def check_unit(self, value: float, unit: str, what: str, *path: str | int) -> None:
        """Refuse a number with a unit of another dimension than ``unit`` [SI]."""
        if wrong := unfit(value, unit):
            raise RefusedError(f"{what} is in {unit}, and {wrong}", *path)

    def check_result(self, name: str, *path: str | int) -> None:
        """Refuse a name that is no result."""
        if name not in self.job.keep:
            raise RefusedError(f"no run keeps {quoted(name)}{or_near(name, self.job.keep)} "
                               f"(kept: {listed(self.job.keep) or 'nothing'})", *path)

    def conditions(self, texts: Iterable[str]) -> tuple[Condition, ...]:
        """Conditions of texts such as ``"moved < 1 mm"``."""
        found = []
        for k, text in enumerate(texts):
            path, match = ("where", k), _RELATION.fullmatch(text)
            if match is None:
                raise RefusedError(f"{quoted(text)} is not a condition (allowed: \"moved < 1 mm\" "
                                   "with a kept quantity and <, <=, > or >=)", *path)
            name, relation, written = match.groups()
            self.check_result(name, *path)
            try:
                limit = parse_quantity(written, None)
            except WrongValueError as error:
                raise RefusedError(f"{quoted(text)}: {error}", *path) from None
            self.check_unit(limit, self.units[name], f"{quoted(text)}: {name}", *path)
            found.append(Condition(name, relation in ("<", "<="), float(limit), text))
        return tuple(found)

    def check_runs(self, runs: int) -> None:
        """Refuse more runs than the limit."""
        if problems := list(over(self.job.limits, "runs", runs, "search",
                                 "the search has {count} runs")):
            raise SceneError(problems)

    @cached_property
    def _log(self) -> Log:
        self.workers = check_workers(self.workers)
        return self.stack.enter_context(Log(self.out))

    @cached_property
    def _known(self) -> dict[str, SweepRow]:
        return {row.id: row for row in self._log.rows()}

    @cached_property
    def _workers(self) -> Any:
        return make_workers(self.job, self.workers, self.stack)

    def rows(self, quantiles: Quantiles, *, halved: bool = False) -> list[SweepRow]:
        """The rows at quantiles [n, paths], perhaps at half the step; only missing ones are run."""
        points, digest, known = self.points(quantiles), self.job.digest, self._known
        if halved:
            step = self.plan.loaded.mechanism.run.step / 2
            points = [{**point, STEP: step} for point in points]
        wanted = [(run_id(digest, point), point) for point in points]
        if halved:
            self.halved.update(id for id, _ in wanted)
        else:
            self.visited.update(wanted)
        if missing := {id: point for id, point in wanted if id not in known}:
            for row in self._workers.results(missing.items()):
                self._log.add(row)
                self.on_row(row)
                known[row.id] = row
        return [known[id] for id, _ in wanted]

    def write(
        self, found: Result, wanted: Sequence[Condition] = (), line: FoundLine | None = None,
    ) -> None:
        """Write the table, its figure, and ``search.json``."""
        if self.out is None:
            return
        plan = replace(self.plan, job=self.job, points=[*self.visited.values()])
        table = make_table(plan, self._known.values())
        if wanted:
            table.met = held([self._known[id] for id in self.visited], wanted)
        table.write(self.out)
        if self.kind != "fit":  # it keeps whole curves, and has a figure of its own
            draw_table(table, self.out / FIGURE, " and ".join(each.text for each in wanted), line)
        given = {name: option for name, option in self.spec.model_dump().items()
                 if option not in (None, (), {}, "")}
        write_atomic(self.out / RESULT, json_text({
            "search": self.kind,
            "study": {**self.plan.written, "search": {self.kind: given}},
            "versions": {"sandbox": __version__}, "units": plan.units,
            "found": asdict(found)}, indent=2) + "\n")


def results(rows: Sequence[SweepRow], names: Iterable[str]) -> Array:
    """Results by name, [n, names]; nan for no value."""
    return np.array([[row.kept.get(name) for name in names] for row in rows], dtype=float)


def held(rows: Sequence[SweepRow], wanted: Sequence[Condition]) -> Array:
    """1 where all conditions, or without any the scene's expectations, hold, 0 or nan, [n]."""
    if not wanted:
        return np.array([row.holds for row in rows], dtype=float)
    worst = np.max([each.excess(rows) for each in wanted], axis=0)
    known = np.array([row.status == DONE for row in rows]) & np.isfinite(worst)
    return np.where(known, worst <= 0, np.nan)


def main_failure(rows: Iterable[SweepRow]) -> str:
    """Why most of these runs have no answer, after a colon; empty if all have one."""
    reasons = Counter(filter(None, (row.failure for row in rows)))
    return f": {reasons.most_common(1)[0][0]}" if reasons else ""
