"""One run of a sweep: from values of paths to a row. What every worker does."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.audit.audit import audit
from sandbox.engine.inspect_control import Checked, control_problems
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SandboxError, SceneError
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import measured, verdicts, window
from sandbox.scene.elements.settings import Looked
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.values.expressions import parse_expression
from sandbox.sweeps.job import DONE, ENDED, Asked, ReadAt, SweepJob, SweepRow
from sandbox.sweeps.points import Override

MOST_REASON = 500
"""Characters of a reason that a row keeps."""


class Runner:
    """Runs points of one job, one after the other."""

    def __init__(self, job: SweepJob, scene: Path | Mapping[str, Any]) -> None:
        self._job, self._scene = job, scene

    def prepare(self) -> None:
        """Compile what the scene needs, so that other workers find it in the cache."""
        with suppress(Exception):  # each run reports what is wrong with its scene
            loaded = read_scene(self._scene, overrides=self._job.set, limits=self._job.limits)
            Simulation(_checked(loaded))

    def __call__(self, id: str, values: Mapping[str, Override]) -> SweepRow:
        """Run one point; whatever becomes of it is in its row."""
        try:
            loaded = read_scene(self._scene, overrides={**self._job.set, **values},
                                limits=self._job.limits)
            recording = simulate(_checked(loaded),
                                 recorded_bytes=self._job.limits.recorded_bytes)
        except tuple(ENDED) as error:
            status = next(status for kind, status in ENDED.items() if isinstance(error, kind))
            return SweepRow(id, status, reason=reason_of(error))
        if self._job.recordings:
            recording.save(Path(self._job.recordings, id), parameters=loaded.scene.parameters)
        return self._row(id, recording, loaded.scene.parameters)

    def _row(self, id: str, run: Recording, parameters: Mapping[str, float]) -> SweepRow:
        kept, lacking = keep_of(run, self._job.keep, parameters)
        judged = verdicts(run)
        looks = None
        if self._job.audited:
            looks = tuple(figure.name for figure in audit(run) if figure.verdict == "look")
        return SweepRow(
            id, DONE, reason="; ".join(lacking)[:MOST_REASON], kept=kept,
            holds=all(verdict.ok for verdict in judged) if judged else None,
            failed=tuple(dict.fromkeys(v.quantity for v in judged if not v.ok)), looks=looks)


def _checked(loaded: Loaded) -> Checked:
    """A scene that was just read needs no second look at its values, only one at its control."""
    if problems := control_problems(loaded.mechanism):
        raise SceneError(loaded.placed(problems), loaded.name)
    return Checked(loaded.mechanism)


def keep_of(
    run: Recording, keep: Mapping[str, Asked], parameters: Mapping[str, float],
) -> tuple[dict[str, float | None], list[str]]:
    """What is kept of a run, by name, and why some have no value."""
    found: dict[str, float | None] = {}
    lacking: list[str] = []
    curves: dict[str, Array] = {}
    for name, asked in keep.items():
        try:
            value, why = _expressed(asked, parameters, found) if isinstance(asked, str) else \
                _read(run, asked, curves)
        except (SandboxError, ArithmeticError, ValueError) as error:
            value, why = math.nan, str(error)
        found[name] = value if math.isfinite(value) else None
        if found[name] is None:
            lacking.append(f"{name}: {why or 'no finite value'}")
    return found, lacking


def _read(
    run: Recording, asked: Looked | ReadAt, curves: dict[str, Array],
) -> tuple[float, str]:
    if isinstance(asked, ReadAt):
        if asked.quantity not in curves:  # many instants of one quantity are asked for
            curves[asked.quantity] = run[asked.quantity]
        return _at(run.time, curves[asked.quantity], asked.time)
    chosen, unreached = window(run, asked)
    if unreached:
        return math.nan, unreached
    return measured(run, asked.quantity, asked, chosen)


def _at(time: Array, values: Array, instant: float) -> tuple[float, str]:
    """The value at an instant, nan if the run has none, and why."""
    beyond = time[1] - time[0] if len(time) > 1 else 0.0
    if not time[0] - beyond <= instant <= time[-1] + beyond:
        return math.nan, f"the run has no samples about {instant:g} s"
    place = int(np.clip(np.searchsorted(time, instant), 1, len(time) - 1))
    share = (instant - time[place - 1]) / (time[place] - time[place - 1])
    return float((1 - share) * values[place - 1] + share * values[place]), ""


def _expressed(
    text: str, parameters: Mapping[str, float], known: Mapping[str, float | None],
) -> tuple[float, str]:
    expression = parse_expression(text)
    if lacking := [name for name in expression.names if known.get(name, 0.0) is None]:
        return math.nan, f"{lacking[0]} has no value"
    values = {**parameters, **known}
    return float(expression.evaluate({name: values[name] for name in expression.names})), ""


def reason_of(error: SandboxError) -> str:
    """Why a run did not come to its end, on one line."""
    told = "; ".join(str(problem) for problem in error.problems) \
        if isinstance(error, SceneError) else str(error)
    return " ".join(told.split())[:MOST_REASON]


@contextmanager
def ready(job: SweepJob) -> Iterator[Runner]:
    """A runner with the job's files in a folder of their own, while the context lasts."""
    with job.bundle.unpacked() as scene:
        yield Runner(job, scene)
