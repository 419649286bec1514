"""Maps of reachable poses, and the pulls at which a pose can be held, as PNG, SVG or PDF.

It draws what it is given: rectangles, curves and a target in planes of two
angles; bars over an axis of pulls. Which poses those are is computed elsewhere.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.draw.figure import style
from sandbox.numeric import Array

Rectangle = tuple[float, float, float, float]
"""Lowest and highest x, lowest and highest y."""
THIN = 0.006
"""Of an axis: a rectangle that is thinner is drawn as a line, so that a stop can be seen."""
MAP, HEADS, KEY = 56.0, 14.0, 18.0
"""Height of a map with its labels, of what stands above a row of them, of the legend [mm]."""
VERDICT = 12.0
"""From one line above a map to the next [pt]."""
BAR, SURROUND = 5.6, 20.0
"""Height of a bar with its gap, and of a figure of bars without them [mm]."""
HEADLINE = 2.0
"""Height of a group's name and of what is said of it, in bars."""
DASHES: Any = (0, (3, 2))
CURVE: dict[str, Any] = {"linewidth": 2.0}
VARIANT: dict[str, Any] = {"linewidth": 1.2, "linestyle": DASHES}
"""How a curve is drawn, and a variant of it."""
RING: dict[str, Any] = {"marker": "o", "markersize": 6.5, "markerfacecolor": "white",
                        "markeredgecolor": style.INK, "markeredgewidth": 1.2, "linestyle": ""}
"""How a target is drawn."""


@dataclass(frozen=True)
class Region:
    """What one manner of doing it reaches in a plane: rectangles, or a curve x, y."""

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
class MapRow:
    """Maps of one condition, side by side."""

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


def save_maps(path: Path, rows: Sequence[MapRow]) -> None:
    """Draw rows of maps below each other, with one legend above all.

    Raises:
        OutputError: it cannot be written.
        ValueError: no rows, or rows of unequal numbers of planes.
    """
    counts = {len(row.planes) for row in rows}
    if len(counts) != 1:
        raise ValueError("rows must all hold the same number of planes, got "
                         + (", ".join(map(str, sorted(counts))) or "none"))
    figure = style.new_figure((MAP + HEADS) * len(rows) + KEY)
    grid = figure.subplots(len(rows), counts.pop(), squeeze=False)
    for line, row in zip(grid, rows, strict=True):
        for axes, plane in zip(line, row.planes, strict=True):
            _plane(axes, plane)
        _head(line[0], row)
    style.legend(figure, handles=_handles(rows[0].planes[0].regions),
                 loc="outside upper center", ncols=2, columnspacing=2.2)
    style.save_figure(figure, path)


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
    groups = list(dict.fromkeys(bar.group for bar in bars))
    figure = style.new_figure(BAR * (len(bars) + HEADLINE * len(groups)) + SURROUND)
    axes = figure.subplots()
    style.dress(axes, title, "", x=x)
    names: list[tuple[float, str]] = []
    y = 0.0
    for group, (colour, note) in zip(groups, notes, strict=True):
        axes.text(0.012 * right, y - 0.1, f"{group}:\n{note}", fontsize=style.SMALL, color=colour,
                  va="center", bbox={"facecolor": "white", "edgecolor": "none", "pad": 1.5})
        mine = [bar for bar in bars if bar.group == group]
        _common(axes, mine, y)
        for bar in mine:
            y += 1
            axes.barh(y, min(bar.high, right) - bar.low, left=bar.low, height=0.62,
                      color=bar.colour)
            if bar.high > right:
                axes.annotate("→", (right, y), fontsize=style.HEAD, color=bar.colour,
                              va="center_baseline", annotation_clip=False)
            names.append((y, bar.label))
        y += HEADLINE
    axes.set_yticks([at for at, _ in names], labels=[name for _, name in names])
    axes.set_xlim(0, right)
    axes.set_ylim(y - 0.5, -0.6)
    for mark in marks:
        axes.axvline(mark, zorder=0.8, **style.STOP)
    style.save_figure(figure, path)


def _common(axes: Any, bars: Sequence[Bar], y: float) -> None:
    low, high = max(bar.low for bar in bars), min(bar.high for bar in bars)
    if low <= high:
        axes.fill_between([low, high], y + 0.5, y + len(bars) + 0.5, color=bars[0].colour,
                          alpha=0.22, linewidth=0, zorder=0)


def _plane(axes: Any, plane: Plane) -> None:
    style.dress(axes, "", plane.y, x=plane.x)
    for region in plane.regions:
        if region.x is not None and region.y is not None:
            axes.plot(region.x, region.y, color=region.colour, solid_capstyle="round", zorder=4,
                      **VARIANT if region.outline else CURVE)
        for rectangle in region.rectangles:
            _rectangle(axes, plane, region, rectangle)
    axes.plot(*plane.target, zorder=5, clip_on=False, **RING)
    axes.plot(*plane.target, marker="o", markersize=1.8, color=style.INK, linestyle="", zorder=6)
    _stops(axes, plane)
    axes.set_xlim(-0.015 * plane.width, plane.width)
    axes.set_ylim(-0.015 * plane.height, plane.height)


def _rectangle(axes: Any, plane: Plane, region: Region, rectangle: Rectangle) -> None:
    from matplotlib.patches import Rectangle as Patch

    left, right, low, high = rectangle
    thin = right - left < THIN * plane.width or high - low < THIN * plane.height
    if region.outline and thin:
        return
    fill = "none" if region.outline else region.colour
    axes.add_patch(Patch(
        (left, low), right - left, high - low, facecolor=fill, edgecolor=region.colour,
        linewidth=2.4 if thin else 1.0, linestyle=DASHES if region.outline else "-",
        alpha=None if region.outline or thin else 0.45, zorder=3 if region.outline or thin else 2))


def _stops(axes: Any, plane: Plane) -> None:
    """Lines at the stops; a note where something lies on a stop outside of the map."""
    x, y = plane.stops
    beyond = [side for side, stop, shown in ((0, x, plane.width), (2, y, plane.height))
              if any(r[side] > shown for region in plane.regions for r in region.rectangles)]
    for side in beyond:
        at, where = ((0.985, 0.04), "→") if side == 0 else ((0.985, 0.94), "↑")
        axes.text(*at, f"{where} also on the stop, {plane.stops[side // 2]:.0f}°", ha="right",
                  fontsize=style.TINY, color=style.QUIET, transform=axes.transAxes)
    if y < plane.height:
        axes.axhline(y, zorder=1, **style.STOP)
        axes.text(plane.width, y + 0.012 * plane.height, "stop", fontsize=style.TINY,
                  color=style.QUIET, ha="right", va="bottom")


def _head(axes: Any, row: MapRow) -> None:
    """Title and verdicts above the first map of a row."""
    for i, (line, colour) in enumerate(reversed(row.verdicts)):
        axes.annotate(line, (0, 1), xycoords="axes fraction", xytext=(0, 6 + VERDICT * i),
                      textcoords="offset points", fontsize=style.SMALL, color=colour)
    axes.annotate(row.title, (0, 1), xycoords="axes fraction",
                  xytext=(0, 8 + VERDICT * len(row.verdicts)), textcoords="offset points",
                  fontsize=style.HEAD, color=style.INK)


def _handles(regions: Sequence[Region]) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    handles: list[Any] = []
    for region in regions:
        if region.x is not None:
            handles.append(Line2D([], [], color=region.colour, label=region.label,
                                  **VARIANT if region.outline else CURVE))
        else:
            fill = "none" if region.outline else region.colour
            handles.append(Patch(facecolor=fill, edgecolor=region.colour, label=region.label,
                                 linestyle=DASHES if region.outline else "-",
                                 alpha=None if region.outline else 0.6))
    handles.append(Line2D([], [], label="the paper's target, 5° / 10° / 15°", **RING))
    return handles
