"""Runs runs over one another: quantities with their targets, and the drives under control."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_uppercase
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.style import SideLabel
from sandbox.errors import OutputError
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.response import settling_time
from sandbox.samples.targets import track

ROW, SURROUND, AXES = 46.0, 14.0, 33.0
"""Height of a row of panels, of title and footnote, of a panel's axes [mm]."""
MOST, LONGEST = 24, 30
"""Panels of a figure, what a page holds, twice; letters above a panel: of a longer name its end."""


@dataclass(frozen=True)
class Compared:
    """One of the runs that are compared."""

    label: str
    run: Recording
    targets: Mapping[str, Array]
    """Quantity to its target over time, shape [n], SI."""


def draw(runs: Sequence[Compared], quantities: Sequence[str], drives: Sequence[str]) -> Any:
    """One panel for each quantity and for each drive; every run has its own colour.

    Args:
        runs: the runs.
        quantities: names; a run that has no such quantity is left out of its panel.
        drives: names of drives; the same.

    Raises:
        OutputError: too many panels.
    """
    names = [*quantities, *(f"{drive}.value" for drive in drives)]
    names = [name for name in dict.fromkeys(names) if any(name in one.run for one in runs)]
    if len(names) > MOST:
        raise OutputError(f"{len(names)} panels are too many for one figure: at most {MOST}; "
                          "choose with --quantity", code="bad-picture")
    columns = min(2, len(names))
    rows = math.ceil(len(names) / columns)
    figure = style.new_figure(ROW * rows + SURROUND)
    grid = list(figure.subplots(rows, columns, sharex=True, squeeze=False).ravel())
    for i, (axes, name) in enumerate(zip(grid, names, strict=False)):
        _panel(axes, ascii_uppercase[i], runs, name)
    style.over_time(grid, len(names), columns, *(one.run for one in runs))
    style.name_runs(figure, [one.label for one in runs])
    if any(one.targets for one in runs):
        style.footnote(figure, "Dashed: targets. Circles: settled within 2 % of the target.")
    return figure


def _panel(axes: Any, letter: str, runs: Sequence[Compared], name: str) -> None:
    having = {i: track(one.run, name, one.targets.get(name))
              for i, one in enumerate(runs) if name in one.run}
    values = [one.value for one in having.values()]
    aims = [one.target for one in having.values() if one.target is not None]
    unit = runs[next(iter(having))].run.unit(name)
    shown = style.shown_as(unit, *values, *aims)
    shared = bool(aims) and all(np.ptp(aim) == 0 and aim[0] == aims[0][0] for aim in aims)
    for i, (time, value, target) in having.items():
        row = shown.factor * value
        axes.plot(time, row, color=style.hue(i), linewidth=style.LINE, zorder=3)
        if target is None:
            continue
        axes.plot(time, shown.factor * target, color=style.INK if shared else style.hue(i),
                  zorder=2, **style.TARGET)
        settled = settling_time(time, value, target)
        if math.isfinite(settled):
            axes.plot(settled, np.interp(settled, time, row), "o", color=style.hue(i),
                      markersize=4.5, markerfacecolor="white", markeredgewidth=1.2, zorder=4)
    style.roomy(axes, *(shown.factor * row for row in (*values, *aims)))
    unit = f"[{shown.unit}]" if shown.unit else ""
    name = name.removesuffix(".value")
    head = name if len(name) <= LONGEST else f"…{name[1 - LONGEST:]}"
    style.dress(axes, head, unit, letter=letter)
    style.powers(axes)
    if shared:
        level = shown.factor * float(aims[0][0])
        style.label_side(axes, [SideLabel(level, f"{style.number(level)}{shown.sign}")],
                         height=AXES)
