"""What of an outline is below a level, side by side: area and its moment, by Green's theorem.

With d the height over the level, of the part of the outline that is below it,

    A = - ∮ d dx          ∬ x dA = - ∮ x d dx

The level itself, which closes that part, has d = 0 and gives nothing.
"""

from __future__ import annotations

import math

from sandbox.engine.kernel import kernel
from sandbox.numeric import Array


@kernel
def below(
    sides: Array, first: int, last: int, c: float, s: float, angle: float, height: float,
) -> tuple[float, float]:
    """Area below a level [m^2], and its moment about the upright line through the centre [m^3].

    Args:
        sides: of all outlines, from the centres of mass, [k, 5].
        first: the outline's first.
        last: where it ends.
        c: cosine of the body's angle.
        s: sine of it.
        angle: it [rad].
        height: of the centre of mass over the level [m].
    """
    area, moment = 0.0, 0.0
    for k in range(first, last):
        px, py, radius = sides[k, 0], sides[k, 1], sides[k, 4]
        x, d = c * px - s * py, s * px + c * py + height
        if radius > 0.0:
            one, two = _arc(x, d, radius, sides[k, 2] + angle, sides[k, 3] - sides[k, 2])
        else:
            qx, qy = sides[k, 2], sides[k, 3]
            one, two = _straight(x, d, c * qx - s * qy, s * qx + c * qy + height)
        area -= one
        moment -= two
    return area, moment


@kernel
def _straight(x1: float, d1: float, x2: float, d2: float) -> tuple[float, float]:
    """∫ d dx and ∫ x d dx along what of a side is below d = 0."""
    if d1 >= 0.0 and d2 >= 0.0:
        return 0.0, 0.0
    if d1 > 0.0:
        x1, d1 = x1 + d1 / (d1 - d2) * (x2 - x1), 0.0
    elif d2 > 0.0:
        x2, d2 = x1 + d1 / (d1 - d2) * (x2 - x1), 0.0
    return ((d1 + d2) / 2 * (x2 - x1),
            (x2 - x1) / 6 * (2 * x1 * d1 + x1 * d2 + x2 * d1 + 2 * x2 * d2))


@kernel
def _arc(x: float, d: float, r: float, start: float, span: float) -> tuple[float, float]:
    """The same along an arc about (x, d) that goes counter-clockwise by ``span``."""
    if d - r >= 0.0:
        return 0.0, 0.0
    half = math.asin(min(max(-d / r, -1.0), 1.0))
    begin = start - math.floor(start / math.tau) * math.tau
    one, two = 0.0, 0.0
    for n in range(3):  # below is from pi - half to 2 pi + half
        turn = (n - 1) * math.tau
        low = max(begin, math.pi - half + turn)
        high = min(begin + span, math.tau + half + turn)
        if high > low:
            a, b = _flat(d, r, high) - _flat(d, r, low), _flat_x(d, r, high) - _flat_x(d, r, low)
            one += a
            two += x * a + b
    return one, two


@kernel
def _flat(d: float, r: float, phi: float) -> float:
    """Of the arc up to an angle ∫ d dx."""
    return -r * (r * (phi - math.sin(phi) * math.cos(phi)) / 2 - d * math.cos(phi))


@kernel
def _flat_x(d: float, r: float, phi: float) -> float:
    """Of the arc up to an angle ∫ x d dx, x from its centre."""
    s = math.sin(phi)
    return -r * r * (d * s**2 / 2 + r * s**3 / 3)
