"""Every recorded load as a force at a body's centre of mass and a moment about it.

Tendons, springs, dampers, stops, drives, contacts, weight: all but the joints,
whose forces follow from these (:mod:`sandbox.samples.reactions`). Rows are
loads or bodies, columns samples.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.kinds.arrays import Array, Integers
from sandbox.samples.cords import Guides, Stretches, guides_of, stretches
from sandbox.samples.frames import Frames, Layout
from sandbox.samples.stored import Stored
from sandbox.scene.elements.bodies import Circle
from sandbox.scene.elements.drives import (
    BrakeDrive,
    ForceDrive,
    MotorDrive,
    StiffnessDrive,
    TorqueDrive,
)
from sandbox.scene.elements.springs import LinearSpring, RotarySpring

TURNING = (TorqueDrive, MotorDrive, BrakeDrive)
"""Drives that are a torque between the two bodies of a hinge."""


class Batch(NamedTuple):
    """Loads of one kind."""

    kind: str
    element: Integers
    """Which element of its kind each is of, [k]."""
    body: Integers
    """On which body each acts, [k]."""
    x: Array
    """Force in the world [N], [k, n]."""
    y: Array
    moment: Array
    """About the body's centre of mass, counter-clockwise [N m], [k, n]."""


class ContactSides(NamedTuple):
    """Both bodies of every contact row: 2 m rows."""

    sample: Integers
    body: Integers
    force: Array
    """On the body [N], [2 m, 2]."""
    moment: Array
    """About its centre of mass [N m]; with two points of contact only nearly so."""
    at: Array
    """Where the force acts, in the world [m], [2 m, 2]."""
    point: NDArray[np.bool_]
    """Whether the two can touch in one point only."""


class Loads:
    """The loads of a recording, one batch a kind; sums over bodies when asked for."""

    def __init__(self, run: Stored, layout: Layout | None = None) -> None:
        self.run = run
        self.layout = layout or Layout(run.mechanism)
        self.frames = Frames(run, self.layout)
        self.aimed = Frames(run, self.layout, predicted=True)
        """Where tendons, springs and drives were when their forces were worked out."""

    @cached_property
    def cords(self) -> Stretches:
        """The straight pieces of all tendons."""
        return stretches(self.aimed, self.guides)

    @cached_property
    def guides(self) -> Guides:
        """The guides of all tendons."""
        return guides_of(self.layout)

    @cached_property
    def batches(self) -> list[Batch]:
        """All loads but those of contacts and joints."""
        return list(self._batches())

    @cached_property
    def totals(self) -> Array:
        """Sum of all loads but those of joints: force x, y [N] and moment [N m], [3, nb, n]."""
        total = self._contact_totals()
        for batch in self.batches:
            for k, body in enumerate(batch.body):
                if self.layout.free[body]:
                    total[0, body] += batch.x[k]
                    total[1, body] += batch.y[k]
                    total[2, body] += batch.moment[k]
        return total

    @cached_property
    def largest(self) -> Array:
        """Largest single force [N] and moment [N m] on every body in the whole run, [2, nb].

        The inertial forces m a and I alpha count, too.
        """
        most = self._contact_most
        mass = self.run.arrays["body_mass"], self.run.arrays["body_inertia"]
        a = self.frames.acceleration
        for body in np.flatnonzero(self.layout.free):
            most[0, body] = max(most[0, body], mass[0][body] * _peak(np.hypot(a[0, body],
                                                                              a[1, body])))
            most[1, body] = max(most[1, body], mass[1][body] * _peak(a[2, body]))
        for batch in self.batches:
            force = np.sqrt((batch.x**2 + batch.y**2).max(axis=1, initial=0.0))
            moment = np.abs(batch.moment).max(axis=1, initial=0.0)
            np.maximum.at(most[0], batch.body, force)
            np.maximum.at(most[1], batch.body, moment)
        return most

    def _batches(self) -> Iterator[Batch]:
        mechanism = self.layout.mechanism
        if mechanism.tendons:
            yield self._tendons()
        if any(mechanism.gravity):
            yield self._weight()
        if any(isinstance(spring, LinearSpring) for spring in mechanism.springs):
            yield self._linear_springs()
        if any(isinstance(spring, RotarySpring) for spring in mechanism.springs):
            yield self._rotary_springs()
        for kind in ("damping", "stop"):
            if self.layout.pins:
                yield self._at_pins(kind)
        if any(isinstance(drive, TURNING) for drive in mechanism.drives):
            yield self._torques()
        if any(isinstance(drive, ForceDrive) for drive in mechanism.drives):
            yield self._forces()

    def _tendons(self) -> Batch:
        guides, cords = self.guides, self.cords
        tension = self.run.arrays["tendon_tension"].T[guides.tendon]
        fx, fy = tension * cords.x, tension * cords.y
        one, two = guides.first, guides.first + 1
        moments = []
        for nodes, end in ((one, cords.start), (two, cords.end)):
            moment = end.arm_x * fy - end.arm_y * fx
            for k in np.flatnonzero(guides.radius[nodes]):
                moment[k] += guides.radius[nodes[k]] * -tension[k]  # n x u = -1
            moments.append(moment)
        return Batch("tendon", np.tile(guides.tendon, 2),
                     np.concatenate([guides.body[one], guides.body[two]]),
                     np.concatenate([fx, -fx]), np.concatenate([fy, -fy]),
                     np.concatenate([moments[0], -moments[1]]))

    def _weight(self) -> Batch:
        free = np.flatnonzero(self.layout.free)
        weight = self.run.arrays["body_mass"][free, None] * np.ones(self.frames.samples)
        gx, gy = self.layout.mechanism.gravity
        return Batch("gravity", np.zeros(len(free), dtype=np.int64), free, weight * gx,
                     weight * gy, np.zeros_like(weight))

    def _linear_springs(self) -> Batch:
        number = self.layout.number
        chosen = [(i, s) for i, s in enumerate(self.layout.mechanism.springs)
                  if isinstance(s, LinearSpring)]
        which = np.array([i for i, _ in chosen])
        a, b = (np.array([number[name] for name in names])
                for names in ([s.a for _, s in chosen], [s.b for _, s in chosen]))
        one = self.aimed.places(a, [s.on_a for _, s in chosen])
        two = self.aimed.places(b, [s.on_b for _, s in chosen])
        dx, dy = two.x - one.x, two.y - one.y
        length = np.hypot(dx, dy)
        pull = self.run.arrays["spring_force"].T[which] / np.where(length > 0, length, np.inf)
        fx, fy = pull * dx, pull * dy
        return Batch("spring", np.tile(which, 2), np.concatenate([a, b]),
                     np.concatenate([fx, -fx]), np.concatenate([fy, -fy]),
                     np.concatenate([one.arm_x * fy - one.arm_y * fx,
                                     two.arm_y * fx - two.arm_x * fy]))

    def _rotary_springs(self) -> Batch:
        """Without their dampers, which are among those of the pins."""
        chosen = [(i, s) for i, s in enumerate(self.layout.mechanism.springs)
                  if isinstance(s, RotarySpring)]
        joints = np.array([self.layout.joint_number[s.joint] for _, s in chosen])
        rest = np.array([s.rest_angle for _, s in chosen])[:, None]
        stiffness = np.array([s.stiffness for _, s in chosen])[:, None]
        a, which = self.run.arrays, np.array([i for i, _ in chosen])
        torque = -stiffness * (a["joint_angle"].T[joints] - rest)
        driven = {d.spring for d in self.layout.mechanism.drives if isinstance(d, StiffnessDrive)}
        for k, (i, spring) in enumerate(chosen):
            if spring.name in driven:
                damping = spring.damping * a["joint_rate"].T[joints[k]]
                torque[k] = damping - a["spring_force"].T[i]
        return self._couples("spring", which, joints, torque)

    def _at_pins(self, kind: str) -> Batch:
        joints = np.array(self.layout.pins)
        torque = self.run.arrays[f"joint_{kind}"].T[joints]
        acts = np.nan_to_num(torque).any(axis=1)
        return self._couples(kind, joints[acts], joints[acts], torque[acts])

    def _torques(self) -> Batch:
        """What torque drives are set to, what motors and brakes gave."""
        chosen = [(i, d) for i, d in enumerate(self.layout.mechanism.drives)
                  if isinstance(d, TURNING)]
        torque = np.stack([
            self.run.arrays["drive_value" if isinstance(d, TorqueDrive) else "drive_torque"].T[i]
            for i, d in chosen])
        joints = np.array([self.layout.joint_number[d.joint] for _, d in chosen])
        return self._couples("drive", np.array([i for i, _ in chosen]), joints, torque)

    def _couples(self, kind: str, element: Integers, joints: Integers, torque: Array) -> Batch:
        """Torques [k, n] between the two bodies of pins, in the pins' positive sense."""
        torque = np.nan_to_num(torque) * self.layout.sense[joints][:, None]
        bodies = self.layout.joint_bodies[joints]
        nothing = np.zeros((2 * len(joints), self.frames.samples))
        return Batch(kind, np.tile(element, 2), np.concatenate([bodies[:, 1], bodies[:, 0]]),
                     nothing, nothing, np.concatenate([torque, -torque]))

    def _forces(self) -> Batch:
        chosen = [(i, d) for i, d in enumerate(self.layout.mechanism.drives)
                  if isinstance(d, ForceDrive)]
        which = np.array([i for i, _ in chosen])
        body = np.array([self.layout.number[d.body] for _, d in chosen])
        at = self.aimed.places(body, [d.at for _, d in chosen])
        value = self.run.arrays["drive_value"].T[which]
        along = np.array([np.array(d.direction) / np.hypot(*d.direction) for _, d in chosen])
        turns = np.array([d.frame == "body" for _, d in chosen])[:, None]
        c = np.where(turns, self.aimed.cos[body], 1.0)
        s = np.where(turns, self.aimed.sin[body], 0.0)
        fx = value * (c * along[:, :1] - s * along[:, 1:])
        fy = value * (s * along[:, :1] + c * along[:, 1:])
        return Batch("drive", which, body, fx, fy, at.arm_x * fy - at.arm_y * fx)

    # -- contacts -----------------------------------------------------------------------

    @cached_property
    def single(self) -> NDArray[np.bool_]:
        """Bodies that touch anything in one point only: one shape, which is a circle, [nb]."""
        return np.array([len(b.shapes) == 1 and isinstance(b.shapes[0], Circle)
                         for b in self.layout.mechanism.bodies], dtype=bool)

    @cached_property
    def contact_sides(self) -> ContactSides:
        """Both sides of every contact row."""
        a = self.run.arrays
        sample, body, other = a["contact_sample"], a["contact_body"], a["contact_other"]
        one_shape = np.array([len(b.shapes) == 1 for b in self.layout.mechanism.bodies], dtype=bool)
        point = ((self.single[body] | self.single[other]) & one_shape[body] & one_shape[other])
        half = a["contact_normal"] * a["contact_gap"][:, None] / 2
        sides = []
        for sign, on in ((1.0, body), (-1.0, other)):
            # the force acts where the surface of this body is, half a gap from the mean point
            at = a["contact_point"] + sign * half
            arm_x = at[:, 0] - self.frames.centre_x[on, sample]
            arm_y = at[:, 1] - self.frames.centre_y[on, sample]
            force = sign * a["contact_force"]
            sides.append((on, force, arm_x * force[:, 1] - arm_y * force[:, 0], at))
        return ContactSides(
            np.tile(sample, 2), np.concatenate([s[0] for s in sides]),
            np.concatenate([s[1] for s in sides]), np.concatenate([s[2] for s in sides]),
            np.concatenate([s[3] for s in sides]), np.tile(point, 2))

    def _contact_totals(self) -> Array:
        count, n = len(self.layout.names), self.frames.samples
        sides = self.contact_sides
        slot = sides.body * n + sides.sample
        columns = (sides.force[:, 0], sides.force[:, 1], sides.moment)
        return np.array([np.bincount(slot, weights=column, minlength=count * n)
                         for column in columns]).astype(float).reshape(3, count, n)

    @cached_property
    def _contact_most(self) -> Array:
        sides = self.contact_sides
        most = np.zeros((2, len(self.layout.names)))
        np.maximum.at(most[0], sides.body, np.hypot(sides.force[:, 0], sides.force[:, 1]))
        np.maximum.at(most[1], sides.body, np.abs(sides.moment))
        return most

    @cached_property
    def spread(self) -> NDArray[np.bool_]:
        """Bodies and samples whose contacts may have two points: moments unknown, [nb, n]."""
        sides = self.contact_sides
        result = np.zeros((len(self.layout.names), self.frames.samples), dtype=bool)
        result[sides.body[~sides.point], sides.sample[~sides.point]] = True
        return result


def _peak(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
