"""Runs laid over one another: quantities with their targets, and the drives under control."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from string import ascii_uppercase
from typing import Any

import numpy as np

from sandbox.draw.figure import style as paper
from sandbox.draw.figure.panels import COLOURS
from sandbox.draw.figure.style import Array, Beside
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.samples.response import settling_time
from sandbox.samples.targets import track

ROW, REST, AXES = 46.0, 14.0, 33.0
"""Height of a row of panels, of title and footnote, of a panel's axes [mm]."""
ENTRY = 5.0
"""Height of a row of the legend [mm]."""
MOST = 24
"""Panels of a figure: what a page holds, twice."""


@dataclass(frozen=True)
class Laid:
    """One of the runs that are compared."""

    label: str
    run: Recording
    goals: Mapping[str, Array]
    """Quantity to its target over time, shape [n], SI."""


def draw(laid: Sequence[Laid], quantities: Sequence[str], drives: Sequence[str]) -> Any:
    """One panel for each quantity and for each drive; every run has its own colour.

    Args:
        laid: the runs.
        quantities: names; a run that has no such quantity is left out of its panel.
        drives: names of drives; the same.

    Raises:
        OutputError: too many panels.
    """
    names = [*quantities, *(f"{drive}.value" for drive in drives)]
    names = [name for name in dict.fromkeys(names) if any(name in one.run for one in laid)]
    if len(names) > MOST:
        raise OutputError(f"{len(names)} panels are too many for one figure: at most {MOST}; "
                          "choose with --quantity")
    columns = min(2, len(names))
    rows, legend = math.ceil(len(names) / columns), math.ceil(len(laid) / _across(laid))
    figure = paper.new_figure(ROW * rows + ENTRY * legend + REST)
    grid = list(figure.subplots(rows, columns, sharex=True, squeeze=False).ravel())
    for i, (axes, name) in enumerate(zip(grid, names, strict=False)):
        _panel(axes, ascii_uppercase[i], laid, name)
    paper.over_time(grid, len(names), columns, *(one.run for one in laid))
    _legend(figure, laid)
    if any(one.goals for one in laid):
        paper.footnote(figure, "Dashed: targets. Circles: settled within 2 % of the target.")
    return figure


def hue(place: int) -> str:
    """The colour of the run at this place."""
    return COLOURS[place % len(COLOURS)]


def _across(laid: Sequence[Laid]) -> int:
    """Entries of the legend side by side: about 110 letters fit."""
    longest = max(len(one.label) for one in laid) + 8
    return max(1, min(len(laid), 110 // longest))


def _legend(figure: Any, laid: Sequence[Laid]) -> None:
    from matplotlib.lines import Line2D

    lines = [Line2D([], [], color=hue(i), linewidth=1.8) for i in range(len(laid))]
    figure.legend(lines, [paper.plain(one.label) for one in laid], loc="outside upper left",
                  ncols=_across(laid), frameon=False, fontsize=paper.PLAIN, labelcolor=paper.INK,
                  handlelength=1.8, borderaxespad=0.2)


def _panel(axes: Any, letter: str, laid: Sequence[Laid], name: str) -> None:
    having = {i: track(one.run, name, one.goals.get(name))
              for i, one in enumerate(laid) if name in one.run}
    values = [one.value for one in having.values()]
    aims = [one.target for one in having.values() if one.target is not None]
    unit = laid[next(iter(having))].run.unit(name)
    shown = paper.shown_as(unit, *values, *aims)
    shared = bool(aims) and all(np.ptp(aim) == 0 and aim[0] == aims[0][0] for aim in aims)
    for i, (time, value, target) in having.items():
        row = shown.factor * value
        axes.plot(time, row, color=hue(i), linewidth=1.4, zorder=3)
        if target is None:
            continue
        axes.plot(time, shown.factor * target, linewidth=0.9, linestyle=(0, (4, 3)),
                  color=paper.INK if shared else hue(i), zorder=2)
        settled = settling_time(time, value, target)
        if math.isfinite(settled):
            axes.plot(settled, np.interp(settled, time, row), "o", color=hue(i), markersize=4.5,
                      markerfacecolor="white", markeredgewidth=1.2, zorder=4)
    paper.roomy(axes, *(shown.factor * row for row in (*values, *aims)))
    unit = f"[{shown.unit}]" if shown.unit else ""
    paper.dress(axes, name.removesuffix(".value"), unit, letter=letter)
    if shared:
        goal = shown.factor * float(aims[0][0])
        paper.put_beside(axes, [Beside(goal, f"{paper.number(goal)}{shown.sign}")], height=AXES)
