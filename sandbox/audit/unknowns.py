"""The forces of one sample that only balance determines, as wrenches on their bodies.

Joints carry any load; contacts push within their friction cones; stops, ends of grooves and ropes
push back where they are reached; rigid tendons pull if they are taut, with one tension along their
path; motors and brakes act up to their limits. All others (weight, springs, soft tendons, pulled
ones, dampers, forces and torques of drives) are known; other checks compare them with their laws.
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
from sandbox.audit.outlines import pressed
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
    """One force or couple of unknown magnitude."""

    does: dict[int, Array]
    """Wrench of a unit: force x, y and moment about the centre of mass, by body, [3]."""
    free: bool = False
    """Whether it may have either sign."""
    most: float = np.inf
    """Largest magnitude [N, N m]."""
    contact: int = NONE
    """The contact row that it belongs to."""
    normal: float = 0.0
    """Contribution of a unit to that row's normal force, and to its tangential one."""
    tangential: float = 0.0
    below: float = 0.0
    """Rounding error below 0 [N] of the recorded force."""


class Unknowns:
    """Unknown and known forces of a single sample."""

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
        """Sum of the unknown forces: m a and I alpha minus all known loads, [nb, 3]."""
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
        if batch.kind == "friction":  # slipping friction is at its bound
            known &= self.arrays["joint_sticks"][0, batch.element] == 0.0
        return known

    @cached_property
    def rigid(self) -> Flags:
        """Tendons without a pull that are too stiff for a tension by their stretch, [nt].

        With friction at guides the tensions depend on the past: they are known.
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
        """The flank of its teeth that pushed; 0 without one."""
        force, pose = self.arrays["joint_force"][0, joint], self.arrays["body_pose"][0]
        if not self.model.joints.kind[joint].teeth or not force.any():
            return 0
        pushes = [flank_of(self.model, joint, pose, side) for side in (1, -1)]
        one, other = (float(push.x * force[0] + push.y * force[1]) for push in pushes)
        return 1 if one >= other else -1

    def _pair(self, one: int, two: int, at: Array, force: Array, couple: float = 0.0) -> dict[
            int, Array]:
        """A force at a position in the world, and a couple, on ``one`` by ``two``."""
        does = {}
        for sign, body in ((1.0, one), (-1.0, two)):
            arm = at - self.centre[body]
            does[body] = sign * np.array([*force, arm[0] * force[1] - arm[1] * force[0] + couple])
        return does

    def _ends(self) -> Iterator[Unknown]:
        """Taut ropes, telescopes at their shortest, points at an end of their groove."""
        joints, frames, h = self.model.joints, self.loads.frames, self.evidence.h
        speed = np.abs(self.evidence.velocity[:2, :, 0]).sum(axis=0)
        spin = np.abs(self.evidence.velocity[2, :, 0])
        for j in joints.keeping("range", "groove").tolist():
            a, b = joints.bodies[j].tolist()
            on_a, on_b = (np.array([end.x[j, 0], end.y[j, 0]]) for end in frames.anchors)
            if joints.kind[j].keeps == "groove":
                place = frames.place_in_slot(j)
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
                    torque = self.loads.joint_efforts.on_bodies(j)
                    yield Unknown({body: sign * wrench for body, wrench in torque.items()})

    def _cords(self) -> Iterator[Unknown]:
        if not self.rigid.any():
            return
        efforts, a = self.loads.cord_efforts, self.arrays
        rates = efforts.rates(len(self.rigid), self.evidence.velocity)
        for cord in np.flatnonzero(self.rigid).tolist():
            stretch = float(a["tendon_length"][0, cord] - a["tendon_rest"][cord])
            if stretch + 2 * self.evidence.h * abs(float(rates[cord, 0])) >= -ROUNDING:
                yield Unknown({body: -wrench
                               for body, wrench in efforts.on_bodies(cord).items()})

    def _motors(self) -> Iterator[Unknown]:
        drives = self.model.drives
        for i, kind in enumerate(drives.kind):
            if kind.limited and np.isnan(drives.slope[i]):
                most = float(drives.most[i])
                if np.isnan(most):  # the limit of a brake is its value
                    most = float(self.arrays["drive_value"][0, i])
                yield Unknown(self.loads.drive_efforts.on_bodies(i), free=True, most=most)

    def _rubs(self) -> Iterator[Unknown]:
        """Friction of sticking joints, up to its limit under their load."""
        joints, efforts = self.model.joints, self.loads.friction_efforts
        for j in joints.rubbed.tolist():
            if self.arrays["joint_sticks"][0, j] == 1.0:
                most = joints.friction[j] + joints.rubbing[j] * float(carried(self.evidence, j)[0])
                yield Unknown(efforts.on_bodies(j), free=True, most=float(joints.static[j] * most))

    def _contacts(self) -> Iterator[Unknown]:
        a = self.arrays
        for row, normal in enumerate(self.evidence.run.contacts.normal.tolist()):
            pair = int(a["contact_body"][row]), int(a["contact_other"][row])
            u = a["contact_normal"][row]
            left = np.array([-u[1], u[0]])
            places = pressed(self.evidence, row)
            if places is None:  # several normals: any resultant is possible
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
