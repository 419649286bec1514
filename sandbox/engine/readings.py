"""What controllers and conditions read: quantities of the running mechanism, one number each.

After step k a reading is what a sample of step k would record. Before the
first step, forces and tensions read 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sandbox.engine.sampler import Sampler
from sandbox.engine.tables import Tables
from sandbox.engine.world import World
from sandbox.kinds.quantities import LIVE
from sandbox.model.catalogue import Catalogue, Source
from sandbox.samples.contacts import Contacts
from sandbox.scene.elements.drives import BrakeDrive, StiffnessDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.elements.springs import RotarySpring
from sandbox.scene.geometry import joint_angle_sign
from sandbox.scene.values.closures import Read, closure

Array = NDArray[np.float64]


class Readings:
    """Makes functions that read the state of one run.

    ``now`` is the instant [s], ``drive`` [nd] the drives' values in the last step, ``before``
    [nb, 3] the velocities that it began with, ``listed`` its contacts once somebody
    asked for them. The owner of the loop sets them after every block of steps.
    """

    def __init__(
        self, world: World, tables: Tables, before: Array, sampler: Sampler, catalogue: Catalogue,
    ) -> None:
        self.world, self.tables, self.before = world, tables, before
        self.sampler, self.catalogue = sampler, catalogue
        self.drive: Array = np.zeros(len(world.mechanism.drives))
        self.now = 0.0
        self.listed: Contacts | None = None

    def of(self, text: str) -> Read:
        """A function for a quantity, a meter or an expression of them.

        Raises:
            UnknownQuantityError: a name that is not in the catalogue.
            WrongValueError: not an expression.
            KeyError: a quantity that is not in :data:`sandbox.kinds.quantities.LIVE`.
        """
        if text.startswith("=") or ("/" in text and text not in self.catalogue):
            return closure(text, self._named)
        return self._named(text)

    def _named(self, name: str) -> Read:
        if name == "t":
            return lambda: self.now
        source = self.catalogue.find(name)
        if source.quantity not in LIVE[source.kind]:
            raise KeyError(name)
        kinds: dict[str, Callable[[Source], Read]] = {
            "body": self._body, "joint": self._joint, "spring": self._spring,
            "tendon": self._tendon, "drive": self._drive, "group": self._group,
            "pair": self._pair, "meter": self._meter,
        }
        return kinds[source.kind](source)

    def _meter(self, source: Source) -> Read:
        return closure(self.world.mechanism.meters[source.index].value, self._named)

    def _drive(self, source: Source) -> Read:
        index = source.index
        if isinstance(self.world.mechanism.drives[index], StiffnessDrive | BrakeDrive):
            return lambda: max(self.drive.item(index), 0.0)  # below 0 counts as 0
        return lambda: self.drive.item(index)

    def _body(self, source: Source) -> Read:
        world, index = self.world, source.index
        name = world.mechanism.bodies[index].name
        n, item, mean = world.number[name], world.state.item, self.before.item
        cx, cy = world.mass[name].centre if name in world.mass else (0.0, 0.0)
        rates = {"vx": 0, "vy": 1, "omega": 2}
        if source.quantity in rates:
            j = rates[source.quantity]
            return lambda: 0.5 * (item(n, 3 + j) + mean(n, j))
        if source.quantity == "angle":
            return lambda: item(n, 2)
        if source.quantity == "x":
            return lambda: item(n, 0) - math.cos(item(n, 2)) * cx + math.sin(item(n, 2)) * cy
        if source.quantity == "y":
            return lambda: item(n, 1) - math.sin(item(n, 2)) * cx - math.cos(item(n, 2)) * cy
        return lambda: float(self.contacts.of_body(index, "normal")[0])

    def _joint(self, source: Source) -> Read:
        world = self.world
        joint = world.mechanism.joints[source.index]
        if source.quantity == "reaction":
            constraint, h = world.reactions[source.index], world.h
            return lambda: constraint.impulse / h
        assert isinstance(joint, Pin)  # the catalogue gives angles to pins only
        a, b, sign = world.number[joint.a], world.number[joint.b], joint_angle_sign(joint)
        item, mean, zero = world.state.item, self.before.item, joint.zero
        if source.quantity == "angle":
            return lambda: sign * (item(b, 2) - item(a, 2)) - zero
        return lambda: 0.5 * sign * (item(b, 5) + mean(b, 2) - item(a, 5) - mean(a, 2))

    def _spring(self, source: Source) -> Read:
        if source.quantity in ("length", "force"):
            column = self.tables.springs[source.quantity]
            return _item(column, self.tables.linear.index(source.index))
        spring = self.world.mechanism.springs[source.index]
        assert isinstance(spring, RotarySpring)  # the catalogue gives it an angle
        return self._named(f"{spring.joint}.angle")

    def _tendon(self, source: Source) -> Read:
        spans = self.tables.spans
        if source.quantity == "tension":
            return _item(spans["tension"], source.index)
        length, start = _item(spans["length"], source.index), float(spans["length"][source.index])
        return length if source.quantity == "length" else lambda: start - length()

    def _group(self, source: Source) -> Read:
        names = self.world.mechanism.groups[source.index].bodies
        places = {body.name: i for i, body in enumerate(self.world.mechanism.bodies)}
        members = [places[name] for name in names]
        quantity = source.quantity.removeprefix("contact.")
        return lambda: float(self.contacts.of_group(members, quantity)[0])

    def _pair(self, source: Source) -> Read:
        return lambda: float(self.contacts.of_pair(source.index, source.other, "normal")[0])

    @property
    def contacts(self) -> Contacts:
        """The contacts of the last step."""
        if self.listed is None:
            self.listed = self.sampler.contacts_now()
        return self.listed


def _item(column: Array, index: int) -> Read:
    item = column.item
    return lambda: item(index)

