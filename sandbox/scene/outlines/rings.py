"""Closed outlines as corners: their area, where one crosses itself or another, convex pieces.

The outline is cut into triangles between its own corners (mapbox_earcut), and these are joined
over their inner sides, the longest first, as long as what comes of it stays convex (Hertel and
Mehlhorn 1983: at most four times as many pieces as there need be).

A piece's inner sides, the seams, are no surface: what comes near must not be caught there. A
piece touches with a normal n out of the outline only if no point of the outline lies that way
from the place that touches. So with a side of the outline n is its normal, and with a corner it
lies between those of the two sides, if the corner stands out; with a corner that does not, n is
that of one of its sides. Each piece has a list of these arcs of normals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import mapbox_earcut
import numpy as np

from sandbox.numeric import Array, Integers

Corner = tuple[float, float]
Ring = tuple[Corner, ...]
"""Corners in order, the last joined to the first."""
LINE = 1e-14
"""How wide corners in one line are, as a share of its length: rounding."""
STRAIGHT = 1e-12
"""A bend that is none but by rounding, a sine."""
PIECE_CORNERS = 64
"""Of one piece."""
COVERED = 1e-9
"""A share of the area by which the triangles may miss it: they are the outline but for rounding."""


def signed_area(ring: Ring) -> float:
    """Area [m^2] inside, negative where the corners go round clockwise."""
    x, y = (np.array(ring) - ring[0]).T
    return float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2)


def wound(ring: Ring, sense: int = 1) -> Ring:
    """The same corners counter-clockwise, or clockwise for a ``sense`` of -1."""
    return ring if sense * signed_area(ring) > 0 else ring[::-1]


def is_convex(ring: Ring) -> bool:
    """Whether every corner bends the same way and all of them together go round once."""
    points = np.array(ring)
    after = np.roll(points, -1, axis=0) - points
    before = np.roll(after, 1, axis=0)
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
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


class Meeting(NamedTuple):
    """Two sides that should not meet: the corners that they start from, and the place in words."""

    one: int
    other: int
    place: str


def first_meeting(rings: Sequence[Ring]) -> Meeting | None:
    """The first two sides of closed outlines that cross or touch each other, in their order.

    Sides are looked at from left to right, each against those that begin before it ends.
    """
    starts = np.concatenate([np.array(ring) for ring in rings])
    ends = np.concatenate([np.roll(np.array(ring), -1, axis=0) for ring in rings])
    names = [i for ring in rings for i in range(len(ring))]
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
    x, y = _place(starts[i], ends[i], starts[j], ends[j])
    return Meeting(names[i], names[j], f"at [{x:.6g}, {y:.6g}]")


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
                f"corner {meeting.one} meets that from corner {meeting.other}")
    return ""


def hole_fault(outer: Ring, holes: Sequence[Ring]) -> tuple[int, str] | None:
    """The first hole that does not lie in an outline by itself, and why."""
    for k, hole in enumerate(holes):
        for what, ring in (("the outline", outer),
                           *((f"hole {m}", holes[m]) for m in range(k))):
            if meeting := first_meeting([ring, hole]):
                return k, (f"this hole meets {what} {meeting.place}, at the side from corner "
                           f"{meeting.other}")
        if not inside(hole[0], outer):
            x, y = hole[0]
            return k, f"this hole lies outside of the outline at [{x:.6g}, {y:.6g}]"
        for m in range(k):
            if inside(hole[0], holes[m]) or inside(holes[m][0], hole):
                return k, f"this hole and hole {m} lie one in the other"
    return None


@dataclass(frozen=True)
class Piece:
    """A convex piece of an outline: its corners, counter-clockwise, and which way it faces."""

    ring: Ring
    faces: Array
    """Arcs of unit normals, a quarter turn at most each: x and y of both ends, [k, 4]."""


class CutError(ValueError):
    """An outline that could not be cut up, as rounding has it."""


@lru_cache(maxsize=256)
def pieces_of(outer: Ring, holes: tuple[Ring, ...] = ()) -> tuple[Piece, ...]:
    """The convex pieces of an outline that is sound, with holes that are.

    Raises:
        CutError: two sides are too close for pieces between them.
    """
    rings = [wound(without_straight(outer)),
             *(wound(without_straight(hole), -1) for hole in holes)]
    corners = [corner for ring in rings for corner in ring]
    after = _after(rings)
    cut = _joined(_triangles(rings, corners), corners)
    given: set[int] = set()
    found = []
    for piece in cut:
        faces = _faces(piece, corners, after, given)
        found.append(Piece(tuple(corners[i] for i in piece), faces))
    return tuple(found)


def _after(rings: Sequence[Ring]) -> list[int]:
    """The corner that follows each, all rings counted on."""
    after: list[int] = []
    for ring in rings:
        first = len(after)
        after += [first + (i + 1) % len(ring) for i in range(len(ring))]
    return after


def _triangles(rings: Sequence[Ring], corners: Sequence[Corner]) -> list[tuple[int, ...]]:
    """Triangles of corners' numbers, counter-clockwise."""
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    points = np.array(corners)
    # earcut compares products with 0: scale to a size of about 1 to avoid underflow
    points = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    found = mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3)
    made = [tuple(corner) for corner in found.tolist()]
    area = sum(abs(signed_area(ring)) * (1 if k == 0 else -1) for k, ring in enumerate(rings))
    whole = sum(abs(signed_area(tuple(corners[i] for i in each))) for each in made)
    if abs(whole - area) > COVERED * area:
        raise CutError(f"the triangles cover {whole:.6g} of {area:.6g} m^2")
    return [each if signed_area(tuple(corners[i] for i in each)) > 0 else each[::-1]
            for each in made]


def _joined(cut: list[tuple[int, ...]], corners: Sequence[Corner]) -> list[tuple[int, ...]]:
    """Pieces joined over inner sides while they stay convex and have not too many corners."""
    pieces = dict(enumerate(cut))
    owner = {side: n for n, piece in pieces.items() for side in _sides(piece)}
    inner = [side for side in owner if side[0] < side[1] and side[::-1] in owner]
    inner.sort(key=lambda side: (-math.dist(corners[side[0]], corners[side[1]]), side))
    for side in inner:
        one, other = owner[side], owner[side[::-1]]
        if one == other:
            continue
        made = _over(pieces[one], pieces[other], side)
        if len(made) > PIECE_CORNERS or not _stays_convex(made, side, corners):
            continue
        pieces[one] = made
        del pieces[other]
        owner.update({each: one for each in _sides(made)})
    return list(pieces.values())


def _sides(piece: tuple[int, ...]) -> list[tuple[int, int]]:
    return list(zip(piece, piece[1:] + piece[:1], strict=True))


def _over(one: tuple[int, ...], other: tuple[int, ...], side: tuple[int, int]) -> tuple[int, ...]:
    """Two pieces as one, without the side that they share."""
    i, j = one.index(side[1]), other.index(side[0])
    return (one[i:] + one[:i]) + (other[j:] + other[:j])[1:-1]


def _stays_convex(
    piece: tuple[int, ...], side: tuple[int, int], corners: Sequence[Corner],
) -> bool:
    for corner in side:
        k = piece.index(corner)
        (x0, y0), (x1, y1), (x2, y2) = (
            corners[piece[(k + d) % len(piece)]] for d in (-1, 0, 1))
        if (x1 - x0) * (y2 - y1) - (y1 - y0) * (x2 - x1) <= 0:
            return False
    return True


def _faces(
    piece: tuple[int, ...], corners: Sequence[Corner], after: Sequence[int], given: set[int],
) -> Array:
    """The arcs of one piece; a corner that several pieces share belongs to the first."""
    before = {following: i for i, following in enumerate(after)}
    found: list[tuple[float, ...]] = []
    for i, following in _sides(piece):
        if after[i] == following:
            normal = side_normal(corners[i], corners[following])
            found.append((*normal, *normal))
        if i in given:
            continue
        given.add(i)
        one = side_normal(corners[before[i]], corners[i])
        two = side_normal(corners[i], corners[after[i]])
        if one[0] * two[1] - one[1] * two[0] > 0:  # it stands out
            found += halves(one, two)
    return np.array(found).reshape(-1, 4)


def side_normal(start: Corner, end: Corner) -> Corner:
    """The unit normal to the right of a side."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    return dy / length, -dx / length


def halves(one: Corner, two: Corner) -> list[tuple[float, ...]]:
    """The arc from one unit vector counter-clockwise to another, up to half a turn, in two."""
    start, end = (math.atan2(y, x) for x, y in (one, two))
    middle = start + ((end - start) % math.tau) / 2
    between = math.cos(middle), math.sin(middle)
    return [(*one, *between), (*between, *two)]


def chain_faces(points: Ring) -> list[Array]:
    """Arcs of normals of each segment of a chain [k, 4], which faces both ways.

    At a joint n lies between the normals on the side that stands out; at a free end it may lie
    anywhere that is not back along the segment. A chain whose last point is its first is closed.
    """
    closed = points[0] == points[-1]
    last = len(points) - 1
    found: list[list[tuple[float, ...]]] = []
    for i in range(last):
        right = side_normal(points[i], points[i + 1])
        left = -right[0], -right[1]
        arcs: list[tuple[float, ...]] = [(*right, *right), (*left, *left)]
        if i == 0 and not closed:
            arcs += halves(left, right)
        if i < last - 1 or closed:
            following = side_normal(points[(i + 1) % last], points[(i + 1) % last + 1])
            arcs += _joint(right, following)
        else:
            arcs += halves(right, left)
        found.append(arcs)
    return [np.array(arcs) for arcs in found]


def _joint(one: Corner, two: Corner) -> list[tuple[float, ...]]:
    """The arc at the end of a segment with its right normal ``one``, before one with ``two``."""
    bend = one[0] * two[1] - one[1] * two[0]
    if bend > 0:
        return halves(one, two)
    if bend < 0:
        return halves((-two[0], -two[1]), (-one[0], -one[1]))
    back = one[0] * two[0] + one[1] * two[1] < 0
    return halves(one, two) if back else []
