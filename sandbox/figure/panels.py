"""Panels of a figure: a declarative description and its drawing.

The layout of matplotlib places everything; the figure gets the height that its panels need.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from sandbox.figure import style
from sandbox.numeric import Array

KINDS: dict[str, dict[str, Any]] = {
    "line": {"linewidth": style.LINE},
    "dashed": style.TARGET,
    "points": {"linestyle": "", "marker": "o", "markersize": 4.0, "markerfacecolor": "white",
               "markeredgewidth": 1.1},
    "dots": {"linestyle": "", "marker": "o", "markersize": 3.5, "markeredgewidth": 0},
    "rug": {"linestyle": "", "marker": "|", "markersize": 8},
}  # line properties by kind of curve
MANY_POINTS, APART = 30, 0.045
"""With more points than this, those closer than this share of the panel are skipped."""
PLANE = 70.0  # height of panels with equal scales [mm]


@dataclass(frozen=True)
class Axis:
    """An axis of a panel."""

    label: str = ""  # with its unit
    log: bool = False
    words: Sequence[str] = ()  # texts of ticks
    ticks: Sequence[float] = ()  # places of the texts; 0, 1, … by default
    limits: tuple[float, float] | None = None


class Curve(NamedTuple):
    """Points (x, y), shape [n] each."""

    label: str  # empty for a curve without a name
    x: Array
    y: Array
    kind: Literal["line", "dashed", "points", "dots", "rug"] = "line"
    """A ``rug`` is strokes at the bottom of the panel."""
    look: Mapping[str, Any] = {}
    """Properties of the line that differ from those of the kind; with a colour, all is given."""


Mark = Curve | Callable[[Any], object]
"""A curve, or what else is drawn, such as a histogram: called with the axes of matplotlib."""


def upright(x: float, **look: Any) -> Mark:
    """A vertical line."""
    return lambda axes: axes.axvline(
        x, **{"color": style.GREY, "linewidth": 0.8, "zorder": 1.5, **look})


@dataclass(frozen=True)
class Panel:
    """Marks over two axes."""

    title: str = ""
    x: Axis = Axis()
    y: Axis = Axis()
    marks: Sequence[Mark] = ()
    names: Literal["above", "inside", ""] = "above"  # place of the curves' names
    height: float = 38.0  # of its axes [mm]
    plane: bool = False  # whether both axes have one scale, so that a circle is round
    grid: Literal["both", "x", ""] = "both"

    @property
    def curves(self) -> list[Curve]:
        """Its curves."""
        return [mark for mark in self.marks if isinstance(mark, Curve)]


def draw(
    panels: Sequence[Panel] | Sequence[Sequence[Panel]], *, title: str = "",
    key: Sequence[tuple[str, Mapping[str, Any]]] = (), notes: Sequence[str] = (),
    width: float = style.WIDTH, shared: bool = False, widths: Sequence[float] | None = None,
) -> Any:
    """A ``matplotlib`` figure of panels one below the other, or of rows of panels.

    ``key`` are names above the panels and their line properties; ``notes`` are lines below them;
    ``width`` is in mm. ``shared``: the panels of a column share their x axis; ``widths`` are ratios
    of the widths of the columns.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    rows = [[row] if isinstance(row, Panel) else list(row) for row in panels]
    figure = style.new_figure(250.0 * len(rows), width)
    grid = figure.subplots(len(rows), len(rows[0]), squeeze=False, width_ratios=widths,
                           sharex="col" if shared else "none",
                           sharey="row" if len(rows[0]) > 1 else "none")
    heights, shown = [], list[str]()
    for row, all_axes in zip(rows, grid, strict=True):
        heights.append(0.0)
        for panel, axes in zip(row, all_axes, strict=True):
            _dress(axes, panel, width / len(row), bottom=not shared or row is rows[-1])
            names = _fill(axes, panel)
            heights[-1] = max(heights[-1], PLANE if panel.plane else panel.height)
            if not panel.names or not names:
                continue
            above, shown = shown, [name for name, _ in names]
            if shown == above:  # a legend is not repeated below
                continue
            if panel.names == "inside":
                style.legend(axes, names, loc="best")
            else:  # below the title
                head = axes.get_title(loc="left")
                axes.set_title("", loc="left")
                style.legend(axes, names, width - 12.0, loc="lower left", title=head,
                             bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1,
                             title_fontsize=style.PLAIN)
    head = style.in_lines(title, width, style.HEAD, style.BOLD)
    if key:
        artists = [(name, Patch(color=look["facecolor"]) if "facecolor" in look else
                    Line2D([], [], **look)) for name, look in key]
        style.legend(figure, artists, width - 6, loc="outside upper left", borderaxespad=0.3,
                     title=head, title_fontproperties={"size": style.HEAD, "weight": "bold"})
    elif head:
        figure.suptitle(head, x=0.01, ha="left", fontsize=style.HEAD, color=style.INK,
                        fontweight="bold")
    if notes:
        figure.supxlabel("\n".join(style.in_lines(note, width, style.SMALL) for note in notes),
                         x=0.01, ha="left", fontsize=style.SMALL, color=style.QUIET)
    figure.draw_without_rendering()  # each row of panels gets its own height
    missing = sum(heights) * style.MM - sum(
        row[0].get_window_extent().height for row in grid) / figure.dpi
    figure.set_figheight(figure.get_figheight() + missing)
    grid[0, 0].get_gridspec().set_height_ratios(heights)
    return figure


def _dress(axes: Any, panel: Panel, width: float, *, bottom: bool) -> None:
    text = {"fontsize": style.SMALL, "color": style.INK}
    if panel.title:
        axes.set_title(style.plain(panel.title), loc="left", pad=5,
                       **{**text, "fontsize": style.PLAIN})
    axes.set_ylabel(style.plain(panel.y.label), **text)
    label = style.in_lines(panel.x.label.replace(".", ". "), width, style.SMALL)
    axes.set_xlabel(label.replace(". ", ".") if bottom else "", **text)
    axes.tick_params(labelsize=style.SMALL, colors=style.INK, which="both", length=2.5)
    axes.tick_params(which="minor", length=1.5)
    axes.set_axisbelow(True)
    if panel.grid:
        axes.grid(color=style.FAINT, linewidth=0.6, axis=panel.grid)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.set_offset_position("right")
    for axis in (axes.xaxis, axes.yaxis):
        axis.offsetText.set(**text)


def _fill(axes: Any, panel: Panel) -> list[tuple[str, Any]]:
    """Draw the marks of a panel; returns names of curves with samples for a legend."""
    lines, names = [], dict[str, Any]()
    labels = list(dict.fromkeys(curve.label for curve in panel.curves))
    for curve in panel.curves:
        how, y, place = dict(KINDS[curve.kind]), curve.y, labels.index(curve.label)
        if "color" not in curve.look:
            how["color"] = style.hue(place)
            if curve.kind == "line":
                how["linestyle"] = style.dash(place)
        if curve.kind == "rug":
            how["transform"], y = axes.get_xaxis_transform(), np.full(len(curve.x), 0.02)
        elif curve.kind == "points" and len(curve.x) > MANY_POINTS and \
                np.isfinite(curve.x + curve.y).all():
            how["markevery"] = APART
        line, = axes.plot(curve.x, y, **{**how, **curve.look})
        if curve.kind == "line":
            lines.append(line)
        if curve.label:
            names.setdefault(curve.label, line)
    for mark in panel.marks:
        if not isinstance(mark, Curve):
            mark(axes)
    _scale(axes, panel)
    style.show_coincident(axes, lines)
    return list(names.items())


def _scale(axes: Any, panel: Panel) -> None:
    for along, axis, one in (("x", axes.xaxis, panel.x), ("y", axes.yaxis, panel.y)):
        some = [curve for curve in panel.curves if along == "x" or curve.kind != "rug"]
        values = np.concatenate([np.empty(0), *(getattr(curve, along) for curve in some)])
        values = values[np.isfinite(values)]
        if one.log:
            getattr(axes, f"set_{along}scale")("log")
        elif along == "y" and not one.words:
            axes.ticklabel_format(axis="y", scilimits=(-3, 5), useMathText=True, useOffset=False)
            if len(values) and one.limits is None and not panel.plane:
                axes.set_ylim(*_roomy(values))
        elif along == "x" and len(values) and (np.mod(values, 1) == 0).all() and not one.words:
            axis.get_major_locator().set_params(integer=True)
        if one.words:
            axis.set_ticks(one.ticks or range(len(one.words)), list(map(style.plain, one.words)))
            axis.set_ticks([], minor=True)
        if one.limits is not None:
            getattr(axes, f"set_{along}lim")(*one.limits)
    if panel.plane:
        axes.set_aspect("equal", adjustable="datalim")
    else:
        axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())


def _roomy(values: Array) -> tuple[float, float]:
    """Limits of a linear axis with a margin around finite values, shape [n], n > 0."""
    low, high = float(values.min()), float(values.max())
    peak, middle = max(abs(low), abs(high)), 0.5 * (low + high)
    span = max(high - low, 1e-3 * peak, 1e-9) if peak > 1e-12 else 1.0  # values below this are zero
    return middle - 0.56 * span, middle + 0.58 * span
