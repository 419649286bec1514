"""Colours, calm ones for bodies, a ramp for tension, signals for forces; and what paints with them.

Light, grey-blue and sand tints for bodies; orange for tension, light blue for what pushes, dark
blue for forces, magenta for stops and teal for traces keep apart for all common kinds of colour
blindness, by lightness as well as by hue.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np

from sandbox.picture.geometry import XY

Colour = tuple[int, int, int]
EM = 0.6875
"""Pixels of an em for one of pygame's own font's size."""
BACKGROUND: Colour = (255, 255, 255)
INK: Colour = (34, 40, 49)
FAINT_INK: Colour = (108, 117, 128)
HAIRLINE: Colour = (217, 221, 226)
FORCE: Colour = (14, 74, 158)
DRIVE: Colour = (96, 48, 140)
SPRING: Colour = (70, 84, 100)
SLACK: Colour = (172, 178, 186)
TRACE: Colour = (0, 126, 150)
TRACES: tuple[Colour, ...] = (TRACE, (182, 98, 16), (118, 84, 176), (190, 58, 116), (104, 122, 30),
                              (112, 86, 70))
"""Of several points, in this order; after the last the first again."""
VELOCITY: Colour = (16, 132, 60)
ACCELERATION: Colour = (164, 98, 0)
REACTION: Colour = (84, 116, 214)
AXES: Colour = (150, 62, 62)


class Style(NamedTuple):
    """Fill and outline of a body."""

    fill: Colour
    edge: Colour


WHEEL = Style((233, 230, 241), (128, 120, 156))
"""Of wheels of guides."""
ROLES: dict[str, Style] = {
    "phalanx": Style((213, 225, 238), (88, 112, 140)),
    "palm": Style((186, 195, 206), (84, 94, 107)),
    "ground": Style((200, 203, 207), (96, 101, 108)),
    "rocker": Style((205, 229, 219), (72, 122, 106)),
    "pulley": Style((228, 223, 240), (116, 104, 152)),
    "object": Style((244, 232, 206), (150, 124, 72)),
    "link": Style((228, 231, 235), (110, 118, 128)),
}
LEVELS = 32
"""Steps of either ramp: few enough for one palette of a GIF."""
NIGHT: Colour = (18, 23, 29)
"""The ground of a page by night."""
TOKENS: dict[str, tuple[Colour, Colour]] = {
    "paper": (BACKGROUND, NIGHT), "ink": (INK, (230, 234, 238)),
    "faint_ink": (FAINT_INK, (154, 166, 178)), "hairline": (HAIRLINE, (44, 53, 63)),
    "force": (FORCE, (111, 176, 255)), "patch": ((159, 183, 216), (38, 66, 100)),
    "stop": ((200, 16, 122), (255, 92, 180)), "drive": (DRIVE, (199, 157, 242)),
    "spring": (SPRING, (163, 178, 194)), "pin_ring": ((44, 52, 62), (195, 204, 214)),
    "slack": (SLACK, (113, 123, 134)), "rope": ((92, 86, 78), (185, 172, 152)),
    "velocity": (VELOCITY, (98, 212, 137)), "acceleration": (ACCELERATION, (240, 176, 82)),
    "reaction": (REACTION, (147, 170, 245)), "axes": (AXES, (224, 143, 143)),
    "liquid": ((228, 239, 248), (22, 40, 58)), "liquid_edge": ((126, 164, 196), (79, 126, 166)),
    "#c8cbcf": ((200, 203, 207), (58, 64, 72)),
}
"""Colours of styles by day and by night; the last is that of the ground symbol."""


def mixed(one: Colour, other: Colour, fraction: float) -> Colour:
    """``one`` with a fraction (0 to 1) of ``other``."""
    red, green, blue = (round(p + fraction * (q - p)) for p, q in zip(one, other, strict=True))
    return red, green, blue


def lighter(colour: Colour, fraction: float = 0.5) -> Colour:
    """``colour`` mixed with white."""
    return mixed(colour, BACKGROUND, fraction)


def css(colour: Colour) -> str:
    """``#rrggbb``."""
    return "#" + "".join(f"{value:02x}" for value in colour)


def from_css(colour: str) -> Colour:
    """The colour of ``#rrggbb``."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def _ramp(*stops: tuple[float, Colour]) -> tuple[Colour, ...]:
    """Colours between those at some places from 0 to 1."""
    return tuple(next(mixed(low, high, (k / (LEVELS - 1) - a) / (b - a))
                      for (a, low), (b, high) in pairwise(stops) if k / (LEVELS - 1) <= b)
                 for k in range(LEVELS))


# grey at no tension, over sand and orange, to a deep red; lightness falls all along
TENSION = _ramp((0.0, (160, 166, 173)), (0.3, (226, 164, 92)), (0.6, (228, 108, 34)),
                (1.0, (158, 18, 20)))
# what pushes: the same grey, over light blue to a dark one
PUSH = _ramp((0.0, (160, 166, 173)), (0.3, (116, 180, 214)), (0.6, (44, 128, 196)),
             (1.0, (16, 52, 128)))


class Painter(Protocol):
    """What paints shapes on a picture that may be enlarged, in its pixels, y down; and texts."""

    enlarge: int
    """Pixels of shapes per finished pixel."""

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

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """Write words right of and below a corner [finished pixels]."""


def hatch_lines(corners: Sequence[XY], pitch: float) -> list[tuple[XY, XY]]:
    """Slanted lines over the box of some corners; neighbouring areas have the same ones."""
    points = np.asarray(corners)
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    starts = np.arange((x0 + y0) // pitch * pitch, x1 + y1 + pitch, pitch).tolist()
    return [((c - y0, y0), (c - y1, y1)) for c in starts]
