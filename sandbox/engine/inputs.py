"""Inputs over time: values of drives and poses of scheduled bodies.

Values are those at the pose of the step, of motors half a step later, of rigid servos at the next
pose. No value is below its drive's floor. Positions move first, then velocities: after step k the
poses, and the forces of step k, belong to t = (k - 1/2) h, the velocities to t = k h. Labelled so,
the scheme is a leapfrog of second order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pymunk

from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.numeric import Array, Integers
from sandbox.scene.bodies import Body
from sandbox.values.signals import AnySignal, Constant, Path, values
from sandbox.values.tables import Tables
from sandbox.values.units import RANGES


@dataclass(frozen=True)
class Clock:
    """Step h [s], number of steps, and steps between two samples."""

    step: float
    steps: int
    every: int

    @property
    def samples(self) -> int:
        """Number of samples in a whole run."""
        return self.steps // self.every

    def force_time(self, k: Integers | int) -> Array:
        """Instant [s] of the poses and forces of a step, counted k = 1, 2, and so on."""
        return (np.asarray(k, dtype=float) - 0.5) * self.step

    def sample_step(self, i: Integers | int) -> Integers:
        """The step that sample i = 0, 1, … records."""
        return (np.asarray(i, dtype=np.int64) + 1) * self.every


def make_clock(duration: float, step: float, sample_rate: float) -> Clock:
    """A clock for a run of ``duration`` [s]: at least one step and one sample."""
    steps = max(1, math.ceil(duration / step - 1e-9))
    every = min(steps, max(1, round(1 / (sample_rate * step))))
    return Clock(step, steps, every)


CHUNK = 4096  # steps whose signals are computed at once; chunks begin at steps 1, CHUNK + 1, ...


class Inputs:
    """Signals sampled a chunk of steps ahead, in one vectorised call each."""

    def __init__(self, world: World, clock: Clock) -> None:
        self.world, self.clock = world, clock
        self.model = world.model
        self.mechanism = self.model.mechanism
        self._start = 1
        self._drives: Array = np.zeros((0, len(self.mechanism.drives)))
        bodies = [(i, self.mechanism.bodies[i]) for i in world.order.tolist()]
        self._moved = [(i, body, body.path) for i, body in bodies if body.path is not None]
        self._speeds: Array = np.zeros((0, len(self._moved), 3))
        drives = self.model.drives
        self._circles: dict[int, tuple[pymunk.Circle, float]] = {}
        """The circles in pymunk whose radii drives set, and by how much they stand out there."""
        for i in (i for i, kind in enumerate(drives.kind) if kind.latched):
            circle, = world.shapes[int(drives.target[i])][int(drives.shape[i])]
            assert isinstance(circle, pymunk.Circle)  # references are checked when a scene is read
            self._circles[i] = circle, float(
                world.shape_tables.shapes["margin"][circle.collision_type - 1])
        self._latched: dict[int, float] = {}  # their values in pymunk
        self._place()

    @property
    def at_once(self) -> int:
        """Maximum number of steps at a time: one if a varying signal sets a radius in pymunk."""
        switched = {name for event in self.mechanism.events for name in event.set}
        controlled = {name for controller in self.mechanism.controllers
                      if controller.active and f"{controller.name}.active" not in switched
                      for name in controller.written}
        varied = any(not isinstance(drive.value, Constant) and drive.name not in controlled
                     for drive in map(self.mechanism.drives.__getitem__, self._circles))
        return 1 if varied else CHUNK

    def rows(self, k: int, maximum: int) -> Array:
        """Values of all drives for up to ``maximum`` steps from step k, fewer at a chunk's end."""
        if not self._start <= k < self._start + len(self._drives):
            self._fill(k)
        row = k - self._start
        return self._drives[row : row + maximum]

    def apply(self, row: Array) -> None:
        """Set the radii in pymunk, from the values of all drives [nd]."""
        for i, (circle, margin) in self._circles.items():
            value = float(row[i])
            if self._latched.get(i) != value:
                self._latched[i] = value
                # a controller's value is not checked, and pymunk refuses some
                circle.unsafe_set_radius(min(value, RANGES["length"].maximum) + margin)
                shapes = self.world.shape_tables.shapes
                shapes["radius"][circle.collision_type - 1] = circle.radius - margin
                self.world.space.reindex_shape(circle)  # pymunk keeps the bounds of fixed bodies

    def speeds(self, k: int, count: int) -> Array:
        """Velocities of scheduled bodies after the steps from k, as :meth:`rows`, [n, ns, 3]."""
        row = k - self._start
        return self._speeds[row : row + count]

    def _place(self) -> None:
        """Put scheduled bodies to their poses half a step before t = 0, paths continued."""
        if not self._moved:
            return
        self._fill(1)
        for index, body, path in self._moved:
            n = self.world.number[index]
            start, first = np.array([*body.at, body.angle]), self._poses(body, path, 1, 1)[0]
            held, speed = self.world.bodies[n], 2 * (first - start) / self.clock.step
            x, y, angle = (2 * start - first).tolist()
            held.position, held.angle = (x, y), angle
            vx, vy, held.angular_velocity = speed.tolist()
            held.velocity = vx, vy
            self.world.space.reindex_shapes_for_body(held)
        self.world.read()

    def places(self, k: int) -> Array:
        """Poses of scheduled bodies' frames in step k, in pymunk's order, [ns, 3]."""
        found = [self._poses(body, path, k, k)[0] for _, body, path in self._moved]
        return np.array(found).reshape(-1, 3)

    def _fill(self, start: int) -> None:
        stop = min(start + CHUNK, self.clock.steps + 1)
        times = self.clock.force_time(np.arange(start, stop))
        drives = np.empty((stop - start, len(self.mechanism.drives)))
        for i, drive in enumerate(self.mechanism.drives):
            late = self.clock.step * float(self.model.drives.late[i])
            drives[:, i] = signal_values(f"drive {drive.name}", drive.signal(self.mechanism),
                                         times + late, self.mechanism.functions)
        speeds = np.stack(
            [self._speeds_of(body, path, start, stop) for _, body, path in self._moved], axis=1,
        ) if self._moved else np.zeros((stop - start, 0, 3))
        # only now: a signal without a value raises an error
        self._start, self._speeds = start, speeds
        self._drives = np.maximum(drives, self.model.drives.floor)

    def _speeds_of(self, body: Body, path: Path, start: int, stop: int) -> Array:
        """Velocities [n, 3] after the steps ``start`` … ``stop`` - 1."""
        last = min(stop, self.clock.steps)
        poses = self._poses(body, path, max(start - 2, 1), last)
        if start == 1:  # continue the path before the first
            begin = np.array([*body.at, body.angle])
            poses = np.vstack([2 * begin - poses[0], poses])
        speeds = np.diff(poses, axis=0) / self.clock.step
        if last < stop:
            beyond = 2 * speeds[-1] - speeds[-2] if len(speeds) > 1 else speeds[-1]
            speeds = np.vstack([speeds, beyond])
        found: Array = speeds[len(speeds) - (stop - start):]
        return found

    def _poses(self, body: Body, path: Path, first: int, last: int) -> Array:
        times = self.clock.force_time(np.arange(first, last + 1))
        poses = np.tile([*body.at, body.angle], (len(times), 1))
        for axis, signal in enumerate((path.x, path.y, path.angle)):
            if signal is not None:
                poses[:, axis] = signal_values(
                    f"path of {body.name}", signal, times, self.mechanism.functions)
        return poses


def signal_values(what: str, signal: AnySignal, times: Array, tables: Tables) -> Array:
    """Values at some times; SceneError without one."""
    try:
        return values(signal, times, tables)
    except ValueError as error:
        raise SceneError([Problem("bad-argument", f"{what}: {error}")]) from None
