"""Cuts shapes that reach far beyond a picture, which painters could not take.

pygame walks every pixel of a shape, also outside of the picture, and takes no numbers beyond those
of a C int. Coordinates that are not finite are dropped here, for all painters.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

XY = tuple[float, float]
Edges = tuple[float, float, float, float]
"""Left, top, right, bottom [pixels]."""
FAR = 1e12
"""Coordinates beyond this are moved there [pixels]."""
ARC = 128
"""Sides of the visible piece of a very large circle."""


def within(points: Sequence[XY], edges: Edges) -> bool:
    """Whether all points are within the edges; NaN is not."""
    left, top, right, bottom = edges
    return all(left <= x <= right and top <= y <= bottom for x, y in points)


def _held(points: Sequence[XY]) -> list[XY]:
    """The points within :data:`FAR`; none if one of them is NaN."""
    if any(math.isnan(x) or math.isnan(y) for x, y in points):
        return []
    return [(min(max(x, -FAR), FAR), min(max(y, -FAR), FAR)) for x, y in points]


def cut_polygon(corners: Sequence[XY], edges: Edges) -> list[XY]:
    """A polygon's corners within the edges (Sutherland and Hodgman)."""
    found = _held(corners)
    for axis, limit, sign in ((0, edges[0], 1), (1, edges[1], 1), (0, edges[2], -1),
                              (1, edges[3], -1)):
        before, found = found, []
        for k, point in enumerate(before):
            last = before[k - 1]
            inside, outside = (sign * (p[axis] - limit) >= 0 for p in (point, last))
            if inside != outside:
                w = (limit - last[axis]) / (point[axis] - last[axis])
                found.append((last[0] + w * (point[0] - last[0]),
                              last[1] + w * (point[1] - last[1])))
            if inside:
                found.append(point)
    return found


def cut_line(start: XY, end: XY, edges: Edges) -> tuple[XY, XY] | None:
    """The piece of a line within the edges (Liang and Barsky); None if there is none."""
    ends = _held((start, end))
    if not ends:
        return None
    (x, y), (dx, dy) = ends[0], (ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
    first, last = 0.0, 1.0
    for step, room in ((-dx, x - edges[0]), (-dy, y - edges[1]), (dx, edges[2] - x),
                       (dy, edges[3] - y)):
        if step == 0:
            if room < 0:
                return None
        elif step < 0:
            first = max(first, room / step)
        else:
            last = min(last, room / step)
    if first > last:
        return None
    return (x + first * dx, y + first * dy), (x + last * dx, y + last * dy)


def large_circle(centre: XY, radius: float, edges: Edges) -> list[XY]:
    """What the edges show of a circle that is far larger, as a polygon: nothing, all or a piece.

    The arc is measured from its point nearest to the picture: differences of numbers as large as
    the radius would have no digits left.
    """
    left, top, right, bottom = edges
    reach = math.hypot(right - left, bottom - top) / 2
    middle = (left + right) / 2, (top + bottom) / 2
    held = _held([centre])
    if not held or math.isnan(radius):
        return []
    radius = min(radius, FAR)
    x, y = middle[0] - held[0][0], middle[1] - held[0][1]
    distance = math.hypot(x, y)
    if distance - radius > reach:
        return []
    if radius - distance > reach:
        return [(left, top), (right, top), (right, bottom), (left, bottom)]
    ux, uy = x / distance, y / distance
    half = math.asin(min(1.0, reach / distance))
    arc = []
    for k in range(ARC + 1):
        angle = half * (2 * k / ARC - 1)
        out = radius - distance - 2 * radius * math.sin(angle / 2) ** 2
        along = radius * math.sin(angle)
        arc.append((middle[0] + out * ux - along * uy, middle[1] + out * uy + along * ux))
    deep = [(px - 4 * reach * ux, py - 4 * reach * uy) for px, py in (arc[-1], arc[0])]
    return [*arc, *deep]
