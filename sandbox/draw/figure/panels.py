"""Curves and points in labelled panels side by side, as PNG, SVG or PDF files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array

WIDTH, HEIGHT = style.WIDTH / 2, 64.0
"""Of a panel [mm]: two fill a page's width."""
NAMES, ROW_NAMES, ROW, SURROUND = 40.0, 40.0, 5.0, 18.0
"""Width of curves' names beside a panel, and of rows' names; height of a row, and of what is
not rows [mm]."""
KINDS: dict[str, dict[str, Any]] = {
    "line": {"linewidth": style.LINE},
    "dashed": style.TARGET,
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
    tallest = max(len(panel.rows) for panel in panels)
    crowded = sum(len(panel.curves) > CROWD for panel in panels)
    figure = style.new_figure(
        max(HEIGHT, ROW * tallest + SURROUND),
        WIDTH * len(panels) + NAMES * crowded + (ROW_NAMES if tallest else 0.0))
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        _draw(axes, panel)
    style.save_figure(figure, path)


def _draw(axes: Any, panel: Panel) -> None:
    for i, curve in enumerate(panel.curves):
        axes.plot(curve.x, curve.y, label=style.plain(curve.label) or None,
                  color=style.hue(_head(panel.curves, i)), **KINDS[curve.kind])
    style.dress(axes, panel.title, panel.y, x=panel.x)
    _scale(axes, panel)
    if any(curve.label for curve in panel.curves):
        # many curves leave no room for their names among them
        aside = len(panel.curves) > CROWD
        style.legend(axes, **{"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)} if aside else {})


def _scale(axes: Any, panel: Panel) -> None:
    if panel.rows:
        axes.set_yticks(range(len(panel.rows)), labels=panel.rows)
        axes.invert_yaxis()
    elif panel.scale == "log":
        axes.set_xscale("log")
        axes.set_yscale("log")
    else:
        style.powers(axes)
        if all((np.mod(curve.x, 1) == 0).all() for curve in panel.curves):  # what is counted
            axes.xaxis.get_major_locator().set_params(integer=True)
    if panel.top is not None:
        axes.set_ylim(-0.05 * panel.top, panel.top)


def _head(curves: Sequence[Curve], index: int) -> int:
    """Curves of one name before the comma share a colour: ``joint 1, engine``."""
    heads = list(dict.fromkeys(curve.label.partition(",")[0] for curve in curves))
    return heads.index(curves[index].label.partition(",")[0])
