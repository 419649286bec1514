"""What samples keep: gathered by the compiled loop, and worked out a chunk at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.engine.advance import advance
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import Memory, make_memory
from sandbox.engine.snapshot import make_snapshot, twist_of
from sandbox.engine.state import (
    ANGLE,
    DAMPED_WORK,
    DAMPING,
    PULL,
    RATE,
    RUBBED,
    RUBBED_WORK,
    STICKS,
    STOPPING,
)
from sandbox.engine.tables import Tables
from sandbox.engine.touch_state import CONTACT
from sandbox.engine.world import World
from sandbox.kinds.arrays import Arrays
from sandbox.model.ties import held_one
from sandbox.numeric import Array, Integers, Records
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts

CHUNK = 512
CANCELLED = 1e-6
"""A resultant that small against the sizes of its forces has no line of action."""


class Sampler:
    """Room for raw samples of a run; turns each chunk of them into rows of the recording."""

    def __init__(self, world: World, tables: Tables, builder: RecordingBuilder) -> None:
        self.world, self.tables, self.builder = world, tables, builder
        self.model = world.model
        self.kept = make_snapshot(CHUNK, tables.constants, len(self.model.drives.name),
                                  _contacts_kept(world.room.contacts))
        self._entry_points = prepare(tables.constants, advance)
        self.memory = self._memory()
        """What the compiled loop works on."""

    def _memory(self) -> Memory:
        return make_memory(self.world.native, *self.tables[:3], self.kept, self._entry_points)

    def restart(self, tables: Tables, builder: RecordingBuilder) -> None:
        """Gather for another recording, with tables of no more room than those so far."""
        self.tables, self.builder = tables, builder
        self.kept.taken[:] = 0
        self.memory = self._memory()

    def enlarge(self, tables: Tables) -> None:
        """Go on with tables that have more room, that of the world."""
        self.tables = tables
        contacts = np.zeros(_contacts_kept(self.world.room.contacts), self.kept.contacts.dtype)
        contacts[:len(self.kept.contacts)] = self.kept.contacts
        self.kept = self.kept._replace(contacts=contacts)
        self.memory = self._memory()

    @property
    def done(self) -> int:
        """Samples that are in the recording."""
        return int(self.kept.taken[1])

    @property
    def filled(self) -> int:
        """Samples that are gathered since."""
        return int(self.kept.taken[0] - self.kept.taken[1])

    @property
    def full(self) -> bool:
        """Whether the loop was stopped because there is no room for the next sample."""
        return bool(self.kept.taken[2])

    def flush(self) -> None:
        """Work out what was gathered and hand it to the recording."""
        self.write()
        self.kept.taken[1] = self.kept.taken[0]  # in one go: Ctrl-C leaves each sample once
        self.kept.taken[2] = 0

    def write(self) -> None:
        """Work out what was gathered, and go on gathering as if nothing had been.

        Numbers then come from whole chunks, however often a recording is asked for.
        """
        n = self.filled
        if n == 0:
            return
        arrays, kept = self.builder.blank(n), self.kept
        self._write_bodies(arrays, n)
        self._write_joints(arrays, n)
        self._write_springs(arrays, n)
        cords = kept.cords[:n, :len(self.model.tendons.name)]  # spans come after these
        arrays["tendon_length"][:] = cords[:, :, 0]
        arrays["tendon_tension"][:] = cords[:, :, 1]
        arrays["tendon_work"][:] = cords[:, :, 2]
        arrays["guide_friction"][:] = kept.slips[:n, :, 0]
        arrays["guide_slip"][:] = kept.slips[:n, :, 1]
        arrays["guide_lifted"][:] = kept.lifted[:n]
        self._write_lines(arrays, n)
        loads = kept.loads[:n]
        arrays["load_force"][:], arrays["load_torque"][:] = loads[:, :, :2], loads[:, :, 2]
        arrays["load_work"][:] = loads[:, :, 3]
        self._write_drives(arrays, n)
        arrays["held"][:] = kept.ties[:n]
        self.builder.put(self.done, arrays)
        each = np.diff(kept.fill[:n], prepend=0)
        sample = np.repeat(np.arange(self.done, self.done + n), each)
        self.builder.contacts.replace(
            self.done, **self._contact_rows(sample, kept.contacts[:kept.fill[n - 1]]))

    def _write_bodies(self, arrays: Arrays, n: int) -> None:
        kept = self.kept
        arrays["body_pose"][:] = kept.pose[:n]
        arrays["body_velocity"][:] = kept.velocity[:n]
        arrays["body_acceleration"][:] = kept.acceleration[:n]

    def _write_joints(self, arrays: Arrays, n: int) -> None:
        kept = self.kept.joints[:n]
        arrays["joint_reaction"][:] = np.hypot(kept[:, :, 0], kept[:, :, 1])
        arrays["joint_force"][:] = kept[:, :, :2]
        for name, column in (("couple", 2), ("angle", ANGLE), ("rate", RATE), ("stop", STOPPING),
                             ("damping", DAMPING), ("damping_work", DAMPED_WORK),
                             ("friction", RUBBED), ("friction_work", RUBBED_WORK),
                             ("sticks", STICKS)):
            arrays[f"joint_{name}"][:] = kept[:, :, column]
        lines = np.array([kind.line for kind in self.model.joints.kind], dtype=bool)
        for name, told in (("length", "angle"), ("speed", "rate")):
            arrays[f"joint_{name}"][:, lines] = arrays[f"joint_{told}"][:, lines]
            arrays[f"joint_{told}"][:, lines] = np.nan

    def _write_lines(self, arrays: Arrays, n: int) -> None:
        lines, valves = self.kept.fluids[:n], self.kept.valves[:n]
        for column, name in enumerate(
                ("pressure", "volume", "flow", "content", "spilled", "work", "ahead")):
            arrays[f"line_{name}"][:] = lines[:, :, column]
        constants = self.tables.constants
        arrays["line_ahead"] *= self.world.h
        arrays["line_volume"] += constants.fluids["volume"]
        # of a gas what filled it at t = 0 without pressure is in its content
        arrays["line_content"] -= np.where(constants.fluids["gas"] > 0,
                                           constants.fluids["volume"], 0.0)
        arrays["valve_flow"][:], arrays["valve_loss"][:] = valves[:, :, 0], valves[:, :, 1]

    def _write_drives(self, arrays: Arrays, n: int) -> None:
        constants = self.tables.constants
        actions, cords = constants.actions, constants.cords
        arrays["drive_value"][:] = self.kept.drive[:n]
        work = arrays["drive_work"]
        work[:] = 0.0
        own = actions["spring"] < 0
        limited = actions["motor"] >= 0
        arrays["drive_torque"][:, actions["drive"][limited]] = (
            actions["sense"][limited] * self.kept.actions[:n, limited, 0])
        work[:, actions["drive"][own]] = self.kept.actions[:n, own, 1]
        runs = actions["runs"] == 1
        arrays["drive_power"][:, actions["drive"][runs]] = self.kept.actions[:n, runs, 0]
        pumps = constants.pumps["drive"]
        arrays["drive_flow"][:, pumps] = self.kept.pumps[:n, :, 0]
        work[:, pumps] = self.kept.pumps[:n, :, 1]
        pulled = cords["kind"] == PULL
        work[:, cords["drive"][pulled]] = self.kept.cords[:n, pulled, 2]

    def _write_springs(self, arrays: Arrays, n: int) -> None:
        springs, actions = self.model.springs, self.tables.constants.actions
        straight, kept = self.tables.straight, self.kept.springs[:n]
        arrays["spring_length"][:, straight] = kept[:, :, 0]
        arrays["spring_force"][:, straight] = kept[:, :, 1]
        arrays["spring_work"][:, straight] = kept[:, :, 2]
        for i in np.flatnonzero(~springs.straight).tolist():
            j = springs.joint[i]
            arrays["spring_length"][:, i] = arrays["joint_angle"][:, j]
            row = int(np.flatnonzero(actions["spring"] == i)[0])
            torque = -actions["sense"][row] * self.kept.actions[:n, row, 0]
            arrays["spring_work"][:, i] = self.kept.actions[:n, row, 1]
            holds = held_one(self.model.ties.joint[j], self.kept.ties[:n])
            arrays["spring_force"][:, i] = (
                torque + holds * springs.damping[i] * arrays["joint_rate"][:, j])

    def contacts_now(self) -> Contacts:
        """The contacts of the last step, as one sample."""
        state = self.tables.state
        touches = state.touches[:state.touching[0]]
        touches = touches[touches["normal"] + touches["bounce"] > 0.0]
        contacts = np.zeros(len(touches), CONTACT)
        for name in ("a", "b", "gap", "nx", "ny"):
            contacts[name] = touches[name]
        contacts["x"] = state.body[touches["a"], 0] + touches["ax"]
        contacts["y"] = state.body[touches["a"], 1] + touches["ay"]
        contacts["normal"] = touches["normal"] + touches["bounce"]
        contacts["tangent"] = touches["tangent"] + touches["rub"]
        contacts["twist"] = [twist_of(state.body, touch) for touch in touches]
        rows = self._contact_rows(np.zeros(len(contacts), dtype=np.int64), contacts)
        return Contacts({f"contact_{key}": column for key, column in rows.items()},
                        samples=1, bodies=len(self.world.bodies))

    def _contact_rows(self, sample: Integers, kept: Records) -> dict[str, NDArray[Any]]:
        """The columns of contact rows, forces in N."""
        order = self.world.order
        return merge_contacts(sample, order[kept["a"]], order[kept["b"]], kept, self.world.h)


def _contacts_kept(room: int) -> int:
    """For how many contacts of gathered samples there is room, ``room`` of a step at least."""
    return max(4096, 2 * room)


def merge_contacts(
    sample: Integers, body: Integers, other: Integers, kept: Records, h: float,
) -> dict[str, NDArray[Any]]:
    """One row per touching pair of bodies and sample.

    Points of one pair, of whatever shapes, are added up; the place is the centre of pressure, the
    mean weighted by the normal impulses, moved onto the line of action of the pair's force where
    it is not on it, as between surfaces that are not in line: what the pair's force does at its
    place is then all that its points do, moments included. ``kept`` are CONTACT, in order of
    samples, ``h`` is the step [s].
    """
    bodies = 1 + max(kept["a"].max(initial=0), kept["b"].max(initial=0))
    pair = (sample * bodies + kept["a"]) * bodies + kept["b"]
    if (pair[1:] < pair[:-1]).any():  # bodies of several shapes
        order = np.argsort(pair, kind="stable")
        sample, body, other, kept, pair = (
            column[order] for column in (sample, body, other, kept, pair))
    normal = -np.stack([kept["nx"], kept["ny"]], axis=1)  # to the first body
    along = np.stack([kept["ny"], -kept["nx"]], axis=1)
    force = (kept["normal"][:, None] * normal + kept["tangent"][:, None] * along) / h
    point, gap = np.stack([kept["x"], kept["y"]], axis=1), kept["gap"].copy()
    twist = kept["twist"] / h
    start = np.flatnonzero(np.diff(pair, prepend=-1))
    merged = np.diff(start, append=len(sample)).astype(float)
    if len(start) < len(sample):
        weight = kept["normal"][:, None]
        total = np.add.reduceat(weight, start)
        point = _on_line(np.add.reduceat(point * weight, start) / total, point, force, start)
        normals = np.add.reduceat(normal * weight, start)
        size = np.hypot(*normals.T)[:, None]
        acts = size > CANCELLED * total  # held from both sides, there is none: the first point's
        normal = np.where(acts, normals / np.where(acts, size, 1.0), normal[start])
        force, gap = np.add.reduceat(force, start), np.minimum.reduceat(gap, start)
        twist = np.add.reduceat(twist, start)
    return {
        "sample": sample[start], "body": body[start], "other": other[start],
        "point": point, "force": force, "normal": normal, "gap": gap, "merged": merged,
        "twist": twist,
    }


def _on_line(mean: Array, point: Array, force: Array, start: Integers) -> Array:
    """Points ``mean`` [p, 2] moved onto the lines of action of the forces at ``point`` [m, 2].

    Rows of each pair begin at ``start``. Left where they are if the forces all but cancel: what
    they do is then a couple, which no place gives.
    """
    pair = np.repeat(np.arange(len(start)), np.diff(start, append=len(point)))
    arm = point - mean[pair]
    moment = np.add.reduceat(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0], start)
    total = np.add.reduceat(force, start)
    sizes = np.add.reduceat(np.hypot(force[:, 0], force[:, 1]), start)
    square = (total**2).sum(axis=1)
    acts = square > (CANCELLED * sizes) ** 2
    way = np.where(acts, moment / np.where(acts, square, 1.0), 0.0)
    moved: Array = mean + way[:, None] * np.stack([total[:, 1], -total[:, 0]], axis=1)
    return moved
