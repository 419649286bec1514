"""Marks of motors, servos, brakes and torques about hinges."""

from __future__ import annotations

import math

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, DRIVE

SQUARE = 5.6
"""Half the side of a brake's mark in points."""
ARC, SWEEP = 9.5, 3.9
"""Radius of a motor's mark in points, and how far it goes round [rad]."""
LINE = 1.5
TURN = 15.0
"""Radius of a torque's arrow in points."""

XY = tuple[float, float]


def brake_mark(canvas: Canvas, at: XY, *, holds: bool) -> None:
    """A square round a hinge: full while the brake holds, hollow while it lets go."""
    half = SQUARE * canvas.unit
    area = (at[0] - half, at[1] - half, 2 * half, 2 * half)
    canvas.touch(at, SQUARE + 1)
    clip.rect(canvas.surface, DRIVE if holds else BACKGROUND, area)
    clip.rect(canvas.surface, DRIVE, area, canvas.width(LINE))


def motor_mark(canvas: Canvas, at: XY, sense: int) -> None:
    """An arc with a head round a hinge; ``sense`` is +1 where it turns counter-clockwise.

    Of one that keeps its hinge at rest, 0, a whole ring.
    """
    radius, start = ARC * canvas.unit, -sense * math.pi / 4
    canvas.touch(at, ARC + 8)
    if sense == 0:
        _ring(canvas, at)
        return
    # pixels run down: a turn that is counter-clockwise as seen has falling pixel angles
    rim = [start - sense * SWEEP * k / 24 for k in range(25)]
    path = [(at[0] + radius * math.cos(q), at[1] + radius * math.sin(q)) for q in rim]
    canvas.polyline(DRIVE, path, LINE)
    (x, y), end = path[-1], rim[-1]
    ahead = (sense * math.sin(end), -sense * math.cos(end))
    aside = (math.cos(end), math.sin(end))
    length, half = 8.0 * canvas.unit, 3.0 * canvas.unit
    clip.polygon(canvas.surface, DRIVE, [
        (x + length * ahead[0], y + length * ahead[1]),
        (x + half * aside[0], y + half * aside[1]), (x - half * aside[0], y - half * aside[1])])


def servo_mark(canvas: Canvas, at: XY) -> None:
    """A ring about a hinge with marks at its quarters, like a dial."""
    canvas.touch(at, ARC + 4)
    _ring(canvas, at)
    for k in range(4):
        x, y = math.cos(k * math.pi / 2), math.sin(k * math.pi / 2)
        ends = [(at[0] + r * canvas.unit * x, at[1] + r * canvas.unit * y)
                for r in (ARC - 2.5, ARC + 3)]
        canvas.polyline(DRIVE, ends, LINE + 0.5)


def _ring(canvas: Canvas, at: XY) -> None:
    radius = ARC * canvas.unit
    canvas.polyline(DRIVE, [(at[0] + radius * math.cos(q), at[1] + radius * math.sin(q))
                            for q in (math.tau * k / 48 for k in range(49))], LINE)


def turn_arrow(canvas: Canvas, at: XY, sense: int, points: float = TURN) -> None:
    """A bent arrow about a hinge, of a radius; ``sense`` +1 is counter-clockwise as seen."""
    radius = points * canvas.unit
    canvas.touch(at, points + 7)
    angles = [math.radians(a) for a in range(-50, 201, 10)]
    if sense < 0:
        angles = [math.pi - a for a in angles]
    path = [(at[0] + radius * math.cos(a), at[1] - radius * math.sin(a)) for a in angles]
    canvas.polyline(DRIVE, path[:-3], 3.2)
    clip.polygon(canvas.surface, DRIVE, arrow(
        path[-4], path[-1], 3.2 * canvas.unit, 12 * canvas.unit))
