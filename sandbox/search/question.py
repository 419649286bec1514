"""A search as it is asked: the words of a sweep, of which it chooses the points itself."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import TypeAdapter, ValidationError

from sandbox.errors import Problem, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.messages import explain
from sandbox.scene.read.paths import parse_path, path_text
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.scene.values.numbers import message_of
from sandbox.search.space import Space
from sandbox.sweeps.job import STEP
from sandbox.sweeps.plan import Plan, make_plan, study_file
from sandbox.sweeps.points import plain, with_unit
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.sweep import study_data
from sandbox.sweeps.table import MET
from sandbox.sweeps.varied import Distributed, Varied
from sandbox.sweeps.words import varied_from
from sandbox.wording import WrongValueError, quoted

RANGES = '"vary": {"parameters.pull": {"from": "2 N", "to": "8 N"}}'
TAILS = np.array([0.01, 0.99])
"""Quantiles of a distribution at which the scene is tried before anything runs."""
Scene = str | os.PathLike[str] | Mapping[str, Any]


@dataclass(frozen=True)
class Question:
    """A scene, what is varied in it, and what is kept of its runs."""

    plan: Plan
    """Of the two ends of all ranges: what each run needs besides its point."""
    space: Space
    source: SceneSource
    """The study as it was written."""
    folder: Path = Path()
    """Where files are that it names."""

    def __repr__(self) -> str:
        return f"<Question of {self.name!r}: {len(self.kept)} kept>"

    @property
    def name(self) -> str:
        """Of the study, or of its scene."""
        return self.plan.name

    @property
    def kept(self) -> dict[str, str]:
        """What is kept of each run, and its SI unit."""
        return {name: self.plan.units.get(name, "") for name in self.plan.job.keep}


def asked(
    scene: Scene, *, vary: Mapping[str, Any] | None = None,
    keep: Mapping[str, Any] | list[str] | None = None, set: Mapping[str, Any] | None = None,
    limits: Limits | None = None,
) -> Question:
    """The question of a study file, or of a scene and the words of a sweep.

    Args:
        scene: a scene; with ``vary`` left out, a study file.
        vary: ranges (``"2 N:8 N"``), distributions and lists by path.
        keep: what is kept of each run.
        set: what else is changed, in all runs.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem.
    """
    if vary is None and not isinstance(scene, Mapping):
        return asked_in(scene, limits)
    data = study_data(scene, vary=vary or {}, keep=keep, set=set)
    if counted := [Problem(
            "bad-study",
            f"{quoted(path)} has a count, {each['count']}, and a search chooses its points itself",
            allowed="the range without its count") for group in data["vary"]
            for path, each in group["over"].items() if _spans(each) and each.get("count")]:
        raise SceneError(counted)
    return _asked(SceneSource(data), limits, Path(), "")


def asked_in(study: Scene, limits: Limits | None = None) -> Question:
    """The question of a study: a file, a shipped one's name, or a mapping of what a file holds.

    Raises:
        SceneError: every problem.
    """
    if isinstance(study, Mapping):
        return _asked(SceneSource(dict(study)), limits, Path(), "")
    file = study_file(os.fspath(study), limits) or Path(study)
    return _asked(read_source(file, limits=limits), limits, file.parent, file.stem)


def _asked(source: SceneSource, limits: Limits | None, folder: Path, name: str) -> Question:
    if not isinstance(source.data, dict):
        raise SceneError([Problem("bad-study", "a study is an object {…}")], source.name)
    if "vary" not in source.data:
        raise SceneError(_without_vary(source), source.name)
    over = _merged(source)
    data = {"audit": False, **source.data, "vary": [
        {"over": {path: _ends(path, each) for path, each in over.items()}, "design": "paired"}]}
    try:
        plan = make_plan(replace(source, data=data), limits or Limits(), folder=folder, name=name)
    except SceneError as error:
        raise SceneError([_as_written(each, source) for each in error.problems],
                         source.name) from None
    if STEP in over:
        raise SceneError([Problem("bad-search",
                                  f"a search does not vary {STEP}: it is halved to see whether "
                                  "what was found hangs on it")], source.name)
    if MET in plan.job.keep:
        raise SceneError([Problem("duplicate-name",
                                  f"{quoted(MET)} is another column of the table", "$.keep",
                                  *source.where(("keep",)), allowed="another name")], source.name)
    spans = plan.spec.vary[0].over
    return Question(plan, Space(
        {path: spans[path] if _spans(each) else _value(path, each) for path, each in over.items()},
        {path: plan.units.get(path, "") for path in over}), source, folder)


def _as_written(problem: Problem, source: SceneSource) -> Problem:
    """A problem of the one group that a search makes of all, where its path was written."""
    vary = source.data.get("vary")
    found = parse_path(problem.path)
    if problem.file or found[:3] != ("vary", 0, "over") or len(found) < 4:
        return problem
    path = str(found[3])
    before: tuple[str | int, ...] = ("vary",) if isinstance(vary, dict) else next(
        ("vary", place, "over") for place, group in enumerate(vary) if path in group["over"])
    written = (*before, *found[3:])
    line, column = source.where(written, key=problem.key)
    return replace(problem, path=path_text(written), line=line, column=column)


def _without_vary(source: SceneSource) -> list[Problem]:
    """What is wrong with a search that has no key ``vary``: another key may be meant as it."""
    found: list[Problem] = []
    try:
        SweepSpec.model_validate({"vary": None, **source.data})
    except ValidationError as error:
        found = [each for each in explain(error, source.data, SweepSpec) if each.key]
    if not any("vary" in each.hint for each in found):
        found.append(Problem("bad-study", "the search does not say what is varied", allowed=RANGES))
    return [replace(each, line=line, column=column) for each in found
            for line, column in [source.where(parse_path(each.path), key=each.key)]]


def _merged(source: SceneSource) -> dict[str, Any]:
    """What each path is given: of a search all groups are one."""
    vary = source.data.get("vary")
    groups = vary if isinstance(vary, list) else [{"over": vary}]
    found: dict[str, Any] = {}
    for group in groups:
        over = group.get("over") if isinstance(group, dict) else None
        if not isinstance(over, dict) or not over:
            raise SceneError([Problem(
                "bad-study",
                "the search does not say what is varied", "$.vary", *source.where(("vary",)),
                allowed=RANGES)], source.name)
        found.update({path: _said(path, each, source) for path, each in over.items()})
    return found


def _said(path: str, written: Any, source: SceneSource) -> Any:
    """What a path is given, the command line's words for it as an object."""
    try:
        return varied_from(written) if isinstance(written, str) else written
    except WrongValueError as error:
        raise SceneError([_as_written(Problem.of(
            error, path_text(("vary", 0, "over", path))), source)], source.name) from None


def _spans(written: Any) -> bool:
    return isinstance(written, dict) and "distribution" not in written


def _ends(path: str, written: Any) -> Any:
    """The two ends of what a path is given, as values of a sweep."""
    if _spans(written):
        return {**written, "count": 2}
    value = _value(path, written)
    if isinstance(value, Distributed):
        return with_unit(value.at(TAILS), value.unit)
    assert isinstance(value, tuple)  # spans are those above
    return [plain(value[0]), plain(value[-1])]


def _value(path: str, written: Any) -> Varied:
    try:
        found: Varied = TypeAdapter(Varied).validate_python(written)
        return found
    except ValidationError as error:
        raise SceneError([Problem("bad-search", message_of(each), path_text(("vary", path)))
                          for each in error.errors()]) from None
