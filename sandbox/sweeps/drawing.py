"""The figure of a sweep, from its table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.sweeps import SweepColumn, SweepDrawing, draw_sweep
from sandbox.numeric import Flags
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.table import MISSING, SweepTable, load_pyarrow
from sandbox.sweeps.varied import Distributed, Spanned

FIGURE = "sweep.png"


def load() -> None:
    """Load what a table and its figure need at the end, while workers load the engine."""
    style.load()
    load_pyarrow()


def draw(table: SweepTable, path: Path) -> None:
    """Draw what was kept over what was varied; runs that are not done are left out.

    Raises:
        OutputError: the file cannot be written.
    """
    plan = table.plan
    here = np.array([status != MISSING for status in table.status], dtype=bool)
    varied = [_column(name, plan.units.get(name, ""), values, here, _is_log(plan.spec, name))
              for name, values in table.varied.items()]
    kept = [SweepColumn(name, plan.units.get(name, ""), values[here])
            for name, values in table.kept.items()]
    if not kept:
        held = np.where(np.isnan(table.holds), 0.0, table.holds)
        kept = [SweepColumn("expectations hold", "", held[here])]
    draw_sweep(path, SweepDrawing(
        varied, kept, failed=~table.done[here], doubtful=table.doubtful[here],
        grid=plan.points.one_grid and not any(
            isinstance(each, Distributed) for group in plan.spec.vary
            for each in group.over.values()),
        title=plan.spec.title or f"{plan.name}: {len(table)} runs"))


def _column(
    name: str, unit: str, values: list[float | str], here: Flags, log: bool,
) -> SweepColumn:
    if all(isinstance(value, float) for value in values):
        return SweepColumn(name, unit, np.array(values, dtype=float)[here], log=log)
    texts = tuple(dict.fromkeys(map(str, values)))
    places = {text: float(place) for place, text in enumerate(texts)}
    return SweepColumn(name, "", np.array([places[str(v)] for v in values])[here], texts)


def _is_log(spec: SweepSpec, path: str) -> bool:
    for group in spec.vary:
        each = group.over.get(path)
        if isinstance(each, Spanned):
            return each.scale == "log"
        if isinstance(each, Distributed):
            return each.distribution in ("log_uniform", "log_normal")
    return False
