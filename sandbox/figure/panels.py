"""Panels of a figure: a declarative description and its drawing.

The layout of matplotlib places everything; the figure gets the height that its panels need. A curve
named ``joint 1, engine`` shows the result of ``engine`` for ``joint 1``: if curves share the part
before the comma, that part has a colour and the rest a dash or a marker.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np

from sandbox.figure import style
from sandbox.figure.style import take_apart
from sandbox.numeric import Array

KINDS: dict[str, dict[str, Any]] = {
    "line": {"linewidth": style.LINE},
    "dashed": style.TARGET,
    "points": {"linestyle": "", "marker": "o", "markersize": 4.0, "markerfacecolor": "white",
               "markeredgewidth": 1.1},
    "dots": {"linestyle": "", "marker": "o", "markersize": 3.5, "markeredgewidth": 0},
    "rug": {"linestyle": "", "marker": "|", "markersize": 8},
    "joined": {"linewidth": 1.3, "marker": "o", "markersize": 4.5},
}
"""Line properties by kind of curve."""
MARKERS = "os^Dv"
LARGER = 1.8
"""Points of one kind are larger than those of the next by this [pt], since they may coincide."""
MANY_POINTS, APART = 30, 0.045
"""With more points than this, those closer than this share of the panel are skipped."""
READABLE = (1e-3, 1e4)
"""Range of numbers written without powers of ten at logarithmic axes."""
AT_THE_RIGHT = 0.8
"""A curve that ends beyond this share of the panel's width can have its name at its end."""
NARROW_RANGE = 100
"""A logarithmic axis with a smaller ratio of its limits also labels twos and fives."""
POWERS = (-3, 5)
"""Powers of ten between which the numbers of a linear axis are written out."""
MIN_PLANE, MAX_PLANE, PLANE_MARGIN = 38.0, 110.0, 1.14
"""Height of panels with equal scales [mm]; the range shown as a multiple of the values' range."""
ROUNDING = 1e-12
"""Values below this are zero."""
ROW = 1.25 * style.SMALL * style.MM_PER_POINT
"""Height of a label beside a panel [mm]."""


@dataclass(frozen=True)
class Axis:
    """An axis of a panel."""

    label: str = ""
    """With its unit."""
    log: bool = False
    ticks: Sequence[float] = ()
    """Positions of the ticks; matplotlib's choice by default."""
    words: Sequence[str] = ()
    """Texts of the ticks."""
    limits: tuple[float, float] | None = None


class Curve(NamedTuple):
    """Points (x, y), shape [n] each."""

    label: str
    """Empty for a curve without a name."""
    x: Array
    y: Array
    kind: Literal["line", "dashed", "points", "dots", "rug", "joined"] = "line"
    """A ``rug`` is strokes at the bottom of the panel."""
    look: Mapping[str, Any] = {}
    """Properties of the line that differ from those of the kind; with a colour, all is given."""


class Upright(NamedTuple):
    """A vertical line, with a name at the top of the panel."""

    x: float
    name: str = ""
    look: Mapping[str, Any] = {"color": style.GREY, "linewidth": 0.8, "zorder": 1.5}


class Custom(NamedTuple):
    """A mark that matplotlib draws in one call, such as a histogram."""

    draw: Callable[[Any], object]
    """Called with the axes."""


Mark = Curve | Upright | Custom


@dataclass(frozen=True)
class Panel:
    """Marks over two axes."""

    title: str = ""
    x: Axis = Axis()
    y: Axis = Axis()
    marks: Sequence[Mark] = ()
    names: Literal["auto", "side", "above", "inside", ""] = "auto"
    """Place of the curves' names."""
    height: float = 38.0
    """Of its axes [mm]."""
    plane: bool = False
    """Whether both axes have one scale, so that a circle is round."""
    grid: Literal["both", "x", ""] = "both"

    @property
    def curves(self) -> list[Curve]:
        """Its curves."""
        return [mark for mark in self.marks if isinstance(mark, Curve)]

    def values(self, of: Literal["x", "y"]) -> Array:
        """All finite coordinates of its curves."""
        rows = [getattr(curve, of) for curve in self.curves if of == "x" or curve.kind != "rug"]
        values = np.concatenate([np.ravel(row) for row in rows]) if rows else np.empty(0)
        return np.asarray(values[np.isfinite(values)], dtype=float)


@dataclass
class _Drawn:
    """A panel with its axes, and texts that are placed when the layout is known."""

    panel: Panel
    axes: Any
    beside: list[tuple[Any, float]] = field(default_factory=list)
    """Labels at the right, and the values at the ends of their curves."""
    events: list[Any] = field(default_factory=list)
    """Names of vertical lines."""


def save_panels(
    path: Path, panels: Sequence[Panel] | Sequence[Sequence[Panel]], **how: Any,
) -> None:
    """Draw panels into a file; see :func:`draw`.

    Raises:
        OutputError: the file cannot be written.
    """
    style.save_figure(draw(panels, **how), path)


def draw(
    panels: Sequence[Panel] | Sequence[Sequence[Panel]], *, title: str = "",
    key: Sequence[tuple[str, Mapping[str, Any]]] = (), notes: Sequence[str] = (),
    width: float = style.WIDTH, shared: bool = False, widths: Sequence[float] | None = None,
) -> Any:
    """A figure of panels one below the other, or of rows of panels.

    Args:
        panels: at least one.
        title: of the figure.
        key: names above the panels, and the line properties they stand for.
        notes: lines below the panels.
        width: of the figure [mm].
        shared: whether the panels of a column share their x axis.
        widths: ratios of the widths of the columns.

    Returns:
        a ``matplotlib.figure.Figure``.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    rows = [[row] if isinstance(row, Panel) else list(row) for row in panels]
    figure = style.new_figure(50.0 * len(rows), width)
    grid = figure.subplots(len(rows), len(rows[0]), squeeze=False, width_ratios=widths,
                           sharex="col" if shared else "none",
                           sharey="row" if len(rows[0]) > 1 else "none")
    cells, first = [], None
    for row, all_axes in zip(rows, grid, strict=True):
        for panel, axes in zip(row, all_axes, strict=True):
            _dress(axes, panel, bottom=not shared or row is rows[-1])
            drawn, names = _fill(axes, panel)
            words = [name for name, _ in names]
            if names and (panel.names == "above" or words != first):  # above, below its title
                head = axes.get_title(loc="left")
                axes.set_title("", loc="left")
                style.legend(axes, names, width - 12.0, loc="lower left", title=head,
                             bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1,
                             title_fontsize=style.PLAIN)
            first = words if first is None else first  # these names are not repeated below
            cells.append(drawn)
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
    _fit(figure, grid, cells)
    return figure


def _dress(axes: Any, panel: Panel, *, bottom: bool) -> None:
    """Set the title, the labels, the grid and the frame of a panel."""
    text = {"fontsize": style.SMALL, "color": style.INK}
    if panel.title:
        axes.set_title(style.plain(panel.title), loc="left", pad=5,
                       **{**text, "fontsize": style.PLAIN})
    axes.set_ylabel(style.plain(panel.y.label), **text)
    axes.set_xlabel(style.plain(panel.x.label) if bottom else "", **text)
    axes.tick_params(labelsize=style.SMALL, colors=style.INK, which="both", length=2.5)
    axes.tick_params(which="minor", length=1.5)
    axes.set_axisbelow(True)
    if panel.grid:
        axes.grid(color=style.FAINT, linewidth=0.6, axis=panel.grid)
    axes.spines[["top", "right"]].set_visible(False)
    axes.yaxis.set_offset_position("right")
    axes.yaxis.offsetText.set(**text)


def _fill(axes: Any, panel: Panel) -> tuple[_Drawn, list[tuple[str, Any]]]:
    """Draw the marks of a panel; its texts to be placed, and the names left for a legend."""
    looks, drawn = _looks(panel.curves), _Drawn(panel, axes)
    lines = [_plot(axes, *each) for each in zip(panel.curves, looks, strict=True)]
    for mark in panel.marks:
        if isinstance(mark, Custom):
            mark.draw(axes)
        elif isinstance(mark, Upright):
            axes.axvline(mark.x, **mark.look)
            if mark.name:
                drawn.events.append(axes.annotate(
                    style.plain(mark.name), (mark.x, 1.0), xycoords=("data", "axes fraction"),
                    textcoords="offset points", xytext=(2, 0), va="top", fontsize=style.TINY,
                    color=style.QUIET, bbox={"facecolor": "white", "edgecolor": "none",
                                             "pad": 0.5}))
                drawn.events[-1].set_in_layout(False)
    _scale(axes, panel)
    drawn.beside = _beside(axes, panel, looks) if panel.names in ("auto", "side") else []
    take_apart(axes, [line for line, curve in zip(lines, panel.curves, strict=True)
                      if curve.kind == "line"])
    if drawn.beside and panel.names == "auto":
        axes.set_xlim(right=max(np.nanmax(curve.x) for curve in panel.curves))
        _whole_markers(axes, lines, looks)
    left = _key([look for look in looks if look.head],
                {text.get_text() for text, _ in drawn.beside})
    if panel.names == "inside":
        style.legend(axes, left, loc="best")
    return drawn, left if panel.names in ("auto", "above") else []


class _Look(NamedTuple):
    """Name and line properties of a curve."""

    head: str
    tail: str
    """The part of the name behind the comma, if curves share the part before it."""
    how: Mapping[str, Any]


def _plot(axes: Any, curve: Curve, look: _Look) -> Any:
    few = {"markevery": APART} if curve.kind == "points" and len(curve.x) > MANY_POINTS and \
        np.isfinite(curve.x + curve.y).all() else {}
    if curve.kind == "rug":
        few = {"transform": axes.get_xaxis_transform()}
    y = np.full(len(curve.x), 0.02) if curve.kind == "rug" else curve.y
    return axes.plot(curve.x, y, **look.how, **few)[0]


def _looks(curves: Sequence[Curve]) -> list[_Look]:
    """Line properties of curves: a colour by head, a dash or a marker by tail."""
    split = [(head, tail.strip()) for head, _, tail in (c.label.partition(",") for c in curves)]
    heads = [head for head, _ in split]
    shared = any(head and heads.count(head) > 1 for head in heads)
    if not shared:
        split = [(curve.label, "") for curve in curves]
    order = list(dict.fromkeys(head for head, _ in split))
    manners = {kind: list(dict.fromkeys(
        tail if shared else head for curve, (head, tail) in zip(curves, split, strict=True)
        if curve.kind == kind)) for kind in ("line", "points", "joined")}
    looks = []
    for curve, (head, tail) in zip(curves, split, strict=True):
        how = {**KINDS[curve.kind], **curve.look}
        if "color" not in how:
            place, mine = order.index(head), manners.get(curve.kind, [])
            rank = mine.index(tail if shared else head) if mine else 0
            how["color"] = style.hue(place)
            if curve.kind == "line":
                how["linestyle"] = (style.DASHES[rank % len(style.DASHES)] if shared
                                    else style.dash(place))
            elif mine:
                how["marker"] = MARKERS[rank % len(MARKERS)]
                how["markersize"] += LARGER * (len(mine) - 1 - rank) * (curve.kind == "points")
        looks.append(_Look(head, tail, how))
    return looks


def _key(looks: Sequence[_Look], named: set[str]) -> list[tuple[str, Any]]:
    """Names and samples of a legend: heads in their colours, then tails without a colour."""
    from matplotlib.lines import Line2D

    heads: dict[str, Any] = {}
    tails: dict[str, Any] = {}
    for look in looks:
        if look.tail and sum(other.head == look.head for other in looks) > 1:
            heads.setdefault(look.head, Line2D([], [], color=look.how["color"], linewidth=3.0))
            tails.setdefault(look.tail, Line2D([], [], **{**look.how, "color": style.INK}))
        else:
            name = f"{look.head}, {look.tail}" if look.tail else look.head
            heads.setdefault(name, Line2D([], [], **look.how))
    return [(name, sample) for name, sample in {**heads, **tails}.items()
            if name and style.plain(name) not in named]


def _beside(axes: Any, panel: Panel, looks: Sequence[_Look]) -> list[tuple[Any, float]]:
    """Labels at the ends of curves; by ``auto`` only if there are several, all at the right."""
    to_axes = axes.transScale + axes.transLimits
    found: dict[str, tuple[float, Any]] = {}
    for curve, look in zip(panel.curves, looks, strict=True):
        finite = np.flatnonzero(np.isfinite(curve.x + curve.y))
        if not look.head or look.head in found:
            continue
        end = (curve.x[finite[-1]], curve.y[finite[-1]]) if len(finite) else (0.0, 0.0)
        if panel.names == "auto":
            # one that is vertical ends at no particular height
            if curve.kind == "points" or not len(finite) or np.ptp(curve.x[finite]) == 0:
                continue
            if to_axes.transform(end)[0] < AT_THE_RIGHT:
                return []
        found[look.head] = (float(end[1]), look.how["color"])
    if panel.names == "auto" and len(found) < 2:
        return []
    return [(axes.annotate(style.plain(name), (1.0, 0.5), xycoords="axes fraction", xytext=(6, 0),
                           textcoords="offset points", va="center", fontsize=style.SMALL,
                           color=colour, annotation_clip=False), y)
            for name, (y, colour) in found.items()]


def _whole_markers(axes: Any, lines: Sequence[Any], looks: Sequence[_Look]) -> None:
    """Draw markers at the right end again without clipping."""
    (left, right), (low, high) = sorted(axes.get_xlim()), sorted(axes.get_ylim())
    for line, look in zip(lines, looks, strict=True):
        x, y = line.get_xydata().T
        last = (x >= right - 1e-9 * (right - left)) & (y >= low) & (y <= high)
        if "marker" in look.how and last.any():
            axes.plot(x[last], y[last], scalex=False, scaley=False, clip_on=False, **{
                **look.how, "linestyle": ""})


def _scale(axes: Any, panel: Panel) -> None:
    """Set scales, limits and ticks."""
    for along, axis, one, values in (("x", axes.xaxis, panel.x, panel.values("x")),
                                     ("y", axes.yaxis, panel.y, panel.values("y"))):
        if one.log:
            getattr(axes, f"set_{along}scale")("log")
            _log_numbers(axis, values)
        elif along == "y" and not one.words and not one.ticks:
            axes.ticklabel_format(axis="y", scilimits=POWERS, useMathText=True, useOffset=False)
            if len(values) and one.limits is None and not panel.plane:
                axes.set_ylim(*roomy(values))
        elif along == "x" and len(values) and (np.mod(values, 1) == 0).all() and not one.words:
            axis.get_major_locator().set_params(integer=True)
        if one.ticks or one.words:
            axis.set_ticks(one.ticks or range(len(one.words)),
                           labels=[style.plain(word) for word in one.words] or None)
            axis.set_minor_formatter("")
        if one.limits is not None:
            getattr(axes, f"set_{along}lim")(*one.limits)
    if not panel.plane:
        axes.set(xlim=axes.get_xlim(), ylim=axes.get_ylim())


def _log_numbers(axis: Any, values: Array) -> None:
    """Numbers of a logarithmic axis, as powers of ten only where they are hard to read else."""
    if len(values) and ((values > READABLE[0]) & (values < READABLE[1])).all():
        leading = "25" if values.max() <= NARROW_RANGE * values.min() else ""
        axis.set_major_formatter(lambda value, _: style.number(value))
        axis.set_minor_formatter(
            lambda value, _: style.number(value) if f"{value:e}"[0] in leading else "")


def roomy(values: Array) -> tuple[float, float]:
    """Limits of a linear axis with a margin around finite values, shape [n], n > 0."""
    low, high = float(values.min()), float(values.max())
    peak, middle = max(abs(low), abs(high)), 0.5 * (low + high)
    span = max(high - low, 1e-3 * peak, 1e-9) if peak > ROUNDING else 1.0
    low, high = min(low, middle - 0.5 * span), max(high, middle + 0.5 * span)
    return low - 0.06 * span, high + 0.08 * span


def _fit(figure: Any, grid: Any, cells: Sequence[_Drawn]) -> None:
    """Set the height of a figure so that each panel has its own, then place the texts."""
    columns, planes = grid.shape[1], [cell for cell in cells if cell.panel.plane]
    figure.draw_without_rendering()
    sizes = [cell.axes.get_window_extent() for cell in cells]
    heights = [max(cell.panel.height, ROW * len(cell.beside)) for cell in cells]
    if planes:  # limits of x so that all have one scale
        width = sizes[0].width / figure.dpi / style.MM
        x = np.concatenate([cell.panel.values("x") for cell in planes])
        spans = [float(np.ptp(cell.panel.values("y"))) if cell.panel.plane else 0.0
                 for cell in cells]
        scale = PLANE_MARGIN * max(float(np.ptp(x)) / width, max(spans) / MAX_PLANE)
        middle, half = 0.5 * float(x.min() + x.max()), 0.5 * scale * width
        for cell in planes:
            cell.axes.set_xlim(middle - half, middle + half)
        heights = [min(max(PLANE_MARGIN * span / scale, MIN_PLANE), MAX_PLANE)
                   if cell.panel.plane else high
                   for cell, span, high in zip(cells, spans, heights, strict=True)]
    wanted = [max(heights[i:i + columns]) for i in range(0, len(cells), columns)]
    missing = sum(wanted) * style.MM - sum(size.height for size in sizes[::columns]) / figure.dpi
    figure.set_figheight(figure.get_figheight() + missing)
    grid[0, 0].get_gridspec().set_height_ratios(wanted)
    for _ in range(2 if planes else 0):  # new ticks may change the width
        figure.draw_without_rendering()
        for cell in planes:
            size, y = cell.axes.get_window_extent(), cell.panel.values("y")
            high = 0.5 * float(np.ptp(cell.axes.get_xlim())) * size.height / size.width
            centre = 0.5 * float(y.min() + y.max())
            cell.axes.set_ylim(centre - high, centre + high)
    for i, (cell, size) in enumerate(zip(cells, sizes, strict=True)):
        _place_events(cell, wanted[i // columns] * style.MM * figure.dpi, size.width)
        if cell.beside:
            _place_beside(cell, wanted[i // columns])


def _place_beside(cell: _Drawn, height: float) -> None:
    """Move labels at the right apart where they would overlap."""
    gap, to_axes = ROW / height, cell.axes.transScale + cell.axes.transLimits
    right = cell.axes.get_xlim()[1]
    ends = np.array([to_axes.transform((right, y))[1] for _, y in cell.beside])
    places = style.apart(np.clip(ends, 0.0, 1.0), gap)
    if len(places) * gap <= 1:
        places += max(0.0, -places.min()) - max(0.0, places.max() - 1.0)
    for (label, _), at in zip(cell.beside, places.tolist(), strict=True):
        label.xy = (1.0, at)


def _place_events(cell: _Drawn, height: float, width: float) -> None:
    """Put names of vertical lines in rows without overlap, with space for them at the top."""
    taken: list[tuple[int, float, float]] = []
    (low, high), axes = cell.axes.get_xlim(), cell.axes
    for label in cell.events:
        box = label.get_window_extent()
        at, wide = (label.xy[0] - low) / (high - low), box.width / width + 0.02
        right = at + wide <= 1 or at < 0.5
        start, stop = (at, at + wide) if right else (at - wide, at)
        row = next(row for row in itertools.count() if not any(
            row == other and start < end and begin < stop for other, begin, end in taken))
        taken.append((row, start, stop))
        label.set(ha="left" if right else "right")
        label.xy = (label.xy[0], 1 - 1.15 * box.height / height * row)
        label.xyann = (2 if right else -2, 0)
    if taken:
        room = 1.2 * cell.events[0].get_window_extent().height / height
        low, high = axes.get_ylim()
        axes.set_ylim(low, low + (high - low) / (1 - room * (1 + max(row for row, *_ in taken))))
