"""What is fixed without shapes of its own: ground symbols, grooves in the ground and what runs."""

from __future__ import annotations

import math

from sandbox.draw.film import clip
from sandbox.draw.film.bodies import hatch
from sandbox.draw.film.canvas import Canvas
from sandbox.draw.film.geometry import dashes
from sandbox.draw.film.links import along_bar
from sandbox.draw.film.palette import BACKGROUND, FAINT_INK, INK, PIN_RING, ROLES

GAUGE, FINE = 13.0, 1.0
"""Of a groove in the ground: the way between its two lines, and their width, in points."""
TICK, TICKS = 5.0, 8.0
"""Of the strokes beside it that say that it is fixed: length and way between two, in points."""

XY = tuple[float, float]


def fixed_rail(canvas: Canvas, start: XY, end: XY) -> None:
    """A groove in the ground: two fine lines, short strokes along the lower or right one."""
    (x0, y0), (x1, y1) = sorted((start, end), key=lambda at: (at[0], -at[1]))
    length = math.dist(start, end)
    if not length > 0:
        return
    ux, uy = (x1 - x0) / length, (y1 - y0) / length
    half, tick = GAUGE / 2 * canvas.unit, TICK * canvas.unit
    canvas.touch_path((start, end), GAUGE / 2 + TICK + 1)
    # bodies may lie over it: a number that finds no other place stands on it
    canvas.avoided += along_bar(canvas, start, end, GAUGE / 2)
    for way in (-half, half):
        clip.line(canvas.surface, INK, (x0 - way * uy, y0 + way * ux),
                  (x1 - way * uy, y1 + way * ux), canvas.width(FINE))
    for x, y in ((x0, y0), (x1, y1)):
        clip.line(canvas.surface, INK, (x + half * uy, y - half * ux),
                  (x - half * uy, y + half * ux), canvas.width(FINE))
    cut = clip.cut_line(canvas.surface, (x0 - half * uy, y0 + half * ux),
                        (x1 - half * uy, y1 + half * ux))
    for (x, y), _ in dashes(list(cut), TICKS * canvas.unit, 0.0)[1:] if cut else ():
        clip.line(canvas.surface, FAINT_INK, (x, y),
                  (x - tick * (uy + ux), y + tick * (ux - uy)), canvas.width(0.9))


def roller(canvas: Canvas, start: XY, end: XY, at: XY, *, turns: bool) -> None:
    """What runs in a groove in the ground: a roller, or a block where nothing turns."""
    radius = GAUGE / 2 - FINE / 2
    canvas.touch(at, 2 * radius)
    if turns:
        canvas.ring(BACKGROUND, PIN_RING, at, radius, 1.1)
        return
    length = math.dist(start, end) or 1.0
    dx, dy = (2 * radius * canvas.unit * (end[k] - start[k]) / length for k in (0, 1))
    tail, tip = (at[0] - dx, at[1] - dy), (at[0] + dx, at[1] + dy)
    canvas.polyline(PIN_RING, (tail, tip), 2 * radius)
    canvas.polyline(BACKGROUND, (tail, tip), 2 * radius - 2.2)


def ground_symbol(canvas: Canvas, at: XY) -> None:
    """A hatched block below a triangle: fixed here."""
    x, y, u = at[0], at[1], canvas.unit
    style = ROLES["ground"]
    canvas.touch(at, 19)
    corners = [(x, y), (x - 8 * u, y + 12 * u), (x + 8 * u, y + 12 * u)]
    clip.polygon(canvas.surface, style.fill, corners)
    clip.lines(canvas.surface, FAINT_INK, corners, canvas.width(1.2), closed=True)
    base = [(x - 12 * u, y + 12 * u), (x + 12 * u, y + 12 * u), (x + 12 * u, y + 17 * u),
            (x - 12 * u, y + 17 * u)]
    hatch(canvas, base, style)
    clip.line(canvas.surface, INK, base[0], base[1], canvas.width(1.4))
