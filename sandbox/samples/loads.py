"""Every recorded load as a force at a body's centre of mass and a moment about it.

Most elements act along a coordinate q between two bodies: the distance of two points, the angle of
a hinge or the displacement along a groove. A unit effort along it gives the wrenches w_a and w_b on
its bodies, and q' = w_a . v_a + w_b . v_b. This is the NumPy counterpart of
:mod:`sandbox.engine.coordinates`. Rows are loads or bodies, columns samples.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sandbox.model.joints import meeting, rotated
from sandbox.model.model import NONE, Model, held_of
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cables import Frames, Places, piece_tensions

if TYPE_CHECKING:
    from sandbox.samples.samples import Samples


class Batch(NamedTuple):
    """Loads of one kind, or the wrenches of unit efforts."""

    kind: str
    element: Integers  # The element of each row, [k]
    body: Integers  # The body on which each acts, [k]
    wrench: Array
    """Force x, y [N] and moment about the body's centre of mass [N m] in the world, [k, 3, n]."""

    def times(self, effort: Array) -> Batch:
        """The loads of ``effort`` [elements, n] along coordinates."""
        return self._replace(wrench=self.wrench * effort[self.element][:, None])

    def power(self, velocity: Array) -> Array:
        """Power of each row as bodies move with ``velocity`` [3, nb, n]; [k, n] W."""
        v, (x, y, moment) = velocity[:, self.body], np.moveaxis(self.wrench, 1, 0)
        return np.asarray(x * v[0] + y * v[1] + moment * v[2])

    def rates(self, count: int, velocity: Array) -> Array:
        """Power of each of ``count`` elements; of unit efforts the rate of q, [count, n]."""
        found = np.zeros((count, velocity.shape[2]))
        np.add.at(found, self.element, self.power(velocity))
        return found

    def wrenches(self, count: int, bodies: int) -> Array:
        """Wrenches of ``count`` elements in the first sample, [count, bodies, 3]."""
        found = np.zeros((count, bodies, 3))
        np.add.at(found, (self.element, self.body), self.wrench[..., 0])
        return found


class ContactSides(NamedTuple):
    """Both bodies of every contact row: 2 m rows."""

    sample: Integers
    body: Integers
    wrench: Array  # Force x, y [N] and moment about the body's centre of mass [N m], [2 m, 3]
    arm: Array  # From the centre of mass to the place of the force [m], [2 m, 2]


class Loads:
    """The loads of a recording, in batches by kind, and their sums over bodies."""

    def __init__(self, run: Samples) -> None:
        self.run, self.model = run, run.model
        self.frames = Frames(run.model, run.arrays)
        self.actuators: Flags = np.array([kind.line for kind in run.model.joints.kind], dtype=bool)
        """Which joints are actuators, [nj]."""
        mass, inertia = run.arrays["body_mass"], run.arrays["body_inertia"]
        self.weights: Array = np.where(
            run.model.bodies.free[:, None], np.stack([mass, mass, inertia], axis=1), 0.0)
        """Inertia along x, y and about the centre: m, m, I, [nb, 3]; 0 of bodies not free."""
        self.inverse: Array = np.divide(
            1, self.weights, out=np.zeros_like(self.weights), where=self.weights > 0)
        """1 / m, 1 / m, 1 / I, [nb, 3]; 0 of bodies not free."""

    @cached_property
    def largest(self) -> Array:
        """Largest force [N] and moment [N m] on every body, inertia included, [2, nb]."""
        sides, most = self.contact_sides, np.zeros((2, len(self.model.bodies.name)))
        inertial = self.weights[..., None] * self.frames.acceleration.swapaxes(0, 1)
        loads = [(batch.body, batch.wrench) for batch in (*self.batches, self.joints)]
        for body, wrench in (*loads, (sides.body, sides.wrench[..., None]),
                             (np.arange(len(inertial)), inertial)):
            np.fmax.at(most[0], body, np.hypot(wrench[:, 0], wrench[:, 1]).max(axis=1, initial=0.0))
            np.fmax.at(most[1], body, np.abs(wrench[:, 2]).max(axis=1, initial=0.0))
        return most

    @cached_property
    def others(self) -> Array:
        """Sum of all loads but those of contacts and joints: force x, y and moment, [3, nb, n]."""
        return self.sum_of(self.batches)

    def sum_of(self, batches: Iterable[Batch]) -> Array:
        """Sum of loads on every body: force x, y [N] and moment [N m], [3, nb, n]."""
        total = np.zeros_like(self.frames.centre)
        for batch in batches:
            np.add.at(total.swapaxes(0, 1), batch.body, batch.wrench)
        return total

    @cached_property
    def left(self) -> Array:
        """All loads less m a, and moments less I alpha, [3, nb, n]; 0 of bodies not free."""
        left, sides = self.others + self.sum_of([self.joints]), self.contact_sides
        for axis, push in zip(left, sides.wrench.T, strict=True):
            np.add.at(axis, (sides.body, sides.sample), push)
        left -= self.weights.T[:, :, None] * self.frames.acceleration
        left[:, ~self.model.bodies.free] = 0.0
        return left

    @cached_property
    def batches(self) -> list[Batch]:
        """All loads but those of contacts and joints."""
        return list(self._batches())

    def _batches(self) -> Iterator[Batch]:
        model, a = self.model, self.run.arrays
        joints, springs = model.joints, model.springs
        if model.tendons.name:
            pulls = -np.tile(piece_tensions(model, a), (2, 1))[:, None]
            yield self.cable_efforts._replace(wrench=self.cable_efforts.wrench * pulls)
        if model.lines.name:
            yield self.line_efforts.times(a["line_pressure"].T)
        if any(model.mechanism.gravity):
            free = np.flatnonzero(model.bodies.free)
            weight = a["body_mass"][free, None] * np.ones(self.frames.samples)
            gx, gy = model.mechanism.gravity
            yield Batch("gravity", np.zeros(len(free), dtype=np.int64), free,
                        np.stack([weight * gx, weight * gy, np.zeros_like(weight)], axis=1))
        if springs.name:
            yield self.spring_efforts.times(-self.spring_forces)
        for kind in ("damping", "stop"):
            torque = np.nan_to_num(a[f"joint_{kind}"].T)
            acts = joints.hinges[torque[joints.hinges].any(axis=1)]
            if len(acts):
                yield self._along(kind, acts, joints.bodies[acts], joints.anchor[acts],
                                  acts).times(torque)
        if len(joints.frictional):
            yield self.friction_efforts.times(np.nan_to_num(a["joint_friction"].T))
        if model.loads.name:
            wrench = np.concatenate([a["load_force"], a["load_torque"][..., None]], axis=2)
            yield Batch("load", np.arange(len(model.loads.name)), model.loads.body,
                        wrench.transpose(1, 2, 0))
        if len(model.drives.giving("torque", "push")):
            yield self.drive_efforts.times(np.nan_to_num(self.given))
        if len(pushing := model.drives.giving("force")):
            drives, body = model.drives, model.drives.target[pushing]
            at = self.frames.places(body, drives.at[pushing])
            turned = np.where(drives.turning[pushing, None], self.frames.pose[2, body], 0.0)
            fx, fy = a["drive_value"].T[pushing] * np.moveaxis(
                rotated(drives.direction[pushing, None], turned), -1, 0)
            yield Batch("force", pushing, body, np.stack(
                [fx, fy, at.arm_x * fy - at.arm_y * fx], axis=1))

    def _pair(
        self, kind: str, element: Integers, bodies: Integers, x: Array, y: Array,
        at: Sequence[Places], couple: Array | float,
    ) -> Batch:
        """A force x, y [k, n] and a couple on bodies ``b``, and the opposite ones on bodies ``a``.

        ``bodies`` are ``a`` and ``b``, [k, 2], with the places ``at`` which the force acts.
        """
        on_a, on_b = (np.stack([x, y, end.arm_x * y - end.arm_y * x + couple], axis=1)
                      for end in at)
        return Batch(kind, np.tile(element, 2), np.concatenate([bodies[:, 1], bodies[:, 0]]),
                     np.concatenate([on_b, -on_a]))

    def _along(
        self, kind: str, element: Integers, bodies: Integers, anchor: Array, joint: Integers,
        gain: Array | float = 1.0,
    ) -> Batch:
        """Unit efforts along distances [k], or about hinges where ``joint`` [k] has one."""
        one, two = (self.frames.places(bodies[:, k], np.nan_to_num(anchor[:, k])) for k in (0, 1))
        dx, dy = two.x - one.x, two.y - one.y
        turns, length = joint[:, None] >= 0, np.hypot(dx, dy)
        length = np.where(turns | (length == 0), np.inf, length)
        couple = np.zeros_like(turns, dtype=float)
        if turns.any():
            couple = np.where(turns, gain * self.model.joints.sense[joint][:, None], 0.0)
        return self._pair(
            kind, element, bodies, gain * dx / length, gain * dy / length, (one, two), couple)

    @cached_property
    def spring_efforts(self) -> Batch:
        """Efforts of 1 N along straight springs and 1 N m about the hinges of rotary ones."""
        springs = self.model.springs
        return self._along("spring", np.arange(len(springs.name)), springs.bodies, springs.anchor,
                           springs.joint)

    @cached_property
    def spring_forces(self) -> Array:
        """Of straight springs, and of rotary ones without the hinge's damper, [ns, n]."""
        a, springs = self.run.arrays, self.model.springs
        force, rotary = a["spring_force"].T.copy(), np.flatnonzero(~springs.straight)
        joints = springs.joint[rotary]
        holds = held_of(self.model.bonds.joint[joints], a["held"])
        rates = np.nan_to_num(a["joint_rate"].T[joints])
        force[rotary] -= holds * springs.damping[rotary, None] * rates
        return np.asarray(force)

    @cached_property
    def line_efforts(self) -> Batch:
        """The effect of 1 Pa in every line, chamber by chamber."""
        lines = self.model.lines
        return self._along("line", lines.of, lines.bodies, lines.anchor, lines.joint,
                           lines.gain[:, None])

    @cached_property
    def joint_efforts(self) -> Batch:
        """Efforts of 1 N m about every hinge, and 1 N along every actuator."""
        joints = self.model.joints
        which = np.flatnonzero(joints.angle | self.actuators)
        return self._along("joint", which, joints.bodies[which], joints.anchor[which],
                           np.where(self.actuators, NONE, np.arange(len(joints.name)))[which])

    @cached_property
    def drive_efforts(self) -> Batch:
        """Unit efforts of drives of hinges and actuators."""
        drives, joints = self.model.drives, self.model.joints
        which = drives.giving("torque", "push")
        on = drives.target[which]
        return self._along("drive", which, joints.bodies[on], joints.anchor[on],
                           np.where([drives.kind[i].gives == "push" for i in which], NONE, on))

    @cached_property
    def friction_efforts(self) -> Batch:
        """Efforts of 1 N m about every pin with dry friction, and 1 N along every such slot."""
        joints, which = self.model.joints, self.model.joints.frictional
        slots = np.array([joints.kind[j].keeps == "groove" for j in which], dtype=bool)
        x, y, couple = np.zeros((3, len(which), self.frames.samples))
        couple[~slots] = joints.sense[which[~slots], None]
        for k in np.flatnonzero(slots):
            place = self.frames.place_in_slot(int(which[k]))
            x[k], y[k] = place.x, place.y
        at = [Places(*(part[which] for part in end)) for end in self._joint_places]
        return self._pair("friction", which, joints.bodies[which], x, y, at, couple)

    @cached_property
    def _joint_places(self) -> list[Places]:
        """Anchors of joints on ``a`` and ``b`` with the arms of their forces, [nj, n]."""
        joints, (_, pin) = self.model.joints, self.frames.anchors
        found = [Places(*(part.copy() for part in end)) for end in self.frames.anchors]
        # a groove is held where the pin is
        meet = [(j, 0, pin.x[j], pin.y[j]) for j in joints.keeping("groove").tolist()] + [
            (j, side, *meeting(self.model, j, self.run.arrays["body_pose"]))
            for j in np.flatnonzero([kind.wheels for kind in joints.kind]).tolist()
            for side in (0, 1)]
        for j, side, x, y in meet:
            found[side].arm_x[j], found[side].arm_y[j] = (
                np.stack([x, y]) - self.frames.centre[:2, joints.bodies[j, side]])
        return found

    @cached_property
    def joints(self) -> Batch:
        """Loads of joints on their bodies ``b``, then on ``a``; nan in old recordings."""
        fx, fy = (np.ascontiguousarray(part) for part in self.run.arrays["joint_force"].T)
        joints = self.model.joints
        found = self._pair("joint", np.arange(len(joints.name)), joints.bodies, fx, fy,
                           self._joint_places, self.run.arrays["joint_couple"].T)
        twist_a, twist_b = np.nan_to_num(self.run.arrays["joint_twist"]).T
        found.wrench[:, 2] += np.concatenate([twist_b, twist_a])
        return found

    @cached_property
    def cable_efforts(self) -> Batch:
        """Those of :func:`cable_efforts`."""
        return cable_efforts(self.frames)

    @cached_property
    def given(self) -> Array:
        """Values of drives, solved efforts of those with a limit, 0 while released, [nd, n]."""
        drives, a = self.model.drives, self.run.arrays
        limited = np.array([kind.limited for kind in drives.kind], dtype=bool)
        given = np.where(limited, a["drive_torque"], a["drive_value"]).T
        joined = drives.giving("torque", "push")
        joined = joined[~limited[joined]]
        given[joined] *= held_of(self.model.bonds.joint[drives.target[joined]], a["held"])
        return np.asarray(given)

    @cached_property
    def limits(self) -> Array:
        """Largest effort of drives with a limit, of a brake its value [N m, N], [nd, n]."""
        most = self.model.drives.most[:, None]
        return np.where(np.isnan(most), self.run.arrays["drive_value"].T, most)

    @cached_property
    def contact_sides(self) -> ContactSides:
        """Both sides of every contact row."""
        a = self.run.arrays
        sample, sides = a["contact_sample"], []
        for sign, on, twist in ((1.0, a["contact_body"], 0.0),
                                (-1.0, a["contact_other"], np.nan_to_num(a["contact_twist"]))):
            arm = a["contact_point"] - self.frames.centre[:2, on, sample].T
            x, y = sign * a["contact_force"].T
            moment = arm[:, 0] * y - arm[:, 1] * x + twist
            sides.append((on, np.stack([x, y, moment], axis=1), arm))
        body, wrench, arm = (np.concatenate(part) for part in zip(*sides, strict=True))
        return ContactSides(np.tile(sample, 2), body, wrench, arm)


def cable_efforts(frames: Frames) -> Batch:
    """The effect of -1 N in every straight piece of a tendon: efforts along its length."""
    tendons, cables = frames.model.tendons, frames.cables
    one, two = tendons.stretch_first, tendons.stretch_first + 1
    # n x u = -1
    starts, ends = (np.stack([cables.x, cables.y, end.arm_x * cables.y - end.arm_y * cables.x
                              - tendons.guide_radius[nodes, None]], axis=1)
                    for nodes, end in ((one, cables.start), (two, cables.end)))
    return Batch("tendon", np.tile(tendons.stretch_tendon, 2),
                 tendons.guide_body[np.concatenate([one, two])], np.concatenate([-starts, ends]))


def pulls_at_start(model: Model) -> Array:
    """Wrenches about the centres of mass of 1 N in every tendon at t = 0, [nt, nb, 3]."""
    efforts = cable_efforts(Frames.at_start(model))
    return -efforts.wrenches(len(model.tendons.name), len(model.bodies.name))
