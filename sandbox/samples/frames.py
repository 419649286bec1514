"""Points, velocities and coupled coordinates of rigid bodies in all samples of a run."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import Place, place_in_slot
from sandbox.numeric import Array, Integers
from sandbox.samples.outcome import Stored


class Places(NamedTuple):
    """Points of bodies over time, all [k, n] in m."""

    x: Array
    """In the world."""
    y: Array
    arm_x: Array
    """From the body's centre of mass, along the world's axes."""
    arm_y: Array


class Frames:
    """Poses of all bodies in some samples of a recording, and points of theirs."""

    def __init__(self, run: Stored) -> None:
        self.run, self.model = run, run.model
        self.x, self.y, self.angle = (
            np.ascontiguousarray(part) for part in run.arrays["body_pose"].transpose(2, 1, 0))
        """Poses of the bodies' frames in the world, [nb, n] m, m, rad."""
        self.samples = self.x.shape[1]
        still = self.model.bodies.fixed
        self.cos, self.sin = np.empty_like(self.angle), np.empty_like(self.angle)
        for function, into in ((np.cos, self.cos), (np.sin, self.sin)):
            into[~still] = function(self.angle[~still])
            into[still] = function(self.angle[still, :1])
        centre = run.arrays["body_centre"]
        self._centre = centre
        self.centre_x = self.x + self.cos * centre[:, :1] - self.sin * centre[:, 1:]
        """Centres of mass in the world, [nb, n] m."""
        self.centre_y = self.y + self.sin * centre[:, :1] + self.cos * centre[:, 1:]

    def places(self, bodies: Integers | Sequence[int], points: Array) -> Places:
        """Points given in the frames of ``bodies`` [k], as [k, 2] m."""
        on = np.asarray(bodies, dtype=np.int64)
        local = points.reshape(-1, 2) - self._centre[on]
        c, s = self.cos[on], self.sin[on]
        arm_x = c * local[:, :1] - s * local[:, 1:]
        arm_y = s * local[:, :1] + c * local[:, 1:]
        return Places(self.centre_x[on] + arm_x, self.centre_y[on] + arm_y, arm_x, arm_y)

    @cached_property
    def anchors(self) -> tuple[Places, Places]:
        """Anchors of all joints, on ``a`` and on ``b``, [nj, n]."""
        joints = self.model.joints
        return (self.places(joints.bodies[:, 0], joints.anchor[:, 0]),
                self.places(joints.bodies[:, 1], joints.anchor[:, 1]))

    def groove_direction(self, joint: int) -> tuple[Array, Array]:
        """Direction of a slot from its start to its end, in the world, [n] each."""
        place = self.place_in_slot(joint)
        return place.x, place.y

    def place_in_slot(self, joint: int) -> Place:
        """The place of a slot's point along its groove or path, [n] each."""
        arrays = self.run.arrays
        return place_in_slot(self.model, joint, arrays["body_pose"],
                             arrays["joint_length"][:, joint])

    @cached_property
    def velocity(self) -> Array:
        """Velocities of the centres of mass, and angular velocities, [3, nb, n]."""
        return np.ascontiguousarray(self.run.arrays["body_velocity"].transpose(2, 1, 0))

    @cached_property
    def acceleration(self) -> Array:
        """Accelerations of the centres of mass, and angular ones, [3, nb, n]."""
        return np.ascontiguousarray(self.run.arrays["body_acceleration"].transpose(2, 1, 0))

    @cached_property
    def gaps(self) -> Array:
        """Between the two anchors of every joint [m], [nj, n]."""
        a, b = self.anchors
        return np.hypot(b.x - a.x, b.y - a.y)
