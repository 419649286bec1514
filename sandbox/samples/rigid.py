"""Forces that keep two bodies from moving along them, and how they turn as both move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array

SMALL = 1e-7
"""Motions [m, and by the size of the object rad] over which forces are compared: the square of it
over that of the mechanism's lengths is left out, rounding over it is kept."""
Form = tuple[Array, tuple[float, float], Array, int]
"""Arms, radii, direction and what turns it, as a force between two bodies has them."""


@dataclass(frozen=True)
class Rigid:
    """A force between two bodies that keeps them from moving along it."""

    bodies: tuple[int, int]
    centres: Array
    """Of mass, [2, 2]."""
    arms: Array
    """From these to the centre of rounding of either side, or a point, [2, 2]."""
    radii: tuple[float, float]
    along: Array
    """Of the force on the first body, [2]."""
    turns: int
    """What turns its line: body 0 or 1; 2 the line between both points; 3 nothing."""
    force: float
    """The size of the force [N]."""
    across: bool = False
    """Whether it acts across that line, as friction does."""

    def wrench(self, moved: Array) -> Array:
        """Force and moment on both as these have moved by x, y, turn, [m, 6], each; [m, 6]."""
        ends = [self.centres[k] + moved[:, 3 * k:3 * k + 2]
                + _turned(self.arms[k], moved[:, 3 * k + 2]) for k in (0, 1)]
        n = np.broadcast_to(self.along, (len(moved), 2))
        if self.turns == 2:
            way = ends[0] - ends[1]
            n = way / np.hypot(way[:, :1], way[:, 1:])
        elif self.turns < 2:
            n = _turned(self.along, moved[:, 3 * self.turns + 2])
        at = ends[0] - self.radii[0] * n if self.turns != 0 else ends[1] + self.radii[1] * n
        f = np.stack([-n[:, 1], n[:, 0]], axis=1) if self.across else n
        arms = [at - self.centres[k] - moved[:, 3 * k:3 * k + 2] for k in (0, 1)]
        one, two = (arm[:, 0] * f[:, 1] - arm[:, 1] * f[:, 0] for arm in arms)
        return np.concatenate([f, one[:, None], -f, -two[:, None]], axis=1)

    def slopes(self, size: float) -> Array:
        """How both wrenches change with the motions of both bodies, [6, 6]."""
        steps = SMALL * np.array([size, size, 1.0] * 2)
        found = self.wrench(np.concatenate([np.diag(steps), -np.diag(steps)]))
        return np.asarray(((found[:6] - found[6:]) / (2 * steps[:, None])).T)


def _turned(vector: Array, angle: Array) -> Array:
    """A vector turned by angles [m], [m, 2]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[0] - s * vector[1], s * vector[0] + c * vector[1]], axis=1)
