"""What the outside sets over time: values of drives and poses of scheduled bodies."""

from __future__ import annotations

import numpy as np
import pymunk
from numpy.typing import NDArray

from sandbox.engine.clock import Clock
from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.scene.bodies import Body
from sandbox.scene.drives import RadiusDrive
from sandbox.scene.signals import AnySignal, values

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

        Radii are set to what they are at step k.
        """
        if k + count > self._start + len(self._drives):
            self._fill(k)
        row = k - self._start
        for i, circle in self._swelling:
            circle.unsafe_set_radius(max(self._drives[row, i], 1e-9))
            self.world.space.reindex_shape(circle)  # pymunk keeps the bounds of what is fixed
        return self._drives[row : row + count]

    def steer(self, k: int) -> None:
        """Give scheduled bodies the velocity that leads to their pose of step k.

        Other bodies have that velocity as soon as step k - 1 is made, so this is called then.
        Beyond the last step it goes on changing as before.
        """
        if not self._moved:
            return
        if k <= self.clock.steps and k >= self._start + len(self._drives):
            self._fill(k)
        for j, spec in enumerate(self._moved):
            n = self.world.number[spec.name]
            vx, vy, omega = speed = self._speeds[k - self._start, j]
            self.world.bodies[n].velocity = float(vx), float(vy)
            self.world.bodies[n].angular_velocity = float(omega)
            self.world.state[n, 3:] = speed

    def _fill(self, start: int) -> None:
        stop = min(start + CHUNK, self.clock.steps + 1)
        times = self.clock.force_time(np.arange(start, stop))
        self._start = start
        self._drives = np.empty((stop - start, len(self.mechanism.drives)))
        for i, drive in enumerate(self.mechanism.drives):
            self._drives[:, i] = self._values(f"drive {drive.name}", drive.value, times)
        self._speeds = np.stack(
            [self._speeds_of(body, start, stop) for body in self._moved], axis=1,
        ) if self._moved else np.zeros((0, 0, 3))

    def _speeds_of(self, body: Body, start: int, stop: int) -> Array:
        """Velocities [n + 1, 3] that lead to the poses of steps ``start`` … ``stop``."""
        assert body.path is not None
        first = max(start - 2, 0)
        times = self.clock.force_time(np.arange(first, stop))
        poses = np.tile([*body.at, body.angle], (len(times), 1))
        for axis, signal in enumerate((body.path.x, body.path.y, body.path.angle)):
            if signal is not None:
                poses[:, axis] = self._values(
                    f"path of {body.name}", signal, np.maximum(times, 0.0))
        if first == 0:
            poses[0] = *body.at, body.angle
        speeds = np.diff(poses, axis=0) / self.clock.step
        beyond = 2 * speeds[-1] - speeds[-2] if len(speeds) > 1 else speeds[-1]
        return np.vstack([speeds, beyond])[start - 1 - first:]

    @staticmethod
    def _values(what: str, signal: AnySignal, times: Array) -> Array:
        try:
            return values(signal, times)
        except ValueError as error:
            raise SceneError([Problem(f"{what}: {error}")]) from None
