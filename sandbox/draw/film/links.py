"""What lies between the two points of a joint: rods, ropes, the cylinders of actuators."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Spots
from sandbox.draw.film.geometry import dashes, sagging
from sandbox.draw.film.palette import BACKGROUND, PIN_RING, ROPE, Colour
from sandbox.draw.film.shapes import Area
from sandbox.model.model import Model

TUBE, TUBE_WIDTH = 0.85, 13.0
"""Of an actuator's cylinder: its length as a share of the least of the actuator; width [points]."""
STROKE, LONGEST_TUBE = 0.88, 0.96
"""Shares of an actuator's least length: the longest way of a piston that one cylinder and one rod
have room for, and the longest cylinder."""
NICK = 6.5
"""Way between two turns of a rope's strands in points."""
CORD = 4.6
"""Width of a taut rope in points."""
SLACK_FRACTION = 0.998
"""A rope shorter than this fraction of its length hangs."""

XY = tuple[float, float]
Reach = tuple[float, float]


def has_ropes(model: Model) -> bool:
    """Whether any joint is drawn as a rope."""
    reach = model.joints.reach
    return any(kind.keeps == "range" and not kind.line and reach[k, 0] == 0
               for k, kind in enumerate(model.joints.kind))


def rod_link(canvas: Canvas, a: XY, b: XY, _reach: Reach, colour: Colour | None) -> None:
    """A tube from end to end, filled with its colour."""
    canvas.polyline(PIN_RING, (a, b), 4.4)
    canvas.polyline(colour or BACKGROUND, (a, b), 2.6)


def rope_link(canvas: Canvas, a: XY, b: XY, reach: Reach, colour: Colour | None) -> None:
    """Twisted and in its colour while taut, else dashed; with a least length a cylinder."""
    shortest, longest = reach
    if shortest > 0:
        middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
        canvas.polyline(PIN_RING, (a, middle), 4.4)
        canvas.polyline(colour or BACKGROUND, (a, middle), 2.6)
        canvas.polyline(PIN_RING, (middle, b), 1.6)
        return
    length = longest * canvas.camera.scale
    if math.dist(a, b) > SLACK_FRACTION * length:
        twisted(canvas, colour or ROPE, a, b)
        return
    path = sagging(a, b, length)
    canvas.touch_path(path, 2)
    clip.dashed(canvas.surface, ROPE, path, 5 * canvas.unit, 3 * canvas.unit, canvas.width(1.3))


def twisted(canvas: Canvas, colour: Colour, a: XY, b: XY) -> None:
    """A taut rope: its colour with the slanted gaps between its strands."""
    canvas.polyline(colour, (a, b), CORD)
    cut = clip.cut_line(canvas.surface, a, b)
    length = math.dist(a, b)
    if cut is None or not length:
        return
    ux, uy = (b[0] - a[0]) / length, (b[1] - a[1]) / length
    half = 0.62 * CORD * canvas.unit
    for (x, y), _ in dashes(list(cut), NICK * canvas.unit, 0.0)[1:]:
        clip.line(canvas.surface, BACKGROUND, (x - half * (ux - uy), y - half * (uy + ux)),
                  (x + half * (ux - uy), y + half * (uy + ux)), canvas.width(1.3))


def rope_symbol(canvas: Canvas, x: float, y: float, width: float) -> None:
    """A rope for the legend."""
    twisted(canvas, ROPE, (x, y), (x + width, y))


def actuator_link(canvas: Canvas, a: XY, b: XY, reach: Reach, colour: Colour | None) -> None:
    """A cylinder with its piston, in a colour, and the rod that goes out of it.

    The rod keeps its length, so that the piston goes as far as the actuator grows; where the reach
    is more than one rod can go, the piston goes from end to end of the cylinder.
    """
    length, scale = math.dist(a, b), canvas.camera.scale
    low, high = (each * scale for each in reach)
    tube, piston = cylinder(length, low, high, 12 * canvas.unit)

    def on(way: float) -> XY:
        part = way / length if length > 0 else 0.0
        return a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])

    canvas.polyline(PIN_RING, (on(piston), b), 4.4)
    canvas.polyline(PIN_RING, (a, on(tube)), TUBE_WIDTH)
    canvas.polyline(BACKGROUND, (on(1.4 * canvas.unit), on(tube - 1.4 * canvas.unit)),
                    TUBE_WIDTH - 2.6)
    canvas.polyline(PIN_RING, (on(piston), on(tube)), 4.4)
    half = 3.0 * canvas.unit
    middle = min(max(piston, 1.4 * canvas.unit + half), tube - 1.4 * canvas.unit - half)
    canvas.polyline(colour or PIN_RING, (on(middle - half), on(middle + half)), TUBE_WIDTH - 2.6)


def cylinder(length: float, low: float, high: float, least: float) -> tuple[float, float]:
    """How long a cylinder is, ``least`` or more if there is room, and where its piston is.

    Both from the actuator's foot on, for its ``length`` and that between which it goes.
    """
    stroke = high - low
    if stroke <= STROKE * low and TUBE * low >= least:
        tube = min(max(TUBE * low, stroke / STROKE * LONGEST_TUBE), LONGEST_TUBE * low)
        return tube, (tube - stroke) / 2 + length - low
    tube = min(max(TUBE * low, 0.2 * high, least), 0.9 * length)
    share = (length - low) / stroke if stroke > 0 else 0.5
    return tube, tube * (0.14 + 0.72 * min(max(share, 0.0), 1.0))


def bar_busy(canvas: Canvas, a: XY, b: XY) -> None:
    """Keep labels off a bar."""
    canvas.busy += along_bar(canvas, a, b, 2.5)


def along_bar(canvas: Canvas, a: XY, b: XY, half: float) -> Iterator[Area]:
    """Squares along a bar, ``half`` points to either side [pixels of the finished picture]."""
    side = round(half * canvas.unit / canvas.enlarged)
    cut = clip.cut_line(canvas.surface, a, b)
    for (x, y), _ in dashes(list(cut), 5 * canvas.unit, 0.0) if cut else ():
        yield (round(x / canvas.enlarged) - side, round(y / canvas.enlarged) - side,
               2 * side, 2 * side)


def bar_spots(canvas: Canvas, a: XY, b: XY) -> Spots:
    """Places for a text beside a bar [pixels of the finished picture], best first.

    Above it or right of it, then on the other side, from its middle outwards.
    """
    length, u = math.dist(a, b) or 1.0, canvas.unit / canvas.enlarged
    nx, ny = (b[1] - a[1]) / length, (a[0] - b[0]) / length
    if (ny, -nx) > (-ny, nx) or abs(ny) < 1e-9 > nx:
        nx, ny = -nx, -ny

    def spots(half_x: float, half_y: float) -> Iterator[XY]:
        # the text's box just clears the bar
        reach = abs(nx) * half_x + abs(ny) * half_y + 4 * u
        for share in (0.5, 0.4, 0.6, 0.3, 0.7):
            for way in (reach, -reach):
                yield ((a[0] + share * (b[0] - a[0])) / canvas.enlarged + way * nx,
                       (a[1] + share * (b[1] - a[1])) / canvas.enlarged + way * ny)

    return spots
