"""Every recorded load as a force at a body's centre of mass and a moment about it.

Tendons, lines of fluid, springs, dampers, stops, drives, contacts, weight, and apart from
these what joints carry. Rows are loads or bodies, columns samples.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import Place, meeting, place_in_slot
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Integers
from sandbox.samples.cords import Stretches, piece_tensions, stretches
from sandbox.samples.frames import Frames
from sandbox.samples.outcome import Stored


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
    """About its centre of mass [N m]."""
    at: Array
    """Where the force acts, in the world [m], [2 m, 2]."""


class Loads:
    """The loads of a recording, one batch a kind; sums over bodies when asked for."""

    def __init__(self, run: Stored) -> None:
        self.run, self.model = run, run.model
        self.frames = Frames(run)

    @cached_property
    def cords(self) -> Stretches:
        """The straight pieces of all tendons."""
        return stretches(self.frames)

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

        What joints carry and the inertial forces m a and I alpha count, too.
        """
        most = self._contact_most
        mass = self.run.arrays["body_mass"], self.run.arrays["body_inertia"]
        a = self.frames.acceleration
        for body in np.flatnonzero(self.model.bodies.free):
            most[0, body] = max(most[0, body], mass[0][body] * _peak(np.hypot(a[0, body],
                                                                              a[1, body])))
            most[1, body] = max(most[1, body], mass[1][body] * _peak(a[2, body]))
        for batch in (*self.batches, self.joints):
            force = np.sqrt((batch.x**2 + batch.y**2).max(axis=1, initial=0.0))
            moment = np.abs(batch.moment).max(axis=1, initial=0.0)
            np.fmax.at(most[0], batch.body, force)
            np.fmax.at(most[1], batch.body, moment)
        return most

    @cached_property
    def joints(self) -> Batch:
        """What joints do to their bodies ``b``, and then to ``a``; nan where it was not kept."""
        a, b = self.model.joints.bodies.T
        fx, fy = (np.ascontiguousarray(part) for part in self.run.arrays["joint_force"].T)
        couple = self.run.arrays["joint_couple"].T
        twist_a, twist_b = np.nan_to_num(self.run.arrays["joint_twist"]).T
        on_a, on_b = self.frames.anchors
        (ax, ay), (bx, by) = ((end.arm_x.copy(), end.arm_y.copy()) for end in (on_a, on_b))
        for j in self.model.joints.keeping("groove"):  # a groove is held where the pin is
            ax[j] = on_b.x[j] - self.frames.centre_x[a[j]]
            ay[j] = on_b.y[j] - self.frames.centre_y[a[j]]
        for j in np.flatnonzero([kind.wheels for kind in self.model.joints.kind]):
            x, y = meeting(self.model, int(j), self.run.arrays["body_pose"])
            ax[j], ay[j] = x - self.frames.centre_x[a[j]], y - self.frames.centre_y[a[j]]
            bx[j], by[j] = x - self.frames.centre_x[b[j]], y - self.frames.centre_y[b[j]]
        return Batch("joint", np.tile(np.arange(len(a)), 2), np.concatenate([b, a]),
                     np.concatenate([fx, -fx]), np.concatenate([fy, -fy]),
                     np.concatenate([bx * fy - by * fx + couple + twist_b,
                                     ay * fx - ax * fy - couple + twist_a]))

    @cached_property
    def weights(self) -> Array:
        """What accelerations along x, y and about the centre take: m, m, I, [nb, 3].

        0 of what does not move freely.
        """
        mass, inertia = self.run.arrays["body_mass"], self.run.arrays["body_inertia"]
        return np.where(self.model.bodies.free[:, None],
                        np.stack([mass, mass, inertia], axis=1), 0.0)

    @cached_property
    def left(self) -> Array:
        """All loads, those of joints included, less m a; and moments, less I alpha, [3, nb, n].

        0 of what does not move freely.
        """
        left, free = self.totals.copy(), self.model.bodies.free
        joints = self.joints
        for k, body in enumerate(joints.body):
            left[0, body] += joints.x[k]
            left[1, body] += joints.y[k]
            left[2, body] += joints.moment[k]
        left -= self.weights.T[:, :, None] * self.frames.acceleration
        left[:, ~free] = 0.0
        return left

    def _batches(self) -> Iterator[Batch]:
        model = self.model
        if model.tendons.name:
            yield self.cord_loads
        if model.lines.name:
            yield self._times(self.line_pushes, self.run.arrays["line_pressure"].T)
        if any(model.mechanism.gravity):
            yield self._weight()
        if model.springs.straight.any():
            yield self._times(self.spring_pulls, self.run.arrays["spring_force"].T)
        if not model.springs.straight.all():
            yield self._rotary_springs()
        for kind in ("damping", "stop"):
            if len(model.joints.hinges):
                yield self._at_hinges(kind)
        if len(model.joints.rubbed):
            yield self._times(self.rub_pushes, np.nan_to_num(self.run.arrays["joint_friction"].T))
        if model.loads.name:
            a = self.run.arrays
            yield Batch("load", np.arange(len(model.loads.name)), model.loads.body,
                        a["load_force"][:, :, 0].T, a["load_force"][:, :, 1].T,
                        a["load_torque"].T)
        if len(turning := model.drives.giving("torque")):
            yield self._torques(turning)
        if len(pushing := model.drives.giving("force")):
            yield self._forces(pushing)
        if len(model.drives.giving("push")):
            yield self._times(self.actuator_pushes, self.given)

    @cached_property
    def cord_pulls(self) -> Batch:
        """What 1 N in every tendon would do, stretch by stretch and at either end."""
        tendons, cords = self.model.tendons, self.cords
        one, two = tendons.stretch_first, tendons.stretch_first + 1
        moments = []
        for nodes, end in ((one, cords.start), (two, cords.end)):
            moment = end.arm_x * cords.y - end.arm_y * cords.x
            moment -= tendons.guide_radius[nodes, None]  # n x u = -1
            moments.append(moment)
        return Batch("tendon", np.tile(tendons.stretch_tendon, 2),
                     np.concatenate([tendons.guide_body[one], tendons.guide_body[two]]),
                     np.concatenate([cords.x, -cords.x]), np.concatenate([cords.y, -cords.y]),
                     np.concatenate([moments[0], -moments[1]]))

    @cached_property
    def cord_loads(self) -> Batch:
        """What every tendon does, piece by piece, at either end."""
        pulls, own = self.cord_pulls, np.tile(
            piece_tensions(self.model, self.run.arrays), (2, 1))
        return pulls._replace(x=pulls.x * own, y=pulls.y * own, moment=pulls.moment * own)

    @cached_property
    def line_pushes(self) -> Batch:
        """What 1 Pa in every line would do, chamber by chamber, to their two bodies."""
        lines, joints = self.model.lines, self.model.joints
        a, b = lines.bodies.T
        one, two = (self.frames.places(lines.bodies[:, k], np.nan_to_num(lines.anchor[:, k]))
                    for k in (0, 1))
        turns = lines.joint[:, None] >= 0
        dx, dy = two.x - one.x, two.y - one.y
        length = np.where(turns, np.inf, np.hypot(dx, dy))
        gain = lines.gain[:, None] / np.where(length > 0, length, np.inf)
        x, y = gain * dx, gain * dy
        couple = np.where(turns, lines.gain[:, None] * joints.sense[lines.joint][:, None]
                          if len(joints.name) else 0.0, 0.0)
        return Batch("line", np.tile(lines.of, 2), np.concatenate([a, b]),
                     np.concatenate([-x, x]), np.concatenate([-y, y]),
                     np.concatenate([one.arm_y * x - one.arm_x * y - couple,
                                     two.arm_x * y - two.arm_y * x + couple]))

    @cached_property
    def spring_pulls(self) -> Batch:
        """What 1 N in every straight spring would do to its two bodies."""
        springs = self.model.springs
        which = np.flatnonzero(springs.straight)
        return self._along("spring", which, springs.bodies[which], springs.anchor[which])

    @cached_property
    def actuator_pushes(self) -> Batch:
        """What 1 N of every drive of an actuator would do to its two bodies; it pushes."""
        which, joints = self.model.drives.giving("push"), self.model.joints
        on = self.model.drives.target[which]
        pulls = self._along("drive", which, joints.bodies[on], joints.anchor[on])
        return pulls._replace(x=-pulls.x, y=-pulls.y, moment=-pulls.moment)

    @cached_property
    def given(self) -> Array:
        """What drives give [N m, N]: what they are set to, or what the solver found, [nd, n].

        Of joints that are let go those that are set to it give nothing.
        """
        drives, a = self.model.drives, self.run.arrays
        limited = np.array([kind.limited for kind in drives.kind], dtype=bool)
        given = np.where(limited, a["drive_torque"], a["drive_value"]).T
        joined = drives.giving("torque", "push")
        joined = joined[~limited[joined]]
        given[joined] *= held_of(self.model.ties.joint[drives.target[joined]], a["held"])
        return np.asarray(given)

    def _along(self, kind: str, element: Integers, bodies: Integers, anchor: Array) -> Batch:
        """Pulls of 1 N between two points each, of bodies [k, 2] and in their frames [k, 2, 2]."""
        a, b = bodies.T
        one, two = self.frames.places(a, anchor[:, 0]), self.frames.places(b, anchor[:, 1])
        dx, dy = two.x - one.x, two.y - one.y
        length = np.hypot(dx, dy)
        x, y = (part / np.where(length > 0, length, np.inf) for part in (dx, dy))
        return Batch(kind, np.tile(element, 2), np.concatenate([a, b]),
                     np.concatenate([x, -x]), np.concatenate([y, -y]),
                     np.concatenate([one.arm_x * y - one.arm_y * x,
                                     two.arm_y * x - two.arm_x * y]))

    @cached_property
    def rub_pushes(self) -> Batch:
        """What dry friction of 1 N m of every pin that has it does, and 1 N of every slot."""
        joints, frames = self.model.joints, self.frames
        a, b = joints.bodies[joints.rubbed].T
        x, y, on_a, on_b = np.zeros((4, len(a), frames.samples))
        for k, j in enumerate(joints.rubbed.tolist()):
            if joints.kind[j].keeps != "groove":
                on_a[k], on_b[k] = -joints.sense[j], joints.sense[j]
                continue
            x[k], y[k] = self.groove_direction(j)
            at = frames.anchors[1]
            on_b[k] = at.arm_x[j] * y[k] - at.arm_y[j] * x[k]
            on_a[k] = ((at.y[j] - frames.centre_y[a[k]]) * x[k]
                       - (at.x[j] - frames.centre_x[a[k]]) * y[k])
        return Batch("friction", np.tile(joints.rubbed, 2), np.concatenate([b, a]),
                     np.concatenate([x, -x]), np.concatenate([y, -y]),
                     np.concatenate([on_b, on_a]))

    def groove_direction(self, joint: int) -> tuple[Array, Array]:
        """Direction of a slot from its start to its end, in the world, x and y, [n] each."""
        place = self.place_in_slot(joint)
        return place.x, place.y

    def place_in_slot(self, joint: int) -> Place:
        """Where the point of a slot is along and across it, [n] each."""
        arrays = self.run.arrays
        return place_in_slot(self.model, joint, arrays["body_pose"],
                             arrays["joint_length"][:, joint])

    def lengthening(self, pulls: Batch, count: int, velocity: Array) -> Array:
        """Rates [m/s] at which what pulls grows longer as bodies move with ``velocity`` [3, nb, n].

        ``pulls`` are those of 1 N; the rates are those of its ``count`` elements, [count, n].
        """
        rate = np.zeros((count, self.frames.samples))
        v = velocity[:, pulls.body]
        np.subtract.at(rate, pulls.element, pulls.x * v[0] + pulls.y * v[1] + pulls.moment * v[2])
        return rate

    @staticmethod
    def _times(pulls: Batch, force: Array) -> Batch:
        """Pulls of 1 N, each as strong as its element's ``force`` [elements, n] is."""
        own = force[pulls.element]
        return pulls._replace(x=pulls.x * own, y=pulls.y * own, moment=pulls.moment * own)

    def _weight(self) -> Batch:
        free = np.flatnonzero(self.model.bodies.free)
        weight = self.run.arrays["body_mass"][free, None] * np.ones(self.frames.samples)
        gx, gy = self.model.mechanism.gravity
        return Batch("gravity", np.zeros(len(free), dtype=np.int64), free, weight * gx,
                     weight * gy, np.zeros_like(weight))

    def _rotary_springs(self) -> Batch:
        """Without their dampers, which are among those of the hinges."""
        a, springs = self.run.arrays, self.model.springs
        which = np.flatnonzero(~springs.straight)
        joints = springs.joint[which]
        damping = springs.damping[which, None] * a["joint_rate"].T[joints]
        torque = damping - a["spring_force"].T[which]
        return self._couples("spring", which, joints, torque)

    def _at_hinges(self, kind: str) -> Batch:
        joints = self.model.joints.hinges
        torque = self.run.arrays[f"joint_{kind}"].T[joints]
        acts = np.nan_to_num(torque).any(axis=1)
        return self._couples(kind, joints[acts], joints[acts], torque[acts])

    def _torques(self, which: Integers) -> Batch:
        """What drives are set to; of those that the solver limits, what they gave."""
        joints = self.model.drives.target[which]
        return self._couples("drive", which, joints, self.given[which])

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
        at = self.frames.places(body, drives.at[which])
        value = self.run.arrays["drive_value"].T[which]
        turns = drives.turning[which, None]
        c = np.where(turns, self.frames.cos[body], 1.0)
        s = np.where(turns, self.frames.sin[body], 0.0)
        fx = value * (c * along[:, :1] - s * along[:, 1:])
        fy = value * (s * along[:, :1] + c * along[:, 1:])
        return Batch("drive", which, body, fx, fy, at.arm_x * fy - at.arm_y * fx)

    # -- contacts -----------------------------------------------------------------------

    @cached_property
    def contact_sides(self) -> ContactSides:
        """Both sides of every contact row."""
        a = self.run.arrays
        sample, body, other = a["contact_sample"], a["contact_body"], a["contact_other"]
        at, sides = a["contact_point"], []
        for sign, on, twist in ((1.0, body, 0.0), (-1.0, other, np.nan_to_num(a["contact_twist"]))):
            arm_x = at[:, 0] - self.frames.centre_x[on, sample]
            arm_y = at[:, 1] - self.frames.centre_y[on, sample]
            force = sign * a["contact_force"]
            sides.append((on, force, arm_x * force[:, 1] - arm_y * force[:, 0] + twist))
        return ContactSides(
            np.tile(sample, 2), np.concatenate([s[0] for s in sides]),
            np.concatenate([s[1] for s in sides]), np.concatenate([s[2] for s in sides]),
            np.tile(at, (2, 1)))

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


def _peak(values: Array) -> float:
    return float(np.abs(values).max(initial=0.0))
