"""Shapes, cut to what a picture can show.

pygame walks every pixel and every line of a shape, those outside of the picture too, and takes no
numbers beyond those of a C int: a circle of a kilometre in a view of a centimetre takes
minutes, a box of 1e300 m an exception. What reaches no further than a picture's size beyond its
edges is handed on as it is; all else is cut there first, out of sight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film.geometry import dashes
from sandbox.draw.film.palette import Colour
from sandbox.draw.film.shapes import (
    DrawnBox,
    DrawnLines,
    FilledCircle,
    FilledPolygon,
    Hatching,
    Paper,
)
from sandbox.numeric import Array

XY = tuple[float, float]
Edges = tuple[float, float, float, float]
"""Left, top, right, bottom [pixels]."""
FAR = 1e12
"""Coordinates beyond are moved there [pixels]: no slope of a line in sight changes by it."""
ARC = 128
"""Sides that show the piece of a very large circle that is in sight."""


def near(value: float, most: float = 1e6) -> int:
    """A coordinate as a whole number that a C int holds; NaN is far outside."""
    return round(min(max(value, -most), most)) if value == value else round(-most)


def whole(points: Array) -> NDArray[np.int32]:
    """Coordinates as whole numbers; what is far outside or not a number is so after, too."""
    held = np.nan_to_num(points, nan=-1e9, posinf=1e9, neginf=-1e9)
    return np.clip(held, -1e9, 1e9).astype(np.int32)


def _edges(surface: Paper) -> Edges:
    width, height = surface.get_size()
    return -width, -height, 2 * width, 2 * height


def _within(points: Sequence[XY], edges: Edges) -> bool:
    left, top, right, bottom = edges
    return all(left <= x <= right and top <= y <= bottom for x, y in points)


def _held(points: Sequence[XY]) -> list[XY]:
    """The points with coordinates within :data:`FAR`; none where one is not a number."""
    if any(math.isnan(x) or math.isnan(y) for x, y in points):
        return []
    return [(min(max(x, -FAR), FAR), min(max(y, -FAR), FAR)) for x, y in points]


def cut_polygon(surface: Paper, corners: Sequence[XY]) -> Sequence[XY]:
    """A polygon's corners, cut by Sutherland and Hodgman where it reaches far out of sight."""
    edges = _edges(surface)
    if _within(corners, edges):
        return corners
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


def cut_line(surface: Paper, start: XY, end: XY) -> tuple[XY, XY] | None:
    """The piece of a line that is near the picture, by Liang and Barsky; None if none is."""
    edges = _edges(surface)
    if _within((start, end), edges):
        return start, end
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


def polygon(surface: Paper, colour: Sequence[int], corners: Sequence[XY]) -> None:
    """A filled polygon."""
    cut = cut_polygon(surface, corners)
    if len(cut) > 2:
        surface.keep(FilledPolygon(colour, cut))


def line(surface: Paper, colour: Colour, start: XY, end: XY, width: int = 1) -> None:
    """A straight line."""
    if cut := cut_line(surface, start, end):
        surface.keep(DrawnLines(colour, cut, width))


def lines(surface: Paper, colour: Colour, path: Sequence[XY], width: int = 1, *,
          closed: bool = False) -> None:
    """Connected lines."""
    if _within(path, _edges(surface)):
        surface.keep(DrawnLines(colour, path, width, closed))
        return
    for start, end in pairwise([*path, path[0]] if closed else path):
        line(surface, colour, start, end, width)


def dashed(surface: Paper, colour: Colour, path: Sequence[XY], dash: float, gap: float,
           width: int) -> None:
    """A path in dashes [pixels]; far out of sight there are none."""
    if _within(path, _edges(surface)):
        pieces = dashes(list(path), dash, gap)
    else:
        cuts = [cut_line(surface, start, end) for start, end in pairwise(path)]
        pieces = [piece for cut in cuts if cut for piece in dashes(list(cut), dash, gap)]
    for start, end in pieces:
        surface.keep(DrawnLines(colour, (start, end), width))


def rect(surface: Paper, colour: Colour, area: Edges, width: int = 0) -> None:
    """A rectangle of a mark's size: left, top, width, height."""
    if _within([area[:2]], _edges(surface)):
        surface.keep(DrawnBox(colour, area, width))


def hatching(surface: Paper, colour: Colour, lines: Sequence[tuple[XY, XY]], width: int,
             corners: Sequence[XY]) -> None:
    """Straight lines, each seen as far as it lies within a polygon near the picture."""
    surface.keep(Hatching(colour, lines, width, corners))


def circle(surface: Paper, colour: Colour, centre: XY, radius: float) -> None:
    """A filled circle."""
    if is_large(surface, radius):
        polygon(surface, colour, large_circle(surface, centre, radius))
        return
    far = 6 * _reach(surface)
    if _within([centre], (-far, -far, far, far)):
        surface.keep(FilledCircle(colour, centre, radius))


def is_large(surface: Paper, radius: float) -> bool:
    """Whether a circle is so large that at most a piece of its rim is in sight; NaN is."""
    return not radius <= 4 * _reach(surface)


def _reach(surface: Paper) -> float:
    """Half the diagonal of what is near the picture [pixels]."""
    return 1.5 * math.hypot(*surface.get_size())


def large_circle(surface: Paper, centre: XY, radius: float) -> list[XY]:
    """What a circle far larger than the picture shows near it, as a polygon: none, all or a piece.

    The arc is measured from its point next to the picture, since differences of numbers as large
    as the radius would have no digits left.
    """
    reach = _reach(surface)
    middle = surface.get_size()[0] / 2, surface.get_size()[1] / 2
    held = _held([centre])
    if not held or math.isnan(radius):
        return []
    radius = min(radius, FAR)
    x, y = middle[0] - held[0][0], middle[1] - held[0][1]
    distance = math.hypot(x, y)
    if distance - radius > reach:
        return []
    if radius - distance > reach:
        left, top, right, bottom = _edges(surface)
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
