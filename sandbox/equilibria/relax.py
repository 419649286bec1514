"""Where a mechanism comes to rest, by the engine's own steps: kinetic damping.

Bodies move as forces have it until their energy of motion passes a peak; there all are stopped,
and begin anew. At a peak forces balance along the motion, so every stop is nearer to rest than the
one before, whatever dampers there are: none is needed, and none is waited for. How far anything
goes in a step is bounded, so that no contact is jumped over.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sandbox.engine.still import Still
from sandbox.numeric import Array

REST = 1e-12
"""Share of the size: what comes no farther in a step from rest is at rest."""
BLOCK = 4
"""Steps between two looks at the energy."""
FAR = 10.0
"""Times the size: what has gone so far is held by nothing."""

TURNS = 60.0
"""So far what nothing holds turns [rad]."""


@dataclass(frozen=True)
class Relaxed:
    """How a relaxation ended."""

    at_rest: bool
    worst: int
    """The body that moves fastest."""


class Relaxation:
    """Lets a mechanism come to rest.

    Args:
        still: the mechanism.
        size: of the mechanism [m].
        reach: of every body from its centre of mass, [nb] m.
        most: how far a point may go in one step [m].
    """

    def __init__(self, still: Still, size: float, reach: Array, most: float) -> None:
        self.still, self.size, self.reach, self.most = still, size, reach, most
        self.free = still.model.bodies.free
        self.moved = 0
        """Steps made in all."""

    def run(self, drive: Array, *, steps: int, rest: float = REST) -> Relaxed:
        """Go on until at rest, ``steps`` at most; bodies are left without speed.

        Args:
            drive: values of the drives, [nd].
            steps: at most.
            rest: share of the size that counts as no way to go in a step.

        Raises:
            SimulationDiverged: the motion stopped being finite.
        """
        still, h, begin = self.still, self.still.step_size, self.still.pose
        last, fresh, until = 0.0, True, self.moved + steps
        still.slow(0.0)
        while True:
            count = 1 if fresh else BLOCK
            still.move(drive, count=count)
            self.moved += count
            speed = still.speed
            way = h * self._ways(speed)
            worst = int(np.argmax(way))
            at_rest = fresh and bool(way[worst] <= rest * self.size)
            if at_rest or self.moved >= until or self._gone(begin, worst):
                still.slow(0.0)
                return Relaxed(at_rest, worst)
            energy = self._energy(speed)
            if not fresh and energy < last:
                still.slow(0.0)
                last, fresh = 0.0, True
                continue
            last, fresh = energy, False
            if way[worst] > self.most:
                share = self.most / float(way[worst])
                still.slow(share)
                last *= share * share

    def _gone(self, begin: Array, worst: int) -> bool:
        x, y, turn = np.abs((self.still.pose - begin)[worst])
        return bool(max(x, y) > FAR * self.size or turn > TURNS)

    def _ways(self, speed: Array) -> Array:
        """How fast a point of each body moves at most [m/s]."""
        fast = np.hypot(speed[:, 0], speed[:, 1]) + self.reach * np.abs(speed[:, 2])
        return np.asarray(np.where(self.free, fast, 0.0))

    def _energy(self, speed: Array) -> float:
        return float((self.still.mass[self.free] * speed[self.free] ** 2).sum() / 2)
