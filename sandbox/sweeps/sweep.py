"""Runs a sweep: the runs that are missing in its directory, and the table of all of them."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sandbox.atomic_files import output_path
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.sweeps.job import DONE, Log
from sandbox.sweeps.plan import Plan, Study, plan_of
from sandbox.sweeps.processes import check_workers
from sandbox.sweeps.table import SweepTable, make_table, write_spec
from sandbox.sweeps.workers import make_workers
from sandbox.values.paths import path_text
from sandbox.wording import quoted

RECORDINGS = "runs"  # folder of whole recordings
EXAMPLES = '"max finger.tip.x over last 0.2 s", "tip=max finger.tip.x", "ratio==tip / pull"'


@dataclass(frozen=True)
class Advance:
    """Progress of a sweep."""

    total: int  # different runs of the plan
    before: int  # runs that were finished before it began
    done: int = 0  # runs finished since
    doubtful: int = 0  # of these, runs that ended early or have warnings
    seconds: float = 0.0  # since it began


Progress = Callable[[Advance], None]


def run_plan(
    plan: Plan, directory: Path | None, *, workers: int | str = 0, again: bool = False,
    progress: Progress = lambda at: None,
) -> SweepTable:
    """Run the missing runs of a plan, and write its table; arguments as of :func:`sweep`.

    After Ctrl-C all finished runs are in the directory and its table.
    """
    workers = check_workers(workers)  # before anything is written
    job, recordings = plan.job, None
    if plan.spec.recordings:
        if directory is None:
            raise SandboxError("whole recordings need a directory to go to: out=", code="bad-study")
        recordings = (directory / RECORDINGS).resolve()
        job = replace(job, recordings=str(recordings))
    with Log(directory) as log:
        if again:
            log.path.unlink(missing_ok=True)
        done = {row.id for row in log.rows() if recordings is None or row.status != DONE
                or (recordings / row.id).is_dir()}
        runs = dict(zip(plan.ids, plan.points, strict=True))
        missing = {id: point for id, point in runs.items() if id not in done}
        if isinstance(workers, int):  # no more processes than runs
            workers = min(workers, len(missing))
        began, at = time.perf_counter(), Advance(len(runs), len(runs) - len(missing))
        ended = "interrupted"
        try:
            with ExitStack() as stack:
                for row in make_workers(job, workers, stack).results(missing.items()) \
                        if missing else ():
                    log.add(row)
                    at = replace(at, done=at.done + 1, seconds=time.perf_counter() - began,
                                 doubtful=at.doubtful + (row.status != DONE or bool(row.looks)))
                    progress(at)
            ended = "done"
        finally:
            table = make_table(plan, log.rows())
            if directory:
                table.write(directory)
                write_spec(plan, directory, ended=ended, done=table.count, runs=len(plan))
    return table


def sweep(
    scene: Study, *,
    vary: Mapping[str, Any] | list[Mapping[str, Any]] | None = None,
    keep: Mapping[str, Any] | list[str] | None = None,
    set: Mapping[str, Any] | None = None,
    design: str | None = None, count: int | None = None, seed: int = 0,
    audit: bool = True, recordings: bool = False,
    out: str | os.PathLike[str] | None = None, workers: int | str = 0, again: bool = False,
    limits: Limits | None = None, progress: Progress = lambda at: None,
) -> SweepTable:
    """Run a scene many times with values of its paths varied; the table of results.

    Arguments have the format of study files (docs/sweeps.md).

    Args:
        scene: a file, the name of a shipped scene, or the data of a scene. Without ``vary``, a
            study file.
        vary: values by path: lists, texts such as ``"2 N:8 N:7"`` and ``"normal(3 N, 0.2 N)"``,
            or mappings as in a study file; or a list of groups.
        keep: results, by name or as texts such as ``"max tip.x over last 0.2 s"``; by default
            those of the scene's expectations.
        set: further changes of the scene, in all runs.
        design: arrangement of the points: ``grid``, ``paired``, ``latin_hypercube``, ``sobol``,
            ``halton``, ``random``.
        count: number of points, of designs that choose them.
        seed: of random points.
        audit: audit each run.
        recordings: keep the whole recording of each run.
        out: a directory; runs that are finished in it are not repeated. Nowhere by default.
        workers: number of processes, by default one for each processor; or the address of a Dask
            scheduler, ``tcp://10.0.0.1:8786``.
        again: repeat finished runs.
        limits: of the scene and the number of runs.
        progress: called after each run.

    Raises:
        SceneError: every problem of the scene or the study.
        OutputError: the directory cannot be written.
        SandboxError: workers cannot start, or the cluster cannot be used.
    """
    directory = None if out is None else output_path(out, "a sweep")
    study = study_data(scene, vary=vary, keep=keep, set=set, design=design, count=count, seed=seed,
                       audit=audit, recordings=recordings)
    return run_plan(plan_of(study, limits), directory, workers=workers, again=again,
                    progress=progress)


def study_data(
    scene: Study, *, vary: Any = None, keep: Any = None,
    set: Any = None, design: str | None = None, count: int | None = None, **settings: Any,
) -> Study:
    """The study of the arguments of :func:`sweep`: its data, or a file where nothing is varied."""
    if vary is None and not isinstance(scene, Mapping):
        return scene
    groups = [{"over": dict(vary), "design": design, "count": count}] \
        if isinstance(vary, Mapping) else list(vary or ())
    named, problems = dict(keep) if isinstance(keep, Mapping) else {}, []
    for text in () if isinstance(keep, Mapping) else keep or ():
        name, equals, definition = (part.strip() for part in text.partition("="))
        if not equals:
            name = definition = text.strip()
        if not name or not definition:
            problems.append(Problem(
                "bad-study", f"{quoted(text)} names no {'quantity to keep' if name else 'result'}",
                path_text(("keep", text)), allowed=EXAMPLES))
        elif name in named:
            problems.append(Problem("duplicate-name",
                                    f"two results have the name {quoted(name)}", "$.keep",
                                    allowed="another name for each"))
        named[name] = definition
    if problems:
        raise SceneError(problems)
    where = scene if isinstance(scene, Mapping) else os.fspath(scene)
    return {"scene": where, "set": dict(set or {}), "vary": groups, "keep": named, **settings}
