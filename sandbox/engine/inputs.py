"""What the outside sets over time: values of drives and poses of scheduled bodies."""

from __future__ import annotations

import numpy as np
import pymunk
from numpy.typing import NDArray

from sandbox.engine.clock import Clock
from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.scene.drives import RadiusDrive
from sandbox.scene.signals import values

Array = NDArray[np.float64]

CHUNK = 4096


class Inputs:
    """Signals sampled a chunk of steps ahead, in one vectorised call each."""

    def __init__(self, world: World, clock: Clock) -> None:
        self.world, self.clock = world, clock
        self.mechanism = world.mechanism
        self._start = 1
        self._drives: Array = np.zeros((0, len(self.mechanism.drives)))
        self._moved = [body for body in self.mechanism.bodies if body.path is not None]
        self._speeds: Array = np.zeros((0, len(self._moved), 3))
        self._swelling = self._circles()

    def _circles(self) -> list[tuple[int, pymunk.Circle]]:
        found = []
        for i, drive in enumerate(self.mechanism.drives):
            if isinstance(drive, RadiusDrive):
                shape = self.world.shapes[drive.body][drive.shape]
                assert isinstance(shape, pymunk.Circle)  # checked when the scene is read
                found.append((i, shape))
        return found

    @property
    def at_once(self) -> int:
        """How many steps may be made without coming back: one if bodies or radii are steered."""
        return 1 if self._moved or self._swelling else CHUNK

    def rows(self, k: int, count: int) -> Array:
        """Values of all drives for ``count`` steps from step k on, shape [count, nd].

        Scheduled bodies and radii are set to what they are at step k.
        """
        if k + count > self._start + len(self._drives):
            self._fill(k)
        row = k - self._start
        for i, circle in self._swelling:
            circle.unsafe_set_radius(max(self._drives[row, i], 1e-9))
        for j, spec in enumerate(self._moved):
            vx, vy, omega = self._speeds[row, j]
            body = self.world.bodies[self.world.number[spec.name]]
            body.velocity, body.angular_velocity = (vx, vy), omega
        return self._drives[row : row + count]

    def _fill(self, start: int) -> None:
        stop = min(start + CHUNK, self.clock.steps + 1)
        times = self.clock.force_time(np.arange(start - 1, stop))
        self._start = start
        self._drives = np.empty((stop - start, len(self.mechanism.drives)))
        for i, drive in enumerate(self.mechanism.drives):
            self._drives[:, i] = self._values(f"drive {drive.name}", drive.value, times[1:])
        self._speeds = np.empty((stop - start, len(self._moved), 3))
        for j, body in enumerate(self._moved):
            assert body.path is not None
            held = (*body.at, body.angle)
            for axis, signal in enumerate((body.path.x, body.path.y, body.path.angle)):
                pose = np.full(len(times), held[axis])
                if signal is not None:
                    pose = self._values(f"path of {body.name}", signal, np.maximum(times, 0.0))
                    if start == 1:
                        pose[0] = held[axis]
                self._speeds[:, j, axis] = np.diff(pose) / self.clock.step

    @staticmethod
    def _values(what: str, signal: object, times: Array) -> Array:
        try:
            return values(signal, times)  # type: ignore[arg-type]
        except ValueError as error:
            raise SceneError([Problem(f"{what}: {error}")]) from None
