"""What the outside sets over time: values of drives and poses of scheduled bodies.

The loop, before it makes ``count`` <= :attr:`Inputs.at_once` steps from step k on:

    drive = inputs.rows(k, count)  # what the signals say, [count, nd]; other values may be put in
    inputs.apply(drive[0])         # what pymunk itself holds: radii, motors, brakes

Forces, torques, pulls and stiffnesses are read from ``drive`` at every step; what pymunk holds
stays as it is from one ``apply`` to the next. And with every step made, ``inputs.steer(k)``.
"""

from __future__ import annotations

import numpy as np
import pymunk
from numpy.typing import NDArray

from sandbox.engine.clock import Clock
from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.scene.elements.bodies import Body
from sandbox.scene.elements.controllers import writes_of
from sandbox.scene.elements.drives import BrakeDrive, MotorDrive, RadiusDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.geometry import joint_angle_sign
from sandbox.scene.mechanism import signal_of
from sandbox.scene.values.signals import AnySignal, Constant, values

Array = NDArray[np.float64]

CHUNK = 4096
LEAST_RADIUS = 1e-9
"""Of a circle that a drive makes smaller [m]."""


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
        self._turning = self._motors()
        self._held: dict[int, float] = {}
        """What pymunk was last told of each drive."""

    def _circles(self) -> list[tuple[int, pymunk.Circle]]:
        found = []
        for i, drive in enumerate(self.mechanism.drives):
            if isinstance(drive, RadiusDrive):
                shape = self.world.shapes[drive.body][drive.shape]
                assert isinstance(shape, pymunk.Circle)  # checked when the scene is read
                found.append((i, shape))
        return found

    def _motors(self) -> list[tuple[int, pymunk.SimpleMotor, float]]:
        """Number of the drive, motor, and sense of its turning; 0 for a brake."""
        pins = {joint.name: joint for joint in self.mechanism.joints if isinstance(joint, Pin)}
        return [(i, self.world.motors[drive.name],
                 joint_angle_sign(pins[drive.joint]) if isinstance(drive, MotorDrive) else 0.0)
                for i, drive in enumerate(self.mechanism.drives)
                if isinstance(drive, MotorDrive | BrakeDrive)]

    @property
    def at_once(self) -> int:
        """How many steps may be made without coming back.

        One if bodies are steered, or something that pymunk holds by a signal that varies; what a
        controller writes from the start, if no event switches it, changes when that acts.
        """
        switched = {name for event in self.mechanism.events for name in event.set}
        controlled = {name for controller in self.mechanism.controllers
                      if controller.active and f"{controller.name}.active" not in switched
                      for name in writes_of(controller)}
        varied = any(
            isinstance(drive, RadiusDrive | MotorDrive | BrakeDrive)
            and not isinstance(drive.value, Constant) and drive.name not in controlled
            for drive in self.mechanism.drives)
        return 1 if self._moved or varied else CHUNK

    def rows(self, k: int, count: int) -> Array:
        """Values of all drives for ``count`` steps from step k on, by their signals [count, nd]."""
        if k + count > self._start + len(self._drives):
            self._fill(k)
        row = k - self._start
        return self._drives[row : row + count]

    def apply(self, row: Array) -> None:
        """Tell pymunk what it holds itself, from the values of all drives [nd]."""
        for i, circle in self._swelling:
            value = float(row[i])
            if self._held.get(i) == value:
                continue
            self._held[i] = value
            circle.unsafe_set_radius(max(value, LEAST_RADIUS))
            self.world.space.reindex_shape(circle)  # pymunk keeps the bounds of what is fixed
        for i, motor, sense in self._turning:
            value = float(row[i])
            if self._held.get(i) == value:
                continue
            self._held[i] = value
            if sense:
                motor.rate = -sense * value  # pymunk's rate is that of a against b
            else:
                motor.max_force = max(value, 0.0)

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
            self._drives[:, i] = self._values(
                f"drive {drive.name}", signal_of(drive, self.mechanism), times)
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
