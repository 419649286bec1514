"""The camera: world [m], y up, to picture [pixels], y down. Equal aspect, nothing else."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array

MARGIN = 0.04
"""Fraction of the stage left free on every side of a fitted picture."""
SMALLEST = 1e-9
"""Extents below this [m] count as a point."""


class Rectangle(NamedTuple):
    """A rectangle of the world [m]: ``x0 <= x1``, ``y0 <= y1``."""

    x0: float
    y0: float
    x1: float
    y1: float

    @classmethod
    def around(cls, *sets: Array) -> Rectangle:
        """The smallest box that holds points [..., 2]; non-finite ones are left out."""
        points = np.concatenate([each.reshape(-1, 2) for each in sets])
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return cls(0.0, 0.0, 0.0, 0.0)
        return cls(*points.min(axis=0).tolist(), *points.max(axis=0).tolist())

    @property
    def corners(self) -> Array:
        """Its lower left and its upper right corner [2, 2] m."""
        return np.array(self).reshape(2, 2)

    @property
    def width(self) -> float:
        """In metres."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """In metres."""
        return self.y1 - self.y0


class Stage(NamedTuple):
    """The part of the picture that shows the world [pixels], y down from the top."""

    left: float
    top: float
    width: float
    height: float


class Camera(NamedTuple):
    """``pixel = (px, py) + scale * (x - cx, -(y - cy))``."""

    scale: float
    """Pixels per metre."""
    centre: tuple[float, float]
    """World point [m] that is shown at ``pixel``."""
    pixel: tuple[float, float]

    def to_pixels(self, points: Array) -> Array:
        """Pixels of world points; ``points`` [..., 2] in m."""
        return np.asarray(self.pixel + self.scale * (points - self.centre) * (1.0, -1.0))

    def to_world(self, pixels: Array) -> Array:
        """World points [m] of ``pixels`` [..., 2]; undoes :meth:`to_pixels`."""
        return np.asarray(self.centre + (pixels - self.pixel) / self.scale * (1.0, -1.0))


def width_shown(box: Rectangle, aspect: float, width: float | None = None) -> float:
    """How much of ``box`` a picture shows from side to side [m], by which arrows are measured.

    All of it, or the ``width`` that the view asks for, if that is less: what flies off makes no
    arrow of what is shown longer. ``aspect`` is the picture's width over its height.
    """
    whole = max(box.width, box.height * aspect, 1e-3)
    return min(whole, width) if width else whole


def place_camera(
    box: Rectangle, stage: Stage, *, centre: tuple[float, float] | None = None,
    width: float | None = None,
) -> Camera:
    """The camera that shows ``box`` on ``stage``, or what ``centre`` and ``width`` [m] ask for.

    A width alone keeps the box's centre; a centre alone takes the largest scale
    that still shows the whole box.
    """
    middle = centre or ((box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2)
    pixel = (stage.left + stage.width / 2, stage.top + stage.height / 2)
    if width is not None:
        return Camera(stage.width / width, middle, pixel)
    half_x = max(box.x1 - middle[0], middle[0] - box.x0)
    half_y = max(box.y1 - middle[1], middle[1] - box.y0)
    if max(half_x, half_y) < SMALLEST:
        half_x = half_y = 0.05
    free = 1 - 2 * MARGIN
    return Camera(free * min(stage.width / (2 * max(half_x, SMALLEST)),
                             stage.height / (2 * max(half_y, SMALLEST))), middle, pixel)
