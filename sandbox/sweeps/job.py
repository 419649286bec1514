"""One run of a sweep: from values of paths to a row. What every worker does."""

from __future__ import annotations

import hashlib
import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.errors import (
    ControllerFailed,
    RecordingFull,
    SandboxError,
    SceneError,
    SimulationDiverged,
)
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.expectations import measured, verdicts, window
from sandbox.scene.elements.settings import Looked
from sandbox.scene.elements.spec import Spec
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import read_scene
from sandbox.scene.values.expressions import parse_expression
from sandbox.sweeps.bundle import Bundle
from sandbox.sweeps.points import Override

DONE = "done"
"""The status of a run that came to its end."""
ENDED: dict[type[SandboxError], str] = {
    SceneError: "refused", SimulationDiverged: "diverged", RecordingFull: "limited",
    ControllerFailed: "failed"}
"""The status of a run that did not, by what ended it."""
DIED = "died"
"""The status of a run that took its worker with it, twice."""
STATUSES = (DONE, *ENDED.values(), DIED)
MOST_REASON = 500
"""Characters of a reason that a row keeps."""


@dataclass(frozen=True)
class SweepRow:
    """What became of one run."""

    id: str
    """See :meth:`SweepJob.id`."""
    status: str
    """One of :data:`STATUSES`."""
    reason: str = ""
    """Why it did not come to its end, and what has no value; empty where all is well."""
    kept: Mapping[str, float | None] = field(default_factory=dict)
    """By name; None for what has no value."""
    holds: bool | None = None
    """Whether all expectations of the scene hold; None where it has none, or was not run."""
    failed: tuple[str, ...] = ()
    """Those that do not hold, by quantity."""
    looks: tuple[str, ...] | None = None
    """Figures of the audit that ask for a look; None where it was not audited."""

    @property
    def doubtful(self) -> bool:
        """Whether it did not end well, or its audit asks for a look."""
        return self.status != DONE or bool(self.looks)


def row_data(row: SweepRow) -> dict[str, Any]:
    """A row as plain JSON data."""
    return asdict(row)


def read_row(data: Mapping[str, Any]) -> SweepRow:
    """The row that plain JSON data describe.

    Raises:
        KeyError, TypeError, ValueError: they describe none.
    """
    looks = data["looks"]
    row = SweepRow(id=str(data["id"]), status=str(data["status"]), reason=str(data["reason"]),
              kept={str(name): None if value is None else float(value)
                    for name, value in data["kept"].items()},
              holds=data["holds"], failed=tuple(map(str, data["failed"])),
              looks=None if looks is None else tuple(map(str, looks)))
    if row.status not in STATUSES:
        raise ValueError(row.status)
    return row


class ReadAt(Spec):
    """A quantity at one instant, between samples on the straight line of the two about it.

    Poses belong to the middle of a step, so that a run has no sample at its very ends: up to one
    sample beyond them the line goes on.
    """

    quantity: str
    time: float
    """[s]."""


Asked = Looked | ReadAt | str
"""What is kept: a statistic, a quantity at an instant, an expression of those before it."""


@dataclass(frozen=True)
class SweepJob:
    """All that a worker has to know of a sweep; plain data that can be sent anywhere."""

    bundle: Bundle
    set: Mapping[str, Any]
    """What is changed in the scene in every run."""
    keep: Mapping[str, Asked]
    audited: bool = True
    recordings: str = ""
    """The directory in which whole recordings are kept, each in one of its id; empty for none."""
    limits: Limits = field(default_factory=Limits)

    @property
    def digest(self) -> str:
        """SHA-256 of all that a row hangs on but its own values: hexadecimal digits."""
        keep = {name: each if isinstance(each, str) else each.model_dump(mode="json")
                for name, each in self.keep.items()}
        text = json.dumps([self.bundle.digest, dict(self.set), keep, self.audited, __version__],
                          sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def run_id(digest: str, values: Mapping[str, Override]) -> str:
    """The id of a run, 16 hexadecimal digits: of :attr:`SweepJob.digest` and its paths' values."""
    text = json.dumps([digest, dict(values)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class Runner:
    """Runs points of one job, one after the other."""

    def __init__(self, job: SweepJob, scene: Path | Mapping[str, Any]) -> None:
        self._job, self._scene = job, scene

    def __call__(self, id: str, values: Mapping[str, Override]) -> SweepRow:
        """Run one point; whatever becomes of it is in its row."""
        try:
            loaded = read_scene(self._scene, overrides={**self._job.set, **values},
                                limits=self._job.limits)
            recording = simulate(loaded.mechanism, recorded_bytes=self._job.limits.recorded_bytes)
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
    return measured(run, asked.quantity, asked.statistic, chosen)


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
