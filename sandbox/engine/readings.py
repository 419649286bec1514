"""What controllers and conditions read: quantities of the running mechanism, one number each.

After step k a reading is that of step k alone, as in a recording of every step. Before the
first step, forces and tensions read 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sandbox.elements.quantities import TIED, is_live, numbered
from sandbox.engine.sampler import Sampler
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.model.catalogue import Catalogue, Source
from sandbox.numeric import Array
from sandbox.samples.contacts import Contacts
from sandbox.values.expressions import Read, closure

FORCE = {"reaction_x": "fx", "reaction_y": "fy"}
"""Where the last step keeps these quantities of a joint."""
RUBBED = {"friction": "force", "sticks": "sticks"}
"""The same of those of its dry friction."""


class Readings:
    """Makes functions that read the state of one run.

    ``now`` is the instant [s], ``drive`` [nd] the drives' values in the last step, ``listed``
    its contacts once somebody asked for them. The owner of the loop sets them after every
    block of steps.
    """

    def __init__(
        self, world: World, tables: Tables, sampler: Sampler, catalogue: Catalogue,
    ) -> None:
        self.world, self.tables, self.model = world, tables, world.model
        self.sampler, self.catalogue = sampler, catalogue
        self.drive: Array = np.zeros(len(self.model.drives.name))
        self.now = 0.0
        self.listed: Contacts | None = None

    def of(self, text: str) -> Read:
        """A function for a quantity, a meter or an expression of them.

        Raises:
            UnknownQuantityError: a name that is not in the catalogue.
            WrongValueError: not an expression.
            KeyError: a quantity that is not live (:func:`sandbox.elements.quantities.is_live`).
        """
        if text.startswith("=") or ("/" in text and text not in self.catalogue):
            return closure(text, self._named, self.model.mechanism.functions)
        return self._named(text)

    def _named(self, name: str) -> Read:
        if name == "t":
            return lambda: self.now
        source = self.catalogue.find(name)
        if not is_live(source.kind, source.quantity):
            raise KeyError(name)
        if source.quantity in TIED:
            return self._tie(source)
        kinds: dict[str, Callable[[Source], Read]] = {
            "body": self._body, "joint": self._joint, "spring": self._spring,
            "tendon": self._tendon, "line": self._line, "valve": self._valve,
            "load": self._load, "drive": self._drive, "group": self._group, "pair": self._pair,
            "meter": self._meter,
        }
        return kinds[source.kind](source)

    def _meter(self, source: Source) -> Read:
        mechanism = self.model.mechanism
        return closure(mechanism.meters[source.index].value, self._sampled, mechanism.functions)

    def _sampled(self, name: str) -> Read:
        """As :meth:`_named`, but the time is that of a sample, as it is in what is recorded."""
        half = self.model.mechanism.run.step / 2
        return (lambda: max(self.now - half, 0.0)) if name == "t" else self._named(name)

    def _tie(self, source: Source) -> Read:
        number = self.model.ties.of(source.kind)[source.index]
        return _item(self.tables.state.ties["held"], int(number))

    def _drive(self, source: Source) -> Read:
        index, constants, result = source.index, self.tables.constants, self.tables.result
        if source.quantity == "flow":
            return _item(result.pumps["flow"], int(np.flatnonzero(
                constants.pumps["drive"] == index)[0]))
        if source.quantity in ("torque", "force"):
            actions = constants.actions
            row = int(np.flatnonzero((actions["drive"] == index) & (actions["motor"] >= 0))[0])
            sense, given = float(actions["sense"][row]), _item(result.actions["torque"], row)
            return lambda: sense * given()
        return lambda: self.drive.item(index)

    def _body(self, source: Source) -> Read:
        index, state = source.index, self.tables.state
        n, item = int(self.world.number[index]), state.body.item
        mean = self.tables.result.before.item
        cx, cy = self.model.bodies.centre[index].tolist()
        rates, gains = {"vx": 0, "vy": 1, "omega": 2}, {"ax": 0, "ay": 1, "alpha": 2}
        if source.quantity in rates:
            j = rates[source.quantity]
            return lambda: 0.5 * (item(n, 3 + j) + mean(n, j))
        if source.quantity in gains:
            j, h = gains[source.quantity], self.world.h
            return lambda: (item(n, 3 + j) - mean(n, j)) / h
        if source.quantity == "angle":
            return lambda: item(n, 2)
        if source.quantity == "x":
            return lambda: item(n, 0) - math.cos(item(n, 2)) * cx + math.sin(item(n, 2)) * cy
        if source.quantity == "y":
            return lambda: item(n, 1) - math.sin(item(n, 2)) * cx - math.cos(item(n, 2)) * cy
        touch = source.quantity.removeprefix("contact.")
        return lambda: float(self.contacts.of_body(index, touch)[0])

    def _joint(self, source: Source) -> Read:
        joints, state, index = self.model.joints, self.tables.state, source.index
        if source.quantity == "reaction":
            force = self.tables.result.joints
            x, y = _item(force["fx"], index), _item(force["fy"], index)
            return lambda: math.hypot(x(), y())
        if source.quantity in FORCE:
            return _item(self.tables.result.joints[FORCE[source.quantity]], index)
        if source.quantity == "tension":
            return self._link(index)
        if source.quantity == "length":
            return _item(self.tables.result.joints["way"], index)
        if source.quantity in RUBBED:
            row = int(np.searchsorted(self.tables.constants.dry_friction["joint"], index))
            rubs = self.tables.result.dry_friction
            return _item(rubs[RUBBED[source.quantity]], row) if row < len(rubs) else lambda: 0.0
        a, b = self.world.number[joints.bodies[index]].tolist()
        if source.quantity == "speed":
            return self._speed(index, a, b)
        sense, zero = joints.sense[index].item(), joints.zero[index].item()
        item, mean = state.body.item, self.tables.result.before.item
        if source.quantity == "angle":
            return lambda: sense * (item(b, 2) - item(a, 2)) - zero
        return lambda: 0.5 * sense * (item(b, 5) + mean(b, 2) - item(a, 5) - mean(a, 2))

    def _link(self, joint: int) -> Read:
        """Tension of a joint along a line: its force on ``b``, positive towards ``a``."""
        fx, fy, dx, dy = (_item(self.tables.result.joints[name], joint)
                          for name in ("fx", "fy", "dx", "dy"))

        def tension() -> float:
            size = math.hypot(fx(), fy())
            return -size if dx() * fx() + dy() * fy() > 0 else size

        return tension

    def _speed(self, joint: int, a: int, b: int) -> Read:
        """At which an actuator between two bodies of pymunk's grows longer."""
        body, before = self.tables.state.body.item, self.tables.result.before.item
        dx, dy, ta, tb = (_item(self.tables.result.joints[name], joint)
                          for name in ("dx", "dy", "ta", "tb"))

        def mean(n: int, j: int) -> float:
            return 0.5 * (body(n, 3 + j) + before(n, j))

        return lambda: (dx() * (mean(b, 0) - mean(a, 0)) + dy() * (mean(b, 1) - mean(a, 1))
                        + ta() * mean(a, 2) + tb() * mean(b, 2))

    def _spring(self, source: Source) -> Read:
        springs = self.model.springs
        if source.quantity in ("length", "force"):
            rows, result = self.tables.constants.springs, self.tables.result.springs
            row = int(np.flatnonzero(rows["number"] == source.index)[0])
            if source.quantity == "length":
                return _item(result["way"], row)
            effort = _item(result["effort"], row)
            return lambda: 0.0 - effort()
        return self._named(f"{self.model.joints.name[springs.joint[source.index]]}.angle")

    def _tendon(self, source: Source) -> Read:
        cords = self.tables.result.cords
        if at := numbered("tendon", source.quantity):
            return self._at_guide(source.index, *at)
        if source.quantity == "tension":
            return _item(cords["tension"], source.index)
        length = _item(cords["length"], source.index)
        start = float(self.sampler.builder.statics["tendon_initial"][source.index])
        if source.quantity == "length":
            return length
        wound = self._wound_up(source.index)
        return (lambda: start - length() + wound()) if wound else lambda: start - length()

    def _at_guide(self, tendon: int, what: str, number: int) -> Read:
        """What a tendon has at one of its guides, or in one of its straight pieces."""
        tendons, tables = self.model.tendons, self.tables
        guide = int(tendons.first[tendon]) + number
        if what == "lifted":
            lifted = _item(tables.state.guides["lifted"], guide)
            return lambda: float(lifted())
        if what == "slip":
            return _item(tables.state.slips["way"], int(np.flatnonzero(tendons.grips == guide)[0]))
        piece = np.flatnonzero(tendons.stretch_tendon == tendon)[number]
        last = _item(tables.result.cords["tension"], tendon)
        behind = [_item(tables.result.slips["force"], k) for k in tendons.gripped(tendon).tolist()
                  if tendons.grips[k] > tendons.stretch_first[piece]]
        return lambda: last() - sum(force() for force in behind)

    def _line(self, source: Source) -> Read:
        lines = self.tables.result.fluids
        if source.quantity == "volume":
            grown, volume = _item(lines["grown"], source.index), float(
                self.model.lines.volume[source.index])
            return lambda: volume + grown()
        return _item(lines[source.quantity], source.index)

    def _valve(self, source: Source) -> Read:
        return _item(self.tables.state.valves["flow"], source.index)

    def _load(self, source: Source) -> Read:
        row = int(np.flatnonzero(self.tables.constants.loads["number"] == source.index)[0])
        return _item(self.tables.result.loads[source.quantity], row)

    def _wound_up(self, tendon: int) -> Read | None:
        """What wheels at a tendon's ends have wound up since t = 0 [m]; None without such."""
        if self.model.tendons.closed[tendon]:
            return None
        guides, states = self.model.tendons.guides(tendon), self.tables.state.guides
        radius = self.model.tendons.guide_radius
        ends = [(_item(states["wrap"], end), float(states["wrap0"][end]), float(sign * radius[end]))
                for end, sign in ((guides.start, -1.0), (guides.stop - 1, 1.0)) if radius[end]]
        return (lambda: sum(r * (angle() - start) for angle, start, r in ends)) if ends else None

    def _group(self, source: Source) -> Read:
        names = self.model.mechanism.groups[source.index].bodies
        members = [self.model.names.body[name] for name in names]
        quantity = source.quantity.removeprefix("contact.")
        return lambda: float(self.contacts.of_group(members, quantity)[0])

    def _pair(self, source: Source) -> Read:
        return lambda: float(self.contacts.of_pair(
            source.index, source.other, source.quantity)[0])

    @property
    def contacts(self) -> Contacts:
        """The contacts of the last step."""
        if self.listed is None:
            self.listed = self.sampler.contacts_now()
        return self.listed


def _item(column: Array, index: int) -> Read:
    item = column.item
    return lambda: item(index)

