"""The directory of a run: ``run.npz``, the CSV files, and ``run.json`` last.

``run.json`` means that everything else is there, so it is removed before
anything is written and put in place, whole, at the very end. A run that did
not come to its end leaves ``run.incomplete.json`` instead. Every file is
there whole or not at all (:mod:`sandbox.whole_files`).
"""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import IO, Any

from sandbox.audit.bounds import Bounds
from sandbox.audit.figures import Figure, figure_data
from sandbox.errors import OutputError
from sandbox.recording import archive, tables
from sandbox.samples.expectations import Verdict
from sandbox.samples.outcome import outcome_data
from sandbox.samples.samples import Samples
from sandbox.whole_files import plainly, remove, write_whole, written_whole

SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS, BOUNDS = (
    "run.json", "run.incomplete.json", "run.npz", "contacts.csv", "contact_bounds.csv")
FILES = (SUMMARY, INCOMPLETE, ARCHIVE, CONTACTS, BOUNDS, "tendons.csv", "joints.csv", "bodies.csv",
         "drives.csv", "springs.csv", "meters.csv")
"""Everything that is written here; what an earlier run left of it is removed first."""


def save(
    run: Samples, directory: Path, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None,
) -> None:
    """Write all files of a run into a directory, which is made if need be.

    Raises:
        OutputError: the directory or a file cannot be written.
    """
    save_data(run, directory)
    save_summary(run, directory, verdicts=verdicts, figures=figures, parameters=parameters)


def save_data(run: Samples, directory: Path) -> None:
    """Write everything but the summary, after removing what an earlier run left.

    Raises:
        OutputError: the directory or a file cannot be written.
    """
    with plainly(directory):
        directory.mkdir(parents=True, exist_ok=True)
    for name in FILES:
        remove(directory / name)
    _write(directory / ARCHIVE, partial(archive.write, run))
    _write(directory / CONTACTS, partial(_text, tables.contact_rows(run)))
    for kind in tables.written(run):
        _write(directory / f"{kind}.csv", partial(_text, tables.rows(run, kind)))


def save_summary(
    run: Samples, directory: Path, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None, wall_s: Mapping[str, float] | None = None,
) -> Path:
    """Write ``run.json`` (``run.incomplete.json``) last of all; returns its path.

    ``figures`` are those of the audit, none for a run without one; ``wall_s`` adds
    to the wall times that the recording knows.

    Raises:
        OutputError: it cannot be written.
    """
    path = directory / (SUMMARY if run.complete else INCOMPLETE)
    content = summary(run, verdicts=verdicts, figures=figures, parameters=parameters,
                      wall_s=wall_s)
    write_whole(path, json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")
    return path


def save_bounds(run: Samples, found: Mapping[int, Sequence[Bounds]], path: Path) -> None:
    """Write what contact forces could be in some samples, by their numbers, as a CSV file.

    Raises:
        OutputError: it cannot be written.
    """
    write_whole(path, "".join(tables.bound_rows(run, found)))


def summary(
    run: Samples, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None, wall_s: Mapping[str, float] | None = None,
) -> dict[str, Any]:
    """What ``run.json`` says, as plain JSON data (null stands for infinite and for no value)."""
    info, mechanism = outcome_data(run.info), run.mechanism
    content = {
        "format": archive.FORMAT,
        "complete": info["complete"],
        "reason": info["reason"],
        "name": mechanism.name,
        "title": mechanism.title,
        "parameters": dict(parameters or {}),
        "seed": info["seed"],
        "step_s": info["step"],
        "sample_rate_Hz": info["sample_rate"],
        "samples": len(run),
        "contact_rows": len(run.arrays["contact_gap"]),
        "versions": info["versions"],
        "platform": platform.platform(),
        "wall_s": {**info["wall_s"], **(wall_s or {})},
        "notes": run.notes,
        "events": info["events"],
        "stopped": info["stopped"],
        "controllers": info["controllers"],
        "expectations": [asdict(verdict) for verdict in verdicts],
        "audit": [figure_data(figure) for figure in figures],
        "scene": mechanism.model_dump(mode="json", by_alias=True),
    }
    plain: dict[str, Any] = _plain(content)
    return plain


def archive_of(directory: str | os.PathLike[str]) -> Path:
    """The archive in the directory of a run.

    Raises:
        OutputError: there is no such directory.
    """
    folder = Path(directory)
    if not folder.is_dir():
        raise OutputError(f"there is no directory {folder}")
    return folder / ARCHIVE


def _write(path: Path, content: Callable[[IO[bytes]], None]) -> None:
    with written_whole(path) as part, part.open("wb") as file:
        content(file)


def _text(pieces: Iterable[str], file: IO[bytes]) -> None:
    for piece in pieces:
        file.write(piece.encode())


def _plain(value: Any) -> Any:
    """JSON has no infinity and no nan."""
    if isinstance(value, Mapping):
        return {key: _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
