"""What paints shapes: the protocol that pygame and matplotlib's renderers follow here."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from sandbox.picture.palette import Colour, lighter

XY = tuple[float, float]
EM = 0.6875
"""Pixels of an em for one of pygame's own font's size."""


class Painter(Protocol):
    """What paints shapes, in pixels, y down."""

    def area(self, rings: Sequence[Sequence[Sequence[XY]]], fill: Colour | None,
             edge: Colour | None, width: float, *, union: bool = False, hatch: float = 0.0) -> None:
        """Paint rings, each as its line and that line moved by half the width outwards, inwards.

        With ``union`` they are one area with one outline outside of it; otherwise the second and
        later rings are holes. ``hatch`` is the pitch of slanted lines.
        """

    def line(self, path: Sequence[XY], ink: Colour, width: float) -> None:
        """Paint connected lines."""

    def simple(self, corners: Sequence[XY], fill: Colour | None, edge: Colour | None,
               width: float) -> None:
        """Paint a small polygon with an outline about its line."""

    def disc(self, centre: XY, radius: float, fill: Colour | None, edge: Colour | None,
             width: float, *, hatch: float = 0.0) -> None:
        """Paint a circle with an outline about its line."""

    def text(self, middle: XY, words: str, size: int, ink: Colour, leader: Sequence[XY]) -> None:
        """Write a label with a rim, and a thin line to what it belongs to."""


class SheetPainter(Painter, Protocol):
    """What paints a whole picture: shapes on a picture that may be enlarged, and plain texts."""

    enlarge: int
    """Pixels of shapes per finished pixel."""

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """Write words right of and below a corner [finished pixels]."""


def hatch_ink(edge: Colour) -> Colour:
    """The colour of hatching in a fill with this edge."""
    return lighter(edge, 0.45)


def hatch_lines(corners: Sequence[XY], pitch: float) -> list[tuple[XY, XY]]:
    """Slanted lines over the box of some corners; neighbouring areas have the same ones."""
    points = np.asarray(corners)
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    starts = np.arange((x0 + y0) // pitch * pitch, x1 + y1 + pitch, pitch).tolist()
    return [((c - y0, y0), (c - y1, y1)) for c in starts]
