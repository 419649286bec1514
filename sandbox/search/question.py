"""The question of a search: a scene, the ranges of its paths, and the results of each run."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.errors import Problem, SceneError
from sandbox.numeric import Array
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.sweeps.job import STEP, Override
from sandbox.sweeps.plan import Plan, make_plan, study_file
from sandbox.sweeps.points import Axis, Points, number_of, values_at
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.sweep import study_data
from sandbox.sweeps.table import MET
from sandbox.sweeps.vary import Distribution, Range, Values, parse_values
from sandbox.wording import WrongValueError, quoted

TAILS = np.array([0.01, 0.99])
"""Quantiles of a distribution at which the scene is read before anything runs."""
DIFFERENCE = 1e-5
"""Of quantiles, by which slopes are computed."""
Scene = str | os.PathLike[str] | Mapping[str, Any]
Point = Mapping[str, Override]


@dataclass(frozen=True)
class Space:
    """Varied paths; a point is given by quantiles from 0 to 1."""

    over: Mapping[str, Values]
    units: Mapping[str, str]
    """SI, by path; empty for none."""

    @property
    def paths(self) -> tuple[str, ...]:
        """All varied paths."""
        return tuple(self.over)

    def of_kind(self, kind: type[Range] | type[Distribution] | type[tuple[Any, ...]]) -> list[str]:
        """Paths with ranges, distributions or lists (tuples)."""
        return [path for path, each in self.over.items() if isinstance(each, kind)]

    def points(self, quantiles: Array | Sequence[Sequence[float]]) -> list[Point]:
        """Values of all paths at quantiles, [n, paths]."""
        table = np.asarray(quantiles, dtype=float)
        columns = [values_at(each, table[:, k]) for k, each in enumerate(self.over.values())]
        return [dict(zip(self.paths, values, strict=True))
                for values in zip(*columns, strict=True)]

    def numbers(self, quantiles: Array | Sequence[Sequence[float]]) -> Array:
        """The same in SI, [n, paths]; nan for texts."""
        found = [[number_of(value) for value in point.values()]
                 for point in self.points(quantiles)]
        return np.array([[value if isinstance(value, float) else np.nan for value in row]
                         for row in found])

    def slopes(self, quantiles: Array) -> Array:
        """Derivative of each path's number [SI] by its quantile, [paths], at quantiles [paths]."""
        ends = np.clip([quantiles - DIFFERENCE, quantiles + DIFFERENCE], 0, 1)
        low, high = self.numbers(ends)
        return np.asarray((high - low) / (ends[1] - ends[0]))


@dataclass(frozen=True)
class Question:
    """A scene, its varied paths, and the results of its runs."""

    plan: Plan
    """A sweep of the ends of all ranges."""
    space: Space
    source: SceneSource
    """The study as it was written."""
    folder: Path = Path()
    """To which file names are relative."""

    def __repr__(self) -> str:
        return f"<Question of {self.name!r}: {len(self.kept)} kept>"

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
        return {**self.plan.written, "vary": self.source.data["vary"]}


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

    Raises:
        SceneError: every problem of the study or its scene.
    """
    if vary is None and not isinstance(scene, Mapping):
        return read_question(scene, limits)
    data = study_data(scene, vary=vary or {}, keep=keep, set=set)
    counts = {path: each["count"] for group in data["vary"] for path, each in group["over"].items()
              if isinstance(each, Mapping) and each.get("count")}
    if counts:
        raise SceneError([Problem(
            "bad-study",
            f"{quoted(path)} has a count, {count}, and a search chooses its points itself",
            allowed="the range without its count") for path, count in counts.items()])
    return _question(SceneSource(data), limits, Path(), "")


def read_question(study: Scene, limits: Limits | None = None) -> Question:
    """The question of a study: a file or data.

    Raises:
        SceneError: every problem of the study or its scene.
    """
    if isinstance(study, Mapping):
        return _question(SceneSource(dict(study)), limits, Path(), "")
    file = study_file(os.fspath(study), limits) or Path(study)
    return _question(read_source(file, limits=limits), limits, file.parent, file.stem)


def _question(source: SceneSource, limits: Limits | None, folder: Path, name: str) -> Question:
    data, vary = source.data, source.data.get("vary") if isinstance(source.data, dict) else None
    if isinstance(vary, (dict, list)):
        groups = vary if isinstance(vary, list) else [{"over": vary}]
        data = {"audit": False, **data, "vary": [
            {"over": {path: _uncounted(each) for path, each in group["over"].items()},
             "design": "random", "count": 2}
            if isinstance(group, dict) and isinstance(group.get("over"), dict) else group
            for group in groups]}
    try:
        plan = make_plan(replace(source, data=data), limits, folder=folder, name=name,
                         points_of=_ends)
    except SceneError as error:
        if not isinstance(vary, dict):
            raise
        raise SceneError([_as_written(each, source) for each in error.problems],
                         source.name) from None
    if STEP in plan.points.paths:
        raise SceneError([Problem("bad-search",
                                  f"a search does not vary {STEP}: it is halved to see whether "
                                  "the result depends on it")], source.name)
    if MET in plan.job.keep:
        raise SceneError([Problem("duplicate-name",
                                  f"{quoted(MET)} is another column of the table", "$.keep",
                                  *source.where(("keep",)), allowed="another name")], source.name)
    over = {path: each for group in plan.spec.vary for path, each in group.over.items()}
    return Question(plan, Space(over, {path: plan.units.get(path, "") for path in over}), source,
                    folder)


def _uncounted(written: Any) -> Any:
    """The values of a path without the count that a sweep needs."""
    try:
        found = parse_values(written) if isinstance(written, str) else written
    except WrongValueError:
        return written  # the model of the study reports it
    return {key: each for key, each in found.items() if key != "count"} \
        if isinstance(found, dict) else found


def _ends(spec: SweepSpec) -> Points:
    """Two points, at both ends of all ranges and lists, and in the tails of distributions."""
    return Points([[Axis(path, values_at(values, TAILS if isinstance(values, Distribution)
                                         else np.array([0.0, 1.0])))
                    for group in spec.vary for path, values in group.over.items()]])


def _as_written(problem: Problem, source: SceneSource) -> Problem:
    """A problem of the group written as ``"vary": {…}``, at the place in the file."""
    path = problem.path.replace("$.vary[0].over", "$.vary")
    if path == problem.path or problem.file:
        return problem
    from sandbox.values.paths import parse_path

    line, column = source.where(parse_path(path), key=problem.key)
    return replace(problem, path=path, line=line, column=column)
