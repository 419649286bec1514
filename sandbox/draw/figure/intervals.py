"""Intervals of many estimates beside the truth, as PNG, SVG or PDF: one panel for each parameter.

Estimates stand in the order of their size, so that a glance tells how many intervals miss the
truth, and whether they miss it to either side alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array

COLUMNS = 3
HEIGHT, SURROUND = 44.0, 12.0
"""Of a row of panels, and of what is about all of them [mm]."""


@dataclass(frozen=True)
class Intervals:
    """Estimates of one parameter, as they are plotted, [n] each."""

    title: str
    unit: str
    values: Array
    low: Array
    high: Array
    truth: float


def save_intervals(path: Path, panels: Sequence[Intervals], *, count: str) -> None:
    """Draw intervals into a file, its format by its ending.

    Args:
        path: the file.
        panels: one or more.
        count: what the estimates are of, for the axis along them: ``measurements``.

    Raises:
        OutputError: it cannot be written.
        ValueError: another ending than ``.png .svg .pdf``.
    """
    rows = -(-len(panels) // COLUMNS)
    figure = style.new_figure(HEIGHT * rows + SURROUND)
    grid = figure.subplots(rows, COLUMNS, squeeze=False)
    for place, axes in enumerate(grid.flat):
        axes.set_visible(place < len(panels))
        if place < len(panels):
            below = place + COLUMNS >= len(panels)
            _fill(axes, panels[place], count if below else "")
    style.footnote(figure, "Bars: 95 % intervals, in the order of the estimates; red ones miss the "
                           "truth, which is the line.")
    style.save_figure(figure, path)


def _fill(axes: Any, panel: Intervals, x: str) -> None:
    order = np.argsort(panel.values, kind="stable")
    rank = np.arange(1, len(order) + 1)
    low, high, value = (each[order] for each in (panel.low, panel.high, panel.values))
    missed = (low > panel.truth) | (high < panel.truth)
    style.dress(axes, panel.title, panel.unit, x=x)
    for some, colour in ((~missed, style.BLUE), (missed, style.RED)):
        axes.vlines(rank[some], low[some], high[some], color=colour, linewidth=0.9)
        axes.plot(rank[some], value[some], linestyle="", marker="o", markersize=2.2, color=colour)
    axes.axhline(panel.truth, color=style.INK, linewidth=0.9)
    told = f"{np.count_nonzero(~missed)} of {len(order)} hold it"
    style.remark(axes, told, style.QUIET)
