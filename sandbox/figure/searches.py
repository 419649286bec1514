"""Figures of searches: sensitivities, fronts of several goals, branches of equilibria."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Custom, Mark, Panel, save_panels
from sandbox.figure.sweeps import SweepColumn
from sandbox.numeric import Array, Flags

ROW, FRONT, BRANCHES = 7.5, 56.0, 60.0
"""Height of the bars of a path, of a panel of a front, of a panel of branches [mm]."""
THICK = 0.36
"""Height of a bar, as a share of the distance of two paths."""
MAX_QUANTITIES, MAX_PAIRS, MAX_PATHS = 12, 6, 20
"""Quantities, and pairs of goals, of one figure; paths of a panel."""
MAX_LETTERS = 34
"""Letters of a path at an axis."""
INKS = (style.BLUE, style.GREY)
UNSTABLE: Any = (0, (3.5, 1.8))
FOLD: dict[str, Any] = {"linestyle": "", "marker": "o", "markersize": 5.5,
                        "markerfacecolor": "white", "markeredgewidth": 1.3}


@dataclass(frozen=True)
class InfluenceBars:
    """Influences of paths on one quantity."""

    name: str
    paths: Sequence[str]
    """The most influential first; none for a constant quantity."""
    values: Mapping[str, Array]
    """By measure, [paths]."""
    halves: Mapping[str, Array]
    """Half widths of 95 % intervals by measure, if it has any, [paths]."""
    x: str
    """Label of the axis."""


def draw_influences(
    path: Path, panels: Sequence[InfluenceBars], words: Mapping[str, str], title: str,
) -> None:
    """Draw sensitivities as bars with 95 % intervals; no file if all quantities are constant.

    Args:
        path: the file.
        panels: one for each quantity.
        words: names of the measures for the legend.
        title: of the figure.

    Raises:
        OutputError: the file cannot be written.
    """
    changing = [each for each in panels if each.paths]
    shown = changing[:MAX_QUANTITIES]
    if not shown:
        return
    notes = [f"{panel.name} never changes." for panel in panels if not panel.paths]
    if more := len(changing) - len(shown):
        notes.append(f"{more} further quantities are in search.json.")
    if any(len(panel.paths) > MAX_PATHS for panel in shown):
        notes.append(f"The {MAX_PATHS} most influential paths.")
    inks = dict(zip(words, INKS, strict=False))
    save_panels(path, [_bars(panel, inks) for panel in shown], title=title, notes=notes, key=[
        *((words[word], {"facecolor": ink}) for word, ink in inks.items()),
        ("95 % interval", {"color": style.INK, "linewidth": 1.0})])


def _bars(panel: InfluenceBars, inks: Mapping[str, str]) -> Panel:
    paths = panel.paths[:MAX_PATHS]
    places = np.arange(len(paths), dtype=float)
    marks: list[Mark] = []
    for k, (word, ink) in enumerate(inks.items()):
        halves = panel.halves.get(word)
        marks.append(Custom(partial(
            _barh, places=places + (k - 0.5) * THICK, values=panel.values[word][:MAX_PATHS],
            halves=None if halves is None else halves[:MAX_PATHS], ink=ink)))
    short = [path if len(path) <= MAX_LETTERS else f"…{path[1 - MAX_LETTERS:]}" for path in paths]
    return Panel(panel.name, Axis(panel.x), Axis(
        ticks=places.tolist(), words=short, limits=(len(paths) - 0.5, -0.5)), marks, "",
        ROW * len(paths), grid="x")


def _barh(axes: Any, *, places: Array, values: Array, halves: Array | None, ink: str) -> None:
    axes.barh(places, values, height=THICK, color=ink, xerr=halves, error_kw={
        "ecolor": style.INK, "elinewidth": 1.0, "capsize": 2.0})
    axes.axvline(0.0, color=style.INK, linewidth=0.8)
    axes.tick_params(axis="y", length=0)


def draw_front(
    path: Path, goals: Sequence[SweepColumn], senses: Mapping[str, str], best: Flags, title: str,
) -> None:
    """Draw runs over pairs of goals, with the Pareto front.

    Args:
        path: the file.
        goals: two or more, with the values of all runs, [n]; NaN for runs that fail a condition.
        senses: ``least`` or ``most``, by goal.
        best: runs on the front, [n].
        title: of the figure.

    Raises:
        OutputError: the file cannot be written.
    """
    pairs, panels = list(itertools.combinations(goals, 2)), []
    front = {"color": style.BLUE, "markersize": 4.5}
    for one, other in pairs[:MAX_PAIRS]:
        (x, x_axis), (y, y_axis) = (column.axis(0, f", {senses[column.name]}")
                                    for column in (one, other))
        order = np.flatnonzero(best)[np.argsort(x[best], kind="stable")]
        joined = {"linestyle": "-", "linewidth": 0.8} if len(goals) == 2 else {}
        panels.append(Panel("", x_axis, y_axis, [
            Curve("", x[~best], y[~best], "dots", {"color": style.GREY, "markersize": 3.0}),
            Curve("", x[order], y[order], "dots", {**front, **joined})], "", FRONT))
    more = len(pairs) - MAX_PAIRS
    dot = {"linestyle": "", "marker": "o"}
    save_panels(path, panels, title=title, key=[
        ("none is better in all", {**dot, **front}),
        ("other runs that hold", {**dot, "color": style.GREY, "markersize": 3.0})],
        notes=[f"{more} further pairs of goals are in table.csv."] if more > 0 else ())


class BranchCurve(NamedTuple):
    """A branch of equilibria."""

    x: Array
    """Values of the varied field of the scene, [n]."""
    y: Array
    """The quantity at equilibrium, SI, [n]."""
    stable: Flags
    """[n]"""
    fold: Flags
    """Turning points of x, [n]."""


def save_branches(
    path: Path, branches: Sequence[BranchCurve], *, title: str, along: str, quantity: str,
    unit: str,
) -> None:
    """Draw branches of equilibria: unstable ones dashed, folds as rings.

    Args:
        path: the file; its suffix is the format.
        branches: at least one.
        title: of the figure.
        along: label of the x axis.
        quantity: on the y axis.
        unit: its SI unit.

    Raises:
        OutputError: the file cannot be written.
    """
    shown = style.shown_as(unit, *(branch.y for branch in branches))
    marks: list[Mark] = []
    for i, branch in enumerate(branches):
        y, hue = shown.factor * branch.y, {"color": style.hue(i)}
        solid = branch.stable | branch.fold
        changes = (np.flatnonzero(np.diff(solid.astype(int))) + 1).tolist()
        for low, high in itertools.pairwise([0, *changes, len(solid)]):
            # unstable stretches reach to the neighbours at both ends
            first, last = (low, high) if solid[low] else (max(low - 1, 0), high + 1)
            marks.append(Curve("", branch.x[first:last], y[first:last], "line", {
                **hue, "linestyle": "solid" if solid[low] else UNSTABLE}))
        marks.append(Curve("", branch.x[branch.fold], y[branch.fold], "points", {**hue, **FOLD}))
    dark = {"color": style.INK, "linewidth": style.LINE}
    key: list[tuple[str, dict[str, Any]]] = [("stable", dark)]
    if any((~branch.stable & ~branch.fold).any() for branch in branches):
        key.append(("not stable", {**dark, "linestyle": UNSTABLE}))
    if any(branch.fold.any() for branch in branches):
        key.append(("fold", {"color": style.INK, **FOLD}))
    save_panels(path, [Panel("", Axis(along), Axis(shown.label(quantity)), marks, "", BRANCHES)],
                title=title, key=key)
