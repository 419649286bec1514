"""The searches as Python functions, and searches in study files."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.atomic_files import output_path
from sandbox.errors import Problem, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.search.fitting import Fitted, find_fit
from sandbox.search.influences import Sensitivity, find_sensitivity
from sandbox.search.optimum import Chosen, find_best
from sandbox.search.question import Question, Scene, make_question, read_question
from sandbox.search.session import RefusedError, Where, check_result, parse_conditions
from sandbox.search.thresholds import ThresholdFound, find_threshold
from sandbox.values.paths import path_text

Keep = Mapping[str, Any] | list[str] | None
Out = str | os.PathLike[str] | None
Found = ThresholdFound | Fitted | Chosen | Sensitivity
FINDERS: Mapping[str, Callable[..., Found]] = {
    "threshold": find_threshold, "fit": find_fit, "best": find_best,
    "sensitivity": find_sensitivity}
"""The function of each search, whose options have the names of a study file."""


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

        Raises:
            SceneError: options of the file that do not fit its ranges.
            SandboxError: as the search itself.
        """
        try:
            return FINDERS[self.kind or kind](self.question, place=place, **options,
                                              **(self.options or {}))
        except RefusedError as error:
            if not self.kind:
                raise
            raise self._wrong([(str(error), ())]) from None

    def check(self) -> Search:
        """Refuse unknown results in the file, and a measurement that is not there.

        Raises:
            SceneError: every problem.
        """
        wrong: list[tuple[str, tuple[str | int, ...]]] = []
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
        if data is not None and not data.is_file():
            wrong.append((f"there is no file {data}", ("data",)))
        if wrong:
            raise self._wrong(wrong)
        return self

    def require(self, kind: str) -> None:
        """Refuse a study whose search is of another kind.

        Raises:
            SceneError: it is.
        """
        if self.kind not in ("", kind):
            raise self._wrong([(f"the study is a search of the kind {self.kind}, not {kind}", ())],
                              key=True)

    def _wrong(
        self, problems: list[tuple[str, tuple[str | int, ...]]], *, key: bool = False,
    ) -> SceneError:
        source = self.question.source
        return SceneError([Problem("bad-search", message, path_text(("search", self.kind, *path)),
                                   *source.where(("search", self.kind, *path), key=key))
                           for message, path in problems], source.name)


def read_search(study: Scene, limits: Limits | None = None) -> Search:
    """The search of a study: a file or data.

    Raises:
        SceneError: every problem.
    """
    question = read_question(study, limits)
    spec = question.plan.spec.search
    if spec is None:
        return Search(question)
    options = spec.options
    if spec.kind in ("best", "sensitivity") and "seed" in question.source.data:
        options.setdefault("seed", question.plan.spec.seed)
    if "data" in options:
        options["data"] = question.folder / options["data"]
    return Search(question, spec.kind, options).check()


def study(
    file: Scene, *, out: Out = None, workers: int | str = 0, limits: Limits | None = None,
) -> Found:
    """The search in a study file, under its key ``search`` (docs/searches.md).

    Args:
        file: the file, a shipped study's name, or its data.
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
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    set: Mapping[str, Any] | None = None, where: Sequence[str] | str = (),
    within: float | None = None, out: Out = None, workers: int | str = 0,
    limits: Limits | None = None,
) -> ThresholdFound:
    """The value of one path at which a condition begins or ceases to hold (docs/searches.md).

    Args:
        scene: a scene; without ``vary``, a study file.
        vary: one path with a range, ``"2 N:8 N"``.
        keep: results of each run.
        set: further changes of the scene, in all runs.
        where: conditions, as ``"moved < 1 mm"``; by default the scene's expectations.
        within: width of the bracket [SI].
        out: as of :func:`study`.
        workers: as of :func:`study`.
        limits: as of :func:`study`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: both ends of the range have the same answer; a run has none.
        OutputError: the directory cannot be written.
    """
    return find_threshold(_question(scene, vary=vary, keep=keep, set=set, limits=limits),
                          _texts(where), within=within, place=_where(out, workers))


def fit(
    scene: Scene, data: str | os.PathLike[str], *, vary: Mapping[str, Any] | None = None,
    match: Mapping[str, str] | None = None, noise: Mapping[str, float] | None = None,
    set: Mapping[str, Any] | None = None, out: Out = None, workers: int | str = 0,
    limits: Limits | None = None,
) -> Fitted:
    """The values of paths with which a scene reproduces a measurement (docs/searches.md).

    Args:
        scene: a scene; without ``vary``, a study file.
        data: a CSV file with a column ``time`` [s] and columns of quantities, SI or ``x [mm]``.
        vary: ranges by path, ``"50 N/m:500 N/m"``.
        match: the quantity of each column, ``{"x": "puck.x"}``; by default columns that have a
            quantity's name.
        noise: standard deviation of each column [SI]; estimated by default.
        set: further changes of the scene, in all runs.
        out: as of :func:`study`.
        workers: as of :func:`study`.
        limits: as of :func:`study`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: data that cannot be used, a run without an answer.
        OutputError: the directory cannot be written.
    """
    return find_fit(_question(scene, vary=vary, keep=[], set=set, limits=limits), Path(data),
                    match=match, noise=noise, place=_where(out, workers))


def best(
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    least: Sequence[str] | str = (), most: Sequence[str] | str = (),
    where: Sequence[str] | str = (), set: Mapping[str, Any] | None = None,
    sampler: str | None = None, runs: int = 200, seed: int = 0,
    out: Out = None, workers: int | str = 0, limits: Limits | None = None,
) -> Chosen:
    """The values of paths that minimise or maximise results (docs/searches.md).

    Args:
        scene: a scene; without ``vary``, a study file.
        vary: ranges, ``"2 N:8 N"``, and lists by path.
        keep: results of each run.
        least: names of results to minimise; several goals have several solutions.
        most: names of results to maximise.
        where: conditions, as ``"slip < 1 mm"``.
        set: further changes of the scene, in all runs.
        sampler: of Optuna: ``cmaes``, ``tpe``, ``gp``, ``nsga2``, ``random``.
        runs: number of runs.
        seed: of the sampler.
        out: as of :func:`study`.
        workers: as of :func:`study`.
        limits: as of :func:`study`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: no run meets the conditions; a package is not installed.
        OutputError: the directory cannot be written.
    """
    return find_best(
        _question(scene, vary=vary, keep=keep, set=set, limits=limits), least=_texts(least),
        most=_texts(most), where=_texts(where), sampler=sampler, runs=runs, seed=seed,
        place=_where(out, workers))


def sensitivity(
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    set: Mapping[str, Any] | None = None, method: str = "sobol", count: int = 64, seed: int = 0,
    out: Out = None, workers: int | str = 0, limits: Limits | None = None,
) -> Sensitivity:
    """The influence of each path on each result (docs/searches.md).

    Args:
        scene: a scene; without ``vary``, a study file.
        vary: ranges, distributions and lists by path; two or more.
        keep: results of each run.
        set: further changes of the scene, in all runs.
        method: ``sobol`` (shares of the variance) or ``morris`` (screening).
        count: base points, a power of 2, or trajectories.
        seed: of the points.
        out: as of :func:`study`.
        workers: as of :func:`study`.
        limits: as of :func:`study`.

    Raises:
        SceneError: every problem of the study or its scene.
        SandboxError: too few runs have an answer; SALib is not installed.
        OutputError: the directory cannot be written.
    """
    return find_sensitivity(_question(scene, vary=vary, keep=keep, set=set, limits=limits),
                            method=method, count=count, seed=seed, place=_where(out, workers))


def _question(scene: Scene, **arguments: Any) -> Question:
    question = make_question(scene, **arguments)
    if question.plan.spec.search is not None:
        raise RefusedError("the study already defines its search: use sandbox.search.study")
    return question


def _texts(given: Sequence[str] | str) -> Sequence[str]:
    return [given] if isinstance(given, str) else given


def _where(out: Out, workers: int | str) -> Where:
    return Where(None if out is None else output_path(out, "a search"), workers)
