"""What the outside sets over time: values of drives and poses of scheduled bodies.

The loop, before it makes ``count`` <= :attr:`Inputs.at_once` steps from step k on:

    drive = inputs.rows(k, count)  # what the signals say, [count, nd]; other values may be put in
    inputs.apply(drive[0])         # what pymunk itself latches: radii, motors, brakes

Forces, torques, pulls and stiffnesses are read from ``drive`` at every step; what pymunk latches
stays as it is from one ``apply`` to the next. And with every step made, ``inputs.steer(k)``.
No value is below its drive's floor.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pymunk

from sandbox.engine.clock import Clock
from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.numeric import Array
from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.controllers import writes_of
from sandbox.scene.mechanism import signal_of
from sandbox.scene.values.signals import AnySignal, Constant, Path, values

CHUNK = 4096
"""Steps whose signals are worked out in one go; chunks begin at steps 1, CHUNK + 1, ..."""


class Inputs:
    """Signals sampled a chunk of steps ahead, in one vectorised call each."""

    def __init__(self, world: World, clock: Clock) -> None:
        self.world, self.clock = world, clock
        self.model = world.model
        self.mechanism = self.model.mechanism
        self._start = 1
        self._drives: Array = np.zeros((0, len(self.mechanism.drives)))
        self._moved = [(i, body, body.path) for i, body in enumerate(self.mechanism.bodies)
                       if body.path is not None]
        self._speeds: Array = np.zeros((0, len(self._moved), 3))
        kinds = self.model.drives.kind
        self._latches = {i: LATCHES[drive.type](world, i)
                      for i, drive in enumerate(self.mechanism.drives) if kinds[i].latched}
        self._latched: dict[int, float] = {}
        """What pymunk was last given of each drive."""

    @property
    def at_once(self) -> int:
        """How many steps may be made without coming back.

        One if bodies are steered, or something that pymunk latches by a signal that varies; what a
        controller writes from the start, if no event switches it, changes when that acts.
        """
        switched = {name for event in self.mechanism.events for name in event.set}
        controlled = {name for controller in self.mechanism.controllers
                      if controller.active and f"{controller.name}.active" not in switched
                      for name in writes_of(controller)}
        drives = self.mechanism.drives
        varied = any(not isinstance(drives[i].value, Constant) and drives[i].name not in controlled
                     for i in self._latches)
        return 1 if self._moved or varied else CHUNK

    def rows(self, k: int, most: int) -> Array:
        """Values of all drives for up to ``most`` steps from step k on, by their signals [n, nd].

        Fewer where a chunk ends, so that a run's numbers do not hang on where it paused.
        """
        if not self._start <= k < self._start + len(self._drives):
            self._fill(k)
        row = k - self._start
        return self._drives[row : row + most]

    def apply(self, row: Array) -> None:
        """Set in pymunk what it latches, from the values of all drives [nd]."""
        for i, latch in self._latches.items():
            value = float(row[i])
            if self._latched.get(i) != value:
                self._latched[i] = value
                latch(value)

    def steer(self, k: int) -> None:
        """Give scheduled bodies the velocity that leads to their pose of step k.

        Other bodies have that velocity as soon as step k - 1 is made, so this is called then.
        Beyond the last step it goes on changing as before.
        """
        if not self._moved:
            return
        if k <= self.clock.steps and k >= self._start + len(self._drives):
            self._fill(k)
        for j, (i, _, _) in enumerate(self._moved):
            n = self.world.number[i]
            vx, vy, omega = speed = self._speeds[k - self._start, j]
            self.world.bodies[n].velocity = float(vx), float(vy)
            self.world.bodies[n].angular_velocity = float(omega)
            self.world.body[n, 3:] = speed

    def _fill(self, start: int) -> None:
        stop = min(start + CHUNK, self.clock.steps + 1)
        times = self.clock.force_time(np.arange(start, stop))
        drives = np.empty((stop - start, len(self.mechanism.drives)))
        for i, drive in enumerate(self.mechanism.drives):
            drives[:, i] = self._values(
                f"drive {drive.name}", signal_of(drive, self.mechanism), times)
        speeds = np.stack(
            [self._speeds_of(body, path, start, stop) for _, body, path in self._moved], axis=1,
        ) if self._moved else np.zeros((0, 0, 3))
        # only now, when no signal was found to be without a value
        self._start, self._speeds = start, speeds
        self._drives = np.maximum(drives, self.model.drives.floor)

    def _speeds_of(self, body: Body, path: Path, start: int, stop: int) -> Array:
        """Velocities [n + 1, 3] that lead to the poses of steps ``start`` … ``stop``."""
        first = max(start - 2, 0)
        times = self.clock.force_time(np.arange(first, stop))
        poses = np.tile([*body.at, body.angle], (len(times), 1))
        for axis, signal in enumerate((path.x, path.y, path.angle)):
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


Latch = Callable[[float], None]


def _radius(world: World, drive: int) -> Latch:
    drives = world.model.drives
    circle = world.shapes[int(drives.target[drive])][int(drives.shape[drive])]

    def latch(value: float) -> None:
        assert isinstance(circle, pymunk.Circle)  # references are checked when a scene is read
        circle.unsafe_set_radius(value)
        world.space.reindex_shape(circle)  # pymunk keeps the bounds of what is fixed

    return latch


def _motor(world: World, drive: int) -> Latch:
    motor, sense = world.motors[drive], world.model.joints.sense[world.model.drives.target[drive]]

    def latch(value: float) -> None:
        motor.rate = -float(sense) * value  # pymunk's rate is that of a against b

    return latch


def _brake(world: World, drive: int) -> Latch:
    motor = world.motors[drive]

    def latch(value: float) -> None:
        motor.max_force = value

    return latch


LATCHES: dict[str, Callable[[World, int], Latch]] = {
    "radius": _radius, "motor": _motor, "brake": _brake}
"""What sets in pymunk the value that it latches of each kind of drive, by its tag."""
