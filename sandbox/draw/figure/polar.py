"""Forces by their direction, as PNG, SVG or PDF."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array, Flags

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SIZE = 105.0, 112.0
"""Width and height [mm]."""
WIDE = 46
"""Letters of a line of the title."""
RINGS = 4
"""Of the grid, at most."""
ROOM = 1.12
"""Radius of the picture over the largest force in it."""
OUTSIDE = 1.02
"""Over the bound: what is farther from it has a word of its own."""
FARTHEST = 3.0
"""Over the median of what is finite: larger forces are marked at the rim."""


def save_pushes(
    path: Path, *, title: str, around: Array, bounds: Array, directions: Array, found: Array,
    most: Array, limit: str,
) -> None:
    """Draw pushes that move an object over their direction, and the bound that balance gives.

    Args:
        path: the file; its ending says the format.
        title: above it.
        around: directions of the bound, all round [rad], shape [f].
        bounds: [N], shape [f]; what is infinite or nan is left out.
        directions: of the pushes [rad], shape [k].
        found: [N], shape [k]; where infinite, a cross says up to where it was pushed.
        most: up to which it was pushed [N], shape [k].
        limit: how far the object has come then, as text.

    Raises:
        OutputError: it cannot be written.
    """
    from matplotlib.ticker import MaxNLocator

    figure = style.new_figure(SIZE[1], SIZE[0])
    axes = figure.add_subplot(projection="polar")
    shown = np.where(np.isfinite(bounds), bounds, np.nan)
    axes.plot(np.append(around, around[0] + 2 * np.pi), np.append(shown, shown[0]),
              color=style.hue(0), linewidth=style.LINE,
              label="bound: beyond it gives" if np.isfinite(shown).any() else "no bound")
    moved = np.isfinite(found)
    radius = _radius(np.concatenate([bounds, found]), most[~moved])
    beyond = moved & (found > radius)
    bound = bounds[::len(around) // len(directions)]
    outside = moved & ~beyond & np.isfinite(bound) & (bound > 0) & (found > OUTSIDE * bound)
    _mark(axes, directions, found, moved & ~beyond, 1, "o", f"moved by {limit}" + (
        "\n(outside: gives, tightens, holds on)" if outside.any() else ""))
    _mark(axes, directions, most, ~moved & (most <= radius), 2, "x", "not moved up to here")
    rim = np.full(len(found), 0.97 * radius)
    _mark(axes, directions, rim, beyond | (~moved & (most > radius)), 1, "^",
          "beyond the rim, if at all")
    axes.set_ylim(0.0, radius)
    axes.yaxis.set_major_locator(MaxNLocator(RINGS))
    axes.set_rlabel_position(112.5)
    axes.tick_params(labelsize=style.SMALL, colors=style.INK)
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85})
    axes.grid(visible=True, color=style.FAINT, linewidth=0.6)
    axes.spines["polar"].set_color(style.FAINT)
    axes.yaxis.set_major_formatter(lambda value, _: f"{style.number(value)} N" if value else "")
    style.title(figure, textwrap.fill(title, WIDE))
    style.legend(figure, loc="outside lower center", ncols=2)
    style.save_figure(figure, path)


def _radius(forces: Array, tried: Array) -> float:
    """Of the picture [N]: all bounds and what was found and tried, if not far above most of it."""
    known = forces[np.isfinite(forces) & (forces > 0)]
    known = known if len(known) else tried
    if not len(known):
        return 1.0
    far = FARTHEST * float(np.median(known))
    return ROOM * min(float(np.concatenate([known, tried[tried <= far]]).max()), far)


def _mark(
    axes: Axes, directions: Array, at: Array, which: Flags, hue: int, marker: str, label: str,
) -> None:
    """Marks at some of the directions, if any."""
    if which.any():
        axes.plot(directions[which], at[which], color=style.hue(hue), linestyle="", marker=marker,
                  markersize=4.5, markerfacecolor="white", markeredgewidth=1.3, label=label,
                  clip_on=False)
