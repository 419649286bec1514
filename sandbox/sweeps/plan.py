"""From what was written to what is run: a sweep with its scene read and its first points tried.

All that can be known before anything runs is told here, every problem at once: a path that is
nothing, a value that no field takes, a quantity that no run will have.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import Catalogue
from sandbox.samples.samples import TIME
from sandbox.scene.elements.settings import Expect, Looked
from sandbox.scene.library import find_scene, shipped_scenes
from sandbox.scene.read.limits import Limits, over
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.read.messages import explain
from sandbox.scene.read.paths import parse_path
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.scene.values.expressions import parse_expression
from sandbox.scene.values.units import unit_in
from sandbox.sweeps.bundle import bundled
from sandbox.sweeps.job import SweepJob, run_id
from sandbox.sweeps.points import Axis, Planned, Points, number_of
from sandbox.sweeps.spec import UNCOUNTED, SweepSpec
from sandbox.sweeps.varied import si_unit
from sandbox.wording import WrongValueError, counted, is_pattern, kind_of, listed, near, quoted

COLUMNS = ("run", "id", "status", "reason", "holds", "failed", "looks", "seed")
"""What a table has of each run besides its values and what is kept."""
MOST_COLUMNS = 2_000
DURATION = "run.duration"
SETTING = "cannot set "
"""How a problem of a path that a scene has not begins."""


@dataclass(frozen=True)
class Plan:
    """A sweep that can be run."""

    spec: SweepSpec
    job: SweepJob
    points: Planned
    loaded: Loaded
    """The scene with what ``set`` changes, and as it is of what is varied."""
    written: Mapping[str, Any]
    """The study as it was written."""

    @property
    def name(self) -> str:
        """Of the sweep."""
        return self.spec.name or self.loaded.mechanism.name

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return f"<Plan of {self.name!r}: {counted(len(self), 'run')}, {len(self.job.keep)} kept>"

    @cached_property
    def ids(self) -> list[str]:
        """The ids of all runs; of the same point twice the same."""
        digest = self.job.digest
        return [run_id(digest, self.points[run]) for run in range(len(self))]

    @cached_property
    def units(self) -> dict[str, str]:
        """The SI unit of each path and of each that is kept; empty where it has none."""
        found = {}
        for axis in self.points.axes:
            unit = unit_in(axis.written[0]) or written_unit(self.loaded, axis.path)
            found[axis.path] = si_unit(unit)
        catalogue = Catalogue(self.loaded.mechanism)
        for name, asked in self.job.keep.items():
            unit = ""
            if isinstance(asked, Looked) and asked.quantity in catalogue:
                unit = catalogue.find(asked.quantity).unit
            elif isinstance(asked, Looked) and asked.quantity == TIME:
                unit = "s"
            found[name] = "" if unit == "1" else unit
        return found


def written_unit(base: Loaded, path: str) -> str:
    """The unit of the value that a path has in a scene's own file; empty for none."""
    value = base.origins.source.data
    for step in parse_path(path):
        if isinstance(value, dict):
            value = value.get(str(step))
        elif isinstance(value, list):
            value = value[step] if isinstance(step, int) and step < len(value) else next(
                (each for each in value if isinstance(each, dict) and each.get("name") == step),
                None)
    return unit_in(value)


def read_plan(source: str | os.PathLike[str], limits: Limits | None = None) -> Plan:
    """The plan of a study file.

    Raises:
        SceneError: every problem of the file, or of the scene.
    """
    path = study_file(os.fspath(source), limits) or Path(source)
    found = read_source(path, limits=limits)
    return make_plan(found, limits or Limits(), folder=path.parent, name=path.stem)


def plan_of(data: Mapping[str, Any], limits: Limits | None = None) -> Plan:
    """The plan of what a study file would hold; its scene is found from the working directory.

    Raises:
        SceneError: every problem.
    """
    return make_plan(SceneSource(dict(data)), limits or Limits(), folder=Path())


def make_plan(found: SceneSource, limits: Limits, *, folder: Path, name: str = "") -> Plan:
    """The plan of a study's data.

    Args:
        found: the data, and where they were written.
        limits: how large each run may be, and how many there may be.
        folder: where files are that it names.
        name: of the study, if it has none.

    Raises:
        SceneError: every problem.
    """
    data = found.data
    if not isinstance(data, dict):
        raise SceneError([Problem("bad-study",
                                  f"a study is an object {{…}}, not {kind_of(data)}", "$",
                                  *found.where(()))], found.name)
    making = _Making(found, limits, folder)
    scene = making.scene()
    base = making.based(scene)
    spec = making.spec(base)
    points = Points(spec)
    making.count(points)
    durations = making.extremes(scene, spec, points)
    making.windows(spec, durations, points)
    keep = making.kept(spec, base, points)
    making.refuse()
    bundle, base = bundled(scene, spec.set, limits,
                           also=[axis.written for axis in points.axes])
    job = SweepJob(bundle, spec.set, keep, audited=spec.audit, limits=limits)
    return Plan(spec.model_copy(update={"name": spec.name or name}), job, points, base, data)


@dataclass
class _Making:
    """A plan on its way, and what is wrong with it so far."""

    found: SceneSource
    limits: Limits
    folder: Path
    problems: list[Problem] = dataclasses.field(default_factory=list)

    def refuse(self) -> None:
        """Stop here if anything is wrong."""
        if self.problems:
            raise SceneError(self._placed(), self.found.name)

    def _placed(self) -> list[Problem]:
        placed = []
        for problem in self.problems:
            line, column = self.found.where(parse_path(problem.path), key=problem.key)
            placed.append(problem if problem.file else replace(problem, line=line, column=column))
        return placed

    def scene(self) -> Path | dict[str, Any]:
        """Where the scene is, or what it is."""
        named = self.found.data.get("scene")
        if isinstance(named, dict):
            return named
        if not isinstance(named, str) or not named.strip():
            self.problems.append(Problem(
                "missing-key",
                "the study does not say which scene it is of", "$.scene" if named else "$",
                allowed='"scene": a file beside it, the name of a shipped scene, or a scene'))
            self.refuse()
        path = self.folder / str(named)
        if path.suffix == ".json" and path.is_file():
            return path
        shipped = shipped_scenes()
        if named in shipped:
            return shipped[str(named)]
        try:
            return find_scene(path if path.suffix == ".json" else str(named))
        except SceneError as error:
            self.problems += [replace(each, path="$.scene") for each in error.problems]
            self.refuse()
            raise

    def based(self, scene: Path | dict[str, Any]) -> Loaded:
        """The scene with what is set in every run."""
        overrides = self.found.data.get("set", {})
        overrides = overrides if isinstance(overrides, dict) else {}
        return read_scene(scene, overrides=overrides, limits=self.limits)

    def spec(self, base: Loaded) -> SweepSpec:
        """What was written, with all numbers and words looked over."""
        data = self.found.data
        context = {"parameters": base.scene.parameters}
        try:
            return SweepSpec.model_validate(data, context=context)
        except ValidationError as error:
            told = explain(error, data, SweepSpec)
            uncounted = sum(each["type"] == UNCOUNTED for each in error.errors())
            if "search" in data and uncounted == len(told):
                told = [Problem("bad-study",
                                "the study is a search, whose ranges have no points of their own: "
                                "'sandbox search' runs it", "$.search", key=True)]
            self.problems += told
            self.refuse()
            raise

    def count(self, points: Points) -> None:
        """See that there are not too many runs."""
        self.problems += over(self.limits, "runs", len(points), "$.vary",
                              "the sweep has {count} runs")
        self.refuse()

    def extremes(
        self, scene: Path | dict[str, Any], spec: SweepSpec, points: Points,
    ) -> set[float]:
        """Read the scene at the first point, and where each path is least and largest.

        Returns:
            how long the runs there are [s].
        """
        told, durations = set[str](), set[float]()
        for run in sorted(set(_extremes(points))):
            values = points[run]
            try:
                durations.add(read_scene(scene, overrides={**spec.set, **values},
                                         limits=self.limits).mechanism.run.duration)
            except SceneError as error:
                here = ", ".join(f"{path} = {value}" for path, value in values.items())
                for each in error.problems:
                    if each.message in told:
                        continue
                    told.add(each.message)
                    own = each if each.message.startswith(SETTING) else Problem(
                        "bad-study", f"with {here} the scene is wrong: {each}")
                    self.problems.append(replace(own, path=self._path_of(each, spec), line=0,
                                                 column=0, file=""))
        self.refuse()
        return durations

    def windows(self, spec: SweepSpec, durations: set[float], points: Points) -> None:
        """See that windows of time are no longer than the longest run.

        It is known where the duration is varied by itself, or not at all: of one that follows from
        other values in some way, the longest may lie anywhere between them.
        """
        if len(durations) > 1 and DURATION not in points.paths:
            return
        for name, each in spec.keep.items():
            beyond = "" if isinstance(each, str) else each.past_end(max(durations))
            if beyond:
                self.problems.append(Problem("bad-time", beyond, f'$.keep["{name}"]'))

    def _path_of(self, problem: Problem, spec: SweepSpec) -> str:
        """Where in the study the path stands that a problem of the scene is about."""
        for group in spec.vary:
            for path in group.over:
                if quoted(path) in problem.message or f"$.{path}" == problem.path:
                    return self._inside(path, spec)
        return "$.vary"

    def _inside(self, path: str, spec: SweepSpec) -> str:
        """Where in the study a path of the scene stands."""
        listed_ = isinstance(self.found.data.get("vary"), list)
        place = next(i for i, group in enumerate(spec.vary) if path in group.over)
        return f'{f"$.vary[{place}].over" if listed_ else "$.vary"}["{path}"]'

    def kept(
        self, spec: SweepSpec, base: Loaded, points: Points,
    ) -> dict[str, Looked | str]:
        """What is kept, patterns written out; of a study that says nothing, what is expected."""
        asked: dict[str, Looked | str] = dict(spec.keep) or _expected(base)
        catalogue = Catalogue(base.mechanism)
        found: dict[str, Looked | str] = {}
        for name, each in asked.items():
            path = f'$.keep["{name}"]'
            if isinstance(each, str):
                self._expression(each, {*base.scene.parameters, *found}, path)
                found[name] = each
                continue
            names = catalogue.match(each.quantity) or [TIME] * (each.quantity == TIME)
            if not names:
                hint = catalogue.near(each.quantity)
                self.problems.append(Problem(
                    "unknown-quantity", f"no run has the quantity {quoted(each.quantity)}", path,
                    allowed=catalogue.lacking(each.quantity) or catalogue.allowed(each.quantity),
                    hint=quoted(hint) if hint else ""))
            for quantity in names:
                found[_column(name, each.quantity, quantity)] = Looked.model_validate(
                    each.model_dump(exclude_defaults=True) | {each.key: quantity})
        for name in found:
            if name in COLUMNS or name in points.paths:
                self.problems.append(Problem("duplicate-name",
                                             f"{quoted(name)} is another column of the table",
                                             "$.keep", allowed="another name"))
        self.problems += [Problem("limit-exceeded",
                                  f"{len(found)} quantities of each run would be kept", "$.keep",
                                  allowed=f"at most {MOST_COLUMNS}")] * (len(found) > MOST_COLUMNS)
        return found

    def _expression(self, text: str, known: set[str], path: str) -> None:
        try:
            names = parse_expression(text).names
        except WrongValueError as error:
            self.problems.append(Problem.of(error, path))
            return
        for name in sorted(names - known):
            self.problems.append(Problem(
                "name-not-found", f"unknown name {quoted(name)} in an expression", path,
                hint=near(name, known),
                allowed=f"parameters and what is kept before it: {listed(sorted(known))}"))


def _extremes(points: Points) -> Iterator[int]:
    """Runs in which some path is least or largest; of texts, the first of each."""
    yield 0
    wanted: list[tuple[Axis, set[int]]] = []
    for axis in points.axes:
        numbers = [number_of(value) for value in axis.written]
        if all(isinstance(number, float) for number in numbers):
            order = sorted(range(len(numbers)), key=numbers.__getitem__)
            wanted.append((axis, {order[0], order[-1]}))
        else:
            seen = dict((str(value), place) for place, value in
                        reversed(list(enumerate(axis.written))))
            wanted.append((axis, set(list(seen.values())[:20])))
    for axis, places in wanted:
        for place in places:
            yield points.first(axis.path, place)


def _expected(base: Loaded) -> dict[str, Looked | str]:
    """What the scene's expectations look at."""
    fields = set(Looked.model_fields)
    return {f"{each.statistic} {each.quantity}": Looked.model_validate(
        each.model_dump(include=fields, exclude_defaults=True)) for each in base.mechanism.expect
        if isinstance(each, Expect)}


def _column(name: str, pattern: str, quantity: str) -> str:
    """The name of what is kept of one of the quantities that a pattern fits."""
    if not is_pattern(pattern):
        return name
    return name.replace(pattern, quantity) if pattern in name else f"{name} {quantity}"


def study_file(word: str, limits: Limits | None = None) -> Path | None:
    """The study file that a word names; None for a scene.

    It varies or searches, or its ``scene`` is a name, which no scene has: so one whose ``vary`` is
    misspelt is read as a study, and told so.

    Raises:
        SceneError: a file that cannot be read.
    """
    path = Path(word)
    if path.suffix != ".json" or not path.is_file():
        return None
    data = read_source(path, limits=limits).data
    if not isinstance(data, dict):
        return None
    return path if {"vary", "search"} & data.keys() or isinstance(data.get("scene"), str) else None
