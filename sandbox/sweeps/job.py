"""What a worker is given and what it gives back: a job, and a row for each run of it.

Nothing here loads the engine: whoever hands out work does none of it.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from sandbox import __version__
from sandbox.errors import (
    ControllerFailed,
    RecordingFull,
    SandboxError,
    SceneError,
    SimulationDiverged,
)
from sandbox.scene.elements.settings import Looked
from sandbox.scene.elements.spec import Spec
from sandbox.scene.read.limits import Limits
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
STEP = "run.step"
"""The path of a scene's step, which is halved to see whether what was found hangs on it."""


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


Task = tuple[str, Mapping[str, Override]]
"""The id of a run, and what its paths are set to."""
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
