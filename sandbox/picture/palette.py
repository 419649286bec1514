"""Colours and symbols: calm fills of bodies, ramps for tension, strong colours for forces.

Light, grey-blue and sand tints for bodies; orange for tension, light blue for what pushes, dark
blue for forces, magenta for stops and teal for traces keep apart for all common kinds of colour
blindness, by lightness as well as by hue.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from sandbox.picture.geometry import XY, arrow
from sandbox.picture.listing import Listing, flat, short

if TYPE_CHECKING:
    from sandbox.picture.frames import Pixels
    from sandbox.picture.paper import Paper

Painter: TypeAlias = "Pixels | Paper"
Colour = tuple[int, int, int]
Ink = Colour | None
Rings = Sequence[Sequence[XY]]
EM = 0.6875  # pixels of an em for one of pygame's own font's size
BACKGROUND: Colour = (255, 255, 255)
INK: Colour = (34, 40, 49)
FAINT_INK: Colour = (108, 117, 128)
HAIRLINE: Colour = (217, 221, 226)
TRACES: tuple[Colour, ...] = ((0, 126, 150), (182, 98, 16), (118, 84, 176), (190, 58, 116),
                              (104, 122, 30), (112, 86, 70))
"""Of several points, in this order; after the last the first again."""


class Style(NamedTuple):
    """Fill and outline of a body."""

    fill: Colour
    edge: Colour


WHEEL = Style((233, 230, 241), (128, 120, 156))  # of wheels of guides
ROLES: dict[str, Style] = {
    "phalanx": Style((213, 225, 238), (88, 112, 140)),
    "palm": Style((186, 195, 206), (84, 94, 107)),
    "ground": Style((200, 203, 207), (96, 101, 108)),
    "rocker": Style((205, 229, 219), (72, 122, 106)),
    "pulley": Style((228, 223, 240), (116, 104, 152)),
    "object": Style((244, 232, 206), (150, 124, 72)),
    "link": Style((228, 231, 235), (110, 118, 128)),
}
ZIGZAG = [0, 0, 0.16, 0, *(v for k in range(10) for v in (
    round(0.16 + 0.68 * (k + 0.5) / 10, 4), 1 - 2 * (k % 2))), 0.84, 0, 1, 0]
"""A coil as the pattern of a span, with straight ends."""
LEVELS = 32  # steps of either ramp: few enough for one palette of a GIF
NIGHT: Colour = (18, 23, 29)  # the ground of a page by night
TOKENS: dict[str, tuple[Colour, Colour]] = {
    "paper": (BACKGROUND, NIGHT), "ink": (INK, (230, 234, 238)),
    "faint_ink": (FAINT_INK, (154, 166, 178)), "hairline": (HAIRLINE, (44, 53, 63)),
    "force": ((14, 74, 158), (111, 176, 255)), "patch": ((159, 183, 216), (38, 66, 100)),
    "stop": ((200, 16, 122), (255, 92, 180)), "drive": ((96, 48, 140), (199, 157, 242)),
    "spring": ((70, 84, 100), (163, 178, 194)), "pin_ring": ((44, 52, 62), (195, 204, 214)),
    "slack": ((172, 178, 186), (113, 123, 134)), "rope": ((92, 86, 78), (185, 172, 152)),
    "velocity": ((16, 132, 60), (98, 212, 137)),
    "acceleration": ((164, 98, 0), (240, 176, 82)),
    "reaction": ((84, 116, 214), (147, 170, 245)), "axes": ((150, 62, 62), (224, 143, 143)),
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


def _ramp(*stops: tuple[float, Colour]) -> tuple[Colour, ...]:
    """Colours between those at some places from 0 to 1."""
    return tuple(next(mixed(low, high, (share - a) / (b - a))
                      for (a, low), (b, high) in pairwise(stops) if share <= b)
                 for share in (k / (LEVELS - 1) for k in range(LEVELS)))


# grey at no tension, over sand and orange, to a deep red; lightness falls all along
TENSION = _ramp((0.0, (160, 166, 173)), (0.3, (226, 164, 92)), (0.6, (228, 108, 34)),
                (1.0, (158, 18, 20)))
# pushing: the same grey, over light blue to a dark one
PUSH = _ramp((0.0, (160, 166, 173)), (0.3, (116, 180, 214)), (0.6, (44, 128, 196)),
             (1.0, (16, 52, 128)))


def hatch_lines(corners: Sequence[XY], pitch: float) -> list[tuple[XY, XY]]:
    """Slanted lines over the box of some corners; neighbouring areas have the same ones."""
    points = np.asarray(corners)
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    starts = np.arange((x0 + y0) // pitch * pitch, x1 + y1 + pitch, pitch).tolist()
    return [((c - y0, y0), (c - y1, y1)) for c in starts]


Part = tuple[tuple[Any, ...], Any]  # arguments of a style, and a subpath
TURN, HEAD = 9.5, 13.0  # radii of the mark of a motor or servo, and of the wedge of a stop


def _line(*coordinates: float) -> dict[str, list[float]]:
    return {"l": [*coordinates]}


def _disc(radius: float, line: float, edge: str = "pin_ring", fill: str = "paper") -> Part:
    """A circle whose outline lies within its radius."""
    return (fill, edge, line), {"c": [0.0, 0.0, 0.0, 0.0, radius - line / 2]}


def _square(half: float) -> list[float]:
    return [-half, -half, half, -half, half, half, -half, half]


def _arc(radius: float, first: float, sweep: float, steps: int = 24) -> list[float]:
    angles = [first + sweep * k / steps for k in range(steps + 1)]
    return flat(*((radius * math.cos(a), radius * math.sin(a)) for a in angles))


def _turn(sense: int) -> list[Part]:
    """An arc with a head about a hinge, counter-clockwise for sense 1."""
    arc = _arc(TURN, sense * math.pi / 4, sense * 3.9)
    x, y = arc[-2:]
    end = math.atan2(y, x)
    ux, uy = math.cos(end), math.sin(end)
    head = flat((x - sense * 8 * uy, y + sense * 8 * ux), (x + 3 * ux, y + 3 * uy),
                (x - 3 * ux, y - 3 * uy))
    return [(("", "drive", 1.5), _line(*arc)), (("drive",), head)]


def _valve(fill: str) -> list[Part]:
    return [((fill, "drive", 1.2), [0, 0, side * 7, 4.2, side * 7, -4.2]) for side in (1, -1)]


RING: Part = (("", "drive", 1.5), _line(*_arc(TURN, 0.0, math.tau, 48)))
DIAMOND = [8.5, 0, 0, 8.5, -8.5, 0, 0, -8.5]
AXIS, LETTER = ("", "axes", 1.3), ("", "axes", 1.1)
GLYPHS: dict[str, list[Part]] = {
    "pin": [_disc(3.6, 1.4)],
    "end": [_disc(2.7, 1.2)],
    "eye": [_disc(2.7, 1.0)],
    "weld": [(("pin_ring",), _square(2.6))],
    "rubs": [_disc(6.4, 1.1, "faint_ink", "faint_ink")],
    "slides": [_disc(6.4, 1.1, "faint_ink")],
    "roller": [_disc(6.0, 1.1)],
    "block": [(("paper", "pin_ring", 1.1), [-11.4, -5.4, 11.4, -5.4, 11.4, 5.4, -11.4, 5.4])],
    "ground": [(("#c8cbcf", "faint_ink", 1.2), [0, 0, -8, -12, 8, -12]),
               *((("", "faint_ink", 0.9), _line(x, -12, x - 5, -17)) for x in range(-8, 13, 5)),
               (("", "ink", 1.4), _line(-12, -12, 12, -12))],
    "stop": [(("stop",), [0.0, 0.0, *_arc(HEAD, -0.5, 1.0, 8)])],
    "holds": [(("ink", "ink", 1.4), DIAMOND)],
    "gone": [(("paper", "ink", 1.4), DIAMOND)],
    "dot": [(("spring",), {"c": [0.0, 0.0, 0.0, 0.0, 1.7]})],
    "braked": [(("drive", "drive", 1.5), _square(4.9))],
    "unbraked": [(("paper", "drive", 1.5), _square(4.9))],
    "motor": _turn(1),
    "motor_back": _turn(-1),
    "motor_rest": [RING],
    "servo": [RING, *((("", "drive", 2.0), _line(*(r * v for r in (TURN - 2.5, TURN + 3)
                                                  for v in way)))
                      for way in ((1, 0), (0, 1), (-1, 0), (0, -1)))],
    "belt": [(("drive", "paper", 0.6), [6, 4.5, -3.6, 8.7, -3.6, 0.3])],
    "belt_back": [(("drive", "paper", 0.6), [-6, 4.5, 3.6, 8.7, 3.6, 0.3])],
    "open": _valve("drive"),
    "shut": _valve("paper"),
    "pump": [_disc(7.5, 1.2, "drive"), (("drive",), [-4, 2, 4, 2, 0, -6])],
    "tank": [(("", "spring", 1.2), _line(-6, 0, -6, -6, 6, -6, 6, 0))],
    "axes": [(AXIS, _line(0, 0, 20, 0)), (("axes",), [26, 0, 19, 3, 19, -3]),
             (AXIS, _line(0, 0, 0, 20)), (("axes",), [0, 26, -3, 19, 3, 19]),
             (LETTER, _line(30, -3, 35, 3)), (LETTER, _line(30, 3, 35, -3)),
             (LETTER, _line(-3, 36, 0, 33)), (LETTER, _line(3, 36, -2, 29))],
    "cut": [(("force",), flat(*arrow((0, 0), (34, 0), 2.4, 10))),
            *((("", "paper", 1.8), _line(x - 2, -4.5, x + 2, 4.5)) for x in (13, 17))],
    "patch": [(("patch", "force", 1.2), [0, -6, 22, -6, 22, 0, 0, 6])],
    "slack": [(("", "slack", 1.8, 5), _line(0, 0, 26, 0))],
    "stiffer": [(("", "drive", 2.4), _line(*(
        short(v * (4 if k % 2 else 36)) for k, v in enumerate(ZIGZAG))))],
    "driven": [(("drive",), flat(*arrow((0, 0), (30, 0), 7.0, 17)))],
    "torque": [(("", "drive", 3.2), _line(*_arc(8, -0.9, 3.7))),
               (("drive",), [-8.8, -1.6, -3.6, 1.4, -11, 4.4])],
}


def glyph(out: Listing, name: str) -> str:
    """The name of a glyph, which the list has from then on."""
    if name not in out.glyphs:
        out.glyphs[name] = [[out.style(*style), path] for style, path in GLYPHS[name]]
    return name
