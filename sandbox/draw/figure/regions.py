"""Regions in which something holds, over two values or one, as PNG, SVG or PDF.

Cells are coloured by what is known of them, the boundary is a line through undecided ones, and the
runs that it was found by are dots. A closed form is a dashed line.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Flags, Integers

FILLS = {1: style.HOLDS, 0: style.FAILS, 2: style.UNDECIDED, -1: style.UNANSWERED}
"""Of the states of cells."""
WORDS = {1: "holds", 0: "does not hold", 2: "undecided cells", -1: "no answer"}
HEIGHT, STRIP, SURROUND = 78.0, 12.0, 26.0
"""Of a map and of a strip of one value, and of what is about them [mm]."""
COLUMNS = 3
DASHED: Any = (0, (3.5, 2))
DOT = 1.3


@dataclass(frozen=True)
class RegionAxis:
    """What is along an axis."""

    label: str
    unit: str
    """SI; empty for none."""

    def shown(self, numbers: Array) -> tuple[float, str]:
        """The factor of its numbers [SI] as they are shown, and its label with the unit."""
        how = style.shown_as(self.unit, numbers)
        return how.factor, f"{self.label} [{how.unit}]" if how.unit else self.label


@dataclass(frozen=True)
class RegionPanel:
    """One map."""

    head: str
    axes: tuple[RegionAxis, ...]
    """One, or x and y."""
    ways: tuple[Array, ...]
    """Borders of cells along each [SI], [side + 1]."""
    states: Integers
    """Of cells, [side] or [side of x, side of y]: keys of :data:`FILLS`."""
    boundary: Sequence[Array]
    """Polylines [n, 2] [SI]; over one value brackets [2, 1]."""
    runs: Array
    """[n, 1] or [n, 2] [SI]."""
    failed: Flags
    """Runs without an end, [n]."""
    doubtful: Flags
    """Runs of which the audit asks for a look, [n]."""
    form: Array | None = None
    """A closed form at the cells' corners, [side + 1] along each: its zero line is drawn."""


def draw_regions(
    path: Path, panels: Sequence[RegionPanel], *, title: str = "", closed: str = "",
    columns: int = COLUMNS,
) -> None:
    """Draw maps side by side.

    Args:
        path: the file; its ending says the format.
        panels: all over one value, or all over two.
        title: above all.
        closed: what the closed form is called.
        columns: at most so many side by side.

    Raises:
        OutputError: it cannot be written.
        ValueError: no panels.
    """
    if not panels:
        raise ValueError("a figure of regions has one map or more")
    flat = len(panels[0].axes) == 1
    wide = 1 if flat else min(columns, len(panels))
    rows = -(-len(panels) // wide)
    tall = STRIP if flat else (HEIGHT if wide == 1 else 100.0 / wide + 8.0)
    figure = style.new_figure(tall * rows + SURROUND)
    grid = figure.subplots(rows, wide, squeeze=False, sharex=True, sharey=True)
    for place, axes in enumerate(grid.flat):
        if place >= len(panels):
            axes.set_visible(False)
            continue
        last, first = place + wide >= len(panels), place % wide == 0
        (_strip if flat else _map)(axes, panels[place])
        x = panels[place].axes[0].shown(panels[place].ways[0])[1]
        y = "" if flat or not first else panels[place].axes[1].shown(panels[place].ways[1])[1]
        # of three side by side the middle one has room for what all three are over
        named = last and (wide < COLUMNS or place % wide == wide // 2)
        style.dress(axes, panels[place].head, y, x=x if named else "")
        axes.grid(visible=False)
        axes.tick_params(labelbottom=last, labelleft=first and not flat)
        if flat:
            axes.set_yticks([])
    style.title(figure, title)
    style.legend(figure, handles=_handles(panels, closed), loc="outside lower center", ncols=3,
                 columnspacing=1.6)
    style.save_figure(figure, path)


def _map(axes: Any, panel: RegionPanel) -> None:
    (fx, _), (fy, _) = (axis.shown(way) for axis, way in zip(panel.axes, panel.ways, strict=True))
    x, y = fx * panel.ways[0], fy * panel.ways[1]
    _fill(axes, x, y, panel.states.T)
    for line in panel.boundary:
        axes.plot(fx * line[:, 0], fy * line[:, 1], color=style.INK, linewidth=style.LINE)
    _dots(axes, panel, fx * panel.runs[:, 0], fy * panel.runs[:, 1])
    if panel.form is not None and _crosses(panel.form):
        axes.contour(x, y, panel.form.T, levels=[_level(panel.form)], colors=[style.VIOLET],
                     linewidths=[style.LINE], linestyles=[DASHED])
    for along, way in (("x", x), ("y", y)):
        _scale(axes, along, way)


def _strip(axes: Any, panel: RegionPanel) -> None:
    factor, _ = panel.axes[0].shown(panel.ways[0])
    x = factor * panel.ways[0]
    _fill(axes, x, np.array([0.0, 1.0]), panel.states[None, :])
    for bracket in panel.boundary:
        axes.axvline(factor * float(bracket.mean()), color=style.INK, linewidth=style.LINE)
    _dots(axes, panel, factor * panel.runs[:, 0], np.full(len(panel.runs), 0.5))
    if panel.form is not None:
        level = _level(panel.form)
        for k in np.flatnonzero(np.diff(panel.form > level)):
            axes.axvline(0.5 * (x[k] + x[k + 1]), color=style.VIOLET, linewidth=style.LINE,
                         linestyle=DASHED)
    _scale(axes, "x", x)
    axes.set_ylim(0, 1)


def _fill(axes: Any, x: Array, y: Array, states: Integers) -> None:
    from matplotlib.colors import to_rgb

    colours = np.empty((*states.shape, 3))
    for state, colour in FILLS.items():
        colours[states == state] = to_rgb(colour)
    axes.pcolormesh(x, y, colours, linewidth=0, rasterized=True, zorder=0)


def _dots(axes: Any, panel: RegionPanel, x: Array, y: Array) -> None:
    well = ~panel.failed
    axes.plot(x[well], y[well], linestyle="", marker="o", markersize=DOT, markeredgewidth=0,
              color=style.SLATE, alpha=0.75)
    axes.plot(x[panel.failed], y[panel.failed], linestyle="", marker="x", markersize=3,
              color=style.RED, markeredgewidth=0.8)
    look = panel.doubtful & well
    axes.plot(x[look], y[look], linestyle="", marker="o", markersize=3.5, markerfacecolor="none",
              markeredgecolor=style.ORANGE, markeredgewidth=0.8)


def _crosses(form: Array) -> bool:
    return bool(np.nanmin(form) <= 0 < np.nanmax(form))


def _level(form: Array) -> float:
    """Where the line of a closed form is: of a comparison, which is 0 or 1, between them."""
    return 0.5 if set(np.unique(form).tolist()) <= {0.0, 1.0} else 0.0


def _scale(axes: Any, along: str, way: Array) -> None:
    steps = np.diff(way)
    if len(steps) > 1 and not np.allclose(steps, steps[0]) and (way > 0).all():
        getattr(axes, f"set_{along}scale")("log")
    getattr(axes, f"set_{along}lim")(float(way.min()), float(way.max()))


def _handles(panels: Sequence[RegionPanel], closed: str) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    there = {int(state) for panel in panels for state in np.unique(panel.states)}
    found: list[Any] = [Patch(facecolor=FILLS[state], edgecolor=style.GREY, linewidth=0.5,
                              label=words) for state, words in WORDS.items() if state in there]
    if any(panel.boundary for panel in panels):
        found.append(Line2D([], [], color=style.INK, linewidth=style.LINE, label="boundary"))
    found.append(Line2D([], [], color=style.SLATE, linestyle="", marker="o", markersize=2.5,
                        markeredgewidth=0, label="runs"))
    if any(panel.failed.any() for panel in panels):
        found.append(Line2D([], [], color=style.RED, linestyle="", marker="x", markersize=3,
                            label="runs without an end"))
    if any((panel.doubtful & ~panel.failed).any() for panel in panels):
        found.append(Line2D([], [], color=style.ORANGE, linestyle="", marker="o", markersize=3.5,
                            markerfacecolor="none", label="audit asks for a look"))
    if closed and any(panel.form is not None for panel in panels):
        found.append(Line2D([], [], color=style.VIOLET, linewidth=style.LINE, linestyle=DASHED,
                            label=style.plain(closed)))
    return found
