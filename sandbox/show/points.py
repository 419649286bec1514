"""Points of bodies and colours as the script takes them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from sandbox.picture.palette import Colour

Part = dict[str, Any]
"""What is drawn of something, as plain data: ``k`` its kind, ``l`` its layer, ``n`` its name."""
DIGITS = 7
"""Of a coordinate: what is lost is less than any screen shows."""


def short(value: float) -> float:
    """A number with as many digits as a picture needs; what is none is 0."""
    value = float(value)
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else 0.0


def point(body: int, at: Iterable[float]) -> list[float]:
    """A point of a body, ``[body, x, y]`` in its frame [m]."""
    x, y = at
    return [int(body), short(x), short(y)]


def path(points: Iterable[Iterable[float]]) -> list[float]:
    """Points as one list of numbers, x and y in turn."""
    return [short(v) for at in points for v in at]


def css(colour: Colour) -> str:
    """``#rrggbb``."""
    return "#" + "".join(f"{part:02x}" for part in colour)
