"""The files of a run: ``run.npz``, the CSV files, and ``run.json`` last.

CSV files have one row per sample, columns ``time_s,<name>.<quantity>_<unit>``. In a unit a space
becomes ``_``, ``/`` becomes ``_per_``, ``%`` becomes ``percent``, ``^`` and ``1`` vanish. Numbers
have 12 significant digits; zero has no sign; a missing value is ``nan``.
"""

from __future__ import annotations

import json
import math
import os
import platform
import re
import zipfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
from pydantic import TypeAdapter

from sandbox.atomic_files import atomic_file, json_text, write_atomic
from sandbox.audit.bounds import Bounds
from sandbox.audit.evidence import Figure
from sandbox.elements.arrays import IMPACT, Arrays
from sandbox.elements.quantities import CONTACT_COLUMNS, IMPACT_COLUMNS
from sandbox.errors import OutputError
from sandbox.numeric import Array, Integers
from sandbox.recording import archive
from sandbox.recording.new_run import ARCHIVE, CONTACTS, IMPACTS, INCOMPLETE, SUMMARY
from sandbox.samples.expectations import Verdict
from sandbox.samples.outcome import Outcome, outcome_data
from sandbox.samples.samples import TABLES, Samples
from sandbox.scene.mechanism import Mechanism
from sandbox.values.units import normal_unit

RUN_ID = re.compile(rb'"run_id": "([0-9a-f]{32})"')
EDITED = "was changed: it does not name its run, and its checks are ignored"
HEAD = 1024  # Bytes of a summary in which its id stands
MAX_SUMMARY = 64_000_000  # Bytes of a summary that is read as a whole
NUMBER = "%.12g"
ALWAYS = ("tendons", "joints", "bodies", "drives")  # written even without columns
BLOCK = 250_000  # Numbers that are turned into text at a time


def save_data(run: Samples, directory: Path) -> None:
    """Write everything but the summary into a directory that holds no run."""
    with atomic_file(directory / ARCHIVE, durable=False) as part, part.open("wb") as file:
        archive.write(run, file)
    texts: dict[str, Iterable[str]] = {CONTACTS: contact_rows(run)}
    if len(run.arrays["impact_time"]):
        impacts = _pair_rows(run, *(run.arrays[key] for key in IMPACT))
        texts[IMPACTS] = [_pair_head(IMPACT_COLUMNS), impacts]
    texts |= {f"{kind}.csv": rows(run, kind) for kind in TABLES
              if kind in ALWAYS or getattr(run.mechanism, kind)}
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
    path = directory / SUMMARY
    path = path if path.exists() else directory / INCOMPLETE
    try:
        if path.stat().st_size <= MAX_SUMMARY:
            rows = json.loads(path.read_bytes()).get("audit") or []
            return TypeAdapter(list[Figure]).validate_python([
                {key: math.nan if value is None else value for key, value in row.items()}
                for row in rows])
    except (AttributeError, OSError, ValueError, TypeError, RecursionError):
        pass
    return []


def column(name: str, unit: str) -> str:
    """The name of a column: ``finger1.tendon.tension_N``, ``arm.omega_rad_per_s``, ``held``."""
    unit = normal_unit(unit).replace("/", "_per_").replace("%", "percent").replace(" ", "_")
    unit = re.sub(r"[^\w]", "", "" if unit == "1" else unit).removeprefix("1_").strip("_")
    return "_".join(filter(None, (name, unit)))


def rows(run: Samples, kind: str) -> Iterator[str]:
    """The text of a table (see :meth:`Samples.table`), header first, in large pieces."""
    names, units, _ = run.part(0, 0).table(kind)
    heads = ["time_s", *(column(name, unit) for name, unit in zip(names, units, strict=True))]
    yield ",".join(heads) + "\n"
    line = ",".join([NUMBER] * len(heads)) + "\n"
    size = max(1, BLOCK // len(heads))
    for first in range(0, len(run), size):
        part = run.part(first, first + size)
        # adding 0 takes the sign off a zero
        values = np.column_stack([part.time, part.table(kind).values]) + 0.0
        yield "".join([line % tuple(row) for row in values.tolist()])


def _pair_head(units: Mapping[str, str]) -> str:
    """The first line of a table with a row for two bodies at an instant."""
    return ",".join(["time_s", "body", "other", *(
        column(name, unit) for name, unit in units.items())]) + "\n"


def bound_rows(run: Samples, found: Mapping[int, Sequence[Bounds]]) -> Iterator[str]:
    """The text of ``contact_bounds.csv``: bounds of contact forces, by number of the sample."""
    yield _pair_head({f"{kind}{end}": "N" for kind in ("normal", "tangential")
                      for end in ("", "_low", "_high")})
    for sample in sorted(found):
        if each := found[sample]:
            numbers = np.array([[value for part in (one.normal, one.tangential)
                                 for value in (part.force, part.low, part.high)] for one in each])
            yield _pair_rows(run, np.full(len(each), run.time[sample]),
                             *np.array([(one.body, one.other) for one in each]).T, numbers)


def contact_rows(run: Samples) -> Iterator[str]:
    """The text of ``contacts.csv``: the force on ``body`` by ``other``, row by row."""
    yield _pair_head(CONTACT_COLUMNS)
    contacts = run.mean_contacts
    for first in range(0, len(contacts.point), BLOCK // 8):
        rows = slice(first, first + BLOCK // 8)
        yield _pair_rows(run, run.time[contacts.sample[rows]], contacts.body[rows],
                         contacts.other[rows], contacts.point[rows], contacts.force[rows],
                         contacts.normal[rows], contacts.tangential[rows])


def _pair_rows(run: Samples, time: Array, body: Integers, other: Integers, *numbers: Array) -> str:
    names = [body.name for body in run.mechanism.bodies]
    values = np.column_stack([time, *numbers]) + 0.0
    line = ",".join([NUMBER, "%s", "%s", *[NUMBER] * (values.shape[1] - 1)]) + "\n"
    return "".join([line % (row[0], names[one], names[two], *row[1:]) for row, one, two in zip(
        values.tolist(), body.tolist(), other.tolist(), strict=True)])
