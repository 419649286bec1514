"""Colours: calm ones for bodies, a ramp for tension, signals for forces and stops.

Light, grey-blue and sand tints for bodies; orange for tension, light blue for what pushes, dark
blue for forces, magenta for stops and teal for traces keep apart for all common kinds of colour
blindness, by lightness as well as by hue.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

Colour = tuple[int, int, int]

BACKGROUND: Colour = (255, 255, 255)
INK: Colour = (34, 40, 49)
FAINT_INK: Colour = (108, 117, 128)
HAIRLINE: Colour = (217, 221, 226)
FORCE: Colour = (14, 74, 158)
STOP: Colour = (200, 16, 122)
DRIVE: Colour = (96, 48, 140)
SPRING: Colour = (70, 84, 100)
PIN_RING: Colour = (44, 52, 62)
SLACK: Colour = (172, 178, 186)
ROPE: Colour = (92, 86, 78)
TRACE: Colour = (0, 126, 150)
TRACES: tuple[Colour, ...] = (TRACE, (182, 98, 16), (118, 84, 176), (190, 58, 116), (104, 122, 30),
                              (112, 86, 70))
"""Of several points, in this order; after the last the first again."""
VELOCITY: Colour = (16, 132, 60)
ACCELERATION: Colour = (164, 98, 0)
REACTION: Colour = (84, 116, 214)
AXES: Colour = (150, 62, 62)
LIQUID: Colour = (228, 239, 248)
LIQUID_EDGE: Colour = (126, 164, 196)
WHEEL: Colour = (233, 230, 241)
WHEEL_EDGE: Colour = (128, 120, 156)


@dataclass(frozen=True)
class Style:
    """Fill and outline of a body."""

    fill: Colour
    edge: Colour


ROLES: dict[str, Style] = {
    "phalanx": Style((213, 225, 238), (88, 112, 140)),
    "palm": Style((186, 195, 206), (84, 94, 107)),
    "ground": Style((200, 203, 207), (96, 101, 108)),
    "rocker": Style((205, 229, 219), (72, 122, 106)),
    "pulley": Style((228, 223, 240), (116, 104, 152)),
    "object": Style((244, 232, 206), (150, 124, 72)),
    "link": Style((228, 231, 235), (110, 118, 128)),
}

# grey at no tension, over sand and orange, to a deep red; lightness falls all along
_RAMP: tuple[tuple[float, Colour], ...] = (
    (0.0, (160, 166, 173)), (0.3, (226, 164, 92)), (0.6, (228, 108, 34)), (1.0, (158, 18, 20)),
)
# what pushes: the same grey, over light blue to a dark one
_PUSH_RAMP: tuple[tuple[float, Colour], ...] = (
    (0.0, (160, 166, 173)), (0.3, (116, 180, 214)), (0.6, (44, 128, 196)), (1.0, (16, 52, 128)),
)
LEVELS = 32
"""Steps of either ramp: few enough for one palette of a GIF."""
NIGHT: Colour = (18, 23, 29)
"""The ground of a page by night."""
TOKENS: dict[str, tuple[Colour, Colour]] = {
    "paper": (BACKGROUND, NIGHT), "ink": (INK, (230, 234, 238)),
    "faint_ink": (FAINT_INK, (154, 166, 178)), "hairline": (HAIRLINE, (44, 53, 63)),
    "force": (FORCE, (111, 176, 255)), "patch": ((159, 183, 216), (38, 66, 100)),
    "stop": (STOP, (255, 92, 180)), "drive": (DRIVE, (199, 157, 242)),
    "spring": (SPRING, (163, 178, 194)), "pin_ring": (PIN_RING, (195, 204, 214)),
    "slack": (SLACK, (113, 123, 134)), "rope": (ROPE, (185, 172, 152)),
    "velocity": (VELOCITY, (98, 212, 137)), "acceleration": (ACCELERATION, (240, 176, 82)),
    "reaction": (REACTION, (147, 170, 245)), "axes": (AXES, (224, 143, 143)),
    "liquid": (LIQUID, (22, 40, 58)), "liquid_edge": (LIQUID_EDGE, (79, 126, 166)),
}
"""Colours of styles by day and by night."""


def _mix(ramp: tuple[tuple[float, Colour], ...], fraction: float) -> Colour:
    for (a, low), (b, high) in pairwise(ramp):
        if fraction <= b:
            w = (fraction - a) / (b - a)
            red, green, blue = (round(p + w * (q - p)) for p, q in zip(low, high, strict=True))
            return red, green, blue
    return ramp[-1][1]


TENSION: tuple[Colour, ...] = tuple(_mix(_RAMP, k / (LEVELS - 1)) for k in range(LEVELS))
PUSH: tuple[Colour, ...] = tuple(_mix(_PUSH_RAMP, k / (LEVELS - 1)) for k in range(LEVELS))


def mixed(one: Colour, other: Colour, fraction: float) -> Colour:
    """``one`` with a fraction (0 to 1) of ``other``."""
    red, green, blue = (round(p + fraction * (q - p)) for p, q in zip(one, other, strict=True))
    return red, green, blue


def css(colour: Colour) -> str:
    """``#rrggbb``."""
    return "#" + "".join(f"{value:02x}" for value in colour)


def lighter(colour: Colour, fraction: float = 0.5) -> Colour:
    """``colour`` mixed with white."""
    red, green, blue = (round(c + (255 - c) * fraction) for c in colour)
    return red, green, blue
