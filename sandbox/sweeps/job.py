"""The work of a sweep as plain data: the scene with its files, the results to keep, and rows.

Nothing here loads the engine. The rows of a directory are a line of JSON each, appended and never
rewritten, written at once when a run is finished: a process that is killed loses only the runs that
were under way. A line that was cut off is removed.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import IO, Any, Literal

from pydantic import TypeAdapter, ValidationError

from sandbox import __version__, errors
from sandbox.atomic_files import flush, locked, output_errors
from sandbox.scene.document import element_files, load_elements
from sandbox.scene.outlines.drawings import own_file
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded, read_scene
from sandbox.scene.settings import Looked

Status = Literal["", "done", "refused", "diverged", "limited", "failed", "died"]
"""How a run ended; empty for one that was not done yet, ``died`` if its worker processes died."""
DONE: Status = "done"
ENDED: dict[type[errors.SandboxError], Status] = {  # status of a run by the error that ended it
    errors.SceneError: "refused", errors.SimulationDiverged: "diverged",
    errors.RecordingFull: "limited", errors.ControllerFailed: "failed"}
STEP = "run.step"  # path of the time step, which searches halve to check their result
ROWS = Path("rows", "00000.jsonl")  # the rows in the directory of a sweep
Override = str | float | int | bool | list[Any] | dict[str, Any] | None  # as ``--set`` takes it
Point = Mapping[str, Override]  # the values of the varied paths in a run
Task = tuple[str, Point]  # id of a run, and the values of its paths


@dataclass(frozen=True)
class Bundle:
    """A scene file, or its data, with all files that it includes or draws from."""

    name: str  # name of the scene
    main: str = ""  # name of its file; empty for a scene given as data
    data: dict[str, Any] | None = None
    files: Mapping[str, bytes] = field(default_factory=dict)  # by name
    elements: Mapping[str, bytes] = field(default_factory=element_files)  # own ones, by path

    def register(self) -> None:
        """Register the elements of files in this process."""
        for path, source in self.elements.items():
            load_elements(Path(path), source)

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
    """The bundle of a scene with all files that later values may name, and the scene itself."""
    loaded = read_scene(scene, overrides=overrides, limits=limits)
    if isinstance(scene, Mapping):
        data = json.loads(json.dumps(dict(scene)))
        return Bundle(loaded.mechanism.name, data=data), loaded
    folder, later, paths = scene.parent, set(_texts(list(also))), [scene, *loaded.files]
    for path in [folder / f"{text}.json" for text in sorted(filter(str.isidentifier, later))]:
        if path.is_file():
            paths += [path, *read_scene(path, limits=limits).files]
    found = {str(path.relative_to(folder) if path.is_relative_to(folder) else path.name):
             path.read_bytes() for path in paths}
    for text in sorted(later.union(_texts([*map(json.loads, found.values()), overrides]))):
        if text.lower().endswith((".svg", ".dxf")) and (folder / text).is_file():
            found[text] = own_file(folder, text)
    return Bundle(loaded.mechanism.name, main=scene.name, files=found), loaded


def _texts(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, (Mapping, list, tuple)):
        for each in value.values() if isinstance(value, Mapping) else value:
            yield from _texts(each)


@dataclass(frozen=True)
class SweepJob:
    """All that a worker needs to run any point; plain data that can be sent anywhere."""

    bundle: Bundle
    set: Mapping[str, Any]  # changes of the scene in every run
    keep: Mapping[str, Looked | str]
    audited: bool = True
    recordings: str = ""  # directory for whole recordings, one in each run's id; empty for none
    limits: Limits = field(default_factory=Limits)

    @property
    def digest(self) -> str:
        """SHA-256 of all that a row depends on besides the values of its paths, hexadecimal."""
        bundle, keep = self.bundle, {
            name: each if isinstance(each, str) else each.model_dump(mode="json")
            for name, each in self.keep.items()}
        total = hashlib.sha256(json.dumps(bundle.data, sort_keys=True).encode())
        total.update(f"{bundle.name}\0{bundle.main}".encode())
        for files in (bundle.files, bundle.elements):
            for name in sorted(files):
                total.update(f"{name}\0{len(files[name])}\0".encode() + files[name])
        text = json.dumps([total.hexdigest(), dict(self.set), keep, self.audited, __version__],
                          sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()


def run_id(digest: str, values: Point) -> str:
    """Id of a run, 16 hexadecimal digits: of :attr:`SweepJob.digest` and its paths' values."""
    text = json.dumps([digest, dict(values)], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


@dataclass(frozen=True)
class SweepRow:
    """The outcome of one run."""

    id: str  # see :func:`run_id`
    status: Status
    reason: str = ""  # why the run ended early, or which results have no value; empty otherwise
    kept: Mapping[str, float | None] = field(default_factory=dict)  # None: no value
    holds: bool | None = None  # whether all expectations hold; None where it has none
    failed: tuple[str, ...] = ()  # quantities whose expectations do not hold
    looks: tuple[str, ...] | None = None  # audit figures with a warning; None: no audit

    @property
    def failure(self) -> str:
        """Why it has no answer."""
        return self.reason if self.status == DONE else f"{self.status}: {self.reason}"


class Log:
    """The rows of a directory, or a temporary one, as a context in which only it adds to them."""

    _line = TypeAdapter(SweepRow)

    def __init__(self, directory: Path | None) -> None:
        self._stack = contextlib.ExitStack()
        self.path = (directory or Path(self._stack.enter_context(
            tempfile.TemporaryDirectory(prefix="sandbox-rows-")))) / ROWS
        self._file: IO[bytes] | None = None

    def __enter__(self) -> Log:
        folder = self.path.parent
        with output_errors(folder):
            folder.mkdir(parents=True, exist_ok=True)
            (folder / ".lock").touch()
            if self._stack.enter_context(locked(folder / ".lock")) is False:
                raise errors.OutputError(f"{folder.parent}: another process writes to this "
                                         "directory", code="runs-in-use")
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def add(self, row: SweepRow) -> None:
        """Append a finished run."""
        with output_errors(self.path):
            if self._file is None:
                self._file = self._stack.enter_context(self.path.open("ab", buffering=0))
                # remove a line that was cut off
                self._file.truncate(self.path.read_bytes().rfind(b"\n") + 1)
                self._stack.callback(flush, self.path)
            self._file.write(json.dumps(asdict(row), allow_nan=False).encode() + b"\n")

    def rows(self) -> Iterator[SweepRow]:
        """The rows so far, in the order in which they were finished."""
        if not self.path.is_file():
            return
        with output_errors(self.path), self.path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if not line.endswith(b"\n"):
                    break  # being written, or cut off
                try:
                    yield self._line.validate_json(line)
                except ValidationError:
                    raise errors.OutputError(
                        f"{self.path}:{number}: this line is no row of a sweep; remove it, and its "
                        "run is repeated", code="run-damaged") from None
