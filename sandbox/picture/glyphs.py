"""Symbols of constant size: styles and subpaths in points, y up."""

from __future__ import annotations

import math
from typing import Any

from sandbox.picture.listing import Listing, flat, short

Part = tuple[tuple[Any, ...], Any]
"""Arguments of a style, and a subpath."""
TURN, HEAD = 9.5, 13.0
"""Radii of the mark of a motor or servo, and of the wedge of a stop."""


def _line(*coordinates: float) -> dict[str, list[float]]:
    return {"l": [*coordinates]}


def _disc(radius: float, line: float, edge: str = "pin_ring", fill: str = "paper") -> Part:
    """A circle whose outline lies within its radius."""
    return (fill, edge, line), {"c": [0.0, 0.0, 0.0, 0.0, radius - line / 2]}


def _square(half: float) -> list[float]:
    return [-half, -half, half, -half, half, half, -half, half]


def _arc(radius: float, first: float, sweep: float, steps: int = 24) -> list[float]:
    """Points on an arc from an angle through ``sweep`` [rad]."""
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


def _tick(turn: float) -> dict[str, list[float]]:
    return _line(*flat(*((r * math.cos(turn), r * math.sin(turn))
                         for r in (TURN - 2.5, TURN + 3))))


def _valve(fill: str) -> list[Part]:
    return [((fill, "drive", 1.2), [0, 0, side * 7, 4.2, side * 7, -4.2]) for side in (1, -1)]


def _coil(width: float) -> dict[str, list[float]]:
    inner = [v for k in range(10) for v in (short(width * (0.16 + 0.68 * (k + 0.5) / 10)),
                                            4.0 * (1 - 2 * (k % 2)))]
    return _line(0.0, 0.0, short(0.16 * width), 0.0, *inner, short(0.84 * width), 0.0, width, 0.0)


def _arrow(width: float, shaft: float, head: float) -> list[float]:
    half, wide, neck = shaft / 2, 0.45 * head, width - head
    return [0, half, neck, half, neck, wide, width, 0, neck, -wide, neck, -half, 0, -half]


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
    "servo": [RING, *((("", "drive", 2.0), _tick(k * math.pi / 2)) for k in range(4))],
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
    "cut": [(("force",), _arrow(34, 2.4, 10)),
            *((("", "paper", 1.8), _line(x - 2, -4.5, x + 2, 4.5)) for x in (13, 17))],
    "patch": [(("patch", "force", 1.2), [0, -6, 22, -6, 22, 0, 0, 6])],
    "slack": [(("", "slack", 1.8, 5), _line(0, 0, 26, 0))],
    "stiffer": [(("", "drive", 2.4), _coil(36))],
    "driven": [(("drive",), _arrow(30, 7.0, 17))],
    "torque": [(("", "drive", 3.2), _line(*_arc(8, -0.9, 3.7))),
               (("drive",), [-8.8, -1.6, -3.6, 1.4, -11, 4.4])],
}


def glyph(out: Listing, name: str) -> str:
    """The name of a glyph, which the list has from then on."""
    if name not in out.glyphs:
        out.glyphs[name] = [[out.style(*style), path] for style, path in GLYPHS[name]]
    return name
