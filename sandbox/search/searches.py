"""The searches as Python functions."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypedDict, Unpack, cast

from sandbox.atomic_files import output_path
from sandbox.scene.read.limits import Limits
from sandbox.search.fitting import Fitted, find_fit
from sandbox.search.influences import Sensitivity, find_sensitivity
from sandbox.search.optimum import Chosen, find_best
from sandbox.search.session import RefusedError, Session
from sandbox.search.thresholds import ThresholdFound, find_threshold
from sandbox.sweeps.job import SweepRow
from sandbox.sweeps.plan import Study
from sandbox.sweeps.sweep import study_data

Found = ThresholdFound | Fitted | Chosen | Sensitivity
FINDERS: Mapping[str, Callable[[Session, Any], Found]] = {
    "threshold": find_threshold, "fit": find_fit, "best": find_best,
    "sensitivity": find_sensitivity}
"""The function of each search, by its name in a study file."""


def run_search(
    session: Session, out: str | os.PathLike[str] | None = None, workers: int | str = 0,
    on_row: Callable[[SweepRow], None] = lambda row: None,
) -> Found:
    """Run a search whose kind is chosen; ``on_row`` is called with each row that was run."""
    session.out = None if out is None else output_path(out, "a search")
    session.workers, session.on_row = workers, on_row
    try:
        with session.stack:
            return FINDERS[session.kind](session, session.spec)
    except RefusedError as error:
        raise session.wrong(error) from None


class Shared(TypedDict, total=False):
    """Arguments of all searches.

    Each raises a :class:`sandbox.SceneError` with every problem of the study or its scene, and a
    :class:`sandbox.OutputError` if the directory cannot be written.
    """

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
    file: Study, *, out: str | os.PathLike[str] | None = None, workers: int | str = 0,
    limits: Limits | None = None,
) -> Found:
    """The search in a study file, under its key ``search`` (docs/searches.md).

    Args:
        file: the file, or its data.
        out: as ``workers`` and ``limits`` of all searches: see :class:`Shared`.
        workers: number of processes, or an address.
        limits: of the scene.

    Raises:
        SandboxError: the study has no search; as the search itself.
    """
    return run_search(Session(file, limits), out, workers)


def threshold(
    scene: Study, *, where: Sequence[str] | str = (), within: float | str | None = None,
    **shared: Unpack[Shared],
) -> ThresholdFound:
    """The value of one path at which a condition begins or ceases to hold (docs/searches.md).

    Args:
        scene: a scene.
        where: conditions, as ``"moved < 1 mm"``; by default the scene's expectations.
        within: width of the bracket; by default a thousandth of the range.
        shared: ``vary`` (one path with a range) and others: see :class:`Shared`.

    Raises:
        SandboxError: both ends of the range have the same answer; a run has none.
    """
    return cast("ThresholdFound", _run(scene, "threshold", shared, where=where, within=within))


def fit(
    scene: Study, data: str | os.PathLike[str], *, match: Mapping[str, str] | None = None,
    noise: Mapping[str, float | str] | None = None, **shared: Unpack[Shared],
) -> Fitted:
    """The values of paths with which a scene reproduces a measurement (docs/searches.md).

    Args:
        scene: a scene.
        data: a CSV file with a column ``time`` [s] and columns of quantities, SI or ``x [mm]``.
        match: the quantity of each column, ``{"x": "puck.x"}``; by default columns that have a
            quantity's name.
        noise: standard deviation of each column; estimated by default.
        shared: ``vary`` (ranges) and others except ``keep``: see :class:`Shared`.

    Raises:
        SandboxError: data that cannot be used, a run without an answer.
    """
    return cast("Fitted", _run(scene, "fit", {"keep": [], **shared}, data=os.fspath(data),
                               match=match, noise=noise))


def best(
    scene: Study, *, least: Sequence[str] | str = (), most: Sequence[str] | str = (),
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
        shared: ``vary`` (ranges and lists) and others: see :class:`Shared`.

    Raises:
        SandboxError: no run meets the conditions; a package is not installed.
    """
    return cast("Chosen", _run(scene, "best", shared, least=least, most=most, where=where,
                               sampler=sampler, runs=runs, seed=seed))


def sensitivity(
    scene: Study, *, method: str = "sobol", count: int = 64, seed: int = 0,
    **shared: Unpack[Shared],
) -> Sensitivity:
    """The influence of each path on each result (docs/searches.md).

    Args:
        scene: a scene.
        method: ``sobol`` (shares of the variance) or ``morris`` (screening).
        count: base points, a power of 2, or trajectories.
        seed: of the points.
        shared: ``vary`` (two or more paths) and others: see :class:`Shared`.

    Raises:
        SandboxError: too few runs have an answer; SALib is not installed.
    """
    return cast("Sensitivity", _run(scene, "sensitivity", shared, method=method, count=count,
                                    seed=seed))


def _run(scene: Study, kind: str, shared: Shared, **options: Any) -> Found:
    words: dict[str, Any] = dict(shared)
    out, workers, limits = (words.pop(name, None) for name in ("out", "workers", "limits"))
    session = Session(study_data(scene, **words), limits, kind, options)
    if "search" in session.source.data:
        raise RefusedError("the study already defines its search: use sandbox.search.study")
    return run_search(session, out, workers or 0)
