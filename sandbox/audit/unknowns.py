"""The forces of one sample that only balance tells, each as what it does to its bodies.

A joint carries what it must, either way; what touches pushes and rubs within its cone; stops,
ends of grooves and ropes push back where they are reached; cords as good as rigid pull if they are
taut, with one tension along all their path; motors and brakes give what they may. All else (weight,
springs, softer cords, pulled ones, dampers, forces and torques that drives set) is known, and held
to its own law by other figures.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from sandbox.audit.contacts import CONE
from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, STOPPED
from sandbox.audit.friction import carried
from sandbox.audit.touching import pressed
from sandbox.elements.tendons import RIGID
from sandbox.model.joints import flank_of, slot_length
from sandbox.model.model import NONE
from sandbox.model.pairs import static_friction_of
from sandbox.model.supports import about_centre, joint_rows
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Flags
from sandbox.samples.loads import Batch


@dataclass
class Unknown:
    """One force or couple of unknown size: what its unit does to bodies."""

    does: dict[int, Array]
    """Force x, y and moment about the centre of mass, by body, [3]."""
    free: bool = False
    """Whether it may have either sign."""
    most: float = np.inf
    """The most that it may be, either way [N, N m]."""
    contact: int = NONE
    """The contact row that it is part of."""
    normal: float = 0.0
    """What its unit is of that row's normal force, and of its tangential one."""
    tangential: float = 0.0
    below: float = 0.0
    """So far below 0 [N] rounding may have left what is recorded."""


class Unknowns:
    """What is unknown, and what is known, of a sample that stands alone."""

    def __init__(self, evidence: Evidence) -> None:
        self.evidence, self.model, self.loads = evidence, evidence.model, evidence.loads
        self.arrays = evidence.run.arrays
        self.centre = np.stack([self.loads.frames.centre_x[:, 0],
                                self.loads.frames.centre_y[:, 0]], axis=1)

    @cached_property
    def all(self) -> list[Unknown]:
        """All unknown forces that act on a body that moves freely."""
        free = self.model.bodies.free
        found = [*self._joints(), *self._ends(), *self._stops(), *self._cords(), *self._motors(),
                 *self._rubs(), *self._contacts()]
        for one in found:
            one.does = {body: wrench for body, wrench in one.does.items() if free[body]}
        return [one for one in found if one.does]

    @cached_property
    def target(self) -> Array:
        """What the unknown forces have to come to: m a, I alpha less all known loads, [nb, 3]."""
        a, free = self.arrays, self.model.bodies.free
        mass = np.stack([a["body_mass"], a["body_mass"], a["body_inertia"]], axis=1)
        total = np.where(free[:, None], mass, 0.0) * a["body_acceleration"][0]
        for batch in self.loads.batches:
            known = self._known(batch)
            wrench = np.stack([batch.x[known, 0], batch.y[known, 0], batch.moment[known, 0]], 1)
            np.subtract.at(total, batch.body[known], wrench)
        return np.asarray(total)

    def _known(self, batch: Batch) -> Flags:
        known = np.full(len(batch.body), batch.kind != "stop")
        if batch.kind == "tendon":
            known &= np.logical_not(self.rigid[batch.element])
        if batch.kind == "drive":
            known &= np.array([not self.model.drives.kind[i].limited
                               or not np.isnan(self.model.drives.slope[i])
                               for i in batch.element])
        if batch.kind == "friction":  # what slips is at its bound
            known &= self.arrays["joint_sticks"][0, batch.element] == 0.0
        return known

    @cached_property
    def rigid(self) -> Flags:
        """Cords, not pulled by a drive, too stiff for their stretch to tell their tension, [nt].

        Of one that guides hold by friction tensions hang on what was before: they are known.
        """
        tendons = self.model.tendons
        held = [len(tendons.gripped(cord)) > 0 for cord in range(len(tendons.name))]
        return np.asarray((tendons.drive == NONE) & (tendons.stiffness >= RIGID)
                          & ~np.array(held, dtype=bool))

    def _joints(self) -> Iterator[Unknown]:
        pose = self.arrays["body_pose"][0]
        for joint in np.flatnonzero(held_of(self.model.ties.joint, self.arrays["held"])[:, 0]):
            for row in joint_rows(self.model, pose, int(joint), flank=self._pushing(int(joint))):
                yield Unknown({body: about_centre(self.model, pose, body, wrench)
                               for body, wrench in row}, free=True)

    def _pushing(self, joint: int) -> int:
        """The flank of its teeth that pushed; 0 if it has none, or they did not."""
        force, pose = self.arrays["joint_force"][0, joint], self.arrays["body_pose"][0]
        if not self.model.joints.kind[joint].teeth or not force.any():
            return 0
        pushes = [flank_of(self.model, joint, pose, side) for side in (1, -1)]
        one, other = (float(push.x * force[0] + push.y * force[1]) for push in pushes)
        return 1 if one >= other else -1

    def _pair(self, one: int, two: int, at: Array, force: Array, couple: float = 0.0) -> dict[
            int, Array]:
        """A force at a place of the world, and a couple, on ``one`` by ``two``."""
        does = {}
        for sign, body in ((1.0, one), (-1.0, two)):
            arm = at - self.centre[body]
            does[body] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0] + couple])
        return does

    def _ends(self) -> Iterator[Unknown]:
        """Ropes that are taut, telescopes pushed together, points at the end of their groove."""
        joints, frames, h = self.model.joints, self.loads.frames, self.evidence.h
        speed = np.abs(self.evidence.velocity[:2, :, 0]).sum(axis=0)
        spin = np.abs(self.evidence.velocity[2, :, 0])
        for j in joints.keeping("range", "groove").tolist():
            a, b = joints.bodies[j].tolist()
            on_a, on_b = (np.array([end.x[j, 0], end.y[j, 0]]) for end in frames.anchors)
            if joints.kind[j].keeps == "groove":
                place = self.loads.place_in_slot(j)
                high, length = slot_length(self.model, j), float(place.along[0])
                low, way = -math.inf if math.isinf(high) else 0.0, np.array(
                    [place.x[0], place.y[0]])
            else:
                low, high = joints.reach[j].tolist()
                length = float(np.hypot(*(on_b - on_a)))
                way = (on_b - on_a) / max(length, ROUNDING)
            moves = sum(speed[body] + spin[body] * float(np.hypot(*(on_b - self.centre[body])))
                        for body in (a, b))
            near = STOPPED + 2 * h * moves
            for reached, sign in ((length <= low + near, 1.0), (length >= high - near, -1.0)):
                if reached:
                    yield Unknown(self._pair(b, a, on_b, sign * way))

    def _stops(self) -> Iterator[Unknown]:
        joints, evidence = self.model.joints, self.evidence
        for j in joints.stopped.tolist():
            rate = abs(float(evidence.rates[j, 0])) + abs(float(evidence.rates_after[j, 0]))
            near, angle = STOPPED + evidence.h * rate, float(evidence.angles[j, 0])
            low, high = joints.stops[j].tolist()
            for reached, sign in ((angle <= low + near, 1.0), (angle >= high - near, -1.0)):
                if reached:
                    yield Unknown(self._couple(j, sign))

    def _couple(self, joint: int, size: float) -> dict[int, Array]:
        """A torque in a hinge's positive sense."""
        a, b = self.model.joints.bodies[joint].tolist()
        turn = np.array([0.0, 0.0, size * float(self.model.joints.sense[joint])])
        return {b: turn, a: -turn}

    def _cords(self) -> Iterator[Unknown]:
        if not self.rigid.any():
            return
        pulls, a = self.loads.cord_pulls, self.arrays
        rates = self.loads.lengthening(pulls, len(self.rigid), self.evidence.velocity)
        for cord in np.flatnonzero(self.rigid).tolist():
            stretch = float(a["tendon_length"][0, cord] - a["tendon_rest"][cord])
            if stretch + 2 * self.evidence.h * abs(float(rates[cord, 0])) < -ROUNDING:
                continue
            does: dict[int, Array] = {}
            for k in np.flatnonzero(pulls.element == cord).tolist():
                body = int(pulls.body[k])
                wrench = np.array([pulls.x[k, 0], pulls.y[k, 0], pulls.moment[k, 0]])
                does[body] = does.get(body, np.zeros(3)) + wrench
            yield Unknown(does)

    def _motors(self) -> Iterator[Unknown]:
        drives = self.model.drives
        for i, kind in enumerate(drives.kind):
            if kind.limited and np.isnan(drives.slope[i]):
                most = float(drives.most[i])
                if np.isnan(most):  # a brake may give what it is set to
                    most = float(self.arrays["drive_value"][0, i])
                yield Unknown(self._driven(i), free=True, most=most)

    def _driven(self, drive: int) -> dict[int, Array]:
        """What a unit of a drive does: a torque in a hinge, a push of an actuator."""
        drives, j = self.model.drives, int(self.model.drives.target[drive])
        if drives.kind[drive].gives != "push":
            return self._couple(j, 1.0)
        a, b = self.model.joints.bodies[j].tolist()
        on_a, on_b = (np.array([end.x[j, 0], end.y[j, 0]]) for end in self.loads.frames.anchors)
        way = on_b - on_a
        return self._pair(b, a, on_b, way / max(float(np.hypot(*way)), ROUNDING))

    def _rubs(self) -> Iterator[Unknown]:
        """Friction of joints that hold, up to what it could hold with under what they carry."""
        joints, pushes = self.model.joints, self.loads.rub_pushes
        for j in joints.rubbed.tolist():
            if self.arrays["joint_sticks"][0, j] != 1.0:
                continue
            does = {int(pushes.body[k]): np.array([pushes.x[k, 0], pushes.y[k, 0],
                                                   pushes.moment[k, 0]])
                    for k in np.flatnonzero(pushes.element == j).tolist()}
            most = joints.friction[j] + joints.rubbing[j] * float(carried(self.evidence, j)[0])
            yield Unknown(does, free=True, most=float(joints.static[j] * most))

    def _contacts(self) -> Iterator[Unknown]:
        a = self.arrays
        for row, normal in enumerate(self.evidence.run.contacts.normal.tolist()):
            pair = int(a["contact_body"][row]), int(a["contact_other"][row])
            u = a["contact_normal"][row]
            left = np.array([-u[1], u[0]])
            places = pressed(self.evidence, row)
            if places is None:  # several normals: what they come to may be anything
                at = a["contact_point"][row]
                for n, t in ((1.0, 0.0), (0.0, 1.0)):
                    yield Unknown(self._pair(*pair, at, n * u + t * left), free=True, contact=row,
                                  normal=n, tangential=t)
                yield Unknown(self._pair(*pair, at, 0 * u, 1.0), free=True, contact=row)
                continue
            mu = static_friction_of(self.model.mechanism, *pair)
            for at in places:
                for t in (mu, -mu) if mu else (0.0,):
                    yield Unknown(self._pair(*pair, at, u + t * left), contact=row, normal=1.0,
                                  tangential=t, below=CONE * abs(normal))
