"""The figure of a sweep, from its table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.sweeps import FoundLine, SweepColumn, SweepDrawing, draw_sweep
from sandbox.numeric import Array, Flags
from sandbox.scene.elements.settings import Looked
from sandbox.sweeps.plan import Plan
from sandbox.sweeps.spec import SweepSpec
from sandbox.sweeps.table import MISSING, SweepTable, load_pyarrow
from sandbox.sweeps.varied import Distributed, Spanned
from sandbox.sweeps.words import told

FIGURE = "sweep.png"
EXPECTED = "what the scene expects"


def load() -> None:
    """Load what a table and its figure need at the end, while workers load the engine."""
    style.load()
    load_pyarrow()


def draw(
    table: SweepTable, path: Path, *, held: Array | None = None, condition: str = "",
    found: FoundLine | None = None,
) -> None:
    """Draw what was kept over what was varied; runs that are not done are left out.

    Args:
        table: of the runs.
        path: the file.
        held: 1 of runs of which holds what must, else 0, nan where it is not known, [n]; by
            default what the scene expects.
        condition: what must hold.
        found: what a search found.

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
        kept = [SweepColumn("expectations passed", "", np.nan_to_num(table.holds)[here])]
    draw_sweep(path, SweepDrawing(
        varied, kept, failed=~table.done[here], doubtful=table.doubtful[here],
        grid=plan.points.one_grid and not any(
            isinstance(each, Distributed) for group in plan.spec.vary
            for each in group.over.values()),
        title=plan.spec.title or f"{plan.name}: {len(table)} runs",
        held=(table.holds if held is None else held)[here], condition=condition or EXPECTED,
        meanings=_meanings(plan), found=found))


def _meanings(plan: Plan) -> dict[str, str]:
    """What is behind the names that say it not themselves."""
    found = {}
    for name, asked in plan.job.keep.items():
        if isinstance(asked, str):
            found[name] = asked.lstrip().removeprefix("=").strip()
        elif isinstance(asked, Looked) and asked.quantity not in name:
            found[name] = told(asked)
    return found


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
