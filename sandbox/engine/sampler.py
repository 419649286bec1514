"""Samples: copies of arrays that the compiled loop keeps, turned into recorded values in chunks."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import Arrays
from sandbox.engine.advance import advance
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import Memory, make_memory
from sandbox.engine.records import PULL, STOP
from sandbox.engine.snapshot import list_contacts, make_snapshot
from sandbox.engine.state import CONTACT
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.model.bonds import held_one
from sandbox.numeric import Array, Integers, Records
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts, merge_contacts

CHUNK = 512
LEAST = 4096
"""Contacts of gathered samples that there is room for, at least."""


class Sampler:
    """Room for raw samples of a run; turns each chunk of them into rows of the recording."""

    def __init__(
        self, world: World, tables: Tables, builder: RecordingBuilder, every: int,
    ) -> None:
        self.world, self.tables, self.builder, self.every = world, tables, builder, every
        self.model = world.model
        self.kept = make_snapshot(CHUNK, tables, max(LEAST, 2 * world.room.contacts))
        self._arrays = builder.blank(CHUNK)
        """Rows on their way to the recording; what elements do not have stays nan."""
        self._entry_points = prepare(tables.constants, tables.elements, advance)
        self.memory = self._memory()
        """What the compiled loop works on."""

    def _memory(self) -> Memory:
        return make_memory(self.world.native, *self.tables, self.kept, self._entry_points)

    def restart(self, tables: Tables, builder: RecordingBuilder) -> None:
        """Gather for another recording, with tables of no more room than those so far."""
        self.tables, self.builder = tables, builder
        for counts in (self.kept.taken, self.kept.unfinished, self.kept.sums, self.kept.waiting):
            counts[:] = 0
        self.memory = self._memory()

    def enlarge(self, tables: Tables) -> None:
        """Go on with tables that have more room, that of the world."""
        self.tables = tables
        room = max(LEAST, 2 * self.world.room.contacts)
        self._lengthen(contacts=room, mean_contacts=2 * room)

    def _lengthen(self, **rows: int) -> None:
        for name, count in rows.items():
            old = getattr(self.kept, name)
            new = np.zeros(max(count, len(old)), old.dtype)
            new[:len(old)] = old
            room: dict[str, Any] = {name: new}
            self.kept = self.kept._replace(**room)
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
        """Compute what was gathered, and go on gathering as if nothing had been written."""
        n = self.filled
        if n == 0:
            return
        arrays, kept = {key: array[:n] for key, array in self._arrays.items()}, self.kept
        for name in ("pose", "velocity", "acceleration"):
            arrays[f"body_{name}"][:] = getattr(kept, name)[:n]
        self._write_joints(arrays, n)
        self._write_springs(arrays, n)
        if self.model.tendons.name:
            self._write_tendons(arrays, n)
        if len(self.tables.elements.fluids):
            self._write_lines(arrays, n)
        loads, number = self._of("loads", n), self.tables.elements.loads["number"]
        arrays["load_force"][:, number] = np.stack([loads["fx"], loads["fy"]], axis=-1)
        arrays["load_torque"][:, number] = loads["torque"]
        arrays["load_work"][:, number] = self._work("loads", n)
        self._write_drives(arrays, n)
        arrays["held"][:] = self._of("bonds", n)["held"]
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

    def _of(self, view: str, n: int) -> Any:
        return self.kept.copied[view][:n]

    def _work(self, element: str, n: int, name: str = "work") -> Array:
        """Work [J] of elements up to the instants of samples, which lie amid their steps."""
        found = self._of(element, n)
        work: Array = found[name] - found[f"step_{name}"] / 2
        return work

    def _write_joints(self, arrays: Arrays, n: int) -> None:
        """Joints with their limits and dry friction."""
        elements, results = self.tables.elements, self._of("joints", n)
        arrays["joint_reaction"][:] = np.hypot(results["fx"], results["fy"])
        arrays["joint_force"][:] = np.stack([results["fx"], results["fy"]], axis=-1)
        arrays["joint_couple"][:] = results["couple"]
        arrays["joint_twist"][:] = np.stack(
            [results["twist_a"], results["twist_b"]], axis=-1) / self.world.h
        hinge, line = elements.joints["hinge"] == 1, elements.joints["line"] == 1
        sense, zero = elements.joints["sense"][hinge], elements.joints["zero"][hinge]
        arrays["joint_angle"][:, hinge] = sense * results["way"][:, hinge] - zero
        arrays["joint_rate"][:, hinge] = results["rate"][:, hinge]
        arrays["joint_length"][:, line] = results["way"][:, line]
        arrays["joint_speed"][:, line] = results["rate"][:, line]
        arrays["joint_stop"][:, elements.joints["stopped"] == 1] = 0.0
        for i in np.flatnonzero(elements.limits["what"] == STOP).tolist():
            limit, impulse = elements.limits[i], self._of("limits", n)["impulse"][:, i]
            sense = elements.joints["sense"][limit["joint"]]
            arrays["joint_stop"][:, limit["joint"]] += (
                sense * limit["side"] * impulse / self.world.h)
        joint, friction = elements.dry_friction["joint"], self._of("dry_friction", n)
        arrays["joint_friction"][:, joint] = friction["force"]
        arrays["joint_sticks"][:, joint] = friction["sticks"]
        arrays["joint_friction_work"][:, joint] = self._work("dry_friction", n)

    def _write_tendons(self, arrays: Arrays, n: int) -> None:
        whole = slice(len(self.model.tendons.name))  # spans come after these
        for name in ("length", "tension"):
            arrays[f"tendon_{name}"][:] = self._of("cables", n)[name][:, whole]
        arrays["tendon_work"][:] = self._work("cables", n)[:, whole]
        arrays["guide_friction"][:] = self._of("slips", n)["force"]
        arrays["guide_slip"][:] = self._of("slips", n)["way"]
        arrays["guide_lifted"][:] = (
            self._of("guides", n)["lifted"][:, self.tables.constants.wheels])

    def _write_lines(self, arrays: Arrays, n: int) -> None:
        results = self._of("fluids", n)
        fluids = self.tables.elements.fluids
        arrays["line_pressure"][:], arrays["line_flow"][:] = results["pressure"], results["flow"]
        arrays["line_volume"][:] = results["grown"] + fluids["volume"]
        # of a gas the content counts what filled it at t = 0 without pressure
        arrays["line_content"][:] = results["content"] - np.where(
            fluids["gas"] > 0, fluids["volume"], 0.0)
        arrays["line_spilled"][:] = results["spilled"]
        arrays["line_work"][:] = self._work("fluids", n)
        arrays["line_ahead"][:] = results["ahead"] * self.world.h
        arrays["valve_flow"][:] = self._of("valves", n)["flow"]
        arrays["valve_loss"][:] = self._work("valves", n, "loss")

    def _write_drives(self, arrays: Arrays, n: int) -> None:
        elements = self.tables.elements
        actions, cables, pumps = elements.actions, elements.cables, elements.pumps["drive"]
        torque, work = self._of("actions", n)["torque"], arrays["drive_work"]
        arrays["drive_value"][:] = self.kept.drive[:n]
        limited, runs = actions["motor"] >= 0, actions["runs"] == 1
        arrays["drive_torque"][:, actions["drive"][limited]] = (
            actions["sense"][limited] * torque[:, limited])
        arrays["drive_power"][:, actions["drive"][runs]] = torque[:, runs]
        arrays["drive_flow"][:, pumps] = self._of("pumps", n)["flow"]
        pulled = cables["kind"] == PULL
        work[:] = 0.0
        work[:, actions["drive"]] = self._work("actions", n)
        work[:, pumps] = self._work("pumps", n)
        work[:, cables["drive"][pulled]] = self._work("cables", n)[:, pulled]

    def _write_springs(self, arrays: Arrays, n: int) -> None:
        """Springs and the damping of hinges, which springs with a rotary damper share."""
        joints, springs = self.model.joints, self.tables.elements.springs
        results, work = self._of("springs", n), self._work("springs", n)
        damped = springs["number"] < 0
        hinge = springs["joint"][damped]
        for name, values in (("damping", joints.sense[hinge] * results["effort"][:, damped]),
                             ("damping_work", work[:, damped])):
            arrays[f"joint_{name}"][:, joints.angle] = 0.0
            arrays[f"joint_{name}"][:, hinge] = values
        straight = springs["joint"] < 0
        own = springs["number"][straight]
        arrays["spring_length"][:, own] = results["way"][:, straight]
        arrays["spring_force"][:, own] = 0.0 - results["effort"][:, straight]
        arrays["spring_work"][:, own] = work[:, straight]
        for k in np.flatnonzero(~straight & ~damped).tolist():
            i, j = int(springs["number"][k]), int(springs["joint"][k])
            holds = held_one(self.model.bonds.joint[j], self._of("bonds", n)["held"])
            arrays["spring_work"][:, i] = work[:, k]
            arrays["spring_length"][:, i] = arrays["joint_angle"][:, j]
            arrays["spring_force"][:, i] = (
                springs["sense"][k] * -results["effort"][:, k]
                + holds * self.model.springs.damping[i] * arrays["joint_rate"][:, j])

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
