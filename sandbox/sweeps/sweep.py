"""Run a sweep: what is not done yet, wherever it runs, and the table of all of it."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from sandbox.atomic_files import output_path
from sandbox.errors import Problem, SandboxError, SceneError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.paths import JsonPath, path_text
from sandbox.sweeps.crew import crew_of
from sandbox.sweeps.evaluator import Evaluator
from sandbox.sweeps.job import DONE, SweepJob
from sandbox.sweeps.log import Log
from sandbox.sweeps.plan import Plan, plan_of, read_plan
from sandbox.sweeps.table import SweepTable, table_of, write_spec
from sandbox.sweeps.words import kept_from, varied_from
from sandbox.wording import WrongValueError, quoted

RECORDINGS = "runs"
"""The directory of whole recordings in that of a sweep."""


@dataclass(frozen=True)
class Advance:
    """How far a sweep is."""

    total: int
    """Runs of the plan."""
    before: int
    """Runs that were done when it began."""
    done: int = 0
    """Runs since."""
    doubtful: int = 0
    """Of these, those that did not end well or ask for a look."""
    seconds: float = 0.0
    """Since it began."""

    @property
    def fraction(self) -> float:
        """Of what there was to do."""
        return self.done / max(self.total - self.before, 1)


Progress = Callable[[Advance], None]


def run_plan(
    plan: Plan, directory: Path | None, *, workers: int = 0, cluster: str = "",
    again: bool = False, progress: Progress | None = None,
) -> SweepTable:
    """Run what is not done yet of a plan, and write its table.

    Args:
        plan: the sweep.
        directory: where rows are kept and the table goes; None for nowhere.
        workers: processes at hand; as many as there are processors by default.
        cluster: address of a Dask scheduler, which is used in their place.
        again: do runs again that are done.
        progress: is told how far it is, run by run.

    Raises:
        OutputError: the directory cannot be written, or another process is at it.
        SandboxError: no workers, more than are begun, or a cluster that cannot be used.
        KeyboardInterrupt: Ctrl-C; all finished runs are kept, and the table has them.
    """
    crew_of(workers)  # refused before anything is written
    if directory is None:
        if plan.spec.recordings:
            raise SandboxError("whole recordings need a directory to go to: out=", code="bad-study")
        with tempfile.TemporaryDirectory(prefix="sandbox-sweep-") as folder:
            return _run(plan, Path(folder), workers, cluster, again, progress)
    return _run(plan, directory, workers, cluster, again, progress)


def _run(
    plan: Plan, directory: Path, workers: int, cluster: str, again: bool,
    progress: Progress | None,
) -> SweepTable:
    with Log(directory) as log:
        if again:
            log.clear()
        done = {row.id for row in log.rows() if not plan.spec.recordings or row.status != DONE
                or (directory / RECORDINGS / row.id).is_dir()}
        missing = {id: run for run, id in reversed(list(enumerate(plan.ids))) if id not in done}
        job = replace(plan.job, recordings=str((directory / RECORDINGS).resolve())
                      if plan.spec.recordings else "")
        ended = "interrupted"
        try:
            if missing:
                _work(plan, job, missing, log, {"workers": workers, "cluster": cluster}, progress)
            ended = "done"
        finally:
            table = table_of(plan, log.rows())
            table.write(directory)
            write_spec(plan, directory, {"ended": ended, "done": table.count, "runs": len(plan)})
    return table


def _work(
    plan: Plan, job: SweepJob, missing: Mapping[str, int], log: Log, crew: Mapping[str, Any],
    progress: Progress | None,
) -> None:
    """Run what is missing: the first run of each id."""
    began, total = time.perf_counter(), len(set(plan.ids))
    at = Advance(total, total - len(missing))
    with Evaluator(job, log, most=len(missing), **crew) as evaluator:
        for row in evaluator.run((plan.ids[run], plan.points[run])
                                 for run in sorted(missing.values())):
            at = replace(at, done=at.done + 1, doubtful=at.doubtful + row.doubtful,
                         seconds=time.perf_counter() - began)
            if progress:
                progress(at)


def sweep(
    scene: str | os.PathLike[str] | Mapping[str, Any], *,
    vary: Mapping[str, Any] | list[Mapping[str, Any]] | None = None,
    keep: Mapping[str, Any] | list[str] | None = None,
    set: Mapping[str, Any] | None = None,
    design: str | None = None, count: int | None = None, seed: int = 0,
    audit: bool = True, recordings: bool = False,
    out: str | os.PathLike[str] | None = None, workers: int = 0, cluster: str = "",
    again: bool = False, limits: Limits | None = None, progress: Progress | None = None,
) -> SweepTable:
    """Run a scene many times with values of its paths varied; the table of what came of it.

    The words are those of a study file (docs/sweeps.md).

    Args:
        scene: a file, the name of a shipped scene, or a mapping of what a file holds. With
            ``vary`` left out, a study file.
        vary: values by path: lists, texts such as ``"2 N:8 N:7"`` and ``"normal(3 N, 0.2 N)"``,
            or mappings as in a study file; or a list of groups.
        keep: what is kept, by name or as texts such as ``"max tip.x over last 0.2 s"``; by
            default what the scene's expectations look at.
        set: what else is changed, in all runs.
        design: how points lie: ``grid``, ``paired``, ``latin_hypercube``, ``sobol``, ``halton``,
            ``random``.
        count: how many points, of designs that choose them.
        seed: of random points.
        audit: audit each run.
        recordings: keep the whole recording of each run.
        out: a directory; runs that are done in it are not done again. Nowhere by default.
        workers: processes; as many as there are processors by default.
        cluster: address of a Dask scheduler to be used in their place.
        again: do runs again that are done.
        limits: how large scenes and the sweep may be.
        progress: is told how far it is, run by run.

    Raises:
        SceneError: every problem of the scene or of the study.
        OutputError: the directory cannot be written.
        SandboxError: a cluster that cannot be used; what needs a package that is not installed.
    """
    directory = None if out is None else output_path(out, "a sweep")
    if vary is None and not isinstance(scene, Mapping):
        plan = read_plan(scene, limits)
    else:
        plan = plan_of(study_data(
            scene, vary=vary, keep=keep, set=set, design=design, count=count, seed=seed,
            audit=audit, recordings=recordings), limits)
    return run_plan(plan, directory, workers=workers, cluster=cluster, again=again,
                    progress=progress)


def study_data(
    scene: str | os.PathLike[str] | Mapping[str, Any], *, vary: Any, keep: Any = None,
    set: Any = None, design: str | None = None, count: int | None = None, **settings: Any,
) -> dict[str, Any]:
    """What a study file would hold, from words and values.

    Raises:
        SceneError: words that say nothing that can be varied or kept.
    """
    problems: list[Problem] = []

    def read(path: JsonPath, value: Any, reader: Callable[[str], Any]) -> Any:
        try:
            return reader(value) if isinstance(value, str) else value
        except WrongValueError as error:
            problems.append(Problem.of(error, path_text(path)))
            return None

    def group(values: Mapping[str, Any]) -> dict[str, Any]:
        return {path: read(("vary", path), value, varied_from) for path, value in values.items()}

    if isinstance(vary, Mapping):
        groups: Any = [{"over": group(vary), "design": design, "count": count}]
    else:
        groups = [{**each, "over": group(each["over"])} if isinstance(each, Mapping)
                  and isinstance(each.get("over"), Mapping) else each for each in vary or ()]
    named = {} if keep is None else dict(keep) if isinstance(keep, Mapping) else \
        dict(read(("keep", text), text, kept_from) or ("", "") for text in keep)
    if keep is not None and not problems and len(named) < len(keep):
        names = [kept_from(text)[0] for text in keep]
        problems += [Problem("duplicate-name",
                             f"two results have the name {quoted(name)}", "$.keep",
                             allowed="another name for each") for name in named
                     if names.count(name) > 1]
    if problems:
        raise SceneError(problems)
    where = scene if isinstance(scene, Mapping) else os.fspath(scene)
    return {"scene": where, "set": dict(set or {}), "vary": groups, "keep": named, **settings}
