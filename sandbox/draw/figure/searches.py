"""What a search found: bars of what matters, the front of several goals, as PNG, SVG or PDF."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.draw.figure.sweeps import SweepColumn
from sandbox.numeric import Array, Flags

ROW, HEAD, SURROUND = 7.5, 14.0, 26.0
"""Height of a path's bars, of what is about a panel's bars, and of what is about all [mm]."""
FRONT = 72.0
"""Height of a panel of a front [mm]."""
THICK = 0.36
"""Of a bar, of the distance of two paths."""
MOST, MOST_PAIRS = 12, 6
"""Quantities, and pairs of goals, of one figure; a note says how many more there are."""
MOST_PATHS = 20
"""Paths of a panel: the most influential ones."""
LONGEST = 34
"""Letters of a path at an axis."""
INKS = (style.BLUE, style.GREY)


@dataclass(frozen=True)
class InfluenceBars:
    """What paths do to one thing that is kept."""

    name: str
    paths: Sequence[str]
    """The most influential first; none of what never changes."""
    values: Mapping[str, Array]
    """By measure, [paths]."""
    halves: Mapping[str, Array]
    """Half of the 95 % interval of the measures that have one, [paths]."""
    x: str
    """Label of the axis."""


def draw_influences(
    path: Path, panels: Sequence[InfluenceBars], words: Mapping[str, str], title: str,
) -> None:
    """Draw bars of what matters, with their 95 % intervals; nothing where nothing ever changes.

    Args:
        path: the file.
        panels: one for each that is kept.
        words: what each measure is, for the legend.
        title: above it.

    Raises:
        OutputError: the file cannot be written.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    moving = [each for each in panels if each.paths]
    shown = moving[:MOST]
    if not shown:
        return
    rows = [min(len(each.paths), MOST_PATHS) for each in shown]
    figure = style.new_figure(sum(ROW * count + HEAD for count in rows) + SURROUND)
    grid = figure.subplots(len(shown), squeeze=False, height_ratios=[
        ROW * count + HEAD for count in rows])
    for axes, panel in zip(grid[:, 0], shown, strict=True):
        _bars(axes, panel, list(words))
    style.title(figure, title)
    marks = [*(Patch(color=ink) for ink in INKS[:len(words)]),
             Line2D([], [], color=style.INK, linewidth=1.0)]
    notes = [f"{style.plain(panel.name)} never changes." for panel in panels if not panel.paths]
    if more := len(moving) - len(shown):
        notes.append(f"{more} further quantities are in search.json.")
    if any(len(panel.paths) > MOST_PATHS for panel in shown):
        notes.append(f"The {MOST_PATHS} paths that matter most.")
    _legend(figure, marks, [*words.values(), "95 % interval"], notes)
    style.save_figure(figure, path)


def _legend(
    figure: Any, marks: Sequence[Any], words: Sequence[str], notes: Sequence[str],
) -> None:
    """A legend below, and under it notes, for which a footnote would have no place."""
    from matplotlib.lines import Line2D

    blank = [Line2D([], [], linestyle="")] * len(notes)
    figure.set_figheight(figure.get_figheight() + len(notes) * style.NAME * style.MM)
    style.legend(figure, [*marks, *blank], [*words, *notes], loc="outside lower left")


def _bars(axes: Any, panel: InfluenceBars, words: Sequence[str]) -> None:
    style.dress(axes, panel.name, "", x=panel.x)
    axes.grid(visible=False, axis="y")
    paths = panel.paths[:MOST_PATHS]
    places = np.arange(len(paths), dtype=float)
    for k, (word, ink) in enumerate(zip(words, INKS, strict=False)):
        halves = panel.halves.get(word)
        axes.barh(places + (k - 0.5) * THICK, panel.values[word][:MOST_PATHS], height=THICK,
                  color=ink, xerr=None if halves is None else halves[:MOST_PATHS],
                  error_kw={"ecolor": style.INK, "elinewidth": 1.0, "capsize": 2.0})
    axes.axvline(0.0, color=style.INK, linewidth=0.8)
    axes.set_yticks(places, [style.plain(_short(path)) for path in paths])
    axes.set_ylim(len(paths) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)


def _short(path: str) -> str:
    """The end of a long path, which says most."""
    return path if len(path) <= LONGEST else f"…{path[1 - LONGEST:]}"


def draw_front(
    path: Path, goals: Sequence[SweepColumn], senses: Mapping[str, str], best: Flags, title: str,
) -> None:
    """Draw all runs that hold over pairs of goals, and of which none is better in all.

    Args:
        path: the file.
        goals: two or more, with the values of all runs, [n]; nan of those that fail a condition.
        senses: ``least`` or ``most``, by goal.
        best: which runs are the answers, [n].
        title: above it.

    Raises:
        OutputError: the file cannot be written.
    """
    from matplotlib.lines import Line2D

    pairs = list(itertools.combinations(goals, 2))
    figure = style.new_figure(FRONT * len(pairs[:MOST_PAIRS]) + SURROUND)
    grid = figure.subplots(len(pairs[:MOST_PAIRS]), squeeze=False)
    for axes, (one, other) in zip(grid[:, 0], pairs, strict=False):
        (x, x_label), (y, y_label) = one.labelled(), other.labelled()
        style.dress(axes, "", f"{y_label}, {senses[other.name]}",
                    x=f"{x_label}, {senses[one.name]}")
        axes.plot(x[~best], y[~best], linestyle="", marker="o", markersize=3, color=style.GREY,
                  markeredgewidth=0)
        order = np.flatnonzero(best)[np.argsort(x[best], kind="stable")]
        joined = len(goals) == 2
        axes.plot(x[order], y[order], linestyle="-" if joined else "", marker="o", markersize=4.5,
                  color=style.BLUE, linewidth=0.8, markeredgewidth=0)
        style.powers(axes)
        style.roomy(axes, y)
    style.title(figure, title)
    marks = [Line2D([], [], linestyle="", marker="o", markersize=size, color=ink)
             for size, ink in ((4.5, style.BLUE), (3, style.GREY))]
    more = len(pairs) - MOST_PAIRS
    _legend(figure, marks, ["none is better in all", "other runs that hold"],
            [f"{more} further pairs of goals are in table.csv."] * (more > 0))
    style.save_figure(figure, path)
