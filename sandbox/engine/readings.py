"""Quantities of the running simulation, read by controllers and conditions, one number each.

Readings are those of the last step, as in a recording of every step. Before the first step forces
and tensions are 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sandbox.elements.quantities import BOND_QUANTITIES, is_live, numbered
from sandbox.engine.sampler import NUMBERS, RECORDED, Sampler
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.model.catalogue import Catalogue, Source
from sandbox.numeric import Array
from sandbox.samples.contacts import Contacts
from sandbox.values.expressions import Read, closure

RESULTS: dict[tuple[str, str], tuple[str, str]] = {
    ("joint", "reaction_x"): ("joints", "fx"), ("joint", "reaction_y"): ("joints", "fy"),
    ("joint", "length"): ("joints", "way"), ("joint", "position"): ("joints", "way"),
    ("spring", "length"): ("springs", "way"), ("load", "fx"): ("loads", "fx"),
    ("load", "fy"): ("loads", "fy"),
    **{(kind, quantity): place for key, place in RECORDED.items()
       for kind, _, quantity in [key.partition("_")]}}
"""Quantities that are results of the last step: their table and column."""


class Readings:
    """Functions that read the state of one run; :meth:`Control.moved` updates it."""

    def __init__(
        self, world: World, tables: Tables, sampler: Sampler, catalogue: Catalogue,
    ) -> None:
        self.world, self.tables, self.model = world, tables, world.model
        self.sampler, self.catalogue = sampler, catalogue
        self.drive: Array = np.zeros(len(self.model.drives.name))
        self.now = 0.0
        self.listed: Contacts | None = None

    def of(self, text: str) -> Read:
        """A function for a quantity, a meter or an expression; KeyError if it is not live."""
        if text.startswith("=") or ("/" in text and text not in self.catalogue):
            return closure(text, self._named, self.model.mechanism.functions)
        return self._named(text)

    def _named(self, name: str) -> Read:
        if name == "t":
            return lambda: self.now
        source = self.catalogue.find(name)
        if not is_live(source.kind, source.quantity):
            raise KeyError(name)
        if source.quantity in BOND_QUANTITIES:
            number = self.model.bonds.of(source.kind)[source.index]
            return _item(self.tables.elements.bonds["held"], int(number))
        if place := RESULTS.get((source.kind, source.quantity)):
            return self._result(*place, source.index)
        read: Callable[[Source], Read] = getattr(self, f"_{source.kind}")
        return read(source)

    def _result(self, table: str, column: str, index: int) -> Read:
        """A result of an element."""
        records = getattr(self.tables.elements, table)
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
        actions = self.tables.elements.actions
        row = int(np.flatnonzero((actions["drive"] == source.index) & (actions["motor"] >= 0))[0])
        sense, given = float(actions["sense"][row]), self._result("actions", "torque", row)
        return lambda: sense * given()

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
        joints, index = self.model.joints, source.index
        a, b = self.world.number[joints.bodies[index]].tolist()
        item, mean = self.tables.state.body.item, self.tables.result.before.item
        fx, fy, dx, dy, ta, tb = (_item(self.tables.elements.joints[name], index)
                                  for name in ("fx", "fy", "dx", "dy", "ta", "tb"))
        sense, zero = joints.sense[index].item(), joints.zero[index].item()

        def tension() -> float:
            """Along the line; positive if it pulls ``b`` towards ``a``."""
            size = math.hypot(fx(), fy())
            return -size if dx() * fx() + dy() * fy() > 0 else size

        def rate(n: int, j: int) -> float:
            return 0.5 * (item(n, 3 + j) + mean(n, j))

        def speed() -> float:
            """Rate of the length of an actuator."""
            return (dx() * (rate(b, 0) - rate(a, 0)) + dy() * (rate(b, 1) - rate(a, 1))
                    + ta() * mean(a, 2) + tb() * mean(b, 2))

        return {
            "reaction": lambda: math.hypot(fx(), fy()), "tension": tension, "speed": speed,
            "angle": lambda: sense * (item(b, 2) - item(a, 2)) - zero,
            "rate": lambda: 0.5 * sense * (item(b, 5) + mean(b, 2) - item(a, 5) - mean(a, 2)),
        }[source.quantity]

    def _spring(self, source: Source) -> Read:
        if source.quantity == "force":
            effort = self._result("springs", "effort", source.index)
            return lambda: 0.0 - effort()
        joint = self.model.springs.joint[source.index]
        return self._named(f"{self.model.joints.name[joint]}.angle")

    def _tendon(self, source: Source) -> Read:
        if at := numbered("tendon", source.quantity):
            return self._at_guide(source.index, *at)
        length = self._result("cables", "length", source.index)
        start = float(self.sampler.builder.statics["tendon_initial"][source.index])
        wound = self._wound_up(source.index)
        return (lambda: start - length() + wound()) if wound else lambda: start - length()

    def _at_guide(self, tendon: int, what: str, number: int) -> Read:
        """A quantity of a guide, or the tension of a straight piece."""
        tendons, elements = self.model.tendons, self.tables.elements
        guide = int(tendons.first[tendon]) + number
        if what == "lifted":
            lifted = _item(elements.guides["lifted"], guide)
            return lambda: float(lifted())
        if what == "slip":
            slip = int(np.flatnonzero(tendons.grips == guide)[0])
            return _item(elements.slips["way"], slip)
        piece = np.flatnonzero(tendons.stretch_tendon == tendon)[number]
        last = _item(elements.cables["tension"], tendon)
        behind = [_item(elements.slips["force"], k) for k in tendons.gripped(tendon).tolist()
                  if tendons.grips[k] > tendons.stretch_first[piece]]
        return lambda: last() - sum(force() for force in behind)

    def _line(self, source: Source) -> Read:
        grown = self._result("fluids", "grown", source.index)
        volume = float(self.model.lines.volume[source.index])
        return lambda: volume + grown()

    def _wound_up(self, tendon: int) -> Read | None:
        """Length that wheels at a tendon's ends have wound up since t = 0 [m]; None without any."""
        if self.model.tendons.closed[tendon]:
            return None
        guides, states = self.model.tendons.guides(tendon), self.tables.elements.guides
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

