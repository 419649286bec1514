"""Figures of sweeps and searches.

One varied path: curves over it, or, of random samples, points with a histogram. A grid of two
paths: a curve for each value of a path with few values, otherwise a map of each quantity. Anything
else: each quantity over each path. Ticks or crosses mark unfinished runs, rings mark runs with a
warning of the audit, orange points mark runs that fail a condition.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.figure import style
from sandbox.figure.panels import Axis, Curve, Mark, Panel, draw, upright
from sandbox.numeric import Array, Flags

MAX_QUANTITIES, MAX_PAIRS, MAX_PATHS = 12, 6, 20
"""Quantities, and pairs of goals, of one figure; paths of a panel of sensitivities."""
PANEL, MAP, CELL, MAX_COLUMNS = 34.0, 46.0, 24.0, 6
"""Height of a panel, of a map, of a panel of a matrix [mm]; columns of a matrix."""
ROW, FRONT, BRANCHES = 7.5, 56.0, 60.0
"""Height of the bars of a path, of a panel of a front, of a panel of branches [mm]."""
THICK = 0.36  # height of a bar, as a share of the distance of two paths
MAX_LETTERS = 34  # letters of a path at an axis
MANY = 60  # with more points than this, points are small
UNSTABLE: Any = (0, (3.5, 1.8))
FOLD: dict[str, Any] = {"linestyle": "", "marker": "o", "markersize": 5.5,
                        "markerfacecolor": "white", "markeredgewidth": 1.3}


@dataclass(frozen=True)
class SweepColumn:
    """A column of a sweep's table."""

    name: str
    unit: str  # SI; empty for none
    values: Array  # shape [n]; NaN for missing values. Of texts, their indices
    texts: tuple[str, ...] = ()  # texts by index; empty for numbers
    log: bool = False  # whether values are spaced logarithmically

    def axis(self, name: str | None = None) -> tuple[Array, Axis]:
        """Values as plotted, and their axis, by default with the column's name."""
        how = style.shown_as(self.unit, self.values)
        return how.factor * self.values, Axis(
            how.label(self.name if name is None else name), self.log, words=self.texts)


class FoundLine(NamedTuple):
    """The result of a search along a path, SI."""

    path: str
    low: float  # of the bracket or of the 95 % interval, which is shaded
    at: float  # position of the line
    high: float
    words: str  # meaning of the line and the shade


@dataclass(frozen=True)
class SweepDrawing:
    """Content of the figure of a sweep."""

    varied: Sequence[SweepColumn]
    kept: Sequence[SweepColumn]
    failed: Flags  # unfinished runs, [n]
    doubtful: Flags  # runs with a warning of the audit, [n]
    grid: bool  # whether every value of each path is combined with every value of the others
    title: str = ""
    held: Array | None = None
    """1 for runs that meet the condition, 0 for those that do not, NaN for others, [n]."""
    condition: str = ""
    found: FoundLine | None = None

    @property
    def missed(self) -> Flags:
        """Scattered points of runs that fail the condition, [n]."""
        if self.held is None or (self.grid and len(self.varied) <= 2):
            return np.zeros(len(self.failed), dtype=bool)
        return np.asarray(self.held == 0, dtype=bool)


def draw_sweep(path: Path, drawing: SweepDrawing) -> None:
    """Draw a sweep into a file; raises as :func:`~sandbox.figure.style.save_figure`."""
    widths, panels, shown = None, list[list[Panel]](), drawing.kept[:MAX_QUANTITIES]
    if len(drawing.varied) == 1:
        panels = [_over_one(drawing, column) for column in shown]
        widths = None if drawing.grid else (3.0, 1.0)
    elif len(drawing.varied) == 2 and drawing.grid:
        counts = [len(np.unique(column.values)) for column in drawing.varied]
        few = min((k for k in (0, 1) if counts[k] <= 3), default=None,
                  key=lambda k: (not drawing.varied[k].texts, counts[k]))
        panels = [[_map(drawing, column) if few is None else _lines(drawing, column, few)]
                  for column in shown]
    else:
        for column in shown:  # a row over each path
            (y, y_axis), row = column.axis(), list[Panel]()
            for one in drawing.varied[:MAX_COLUMNS]:
                x, x_axis = one.axis()
                row.append(Panel("", x_axis, Axis() if row else y_axis, [
                    *_found(drawing, one), *_points(drawing, x, y, joined=False)], "", CELL))
            panels.append(row)
    style.save_figure(draw(panels, title=drawing.title, notes=_notes(drawing), shared=True,
                           widths=widths), path)


def _notes(drawing: SweepDrawing) -> list[str]:
    count, more = len(drawing.failed), len(drawing.kept) - MAX_QUANTITIES
    missed, failed, doubtful = (int(np.count_nonzero(each)) for each in (
        drawing.missed, drawing.failed, drawing.doubtful))
    notes = {
        drawing.found.words if drawing.found else "": drawing.found,
        f"{missed} of {count} runs fail {drawing.condition}: orange.": missed,
        f"{failed} of {count} runs did not finish: red.": failed,
        f"{doubtful} runs have a warning of the audit: rings.": doubtful,
        f"{more} further quantities are in the table only.": more > 0,
    }
    text = " ".join(note for note, applies in notes.items() if applies)
    return [text] if text else []


def _over_one(drawing: SweepDrawing, column: SweepColumn) -> list[Panel]:
    """A quantity over the only path, with a histogram beside it for random samples."""
    varied = drawing.varied[0]
    (x, x_axis), (y, y_axis) = varied.axis(), column.axis("")
    panel = Panel(column.name, x_axis, y_axis, [
        *_found(drawing, varied),
        *_points(drawing, x, y, joined=drawing.grid and not varied.texts)], "", PANEL)
    if drawing.grid:
        return [panel]
    finite = y[np.isfinite(y)]
    histogram: list[Mark] = [lambda axes: axes.hist(
        finite, bins="auto", orientation="horizontal", color=style.BLUE, alpha=0.75)]
    return [panel, Panel("", Axis("runs"), Axis(),
                         histogram if len(finite) and not _equal(finite) else [], "", PANEL)]


def _lines(drawing: SweepDrawing, column: SweepColumn, few: int) -> Panel:
    """A curve over one path for each of the few values of the other."""
    varied, other = drawing.varied[1 - few], drawing.varied[few]
    (x, x_axis), (values, _), (y, y_axis) = varied.axis(), other.axis(), column.axis("")
    marks, unit = list[Mark](), style.shown_as(other.unit, other.values).unit
    for k, value in enumerate(np.unique(values)):
        name = other.texts[int(value)] if other.texts else f"{style.number(value)} {unit}".strip()
        marks += _points(drawing, x, y, joined=not varied.texts, some=values == value,
                         colour=style.hue(k), label=f"{other.name} = {name}")
    return Panel(column.name, x_axis, y_axis, marks,
                 "inside" if column is drawing.kept[0] else "", PANEL)


def _points(
    drawing: SweepDrawing, x: Array, y: Array, *, joined: bool, some: Flags | None = None,
    colour: str = style.BLUE, label: str = "",
) -> list[Mark]:
    here = np.ones(len(x), dtype=bool) if some is None else some
    size, missed = 3.5 if len(x) <= MANY else 1.8, drawing.missed
    line = {"linestyle": "-", "linewidth": style.LINE} if joined else {"alpha": 0.75}
    marks: list[Mark] = []
    for which, ink, name in ((here & ~missed, colour, label), (here & missed, style.ORANGE, "")):
        order = np.flatnonzero(which)[np.argsort(x[which], kind="stable")]
        marks.append(Curve(name, x[order], y[order], "dots", {
            **line, "color": ink, "markersize": size if len(x) <= MANY or not joined else 0}))
    look, lost = here & drawing.doubtful, here & drawing.failed
    return [*marks, Curve("", x[look], y[look], "points", {
        "color": style.INK, "markersize": size + 3.5, "markerfacecolor": "none",
        "markeredgewidth": 1.0}), Curve("", x[lost], y[lost], "rug", {"color": style.RED})]


def _found(drawing: SweepDrawing, varied: SweepColumn) -> list[Mark]:
    """The result of a search on this path: a line, and its uncertainty."""
    found = drawing.found
    if found is None or found.path != varied.name:
        return []
    factor = style.shown_as(varied.unit, varied.values).factor
    return [lambda axes: axes.axvspan(factor * found.low, factor * found.high,
                                      color=style.BAND, linewidth=0, zorder=0),
            upright(factor * found.at, **{"color": style.INK, "zorder": 0.8, **style.TARGET})]


def _equal(values: Array) -> bool:
    finite = values[np.isfinite(values)]
    return bool(len(finite) and np.ptp(finite) <= 1e-9 * np.abs(finite).max())


def _map(drawing: SweepDrawing, column: SweepColumn) -> Panel:
    """Coloured cells of a grid, with the bar of their colours."""
    one, other = drawing.varied
    (x, x_axis), (y, y_axis), (z, z_axis) = one.axis(), other.axis(), column.axis()
    (xs, i), (ys, j) = (np.unique(each, return_inverse=True) for each in (x, y))
    cells = np.full((len(ys), len(xs)), np.nan)
    cells[j, i] = np.where(np.isfinite(z), np.nanmedian(z), np.nan) if _equal(z) else z

    def paint(axes: Any) -> None:
        # perceptually uniform, also with colour vision deficiency (Nuñez et al., 2018)
        mesh = axes.pcolormesh(_edges(xs, log=one.log), _edges(ys, log=other.log), cells,
                               cmap="cividis", edgecolors="face", linewidth=0.1)
        bar = axes.figure.colorbar(mesh, ax=axes)
        bar.ax.tick_params(labelsize=style.SMALL, colors=style.INK)
        bar.outline.set_visible(False)

    lost, look = drawing.failed, drawing.doubtful
    dots = {"markersize": 4, "markerfacecolor": "none", "markeredgewidth": 1.0}
    return Panel(z_axis.label, _at_centres(x_axis, xs), _at_centres(y_axis, ys), [
        paint,
        Curve("", x[lost], y[lost], "points", {**dots, "marker": "x", "color": style.RED}),
        Curve("", x[look], y[look], "points", {**dots, "color": style.ORANGE})],
        "", MAP, grid="")


def _at_centres(axis: Axis, centres: Array) -> Axis:
    """An axis of a map with ticks at the centres of its cells, or of every so many."""
    some = centres[::-(-len(centres) // 8)].tolist()  # of an axis of a map
    return axis if axis.words else replace(axis, ticks=some, words=[*map(style.number, some)])


def _edges(centres: Array, *, log: bool) -> Array:
    """Borders of cells about rising centres, [n] to [n + 1], n > 1."""
    at = np.log(centres) if log else centres
    half = 0.5 * np.diff(at)
    edges = np.concatenate([at[:1] - half[:1], at[:-1] + half, at[-1:] + half[-1:]])
    return np.exp(edges) if log else edges


class InfluenceBars(NamedTuple):
    """Influences of paths on one quantity."""

    name: str
    paths: Sequence[str]  # the most influential first; none for a constant quantity
    values: Mapping[str, Array]  # by measure, [paths]
    halves: Mapping[str, Array]  # half widths of 95 % intervals by measure, if it has any, [paths]
    x: str  # label of the axis


def draw_influences(
    path: Path, panels: Sequence[InfluenceBars], words: Mapping[str, str], title: str,
) -> None:
    """Draw sensitivities with 95 % intervals; no file if all are constant. ``words`` by measure."""
    changing = [each for each in panels if each.paths]
    shown = changing[:MAX_QUANTITIES]
    if not shown:
        return
    notes = [f"{panel.name} never changes." for panel in panels if not panel.paths]
    if more := len(changing) - len(shown):
        notes.append(f"{more} further quantities are in search.json.")
    if any(len(panel.paths) > MAX_PATHS for panel in shown):
        notes.append(f"The {MAX_PATHS} most influential paths.")
    inks = dict(zip(words, (style.BLUE, style.GREY), strict=False))
    style.save_figure(draw([_bars(panel, inks) for panel in shown], title=title, notes=notes, key=[
        *((words[word], {"facecolor": ink}) for word, ink in inks.items()),
        ("95 % interval", {"color": style.INK, "linewidth": 1.0})]), path)


def _bars(panel: InfluenceBars, inks: Mapping[str, str]) -> Panel:
    paths = panel.paths[:MAX_PATHS]
    places = np.arange(len(paths), dtype=float)

    def paint(axes: Any) -> None:
        for k, (word, ink) in enumerate(inks.items()):
            halves = panel.halves.get(word)
            axes.barh(places + (k - 0.5) * THICK, panel.values[word][:MAX_PATHS], height=THICK,
                      color=ink, xerr=None if halves is None else halves[:MAX_PATHS], error_kw={
                          "ecolor": style.INK, "elinewidth": 1.0, "capsize": 2.0})
            axes.axvline(0.0, color=style.INK, linewidth=0.8)
        axes.tick_params(axis="y", length=0)

    short = [path if len(path) <= MAX_LETTERS else f"…{path[1 - MAX_LETTERS:]}" for path in paths]
    return Panel(panel.name, Axis(panel.x), Axis(
        words=short, limits=(len(paths) - 0.5, -0.5)), [paint], "",
        ROW * len(paths), grid="x")


def draw_front(
    path: Path, goals: Sequence[SweepColumn], senses: Mapping[str, str], best: Flags, title: str,
) -> None:
    """Draw runs over pairs of goals, with the Pareto front.

    The values of ``goals`` are NaN for runs that fail a condition; ``senses`` are ``least`` or
    ``most`` by goal; ``best`` are the runs on the front, [n].
    """
    pairs, panels = list(itertools.combinations(goals, 2)), []
    front, other = ({"color": style.BLUE, "markersize": 4.5},
                    {"color": style.GREY, "markersize": 3.0})
    for pair in pairs[:MAX_PAIRS]:
        (x, x_axis), (y, y_axis) = (
            (values, replace(axis, label=f"{axis.label}, {senses[column.name]}"))
            for column in pair for values, axis in [column.axis()])
        order = np.flatnonzero(best)[np.argsort(x[best], kind="stable")]
        joined = {"linestyle": "-", "linewidth": 0.8} if len(goals) == 2 else {}
        panels.append(Panel("", x_axis, y_axis, [
            Curve("", x[~best], y[~best], "dots", other),
            Curve("", x[order], y[order], "dots", {**front, **joined})], "", FRONT))
    more, dot = len(pairs) - MAX_PAIRS, {"linestyle": "", "marker": "o"}
    style.save_figure(draw(panels, title=title, key=[
        ("none is better in all", {**dot, **front}), ("other runs that hold", {**dot, **other})],
        notes=[f"{more} further pairs of goals are in table.csv."] if more > 0 else ()), path)


class BranchCurve(NamedTuple):
    """A branch of equilibria."""

    x: Array  # values of the varied field of the scene, [n]
    y: Array  # the quantity at equilibrium, SI, [n]
    stable: Flags  # [n]
    fold: Flags  # turning points of x, [n]


def save_branches(
    path: Path, branches: Sequence[BranchCurve], *, title: str, along: str, quantity: str,
    unit: str,
) -> None:
    """Draw branches of equilibria over ``along``: unstable ones dashed, folds as rings."""
    shown = style.shown_as(unit, *(branch.y for branch in branches))
    marks: list[Mark] = []
    for i, branch in enumerate(branches):
        y, hue = shown.factor * branch.y, {"color": style.hue(i)}
        solid = branch.stable | branch.fold
        beside = np.convolve(~solid, np.ones(3), "same") > 0  # to join the solid parts
        for line, which in (("solid", solid), (UNSTABLE, beside)):
            marks.append(Curve("", branch.x, np.where(which, y, np.nan), "line",
                               {**hue, "linestyle": line}))
        marks.append(Curve("", branch.x[branch.fold], y[branch.fold], "points", {**hue, **FOLD}))
    dark = {"color": style.INK, "linewidth": style.LINE}
    key: list[tuple[str, dict[str, Any]]] = [("stable", dark)]
    if any((~branch.stable & ~branch.fold).any() for branch in branches):
        key.append(("not stable", {**dark, "linestyle": UNSTABLE}))
    if any(branch.fold.any() for branch in branches):
        key.append(("fold", {"color": style.INK, **FOLD}))
    panel = Panel("", Axis(along), Axis(shown.label(quantity)), marks, "", BRANCHES)
    style.save_figure(draw([panel], title=title, key=key), path)
