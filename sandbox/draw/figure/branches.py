"""Equilibria along a value of the scene, stable ones solid, as PNG, SVG or PDF."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Flags

HEIGHT = 78.0
"""[mm]"""
UNSTABLE = (0, (3.5, 1.8))


class BranchCurve(NamedTuple):
    """One branch."""

    x: Array
    """Values of the scene's field, [n]."""
    y: Array
    """The quantity at rest, SI, [n]."""
    stable: Flags
    """[n]"""
    fold: Flags
    """Where it turns back, [n]."""


def save_branches(
    path: Path, curves: Sequence[BranchCurve], *, title: str, along: str, quantity: str, unit: str,
) -> None:
    """Draw branches of equilibria: what is unstable dashed, folds as rings.

    Args:
        path: the file; its ending says the format.
        curves: branches.
        title: above it.
        along: what the values are of, with its unit.
        quantity: what is drawn over them.
        unit: its SI unit.

    Raises:
        OutputError: it cannot be written.
    """
    from matplotlib.lines import Line2D

    shown = style.shown_as(unit, *(curve.y for curve in curves))
    figure = style.new_figure(HEIGHT)
    axes = figure.add_subplot()
    for i, curve in enumerate(curves):
        y = shown.factor * curve.y
        for low, high, stable in _stretches(curve.stable | curve.fold):
            axes.plot(curve.x[low:high], y[low:high], color=style.hue(i), linewidth=style.LINE,
                      linestyle="solid" if stable else UNSTABLE)
        axes.plot(curve.x[curve.fold], y[curve.fold], linestyle="", marker="o", markersize=5.5,
                  color=style.hue(i), markerfacecolor="white", markeredgewidth=1.3)
    what = f"{quantity} [{shown.unit}]" if shown.unit else quantity
    style.dress(axes, "", what, x=along)
    style.powers(axes)
    style.roomy(axes, *(shown.factor * curve.y for curve in curves))
    style.title(figure, title)
    dark: dict[str, Any] = {"color": style.INK, "linewidth": style.LINE}
    marks = [(Line2D([], [], **dark), "stable")]
    if any((~curve.stable & ~curve.fold).any() for curve in curves):
        marks.append((Line2D([], [], **dark, linestyle=UNSTABLE), "not stable"))
    if any(curve.fold.any() for curve in curves):
        marks.append((Line2D([], [], color=style.INK, linestyle="", marker="o", markersize=5.5,
                             markerfacecolor="white", markeredgewidth=1.3), "fold"))
    style.legend(figure, *zip(*marks, strict=True), loc="outside lower center", ncols=len(marks))
    style.save_figure(figure, path)


def _stretches(stable: Flags) -> list[tuple[int, int, bool]]:
    """First and last point, exclusive, of each stretch that is alike; they share their ends."""
    changes = np.flatnonzero(np.diff(stable.astype(int))) + 1
    starts = [0, *changes.tolist()]
    ends = [*changes.tolist(), len(stable)]
    found = []
    for low, high in zip(starts, ends, strict=True):
        alike = bool(stable[low])
        # what is not stable reaches to the stable points, or folds, on either side
        found.append((low, high, True) if alike else (max(low - 1, 0), min(high + 1, len(stable)),
                                                      False))
    return found
