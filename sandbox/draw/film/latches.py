"""What may be let go: a diamond where it holds, full while it does."""

from __future__ import annotations

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.palette import BACKGROUND, INK
from sandbox.draw.film.points import PointPool

XY = tuple[float, float]
HALF = 8.5
"""Half the diagonal of a diamond in points."""


def latch_mark(canvas: Canvas, at: XY, *, holds: bool) -> None:
    """A diamond round a point: full while it holds, hollow while it is let go."""
    half = HALF * canvas.unit
    corners = [(at[0] + half * x, at[1] + half * y) for x, y in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    canvas.touch(at, HALF + 1)
    clip.polygon(canvas.surface, INK if holds else BACKGROUND, corners)
    clip.lines(canvas.surface, INK, corners, canvas.width(1.4), closed=True)


class LatchDrawer:
    """Draws the diamonds, of a joint on its body ``a``, where a spring or a cord begins."""

    def __init__(self, run: Filmed, pool: PointPool) -> None:
        model, ties = run.model, run.model.ties
        joints, springs, tendons = model.joints, model.springs, model.tendons
        self._held = run.arrays["held"]
        self._marks: list[tuple[int, int]] = []
        """Which of what may be let go, and its pooled point."""
        for k in np.flatnonzero(ties.joint >= 0).tolist():
            at = pool.add(int(joints.bodies[k, 0]), joints.anchor[k, :1])
            self._marks.append((int(ties.joint[k]), at.start))
        for k in np.flatnonzero(ties.spring >= 0).tolist():
            joint = int(springs.joint[k])
            body, place = springs.bodies[k, 0], springs.anchor[k, :1]
            if not springs.straight[k]:
                body, place = joints.bodies[joint, 0], joints.anchor[joint, :1]
            self._marks.append((int(ties.spring[k]), pool.add(int(body), place).start))
        for k in np.flatnonzero(ties.tendon >= 0).tolist():
            first = tendons.guides(k).start
            at = pool.add(int(tendons.guide_body[first]), tendons.guide_at[first:first + 1])
            self._marks.append((int(ties.tendon[k]), at.start))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All of them; pins come on top."""
        for tie, at in self._marks:
            latch_mark(canvas, moment.points[at], holds=bool(self._held[moment.sample, tie]))
