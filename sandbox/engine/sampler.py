"""What samples keep: gathered by the compiled loop, and worked out a chunk at a time."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.engine.advance import advance
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import Memory, make_memory
from sandbox.engine.records import PULL
from sandbox.engine.snapshot import list_contacts, make_snapshot
from sandbox.engine.state import (
    ANGLE,
    CONTACT,
    DAMPED_WORK,
    DAMPING,
    RATE,
    RUBBED,
    RUBBED_WORK,
    STICKS,
    STOPPING,
)
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.kinds.arrays import Arrays
from sandbox.model.ties import held_one
from sandbox.numeric import Integers, Records
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts
from sandbox.samples.merging import merge_contacts

CHUNK = 512


class Sampler:
    """Room for raw samples of a run; turns each chunk of them into rows of the recording."""

    def __init__(
        self, world: World, tables: Tables, builder: RecordingBuilder, every: int,
    ) -> None:
        self.world, self.tables, self.builder, self.every = world, tables, builder, every
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
        for counts in (self.kept.taken, self.kept.unfinished, self.kept.sums, self.kept.waiting):
            counts[:] = 0
        self.memory = self._memory()

    def enlarge(self, tables: Tables) -> None:
        """Go on with tables that have more room, that of the world."""
        self.tables = tables
        room = _contacts_kept(self.world.room.contacts)
        self._lengthen(contacts=room, mean_contacts=2 * room)

    def _lengthen(self, **rows: int) -> None:
        """Make room for so many rows in arrays that are kept."""
        for name, count in rows.items():
            old = getattr(self.kept, name)
            new = np.zeros(max(count, len(old)), old.dtype)
            new[:len(old)] = old
            self.kept = self.kept._replace(**{name: new})
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
        """Whether the loop was stopped because there is no room to keep what comes next."""
        return bool(self.kept.taken[2])

    def make_room(self) -> None:
        """Let the loop go on that found no room for the next sample, or for contacts of a step."""
        if self.kept.taken[2] == 1:
            self.flush()
        else:
            self._lengthen(mean_contacts=sum(self.kept.unfinished.tolist())
                           + 4 * len(self.tables.state.touches))
        self.kept.taken[2] = 0

    def flush(self) -> None:
        """Work out what was gathered and hand it to the recording."""
        self.write()
        kept, (first, count) = self.kept, self.kept.unfinished.tolist()
        kept.taken[1] = kept.taken[0]  # in one go: Ctrl-C leaves each sample once
        kept.mean_contacts[:count] = kept.mean_contacts[first:first + count].copy()
        kept.unfinished[0] = 0

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
            self.done, *self._contact_rows(sample, kept.contacts[:kept.fill[n - 1]]).values())
        if self.builder.apart:
            self._write_means(n)

    def record_impacts(self, before: int) -> None:
        """Hand on the impacts of the steps just made in one go; ``before`` these so many were."""
        state, order = self.tables.state, self.world.order
        found = state.impacts[:state.made[3]]
        if len(found):
            self.builder.impacts.append(
                (before + found["step"] + 0.5) * self.world.h + found["after"], order[found["a"]],
                order[found["b"]], np.stack([found["x"], found["y"]], axis=1),
                np.stack([found["px"], found["py"]], axis=1))

    def _write_means(self, n: int) -> None:
        """Means of samples whose intervals had several forces, and are over."""
        kept, order, done = self.kept, self.world.order, self.done
        moved = np.flatnonzero(kept.steady[:n] == 0)
        if not len(moved):
            return
        self.builder.means.replace(done, moved + done, kept.means[moved])
        fill = kept.mean_fill[:moved[-1] + 1]
        found = kept.mean_contacts[:fill[-1]]
        numbers = found.view(np.float64).reshape(-1, 9)[:, 2:]
        self.builder.mean_contacts.replace(
            done, np.repeat(np.arange(done, done + len(fill)), np.diff(fill, prepend=0)),
            order[found["a"]], order[found["b"]], numbers / (self.every * self.world.h))

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
        kept = np.zeros(state.touching[0], CONTACT)
        count = list_contacts(state.touches, len(kept), state.body, kept, 0)
        rows = self._contact_rows(np.zeros(count, dtype=np.int64), kept[:count])
        return Contacts({f"contact_{key}": column for key, column in rows.items()},
                        samples=1, bodies=len(self.world.bodies))

    def _contact_rows(self, sample: Integers, kept: Records) -> dict[str, NDArray[Any]]:
        """The columns of contact rows, forces in N."""
        order = self.world.order
        normal = -np.stack([kept["nx"], kept["ny"]], axis=1)  # to the first body
        along = np.stack([kept["ny"], -kept["nx"]], axis=1)
        force = (kept["normal"][:, None] * normal + kept["tangent"][:, None] * along) / self.world.h
        return merge_contacts(
            sample, order[kept["a"]], order[kept["b"]], np.stack([kept["x"], kept["y"]], axis=1),
            force, normal, kept["normal"], kept["gap"].copy(), kept["twist"] / self.world.h)


def _contacts_kept(room: int) -> int:
    """For how many contacts of gathered samples there is room, ``room`` of a step at least."""
    return max(4096, 2 * room)
