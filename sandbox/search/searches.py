"""The searches as Python functions, and searches in study files."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypedDict, Unpack, cast

from pydantic import ValidationError

from sandbox.atomic_files import output_path
from sandbox.errors import Problem, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.search.fitting import Fitted, find_fit
from sandbox.search.influences import Sensitivity, find_sensitivity
from sandbox.search.optimum import Chosen, find_best
from sandbox.search.session import (
    Question,
    RefusedError,
    Scene,
    Session,
    Where,
    check_result,
    make_question,
    parse_conditions,
    read_question,
)
from sandbox.search.thresholds import ThresholdFound, find_threshold
from sandbox.sweeps.spec import SearchSpec
from sandbox.values.messages import explain
from sandbox.values.paths import JsonPath, path_text

Found = ThresholdFound | Fitted | Chosen | Sensitivity
FINDERS: Mapping[str, Callable[[Session, Any], Found]] = {
    "threshold": find_threshold, "fit": find_fit, "best": find_best,
    "sensitivity": find_sensitivity}
"""The function of each search, by its name in a study file."""


@dataclass(frozen=True)
class Search:
    """A question, and the search of its study file, if there is one."""

    question: Question
    kind: str = ""
    """Empty for a study without a search."""
    options: Mapping[str, Any] | None = None
    """Options that the file gives."""

    def run(self, place: Where, *, kind: str = "", **options: Any) -> Found:
        """Run the search.

        Args:
            place: where it runs, and where its files go.
            kind: of the search, for a study without one.
            options: that the file does not give.
        """
        kind = self.kind or kind
        written = {kind: {name: os.fspath(each) if isinstance(each, os.PathLike) else each
                          for name, each in {**options, **(self.options or {})}.items()}}
        try:
            chosen = getattr(SearchSpec.model_validate(written), kind)
        except ValidationError as error:
            raise RefusedError("; ".join(
                str(each).removeprefix(f"$.{kind}").lstrip(".: ")
                for each in explain(error, written, SearchSpec))) from None
        try:
            with ExitStack() as stack:
                return FINDERS[kind](Session(self.question, place, stack), chosen)
        except RefusedError as error:
            if not self.kind:
                raise
            raise self._wrong([(str(error), ())]) from None

    def check(self) -> Search:
        """Refuse unknown results in the file, and a measurement that is not there."""
        wrong: list[tuple[str, JsonPath]] = []
        options, written = self.options or {}, self.question.source.data["search"][self.kind]
        for name in ("where", "least", "most"):
            for number, text in enumerate(options.get(name, ())):
                try:
                    if name == "where":
                        parse_conditions([text], self.question.kept)
                    else:
                        check_result(text, self.question.kept)
                except RefusedError as error:
                    wrong.append((str(error), (name, number) if isinstance(written[name], list)
                                  else (name,)))
        data = options.get("data")
        if data is not None and not Path(data).is_file():
            wrong.append((f"there is no file {data}", ("data",)))
        if wrong:
            raise self._wrong(wrong)
        return self

    def require(self, kind: str) -> None:
        """Refuse a study whose search is of another kind."""
        if self.kind not in ("", kind):
            raise self._wrong([(f"the study is a search of the kind {self.kind}, not {kind}", ())],
                              key=True)

    def _wrong(self, problems: list[tuple[str, JsonPath]], *, key: bool = False) -> SceneError:
        source = self.question.source
        return SceneError([Problem("bad-search", message, path_text(("search", self.kind, *path)),
                                   *source.where(("search", self.kind, *path), key=key))
                           for message, path in problems], source.name)


def read_search(study: Scene, limits: Limits | None = None) -> Search:
    """The search of a study: a file or data."""
    question = read_question(study, limits)
    spec = question.plan.spec.search
    if spec is None:
        return Search(question)
    own = getattr(spec, spec.kind)
    options = {name: getattr(own, name) for name in own.model_fields_set}
    if "seed" in type(own).model_fields and "seed" in question.source.data:
        options.setdefault("seed", question.plan.spec.seed)
    if "data" in options:
        options["data"] = str(question.folder / options["data"])
    return Search(question, spec.kind, options).check()


class Shared(TypedDict, total=False):
    """Arguments of all searches."""

    vary: Mapping[str, Any]
    """Ranges, ``"2 N:8 N"``, by path; lists and distributions where the search takes them. Without
    it, ``scene`` is a study file."""
    keep: Mapping[str, Any] | list[str]
    """Results of each run, except for a fit."""
    set: Mapping[str, Any]
    """Further changes of the scene, in all runs."""
    out: str | os.PathLike[str] | None
    """A directory; runs that are finished in it are not repeated. Nowhere by default."""
    workers: int | str
    """Number of processes, by default one for each processor; or the address of a Dask
    scheduler."""
    limits: Limits | None
    """Of the scene."""


def study(
    file: Scene, *, out: str | os.PathLike[str] | None = None, workers: int | str = 0,
    limits: Limits | None = None,
) -> Found:
    """The search in a study file, under its key ``search`` (docs/searches.md).

    Args:
        file: the file, or its data.
        out: a directory; runs that are finished in it are not repeated. Nowhere by default.
        workers: number of processes, by default one for each processor; or the address of a Dask
            scheduler.
        limits: of the scene.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: the study has no search; as the search itself.
        OutputError: the directory cannot be written.
    """
    found = read_search(file, limits)
    if not found.kind:
        raise RefusedError('the study has no key "search": add the kind of search')
    return found.run(_where(out, workers))


def threshold(
    scene: Scene, *, where: Sequence[str] | str = (), within: float | str | None = None,
    **shared: Unpack[Shared],
) -> ThresholdFound:
    """The value of one path at which a condition begins or ceases to hold (docs/searches.md).

    Args:
        scene: a scene.
        where: conditions, as ``"moved < 1 mm"``; by default the scene's expectations.
        within: width of the bracket; by default a thousandth of the range.
        shared: ``vary`` (one path with a range), ``keep``, ``set``, ``out``, ``workers``,
            ``limits``: see :class:`Shared`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: both ends of the range have the same answer; a run has none.
        OutputError: the directory cannot be written.
    """
    return cast("ThresholdFound", _run(scene, "threshold", shared, where=where, within=within))


def fit(
    scene: Scene, data: str | os.PathLike[str], *, match: Mapping[str, str] | None = None,
    noise: Mapping[str, float | str] | None = None, **shared: Unpack[Shared],
) -> Fitted:
    """The values of paths with which a scene reproduces a measurement (docs/searches.md).

    Args:
        scene: a scene.
        data: a CSV file with a column ``time`` [s] and columns of quantities, SI or ``x [mm]``.
        match: the quantity of each column, ``{"x": "puck.x"}``; by default columns that have a
            quantity's name.
        noise: standard deviation of each column; estimated by default.
        shared: ``vary`` (ranges), ``set``, ``out``, ``workers``, ``limits``: see :class:`Shared`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: data that cannot be used, a run without an answer.
        OutputError: the directory cannot be written.
    """
    return cast("Fitted", _run(scene, "fit", {"keep": [], **shared}, data=data,
                               match=match, noise=noise))


def best(
    scene: Scene, *, least: Sequence[str] | str = (), most: Sequence[str] | str = (),
    where: Sequence[str] | str = (), sampler: str | None = None, runs: int = 200, seed: int = 0,
    **shared: Unpack[Shared],
) -> Chosen:
    """The values of paths that minimise or maximise results (docs/searches.md).

    Args:
        scene: a scene.
        least: names of results to minimise; several goals have several solutions.
        most: names of results to maximise.
        where: conditions, as ``"slip < 1 mm"``.
        sampler: of Optuna: ``cmaes``, ``tpe``, ``gp``, ``nsga2``, ``random``.
        runs: number of runs.
        seed: of the sampler.
        shared: ``vary`` (ranges and lists), ``keep``, ``set``, ``out``, ``workers``, ``limits``:
            see :class:`Shared`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: no run meets the conditions; a package is not installed.
        OutputError: the directory cannot be written.
    """
    return cast("Chosen", _run(scene, "best", shared, least=least, most=most, where=where,
                               sampler=sampler, runs=runs, seed=seed))


def sensitivity(
    scene: Scene, *, method: str = "sobol", count: int = 64, seed: int = 0,
    **shared: Unpack[Shared],
) -> Sensitivity:
    """The influence of each path on each result (docs/searches.md).

    Args:
        scene: a scene.
        method: ``sobol`` (shares of the variance) or ``morris`` (screening).
        count: base points, a power of 2, or trajectories.
        seed: of the points.
        shared: ``vary`` (two or more paths), ``keep``, ``set``, ``out``, ``workers``, ``limits``:
            see :class:`Shared`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: too few runs have an answer; SALib is not installed.
        OutputError: the directory cannot be written.
    """
    return cast("Sensitivity", _run(scene, "sensitivity", shared, method=method, count=count,
                                    seed=seed))


def _run(scene: Scene, kind: str, shared: Shared, **options: Any) -> Found:
    given = dict(shared)
    where = _where(given.pop("out", None), given.pop("workers", 0))
    question = make_question(scene, **given)  # type: ignore[arg-type]
    if question.plan.spec.search is not None:
        raise RefusedError("the study already defines its search: use sandbox.search.study")
    return Search(question).run(where, kind=kind, **options)


def _where(out: Any, workers: Any) -> Where:
    return Where(None if out is None else output_path(out, "a search"), workers)
