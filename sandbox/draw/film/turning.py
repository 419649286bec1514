"""Motors and brakes: marks round the hinges that they turn or hold."""

from __future__ import annotations

import math

import pygame

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.palette import BACKGROUND, DRIVE
from sandbox.draw.film.points import PointPool, anchors, index_of_bodies
from sandbox.scene.elements.drives import BrakeDrive, MotorDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.mechanism import Mechanism

SQUARE = 5.6
"""Half the side of a brake's mark in points."""
ARC, SWEEP = 9.5, 3.9
"""Radius of a motor's mark in points, and how far it goes round [rad]."""
LINE = 1.5

XY = tuple[float, float]


class TurningDrawer:
    """Draws a square round every hinge with a brake, full while it holds, and a motor's arrow."""

    def __init__(self, mechanism: Mechanism, pool: PointPool) -> None:
        index = index_of_bodies(mechanism)
        pins = {joint.name: joint for joint in mechanism.joints if isinstance(joint, Pin)}
        self._marks: list[tuple[int, int, int]] = []
        """Drive, pooled point of its hinge, and sense of a motor's turning; 0 for a brake."""
        for i, drive in enumerate(mechanism.drives):
            if isinstance(drive, MotorDrive | BrakeDrive):
                pin = pins[drive.joint]
                at = pool.add(index[pin.b], [anchors(mechanism, pin)[1]]).start
                sense = -1 if pin.positive == "clockwise" else 1
                self._marks.append((i, at, sense if isinstance(drive, MotorDrive) else 0))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All marks; the pins come on top."""
        for i, point, sense in self._marks:
            value, at = float(moment.drives[i]), moment.points[point]
            if not sense:
                brake_mark(canvas, at, holds=value > 0)
            elif value:
                motor_mark(canvas, at, 1 if sense * value > 0 else -1)


def brake_mark(canvas: Canvas, at: XY, *, holds: bool) -> None:
    """A square round a hinge: full while the brake holds, hollow while it lets go."""
    half = SQUARE * canvas.unit
    area = (at[0] - half, at[1] - half, 2 * half, 2 * half)
    canvas.touch(at, SQUARE + 1)
    pygame.draw.rect(canvas.surface, DRIVE if holds else BACKGROUND, area)
    pygame.draw.rect(canvas.surface, DRIVE, area, canvas.width(LINE))


def motor_mark(canvas: Canvas, at: XY, turn: int) -> None:
    """An arc with a head round a hinge; ``turn`` is +1 where it turns counter-clockwise."""
    radius, start = ARC * canvas.unit, -turn * math.pi / 4
    canvas.touch(at, ARC + 8)
    # pixels run down: a turn that is counter-clockwise as seen has falling pixel angles
    rim = [start - turn * SWEEP * k / 24 for k in range(25)]
    path = [(at[0] + radius * math.cos(q), at[1] + radius * math.sin(q)) for q in rim]
    canvas.polyline(DRIVE, path, LINE)
    (x, y), end = path[-1], rim[-1]
    ahead = (turn * math.sin(end), -turn * math.cos(end))
    aside = (math.cos(end), math.sin(end))
    length, half = 8.0 * canvas.unit, 3.0 * canvas.unit
    pygame.draw.polygon(canvas.surface, DRIVE, [
        (x + length * ahead[0], y + length * ahead[1]),
        (x + half * aside[0], y + half * aside[1]), (x - half * aside[0], y - half * aside[1])])
