"""Lines of action of gears and racks, and the slip of rolling circles.

Involute flanks touch on a common tangent of the base circles, whose radius is r cos(pressure
angle): a crossed tangent of two gears side by side, an open one of a gear inside another; of a rack
on a line that turns with it. All functions take numbers or arrays over time.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np


class Flank(NamedTuple):
    """A flank that pushes."""

    gap: Any  #: gap along the line of action, up to a constant [m]
    period: Any  #: change of the gap over a whole turn of the line of centres [m]; inf of a rack
    x: Any  #: direction of the push on ``b``, a unit vector
    y: Any
    from_a: tuple[Any, Any]  #: from a's centre to its base circle on the line of action [m]


def gear_flank(
    radii: tuple[float, float], inside: bool, pressure: float, side: int, *,
    dx: Any, dy: Any, angle_a: Any, angle_b: Any,
) -> Flank:
    """A flank of two gears ``a`` and ``b``, the smaller ``inside`` the larger one or not.

    ``radii`` are of the pitch circles [m], ``pressure`` is the pressure angle [rad]. ``side``, +1
    or -1, is one of the two common tangents, ``dx`` and ``dy`` lead from centre to centre [m].
    """
    base_a, base_b = (side * radius * np.cos(pressure) for radius in radii)
    turns_b = 1.0 if inside else -1.0
    offset = base_a - turns_b * base_b
    straight = np.sqrt(np.maximum(dx**2 + dy**2 - offset**2, 1e-24))
    square = straight**2 + offset**2
    x, y = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    way = straight - offset * np.arctan2(y, x) + base_a * angle_a - turns_b * base_b * angle_b
    push = -turns_b
    return Flank(push * way, 2 * np.pi * abs(offset), push * x, push * y, (-base_a * y, base_a * x))


def rack_flank(
    radius: float, pressure: float, side: int, *,
    along: tuple[Any, Any], dx: Any, dy: Any, turned: Any,
) -> Flank:
    """A flank of a gear ``a`` and a rack ``b``, arguments as of :func:`gear_flank`.

    ``along`` is the pitch line, a unit vector in the world, with the gear to its left; ``dx`` and
    ``dy`` lead to a point of it. ``turned`` is the angle of the gear minus that of the rack [rad].
    """
    c, s = side * np.cos(pressure), np.sin(pressure)
    x, y = c * along[0] + s * along[1], c * along[1] - s * along[0]
    base = side * radius * np.cos(pressure)
    return Flank(x * dx + y * dy - base * turned, np.inf, x, y, (base * y, -base * x))


def rolled(
    radii: tuple[float, float], inside: bool, *, dx: Any, dy: Any, angle_a: Any, angle_b: Any,
) -> tuple[Any, float]:
    """Slip of a circle ``a`` on a circle ``b``, up to a constant, and its period [m].

    A whole turn of the line of centres adds the period. Arguments as of :func:`gear_flank`.
    """
    ra, rb = radii[0], -radii[1] if inside else radii[1]
    way = ra * angle_a + rb * angle_b - (ra + rb) * np.arctan2(dy, dx)
    return way, 2 * np.pi * abs(ra + rb)


def nearest(difference: Any, period: Any) -> Any:
    """A difference without the whole periods in it."""
    if not np.isfinite(period):
        return difference
    return difference - period * np.round(difference / period)
