"""The table of a sweep, a row for each run in the order of the plan, and its figure."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from sandbox import __version__
from sandbox.atomic_files import atomic_file, json_text, write_atomic, write_csv
from sandbox.errors import SandboxError, optional
from sandbox.figure import style
from sandbox.figure.sweeps import FoundLine, SweepColumn, SweepDrawing, draw_sweep
from sandbox.numeric import Array, Flags
from sandbox.sweeps import CSV, PARQUET, SPEC
from sandbox.sweeps.job import DONE, Status, SweepRow
from sandbox.sweeps.plan import Plan
from sandbox.sweeps.spec import Distribution, Range, Values, number_of
from sandbox.wording import counted, listed, or_near

MET = "met"  # column of a search: whether its condition holds
MISSING: Status = ""  # status of a run that was not done yet


@dataclass
class SweepTable:
    """Columns of a sweep, [n] for n planned runs."""

    plan: Plan
    rows: list[SweepRow]  #: the outcome of each run; its status is empty if it was not done yet
    met: Array | None = None  #: of a search with a condition: 1 or 0, or nan where it is unknown

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        return (f"<SweepTable of {self.plan.name!r}: {counted(len(self), 'run')}, "
                f"{len(self.kept)} kept, {self.count} done>")

    @cached_property
    def kept(self) -> dict[str, Array]:
        """Results by name, SI; nan for no value."""
        return {name: np.array([row.kept.get(name) for row in self.rows], dtype=float)
                for name in self.plan.job.keep}

    @property
    def ids(self) -> list[str]:
        """Ids of the runs, [n]."""
        return self.plan.ids

    @property
    def status(self) -> list[str]:
        """Status of each run, [n]; empty for one that was not done yet."""
        return [row.status for row in self.rows]

    @property
    def holds(self) -> Array:
        """Whether all expectations hold: 1 or 0, or nan for a run without expectations, [n]."""
        return np.array([row.holds for row in self.rows], dtype=float)

    @property
    def count(self) -> int:
        """Runs that are finished, however they ended."""
        return sum(row.status != MISSING for row in self.rows)

    @property
    def done(self) -> Flags:
        """Whether each run reached its end, [n]."""
        return np.array([row.status == DONE for row in self.rows], dtype=bool)

    @property
    def doubtful(self) -> Flags:
        """Whether the audit of each run has warnings, [n]."""
        return np.array([bool(row.looks) for row in self.rows], dtype=bool)

    @cached_property
    def varied(self) -> dict[str, list[float | str]]:
        """Values of each path, SI or text, [n]."""
        return {path: [number_of(point[path]) for point in self.plan.points]
                for path in self.plan.spec.over}

    def __getitem__(self, name: str) -> Any:
        """A column: a result or a path as an array, others as a list.

        Raises:
            SandboxError: there is no such column.
        """
        if name in self.kept:
            return self.kept[name]
        if name in self.varied:
            return np.array(self.varied[name])
        columns = self.columns()
        if name not in columns:
            raise SandboxError(f"the table has no column {name!r}{or_near(name, columns)} "
                               f"(it has {listed(columns, most=40)})", code="bad-study")
        return columns[name]

    def columns(self) -> dict[str, list[Any]]:
        """All columns in their order, as plain lists; None for no value."""
        rows = self.rows
        return {
            "run": list(range(len(self))), "id": self.ids, **self.varied,
            **{name: [row.kept.get(name) for row in rows] for name in self.kept},
            "status": self.status, "reason": [row.reason for row in rows],
            **({} if self.met is None else {
                MET: [None if math.isnan(value) else bool(value) for value in self.met]}),
            "holds": [row.holds for row in rows],
            "failed": [" ".join(row.failed) for row in rows],
            "looks": [" ".join(row.looks or ()) for row in rows],
            "seed": [self.plan.spec.seed] * len(self),
        }

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame`` indexed by run; ``attrs["units"]`` has units.

        Raises:
            SandboxError: pandas is not installed.
        """
        frame = optional("pandas", "pandas").DataFrame(self.columns()).set_index("run")
        frame.attrs["units"] = self.plan.units
        return frame

    def write(self, directory: Path) -> None:
        """Write ``table.csv``, and ``table.parquet`` where pyarrow is installed."""
        columns = self.columns()
        cells = ([str(value).lower() if isinstance(value, bool) else value for value in row]
                 for row in zip(*columns.values(), strict=True))
        write_csv(directory / CSV, itertools.chain([columns], cells))
        try:
            pyarrow, parquet = import_module("pyarrow"), import_module("pyarrow.parquet")
        except ImportError:
            return
        types = {**dict.fromkeys(self.kept, pyarrow.float64()),
                 **dict.fromkeys(("holds", MET), pyarrow.bool_())}
        found = pyarrow.table({name: pyarrow.array(
            list(map(str, values)) if len({type(v) for v in values if v is not None}) > 1
            else values, types.get(name)) for name, values in columns.items()})
        with atomic_file(directory / PARQUET) as part:
            parquet.write_table(found, part)


def preload() -> None:
    """Import what writes tables and figures, while worker processes load the engine."""
    style.load()
    with suppress(ImportError):
        import_module("pyarrow.parquet")


def make_table(plan: Plan, rows: Iterable[SweepRow]) -> SweepTable:
    """The table of a plan from rows in any order; rows of other plans are ignored."""
    found = {row.id: row for row in rows}
    return SweepTable(plan, [found.get(id) or SweepRow(id, MISSING) for id in plan.ids])


def write_spec(plan: Plan, directory: Path, **progress: Any) -> None:
    """Write ``sweep.json``: the study, units of columns, and how the sweep ended."""
    write_atomic(directory / SPEC, json_text({
        "study": dict(plan.written), "versions": {"sandbox": __version__}, "units": plan.units,
        **progress}, indent=2) + "\n")


def draw_table(
    table: SweepTable, path: Path, condition: str = "", found: FoundLine | None = None,
) -> None:
    """Draw results over varied paths, without runs that were not done yet.

    On a grid of two paths, a map shows where the expectations of the scene hold. A search has a
    ``condition`` instead, and may have ``found`` a value.
    """
    plan, over = table.plan, table.plan.spec.over
    grid = len(table) == math.prod(len({*values}) for values in table.varied.values()) and not any(
        isinstance(values, Distribution) for values in over.values())
    here = np.array([row.status != MISSING for row in table.rows], dtype=bool)
    kept = [SweepColumn(name, plan.units.get(name, ""), values[here])
            for name, values in table.kept.items()]
    map_of_holds = grid and len(over) == 2 and {0.0, 1.0} <= {*table.holds.tolist()}
    if not kept or map_of_holds:
        kept.insert(0, SweepColumn("expectations passed", "", np.nan_to_num(table.holds)[here]))
    draw_sweep(path, SweepDrawing(
        [_varied_column(table, name, over[name], here) for name in table.varied], kept,
        failed=~table.done[here], doubtful=table.doubtful[here], grid=grid,
        title=plan.spec.title or f"{plan.name}: {len(table)} runs",
        held=(table.holds if table.met is None else table.met)[here],
        condition=condition or "the scene's expectations", found=found))


def _varied_column(table: SweepTable, name: str, over: Values, here: Flags) -> SweepColumn:
    values = table.varied[name]
    if not all(isinstance(value, float) for value in values):
        places = {text: float(place) for place, text in enumerate(dict.fromkeys(map(str, values)))}
        return SweepColumn(name, "", np.array([places[str(v)] for v in values])[here],
                           tuple(places))
    log = over.scale == "log" if isinstance(over, Range) else (
        isinstance(over, Distribution) and over.distribution.startswith("log_"))
    return SweepColumn(name, table.plan.units.get(name, ""),
                       np.array(values, dtype=float)[here], log=log)
