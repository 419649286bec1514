"""What a sample keeps, gathered cheaply during the loop and worked out a chunk at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from pymunk import batch

from sandbox.engine.advance import keep
from sandbox.engine.memory import make_memory
from sandbox.engine.snapshot import make_snapshot
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.numeric import Array, Integers
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts

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
        self.model = world.model
        ids = np.array([body.id for body in world.bodies], dtype=np.uintp)
        by_id = np.argsort(ids)
        self.ids, self.of_id = ids[by_id], world.order[by_id]
        self.done = 0
        """Samples that are in the recording."""
        self.filled = 0
        """Samples that are gathered since."""
        self.kept = make_snapshot(CHUNK, tables.constants, len(world.native.handles))
        self.memory = make_memory(world.native, *tables[:3], self.kept)
        """What the compiled loop works on."""
        self._drive = np.empty((CHUNK, len(self.model.drives.name)))
        self._contacts: list[tuple[bytes, bytes]] = []
        self._buffer = batch.Buffer()

    def sample(self, drive: Array) -> None:
        """Keep the step just made, with the drives' values [nd] in it."""
        if self.filled == CHUNK:
            self.flush()
        keep(self.memory.table, self.memory.h, self.filled)
        self._drive[self.filled] = drive
        self._contacts.append(self._listed())
        self.filled += 1

    def flush(self) -> None:
        """Work out what was gathered and hand it to the recording."""
        self.write()
        # no call in between, at which Ctrl-C could fall: a sample counts once
        self.done, self.filled = self.done + self.filled, 0
        self._contacts.clear()

    def write(self) -> None:
        """Work out what was gathered, and go on gathering as if nothing had been.

        Numbers then come from whole chunks, however often a recording is asked for.
        """
        n = self.filled
        if n == 0:
            return
        rows, arrays, kept = slice(self.done, self.done + n), self.builder.arrays, self.kept
        self._write_bodies(rows, n)
        self._write_joints(rows, n)
        self._write_springs(rows, n)
        arrays["tendon_length"][rows] = kept.cords[:n, :, 0]
        arrays["tendon_tension"][rows] = kept.cords[:n, :, 1]
        arrays["tendon_work"][rows] = _at_the_instant(kept.cords[:n])
        self._write_drives(rows, n)
        listed = self._contacts[:n]
        self.builder.contacts.replace(self.done, **self._contact_rows(listed, self.done))

    def _write_bodies(self, rows: slice, n: int) -> None:
        arrays, number = self.builder.arrays, self.world.number
        body, before = self.kept.body[:n, number], self.kept.before[:n, number]
        angle = body[:, :, 2]
        c, s = np.cos(angle), np.sin(angle)
        x, y = self.model.bodies.centre[:, 0], self.model.bodies.centre[:, 1]
        pose = arrays["body_pose"]
        pose[rows, :, 0] = body[:, :, 0] - (c * x - s * y)
        pose[rows, :, 1] = body[:, :, 1] - (s * x + c * y)
        pose[rows, :, 2] = angle
        arrays["body_shift"][rows] = body[:, :, :3] - self.kept.pose[:n, number]
        after = body[:, :, 3:]
        arrays["body_velocity"][rows] = (before + after) / 2
        arrays["body_acceleration"][rows] = (after - before) / self.world.h

    def _write_joints(self, rows: slice, n: int) -> None:
        arrays, joints = self.builder.arrays, self.model.joints
        forces = self.kept.impulses[:n] / self.world.h
        count, hinges = len(joints.name), joints.hinges
        arrays["joint_reaction"][rows] = forces[:, :count]
        sense, both = joints.sense[hinges], joints.bodies[hinges]
        a, b = self.world.number[both].T
        angle = sense * (self.kept.body[:n, b, 2] - self.kept.body[:n, a, 2]) - joints.zero[hinges]
        omega = arrays["body_velocity"][rows, :, 2]
        arrays["joint_angle"][rows, hinges] = angle
        rate = omega[:, both[:, 1]] - omega[:, both[:, 0]]
        arrays["joint_rate"][rows, hinges] = sense * rate
        stopped = joints.stopped
        stops = forces[:, count:].reshape(n, -1, 2).sum(axis=2)
        middle = joints.stops[stopped].sum(axis=1) / 2
        low = arrays["joint_angle"][rows, stopped] < middle
        arrays["joint_stop"][rows, stopped] = np.where(low, stops, -stops)
        damped, kept = self.tables.constants.dampers["joint"], self.kept.dampers[:n]
        for name, values in (("joint_damping", joints.sense[damped] * kept[:, :, 0]),
                             ("joint_damping_work", _at_the_instant(kept))):
            arrays[name][rows, hinges] = 0.0
            arrays[name][rows, damped] = values

    def _write_drives(self, rows: slice, n: int) -> None:
        arrays, constants = self.builder.arrays, self.tables.constants
        actions, cords = constants.actions, constants.cords
        arrays["drive_value"][rows] = self._drive[:n]
        work = arrays["drive_work"]
        work[rows] = 0.0
        own = actions["spring"] < 0
        limited = actions["motor"] != 0
        arrays["drive_torque"][rows, actions["drive"][limited]] = (
            actions["sense"][limited] * self.kept.actions[:n, limited, 0])
        work[rows, actions["drive"][own]] = _at_the_instant(self.kept.actions[:n, own])
        pulled = cords["drive"] >= 0
        work[rows, cords["drive"][pulled]] = arrays["tendon_work"][rows][:, pulled]

    def _write_springs(self, rows: slice, n: int) -> None:
        arrays, springs, actions = (
            self.builder.arrays, self.model.springs, self.tables.constants.actions)
        straight, kept = self.tables.straight, self.kept.springs[:n]
        arrays["spring_length"][rows, straight] = kept[:, :, 0]
        arrays["spring_force"][rows, straight] = kept[:, :, 1]
        arrays["spring_work"][rows, straight] = _at_the_instant(kept)
        for i in np.flatnonzero(~springs.straight).tolist():
            j, k, rest = springs.joint[i], springs.stiffness[i], springs.rest[i]
            angle = arrays["joint_angle"][rows, j]
            arrays["spring_length"][rows, i] = angle
            driven = np.flatnonzero(actions["spring"] == i)
            if len(driven):
                done = self.kept.actions[:n, driven]
                torque = -actions["sense"][driven[0]] * done[:, 0, 0]
                arrays["spring_work"][rows, i] = _at_the_instant(done)[:, 0]
            else:
                torque = k * (angle - rest)
                # pymunk turns this spring; what it did is what it no longer holds
                start = self.model.joints.start[j] - rest
                arrays["spring_work"][rows, i] = (
                    k * start**2 - torque * (angle - rest)) / 2
            arrays["spring_force"][rows, i] = (
                torque + springs.damping[i] * arrays["joint_rate"][rows, j])

    def contacts_now(self) -> Contacts:
        """The contacts of the last step, as one sample."""
        rows = self._contact_rows([self._listed()], 0)
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
        """The columns of contact rows, forces in N."""
        ints = np.frombuffer(b"".join(i for i, _ in listed), dtype=np.uintp).reshape(-1, 3)
        floats = np.frombuffer(b"".join(f for _, f in listed)).reshape(-1, 14)
        each = np.array([len(i) // (3 * np.dtype(np.uintp).itemsize) for i, _ in listed])
        sample = np.repeat(np.arange(first_sample, first_sample + len(each)), each)
        first, second = self._body_of(ints[:, 0]), self._body_of(ints[:, 1])
        felt = self.world.filters.allowed[first, second]  # pymunk lists refused pairs, too
        contacts = merge_contacts(sample[felt], first[felt], second[felt], ints[felt, 2],
                                  floats[felt], self.world.number)
        return {**contacts, "force": contacts["force"] / self.world.h}

    def _body_of(self, ids: NDArray[np.uintp]) -> Integers:
        return self.of_id[np.searchsorted(self.ids, ids)]


def _at_the_instant(columns: Array) -> Array:
    """Work [n, e] up to the instant of the sample, in the middle of its step.

    The last two columns are the work up to the step's end and the step's own part.
    """
    work: Array = columns[:, :, -2] - columns[:, :, -1] / 2
    return work


def merge_contacts(
    sample: Integers, first: Integers, second: Integers,
    count: NDArray[Any], floats: Array, rank: Integers,
) -> dict[str, NDArray[Any]]:
    """One row per touching pair of bodies and sample, oriented and in order.

    ``rank`` [nb] says which body of a pair comes first: a moving one before a fixed one.
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
