"""Springs: coils between two points, spirals about a hinge."""

from __future__ import annotations

import math

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.geometry import along_lines, coil_template, spiral
from sandbox.draw.film.palette import DRIVE, SLACK, SPRING, Colour, mixed
from sandbox.draw.film.points import PointPool
from sandbox.model.model import NONE
from sandbox.numeric import Array

COIL = (3.2, 8.0)
"""Least and largest half width of a coil in points."""
COIL_FRACTION = 0.09
"""Half width of a coil as a fraction of its length."""
LINE = 1.1
THICK = (0.5, 6.0)
"""Fractions of its own stiffness between which the line of a driven spring changes."""


def driven_line(fraction: float) -> tuple[Colour, float]:
    """Colour and width in points of a spring whose stiffness is set to ``fraction`` of its own.

    As any spring at 1; thinner and paler below, thicker and towards the drives' colour above, by
    the logarithm of the fraction.
    """
    w = _made_stiffer(fraction)
    return mixed(SPRING, DRIVE if w > 0 else SLACK, abs(w)), LINE * thickened(fraction)


def thickened(fraction: float) -> float:
    """By how much the line of a spring or cord is wider whose stiffness is set to ``fraction``."""
    w = _made_stiffer(fraction)
    return 1 + (1.2 if w > 0 else 0.3) * w


def _made_stiffer(fraction: float) -> float:
    """From -1 to 1, 0 at the element's own stiffness: what shows of ``fraction``."""
    low, high = THICK
    fraction = min(max(fraction, low), high)
    return math.log(fraction) / math.log(high) if fraction > 1 else (
        -math.log(fraction) / math.log(low))


def spring_symbol(canvas: Canvas, x: float, y: float, width: float, *,
                  line: tuple[Colour, float] = (SPRING, 1.2)) -> None:
    """A coil for the legend, ``line`` its colour and width in points."""
    path = along_lines(coil_template(), np.array([[x, y]]), np.array([[x + width, y]]),
                       np.array([4.0 * canvas.unit]))[0].tolist()
    clip.lines(canvas.surface, line[0], path, canvas.width(line[1]))


def stiffened_symbol(canvas: Canvas, x: float, y: float, width: float) -> None:
    """The same of a spring that a drive makes stiffer."""
    spring_symbol(canvas, x, y, width, line=driven_line(THICK[1]))


class SpringDrawer:
    """Draws every spring."""

    def __init__(self, run: Filmed, pool: PointPool) -> None:
        model = run.model
        self._springs = springs = model.springs
        self._ties, self._held = model.ties, run.arrays["held"]
        self._sense, self._zero = model.joints.sense, model.joints.zero
        self._template = coil_template()
        self._straight: list[int] = np.flatnonzero(springs.straight).tolist()
        ends = [[pool.add(body, [at]).start for body, at in
                 zip(springs.bodies[k].tolist(), springs.anchor[k].tolist(), strict=True)]
                for k in self._straight]
        self._starts, self._ends = np.array(ends, np.intp).reshape(-1, 2).T
        self._hinges: list[tuple[int, int, int, int, int]] = []
        """Pooled point, the two bodies, sense of the hinge and number of a spring about one."""
        for k in np.flatnonzero(~springs.straight).tolist():
            joint, (a, b) = springs.joint[k], springs.bodies[k].tolist()
            at = pool.add(b, [model.joints.anchor[joint, 1].tolist()]).start
            self._hinges.append((at, a, b, int(model.joints.sense[joint]), k))

    @property
    def any(self) -> bool:
        """Whether there are springs at all."""
        return bool(len(self._starts) or self._hinges)

    def _there(self, spring: int, moment: Moment) -> bool:
        """Whether a spring holds, and its hinge."""
        joint = self._springs.joint[spring]
        ties = [self._ties.spring[spring], self._ties.joint[joint] if joint >= 0 else NONE]
        return all(tie == NONE or self._held[moment.sample, tie] != 0.0 for tie in ties)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All springs that hold."""
        if len(self._starts):
            start, end = moment.pixels[self._starts], self._pushing_ends(moment)
            lines = along_lines(self._template, start, end, self._width(start, end, canvas))
            canvas.touched += np.hstack((lines.min(axis=1) - 3, lines.max(axis=1) + 3)).tolist()
            paths = lines.tolist()
            radius = 1.7 * canvas.unit
            for k, path in zip(self._straight, paths, strict=True):
                if not self._there(k, moment):
                    continue
                colour, points = self._line(k, moment)
                clip.lines(canvas.surface, colour, path, canvas.width(points))
                clip.circle(canvas.surface, colour, path[0], radius)
                clip.circle(canvas.surface, colour, path[-1], radius)
        for centre, i, j, sense, k in self._hinges:
            if not self._there(k, moment):
                continue
            canvas.touch(moment.points[centre], 14)
            wind = moment.pose[j, 2] - moment.pose[i, 2]
            sweep = -(sense * 1.5 * math.tau + wind)
            path = spiral(sweep, -float(moment.pose[i, 2]), 5.0 * canvas.unit, 11 * canvas.unit)
            colour, points = self._line(k, moment)
            clip.lines(canvas.surface, colour, (path + moment.pixels[centre]).tolist(),
                       canvas.width(points))

    def _pushing_ends(self, moment: Moment) -> Array:
        """Where the springs end [n, 2] pixels: one that only pushes does not follow what goes."""
        start, end = moment.pixels[self._starts], moment.pixels[self._ends].copy()
        length = np.hypot(*(moment.world[self._ends] - moment.world[self._starts]).T)
        for i, k in enumerate(self._straight):
            law, rest = self._springs.law[k], self._springs.rest[k]
            if law is not None and law.side < 0 and length[i] > rest:
                end[i] = start[i] + (end[i] - start[i]) * rest / length[i]
        return end

    def _apart(self, spring: int, moment: Moment) -> bool:
        """Whether a one-sided spring does not act."""
        law, springs = self._springs.law[spring], self._springs
        if law is None or not law.side:
            return False
        if springs.straight[spring]:
            n = self._straight.index(spring)
            at = moment.world[self._ends[n]] - moment.world[self._starts[n]]
            now = float(np.hypot(*at))
        else:
            a, b = springs.bodies[spring]
            joint = springs.joint[spring]
            now = float(self._sense[joint] * (moment.pose[b, 2] - moment.pose[a, 2])
                        - self._zero[joint])
        return bool(law.side * (now - springs.rest[spring]) <= 0)

    def _line(self, spring: int, moment: Moment) -> tuple[Colour, float]:
        """Colour and width in points of a spring."""
        if self._apart(spring, moment):
            return SLACK, LINE
        drive, own = self._springs.drive[spring], float(self._springs.stiffness[spring])
        if drive == NONE or not own:
            return SPRING, LINE
        return driven_line(float(moment.drives[drive]) / own)

    @staticmethod
    def _width(start: Array, end: Array, canvas: Canvas) -> Array:
        """Half widths [n] of the coils in pixels: long springs are drawn wider."""
        length = np.hypot(*(end - start).T)
        low, high = COIL
        return np.asarray(np.clip(COIL_FRACTION * length, low * canvas.unit, high * canvas.unit))
