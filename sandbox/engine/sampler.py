"""What a sample keeps, gathered cheaply during the loop and worked out a chunk at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymunk import batch

from sandbox.engine.snapshot import make_snapshot, take
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts
from sandbox.scene.elements.drives import BrakeDrive, StiffnessDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.elements.springs import RotarySpring
from sandbox.scene.geometry import joint_angle_sign

Array = NDArray[np.float64]

CHUNK = 512
_F = batch.ArbiterFields
CONTACT = (
    _F.BODY_A_ID | _F.BODY_B_ID | _F.CONTACT_COUNT | _F.TOTAL_IMPULSE | _F.NORMAL
    | _F.POINT_A_1 | _F.POINT_B_1 | _F.DISTANCE_1 | _F.POINT_A_2 | _F.POINT_B_2 | _F.DISTANCE_2
)


class Sampler:
    """Keeps raw samples of a run and turns each full chunk into rows of the recording."""

    def __init__(self, world: World, tables: Tables, builder: RecordingBuilder) -> None:
        self.world, self.tables, self.builder = world, tables, builder
        mechanism = world.mechanism
        count = len(world.bodies)
        self.number = np.array([world.number[body.name] for body in mechanism.bodies], dtype=int)
        self.centre = np.array(
            [world.mass[b.name].centre if b.name in world.mass else (0.0, 0.0)
             for b in mechanism.bodies]).reshape(-1, 2)
        ids = np.array([body.id for body in world.bodies], dtype=np.uintp)
        by_id = np.argsort(ids)
        self.ids, self.of_id = ids[by_id], np.array(world.order, dtype=np.int64)[by_id]
        self.done = 0
        self.filled = 0
        drives = len(mechanism.drives)
        self._drive = np.empty((CHUNK, drives))
        self._kept = make_snapshot(
            CHUNK, count, len(tables.springs), len(tables.spans), len(tables.dampers),
            len(tables.actions), len(world.handles))
        self._contacts: list[tuple[bytes, bytes]] = []
        self._buffer = batch.Buffer()

    def sample(self, before: Array, drive: Array) -> None:
        """Keep the step just made; ``before`` [nb, 3] are the velocities that it began with."""
        i, world, tables = self.filled, self.world, self.tables
        take(self._kept, i, world.state, before, world.predicted, tables.springs, tables.spans,
             tables.dampers, tables.actions, world.get_impulse, world.handles)
        self._drive[i] = drive
        self._contacts.append(self._listed())
        self.filled += 1
        if self.filled == CHUNK:
            self.flush()

    def flush(self) -> None:
        """Work out what was gathered and hand it to the recording."""
        n = self.filled
        if n == 0:
            return
        rows, arrays = slice(self.done, self.done + n), self.builder.arrays
        self._flush_bodies(rows, n)
        self._flush_joints(rows, n)
        self._flush_springs(rows, n)
        arrays["tendon_length"][rows] = self._kept.spans[:n, :, 0]
        arrays["tendon_tension"][rows] = self._kept.spans[:n, :, 1]
        arrays["tendon_work"][rows] = _at_the_instant(self._kept.spans[:n])
        self._flush_drives(rows, n)
        self._flush_contacts()
        self.done += n
        self.filled = 0
        self._contacts.clear()

    def _flush_bodies(self, rows: slice, n: int) -> None:
        arrays = self.builder.arrays
        state, before = self._kept.state[:n, self.number], self._kept.before[:n, self.number]
        angle = state[:, :, 2]
        c, s = np.cos(angle), np.sin(angle)
        x, y = self.centre[:, 0], self.centre[:, 1]
        pose = arrays["body_pose"]
        pose[rows, :, 0] = state[:, :, 0] - (c * x - s * y)
        pose[rows, :, 1] = state[:, :, 1] - (s * x + c * y)
        pose[rows, :, 2] = angle
        arrays["body_shift"][rows] = state[:, :, :3] - self._kept.predicted[:n, self.number]
        after = state[:, :, 3:]
        arrays["body_velocity"][rows] = (before + after) / 2
        arrays["body_acceleration"][rows] = (after - before) / self.world.h

    def _flush_joints(self, rows: slice, n: int) -> None:
        arrays, mechanism = self.builder.arrays, self.world.mechanism
        forces = self._kept.impulses[:n] / self.world.h
        joints = len(mechanism.joints)
        arrays["joint_reaction"][rows] = forces[:, :joints]
        halves = forces[:, joints:].reshape(n, -1, 2)
        stops = dict(zip(self.world.stops, halves.sum(axis=2).T, strict=True))
        for i, joint in enumerate(mechanism.joints):
            if not isinstance(joint, Pin):
                continue
            sign = joint_angle_sign(joint)
            a, b = self.world.number[joint.a], self.world.number[joint.b]
            turned = self._kept.state[:n, b, 2] - self._kept.state[:n, a, 2]
            angle = sign * turned - joint.zero
            rate = arrays["body_velocity"][rows, self.world.order[b], 2] - (
                arrays["body_velocity"][rows, self.world.order[a], 2])
            arrays["joint_angle"][rows, i] = angle
            arrays["joint_rate"][rows, i] = sign * rate
            if joint.limits is not None:
                middle = (joint.limits[0] + joint.limits[1]) / 2
                arrays["joint_stop"][rows, i] = np.where(angle < middle, stops[i], -stops[i])

        hinges, kept = self.tables.dampers["joint"], self._kept.dampers[:n]
        pins = [i for i, joint in enumerate(mechanism.joints) if isinstance(joint, Pin)]
        arrays["joint_damping"][rows, pins] = arrays["joint_damping_work"][rows, pins] = 0.0
        signs = [joint_angle_sign(mechanism.joints[i]) for i in hinges]
        arrays["joint_damping"][rows, hinges] = signs * kept[:, :, 0]
        arrays["joint_damping_work"][rows, hinges] = _at_the_instant(kept)

    def _flush_drives(self, rows: slice, n: int) -> None:
        arrays, tables = self.builder.arrays, self.tables
        arrays["drive_value"][rows] = self._drive[:n]
        work = arrays["drive_work"]
        work[rows] = 0.0
        for i, drive in enumerate(self.world.mechanism.drives):
            if isinstance(drive, StiffnessDrive | BrakeDrive):  # below 0 counts as 0
                np.maximum(arrays["drive_value"][rows, i], 0.0, out=arrays["drive_value"][rows, i])
        own = tables.actions["spring"] < 0
        turned = tables.actions["motor"] != 0
        arrays["drive_torque"][rows, tables.actions["drive"][turned]] = (
            tables.actions["sign"][turned] * self._kept.actions[:n, turned, 0])
        work[rows, tables.actions["drive"][own]] = _at_the_instant(self._kept.actions[:n, own])
        pulled = tables.spans["drive"] >= 0
        work[rows, tables.spans["drive"][pulled]] = arrays["tendon_work"][rows][:, pulled]

    def _flush_springs(self, rows: slice, n: int) -> None:
        arrays, mechanism = self.builder.arrays, self.world.mechanism
        arrays["spring_length"][rows, self.tables.linear] = self._kept.springs[:n, :, 0]
        arrays["spring_force"][rows, self.tables.linear] = self._kept.springs[:n, :, 1]
        arrays["spring_work"][rows, self.tables.linear] = _at_the_instant(self._kept.springs[:n])
        actions = self.tables.actions
        names = [joint.name for joint in mechanism.joints]
        for i, spring in enumerate(mechanism.springs):
            if not isinstance(spring, RotarySpring):
                continue
            j = names.index(spring.joint)
            angle = arrays["joint_angle"][rows, j]
            arrays["spring_length"][rows, i] = angle
            driven = np.flatnonzero(actions["spring"] == i)
            if len(driven):
                kept = self._kept.actions[:n, driven]
                torque = -actions["sign"][driven[0]] * kept[:, 0, 0]
                arrays["spring_work"][rows, i] = _at_the_instant(kept)[:, 0]
            else:
                torque = spring.stiffness * (angle - spring.rest_angle)
                # pymunk turns this spring; what it did is what it no longer holds
                start = self._start_angle(j) - spring.rest_angle
                arrays["spring_work"][rows, i] = (
                    spring.stiffness * start**2 - torque * (angle - spring.rest_angle)) / 2
            arrays["spring_force"][rows, i] = (
                torque + spring.damping * arrays["joint_rate"][rows, j])

    def _start_angle(self, joint: int) -> float:
        """Angle of a pin at t = 0 [rad]."""
        pin = self.world.mechanism.joints[joint]
        assert isinstance(pin, Pin)  # references are checked when a scene is read
        angle = {body.name: body.angle for body in self.world.mechanism.bodies}
        return joint_angle_sign(pin) * (angle[pin.b] - angle[pin.a]) - pin.zero

    def _flush_contacts(self) -> None:
        if rows := self._contact_rows(self._contacts, self.done):
            self.builder.contacts.append(**rows)

    def contacts_now(self) -> Contacts:
        """The contacts of the last step, as one sample."""
        rows = self._contact_rows([self._listed()], 0) or {
            "sample": np.zeros(0, np.int64), "body": np.zeros(0, np.int64),
            "other": np.zeros(0, np.int64), "force": np.zeros((0, 2)), "normal": np.zeros((0, 2))}
        return Contacts({f"contact_{key}": column for key, column in rows.items()},
                        samples=1, bodies=len(self.world.bodies))

    def _listed(self) -> tuple[bytes, bytes]:
        """All arbiters of the last step, as pymunk lists them."""
        buffer = self._buffer
        buffer.clear()
        batch.get_space_arbiters(self.world.space, CONTACT, buffer)
        return buffer.int_buf()[:], buffer.float_buf()[:]

    def _contact_rows(
        self, listed: list[tuple[bytes, bytes]], first_sample: int,
    ) -> dict[str, NDArray[Any]]:
        """The columns of contact rows, forces in N; empty without a contact."""
        ints = np.frombuffer(b"".join(i for i, _ in listed), dtype=np.uintp).reshape(-1, 3)
        floats = np.frombuffer(b"".join(f for _, f in listed)).reshape(-1, 14)
        if not len(ints):
            return {}
        each = np.array([len(i) // (3 * np.dtype(np.uintp).itemsize) for i, _ in listed])
        sample = np.repeat(np.arange(first_sample, first_sample + len(each)), each)
        first, second = self._body_of(ints[:, 0]), self._body_of(ints[:, 1])
        felt = self.world.filters.allowed[first, second]  # pymunk lists refused pairs, too
        contacts = merge_contacts(sample[felt], first[felt], second[felt], ints[felt, 2],
                                  floats[felt], self._precedence())
        return {**contacts, "force": contacts["force"] / self.world.h}

    def _body_of(self, ids: NDArray[np.uintp]) -> NDArray[np.int64]:
        return self.of_id[np.searchsorted(self.ids, ids)]

    def _precedence(self) -> NDArray[np.int64]:
        """Rank of each body: a moving one before a fixed one, then the scene's order."""
        rank = np.empty(len(self.world.order), dtype=np.int64)
        rank[self.world.order] = np.arange(len(rank))
        return rank


def _at_the_instant(columns: Array) -> Array:
    """Work [n, e] up to the instant of the sample, in the middle of its step.

    The last two columns are the work up to the step's end and the step's own share.
    """
    work: Array = columns[:, :, -2] - columns[:, :, -1] / 2
    return work


def merge_contacts(
    sample: NDArray[np.int64], first: NDArray[np.int64], second: NDArray[np.int64],
    count: NDArray[Any], floats: Array, rank: NDArray[np.int64],
) -> dict[str, NDArray[Any]]:
    """One row per touching pair of bodies and sample, oriented and in order.

    ``floats`` [m, 14] holds per arbiter: impulse on the first shape's body, normal from first to
    second, then for two points: place on either surface and distance. Arbiters of one pair of
    bodies (several shapes) are added up; the point is the mean, weighted by normal impulse.
    """
    two = count == 2
    point = (floats[:, 4:6] + floats[:, 6:8]) / 2
    other = (floats[:, 9:11] + floats[:, 11:13]) / 2
    point = np.where(two[:, None], (point + other) / 2, point)
    gap = np.where(two, np.minimum(floats[:, 8], floats[:, 13]), floats[:, 8])
    swap = rank[first] > rank[second]
    body, against = np.where(swap, second, first), np.where(swap, first, second)
    sign = np.where(swap, 1.0, -1.0)[:, None]  # the normal points from the first to the second
    normal, force = sign * floats[:, 2:4], -sign * floats[:, 0:2]
    order = np.lexsort((rank[against], rank[body], sample))
    sample, body, against = sample[order], body[order], against[order]
    point, normal, force, gap = point[order], normal[order], force[order], gap[order]
    new = np.ones(len(sample), dtype=bool)
    new[1:] = (np.diff(sample) != 0) | (np.diff(body) != 0) | (np.diff(against) != 0)
    start = np.flatnonzero(new)
    if len(start) < len(sample):
        weight = np.maximum(np.sum(normal * force, axis=1), 1e-300)[:, None]
        total = np.add.reduceat(weight, start)
        point = np.add.reduceat(point * weight, start) / total
        normal = np.add.reduceat(normal * weight, start)
        normal /= np.maximum(np.hypot(*normal.T), 1e-300)[:, None]
        force, gap = np.add.reduceat(force, start), np.minimum.reduceat(gap, start)
    return {
        "sample": sample[start], "body": body[start], "other": against[start],
        "point": point, "force": force, "normal": normal, "gap": gap,
    }
