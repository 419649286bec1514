"""Recorded samples and live readings of the tables of a run.

The compiled loop copies tables; samples are converted to recorded values in chunks. Controllers and
conditions read the tables themselves: readings are those of the last step, as in a recording of
every step. Before the first step forces and tensions are 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import Arrays
from sandbox.elements.quantities import BOND_QUANTITIES, numbered, row_of
from sandbox.engine.advance import advance, list_contacts, make_snapshot
from sandbox.engine.entry_points import prepare
from sandbox.engine.memory import Memory, make_memory
from sandbox.engine.records import PULL
from sandbox.engine.state import CONTACT
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.errors import Problem, SceneError
from sandbox.model.catalogue import Catalogue, Source
from sandbox.model.model import held_of
from sandbox.numeric import Array, Integers, Records
from sandbox.recording.builder import RecordingBuilder
from sandbox.samples.contacts import Contacts, merge_contacts
from sandbox.values.expressions import Read, closure
from sandbox.wording import quoted

CHUNK = 512
MIN_CONTACTS = 4096  # minimum room for contacts of the samples that are not yet converted
RECORDED: dict[str, tuple[str, ...]] = {
    "joint_force": ("joints", "fx", "fy"), "joint_couple": ("joints", "couple"),
    "joint_friction": ("dry_friction", "force"), "joint_sticks": ("dry_friction", "sticks"),
    "joint_friction_work": ("dry_friction", "work"), "tendon_length": ("cables", "length"),
    "tendon_tension": ("cables", "tension"), "tendon_work": ("cables", "work"),
    "guide_friction": ("slips", "force"), "guide_slip": ("slips", "way"),
    "line_pressure": ("fluids", "pressure"), "line_flow": ("fluids", "flow"),
    "line_spilled": ("fluids", "spilled"), "line_work": ("fluids", "work"),
    "valve_flow": ("valves", "flow"), "valve_loss": ("valves", "loss"),
    "load_force": ("loads", "fx", "fy"), "load_torque": ("loads", "torque"),
    "load_work": ("loads", "work"), "drive_flow": ("pumps", "flow"), "held": ("bonds", "held")}
"""Arrays of a recording that are results of elements: their table, a column for each component."""
NUMBERS = {"dry_friction": "joint", "springs": "number", "loads": "number", "pumps": "drive",
           "actions": "drive"}
"""Columns with the numbers of elements, of tables without a row for each."""


class Sampler:
    """Raw samples of a run, and their conversion into rows of the recording."""

    def __init__(self, world: World, tables: Tables, builder: RecordingBuilder, every: int) -> None:
        self.world, self.tables, self.builder, self.every = world, tables, builder, every
        self.model = world.model
        self.kept = make_snapshot(CHUNK, tables, max(MIN_CONTACTS, 2 * world.room.contacts))
        self._arrays = builder.blank(CHUNK)  # values that elements do not have stay nan
        self._entry_points = prepare(tables.constants, tables.elements, advance)
        self._renew()

    def _renew(self) -> None:
        self.memory: Memory = make_memory(
            (self.world.native, *self.tables, self.kept), self.world.h, self._entry_points)

    def restart(self, tables: Tables, builder: RecordingBuilder) -> None:
        """Start another recording, with tables of no more room than those so far."""
        self.tables, self.builder = tables, builder
        for counts in (self.kept.taken, self.kept.unfinished, self.kept.sums, self.kept.waiting):
            counts[:] = 0
        self._renew()

    def enlarge(self, tables: Tables) -> None:
        """Continue with tables of more room, that of the world."""
        self.tables = tables
        room = max(MIN_CONTACTS, 2 * self.world.room.contacts)
        self._lengthen(contacts=room, mean_contacts=2 * room)

    def _lengthen(self, **rows: int) -> None:
        for name, count in rows.items():
            array = getattr(self.kept, name).copy()
            array.resize(max(count, len(array)), refcheck=False)  # filled with zeros
            self.kept = self.kept._replace(**{name: array})
        self._renew()

    def make_room(self) -> None:
        """Make the room that the loop lacks, for the next sample or for contacts of a step."""
        if self.kept.taken[2] == 1:
            self.flush()
        else:
            self._lengthen(mean_contacts=sum(self.kept.unfinished.tolist())
                           + 4 * len(self.tables.state.touches))
        self.kept.taken[2] = 0

    def flush(self) -> None:
        """Move the samples of the loop to the recording."""
        self.write()
        kept, (first, count) = self.kept, self.kept.unfinished.tolist()
        kept.taken[1] = kept.taken[0]  # one assignment: after Ctrl-C no sample is there twice
        kept.mean_contacts[:count] = kept.mean_contacts[first:first + count].copy()
        kept.unfinished[0] = 0

    def write(self) -> None:
        """Write the samples of the loop to the recording; they stay in the loop, too."""
        kept, elements = self.kept, self.tables.elements
        done = int(kept.taken[1])
        n = int(kept.taken[0]) - done
        if n == 0:
            return
        arrays = {key: array[:n] for key, array in self._arrays.items()}
        of = {name: records[:n] for name, records in kept.copied.items()}
        for name in ("pose", "velocity", "acceleration"):
            arrays[f"body_{name}"][:] = getattr(kept, name)[:n]
        for key, (table, *columns) in RECORDED.items():
            number = (getattr(elements, table)[NUMBERS[table]] if table in NUMBERS
                      else slice(arrays[key].shape[1]))
            for i, column in enumerate(columns):
                values = _column(of[table], column)[:, :arrays[key].shape[1]]
                arrays[key].reshape(n, -1, len(columns))[:, number, i] = values
        self._write_joints(arrays, of)
        self._write_springs(arrays, of)
        arrays["guide_lifted"][:] = of["guides"]["lifted"][:, self.tables.constants.wheels]
        lines, fluids = of["fluids"], elements.fluids
        np.add(lines["grown"], fluids["volume"], out=arrays["line_volume"])
        # the content of a gas includes the gas at t = 0 without pressure
        own = np.where(fluids["gas"] > 0, fluids["volume"], 0.0)
        np.subtract(lines["content"], own, out=arrays["line_content"])
        arrays["line_ahead"][:] = lines["ahead"] * self.world.h
        arrays["solver_residual"][:, 0] = kept.residual[:n]
        actions, cables, pumps = elements.actions, elements.cables, elements.pumps["drive"]
        torque, work = of["actions"]["torque"], arrays["drive_work"]
        arrays["drive_value"][:] = kept.drive[:n]
        limited, runs, pulled = actions["motor"] >= 0, actions["runs"] == 1, cables["kind"] == PULL
        arrays["drive_torque"][:, actions["drive"][limited]] = torque[:, limited]
        arrays["drive_power"][:, actions["drive"][runs]] = torque[:, runs]
        work[:] = 0.0
        work[:, actions["drive"]] = _column(of["actions"], "work")
        work[:, pumps] = _column(of["pumps"], "work")
        work[:, cables["drive"][pulled]] = _column(of["cables"], "work")[:, pulled]
        self.builder.put(done, arrays)
        self._write_contacts(done, n)

    def _write_contacts(self, done: int, n: int) -> None:
        kept, order = self.kept, self.world.order
        sample = np.repeat(np.arange(done, done + n), np.diff(kept.fill[:n], prepend=0))
        self.builder.contacts.replace(
            done, *self._contact_rows(sample, kept.contacts[:kept.fill[n - 1]]).values())
        moved = np.flatnonzero(kept.steady[:n] == 0)
        if not self.builder.apart or not len(moved):
            return
        # means of samples whose intervals are complete, and had several forces
        self.builder.means.replace(done, moved + done, kept.means[moved])
        fill = kept.mean_fill[:moved[-1] + 1]
        found = kept.mean_contacts[:fill[-1]]
        numbers = found.view(np.float64).reshape(-1, 9)[:, 2:]
        self.builder.mean_contacts.replace(
            done, np.repeat(np.arange(done, done + len(fill)), np.diff(fill, prepend=0)),
            order[found["a"]], order[found["b"]], numbers / (self.every * self.world.h))

    def record_impacts(self, before: int) -> None:
        """Record the impacts of the last call of the loop, after ``before`` other steps."""
        state, order = self.tables.state, self.world.order
        found = state.impacts[:state.made[3]]
        if len(found):
            self.builder.impacts.append(
                (before + found["step"] + 0.5) * self.world.h + found["after"], order[found["a"]],
                order[found["b"]], np.stack([found["x"], found["y"]], axis=1),
                np.stack([found["px"], found["py"]], axis=1))

    def _write_joints(self, arrays: Arrays, of: dict[str, Records]) -> None:
        elements, results = self.tables.elements, of["joints"]
        np.hypot(results["fx"], results["fy"], out=arrays["joint_reaction"])
        arrays["joint_twist"][:] = np.stack(
            [results["twist_a"], results["twist_b"]], axis=-1) / self.world.h
        hinge, line = elements.joints["hinge"] == 1, elements.joints["line"] == 1
        sense, zero = elements.joints["sense"][hinge], elements.joints["zero"][hinge]
        arrays["joint_angle"][:, hinge] = sense * results["way"][:, hinge] - zero
        arrays["joint_rate"][:, hinge] = results["rate"][:, hinge]
        arrays["joint_length"][:, line] = results["way"][:, line]
        arrays["joint_speed"][:, line] = results["rate"][:, line]
        stopped = elements.joints["stopped"] == 1
        arrays["joint_stop"][:, stopped] = results["stop"][:, stopped]

    def _write_springs(self, arrays: Arrays, of: dict[str, Records]) -> None:
        joints, springs = self.model.joints, self.tables.elements.springs
        results, work = of["springs"], _column(of["springs"], "work")
        damped = springs["number"] < 0
        hinge = springs["joint"][damped]
        for name, values in (("damping", joints.sense[hinge] * results["effort"][:, damped]),
                             ("damping_work", work[:, damped])):
            arrays[f"joint_{name}"][:, joints.angle] = 0.0
            arrays[f"joint_{name}"][:, hinge] = values
        arrays["spring_work"][:, springs["number"][~damped]] = work[:, ~damped]
        straight = springs["joint"] < 0
        own = springs["number"][straight]
        arrays["spring_length"][:, own] = results["way"][:, straight]
        arrays["spring_force"][:, own] = 0.0 - results["effort"][:, straight]
        rotary = ~straight & ~damped
        own, hinge = springs["number"][rotary], springs["joint"][rotary]
        holds = held_of(self.model.bonds.joint[hinge], of["bonds"]["held"]).T
        arrays["spring_length"][:, own] = arrays["joint_angle"][:, hinge]
        arrays["spring_force"][:, own] = (
            springs["sense"][rotary] * -results["effort"][:, rotary]
            + holds * self.model.springs.damping[own] * arrays["joint_rate"][:, hinge])

    def contacts_now(self) -> Contacts:
        """The contacts of the last step, as one sample."""
        state = self.tables.state
        kept = np.zeros(state.touching[0], CONTACT)
        count = list_contacts(state.touches, len(kept), state.body, kept, 0)
        rows = self._contact_rows(np.zeros(count, dtype=np.int64), kept[:count])
        return Contacts({f"contact_{key}": column for key, column in rows.items()},
                        self.model.mechanism, 1)

    def _contact_rows(self, sample: Integers, kept: Records) -> dict[str, NDArray[Any]]:
        order = self.world.order
        normal = -np.stack([kept["nx"], kept["ny"]], axis=1)  # to the first body
        along = np.stack([kept["ny"], -kept["nx"]], axis=1)
        force = (kept["normal"][:, None] * normal + kept["tangent"][:, None] * along) / self.world.h
        return merge_contacts(
            sample, order[kept["a"]], order[kept["b"]], np.stack([kept["x"], kept["y"]], axis=1),
            force, normal, kept["normal"], kept["gap"].copy(), kept["twist"] / self.world.h)


def _column(results: Records, name: str) -> Array:
    """A column of results; work and losses [J] up to the instants of samples, in mid-step."""
    column: Array = results[name]
    return column - results[f"step_{name}"] / 2 if name in ("work", "loss") else column


class Readings:
    """Functions that read the state of one run; :meth:`Control.moved` updates it."""

    def __init__(self, world: World, sampler: Sampler, catalogue: Catalogue) -> None:
        self.world, self.model = world, world.model
        self.sampler, self.catalogue = sampler, catalogue
        self.drive: Array = np.zeros(len(self.model.drives.name))
        self.now = 0.0
        self.listed: Contacts | None = None

    def of(self, text: str) -> Read:
        """A function for a quantity, a meter or an expression; SceneError if one is not live."""
        if text.startswith("=") or ("/" in text and text not in self.catalogue):
            return closure(text, self._named, self.model.mechanism.functions)
        return self._named(text)

    def _named(self, name: str) -> Read:
        if name == "t":
            return lambda: self.now
        source = self.catalogue.find(name)
        quantity = row_of(source.kind, source.quantity)
        if not quantity.live:
            raise SceneError([Problem("quantity-not-live", f"{quoted(name)} is computed after the "
                                      "run and cannot be read during it", name)])
        if source.kind == "solver":
            return _item(self.sampler.tables.state.accuracy, 0)
        if source.quantity in BOND_QUANTITIES:
            number = self.model.bonds.of(source.kind)[source.index]
            return _item(self.sampler.tables.elements.bonds["held"], int(number))
        if place := RECORDED.get(quantity.array):
            return self._result(place[0], place[1 + (quantity.component or 0)], source.index)
        read: Callable[[Source], Read] = getattr(self, f"_{source.kind}")
        return read(source)

    def _result(self, table: str, column: str, index: int) -> Read:
        records = getattr(self.sampler.tables.elements, table)
        if key := NUMBERS.get(table):
            index = int(np.flatnonzero(records[key] == index)[0])
        return _item(records[column], index)

    def _meter(self, source: Source) -> Read:
        mechanism, half = self.model.mechanism, self.model.mechanism.run.step / 2

        def named(name: str) -> Read:  # the time is that of a sample, as in recordings
            return (lambda: max(self.now - half, 0.0)) if name == "t" else self._named(name)

        return closure(mechanism.meters[source.index].value, named, mechanism.functions)

    def _drive(self, source: Source) -> Read:
        if source.quantity == "value":
            return lambda: self.drive.item(source.index)
        return self._result("actions", "torque", source.index)

    def _body(self, source: Source) -> Read:
        index, state, quantity = source.index, self.sampler.tables.state, source.quantity
        n, item = int(self.world.number[index]), state.body.item
        mean = self.sampler.tables.result.before.item
        cx, cy = self.model.bodies.centre[index].tolist()
        h, row = self.world.h, row_of("body", quantity)
        j = row.component or 0
        if row.array == "body_velocity":
            return lambda: 0.5 * (item(n, 3 + j) + mean(n, j))
        if row.array == "body_acceleration":
            return lambda: (item(n, 3 + j) - mean(n, j)) / h
        if row.array:
            return (lambda: item(n, 0) - math.cos(item(n, 2)) * cx + math.sin(item(n, 2)) * cy,
                    lambda: item(n, 1) - math.sin(item(n, 2)) * cx - math.cos(item(n, 2)) * cy,
                    lambda: item(n, 2))[j]
        touch = quantity.removeprefix("contact.")
        return lambda: float(self.contacts.of_body(index, touch)[0])

    def _joint(self, source: Source) -> Read:
        joints, quantity = self.model.joints, source.quantity
        fx, fy, dx, dy, way, rate = (self._result("joints", name, source.index)
                                     for name in ("fx", "fy", "dx", "dy", "way", "rate"))
        sense, zero = joints.sense[source.index].item(), joints.zero[source.index].item()

        def tension() -> float:
            """Along the line; positive if it pulls ``b`` towards ``a``."""
            size = math.hypot(fx(), fy())
            return -size if dx() * fx() + dy() * fy() > 0 else size

        return {"reaction": lambda: math.hypot(fx(), fy()), "tension": tension,
                "angle": lambda: sense * way() - zero, "length": way, "position": way,
                "rate": rate, "speed": rate}[quantity]

    def _spring(self, source: Source) -> Read:
        way, effort = (self._result("springs", name, source.index) for name in ("way", "effort"))
        if source.quantity != "angle":
            return way if source.quantity == "length" else lambda: 0.0 - effort()
        joint = self.model.springs.joint[source.index]
        return self._named(f"{self.model.joints.name[joint]}.angle")

    def _tendon(self, source: Source) -> Read:
        if at := numbered("tendon", source.quantity):
            return self._at_guide(source.index, *at)
        length = self._result("cables", "length", source.index)
        start = float(self.sampler.builder.statics["tendon_initial"][source.index])
        tendons, states = self.model.tendons, self.sampler.tables.elements.guides
        guides, radius = tendons.guides(source.index), tendons.guide_radius
        wheels = [
            (_item(states["wrap"], end), states["wrap0"][end].item(), sign * radius[end].item())
            for end, sign in ((guides.start, -1.0), (guides.stop - 1, 1.0))
            if radius[end] and not tendons.closed[source.index]]
        if not wheels:
            return lambda: start - length()
        # what wheels at its ends have wound up since t = 0 counts, too
        return lambda: start - length() + sum(r * (angle() - first) for angle, first, r in wheels)

    def _at_guide(self, tendon: int, what: str, number: int) -> Read:
        """A quantity of a guide, or the tension of a straight piece."""
        tendons, elements = self.model.tendons, self.sampler.tables.elements
        guide = int(tendons.first[tendon]) + number
        if what == "lifted":
            return _item(elements.guides["lifted"], guide)
        if what == "slip":
            return _item(elements.slips["way"], int(np.flatnonzero(tendons.grips == guide)[0]))
        piece = np.flatnonzero(tendons.stretch_tendon == tendon)[number]
        last = _item(elements.cables["tension"], tendon)
        behind = [_item(elements.slips["force"], k) for k in tendons.gripped(tendon).tolist()
                  if tendons.grips[k] > tendons.stretch_first[piece]]
        return lambda: last() - sum(force() for force in behind)

    def _line(self, source: Source) -> Read:
        grown = self._result("fluids", "grown", source.index)
        volume = float(self.model.lines.volume[source.index])
        return lambda: volume + grown()

    def _group(self, source: Source) -> Read:
        names = self.model.mechanism.groups[source.index].bodies
        members = [self.model.names.body[name] for name in names]
        quantity = source.quantity.removeprefix("contact.")
        return lambda: float(self.contacts.of_group(members, quantity)[0])

    def _pair(self, source: Source) -> Read:
        return lambda: float(self.contacts.of_pair(source.index, source.other, source.quantity)[0])

    @property
    def contacts(self) -> Contacts:
        """The contacts of the last step."""
        if self.listed is None:
            self.listed = self.sampler.contacts_now()
        return self.listed


def _item(column: Array, index: int) -> Read:
    item = column.item
    return lambda: item(index)
