"""Maps of reachable poses, and the pulls at which a pose can be held, as PNG, SVG or PDF.

It draws what it is given: rectangles, curves and a target in planes of two
angles; bars over an axis of pulls. Which poses those are is computed elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.figure.panels import DPI, FAINT, INK
from sandbox.whole_files import written_whole

Array = NDArray[np.float64]
Rectangle = tuple[float, float, float, float]
"""Lowest and highest x, lowest and highest y."""
THIN = 0.006
"""Of an axis: a rectangle that is thinner is drawn as a line, so that a stop can be seen."""
FADED = "#5b6673"


@dataclass(frozen=True)
class Region:
    """What one way of doing it reaches in a plane: rectangles, or a curve x, y."""

    label: str
    colour: str
    rectangles: Sequence[Rectangle] = ()
    x: Array | None = None
    y: Array | None = None
    outline: bool = False
    """Only the outline of the rectangles, or a dashed curve: a variant."""


@dataclass(frozen=True)
class Plane:
    """A map of two angles."""

    x: str
    y: str
    width: float
    """Highest x shown; a note says what lies beyond it."""
    height: float
    regions: Sequence[Region]
    target: tuple[float, float]
    stops: tuple[float, float]
    """Where x and y end mechanically."""


@dataclass(frozen=True)
class Column:
    """Maps of one condition, one below the other."""

    title: str
    verdicts: Sequence[tuple[str, str]]
    """Lines under the title, each with its colour."""
    planes: Sequence[Plane]


@dataclass(frozen=True)
class Bar:
    """A range on the axis of pulls; ``group`` names what belongs together."""

    group: str
    label: str
    colour: str
    low: float
    high: float


def save_maps(path: Path, columns: Sequence[Column]) -> None:
    """Draw columns of maps side by side, with one legend above all.

    Raises:
        OutputError: it cannot be written.
        ValueError: no columns, or columns of unequal numbers of planes.
    """
    rows = {len(column.planes) for column in columns}
    if len(rows) != 1:
        raise ValueError("columns must all hold the same number of planes, got "
                         + (", ".join(map(str, sorted(rows))) or "none"))
    from matplotlib.figure import Figure

    count = rows.pop()
    figure = Figure(figsize=(3.7 * len(columns) + 0.3, 3.1 * count + 1.35), dpi=DPI)
    grid = figure.subplots(count, len(columns), squeeze=False)
    figure.subplots_adjust(left=0.07, right=0.985, bottom=0.08, top=0.79, wspace=0.24, hspace=0.3)
    for j, column in enumerate(columns):
        for i, plane in enumerate(column.planes):
            _plane(grid[i][j], plane)
        _head(grid[0][j], column)
    handles = _handles(columns[0].planes[0].regions)
    figure.legend(handles=handles, loc="upper center", ncols=3, fontsize=8.5, frameon=False,
                  labelcolor=INK, columnspacing=2.2)
    _save(figure, path)


def save_bars(path: Path, bars: Sequence[Bar], *, title: str, x: str, right: float,
              marks: Sequence[float], notes: Sequence[tuple[str, str]]) -> None:
    """Draw ranges of one quantity as rows of bars; what a group shares is shaded.

    Args:
        path: the file, its format by its ending.
        bars: in order from above.
        title: above the figure.
        x: label of the axis, with its unit.
        right: its end; longer bars go on as arrows.
        marks: values that are marked on it.
        notes: for each group, in order, its colour and what is said beside its name.

    Raises:
        OutputError: it cannot be written.
        ValueError: no bars.
    """
    if not bars:
        raise ValueError("bars must hold at least one, got none")
    from matplotlib.figure import Figure

    groups = list(dict.fromkeys(bar.group for bar in bars))
    rows = len(bars) + 1.3 * len(groups)
    figure = Figure(figsize=(7.6, 0.27 * rows + 1.1), dpi=DPI, layout="constrained")
    axes = figure.subplots()
    names: list[tuple[float, str]] = []
    y = 0.0
    for group, (colour, note) in zip(groups, notes, strict=True):
        axes.text(0.012 * right, y + 0.05, f"{group}: {note}", fontsize=8.5, color=colour,
                  va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
        mine = [bar for bar in bars if bar.group == group]
        _common(axes, mine, y)
        for bar in mine:
            y += 1
            axes.barh(y, min(bar.high, right) - bar.low, left=bar.low, height=0.62,
                      color=bar.colour)
            if bar.high > right:
                axes.annotate("→", (right, y), fontsize=10, color=bar.colour, va="center_baseline",
                              annotation_clip=False)
            names.append((y, bar.label))
        y += 1.3
    axes.set_yticks([at for at, _ in names], labels=[name for _, name in names])
    axes.set_xlim(0, right)
    axes.set_ylim(y - 0.5, -0.6)
    for mark in marks:
        axes.axvline(mark, color=FADED, linewidth=0.8, linestyle=(0, (2, 3)), zorder=0)
    axes.set_title(title, fontsize=10, color=INK, loc="left")
    axes.set_xlabel(x, fontsize=9, color=INK)
    _plain(axes)
    _save(figure, path)


def _common(axes: Any, bars: Sequence[Bar], y: float) -> None:
    low, high = max(bar.low for bar in bars), min(bar.high for bar in bars)
    if low <= high:
        axes.fill_between([low, high], y + 0.5, y + len(bars) + 0.5, color=bars[0].colour,
                          alpha=0.22, linewidth=0, zorder=0)


def _plane(axes: Any, plane: Plane) -> None:
    for region in plane.regions:
        if region.x is not None and region.y is not None:
            axes.plot(region.x, region.y, color=region.colour, solid_capstyle="round",
                      linewidth=1.4 if region.outline else 2.2, zorder=4,
                      linestyle=(0, (3, 2)) if region.outline else "-")
        for rectangle in region.rectangles:
            _rectangle(axes, plane, region, rectangle)
    axes.plot(*plane.target, marker="o", markersize=7.5, markerfacecolor="white", zorder=5,
              markeredgecolor=INK, markeredgewidth=1.3, linestyle="", clip_on=False)
    axes.plot(*plane.target, marker="o", markersize=2.2, color=INK, linestyle="", zorder=6)
    _stops(axes, plane)
    axes.set_xlim(-0.015 * plane.width, plane.width)
    axes.set_ylim(-0.015 * plane.height, plane.height)
    axes.set_xlabel(plane.x, fontsize=9, color=INK)
    axes.set_ylabel(plane.y, fontsize=9, color=INK)
    _plain(axes)


def _rectangle(axes: Any, plane: Plane, region: Region, rectangle: Rectangle) -> None:
    from matplotlib.patches import Rectangle as Patch

    left, right, low, high = rectangle
    thin = right - left < THIN * plane.width or high - low < THIN * plane.height
    if region.outline and thin:
        return
    fill = "none" if region.outline else region.colour
    axes.add_patch(Patch(
        (left, low), right - left, high - low, facecolor=fill, edgecolor=region.colour,
        linewidth=3.0 if thin else 1.1, linestyle=(0, (3, 2)) if region.outline else "-",
        alpha=None if region.outline or thin else 0.45, zorder=3 if region.outline or thin else 2))


def _stops(axes: Any, plane: Plane) -> None:
    """Lines at the stops; a note where something lies on a stop outside of the map."""
    x, y = plane.stops
    beyond = [side for side, stop, shown in ((0, x, plane.width), (2, y, plane.height))
              if any(r[side] > shown for region in plane.regions for r in region.rectangles)]
    for side in beyond:
        at, where = ((0.985, 0.04), "→") if side == 0 else ((0.985, 0.94), "↑")
        axes.text(*at, f"{where} also on the stop, {plane.stops[side // 2]:.0f}°", fontsize=7.5,
                  color=FADED, ha="right", transform=axes.transAxes)
    if y < plane.height:
        axes.axhline(y, color=FADED, linewidth=0.8, linestyle=(0, (2, 3)), zorder=1)
        axes.text(plane.width, y + 0.012 * plane.height, "stop", fontsize=7.5, color=FADED,
                  ha="right", va="bottom")


def _head(axes: Any, column: Column) -> None:
    """Title and verdicts above the first map."""
    for i, (line, colour) in enumerate(reversed(column.verdicts)):
        axes.annotate(line, (0, 1), xycoords="axes fraction", xytext=(0, 6 + 12 * i),
                      textcoords="offset points", fontsize=8, color=colour)
    axes.annotate(column.title, (0, 1), xycoords="axes fraction",
                  xytext=(0, 10 + 12 * len(column.verdicts)), textcoords="offset points",
                  fontsize=11, color=INK)


def _handles(regions: Sequence[Region]) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    for region in regions:
        dashes: Any = (0, (3, 2)) if region.outline else "-"
        if region.x is not None:
            handles.append(Line2D([], [], color=region.colour, linestyle=dashes, label=region.label,
                                  linewidth=1.4 if region.outline else 2.2))
        else:
            fill = "none" if region.outline else region.colour
            handles.append(Patch(facecolor=fill, edgecolor=region.colour, linestyle=dashes,
                                 label=region.label, alpha=None if region.outline else 0.6))
    handles.append(Line2D([], [], marker="o", markersize=7.5, markerfacecolor="white",
                          markeredgecolor=INK, markeredgewidth=1.3, linestyle="",
                          label="the paper's target, 5° / 10° / 15°"))
    return handles


def _plain(axes: Any) -> None:
    axes.tick_params(labelsize=8, colors=INK)
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _save(figure: Any, path: Path) -> None:
    with written_whole(path) as aside:
        # the program's version in the file would change it with every release of matplotlib
        figure.savefig(aside, metadata={"Software": None} if path.suffix == ".png" else None)
