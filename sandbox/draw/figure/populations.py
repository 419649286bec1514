"""Many objects at a time: distributions, agreement with a closed form, classes over a plane."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Integers

ROW, SURROUND, SQUARE = 30.0, 18.0, 70.0
"""Height of a row of distributions, of what is about them, of a figure of agreement [mm]."""
CLASS_ROW, KEY = 44.0, 12.0
"""Height of a row of planes, and of the names of the classes [mm]."""
HEADROOM = 1.6
"""Of the axis of counts, over the highest: what is said of a distribution stands there."""
SLICES = 50
"""Of a distribution, over what is shown."""


@dataclass(frozen=True)
class OneSpread:
    """A distribution."""

    title: str
    values: Array
    """Shape [n]; those beyond what is shown are counted in the last slice."""
    note: str
    """What is said beside it."""


@dataclass(frozen=True)
class SpreadRow:
    """Distributions side by side, of one condition."""

    title: str
    spreads: Sequence[OneSpread]


@dataclass(frozen=True)
class Agreeing:
    """What one quantity was predicted and what it was, shape [n] each."""

    label: str
    predicted: Array
    found: Array


@dataclass(frozen=True)
class ClassPlane:
    """Points of a plane, each of a class; shape [n] each."""

    title: str
    x: Array
    y: Array
    of: Integers
    """Number of the class."""
    lines: Sequence[tuple[Array, Array, str]] = ()
    """Curves through them, x, y and colour."""


def save_spreads(
    path: Path, rows: Sequence[SpreadRow], *, x: str, y: str, right: float,
    band: tuple[float, float] | None = None, footnote: str = "",
) -> None:
    """Draw rows of distributions over one axis, a band shaded in all.

    Args:
        path: the file, its format by its ending.
        rows: from above, with as many distributions each.
        x: label of the axis, with its unit.
        y: of the counts.
        right: end of the axis; it begins at 0.
        band: what is shaded.
        footnote: under everything.

    Raises:
        OutputError: it cannot be written.
        ValueError: no rows, or rows of unequal numbers of distributions.
    """
    counts = {len(row.spreads) for row in rows}
    if len(counts) != 1:
        raise ValueError("rows must all hold the same number of distributions, got "
                         + (", ".join(map(str, sorted(counts))) or "none"))
    figure = style.new_figure((ROW + 6.0) * len(rows) + SURROUND)
    parts = np.atleast_1d(figure.subfigures(len(rows), 1))
    for place, (part, row) in enumerate(zip(parts, rows, strict=True)):
        part.suptitle(style.plain(row.title), x=0.01, ha="left", fontsize=style.PLAIN,
                      color=style.INK, fontweight="bold")
        line = part.subplots(1, len(row.spreads), sharey=True, squeeze=False)[0]
        for turn, (axes, spread) in enumerate(zip(line, row.spreads, strict=True)):
            style.dress(axes, spread.title, y if turn == 0 else "",
                        x=x if place == len(rows) - 1 else "")
            if band:
                axes.axvspan(*band, color=style.BAND, linewidth=0)
            counted = axes.hist(np.minimum(spread.values, right * (1 - 1e-9)), bins=SLICES,
                                range=(0.0, right), color=style.hue(turn))[0]
            axes.set_xlim(0.0, right)
            axes.set_ylim(0.0, max(axes.get_ylim()[1], HEADROOM * counted.max()))
            axes.annotate(spread.note, (0.98, 0.96), xycoords="axes fraction", ha="right",
                          va="top", fontsize=style.TINY, color=style.INK)
    if footnote:
        style.footnote(figure, footnote)
    style.save_figure(figure, path)


def save_agreement(
    path: Path, groups: Sequence[Agreeing], *, x: str, y: str, difference: str, least: float,
    footnote: str = "",
) -> None:
    """Draw what was found over what was predicted with the line of equals, and how far both part.

    Args:
        path: the file, its format by its ending.
        groups: each has its colour.
        x: label of what was predicted, with its unit.
        y: of what was found.
        difference: of their difference.
        least: smaller differences are shown as this.
        footnote: under everything.

    Raises:
        OutputError: it cannot be written.
    """
    figure = style.new_figure(SQUARE)
    left, right = figure.subplots(1, 2, width_ratios=(1.15, 1.0))
    most = max(float(max(group.predicted.max(), group.found.max())) for group in groups) * 1.05
    style.dress(left, "", y, x=x)
    left.plot([0, most], [0, most], color=style.GREY, linewidth=0.9, zorder=1)
    style.dress(right, "", "share of all that part by more", x=difference)
    for place, group in enumerate(groups):
        left.plot(group.predicted, group.found, color=style.hue(place), linestyle="", marker="o",
                  markersize=2.6, markerfacecolor="none", markeredgewidth=0.6, alpha=0.8)
        apart = np.sort(np.maximum(np.abs(group.found - group.predicted), least))
        share = 1.0 - np.arange(len(apart)) / len(apart)
        right.plot(np.append(least, apart), np.append(1.0, share), color=style.hue(place),
                   linewidth=style.LINE, drawstyle="steps-post", label=group.label)
    left.set(xlim=(0, most), ylim=(0, most), aspect="equal")
    left.annotate("equal", (0.8 * most, 0.8 * most), xytext=(-4, 6), textcoords="offset points",
                  ha="right", fontsize=style.TINY, color=style.QUIET)
    right.set(xscale="log", yscale="log", xlim=(least, None), ylim=(None, 1.3))
    style.legend(figure, loc="outside upper left", ncols=len(groups))
    if footnote:
        style.footnote(figure, footnote)
    style.save_figure(figure, path)


def save_classes(
    path: Path, rows: Sequence[Sequence[ClassPlane]], classes: Sequence[tuple[str, str]], *,
    x: str, y: str, footnote: str = "", band: tuple[float, float] | None = None,
    top: float | None = None, apart: bool = False,
) -> None:
    """Draw points of several planes, each in the colour of its class, one key above all.

    Args:
        path: the file, its format by its ending.
        rows: from above, with as many planes each.
        classes: name and colour of each.
        x: label of the axis, with its unit.
        y: of the other.
        footnote: under everything.
        band: of y, shaded in all.
        top: end of the y axis, which then begins at 0.
        apart: whether each column has an x axis of its own.

    Raises:
        OutputError: it cannot be written.
    """
    figure = style.new_figure(CLASS_ROW * len(rows) + SURROUND + KEY)
    grid = figure.subplots(len(rows), len(rows[0]), sharex="col" if apart else "all", sharey=True,
                           squeeze=False)
    for row, planes in enumerate(rows):
        for column, plane in enumerate(planes):
            axes = grid[row][column]
            style.dress(axes, plane.title, y if column == 0 else "",
                        x=x if row == len(rows) - 1 else "")
            if band:
                axes.axhspan(*band, color=style.BAND, linewidth=0)
            for number, (_, colour) in enumerate(classes):
                these = plane.of == number
                axes.plot(plane.x[these], plane.y[these], linestyle="", marker="o", color=colour,
                          markersize=3.2, markeredgewidth=0)
            for along, up, colour in plane.lines:
                axes.plot(along, up, color=colour, linewidth=style.LINE)
    if top is not None:
        grid[0][0].set_ylim(0.0, top)
    style.legend(figure, handles=[_dot(name, colour) for name, colour in classes],
                 loc="outside upper left", ncols=len(classes), handletextpad=0.2)
    if footnote:
        style.footnote(figure, footnote)
    style.save_figure(figure, path)


def _dot(name: str, colour: str) -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], linestyle="", marker="o", color=colour, markersize=5, label=name)
