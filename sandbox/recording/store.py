"""The files of a run: ``run.npz``, the CSV files, and ``run.json`` last.

``run.json`` means that everything else is there. A run that did not come to its end has
``run.incomplete.json`` instead. How they get into the directory of a run, and what becomes
of an earlier one there: :mod:`sandbox.recording.new_run`.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path
from typing import IO, Any

from sandbox.atomic_files import atomic_file, write_atomic
from sandbox.audit.bounds import Bounds
from sandbox.audit.figures import Figure, figure_data
from sandbox.elements.arrays import Arrays
from sandbox.errors import OutputError
from sandbox.recording import archive, reading, tables
from sandbox.recording.new_run import ARCHIVE, CONTACTS, IMPACTS, INCOMPLETE, SUMMARY, writing
from sandbox.samples.expectations import Verdict
from sandbox.samples.outcome import Outcome, Status, outcome_data
from sandbox.samples.samples import Samples
from sandbox.scene.mechanism import Mechanism

RUN_ID = re.compile(rb'"run_id": "([0-9a-f]{32})"')
EDITED = ("was changed: it does not name its run, and its checks are ignored")
"""What a run notes of a summary that was changed or cut off."""
HEAD = 1024
"""Bytes of a summary in which its id stands."""
MOST_SUMMARY, MOST_WORDS = 64_000_000, 2000
"""Bytes of a summary that is read as a whole, and letters of a text in it."""


def save(
    run: Samples, directory: Path, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None,
) -> None:
    """Write all files of a run into a directory, which is made if need be.

    An earlier run there stays whole until all of this one is on the disk.

    Raises:
        OutputError: the directory or a file cannot be written, or another run is being
            written there.
    """
    with writing(directory) as new:
        save_data(run, new.aside)
        save_summary(run, new.aside, verdicts=verdicts, figures=figures, parameters=parameters)
        new.publish()


def save_data(run: Samples, directory: Path) -> None:
    """Write everything but the summary into a directory that holds no run.

    Raises:
        OutputError: the directory or a file cannot be written.
    """
    _write(directory / ARCHIVE, partial(archive.write, run))
    _write(directory / CONTACTS, partial(_text, tables.contact_rows(run)))
    if len(run.arrays["impact_time"]):
        _write(directory / IMPACTS, partial(_text, tables.impact_rows(run)))
    for kind in tables.written(run):
        _write(directory / f"{kind}.csv", partial(_text, tables.rows(run, kind)))


def save_summary(
    run: Samples, directory: Path, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None, derived: Sequence[str] = (),
    wall_s: Mapping[str, float] | None = None,
) -> Path:
    """Write ``run.json`` (``run.incomplete.json``) last of all; returns its path.

    ``figures`` are those of the audit, none for a run without one; ``derived`` are the parameters
    that follow from others; ``wall_s`` adds to the wall times that the recording knows.

    Raises:
        OutputError: it cannot be written.
    """
    path = directory / (SUMMARY if run.complete else INCOMPLETE)
    content = summary(run, verdicts=verdicts, figures=figures, parameters=parameters,
                      derived=derived, wall_s=wall_s, run_id=archive.read_id(directory / ARCHIVE))
    write_atomic(path, json.dumps(content, indent=2, allow_nan=False, ensure_ascii=False) + "\n")
    return path


def save_bounds(run: Samples, found: Mapping[int, Sequence[Bounds]], path: Path) -> None:
    """Write what contact forces could be in some samples, by their numbers, as a CSV file.

    Raises:
        OutputError: it cannot be written.
    """
    write_atomic(path, "".join(tables.bound_rows(run, found)))


def summary(
    run: Samples, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None, derived: Sequence[str] = (),
    wall_s: Mapping[str, float] | None = None, run_id: str = "",
) -> dict[str, Any]:
    """What ``run.json`` says, as plain JSON data (null stands for infinite and for no value)."""
    info, mechanism = outcome_data(run.info), run.mechanism
    content = {
        "format": reading.FORMAT,
        "run_id": run_id,
        "complete": info["complete"],
        "reason": info["reason"],
        "name": mechanism.name,
        "title": mechanism.title,
        "parameters": dict(parameters or {}),
        "derived": list(derived),
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
        "broke": info["broke"],
        "stopped": info["stopped"],
        "controllers": info["controllers"],
        "contact_solver": info["contact_solver"],
        "expectations": [asdict(verdict) for verdict in verdicts],
        "audit": [figure_data(figure) for figure in figures],
        "scene": mechanism.model_dump(mode="json", by_alias=True),
    }
    plain: dict[str, Any] = _plain(content)
    return plain


def load(directory: str | os.PathLike[str]) -> tuple[Mechanism, Arrays, Outcome]:
    """What the files of a run say: its mechanism, its arrays, its outcome.

    A run without ``run.json`` is not complete, whatever its archive says.

    Raises:
        OutputError: there is none, it cannot be read, or its files are of two runs.
    """
    folder = Path(directory)
    if not folder.is_dir():
        raise OutputError(f"there is no directory {folder}", code="no-run")
    mechanism, arrays, outcome, run_id = reading.read(folder / ARCHIVE)
    complete = (folder / SUMMARY).exists()
    summary = SUMMARY if complete else INCOMPLETE
    said = _said_id(folder / summary) if (folder / summary).exists() else ""
    if said and said != run_id:
        raise OutputError(f"{folder} is damaged: {summary} and {ARCHIVE} are of different runs",
                          code="run-damaged")
    if run_id and not said and (folder / summary).exists():
        outcome = replace(outcome, notes=(*outcome.notes, f"{summary} {EDITED}"))
    if not complete and outcome.complete:
        outcome = unfinished(outcome)
    return mechanism, arrays, outcome


def unfinished(outcome: Outcome) -> Outcome:
    """The outcome of a run of which not all files came to their place."""
    note = f"{SUMMARY} is missing: the run was stopped before all of its files were in place"
    return replace(outcome, status=Status.UNFINISHED, notes=(*outcome.notes, note))


def _said_id(path: Path) -> str:
    """The id that a summary says near its top; empty for one of an older version.

    The rest is not looked at: it may be long, and nothing of it is needed.
    """
    try:
        with path.open("rb") as file:
            found = RUN_ID.search(file.read(HEAD))
    except OSError as error:
        raise OutputError(f"cannot read {path}: {error.strerror or error}",
                          code="run-damaged") from None
    return found[1].decode() if found else ""


def saved_audit(directory: Path) -> list[Figure]:
    """The audit that was saved with a run; none where it has none, or none that can be read.

    What a summary says is shown as it stands: who doubts it audits the recording again.
    """
    rows = _saved(directory, "audit")
    try:
        return [_figure(row) for row in rows] if isinstance(rows, list) else []
    except (ValueError, TypeError, KeyError):
        return []


def _saved(directory: Path, key: str) -> Any:
    """What a run's summary has under a key; None where there is none that can be read."""
    for name in (SUMMARY, INCOMPLETE):
        path = directory / name
        try:
            if path.stat().st_size > MOST_SUMMARY:
                return None
            found = json.loads(path.read_bytes())
            return found.get(key) if isinstance(found, dict) else None
        except FileNotFoundError:
            continue
        except (OSError, ValueError, RecursionError):
            return None
    return None


def _figure(row: Mapping[str, Any]) -> Figure:
    """A figure as :func:`sandbox.audit.figures.figure_data` wrote it.

    Raises:
        ValueError, TypeError, KeyError: it did not.
    """
    if row["verdict"] not in ("pass", "look", "not computed"):
        raise ValueError("no verdict of an audit")
    words = {key: str(row[key])[:MOST_WORDS] for key in ("name", "unit", "why", "source")}
    value, threshold = (math.nan if row[key] is None else float(row[key])
                        for key in ("value", "threshold"))
    return Figure(value=value, threshold=threshold, verdict=row["verdict"], **words)


def _write(path: Path, content: Callable[[IO[bytes]], None]) -> None:
    with atomic_file(path, durable=False) as part, part.open("wb") as file:
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
