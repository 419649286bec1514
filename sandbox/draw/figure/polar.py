"""Forces by their direction, as PNG, SVG or PDF."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sandbox.draw.figure import style
from sandbox.numeric import Array

SIZE = 105.0, 112.0
"""Width and height [mm]."""
RINGS = 4
"""Of the grid, at most."""
ROOM = 1.12
"""Radius of the picture over the largest force in it."""


def save_pushes(
    path: Path, *, title: str, around: Array, bounds: Array, directions: Array, found: Array,
    limit: str,
) -> None:
    """Draw pushes that move an object over their direction, and the bound that balance gives.

    Args:
        path: the file; its ending says the format.
        title: above it.
        around: directions of the bound, all round [rad], shape [f].
        bounds: [N], shape [f]; what is infinite or nan is left out.
        directions: of the pushes [rad], shape [k].
        found: [N], shape [k]; what is infinite is left out.
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
              label="balance allows no more" if np.isfinite(shown).any() else "no bound")
    moved = np.isfinite(found)
    axes.plot(directions[moved], found[moved], color=style.hue(1), linestyle="", marker="o",
              markersize=4.5, markerfacecolor="white", markeredgewidth=1.3,
              label=f"simulation: moved by {limit}")
    forces = np.concatenate([shown[np.isfinite(shown)], found[moved], [0.0]])
    axes.set_ylim(0.0, ROOM * (forces.max() or 1.0))
    axes.yaxis.set_major_locator(MaxNLocator(RINGS))
    axes.set_rlabel_position(112.5)
    axes.tick_params(labelsize=style.SMALL, colors=style.INK)
    for label in axes.get_yticklabels():
        label.set_bbox({"facecolor": "white", "edgecolor": "none", "pad": 1.0, "alpha": 0.85})
    axes.grid(visible=True, color=style.FAINT, linewidth=0.6)
    axes.spines["polar"].set_color(style.FAINT)
    axes.yaxis.set_major_formatter(lambda value, _: f"{style.number(value)} N" if value else "")
    style.title(figure, title)
    style.legend(figure, loc="outside lower center", ncols=2)
    style.save_figure(figure, path)
