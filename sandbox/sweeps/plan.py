"""A sweep that can be run: its study, its scene and its points, checked before anything runs."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import Catalogue
from sandbox.samples.samples import TIME
from sandbox.scene.library import find_scene
from sandbox.scene.read.limits import Limits, over
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.read.overrides import apply_overrides
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.scene.settings import Looked
from sandbox.sweeps.job import Point, SweepJob, make_bundle, run_id
from sandbox.sweeps.spec import UNCOUNTED, SweepSpec, number_of, points_of
from sandbox.values.expressions import parse_expression
from sandbox.values.messages import explain
from sandbox.values.paths import holds, parse_path
from sandbox.values.units import dimension_of, si_unit, unit_in
from sandbox.wording import is_pattern, listed, near, quoted

Study = str | os.PathLike[str] | Mapping[str, Any]
COLUMNS = ("run", "id", "status", "reason", "met", "holds", "failed", "looks", "seed")
"""Columns of a table besides values and results."""
MAX_TRIED_TEXTS = 20  # texts of one path with which the scene is read before anything runs


@dataclass(frozen=True)
class Plan:
    """A sweep that can be run."""

    name: str
    spec: SweepSpec
    job: SweepJob
    points: Sequence[Point]
    loaded: Loaded  # the scene with the changes of ``set``, without varied values
    written: Mapping[str, Any]  # the study as it was written

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def ids(self) -> list[str]:
        """The ids of all runs; equal points have equal ids."""
        digest = self.job.digest
        return [run_id(digest, point) for point in self.points]

    @cached_property
    def units(self) -> dict[str, str]:
        """SI units of paths and results; empty for none."""
        found = {}
        data = self.loaded.origins.source.data
        for path, value in self.points[0].items():
            unit = unit_in(value)
            for place in () if unit else apply_overrides(data, {path: value})[1]:
                unit = unit_in(reduce(lambda at, step: at[step] if holds(at, step) else None,
                                      place, data))  # by default that in the scene file
            found[path] = si_unit(dimension_of(unit)) if unit else ""
        catalogue = Catalogue(self.loaded.mechanism)
        for name, keep in self.job.keep.items():
            quantity = keep.quantity if isinstance(keep, Looked) else ""
            found[name] = catalogue.find(quantity).unit if quantity in catalogue else \
                "s" if quantity == TIME else ""
        return {name: "" if unit == "1" else unit for name, unit in found.items()}


def read_study(study: Study, limits: Limits | None) -> SceneSource:
    """A study file, or the data of a study, whose files are relative to the working directory."""
    return SceneSource(dict(study)) if isinstance(study, Mapping) else \
        read_source(Path(study), limits=limits)


def plan_of(study: Study, limits: Limits | None = None) -> Plan:
    """The plan of a study file, or of the data of a study."""
    return Checks(read_study(study, limits), limits).plan()


class Checks:
    """The checks of a study, of a search only at the ends of all values, and the problems found."""

    def __init__(self, found: SceneSource, limits: Limits | None, search: bool = False) -> None:
        self.found, self.data, self.limits = found, found.data, limits or Limits()
        self.search, self.problems = search, list[Problem]()

    def plan(self) -> Plan:
        """The plan; all problems are raised together."""
        scene, overrides = self._scene(), self.data.get("set", {})
        base = read_scene(scene, overrides=overrides if isinstance(overrides, dict) else {},
                          limits=self.limits)
        try:
            spec = SweepSpec.model_validate(self.data, context={
                "parameters": base.scene.parameters, "search": self.search})
        except ValidationError as error:
            found = explain(error, self.data, SweepSpec)
            if "search" in self.data and all(each.code == UNCOUNTED and each.path.startswith(
                    "$.vary") for each in found):
                found = [Problem("bad-study", "the study is a search, whose ranges have no points "
                                 "of their own: 'sandbox search' runs it", "$.search", key=True)]
            self._refuse(*found)
            raise
        dimensions = spec.ends() if self.search else spec.dimensions()
        count = math.prod(len(next(iter(each.values()))) for each in dimensions)
        self._refuse(*over(self.limits, "runs", count, "$.vary", "the sweep has {count} runs"))
        points = points_of(dimensions)
        durations = self._read_extremes(scene, spec, points)
        if len(durations) == 1 or "run.duration" in spec.over:  # otherwise others may be longer
            self.problems += [
                Problem("bad-time", beyond, f'$.keep["{name}"]') for name, each in spec.keep.items()
                if isinstance(each, Looked) and (beyond := each.past_end(max(durations)))]
        keep = self._results(spec, base)
        self._refuse()
        bundle, base = make_bundle(scene, spec.set, self.limits, also=points)
        job = SweepJob(bundle, spec.set, keep, audited=spec.audit, limits=self.limits)
        name = spec.name or (self.found.path.stem if self.found.path else base.mechanism.name)
        return Plan(name, spec, job, points, base, self.data)

    def _refuse(self, *problems: Problem) -> None:
        if found := [*self.problems, *problems]:
            raise SceneError([each if each.file else replace(
                each, line=line, column=column) for each in found
                for line, column in [self.found.where(parse_path(each.path), key=each.key)]],
                self.found.name) from None

    def _scene(self) -> Path | dict[str, Any]:
        named = self.data.get("scene")
        if isinstance(named, dict):
            return named
        if not isinstance(named, str) or not named.strip():
            self._refuse(Problem(
                "missing-key", "the study names no scene", "$.scene" if named else "$",
                allowed='"scene": a file in the same folder, the name of a shipped scene, or a '
                        "scene"))
        folder = self.found.path.parent if self.found.path else Path()
        try:
            return find_scene(folder / str(named) if str(named).endswith(".json") else str(named))
        except SceneError as error:
            self._refuse(*(replace(each, path="$.scene") for each in error.problems))
            raise

    def _read_extremes(
        self, scene: Path | dict[str, Any], spec: SweepSpec, points: Sequence[Point],
    ) -> set[float]:
        """Durations [s] of runs at the first point, and with the extreme values of each path."""
        runs, durations, problems = {0}, set[float](), dict[str, Problem]()
        for path in spec.over:
            numbers = [number_of(point[path]) for point in points]
            if all(isinstance(number, float) for number in numbers):
                runs |= {int(np.argmin(numbers)), int(np.argmax(numbers))}
            else:
                texts = [str(point[path]) for point in points]
                runs.update(np.unique(texts, return_index=True)[1][:MAX_TRIED_TEXTS].tolist())
        for run in sorted(runs):
            values = points[run]
            try:
                durations.add(read_scene(scene, overrides={**spec.set, **values},
                                         limits=self.limits).mechanism.run.duration)
            except SceneError as error:
                for each in error.problems:
                    problems.setdefault(each.message, self._of_point(each, values, spec))
        self._refuse(*problems.values())
        return durations

    def _of_point(self, problem: Problem, values: Point, spec: SweepSpec) -> Problem:
        """A problem of the scene at one point, placed at the path that causes it."""
        several = isinstance(self.data.get("vary"), list)
        place = next((
            f'{f"$.vary[{k}].over" if several else "$.vary"}["{path}"]'
            for k, group in enumerate(spec.vary) for path in group.over
            if quoted(path) in problem.message or f"$.{path}" == problem.path), "$.vary")
        if not problem.message.startswith("cannot set "):
            here = ", ".join(f"{path} = {value}" for path, value in values.items())
            problem = Problem("bad-study", f"with {here} the scene is wrong: {problem}")
        return replace(problem, path=place, line=0, column=0, file="")

    def _results(self, spec: SweepSpec, base: Loaded) -> dict[str, Looked | str]:
        """Results by name, patterns expanded; by default those of the scene's expectations."""
        catalogue, parameters = Catalogue(base.mechanism), base.scene.parameters
        expected: dict[str, Looked | str] = {
            f"{each.statistic} {each.quantity}": Looked.model_validate(each.model_dump(
                include={*Looked.model_fields}, exclude_defaults=True))
            for each in base.mechanism.expect}
        found: dict[str, Looked | str] = {}
        for name, each in (spec.keep or expected).items():
            path = f'$.keep["{name}"]'
            if isinstance(each, str):
                known = sorted({*parameters, *found})
                self.problems += [Problem(
                    "name-not-found", f"unknown name {quoted(one)} in an expression", path,
                    hint=near(one, known),
                    allowed=f"parameters and the quantities kept before it: {listed(known)}")
                    for one in sorted(parse_expression(each).names.difference(known))]
                found[name] = each
                continue
            pattern = each.quantity
            names = catalogue.match(pattern) or [TIME] * (pattern == TIME)
            if not names:
                hint = catalogue.near(pattern)
                self.problems.append(Problem(
                    "unknown-quantity", f"no run has the quantity {quoted(pattern)}", path,
                    allowed=catalogue.lacking(pattern) or catalogue.allowed(pattern),
                    hint=quoted(hint) if hint else ""))
            for quantity in names:
                column = name if not is_pattern(pattern) else name.replace(pattern, quantity) \
                    if pattern in name else f"{name} {quantity}"
                found[column] = Looked.model_validate(
                    each.model_dump(exclude_defaults=True) | {each.key: quantity})
        self.problems += [Problem("duplicate-name",
                                  f"{quoted(name)} is another column of the table", "$.keep",
                                  allowed="another name")
                          for name in found if name in (*COLUMNS, *spec.over)]
        return found


def study_file(word: str, limits: Limits | None = None) -> SceneSource | None:
    """The study file that a word names; None for a scene, whose ``scene`` is no name."""
    path = Path(word)
    if path.suffix != ".json" or not path.is_file():
        return None
    found = read_source(path, limits=limits)
    is_study = {"vary", "search"} & found.data.keys() or isinstance(found.data.get("scene"), str)
    return found if is_study else None
