"""A cord that goes round a wheel between two points: where it touches, and how far round."""

from __future__ import annotations

import math
from dataclasses import dataclass

from sandbox.kinds.elements import GRAZE
from sandbox.model.lifts import passes_by
from sandbox.scene.geometry import Vec


@dataclass(frozen=True)
class Wrap:
    """How a cord goes round its wheel; points are the world's [m]."""

    on: Vec
    """Where it comes on."""
    off: Vec
    """Where it goes off."""
    middle: float
    """Direction from the wheel's centre to the middle of the arc [rad]."""
    angle: float
    """How far round it goes [rad]."""
    crosses: bool
    """Whether its two straight parts cross each other."""


def wrap_round(
    before: Vec, centre: Vec, after: Vec, radius: float, *, past: bool = False,
) -> Wrap | None:
    """The cord from a point ``before`` round a wheel at ``centre`` to ``after`` (world, [m]).

    None if one of the points lies in the wheel. A cord that goes straight ``past`` comes on and
    goes off where it is nearest. With u along the cord and n its
    left normal, a wheel of ``radius`` r, positive right of the path, is touched at c + r n.
    """
    sign = math.copysign(1.0, radius)
    if past:
        x, y = _normal(before, after, 0.0)
        far = sign * (passes_by([before, centre, after], [0.0, radius, 0.0]) + abs(radius))
        foot = centre[0] + far * x, centre[1] + far * y
        return Wrap(foot, foot, math.atan2(sign * y, sign * x), 0.0, crosses=False)
    if min(math.dist(before, centre), math.dist(after, centre)) <= abs(radius):
        return None
    n_on = _normal(before, centre, -radius)
    n_off = _normal(centre, after, radius)
    on = centre[0] + radius * n_on[0], centre[1] + radius * n_on[1]
    off = centre[0] + radius * n_off[0], centre[1] + radius * n_off[1]
    between = math.atan2(n_on[1], n_on[0]) - math.atan2(n_off[1], n_off[0])
    angle = (sign * between + GRAZE) % (2 * math.pi) - GRAZE  # to touch is not to go once round
    middle = math.atan2(on[1] - centre[1], on[0] - centre[0]) - sign * angle / 2
    return Wrap(on, off, middle, angle, _cross(before, on, off, after))


def _normal(start: Vec, end: Vec, offset: float) -> Vec:
    """Left normal n of a straight part with n . (end - start) = offset."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    straight = math.sqrt(dx * dx + dy * dy - offset * offset)
    square = dx * dx + dy * dy
    return (offset * dx - straight * dy) / square, (straight * dx + offset * dy) / square


def _cross(a: Vec, b: Vec, c: Vec, d: Vec) -> bool:
    """Whether the segments a-b and c-d cross."""
    def side(p: Vec, q: Vec, r: Vec) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
