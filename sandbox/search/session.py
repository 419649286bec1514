"""A search: its study, its options, and its runs at the time step and at half of it."""

from __future__ import annotations

import os
import re
import tempfile
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from pathlib import Path
from textwrap import shorten
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from sandbox import __version__
from sandbox.atomic_files import json_text, write_atomic
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.figure.sweeps import FoundLine
from sandbox.numeric import Array
from sandbox.scene.read.limits import Limits, over
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.sweeps.job import STEP, Log, Point, SweepRow, run_id
from sandbox.sweeps.plan import make_plan
from sandbox.sweeps.processes import check_workers
from sandbox.sweeps.spec import SearchSpec
from sandbox.sweeps.sweep import study_data
from sandbox.sweeps.table import draw_table, make_table
from sandbox.sweeps.vary import Points, Range, number_of, values_at
from sandbox.sweeps.workers import make_workers
from sandbox.values.messages import explain
from sandbox.values.paths import JsonPath, path_text
from sandbox.values.units import parse_quantity, unfit
from sandbox.wording import WrongValueError, listed, or_near, quoted

RESULT, FIGURE, FOUND = "search.json", "search.png", "found.png"
Scene = str | os.PathLike[str] | Mapping[str, Any]
Quantiles = Array | Sequence[Sequence[float]]
Number = TypeVar("Number", float, Array)
_RELATION = re.compile(r"\s*(.+?)\s*(<=|>=|<|>)\s*(\S.*?)\s*")


class RefusedError(SandboxError):
    """A search that is impossible; ``path`` is the place within its options."""

    code = "bad-search"

    def __init__(self, message: str, *path: str | int) -> None:
        super().__init__(message)
        self.path: JsonPath = path


class Result:
    """The result of a search."""

    certified: bool
    certificate: str

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

    def excess(self, value: Number) -> Number:
        """Distance beyond the limit [SI]; negative where the condition holds."""
        return value - self.limit if self.below else self.limit - value


class Session:
    """A study, its search, and the runs of the search.

    A point is given by a quantile from 0 to 1 of the values of each path. Nothing is written before
    the first run.
    """

    def __init__(
        self, source: SceneSource, limits: Limits | None, folder: Path = Path(), name: str = "",
    ) -> None:
        if isinstance(source.data, dict):
            source = replace(source, data={"audit": False, **source.data})
        self.source = source
        self.plan = make_plan(source, limits, folder=folder, name=name, search=True)
        if STEP in self.plan.points.axes:
            raise SceneError([Problem("bad-search",
                                      f"a search does not vary {STEP}: it is halved to see whether "
                                      "the result depends on it")], source.name)
        self.job = self.plan.job
        self.over = self.plan.spec.over
        self.paths = tuple(self.over)
        self.kept = {name: self.plan.units.get(name, "") for name in self.job.keep}
        """SI units of the results, by name."""
        self.kind, self.options = "", dict[str, Any]()
        """Of the search; at first those of the study file."""
        if spec := self.plan.spec.search:
            self.kind, own = spec.kind, getattr(spec, spec.kind)
            self.options = {name: getattr(own, name) for name in own.model_fields_set}
            if "seed" in type(own).model_fields and "seed" in source.data:
                self.options.setdefault("seed", self.plan.spec.seed)
            if "data" in self.options:
                self.options["data"] = str(folder / self.options["data"])
        self.in_file = self.kind
        self.out: Path | None = None
        """Directory of the rows, which are not run again, and of the table."""
        self.workers: int | str = 0
        self.on_row: Callable[[SweepRow], None] = lambda row: None
        self.stack = ExitStack()
        self._visited: dict[str, Point] = {}
        self._halved: set[str] = set()

    def choose(self, kind: str, **options: Any) -> None:
        """Set the kind of the search, and options that its file does not give."""
        if self.in_file not in ("", kind):
            raise self.wrong(RefusedError(
                f"the study is a search of the kind {self.in_file}, not {kind}"), key=True)
        self.kind = kind
        self.options = {name: os.fspath(each) if isinstance(each, os.PathLike) else each
                        for name, each in {**options, **self.options}.items()}
        written = {kind: self.options}
        try:
            self.spec = getattr(SearchSpec.model_validate(written), kind)
        except ValidationError as error:
            raise RefusedError("; ".join(
                str(each).removeprefix(f"$.{kind}").lstrip(".: ")
                for each in explain(error, written, SearchSpec))) from None

    def wrong(self, error: RefusedError, *, key: bool = False) -> SandboxError:
        """The error with its place in the study file, if the search is defined there."""
        if not self.in_file:
            return error
        path: JsonPath = ("search", self.in_file, *error.path)
        if len(error.path) == 2 and not isinstance(
                self.source.data["search"][self.in_file][error.path[0]], list):
            path = path[:-1]  # one text in place of a list
        return SceneError([Problem(error.code, str(error), path_text(path),
                                   *self.source.where(path, key=key))], self.source.name)

    # -- values and results

    def unit(self, path: str) -> str:
        """The SI unit of a path; empty for none."""
        return self.plan.units.get(path, "")

    def of_kind(self, *kinds: type[Any]) -> list[str]:
        """Paths with ranges, distributions or lists (tuples)."""
        return [path for path, each in self.over.items() if isinstance(each, kinds)]

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

    def check_unit(self, value: float, unit: str, what: str, *path: str | int) -> None:
        """Refuse a number with a unit of another dimension than ``unit`` [SI]."""
        if wrong := unfit(value, unit):
            raise RefusedError(f"{what} is in {unit}, and {wrong}", *path)

    def check_result(self, name: str, *path: str | int) -> None:
        """Refuse a name that is no result."""
        if name not in self.kept:
            raise RefusedError(f"no run keeps {quoted(name)}{or_near(name, self.kept)} "
                               f"(kept: {listed(list(self.kept)) or 'nothing'})", *path)

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
            self.check_unit(limit, self.kept[name], f"{quoted(text)}: {name}", *path)
            found.append(Condition(name, relation in ("<", "<="), float(limit), text))
        return tuple(found)

    # -- runs

    @property
    def count(self) -> int:
        """Different runs so far, at both steps."""
        return len(self._visited) + len(self._halved)

    def check_runs(self, runs: int) -> None:
        """Refuse more runs than the limit."""
        if problems := list(over(self.job.limits, "runs", runs, "search",
                                 "the search has {count} runs")):
            raise SceneError(problems)

    @cached_property
    def _log(self) -> Log:
        self.workers = check_workers(self.workers)
        folder = self.out or Path(self.stack.enter_context(
            tempfile.TemporaryDirectory(prefix="sandbox-search-")))
        return self.stack.enter_context(Log(folder))

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
            self._halved.update(id for id, _ in wanted)
        else:
            self._visited.update(wanted)
        if missing := {id: point for id, point in wanted if id not in known}:
            for row in self._workers.results(missing.items()):
                self._log.add(row)
                self.on_row(row)
                known[row.id] = row
        return [known[id] for id, _ in wanted]

    def write(
        self, found: Result, *, wanted: tuple[Condition, ...] = (), line: FoundLine | None = None,
        **more: Any,
    ) -> None:
        """Write the table of all points with its figure, and ``search.json``.

        Conditions are a column of the table, and colours of the figure; ``line`` is the result on a
        path, for the figure; ``more`` are further entries of the result.
        """
        if self.out is None:
            return
        points = list(self._visited.values())
        plan = replace(self.plan, job=self.job, points=Points([
            {path: [point[path] for point in points] for path in self.paths}]))
        table = make_table(plan, self._log.rows())
        held = table.holds
        if wanted:
            worst = np.max([each.excess(table.kept[each.name]) for each in wanted], axis=0)
            held = table.met = np.where(table.done & np.isfinite(worst), worst <= 0, np.nan)
        table.write(self.out)
        if self.kind != "fit":  # it keeps whole curves, and has a figure of its own
            draw_table(table, self.out / FIGURE, held=held, found=line,
                       condition=" and ".join(each.text for each in wanted))
        given = {name: option for name, option in self.spec.model_dump().items()
                 if option not in (None, (), {}, "")}
        write_atomic(self.out / RESULT, json_text({
            "search": self.kind,
            "study": {**self.plan.written, "search": {self.kind: given}},
            "versions": {"sandbox": __version__}, "units": plan.units,
            "found": asdict(found) | more}, indent=2) + "\n")  # type: ignore[call-overload]


def make_session(
    scene: Scene, *, vary: Mapping[str, Any] | None = None,
    keep: Mapping[str, Any] | list[str] | None = None, set: Mapping[str, Any] | None = None,
    limits: Limits | None = None,
) -> Session:
    """The session of a scene and the arguments of a sweep; without ``vary``, of a study file."""
    if vary is None and not isinstance(scene, Mapping):
        return read_session(scene, limits)
    found = Session(SceneSource(study_data(scene, vary=vary or {}, keep=keep, set=set)), limits)
    if problems := [Problem(
            "bad-study",
            f"{quoted(path)} has a count, {each.count}, and a search chooses its points itself",
            allowed="the range without its count") for path, each in found.over.items()
            if isinstance(each, Range) and each.count]:
        raise SceneError(problems)
    return found


def read_session(study: Scene, limits: Limits | None = None) -> Session:
    """The session of a study: a file or data."""
    if isinstance(study, Mapping):
        return Session(SceneSource(dict(study)), limits)
    file = Path(study)
    return Session(read_source(file, limits=limits), limits, file.parent, file.stem)


def results(rows: Sequence[SweepRow], names: Iterable[str]) -> Array:
    """Results by name, [n, names]; nan for no value."""
    return np.array([[row.kept.get(name) for name in names] for row in rows], dtype=float)


def main_failure(rows: Iterable[SweepRow]) -> str:
    """Why most of these runs have no answer, after a colon; empty if all have one."""
    reasons = Counter(filter(None, (row.failure for row in rows)))
    return f": {reasons.most_common(1)[0][0]}" if reasons else ""
