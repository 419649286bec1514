"""The searches as they are called from Python: the words of a sweep, and those of the search."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from sandbox.atomic_files import output_path
from sandbox.scene.read.limits import Limits
from sandbox.search.asking import Where
from sandbox.search.criteria import RefusedError
from sandbox.search.fitting import Fitted, find_fit
from sandbox.search.influences import Sensitivity, find_sensitivity
from sandbox.search.least_squares import DIFFERENCE
from sandbox.search.optimum import Chosen, find_best, goals_of
from sandbox.search.question import Question, Scene, asked
from sandbox.search.regions import find_robustness
from sandbox.search.regions_found import RobustnessFound
from sandbox.search.thresholds import ThresholdFound, find_threshold
from sandbox.search.written import Found, read_search
from sandbox.sweeps.searching import COARSE, PROBES, RUNS, WITHIN

Keep = Mapping[str, Any] | list[str] | None


def study(
    file: Scene, *, out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> Found:
    """The search that stands in a study file, under its key ``search`` (docs/searches.md).

    Args:
        file: the file, a shipped study's name, or a mapping of what a file holds.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the study or of its scene.
        SandboxError: the study says no search, or what the search itself raises.
        OutputError: the directory cannot be written.
    """
    found = read_search(file, limits)
    if not found.kind:
        raise RefusedError("the study does not say which search it is: it has no key \"search\"")
    return found.run(_place(out, workers, cluster))


def threshold(
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    set: Mapping[str, Any] | None = None, where: Sequence[str] | str = (),
    within: float | None = None, share: float = 0.5, runs: int = 200, seed: int = 0,
    out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> ThresholdFound:
    """Where a condition begins or ceases to hold along one range (docs/searches.md).

    Args:
        scene: a scene; with ``vary`` left out, a study file.
        vary: one path with a range, ``"2 N:8 N"``; others with distributions are random starts.
        keep: what is kept of each run.
        set: what else is changed, in all runs.
        where: what must hold, as ``"moved < 1 mm"``; without, the scene's expectations.
        within: how narrow the bracket or the 95 % interval is to be [SI].
        share: of random starts that is to hold.
        runs: at most so many random starts.
        seed: of random starts.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the scene or of the study.
        SandboxError: both ends of the range have the same answer; a run has none.
        OutputError: the directory cannot be written.
    """
    return find_threshold(
        _asked(scene, vary=vary, keep=keep, set=set, limits=limits), _texts(where), within=within,
        share=share, runs=runs, seed=seed, place=_place(out, workers, cluster))


def fit(
    scene: Scene, data: str | os.PathLike[str], *, vary: Mapping[str, Any] | None = None,
    match: Mapping[str, str] | None = None, noise: Mapping[str, float] | None = None,
    set: Mapping[str, Any] | None = None, difference: float = DIFFERENCE,
    out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> Fitted:
    """The values of paths with which a scene moves as was measured (docs/searches.md).

    Args:
        scene: a scene; with ``vary`` left out, a study file.
        data: a CSV file with a column ``time`` [s] and columns of quantities, SI or ``x [mm]``.
        vary: ranges by path, ``"50 N/m:500 N/m"``.
        match: the quantity that each column is, ``{"x": "puck.x"}``; by default columns that
            have a quantity's name.
        noise: standard deviation of each column [SI]; estimated by default.
        set: what else is changed, in all runs.
        difference: of the runs of which derivatives are made, in ranges.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the scene or of the study.
        SandboxError: data that cannot be read or matched, a run without an answer, no scipy.
        OutputError: the directory cannot be written.
    """
    return find_fit(_asked(scene, vary=vary, keep=[], set=set, limits=limits), Path(data),
                    match=match, noise=noise, difference=difference,
                    place=_place(out, workers, cluster))


def best(
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    least: Sequence[str] | str = (), most: Sequence[str] | str = (),
    where: Sequence[str] | str = (), set: Mapping[str, Any] | None = None,
    sampler: str = "", runs: int = 200, seed: int = 0,
    out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> Chosen:
    """The values of paths with which something is least or most (docs/searches.md).

    Args:
        scene: a scene; with ``vary`` left out, a study file.
        vary: ranges, ``"2 N:8 N"``, and lists by path.
        keep: what is kept of each run.
        least: names of what is kept that is to be least; several goals have several answers.
        most: names of what is kept that is to be most.
        where: conditions, as ``"slip < 1 mm"``.
        set: what else is changed, in all runs.
        sampler: how points are chosen: ``cmaes``, ``tpe``, ``gp``, ``nsga2``, ``random``.
        runs: how many.
        seed: of the sampler.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the scene or of the study.
        SandboxError: no run meets the conditions; what needs a package that is not installed.
        OutputError: the directory cannot be written.
    """
    goals = goals_of(_texts(least), _texts(most))
    return find_best(
        _asked(scene, vary=vary, keep=keep, set=set, limits=limits), goals, _texts(where),
        sampler=sampler, runs=runs, seed=seed, place=_place(out, workers, cluster))


def sensitivity(
    scene: Scene, *, vary: Mapping[str, Any] | None = None, keep: Keep = None,
    set: Mapping[str, Any] | None = None, method: str = "sobol", count: int = 64, seed: int = 0,
    out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> Sensitivity:
    """How much of what is kept comes from which path (docs/searches.md).

    Args:
        scene: a scene; with ``vary`` left out, a study file.
        vary: ranges, distributions and lists by path; two or more.
        keep: what is kept of each run.
        set: what else is changed, in all runs.
        method: ``sobol`` (shares of the variance) or ``morris`` (screening).
        count: of base points, a power of 2, or of trajectories.
        seed: of the points.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the scene or of the study.
        SandboxError: too few runs have an answer; SALib is not installed.
        OutputError: the directory cannot be written.
    """
    return find_sensitivity(_asked(scene, vary=vary, keep=keep, set=set, limits=limits),
                            method=method, count=count, seed=seed,
                            place=_place(out, workers, cluster))


def robustness(
    scene: Scene, *, over: Mapping[str, Any] | None = None, keep: Keep = None,
    set: Mapping[str, Any] | None = None, holds: Sequence[str] | str = (), coarse: int = COARSE,
    within: float = WITHIN, runs: int = RUNS, probes: int = PROBES, boundary: str = "",
    seed: int = 0, out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    limits: Limits | None = None,
) -> RobustnessFound:
    """Where in a range, or in the square of two, something holds (docs/robustness.md).

    Args:
        scene: a scene; with ``over`` left out, a study file.
        over: one or two paths with ranges, ``"-10 mm:10 mm"``, and at most one with a list of
            values, a map for each.
        keep: what is kept of each run.
        set: what else is changed, in all runs.
        holds: conditions, as ``"slip < 1 mm"``; without, the scene's expectations.
        coarse: cells along each range at first; what is smaller than one of them may be missed.
        within: the width of the smallest cells, as a share of each range.
        runs: at most so many, without the probes and the certificate.
        probes: random points in decided cells that say how much was missed.
        boundary: a closed form of the varied names, greater than 0 where it should hold.
        seed: of the probes.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        limits: how large scenes may be.

    Raises:
        SceneError: every problem of the scene or of the study.
        SandboxError: every problem of what is asked, a line each; no run has an answer.
        OutputError: the directory cannot be written.
    """
    return find_robustness(
        _asked(scene, vary=over, keep=keep, set=set, limits=limits), _texts(holds), coarse=coarse,
        within=within, runs=runs, probes=probes, boundary=boundary, seed=seed,
        place=_place(out, workers, cluster))


def _asked(scene: Scene, **words: Any) -> Question:
    """The question; of a study that says its own search it is not another."""
    question = asked(scene, **words)
    if question.plan.spec.search is not None:
        raise RefusedError("the study says itself which search it is: sandbox.search.study does it")
    return question


def _texts(given: Sequence[str] | str) -> Sequence[str]:
    return [given] if isinstance(given, str) else given


def _place(out: str | os.PathLike[str] | None, workers: int, cluster: str) -> Where:
    directory: Path | None = None if out is None else output_path(out, "a search")
    return Where(directory, workers, cluster)
