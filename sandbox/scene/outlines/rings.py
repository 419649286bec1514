"""Closed outlines as corners: their area, and where one crosses itself or another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers

Corner = tuple[float, float]
Ring = tuple[Corner, ...]
"""Corners in order, the last joined to the first."""
LINE = 1e-14
"""How wide corners in one line are, as a share of its length: rounding."""
STRAIGHT = 1e-12
"""A bend that is none but by rounding, a sine."""


def signed_area(ring: Ring) -> float:
    """Area [m^2] inside, negative where the corners go round clockwise."""
    x, y = (np.array(ring) - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def wound(ring: Ring, sense: int = 1) -> Ring:
    """The same corners counter-clockwise, or clockwise for a ``sense`` of -1."""
    return ring if sense * signed_area(ring) > 0 else ring[::-1]


def bends(ring: Ring) -> Array:
    """At each corner the cross product of the sides before and after it [m^2], [n]."""
    points = np.array(ring)
    after = np.roll(points, -1, axis=0) - points
    before = np.roll(after, 1, axis=0)
    return np.asarray(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])


def is_convex(ring: Ring) -> bool:
    """Whether every corner bends the same way and all of them together go round once."""
    points = np.array(ring)
    after = np.roll(points, -1, axis=0) - points
    before = np.roll(after, 1, axis=0)
    cross = bends(ring)
    if not ((cross > 0).all() or (cross < 0).all()):
        return False
    turned = np.arctan2(cross, np.sum(before * after, axis=1)).sum()
    return bool(abs(turned) < 3 * np.pi)


def inside(point: Corner, ring: Ring) -> bool:
    """Whether a point that is not on the outline lies within it."""
    corners = np.array(ring)
    (x, y), (x1, y1) = corners.T, np.roll(corners, -1, axis=0).T
    astride = (y > point[1]) != (y1 > point[1])
    at = x[astride] + (point[1] - y[astride]) / (y1 - y)[astride] * (x1 - x)[astride]
    return bool(np.count_nonzero(at > point[0]) % 2)


def without_straight(ring: Ring) -> Ring:
    """The corners at which the outline bends by more than rounding."""
    points = np.array(ring)
    while True:
        after = np.roll(points, -1, axis=0) - points
        before = np.roll(after, 1, axis=0)
        size = np.hypot(*after.T) * np.hypot(*before.T)
        bend = np.abs(before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0])
        # remove one of two neighbours at a time: without it the other may be needed
        straight = np.flatnonzero(bend <= STRAIGHT * size)
        if not len(straight) or len(points) - len(straight[::2]) < 3:
            return tuple((x, y) for x, y in points.tolist())
        points = np.delete(points, straight[::2], axis=0)


@dataclass(frozen=True)
class Meeting:
    """Two sides that should not meet: which ring and corner each starts from, and where."""

    one: tuple[int, int]
    other: tuple[int, int]
    at: Corner

    @property
    def place(self) -> str:
        """Where it is, in words [m]."""
        return f"at [{self.at[0]:.6g}, {self.at[1]:.6g}]"


def first_meeting(rings: Sequence[Ring]) -> Meeting | None:
    """The first two sides of closed outlines that cross or touch each other, in their order.

    Sides are looked at from left to right, each against those that begin before it ends.
    """
    starts = np.concatenate([np.array(ring) for ring in rings])
    ends = np.concatenate([np.roll(np.array(ring), -1, axis=0) for ring in rings])
    names = [(k, i) for k, ring in enumerate(rings) for i in range(len(ring))]
    after = np.concatenate([np.roll(np.arange(len(ring)), -1) + offset for ring, offset in zip(
        rings, np.cumsum([0, *map(len, rings[:-1])]), strict=True)])
    left, right = np.minimum(starts, ends), np.maximum(starts, ends)
    order = np.argsort(left[:, 0], kind="stable")
    until = np.searchsorted(left[order, 0], right[order, 0], side="right")
    found: list[tuple[int, int]] = []
    for k, i in enumerate(order.tolist()):
        others = order[k + 1:until[k]]
        near = (left[others, 1] <= right[i, 1]) & (right[others, 1] >= left[i, 1])
        found += _meeting(i, others[near], starts, ends, after)
    if not found:
        return None
    i, j = min(found)
    return Meeting(names[i], names[j], _place(starts[i], ends[i], starts[j], ends[j]))


def _meeting(
    i: int, others: Integers, starts: Array, ends: Array, after: Integers,
) -> Iterator[tuple[int, int]]:
    """Which of the sides ``others``, whose boxes overlap that of side i, meet it."""
    p, q, r, s = starts[i], ends[i], starts[others], ends[others]

    def beside(a: Array, b: Array, c: Array) -> Array:
        u, v = np.atleast_2d(b - a), np.atleast_2d(c - a)
        return np.sign(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    met = ((beside(p, q, r) * beside(p, q, s) <= 0) & (beside(r, s, p) * beside(r, s, q) <= 0))
    joined = (after[i] == others) | (after[others] == i)
    # neighbours share a corner; they meet otherwise only where one runs back along the other
    u, v = q - p, s - r
    back = (u[0] * v[:, 1] == u[1] * v[:, 0]) & (v @ u < 0)
    for j in others[met & (~joined | back)].tolist():
        yield min(i, j), max(i, j)


def _place(p: Array, q: Array, r: Array, s: Array) -> Corner:
    """Where two sides that meet do so: at a point of both, or the middle of what they share."""
    u, v = q - p, s - r
    cross = u[0] * v[1] - u[1] * v[0]
    if cross:
        w = ((r - p)[0] * v[1] - (r - p)[1] * v[0]) / cross
        x, y = (p + w * u).tolist()
    else:
        x, y = (sorted((p, q, r, s), key=lambda one: float(one @ u))[1]).tolist()
    return x, y


def ring_fault(ring: Ring) -> str:
    """What keeps corners from being an outline, with the place; empty if nothing does."""
    points = np.array(ring)
    if (same := np.flatnonzero((points == np.roll(points, -1, axis=0)).all(axis=1))).size:
        i = int(same[0])
        return f"corners {i} and {(i + 1) % len(ring)} are the same point"
    along, across = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[:2]
    if across <= LINE * along:
        x, y = ring[0]
        return f"the outline has no area: its corners lie in one line through [{x:.6g}, {y:.6g}]"
    if meeting := (None if is_convex(ring) else first_meeting([ring])):
        return (f"the outline crosses or touches itself {meeting.place}, where the side from "
                f"corner {meeting.one[1]} meets that from corner {meeting.other[1]}")
    return ""


def hole_fault(outer: Ring, holes: Sequence[Ring]) -> tuple[int, str] | None:
    """The first hole that does not lie in an outline by itself, and why."""
    for k, hole in enumerate(holes):
        for what, ring in (("the outline", outer),
                           *((f"hole {m}", holes[m]) for m in range(k))):
            if meeting := first_meeting([ring, hole]):
                return k, (f"this hole meets {what} {meeting.place}, at the side from corner "
                           f"{meeting.other[1]}")
        if not inside(hole[0], outer):
            x, y = hole[0]
            return k, f"this hole lies outside of the outline at [{x:.6g}, {y:.6g}]"
        for m in range(k):
            if inside(hole[0], holes[m]) or inside(holes[m][0], hole):
                return k, f"this hole and hole {m} lie one in the other"
    return None
