"""Plots for reports and papers: curves and points in labelled panels, as PNG or SVG files.

matplotlib's ``Figure`` is used without pyplot, so that no display and no global
state is involved.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from sandbox.whole_files import written_whole

Array = NDArray[np.float64]
COLOURS = ("#2f6690", "#d1742f", "#4f8a6b", "#8a5a9e", "#9a7b3f", "#5b6673", "#b5485d")
"""Calm, and apart in lightness as well as in hue."""
INK, FAINT = "#222831", "#d9dde2"
WIDTH, HEIGHT, DPI = 4.6, 3.3, 130
STYLES: dict[str, dict[str, Any]] = {
    "line": {"linewidth": 1.6},
    "dashed": {"linewidth": 1.1, "linestyle": (0, (4, 3))},
    "points": {"linestyle": "", "marker": "o", "markersize": 3.6, "markerfacecolor": "white",
               "markeredgewidth": 1.1},
    "ticks": {"linestyle": "", "marker": "|", "markersize": 11},
    "joined": {"linewidth": 1.3, "marker": "o", "markersize": 4},
}
"""How each kind of curve is drawn."""
CROWD = 4
"""More curves than this have their names beside the panel."""


@dataclass(frozen=True)
class Curve:
    """Points (x, y), shape [n] each."""

    label: str
    x: Array
    y: Array
    kind: Literal["line", "points", "dashed", "joined", "ticks"] = "line"
    """``joined``: points with a line through them; ``ticks``: upright strokes."""


@dataclass(frozen=True)
class Panel:
    """Curves over two labelled axes; labels carry the units."""

    title: str
    x: str
    y: str
    curves: Sequence[Curve]
    scale: Literal["linear", "log"] = "linear"
    """Of both axes."""
    top: float | None = None
    """Highest y shown; peaks beyond are cut off."""
    rows: Sequence[str] = ()
    """Names of the rows y = 0, 1, ... from above, in place of numbers."""


def save_panels(path: Path, panels: Sequence[Panel]) -> None:
    """Draw panels side by side into a file, its format by its ending.

    Raises:
        OutputError: it cannot be written.
        ValueError: no panels.
    """
    if not panels:
        raise ValueError("panels must hold at least one, got none")
    from matplotlib.figure import Figure

    tallest = max(len(panel.rows) for panel in panels)
    beside = sum(len(panel.curves) > CROWD for panel in panels)
    width = WIDTH * len(panels) + 1.4 * beside + (2.0 if tallest else 0.0)
    figure = Figure(figsize=(width, max(HEIGHT, 0.24 * tallest + 0.9)), dpi=DPI,
                    layout="constrained")
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        _draw(axes, panel)
    with written_whole(path) as aside:
        # the program's version in the file would change it with every release of matplotlib
        figure.savefig(aside, metadata={"Software": None} if path.suffix == ".png" else None)


def _draw(axes: Any, panel: Panel) -> None:
    for i, curve in enumerate(panel.curves):
        colour = COLOURS[_hue(panel.curves, i) % len(COLOURS)]
        axes.plot(curve.x, curve.y, label=curve.label or None, color=colour, **STYLES[curve.kind])
    _scale(axes, panel)
    axes.set_title(panel.title, fontsize=10, color=INK, loc="left")
    axes.set_xlabel(panel.x, fontsize=9, color=INK)
    axes.set_ylabel(panel.y, fontsize=9, color=INK)
    axes.tick_params(labelsize=8, colors=INK, which="both")
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
    if any(curve.label for curve in panel.curves):
        # many curves leave no room for their names among them
        beside = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if len(
            panel.curves) > CROWD else {}
        axes.legend(fontsize=7.5, frameon=False, **beside)


def _scale(axes: Any, panel: Panel) -> None:
    if panel.rows:
        axes.set_yticks(range(len(panel.rows)), labels=panel.rows)
        axes.invert_yaxis()
    elif panel.scale == "log":
        axes.set_xscale("log")
        axes.set_yscale("log")
    else:
        axes.ticklabel_format(axis="y", scilimits=(-3, 4), useMathText=True)
    if panel.top is not None:
        axes.set_ylim(-0.05 * panel.top, panel.top)


def _hue(curves: Sequence[Curve], index: int) -> int:
    """Curves of one name before the comma share a colour: ``joint 1, engine``."""
    heads = list(dict.fromkeys(curve.label.partition(",")[0] for curve in curves))
    return heads.index(curves[index].label.partition(",")[0])
