"""The shapes that drawers make, whatever they are drawn on: pixels, or a list for SVG and PDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from sandbox.draw.film.palette import Colour
from sandbox.numeric import Array

XY = tuple[float, float]
Area = tuple[float, float, float, float]
"""Left, top, width, height [pixels]."""


@dataclass(frozen=True)
class FilledPolygon:
    """Filled, of at least three corners."""

    colour: Sequence[int]
    corners: Sequence[XY] | Array


@dataclass(frozen=True)
class DrawnLines:
    """Connected lines."""

    colour: Colour
    path: Sequence[XY] | Array
    width: int
    closed: bool = False


@dataclass(frozen=True)
class DrawnBox:
    """A rectangle, filled where its line has the width 0."""

    colour: Colour
    area: Area
    width: int


@dataclass(frozen=True)
class FilledCircle:
    """Filled."""

    colour: Colour
    centre: XY
    radius: float


@dataclass(frozen=True)
class Hatching:
    """Straight lines, each seen as far as it lies within a polygon."""

    colour: Colour
    lines: Sequence[tuple[XY, XY]]
    width: int
    corners: Sequence[XY]


Shape = FilledPolygon | DrawnLines | DrawnBox | FilledCircle | Hatching


class Paper(Protocol):
    """What is drawn on."""

    def get_size(self) -> tuple[int, int]:
        """Width and height [pixels]."""

    def set_clip(self, area: Sequence[float] | None, /) -> None:
        """What comes next is cut to ``area``: left, top, width, height [pixels]."""

    def keep(self, shape: Shape) -> None:
        """Lay a shape on top."""
