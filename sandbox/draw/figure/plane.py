"""Paths in the plane: both axes have one scale, so that a circle is round."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.numeric import Array

LEAST, MOST = 38.0, 110.0
"""Height of axes [mm]: a flat path has room about it, an upright one makes them less wide."""
FLAT = 10.0
"""A path so many times longer than high, or higher than long, would be a line: each of its axes
keeps a scale of its own."""
MARGIN = 1.14
"""What is shown, as a multiple of what the values span."""


@dataclass(frozen=True)
class PathScale:
    """The scale of panels one below the other that share their x axis."""

    width: float
    """Of the axes [mm]."""
    middle: float
    """Of x, as shown."""
    scale: float
    """What of x and y a millimetre is."""

    def height(self, y: Array) -> float:
        """Of the axes that hold these values of y, as shown [mm]."""
        return min(max(MARGIN * _span(y) / self.scale, LEAST), MOST)

    def lay(self, axes: Any, y: Array) -> None:
        """Limits and aspect of axes that hold these values of y, as shown."""
        centre, half = _middle(y), 0.5 * self.scale * self.height(y)
        wide = 0.5 * self.scale * self.width
        # how wide axes are tells the layout, when all is drawn: then limits that may give way to it
        # do so, and those of an x axis that is shared may not
        alone = len(axes.get_shared_x_axes().get_siblings(axes)) == 1
        axes.set_xlim(self.middle - wide, self.middle + wide, auto=alone)
        axes.set_ylim(centre - half, centre + half, auto=True)
        axes.set_aspect("equal", adjustable="datalim")


def seen_as_path(x: Array, y: Array) -> bool:
    """Whether one scale shows how both run: neither spans :data:`FLAT` times the other."""
    long, high = _span(x), _span(y)
    return min(long, high) > 0 and max(long, high) <= FLAT * min(long, high)


def path_scale(x: Array, rows: Sequence[Array], width: float) -> PathScale:
    """The scale that all rows of y, a panel each, and x have room at.

    Args:
        x: as shown, any shape; nan counts for nothing.
        rows: of y, as shown, any shapes; at least one value in all that differs from another.
        width: of the axes [mm].
    """
    scale = MARGIN * max(_span(x) / width, *(_span(y) / MOST for y in rows))
    return PathScale(width, _middle(x), scale)


def _span(values: Array) -> float:
    finite = values[np.isfinite(values)]
    return float(np.ptp(finite)) if finite.size else 0.0


def _middle(values: Array) -> float:
    return float(0.5 * (np.nanmin(values) + np.nanmax(values)))
