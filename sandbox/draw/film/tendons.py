"""Tendons: cords through their guides, coloured by tension; dashed where slack."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.camera import round_up
from sandbox.draw.film.canvas import Canvas, Filmed, Moment
from sandbox.draw.film.geometry import cord_path
from sandbox.draw.film.palette import (
    LEVELS,
    PIN_FILL,
    PIN_RING,
    SLACK,
    WHEEL,
    WHEEL_EDGE,
    tension_colour,
)
from sandbox.draw.film.points import PointPool
from sandbox.model.model import Model
from sandbox.scene.elements.bodies import Circle

XY = tuple[float, float]
CORD = 2.4
"""Width of a cord in points."""
WOUND = 1.5
"""How much of a cord that is wound on its end's wheel is shown [rad]."""
SLACK_FRACTION = 1e-6
"""Tensions below this fraction of the scale count as slack."""


@dataclass(frozen=True)
class _Cord:
    where: slice
    radii: list[float]
    """[m]"""
    senses: list[int]
    wheels: list[int]
    """Pooled points of wheels that no circle of a body shows."""


def largest_tension(run: Filmed) -> float:
    """The top of the tension scale [N]: a round number above nearly all of the run.

    The sharpest 0.5 % of samples may lie above it, so that one jerk does not
    wash out everything else.
    """
    tension = run.arrays["tendon_tension"]
    if not tension.size:
        return 0.0
    peak = float(np.quantile(tension.max(axis=1), 0.995))
    return round_up(max(peak, float(tension[-1].max()))) if peak > 0 else 0.0


class TendonDrawer:
    """Draws every tendon with its guides."""

    def __init__(self, run: Filmed, pool: PointPool) -> None:
        self.largest = largest_tension(run)
        self._tension = run.arrays["tendon_tension"]
        self._cords = [self._cord(run.model, k, pool)
                       for k in range(len(run.mechanism.tendons))]
        self._eyes = [i for cord in self._cords
                      for i, r in zip(range(cord.where.start, cord.where.stop), cord.radii,
                                      strict=True) if r == 0]

    @staticmethod
    def _cord(model: Model, k: int, pool: PointPool) -> _Cord:
        guides = model.mechanism.tendons[k].guides
        bodies = model.tendons.guide_body[model.tendons.guides(k)].tolist()
        where = [pool.add(body, [g.at]).start for body, g in zip(bodies, guides, strict=True)]
        wheels = [i for i, body, g in zip(where, bodies, guides, strict=True)
                  if g.radius > 0 and not any(isinstance(s, Circle) and s.at == g.at
                                              for s in model.mechanism.bodies[body].shapes)]
        return _Cord(slice(where[0], where[-1] + 1), [g.radius for g in guides],
                     [1 if g.side == "right" else -1 for g in guides], wheels)

    @property
    def slack(self) -> bool:
        """Whether any tendon is slack at any time."""
        return bool((self._tension <= SLACK_FRACTION * self.largest).any())

    def key(self, moment: Moment) -> bytes:
        """Equal for moments whose cords have the same colours."""
        fraction = self._tension[moment.sample] / (self.largest or 1.0)
        levels = np.where(fraction <= SLACK_FRACTION, -1, np.floor(fraction * (LEVELS - 1) + 0.5))
        return levels.astype(np.int16).tobytes()

    def draw_wheels(self, canvas: Canvas, moment: Moment) -> None:
        """The wheels of guides, below the cords."""
        for cord in self._cords:
            for i in cord.wheels:
                pixels = cord.radii[i - cord.where.start] * canvas.camera.scale
                canvas.touch(moment.points[i], pixels / canvas.unit + 1)
                clip.circle(canvas.surface, WHEEL_EDGE, moment.points[i], pixels)
                clip.circle(canvas.surface, WHEEL, moment.points[i],
                                   max(1.0, pixels - 1.2 * canvas.unit))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The cords, the slack ones first, and the eyes they run through."""
        tensions = self._tension[moment.sample]
        for k in np.argsort(tensions, kind="stable"):
            cord, tension = self._cords[k], float(tensions[k])
            path = self._path(canvas, moment, cord)
            if tension <= SLACK_FRACTION * self.largest:
                canvas.touch_path(path, 2)
                clip.dashed(canvas.surface, SLACK, path, 5 * canvas.unit, 4 * canvas.unit,
                            canvas.width(1.8))
            else:
                canvas.polyline(tension_colour(tension / self.largest), path, CORD)
        for i in self._eyes:
            canvas.ring(PIN_FILL, PIN_RING, moment.points[i], 2.7, 1.0)

    @staticmethod
    def _path(canvas: Canvas, moment: Moment, cord: _Cord) -> list[XY]:
        if not any(cord.radii):
            return moment.points[cord.where]
        # the picture's y runs down, so right of the path in the world is left of it here
        radii = [r * canvas.camera.scale for r in cord.radii]
        return cord_path(moment.points[cord.where], radii, [-s for s in cord.senses], WOUND)
