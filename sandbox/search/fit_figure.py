"""What was measured and what the fitted scene does, a panel for each column."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.draw.figure import style
from sandbox.draw.figure.panels import Curve, Panel, save_panels
from sandbox.numeric import Array

MOST = 6
"""Columns that are drawn; all are in ``fit.csv``."""


@dataclass(frozen=True)
class FittedColumn:
    """A column of measurements, SI, [n] each."""

    name: str
    unit: str
    time: Array
    measured: Array
    fitted: Array


def draw_fit(path: Path, columns: Sequence[FittedColumn]) -> None:
    """Draw measurements as points and the fit as lines over time.

    Raises:
        OutputError: the file cannot be written.
    """
    panels = []
    for each in columns[:MOST]:
        shown = style.shown_as(each.unit, each.measured, each.fitted)
        panels.append(Panel(
            each.name, "time [s]", f"{each.name} [{shown.unit}]" if shown.unit else each.name,
            [Curve("measured", each.time, shown.factor * each.measured, "points"),
             Curve("fitted", each.time, shown.factor * each.fitted)]))
    save_panels(path, panels)
