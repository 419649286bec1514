"""Springs: coils between two points, spirals about a hinge."""

from __future__ import annotations

import math

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.geometry import along_lines, coil_template, spiral
from sandbox.draw.film.palette import DRIVE, SLACK, SPRING, Colour, mixed
from sandbox.draw.film.points import PointPool, anchors, index_of_bodies
from sandbox.scene.elements.drives import StiffnessDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.elements.springs import LinearSpring
from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]
COIL = (3.2, 8.0)
"""Least and largest half width of a coil in points."""
COIL_SHARE = 0.09
"""Half width of a coil as a share of its length."""
LINE = 1.1
THICK = (0.5, 6.0)
"""Shares of its own stiffness between which the line of a driven spring changes."""


def driven_line(share: float) -> tuple[Colour, float]:
    """Colour and width in points of a spring whose stiffness is set to ``share`` of its own.

    As any spring at 1; thinner and paler below, thicker and towards the drives' colour above, by
    the logarithm of the share.
    """
    low, high = THICK
    share = min(max(share, low), high)
    if share < 1:
        w = math.log(share) / math.log(low)
        return mixed(SPRING, SLACK, w), LINE * (1 - 0.3 * w)
    w = math.log(share) / math.log(high)
    return mixed(SPRING, DRIVE, w), LINE * (1 + 1.2 * w)


class SpringDrawer:
    """Draws every spring."""

    def __init__(self, mechanism: Mechanism, pool: PointPool) -> None:
        index = index_of_bodies(mechanism)
        pins = {j.name: j for j in mechanism.joints if isinstance(j, Pin)}
        self._template = coil_template()
        starts, ends = [], []
        self._hinges: list[tuple[int, int, int, int, str]] = []
        self._straight: list[str] = []
        self._driven = {drive.spring: i for i, drive in enumerate(mechanism.drives)
                        if isinstance(drive, StiffnessDrive)}
        self._own = {spring.name: spring.stiffness for spring in mechanism.springs}
        for spring in mechanism.springs:
            if isinstance(spring, LinearSpring):
                self._straight.append(spring.name)
                starts.append(pool.add(index[spring.a], [spring.on_a]).start)
                ends.append(pool.add(index[spring.b], [spring.on_b]).start)
            elif spring.joint in pins:
                pin = pins[spring.joint]
                _, on_b = anchors(mechanism, pin)
                i, j = index[pin.a], index[pin.b]
                self._hinges.append((pool.add(j, [on_b]).start, i, j,
                                     -1 if pin.positive == "clockwise" else 1, spring.name))
        self._starts, self._ends = np.array(starts, np.intp), np.array(ends, np.intp)

    @property
    def any(self) -> bool:
        """Whether there are springs at all."""
        return bool(len(self._starts) or self._hinges)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All springs."""
        if len(self._starts):
            start, end = moment.pixels[self._starts], moment.pixels[self._ends]
            lines = along_lines(self._template, start, end, self._width(start, end, canvas))
            canvas.touched += np.hstack((lines.min(axis=1) - 3, lines.max(axis=1) + 3)).tolist()
            paths = lines.tolist()
            radius = 1.7 * canvas.unit
            for name, path in zip(self._straight, paths, strict=True):
                colour, points = self._line(name, moment)
                pygame.draw.lines(canvas.surface, colour, False, path, canvas.width(points))
                pygame.draw.circle(canvas.surface, colour, path[0], radius)
                pygame.draw.circle(canvas.surface, colour, path[-1], radius)
        for centre, i, j, sense, name in self._hinges:
            canvas.touch(moment.points[centre], 14)
            wind = moment.pose[j, 2] - moment.pose[i, 2]
            turn = -(sense * 1.5 * math.tau + wind)
            path = spiral(turn, -float(moment.pose[i, 2]), 5.0 * canvas.unit, 11 * canvas.unit)
            colour, points = self._line(name, moment)
            pygame.draw.lines(canvas.surface, colour, False,
                              (path + moment.pixels[centre]).tolist(), canvas.width(points))

    def _line(self, name: str, moment: Moment) -> tuple[Colour, float]:
        """Colour and width in points of a spring."""
        if name not in self._driven or not self._own[name]:
            return SPRING, LINE
        return driven_line(float(moment.drives[self._driven[name]]) / self._own[name])

    @staticmethod
    def _width(start: Array, end: Array, canvas: Canvas) -> Array:
        """Half widths [n] of the coils in pixels: long springs are drawn wider."""
        length = np.hypot(*(end - start).T)
        low, high = COIL
        return np.asarray(np.clip(COIL_SHARE * length, low * canvas.unit, high * canvas.unit))
