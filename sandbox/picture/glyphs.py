"""Symbols of constant size: subpaths in points, y up."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from sandbox.picture.listing import Listing, short

PIN = 3.6
"""Radius of a pin."""
TURN = 9.5
"""Radius of the mark of a motor or servo."""
HEAD = 13.0
"""Radius of the wedge of a stop."""
Glyph = list[list[Any]]


def _circle(radius: float, x: float = 0.0, y: float = 0.0) -> dict[str, list[float]]:
    return {"c": [x, y, x, y, radius]}


def _square(half: float) -> list[float]:
    return [-half, -half, half, -half, half, half, -half, half]


def _arc(radius: float, first: float, sweep: float, steps: int = 24) -> list[float]:
    """Points on an arc from an angle through ``sweep`` [rad]."""
    angles = [first + sweep * k / steps for k in range(steps + 1)]
    return [short(v) for a in angles for v in (radius * math.cos(a), radius * math.sin(a))]


def _ring(out: Listing, radius: float, line: float, edge: str = "pin_ring",
          fill: str = "paper") -> Glyph:
    """A circle whose outline lies within its radius."""
    return [[out.style(fill, edge, line), _circle(radius - line / 2)]]


def _ground(out: Listing) -> Glyph:
    fill, edge = "#c8cbcf", "faint_ink"
    out.inks[fill] = [fill, "#3a4048"]
    strokes = [[out.style("", "faint_ink", 0.9), {"l": [x, -12, x - 5, -17]}]
               for x in range(-8, 13, 5)]
    return [[out.style(fill, edge, 1.2), [0, 0, -8, -12, 8, -12]], *strokes,
            [out.style("", "ink", 1.4), {"l": [-12, -12, 12, -12]}]]


def _stop(out: Listing) -> Glyph:
    return [[out.style("stop"), [0.0, 0.0, *_arc(HEAD, -0.5, 1.0, 8)]]]


def _diamond(out: Listing, fill: str) -> Glyph:
    return [[out.style(fill, "ink", 1.4), [8.5, 0, 0, 8.5, -8.5, 0, 0, -8.5]]]


def _brake(out: Listing, fill: str) -> Glyph:
    return [[out.style(fill, "drive", 1.5), _square(4.9)]]


def _motor(out: Listing, sense: int) -> Glyph:
    """An arc with a head about a hinge, counter-clockwise for sense 1; a ring for 0."""
    line = out.style("", "drive", 1.5)
    if sense == 0:
        return [[line, {"l": _arc(TURN, 0.0, math.tau, 48)}]]
    arc = _arc(TURN, sense * math.pi / 4, sense * 3.9)
    x, y = arc[-2:]
    end = math.atan2(y, x)
    ahead = (-sense * math.sin(end), sense * math.cos(end))
    out_x, out_y = math.cos(end), math.sin(end)
    head = [x + 8 * ahead[0], y + 8 * ahead[1], x + 3 * out_x, y + 3 * out_y,
            x - 3 * out_x, y - 3 * out_y]
    return [[line, {"l": arc}], [out.style("drive"), [short(v) for v in head]]]


def _servo(out: Listing) -> Glyph:
    ticks = [{"l": [short(r * v) for r in (TURN - 2.5, TURN + 3) for v in (
        math.cos(k * math.pi / 2), math.sin(k * math.pi / 2))]} for k in range(4)]
    return [*_motor(out, 0), *[[out.style("", "drive", 2.0), tick] for tick in ticks]]


def _valve(out: Listing, fill: str) -> Glyph:
    style = out.style(fill, "drive", 1.2)
    return [[style, [0, 0, 7, 4.2, 7, -4.2]], [style, [0, 0, -7, 4.2, -7, -4.2]]]


def _axes(out: Listing) -> Glyph:
    line, fill = out.style("", "axes", 1.3), out.style("axes")
    letter = out.style("", "axes", 1.1)
    return [[line, {"l": [0, 0, 20, 0]}], [fill, [26, 0, 19, 3, 19, -3]],
            [line, {"l": [0, 0, 0, 20]}], [fill, [0, 26, -3, 19, 3, 19]],
            [letter, {"l": [30, -3, 35, 3]}], [letter, {"l": [30, 3, 35, -3]}],
            [letter, {"l": [-3, 36, 0, 33]}], [letter, {"l": [3, 36, -2, 29]}]]


def _coil(width: float, line: int) -> Glyph:
    steps = 10
    inner = [v for k in range(steps) for v in (width * (0.16 + 0.68 * (k + 0.5) / steps),
                                               4.0 * (1 - 2 * (k % 2)))]
    return [[line, {"l": [short(v) for v in (
        0, 0, 0.16 * width, 0, *inner, 0.84 * width, 0, width, 0)]}]]


def _rope(out: Listing) -> Glyph:
    nicks = [[out.style("", "paper", 1.3), {"l": [x - 2.9, -2.9, x + 2.9, 2.9]}]
             for x in (6.5, 13, 19.5, 26)]
    return [[out.style("", "rope", 4.6), {"l": [0, 0, 30, 0]}], *nicks]


def _arrow(width: float, shaft: float, head: float) -> list[float]:
    half, wide, neck = shaft / 2, 0.45 * head, width - head
    return [0, half, neck, half, neck, wide, width, 0, neck, -wide, neck, -half, 0, -half]


def _cut(out: Listing) -> Glyph:
    bars = [[out.style("", "paper", 1.8), {"l": [x - 2, -4.5, x + 2, 4.5]}] for x in (13, 17)]
    return [[out.style("force"), _arrow(34, 2.4, 10)], *bars]


def _bent(out: Listing) -> Glyph:
    return [[out.style("", "drive", 3.2), {"l": _arc(8, -0.9, 3.7)}],
            [out.style("drive"), [-8.8, -1.6, -3.6, 1.4, -11, 4.4]]]


MADE: dict[str, Callable[[Listing], Glyph]] = {
    "pin": lambda out: _ring(out, PIN, 1.4),
    "end": lambda out: _ring(out, 0.75 * PIN, 1.2),
    "eye": lambda out: _ring(out, 2.7, 1.0),
    "weld": lambda out: [[out.style("pin_ring"), _square(2.6)]],
    "rubs": lambda out: _ring(out, 6.4, 1.1, "faint_ink", "faint_ink"),
    "slides": lambda out: _ring(out, 6.4, 1.1, "faint_ink"),
    "roller": lambda out: _ring(out, 6.0, 1.1),
    "block": lambda out: [[out.style("paper", "pin_ring", 1.1), [
        -11.4, -5.4, 11.4, -5.4, 11.4, 5.4, -11.4, 5.4]]],
    "ground": _ground,
    "stop": _stop,
    "holds": lambda out: _diamond(out, "ink"),
    "gone": lambda out: _diamond(out, "paper"),
    "dot": lambda out: [[out.style("spring"), _circle(1.7)]],
    "braked": lambda out: _brake(out, "drive"),
    "unbraked": lambda out: _brake(out, "paper"),
    "motor": lambda out: _motor(out, 1),
    "motor_back": lambda out: _motor(out, -1),
    "motor_rest": lambda out: _motor(out, 0),
    "servo": _servo,
    "belt": lambda out: [[out.style("drive", "paper", 0.6), [6, 4.5, -3.6, 8.7, -3.6, 0.3]]],
    "belt_back": lambda out: [[out.style("drive", "paper", 0.6), [-6, 4.5, 3.6, 8.7, 3.6, 0.3]]],
    "open": lambda out: _valve(out, "drive"),
    "shut": lambda out: _valve(out, "paper"),
    "pump": lambda out: [*_ring(out, 7.5, 1.2, "drive"),
                         [out.style("drive"), [-4, 2, 4, 2, 0, -6]]],
    "tank": lambda out: [[out.style("", "spring", 1.2), {"l": [-6, 0, -6, -6, 6, -6, 6, 0]}]],
    "axes": _axes,
    "cut": _cut,
    "patch": lambda out: [[out.style("patch", "force", 1.2), [0, -6, 22, -6, 22, 0, 0, 6]]],
    "rope": _rope,
    "slack": lambda out: [[out.style("", "slack", 1.8, 5), {"l": [0, 0, 26, 0]}]],
    "spring": lambda out: _coil(36, out.style("", "spring", 1.2)),
    "stiffer": lambda out: _coil(36, out.style("", "drive", 2.4)),
    "driven": lambda out: [[out.style("drive"), _arrow(30, 7.0, 17)]],
    "torque": _bent,
}
"""By name: what makes each of them."""


def glyph(out: Listing, name: str) -> str:
    """The name of a glyph, which the list has from then on."""
    if name not in out.glyphs:
        out.glyphs[name] = MADE[name](out)
    return name
