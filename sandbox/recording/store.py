"""The files of a run: ``run.npz``, the CSV files, and ``run.json`` last.

``run.json`` means that everything else is there. An incomplete run has ``run.incomplete.json``
instead. :mod:`sandbox.recording.new_run` puts them in place.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

from sandbox.atomic_files import atomic_file, json_text, write_atomic
from sandbox.audit.evidence import Figure
from sandbox.elements.arrays import Arrays
from sandbox.errors import OutputError
from sandbox.recording import archive, tables
from sandbox.recording.new_run import ARCHIVE, CONTACTS, IMPACTS, INCOMPLETE, SUMMARY
from sandbox.samples.expectations import Verdict
from sandbox.samples.outcome import Outcome, outcome_data
from sandbox.samples.samples import TABLES, Samples
from sandbox.scene.mechanism import Mechanism

RUN_ID = re.compile(rb'"run_id": "([0-9a-f]{32})"')
EDITED = "was changed: it does not name its run, and its checks are ignored"
HEAD = 1024  # Bytes of a summary in which its id stands
MAX_SUMMARY, MAX_WORDS = 64_000_000, 2000  # Bytes of a summary, letters of a text in it


def save_data(run: Samples, directory: Path) -> None:
    """Write everything but the summary into a directory that holds no run."""
    with atomic_file(directory / ARCHIVE, durable=False) as part, part.open("wb") as file:
        archive.write(run, file)
    texts = {CONTACTS: tables.contact_rows(run)}
    if len(run.arrays["impact_time"]):
        texts[IMPACTS] = tables.impact_rows(run)
    texts |= {f"{kind}.csv": tables.rows(run, kind) for kind in TABLES
              if kind in tables.ALWAYS or getattr(run.mechanism, kind)}
    for name, pieces in texts.items():
        with atomic_file(directory / name, durable=False) as part, part.open("wb") as file:
            for piece in pieces:
                file.write(piece.encode())


def save_summary(
    run: Samples, directory: Path, *, verdicts: Sequence[Verdict], figures: Sequence[Figure],
    parameters: Mapping[str, float] | None = None, derived: Sequence[str] = (),
    wall_s: Mapping[str, float] | None = None,
) -> Path:
    """Write ``run.json`` (``run.incomplete.json``) last of all; returns its path.

    ``derived`` are the parameters that follow from others; ``wall_s`` adds to the wall times.
    """
    path = directory / (SUMMARY if run.complete else INCOMPLETE)
    info, mechanism = outcome_data(run.info), run.mechanism
    with zipfile.ZipFile(directory / ARCHIVE) as written:
        run_id = written.comment.decode()
    content = {
        "format": archive.FORMAT,
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
        **{key: info[key] for key in archive.RARE},
        "expectations": [asdict(verdict) for verdict in verdicts],
        "audit": [vars(figure) for figure in figures],
        "scene": mechanism.model_dump(mode="json", by_alias=True),
    }
    write_atomic(path, json_text(content, indent=2) + "\n")
    return path


def load(directory: str | os.PathLike[str]) -> tuple[Mechanism, Arrays, Outcome]:
    """The mechanism, arrays and outcome of a run; without ``run.json`` it is not complete."""
    folder = Path(directory)
    if not folder.is_dir():
        raise OutputError(f"there is no directory {folder}", code="no-run")
    mechanism, arrays, outcome, run_id = archive.read(folder / ARCHIVE)
    complete = (folder / SUMMARY).exists()
    path = folder / (SUMMARY if complete else INCOMPLETE)
    if path.exists() and run_id:
        try:
            with path.open("rb") as file:
                named = RUN_ID.search(file.read(HEAD))
        except OSError as error:
            raise OutputError(f"cannot read {path}: {error.strerror or error}",
                              code="run-damaged") from None
        if named is None:
            outcome = replace(outcome, notes=(*outcome.notes, f"{path.name} {EDITED}"))
        elif named[1].decode() != run_id:
            raise OutputError(f"{folder} is damaged: {path.name} and {ARCHIVE} are of different "
                              "runs", code="run-damaged")
    return mechanism, arrays, outcome if complete or not outcome.complete else unfinished(outcome)


def unfinished(outcome: Outcome) -> Outcome:
    """The outcome of a run whose files are not all in place."""
    note = f"{SUMMARY} is missing: the run was stopped before all of its files were in place"
    return replace(outcome, complete=False, notes=(*outcome.notes, note))


def saved_audit(directory: Path) -> list[Figure]:
    """The audit that was saved with a run; empty where there is none, or none that can be read."""
    path, found = directory / SUMMARY, []
    path = path if path.exists() else directory / INCOMPLETE
    try:
        if path.stat().st_size > MAX_SUMMARY:
            return []
        for row in json.loads(path.read_bytes()).get("audit") or []:
            if row["verdict"] not in ("pass", "look", "not computed"):
                return []
            words = {key: str(row[key])[:MAX_WORDS] for key in ("name", "unit", "why", "source")}
            value, threshold = (math.nan if row[key] is None else float(row[key])
                                for key in ("value", "threshold"))
            found.append(Figure(value=value, threshold=threshold, verdict=row["verdict"], **words))
    except (AttributeError, OSError, ValueError, TypeError, KeyError, RecursionError):
        return []
    return found
