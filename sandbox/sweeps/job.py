"""The work of a sweep as plain data: the scene with its files, the results to keep, and rows.

Nothing here loads the engine.
"""

from __future__ import annotations

import hashlib
import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from sandbox import __version__
from sandbox.errors import (
    ControllerFailed,
    RecordingFull,
    SandboxError,
    SceneError,
    SimulationDiverged,
)
from sandbox.scene.document import element_files
from sandbox.scene.outlines.drawings import own_file
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.settings import Looked
from sandbox.values.spec import Spec

DONE, DIED = "done", "died"
"""Status of a run that reached its end, and of one whose worker processes died."""
ENDED: dict[type[SandboxError], str] = {
    SceneError: "refused", SimulationDiverged: "diverged", RecordingFull: "limited",
    ControllerFailed: "failed"}
"""Status of a run by the error that ended it."""
STATUSES = (DONE, *ENDED.values(), DIED)
STEP = "run.step"
"""Path of the time step, which searches halve to check their result."""
DRAWINGS = (".svg", ".dxf")
Override = str | float | int | bool | list[Any] | dict[str, Any] | None
"""A value as ``--set`` takes it."""
Task = tuple[str, Mapping[str, Override]]
"""Id of a run, and the values of its paths."""


@dataclass(frozen=True)
class Bundle:
    """A scene file, or its data, with all files that it includes or draws from."""

    name: str
    """Name of the scene."""
    main: str = ""
    """Name of its file; empty for a scene given as data."""
    data: dict[str, Any] | None = None
    files: Mapping[str, bytes] = field(default_factory=dict, repr=False)
    """By name, relative to the folder of the scene."""
    elements: Mapping[str, bytes] = field(default_factory=element_files, repr=False)
    """Files that register elements, by path."""

    @property
    def digest(self) -> str:
        """SHA-256 of the contents, hexadecimal."""
        total = hashlib.sha256(json.dumps(self.data, sort_keys=True).encode())
        total.update(f"{self.name}\0{self.main}".encode())
        for files in (self.files, self.elements):
            for name in sorted(files):
                total.update(f"{name}\0{len(files[name])}\0".encode() + files[name])
        return total.hexdigest()

    @contextmanager
    def unpacked(self) -> Iterator[Path | dict[str, Any]]:
        """The scene for :func:`read_scene`, in a temporary folder."""
        if self.data is not None:
            yield self.data
            return
        with tempfile.TemporaryDirectory(prefix="sandbox-sweep-") as folder:
            for name, content in self.files.items():
                path = Path(folder, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_bytes(content)
            yield Path(folder, self.main)


def make_bundle(
    scene: Path | Mapping[str, Any], overrides: Mapping[str, Any], limits: Limits, *,
    also: Iterable[Any] = (),
) -> tuple[Bundle, Loaded]:
    """The bundle of a scene, and the scene with ``overrides``.

    Args:
        scene: its file, or its data.
        overrides: changes of the scene.
        limits: of the scene.
        also: later values of its paths, which may name further files beside it.

    Raises:
        SceneError: every problem of the scene.
    """
    also = list(also)
    loaded = read_scene(scene, overrides=overrides, limits=limits)
    if isinstance(scene, Mapping):
        data = json.loads(json.dumps(dict(scene)))
        return Bundle(loaded.mechanism.name, data=data), loaded
    found = {scene.name: scene.read_bytes()}
    for path in [*loaded.files, *_named_scenes(scene.parent, also, limits)]:
        name = path.relative_to(scene.parent) if path.is_relative_to(scene.parent) else path.name
        found[str(name)] = path.read_bytes()
    written = [*map(json.loads, found.values()), overrides, also]
    for text in {text for each in written for text in _texts(each)}:
        if text.lower().endswith(DRAWINGS) and (scene.parent / text).is_file():
            found[text] = own_file(scene.parent, text)
    return Bundle(loaded.mechanism.name, main=scene.name, files=found), loaded


def _named_scenes(folder: Path, values: Iterable[Any], limits: Limits) -> Iterator[Path]:
    """Scene files that values name, and those that they include."""
    for text in sorted({text for text in _texts(list(values)) if text.isidentifier()}):
        path = folder / f"{text}.json"
        if path.is_file():
            yield path
            yield from read_scene(path, limits=limits).files


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (Mapping, list, tuple)):
        for each in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(each)


class ReadAt(Spec):
    """A quantity at an instant, interpolated linearly between samples.

    Poses belong to the middle of a step, so that a run has no sample at its very ends: up to one
    sample beyond them, values are extrapolated.
    """

    quantity: str
    time: float
    """[s]."""


Keep = Looked | ReadAt | str
"""A result: a statistic, a quantity at an instant, or an expression of earlier results."""


@dataclass(frozen=True)
class SweepJob:
    """All that a worker needs to run any point; plain data that can be sent anywhere."""

    bundle: Bundle
    set: Mapping[str, Any]
    """Changes of the scene in every run."""
    keep: Mapping[str, Keep]
    audited: bool = True
    recordings: str = ""
    """Directory for whole recordings, one in each run's id; empty for none."""
    limits: Limits = field(default_factory=Limits)

    @property
    def digest(self) -> str:
        """SHA-256 of all that a row depends on besides the values of its paths, hexadecimal."""
        keep = {name: each if isinstance(each, str) else each.model_dump(mode="json")
                for name, each in self.keep.items()}
        text = json.dumps([self.bundle.digest, dict(self.set), keep, self.audited, __version__],
                          sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def run_id(digest: str, values: Mapping[str, Override]) -> str:
    """Id of a run, 16 hexadecimal digits: of :attr:`SweepJob.digest` and its paths' values."""
    text = json.dumps([digest, dict(values)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class SweepRow:
    """The outcome of one run."""

    id: str
    """See :func:`run_id`."""
    status: str
    """One of :data:`STATUSES`."""
    reason: str = ""
    """Why the run ended early, or which results have no value; empty otherwise."""
    kept: Mapping[str, float | None] = field(default_factory=dict)
    """Results by name; None for one without a value."""
    holds: bool | None = None
    """Whether all expectations of the scene hold; None where it has none, or did not end."""
    failed: tuple[str, ...] = ()
    """Quantities whose expectations do not hold."""
    looks: tuple[str, ...] | None = None
    """Audit figures with a warning; None where the run was not audited."""

    @property
    def doubtful(self) -> bool:
        """Whether it ended early, or its audit has warnings."""
        return self.status != DONE or bool(self.looks)

    def to_json(self) -> bytes:
        """A line of JSON."""
        return json.dumps(asdict(self), allow_nan=False).encode() + b"\n"

    @classmethod
    def from_json(cls, line: bytes) -> SweepRow:
        """The row of a line of JSON.

        Raises:
            KeyError, TypeError, ValueError, AttributeError: the line is no row.
        """
        data = json.loads(line)
        looks = data["looks"]
        if data["status"] not in STATUSES:
            raise ValueError(data["status"])
        return cls(str(data["id"]), data["status"], str(data["reason"]), {
            str(name): None if value is None else float(value)
            for name, value in data["kept"].items()}, data["holds"],
            tuple(map(str, data["failed"])), None if looks is None else tuple(map(str, looks)))
