"""The table of a sweep: a row a run, in the order of its plan, whoever ran it and when."""

from __future__ import annotations

import csv
import json
import math
import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import atomic_file, write_atomic
from sandbox.errors import SandboxError
from sandbox.numeric import Array
from sandbox.sweeps.job import DONE, SweepRow
from sandbox.sweeps.plan import Plan
from sandbox.sweeps.points import number_of
from sandbox.wording import counted, listed, or_near

CSV, PARQUET, SPEC = "table.csv", "table.parquet", "sweep.json"
CHUNK = 50_000
"""Rows that are written at a time."""
MET = "met"
"""The column of a search that says of which runs its condition holds."""
MISSING = ""
"""The status of a run that is not done."""


@dataclass
class SweepTable:
    """Columns, [n] each, n the number of runs that were planned."""

    plan: Plan
    kept: dict[str, Array]
    """By name, SI; nan for what has no value."""
    ids: list[str]
    status: list[str]
    """Empty of a run that is not done."""
    holds: Array
    """1, 0, or nan of a run without expectations."""
    reason: dict[int, str] = field(default_factory=dict)
    """Of runs that have one, by their number."""
    failed: dict[int, tuple[str, ...]] = field(default_factory=dict)
    looks: dict[int, tuple[str, ...]] = field(default_factory=dict)
    """Of runs whose audit asks for a look."""
    met: Array | None = None
    """Of a search with a condition of its own: 1, 0, or nan where a run does not tell."""

    def __len__(self) -> int:
        return len(self.ids)

    def __repr__(self) -> str:
        return (f"<SweepTable of {self.plan.name!r}: {counted(len(self), 'run')}, "
                f"{len(self.kept)} kept, {self.count} done>")

    @property
    def count(self) -> int:
        """Runs that are done, however they ended."""
        return sum(status != MISSING for status in self.status)

    @property
    def done(self) -> Any:
        """Which runs came to their end, [n]."""
        return np.array([each == DONE for each in self.status], dtype=bool)

    @property
    def doubtful(self) -> Any:
        """Which runs did, though their audit asks for a look, [n]."""
        flags = np.zeros(len(self), dtype=bool)
        flags[list(self.looks)] = True
        return flags

    @cached_property
    def varied(self) -> dict[str, list[float | str]]:
        """The values of each path, SI or text, [n]."""
        points = self.plan.points
        found: dict[str, list[float | str]] = {}
        for axis in points.axes:
            numbers = [number_of(value) for value in axis.written]
            found[axis.path] = [numbers[place] for place in points.places(axis.path).tolist()]
        return found

    def __getitem__(self, name: str) -> Any:
        """A column by its name: what is kept, a path, or one of :data:`COLUMNS` or :data:`MET`."""
        if name in self.kept:
            return self.kept[name]
        if name in self.plan.points.paths:
            return np.array(self.varied[name])
        columns = self.columns()
        if name not in columns:
            raise SandboxError(f"the table has no column {name!r}{or_near(name, columns)} "
                               f"(it has {listed(columns, most=40)})")
        return columns[name]

    def columns(self) -> dict[str, Any]:
        """All columns by name, in their order, as plain lists; None for what has no value."""
        n = len(self)
        return {
            "run": list(range(n)), "id": self.ids, **self.varied,
            **{name: [None if math.isnan(value) else value for value in values.tolist()]
               for name, values in self.kept.items()},
            "status": self.status,
            "reason": [self.reason.get(run, "") for run in range(n)],
            **({} if self.met is None else {MET: _flags(self.met)}),
            "holds": _flags(self.holds),
            "failed": [" ".join(self.failed.get(run, ())) for run in range(n)],
            "looks": [" ".join(self.looks.get(run, ())) for run in range(n)],
            "seed": [self.plan.spec.seed] * n,
        }

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``, a row a run; ``attrs["units"]`` has units.

        Raises:
            SandboxError: pandas is not installed.
        """
        try:
            pandas = import_module("pandas")
        except ImportError:
            raise SandboxError("to_pandas() needs the package 'pandas', which is not installed: "
                               "pip install pandas; table['name'] gives plain arrays without "
                               "it", code="missing-package") from None
        frame = pandas.DataFrame(self.columns()).set_index("run")
        frame.attrs["units"] = self.plan.units
        return frame

    def write(self, directory: Path) -> list[str]:
        """Write the table; the names of the files.

        ``table.csv`` always, ``table.parquet`` where pyarrow is installed.

        Raises:
            OutputError: it cannot be written.
        """
        columns = self.columns()
        with atomic_file(directory / CSV) as part, part.open("w", encoding="utf-8",
                                                               newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(columns)
            writer.writerows(_rows(columns.values()))
        return [CSV, *([PARQUET] if _parquet(columns, self.plan, directory / PARQUET) else [])]


def _flags(values: Array) -> list[bool | None]:
    return [None if math.isnan(value) else bool(value) for value in values]


def _rows(columns: Iterable[list[Any]]) -> Iterator[list[Any]]:
    for cells in zip(*columns, strict=True):
        yield ["" if cell is None else repr(cell) if isinstance(cell, float)
               else str(cell).lower() if isinstance(cell, bool) else cell for cell in cells]


def load_pyarrow() -> tuple[Any, Any] | None:
    """``pyarrow`` and ``pyarrow.parquet``; None where they are not installed."""
    try:
        return import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError:
        return None


def _parquet(columns: Mapping[str, list[Any]], plan: Plan, path: Path) -> bool:
    found = load_pyarrow()
    if found is None:
        return False
    pa, parquet = found
    plain = {name: list(map(str, values)) if len({type(v) for v in values if v is not None}) > 1
             else values for name, values in columns.items()}
    fields = [pa.field(name, pa.float64() if name in plan.job.keep else
                       pa.bool_() if name in ("holds", MET) else pa.infer_type(values),
                       metadata={"unit": plan.units.get(name, "")})
              for name, values in plain.items()]
    schema = pa.schema(fields)
    with atomic_file(path) as part, parquet.ParquetWriter(part, schema) as writer:
        for begin in range(0, len(plain["run"]), CHUNK):
            writer.write_table(pa.table({name: values[begin:begin + CHUNK]
                                         for name, values in plain.items()}, schema=schema))
    return True


def table_of(plan: Plan, rows: Iterable[SweepRow]) -> SweepTable:
    """The table of a plan from rows in any order; those of other plans are left aside."""
    n = len(plan)
    ids = plan.ids
    place: dict[str, int] = {}
    again: dict[int, int] = {}
    for run, id in enumerate(ids):
        if id in place:
            again[run] = place[id]
        else:
            place[id] = run
    table = SweepTable(plan, {name: np.full(n, np.nan) for name in plan.job.keep}, ids,
                  [MISSING] * n, np.full(n, np.nan))
    for row in rows:
        run = place.get(row.id, -1)
        if run >= 0:
            _put(table, run, row)
    for run, first in again.items():  # the same point twice is run once
        for name in table.kept:
            table.kept[name][run] = table.kept[name][first]
        table.status[run], table.holds[run] = table.status[first], table.holds[first]
        for sparse in (table.reason, table.failed, table.looks):
            _copied(sparse, first, run)
    return table


def _copied(sparse: dict[int, Any], first: int, run: int) -> None:
    if first in sparse:
        sparse[run] = sparse[first]


def _put(table: SweepTable, run: int, row: SweepRow) -> None:
    table.status[run] = row.status
    if row.holds is not None:
        table.holds[run] = float(row.holds)
    if row.reason:
        table.reason[run] = row.reason
    if row.failed:
        table.failed[run] = row.failed
    if row.looks:
        table.looks[run] = row.looks
    for name, value in row.kept.items():
        if value is not None and name in table.kept:
            table.kept[name][run] = value


def _from_here(file: str, directory: Path) -> str:
    """A scene's file as seen from a directory; empty for a scene that has none."""
    if not file:
        return ""
    try:
        return os.path.relpath(file, directory)
    except ValueError:  # on another drive
        return str(Path(file).resolve())


def write_spec(plan: Plan, directory: Path, told: Mapping[str, Any]) -> None:
    """Write ``sweep.json``: the study as it was run, units of columns, how it ended."""
    data = {"study": dict(plan.written), "versions": {"sandbox": __version__},
            "scene_file": _from_here(plan.loaded.name, directory), "units": plan.units, **told}
    write_atomic(directory / SPEC, json.dumps(data, indent=2, ensure_ascii=False) + "\n")
