"""Closed outlines as corners: area, crossings, convex pieces.

The outline is cut into triangles between its own corners (mapbox_earcut). They are joined over
their inner sides, the longest first, as long as the result stays convex (Hertel and Mehlhorn 1983:
at most four times the minimum number of pieces).

Inner sides, the seams, are no surface: nothing may be caught there. A piece touches with a normal n
out of the outline: on a side, the side's normal; at a corner that stands out, any normal between
those of its two sides; at any other corner, one of these two. Each piece has these arcs of normals.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import mapbox_earcut
import numpy as np

from sandbox.numeric import Array
from sandbox.wording import refuse_if

Corner = tuple[float, float]
Ring = tuple[Corner, ...]  # corners in order, the last joined to the first
LINE = 1e-14  # width of corners in one line as a share of its length: rounding
STRAIGHT = 1e-12  # sine of a bend that is only rounding
PIECE_CORNERS = 64  # maximum number of corners of one piece
COVERED = 1e-9  # share of the area by which the triangles may miss it: rounding


def _cross(u: Array, v: Array) -> Array:
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def signed_area(ring: Ring) -> float:
    """Area [m^2] inside, negative for a clockwise outline."""
    points = np.array(ring) - ring[0]
    return float(np.sum(_cross(points, np.roll(points, -1, axis=0))) / 2)


def wound(ring: Ring, sense: int = 1) -> Ring:
    """The same corners counter-clockwise, or clockwise for a ``sense`` of -1."""
    return ring if sense * signed_area(ring) > 0 else ring[::-1]


def is_convex(ring: Ring) -> bool:
    """Whether every corner bends the same way and all of them together make one turn."""
    points = np.array(ring)
    after = np.roll(points, -1, axis=0) - points
    before = np.roll(after, 1, axis=0)
    cross = _cross(before, after)
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
        # remove one of two neighbours at a time: without it the other may be needed
        straight = np.flatnonzero(np.abs(_cross(before, after)) <= STRAIGHT * size)
        if not len(straight) or len(points) - len(straight[::2]) < 3:
            return tuple((x, y) for x, y in points.tolist())
        points = np.delete(points, straight[::2], axis=0)


def first_meeting(rings: Sequence[Ring]) -> tuple[int, int, str] | None:
    """The first two sides that cross or touch, by their first corners, and the place."""
    starts = np.concatenate([np.array(ring) for ring in rings])
    ends = np.concatenate([np.roll(np.array(ring), -1, axis=0) for ring in rings])
    names, after = [i for ring in rings for i in range(len(ring))], np.array(_after(rings))
    (x0, y0), (x1, y1) = np.minimum(starts, ends).T.copy(), np.maximum(starts, ends).T.copy()
    for i in range(len(starts)):
        others = np.flatnonzero((x0 <= x1[i]) & (x1 >= x0[i]) & (y0 <= y1[i]) & (y1 >= y0[i]))
        others = others[others > i]
        p, q, r, s = starts[i], ends[i], starts[others], ends[others]
        u, v = q - p, s - r
        met = ((np.sign(_cross(u, r - p)) * np.sign(_cross(u, s - p)) <= 0)
               & (np.sign(_cross(v, p - r)) * np.sign(_cross(v, q - r)) <= 0))
        # neighbours share a corner; they meet otherwise only where one runs back along the other
        joined = (after[i] == others) | (after[others] == i)
        back = (u[0] * v[:, 1] == u[1] * v[:, 0]) & (v @ u < 0)
        if len(met := others[met & (~joined | back)]):
            break
    else:
        return None
    j = int(met[0])
    r, s = starts[j], ends[j]
    v = s - r
    if cross := _cross(u, v):
        x, y = p + _cross(r - p, v) / cross * u
    else:  # in one line: the start of what they share
        x, y = sorted((p, q, r, s), key=lambda one: float(one @ u))[1]
    return names[i], names[j], f"at [{x:.6g}, {y:.6g}]"


def ring_fault(ring: Ring) -> str:
    """The fault of corners that are not an outline, with its place; empty if there is none."""
    points = np.array(ring)
    if (same := np.flatnonzero((points == np.roll(points, -1, axis=0)).all(axis=1))).size:
        i = int(same[0])
        return f"corners {i} and {(i + 1) % len(ring)} are the same point"
    along, across = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)[:2]
    if across <= LINE * along:
        x, y = ring[0]
        return f"the outline has no area: its corners lie in one line through [{x:.6g}, {y:.6g}]"
    if meeting := (None if is_convex(ring) else first_meeting([ring])):
        one, other, place = meeting
        return (f"the outline crosses or touches itself {place}, where the side from "
                f"corner {one} meets that from corner {other}")
    return ""


def hole_fault(outer: Ring, holes: Sequence[Ring]) -> str:
    """Why the first hole that is not inside an outline and separate is not; empty without one."""
    for k, hole in enumerate(holes):
        for what, ring in (("the outline", outer), *((f"hole {m}", holes[m]) for m in range(k))):
            if meeting := first_meeting([ring, hole]):
                return (f"hole {k}: this hole meets {what} {meeting[2]}, at the side from corner "
                        f"{meeting[1]}")
        if not inside(hole[0], outer):
            x, y = hole[0]
            return f"hole {k}: this hole lies outside of the outline at [{x:.6g}, {y:.6g}]"
        for m in range(k):
            if inside(hole[0], holes[m]) or inside(holes[m][0], hole):
                return f"hole {k}: this hole and hole {m} lie one in the other"
    return ""


@dataclass(frozen=True)
class Piece:
    """A convex piece of an outline: its corners, counter-clockwise, and its surface."""

    ring: Ring
    faces: Array  # arcs of unit normals, a quarter turn at most each: x and y of both ends, [k, 4]


@lru_cache(maxsize=256)
def pieces_of(outer: Ring, holes: tuple[Ring, ...] = ()) -> tuple[Piece, ...]:
    """The convex pieces of a sound outline with sound holes."""
    rings = [wound(without_straight(outer)), *(wound(without_straight(hole), -1) for hole in holes)]
    corners = [corner for ring in rings for corner in ring]
    after = _after(rings)
    before = {following: i for i, following in enumerate(after)}
    normals = [side_normal(corners[i], corners[following]) for i, following in enumerate(after)]
    seen: set[int] = set()
    found = []
    for piece in _joined(_triangles(rings, corners), corners):
        arcs: list[tuple[float, ...]] = []
        for i, following in _sides(piece):
            if after[i] == following:
                arcs.append(normals[i] + normals[i])
            if i not in seen:  # a corner of several pieces belongs to the first
                seen.add(i)
                arcs += between(normals[before[i]], normals[i])
        found.append(Piece(tuple(corners[i] for i in piece), np.array(arcs).reshape(-1, 4)))
    return tuple(found)


def _after(rings: Sequence[Ring]) -> list[int]:
    """The number of the corner after each, with all rings numbered consecutively."""
    after: list[int] = []
    for ring in rings:
        first = len(after)
        after += [first + (i + 1) % len(ring) for i in range(len(ring))]
    return after


def _triangles(rings: Sequence[Ring], corners: Sequence[Corner]) -> list[tuple[int, ...]]:
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    points = np.array(corners)
    # earcut compares products with 0: scale to a size of about 1 to avoid underflow
    points = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    found = mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3).tolist()
    areas = [signed_area(tuple(corners[i] for i in each)) for each in found]
    area = sum(abs(signed_area(ring)) * (1 if k == 0 else -1) for k, ring in enumerate(rings))
    whole = sum(map(abs, areas))
    refuse_if(abs(whole - area) > COVERED * area, "this outline cannot be cut into convex pieces: "
              f"the triangles cover {whole:.6g} of {area:.6g} m^2", "bad-outline",
              allowed="sides further apart than rounding")
    return [tuple(each if size > 0 else each[::-1])
            for each, size in zip(found, areas, strict=True)]


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
        a, b = pieces[one], pieces[other]
        i, j = a.index(side[1]), b.index(side[0])
        made = (a[i:] + a[:i]) + (b[j:] + b[:j])[1:-1]
        if len(made) <= PIECE_CORNERS and all(_bends_left(made, corner, corners)
                                              for corner in side):
            pieces[one] = made
            del pieces[other]
            owner.update({each: one for each in _sides(made)})
    return list(pieces.values())


def _sides(piece: tuple[int, ...]) -> list[tuple[int, int]]:
    return list(zip(piece, piece[1:] + piece[:1], strict=True))


def _bends_left(piece: tuple[int, ...], corner: int, corners: Sequence[Corner]) -> bool:
    k = piece.index(corner)
    (x0, y0), (x1, y1), (x2, y2) = (corners[piece[(k + d) % len(piece)]] for d in (-1, 0, 1))
    return (x1 - x0) * (y2 - y1) - (y1 - y0) * (x2 - x1) > 0


def side_normal(start: Corner, end: Corner) -> Corner:
    """The unit normal to the right of a side."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    return dy / length, -dx / length


def between(one: Corner, two: Corner) -> list[tuple[float, ...]]:
    """The arc between the normals of two sides, in two; none if their corner does not stand out."""
    bend = one[0] * two[1] - one[1] * two[0]
    if bend < 0 or (bend == 0 and one[0] * two[0] + one[1] * two[1] > 0):
        return []
    start, end = (math.atan2(y, x) for x, y in (one, two))
    middle = start + ((end - start) % math.tau) / 2
    normal = math.cos(middle), math.sin(middle)
    return [(*one, *normal), (*normal, *two)]


def chain_faces(points: Ring) -> Iterator[Array]:
    """Arcs of normals of each segment of a chain [k, 4], which faces both ways.

    At a joint the normal lies between those on the side that stands out; at a free end, anywhere
    but back along the segment. A chain whose last point is its first is closed.
    """
    closed = points[0] == points[-1]
    rights = [side_normal(p, q) for p, q in pairwise(points)]
    lefts = [(-x, -y) for x, y in rights]
    for i, (right, left) in enumerate(zip(rights, lefts, strict=True)):
        arcs: list[tuple[float, ...]] = [right + right, left + left]
        if i == 0 and not closed:
            arcs += between(left, right)
        if i == len(rights) - 1 and not closed:
            arcs += between(right, left)
        else:
            k = (i + 1) % len(rights)
            arcs += between(right, rights[k]) or between(lefts[k], left)
        yield np.array(arcs)
