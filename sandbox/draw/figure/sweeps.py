"""What came of a sweep, in the figure that fits what was varied, as PNG, SVG or PDF.

One path: curves over it, or points where it was drawn at random, with a distribution beside them.
Two paths, each value with each: a curve for each value of one that has few, or else a map of each
quantity, without those that are the same in all runs, of which a note tells. Anything else: each
quantity over each path. Runs that did not come to their end are ticks at the bottom, or crosses;
those of which the audit asks for a look are rings; points of those that fail what must hold have
another colour.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Flags

MOST = 12
"""Quantities of one figure; a note says how many more there are."""
PANEL, SURROUND, MAP = 44.0, 16.0, 56.0
"""Height of a panel and of what is about all of them, and of a map [mm]."""
CELL, CELLS_WIDE = 30.0, 6
"""Height of a panel among many [mm]; paths that have a column."""
MANY = 60
"""More points than this are small."""
LINES = 3
"""Values of one of two paths that are curves; of more values there is a map."""
FEW = 8
"""Values of a path that are all written at its axis, ..."""
ROOM = 0.06
"""... if they are so far from each other, as a share of the whole, ..."""
DIGITS = 4
"""... and have no more digits than these."""
ROUNDING = 1e-9
"""What spreads by less than this share of itself is one value."""
CROWD = 3000
"""More points than this are drawn as their density, ..."""
SHADES = "Blues"
"""... darker where there are more."""
BINS = "auto"
"""Of distributions: numpy's rule, the larger of Sturges' and Freedman and Diaconis' numbers."""
COLOURS = "cividis"
"""Of maps: even in lightness, and the same to those who see fewer colours (Nuñez et al., 2018)."""


@dataclass(frozen=True)
class SweepColumn:
    """A column of a sweep's table."""

    name: str
    unit: str
    """SI; empty for none."""
    values: Array
    """Shape [n]; nan for what has no value. Of texts, the number of the text."""
    texts: tuple[str, ...] = ()
    """Those that numbers stand for, in their order; empty of numbers."""
    log: bool = False
    """Whether its values lie in even ratios."""

    def shown(self) -> tuple[Array, str]:
        """Values as they are plotted, and their unit in brackets."""
        if self.texts:
            return self.values, ""
        how = style.shown_as(self.unit, self.values)
        return self.values * how.factor, f"[{how.unit}]" if how.unit else ""

    def labelled(self) -> tuple[Array, str]:
        """Values as they are plotted, and the label of their axis."""
        values, unit = self.shown()
        return values, f"{self.name} {unit}".strip()


@dataclass(frozen=True)
class FoundLine:
    """What a search found on the axis of a path, SI."""

    path: str
    low: float
    """Of the bracket, or of the 95 % interval, which is shaded."""
    at: float
    """Where the line is."""
    high: float
    words: str
    """What the line and the shade are."""


@dataclass(frozen=True)
class SweepDrawing:
    """What a figure of a sweep shows."""

    varied: Sequence[SweepColumn]
    kept: Sequence[SweepColumn]
    failed: Flags
    """Runs that did not come to their end, [n]."""
    doubtful: Flags
    """Runs of which the audit asks for a look, [n]."""
    grid: bool
    """Whether every value of each path meets every value of the others."""
    title: str = ""
    held: Array | None = None
    """1 of runs of which holds what must, 0 of those that fail it, nan of others, [n]."""
    condition: str = ""
    """What must hold."""
    meanings: Mapping[str, str] = field(default_factory=dict)
    """What stands behind names of what is kept: ``{"ratio": "tip / pull"}``."""
    found: FoundLine | None = None

    @property
    def scattered(self) -> bool:
        """Whether runs are points, and neither curves nor a map."""
        return not (self.grid and len(self.varied) <= 2)


def draw_sweep(path: Path, drawing: SweepDrawing) -> None:
    """Draw a sweep.

    Raises:
        OutputError: the file cannot be written.
        ValueError: nothing was varied or kept, or another ending than ``.png .svg .pdf``.
    """
    if not drawing.varied or not drawing.kept:
        raise ValueError("a figure shows what was varied and what was kept")
    kept = drawing.kept[:MOST]
    if len(drawing.varied) == 1:
        figure = _curves(drawing, kept)
    elif len(drawing.varied) == 2 and drawing.grid:
        level = {column.name for column in _level(drawing)}
        figure = _lines(drawing, kept) if _few(drawing.varied) is not None else _maps(
            drawing, [column for column in kept if column.name not in level])
    else:
        figure = _each_over_each(drawing, kept)
    style.title(figure, drawing.title)
    if notes := _notes(drawing):
        style.footnote(figure, notes)
    style.save_figure(figure, path)


def _notes(drawing: SweepDrawing) -> str:
    shown = {column.name for column in drawing.kept[:MOST]}
    notes = [style.plain("; ".join(f"{name} = {meaning}" for name, meaning in
                                   drawing.meanings.items() if name in shown))]
    if drawing.found:
        notes.append(style.plain(drawing.found.words))
    if level := [style.plain(_everywhere(column)) for column in _level(drawing)]:
        ended = " that came to their end" * bool(drawing.failed.any())
        notes.append(f"{', '.join(level)} in all runs{ended}.")
    if missed := int(np.count_nonzero(_missed(drawing))):
        notes.append(style.plain(
            f"{missed} of {len(drawing.failed)} runs fail {drawing.condition}: orange."))
    if lost := int(np.count_nonzero(drawing.failed)):
        notes.append(f"{lost} of {len(drawing.failed)} runs did not come to their end: red.")
    if asked := int(np.count_nonzero(drawing.doubtful)):
        notes.append(f"{asked} runs have an audit that asks for a look: rings.")
    if len(drawing.failed) > CROWD and drawing.scattered:
        notes.append("The darker, the more runs, by a logarithmic scale.")
    if (more := len(drawing.kept) - MOST) > 0:
        notes.append(f"{more} further quantities are in the table only.")
    return "\n".join(filter(None, [notes[0], " ".join(notes[1:])]))


def _level(drawing: SweepDrawing) -> list[SweepColumn]:
    """What is the same in all runs that came to their end, or there in none, and has no map.

    Where that is so of all that was kept, the first has one.
    """
    kept = drawing.kept[:MOST]
    if drawing.scattered or len(drawing.varied) < 2 or _few(drawing.varied) is not None:
        return []
    ended = ~drawing.failed
    level = [column for column in kept if not np.isfinite(column.values).any() or (
        _one_value(column.values) and np.isfinite(column.values[ended]).all())]
    return level[1:] if len(level) == len(kept) else level


def _everywhere(column: SweepColumn) -> str:
    """What such a column is in all runs."""
    values, unit = column.shown()
    if not np.isfinite(values).any():
        return f"{column.name} without a value"
    value = style.number(float(np.nanmedian(values)))
    return f"{column.name} = {value} {unit.strip('[]')}".rstrip()


def _missed(drawing: SweepDrawing) -> Flags:
    """Runs that fail what must hold, [n]; none where points have no colours of their own."""
    if drawing.held is None or not drawing.scattered or len(drawing.failed) > CROWD:
        return np.zeros(len(drawing.failed), dtype=bool)
    return np.asarray(drawing.held == 0, dtype=bool)


def _curves(drawing: SweepDrawing, kept: Sequence[SweepColumn]) -> Any:
    varied = drawing.varied[0]
    figure = style.new_figure(PANEL * len(kept) + SURROUND)
    wide = None if drawing.grid else (3.0, 1.0)
    grid = figure.subplots(len(kept), 2 if wide else 1, sharex="col", sharey="row", squeeze=False,
                           width_ratios=wide)
    for place, column in enumerate(kept):
        axes, last = grid[place][0], place == len(kept) - 1
        x, label = varied.labelled()
        y, unit = column.shown()
        style.dress(axes, column.name, unit, x=label if last else "")
        style.powers(axes)
        _points(axes, drawing, x, y, joined=drawing.grid and not varied.texts)
        _scale(axes, varied, x)
        _found(axes, drawing, varied)
        if wide:
            style.dress(grid[place][1], "", "", x="runs" if last else "")
            _spread(grid[place][1], y)
    return figure


def _few(varied: Sequence[SweepColumn]) -> int | None:
    """Which of two paths has so few values that each is a curve over the other; None if neither."""
    counts = [len(np.unique(column.values)) for column in varied]
    return min((place for place in (0, 1) if counts[place] <= LINES), default=None,
               key=lambda place: (not varied[place].texts, counts[place]))


def _lines(drawing: SweepDrawing, kept: Sequence[SweepColumn]) -> Any:
    """A curve over one path for each of the few values of the other."""
    from matplotlib.lines import Line2D

    few = _few(drawing.varied) or 0
    varied, other = drawing.varied[1 - few], drawing.varied[few]
    (x, label), (values, unit) = varied.labelled(), other.shown()
    figure = style.new_figure(PANEL * len(kept) + SURROUND)
    grid = figure.subplots(len(kept), squeeze=False, sharex=True)[:, 0]
    each = np.unique(values)
    for place, column in enumerate(kept):
        axes = grid[place]
        y, in_unit = column.shown()
        style.dress(axes, column.name, in_unit, x=label if place == len(kept) - 1 else "")
        style.powers(axes)
        for k, value in enumerate(each):
            _points(axes, drawing, x, y, joined=not varied.texts, some=values == value,
                    colour=style.hue(k))
        _scale(axes, varied, x)
    named = [other.texts[int(value)] if other.texts else
             f"{style.number(value)} {unit.strip('[]')}".strip() for value in each]
    style.legend(grid[0], [Line2D([], [], color=style.hue(k)) for k in range(len(each))],
                 [style.plain(f"{other.name} = {name}") for name in named], loc="best")
    return figure


def _points(
    axes: Any, drawing: SweepDrawing, x: Array, y: Array, *, joined: bool,
    some: Flags | None = None, colour: str = style.BLUE,
) -> None:
    """Runs, or some of them, as points, joined or not; a crowd of them as their density."""
    if len(x) > CROWD and not joined:
        there = np.isfinite(x) & np.isfinite(y)
        if there.any():
            axes.hist2d(x[there], y[there], bins=(120, 80), cmap=SHADES, cmin=1, norm="log")
        return
    here = np.ones(len(x), dtype=bool) if some is None else some
    size = 3.5 if len(x) <= MANY else 1.8
    missed = _missed(drawing)
    for which, ink in ((here & ~missed, colour), (here & missed, style.ORANGE)):
        order = np.flatnonzero(which)[np.argsort(x[which], kind="stable")]
        axes.plot(x[order], y[order], color=ink, linewidth=style.LINE, marker="o",
                  markersize=size if len(x) <= MANY or not joined else 0,
                  linestyle="-" if joined else "", markeredgewidth=0,
                  alpha=1.0 if joined else 0.75)
    style.roomy(axes, y)
    look = here & drawing.doubtful
    axes.plot(x[look], y[look], linestyle="", marker="o", markersize=size + 3.5,
              markerfacecolor="none", markeredgecolor=style.INK, markeredgewidth=1.0)
    lost = here & drawing.failed
    axes.plot(x[lost], np.full(np.count_nonzero(lost), 0.02), linestyle="", marker="|",
              markersize=8, color=style.RED, transform=axes.get_xaxis_transform())


def _found(axes: Any, drawing: SweepDrawing, varied: SweepColumn) -> None:
    """What a search found on this path: a line, and where it may lie."""
    found = drawing.found
    if found is None or found.path != varied.name:
        return
    factor = style.shown_as(varied.unit, varied.values).factor
    axes.axvspan(factor * found.low, factor * found.high, color=style.BAND, zorder=0.5)
    axes.axvline(factor * found.at, color=style.INK, zorder=0.8, **style.TARGET)


def _scale(
    axes: Any, varied: SweepColumn, shown: Array, along: str = "x", *, most: int = FEW,
) -> None:
    """The scale of an axis, and its ticks where these are texts or few numbers."""
    axis = getattr(axes, f"{along}axis")
    if varied.texts:
        axis.set_ticks(range(len(varied.texts)), [style.plain(text) for text in varied.texts])
        return
    places = np.unique(shown[np.isfinite(shown)])
    if varied.log:
        getattr(axes, f"set_{along}scale")("log")
        axis.set_minor_formatter("")
    if 0 < len(places) <= most and (varied.log or _told_apart(places)):
        axis.set_ticks(places, [style.number(place, DIGITS) for place in places])


def _told_apart(places: Array) -> bool:
    """Whether rising numbers, [n], n > 0, are round, and far enough apart to be written."""
    rounded = np.array([float(style.number(place, DIGITS)) for place in places])
    return bool(np.allclose(rounded, places, rtol=ROUNDING, atol=0)) and (
        len(places) == 1 or bool(np.diff(places).min() > ROOM * np.ptp(places)))


def _one_value(values: Array) -> bool:
    """Whether values, nan apart, are one but for rounding; not where there are none."""
    finite = values[np.isfinite(values)]
    return bool(len(finite) and np.ptp(finite) <= ROUNDING * np.abs(finite).max())


def _spread(axes: Any, y: Array) -> None:
    """A distribution beside the points, on their scale: how many runs came out so."""
    finite = y[np.isfinite(y)]
    if len(finite) and not _one_value(finite):
        axes.hist(finite, bins=BINS, orientation="horizontal", color=style.BLUE, alpha=0.75)


def _maps(drawing: SweepDrawing, kept: Sequence[SweepColumn]) -> Any:
    figure = style.new_figure(MAP * len(kept) + SURROUND)
    grid = figure.subplots(len(kept), squeeze=False, sharex=True)
    one, other = drawing.varied
    for place, column in enumerate(kept):
        _map(figure, grid[place][0], drawing, one, other, column)
        if place < len(kept) - 1:
            grid[place][0].set_xlabel("")
    return figure


def _map(
    figure: Any, axes: Any, drawing: SweepDrawing, one: SweepColumn, other: SweepColumn,
    column: SweepColumn,
) -> None:
    (x, x_label), (y, y_label) = one.labelled(), other.labelled()
    z, label = column.labelled()
    xs, i = np.unique(x, return_inverse=True)
    ys, j = np.unique(y, return_inverse=True)
    cells = np.full((len(ys), len(xs)), np.nan)
    single = _one_value(z)
    cells[j, i] = np.where(np.isfinite(z), np.nanmedian(z), np.nan) if single else z
    mesh = axes.pcolormesh(_edges(xs, log=one.log), _edges(ys, log=other.log), cells, cmap=COLOURS,
                           edgecolors="face", linewidth=0.1)
    style.dress(axes, label, y_label, x=x_label)
    axes.grid(visible=False)
    bar = figure.colorbar(mesh, ax=axes)
    if single:
        bar.set_ticks([float(np.nanmedian(z))], labels=[style.number(float(np.nanmedian(z)))])
    bar.ax.tick_params(labelsize=style.SMALL, colors=style.INK)
    bar.outline.set_visible(False)
    lost, look = drawing.failed, drawing.doubtful
    axes.plot(x[lost], y[lost], linestyle="", marker="x", markersize=4, color=style.RED)
    axes.plot(x[look], y[look], linestyle="", marker="o", markersize=4, markerfacecolor="none",
              markeredgecolor=style.ORANGE)
    _scale(axes, one, x)
    _scale(axes, other, y, "y")


def _edges(centres: Array, *, log: bool) -> Array:
    """Borders of cells about rising centres, [n] to [n + 1]; in the middle between them."""
    if len(centres) == 1:
        return np.array([centres[0] - 0.5, centres[0] + 0.5])
    at = np.log(centres) if log else centres
    inside = 0.5 * (at[1:] + at[:-1])
    edges = np.concatenate([[2 * at[0] - inside[0]], inside, [2 * at[-1] - inside[-1]]])
    return np.exp(edges) if log else edges


def _each_over_each(drawing: SweepDrawing, kept: Sequence[SweepColumn]) -> Any:
    varied = drawing.varied[:CELLS_WIDE]
    figure = style.new_figure(CELL * len(kept) + SURROUND)
    grid = figure.subplots(len(kept), len(varied), squeeze=False, sharex="col", sharey="row")
    for place, column in enumerate(kept):
        y, name = column.labelled()
        for axes, one in zip(grid[place], varied, strict=True):
            x, label = one.labelled()
            style.dress(axes, "", name if axes is grid[place][0] else "",
                        x=label if place == len(kept) - 1 else "")
            _points(axes, drawing, x, y, joined=False)
            _found(axes, drawing, one)
            _scale(axes, one, x, most=2 * FEW // (1 + len(varied)))
    return figure
