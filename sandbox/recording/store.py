"""The directory of a run: ``run.npz``, the CSV files, and ``run.json`` last.

``run.json`` means that everything else is there, so it is removed before
anything is written and put in place, whole, at the very end. A run that did
not come to its end leaves ``run.incomplete.json`` instead. Every file is
written beside its place and moved there when it is finished; a disk that
fills leaves no half-written file.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import IO, Any

from sandbox.errors import OutputError
from sandbox.recording import archive, tables
from sandbox.recording.audit import Figure, audit, figure_data
from sandbox.recording.expectations import Verdict, verdicts
from sandbox.recording.recording import Recording

SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS = (
    "run.json", "run.incomplete.json", "run.npz", "contacts.csv")
FILES = (SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS, "tendons.csv", "joints.csv", "bodies.csv",
         "drives.csv", "springs.csv", "meters.csv")
"""Everything that is written here; what an earlier run left of it is removed first."""
PART = ".part"


def save(
    run: Recording, directory: str | os.PathLike[str], *,
    parameters: Mapping[str, float] | None = None, judged: list[Verdict] | None = None,
) -> Path:
    """Write all files of a run and return its directory, which is made if need be.

    Raises:
        OutputError: the directory or a file cannot be written.
    """
    folder = save_data(run, directory)
    save_summary(run, folder, parameters=parameters, judged=judged)
    return folder


def save_data(run: Recording, directory: str | os.PathLike[str]) -> Path:
    """Write everything but the summary, after removing what an earlier run left.

    Raises:
        OutputError: the directory or a file cannot be written.
    """
    folder = Path(directory)
    with _plainly(folder):
        folder.mkdir(parents=True, exist_ok=True)
        for name in FILES:
            (folder / name).unlink(missing_ok=True)
            (folder / (name + PART)).unlink(missing_ok=True)
    _write(folder / ARCHIVE, partial(archive.write, run))
    _write(folder / CONTACTS, partial(_text, tables.contact_rows(run)))
    for kind in tables.written(run):
        _write(folder / f"{kind}.csv", partial(_text, tables.rows(run, kind)))
    return folder


def save_summary(
    run: Recording, directory: str | os.PathLike[str], *,
    parameters: Mapping[str, float] | None = None, judged: list[Verdict] | None = None,
    wall_s: Mapping[str, float] | None = None, audited: list[Figure] | None = None,
) -> Path:
    """Write ``run.json`` (``run.incomplete.json``) last of all; returns its path.

    ``judged`` are the verdicts, worked out here by default; ``wall_s`` adds
    to the wall times that the recording knows; ``audited`` are the figures of the
    audit, made here by default and empty for a run without one.

    Raises:
        OutputError: it cannot be written.
    """
    path = Path(directory) / (SUMMARY if run.complete else INCOMPLETE)
    content = summary(run, parameters=parameters, judged=judged, wall_s=wall_s, audited=audited)
    text = json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n"
    _write(path, partial(_text, [text]))
    return path


def summary(
    run: Recording, *, parameters: Mapping[str, float] | None = None,
    judged: list[Verdict] | None = None, wall_s: Mapping[str, float] | None = None,
    audited: list[Figure] | None = None,
) -> dict[str, Any]:
    """What ``run.json`` says, as plain JSON data (null stands for infinite and for no value)."""
    info, mechanism = run.info, run.mechanism
    judged = verdicts(run) if judged is None else judged
    audited = audit(run) if audited is None else audited
    content = {
        "format": archive.FORMAT,
        "complete": run.complete,
        "reason": info.get("reason", ""),
        "name": mechanism.name,
        "title": mechanism.title,
        "parameters": dict(parameters or {}),
        "seed": info.get("seed", 0),
        "step_s": info.get("step", mechanism.run.step),
        "iterations": info.get("iterations", mechanism.run.iterations),
        "sample_rate_Hz": info.get("sample_rate", mechanism.run.sample_rate),
        "samples": len(run),
        "contact_rows": len(run.arrays["contact_gap"]),
        "versions": info.get("versions", {}),
        "platform": info.get("platform", platform.platform()),
        "wall_s": {**info.get("wall_s", {}), **(wall_s or {})},
        "notes": run.notes,
        "events": info.get("events", []),
        "stopped": info.get("stopped"),
        "controllers": info.get("controllers", {}),
        "expectations": [asdict(verdict) for verdict in judged],
        "audit": [figure_data(figure) for figure in audited],
        "scene": mechanism.model_dump(mode="json", by_alias=True),
    }
    plain: dict[str, Any] = _plain(content)
    return plain


def load(directory: str | os.PathLike[str]) -> Recording:
    """The recording saved in a directory.

    Raises:
        OutputError: there is none, or it cannot be read.
    """
    folder = Path(directory)
    if not folder.is_dir():
        raise OutputError(f"there is no directory {folder}")
    return archive.read(folder / ARCHIVE)


def _write(path: Path, content: Callable[[IO[bytes]], None]) -> None:
    """Write a file beside its place, then move it there; nothing half-written stays."""
    beside = path.with_name(path.name + PART)
    with _plainly(path):
        try:
            with beside.open("wb") as file:
                content(file)
            beside.replace(path)
        except BaseException:
            with contextlib.suppress(OSError):
                beside.unlink(missing_ok=True)
            raise


def _text(pieces: Iterable[str], file: IO[bytes]) -> None:
    for piece in pieces:
        file.write(piece.encode())


@contextlib.contextmanager
def _plainly(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise OutputError(f"cannot write {path}: {error.strerror or error}") from None


def _plain(value: Any) -> Any:
    """JSON has no infinity and no nan."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
