"""The camera: world [m], y up, to picture [pixels], y down. Equal aspect, nothing else."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array

MARGIN = 0.04
"""Fraction of the stage left free on every side of a fitted picture."""
SMALLEST = 1e-9
"""Extents below this [m] count as a point."""


@dataclass(frozen=True)
class Rectangle:
    """A rectangle of the world [m]: ``x0 <= x1``, ``y0 <= y1``."""

    x0: float
    y0: float
    x1: float
    y1: float

    @classmethod
    def around(cls, points: Array) -> Rectangle:
        """The smallest box that holds ``points`` [n, 2]; non-finite ones are left out."""
        points = points[np.isfinite(points).all(axis=1)]
        if not len(points):
            return cls(0.0, 0.0, 0.0, 0.0)
        (x0, y0), (x1, y1) = points.min(axis=0), points.max(axis=0)
        return cls(float(x0), float(y0), float(x1), float(y1))

    @property
    def centre(self) -> tuple[float, float]:
        """Middle of the box [m]."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    @property
    def width(self) -> float:
        """In metres."""
        return self.x1 - self.x0

    @property
    def height(self) -> float:
        """In metres."""
        return self.y1 - self.y0


@dataclass(frozen=True)
class Stage:
    """The part of the picture that shows the world [pixels], y down from the top."""

    left: float
    top: float
    width: float
    height: float


@dataclass(frozen=True)
class Camera:
    """``pixel = (px, py) + scale * (x - cx, -(y - cy))``."""

    scale: float
    """Pixels per metre."""
    centre: tuple[float, float]
    """World point [m] that is shown at ``pixel``."""
    pixel: tuple[float, float]

    def to_pixels(self, points: Array) -> Array:
        """Pixels of world points; ``points`` [..., 2] in m."""
        out = np.empty_like(points, dtype=float)
        out[..., 0] = self.pixel[0] + self.scale * (points[..., 0] - self.centre[0])
        out[..., 1] = self.pixel[1] - self.scale * (points[..., 1] - self.centre[1])
        return out

    def to_world(self, pixels: Array) -> Array:
        """World points [m] of ``pixels`` [..., 2]; undoes :meth:`to_pixels`."""
        out = np.empty_like(pixels, dtype=float)
        out[..., 0] = self.centre[0] + (pixels[..., 0] - self.pixel[0]) / self.scale
        out[..., 1] = self.centre[1] - (pixels[..., 1] - self.pixel[1]) / self.scale
        return out

    def magnified(self, factor: float) -> Camera:
        """The same view on a picture ``factor`` times as large."""
        return Camera(self.scale * factor, self.centre,
                      (self.pixel[0] * factor, self.pixel[1] * factor))


def width_shown(box: Rectangle, aspect: float, width: float | None = None) -> float:
    """How much of ``box`` a picture shows from side to side [m], by which arrows are measured.

    All of it, or the ``width`` that the view asks for, if that is less: what flies off makes no
    arrow of what is shown longer. ``aspect`` is the picture's width over its height.
    """
    whole = max(box.width, box.height * aspect, 1e-3)
    return min(whole, width) if width else whole


def place_camera(
    box: Rectangle,
    stage: Stage,
    *,
    centre: tuple[float, float] | None = None,
    width: float | None = None,
) -> Camera:
    """The camera that shows ``box`` on ``stage``, or what ``centre`` and ``width`` [m] ask for.

    A width alone keeps the box's centre; a centre alone takes the largest scale
    that still shows the whole box.
    """
    middle = centre if centre is not None else box.centre
    pixel = (stage.left + stage.width / 2, stage.top + stage.height / 2)
    if width is not None:
        return Camera(stage.width / width, middle, pixel)
    half_x = max(box.x1 - middle[0], middle[0] - box.x0)
    half_y = max(box.y1 - middle[1], middle[1] - box.y0)
    if max(half_x, half_y) < SMALLEST:
        half_x = half_y = 0.05
    free = 1 - 2 * MARGIN
    scale = free * min(stage.width / (2 * max(half_x, SMALLEST)),
                       stage.height / (2 * max(half_y, SMALLEST)))
    return Camera(scale, middle, pixel)


def needed_height(box: Rectangle, camera: Camera) -> float:
    """How high a stage has to be for a camera to show a box and its margins [pixels]."""
    half = max(box.y1 - camera.centre[1], camera.centre[1] - box.y0)
    return 2 * half * camera.scale / (1 - 2 * MARGIN)


def round_length(largest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``largest``.

    Raises:
        ValueError: ``largest`` is not positive.
    """
    if not largest > 0:
        raise ValueError("a length to round must be positive")
    power = 10.0 ** np.floor(np.log10(largest))
    step = max(s for s in (1.0, 2.0, 5.0) if s * power <= largest * (1 + 1e-9) or s == 1.0)
    return float(step * power)


def round_up(value: float) -> float:
    """The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten not below ``value``.

    1 for nothing, and for numbers so small that no power of ten is.
    """
    if not value > 1e-300:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return float(power * next(s for s in steps if s * power >= value * (1 - 1e-9)))
