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

from sandbox.model.model import NONE
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import Stretches, stretches
from sandbox.samples.frames import Frames
from sandbox.samples.stored import Stored
from sandbox.scene.elements.bodies import Circle


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
    point: Flags
    """Whether the two can touch in one point only."""


class Loads:
    """The loads of a recording, one batch a kind; sums over bodies when asked for."""

    def __init__(self, run: Stored) -> None:
        self.run, self.model = run, run.model
        self.frames = Frames(run)
        self.aimed = Frames(run, predicted=True)
        """Where tendons, springs and drives were when their forces were worked out."""

    @cached_property
    def cords(self) -> Stretches:
        """The straight pieces of all tendons."""
        return stretches(self.aimed)

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
                if self.model.bodies.free[body]:
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
        for body in np.flatnonzero(self.model.bodies.free):
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
        model = self.model
        if model.tendons.name:
            yield self._tendons()
        if any(model.mechanism.gravity):
            yield self._weight()
        if model.springs.straight.any():
            yield self._straight_springs()
        if not model.springs.straight.all():
            yield self._rotary_springs()
        for kind in ("damping", "stop"):
            if len(model.joints.hinges):
                yield self._at_hinges(kind)
        if len(turning := model.drives.giving("torque")):
            yield self._torques(turning)
        if len(pushing := model.drives.giving("force")):
            yield self._forces(pushing)

    def _tendons(self) -> Batch:
        tendons, cords = self.model.tendons, self.cords
        tension = self.run.arrays["tendon_tension"].T[tendons.stretch_tendon]
        fx, fy = tension * cords.x, tension * cords.y
        one, two = tendons.stretch_first, tendons.stretch_first + 1
        moments = []
        for nodes, end in ((one, cords.start), (two, cords.end)):
            moment = end.arm_x * fy - end.arm_y * fx
            for k in np.flatnonzero(tendons.guide_radius[nodes]):
                moment[k] += tendons.guide_radius[nodes[k]] * -tension[k]  # n x u = -1
            moments.append(moment)
        return Batch("tendon", np.tile(tendons.stretch_tendon, 2),
                     np.concatenate([tendons.guide_body[one], tendons.guide_body[two]]),
                     np.concatenate([fx, -fx]), np.concatenate([fy, -fy]),
                     np.concatenate([moments[0], -moments[1]]))

    def _weight(self) -> Batch:
        free = np.flatnonzero(self.model.bodies.free)
        weight = self.run.arrays["body_mass"][free, None] * np.ones(self.frames.samples)
        gx, gy = self.model.mechanism.gravity
        return Batch("gravity", np.zeros(len(free), dtype=np.int64), free, weight * gx,
                     weight * gy, np.zeros_like(weight))

    def _straight_springs(self) -> Batch:
        springs = self.model.springs
        which = np.flatnonzero(springs.straight)
        a, b = springs.bodies[which].T
        one = self.aimed.places(a, springs.anchor[which, 0])
        two = self.aimed.places(b, springs.anchor[which, 1])
        dx, dy = two.x - one.x, two.y - one.y
        length = np.hypot(dx, dy)
        pull = self.run.arrays["spring_force"].T[which] / np.where(length > 0, length, np.inf)
        fx, fy = pull * dx, pull * dy
        return Batch("spring", np.tile(which, 2), np.concatenate([a, b]),
                     np.concatenate([fx, -fx]), np.concatenate([fy, -fy]),
                     np.concatenate([one.arm_x * fy - one.arm_y * fx,
                                     two.arm_y * fx - two.arm_x * fy]))

    def _rotary_springs(self) -> Batch:
        """Without their dampers, which are among those of the hinges."""
        a, springs = self.run.arrays, self.model.springs
        which = np.flatnonzero(~springs.straight)
        joints = springs.joint[which]
        torque = -springs.stiffness[which, None] * (
            a["joint_angle"].T[joints] - springs.rest[which, None])
        for k in np.flatnonzero(springs.drive[which] != NONE):
            damping = springs.damping[which[k]] * a["joint_rate"].T[joints[k]]
            torque[k] = damping - a["spring_force"].T[which[k]]
        return self._couples("spring", which, joints, torque)

    def _at_hinges(self, kind: str) -> Batch:
        joints = self.model.joints.hinges
        torque = self.run.arrays[f"joint_{kind}"].T[joints]
        acts = np.nan_to_num(torque).any(axis=1)
        return self._couples(kind, joints[acts], joints[acts], torque[acts])

    def _torques(self, which: Integers) -> Batch:
        """What drives are set to; of those that the solver limits, what they gave."""
        drives = self.model.drives
        torque = np.stack([
            self.run.arrays["drive_torque" if drives.kind[i].limited else "drive_value"].T[i]
            for i in which])
        return self._couples("drive", which, drives.target[which], torque)

    def _couples(self, kind: str, element: Integers, joints: Integers, torque: Array) -> Batch:
        """Torques [k, n] between the two bodies of hinges, in the hinges' positive sense."""
        torque = np.nan_to_num(torque) * self.model.joints.sense[joints][:, None]
        bodies = self.model.joints.bodies[joints]
        nothing = np.zeros((2 * len(joints), self.frames.samples))
        return Batch(kind, np.tile(element, 2), np.concatenate([bodies[:, 1], bodies[:, 0]]),
                     nothing, nothing, np.concatenate([torque, -torque]))

    def _forces(self, which: Integers) -> Batch:
        drives = self.model.drives
        body, along = drives.target[which], drives.direction[which]
        at = self.aimed.places(body, drives.at[which])
        value = self.run.arrays["drive_value"].T[which]
        turns = drives.turning[which, None]
        c = np.where(turns, self.aimed.cos[body], 1.0)
        s = np.where(turns, self.aimed.sin[body], 0.0)
        fx = value * (c * along[:, :1] - s * along[:, 1:])
        fy = value * (s * along[:, :1] + c * along[:, 1:])
        return Batch("drive", which, body, fx, fy, at.arm_x * fy - at.arm_y * fx)

    # -- contacts -----------------------------------------------------------------------

    @cached_property
    def single(self) -> Flags:
        """Bodies that touch anything in one point only: one shape, which is a circle, [nb]."""
        return np.array([len(b.shapes) == 1 and isinstance(b.shapes[0], Circle)
                         for b in self.model.mechanism.bodies], dtype=bool)

    @cached_property
    def contact_sides(self) -> ContactSides:
        """Both sides of every contact row."""
        a = self.run.arrays
        sample, body, other = a["contact_sample"], a["contact_body"], a["contact_other"]
        one_shape = np.array([len(b.shapes) == 1 for b in self.model.mechanism.bodies], dtype=bool)
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
        count, n = len(self.model.bodies.name), self.frames.samples
        sides = self.contact_sides
        slot = sides.body * n + sides.sample
        columns = (sides.force[:, 0], sides.force[:, 1], sides.moment)
        return np.array([np.bincount(slot, weights=column, minlength=count * n)
                         for column in columns]).astype(float).reshape(3, count, n)

    @cached_property
    def _contact_most(self) -> Array:
        sides = self.contact_sides
        most = np.zeros((2, len(self.model.bodies.name)))
        np.maximum.at(most[0], sides.body, np.hypot(sides.force[:, 0], sides.force[:, 1]))
        np.maximum.at(most[1], sides.body, np.abs(sides.moment))
        return most

    @cached_property
    def spread(self) -> Flags:
        """Bodies and samples whose contacts may have two points: moments unknown, [nb, n]."""
        sides = self.contact_sides
        result = np.zeros((len(self.model.bodies.name), self.frames.samples), dtype=bool)
        result[sides.body[~sides.point], sides.sample[~sides.point]] = True
        return result


def _peak(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
