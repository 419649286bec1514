"""The Recording: what a run leaves behind. Everything after simulation reads only this."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from sandbox.recording import meters
from sandbox.recording.arrays import (
    CONTACT,
    LAYOUT,
    METERS,
    PER_SAMPLE,
    Array,
    Arrays,
    Integers,
    dtype_of,
    faults,
)
from sandbox.recording.contacts import Contacts
from sandbox.recording.quantities import Catalogue, Source
from sandbox.scene.mechanism import Mechanism

_COLUMN: dict[tuple[str, str], tuple[str, int | None]] = {
    ("body", "x"): ("body_pose", 0), ("body", "y"): ("body_pose", 1),
    ("body", "angle"): ("body_pose", 2),
    ("body", "vx"): ("body_velocity", 0), ("body", "vy"): ("body_velocity", 1),
    ("body", "omega"): ("body_velocity", 2),
    ("body", "ax"): ("body_acceleration", 0), ("body", "ay"): ("body_acceleration", 1),
    ("body", "alpha"): ("body_acceleration", 2),
    ("joint", "angle"): ("joint_angle", None), ("joint", "rate"): ("joint_rate", None),
    ("joint", "reaction"): ("joint_reaction", None), ("joint", "stop"): ("joint_stop", None),
    ("joint", "damping"): ("joint_damping", None),
    ("spring", "work"): ("spring_work", None), ("tendon", "work"): ("tendon_work", None),
    ("drive", "work"): ("drive_work", None),
    ("joint", "damping_work"): ("joint_damping_work", None),
    ("spring", "length"): ("spring_length", None), ("spring", "force"): ("spring_force", None),
    ("spring", "angle"): ("spring_length", None), ("spring", "torque"): ("spring_force", None),
    ("tendon", "length"): ("tendon_length", None), ("tendon", "tension"): ("tendon_tension", None),
    ("drive", "value"): ("drive_value", None), ("drive", "torque"): ("drive_torque", None),
}
"""(kind, quantity) -> the array it is kept in, and which of its last axis."""

REACTION = ("reaction_x", "reaction_y")
"""Quantities of a joint that are worked out from all others."""

KINDS = {"bodies": "body", "joints": "joint", "springs": "spring", "tendons": "tendon",
         "drives": "drive", "meters": "meter"}
"""The tables of a recording and the kind of element each holds."""


class Table(NamedTuple):
    """Quantities of one kind side by side."""

    names: list[str]
    units: list[str]
    values: Array
    """Shape [n, number of names]."""


class Recording:
    """The mechanism that was run and plain arrays, SI, nothing of the engine.

    n samples, nb bodies, nj joints, ns springs, nt tendons, nd drives, in the
    mechanism's order; m contact rows.

    * ``time`` [n]: poses and forces of a sample belong to this instant; even
      spacing; the first is not at 0, since the scheme is a leapfrog.
    * ``body_pose`` [n, nb, 3]: x, y, angle of each frame's origin; ``body_velocity`` and
      ``body_acceleration`` [n, nb, 3]: of the centre of mass. ``body_shift`` [n, nb, 3]:
      how far it was moved to take overlaps apart, after the step's forces were known.
    * ``body_centre`` [nb, 2]: centre of mass in the body's frame; ``body_mass``,
      ``body_inertia`` [nb]: about the centre, infinite for what is fixed or scheduled.
    * ``joint_angle``, ``joint_rate`` [n, nj]: nan unless a pin; ``joint_reaction`` [n, nj]:
      size of the force; ``joint_stop``, ``joint_damping`` [n, nj]: torques of the hard stop and
      of the dampers, in the joint's sense.
    * ``spring_length``, ``spring_force`` [n, ns]: positive pulls; of a rotary spring the
      hinge's angle and the torque, which is positive against a positive angle.
    * ``tendon_length``, ``tendon_tension`` [n, nt]; ``tendon_initial`` (at t = 0),
      ``tendon_rest`` [nt].
    * ``drive_value`` [n, nd] in the drive's unit; ``drive_torque`` [n, nd]: of motors and brakes,
      in the joint's sense, nan for other drives.
    * ``drive_work``, ``tendon_work``, ``spring_work``, ``joint_damping_work``: done on the bodies
      since t = 0 [J], added up in every step.
    * ``contact_sample``, ``contact_body``, ``contact_other`` [m]: one row per touching pair
      and sample, in this order; ``contact_point``, ``contact_force`` (on body by other),
      ``contact_normal`` [m, 2]; ``contact_gap`` [m]: negative where they overlap.

    The arrays are read-only. ``info`` is plain JSON data about the run.

    Raises:
        ValueError: arrays that are missing or do not fit the mechanism.
    """

    def __init__(
        self, mechanism: Mechanism, arrays: Mapping[str, NDArray[Any]], info: Mapping[str, Any],
        *, catalogue: Catalogue | None = None, scratch: object = None,
    ) -> None:
        """``scratch`` is kept alive as long as the recording: files that its arrays live in."""
        self.mechanism = mechanism
        self.arrays: Arrays = {key: _read_only(key, array) for key, array in arrays.items()}
        if found := faults(mechanism, self.arrays):
            raise ValueError("; ".join(found))
        self.info = dict(info)
        self.catalogue = catalogue or Catalogue(mechanism)
        self._scratch = scratch

    @property
    def time(self) -> Array:
        """Instants of the samples [s], shape [n]."""
        return self.arrays["time"]

    @property
    def complete(self) -> bool:
        """Whether the run came to its planned end."""
        return bool(self.info.get("complete", False))

    @property
    def notes(self) -> list[str]:
        """What a reader should know, such as meters without a value."""
        return [*self.info.get("notes", []), *self._meters[1]]

    def __len__(self) -> int:
        return len(self.time)

    def __contains__(self, name: str) -> bool:
        return name in self.catalogue

    def __getitem__(self, name: str) -> Array:
        """The quantity ``name`` over time, shape [n], in the unit that :meth:`unit` gives.

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
        """
        return self._read(self.catalogue.find(name))

    def unit(self, name: str) -> str:
        """The SI unit of a quantity, as scenes spell it (``N m``, ``rad/s``; ``1`` for counts).

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
        """
        return self.catalogue.find(name).unit

    def names(self) -> list[str]:
        """All quantities except pairs."""
        return list(self.catalogue.units)

    def match(self, pattern: str) -> list[str]:
        """The quantities that fit a pattern such as ``finger*.tension``; pairs need a ``/``."""
        return self.catalogue.match(pattern)

    def table(self, kind: str) -> Table:
        """All quantities of one of :data:`KINDS`, such as ``tendons``; fixed bodies are left out.

        Raises:
            KeyError: another kind.
        """
        wanted, names, units, columns = KINDS[kind], [], [], []
        for head, element in self.catalogue.elements.items():
            index = element.index
            if element.kind != wanted or (
                wanted == "body" and self.mechanism.bodies[index].motion == "fixed"
            ):
                continue
            for quantity, unit in element.quantities.items():
                names.append(f"{head}.{quantity}" if quantity else head)
                units.append(unit)
                columns.append(self._read(Source(wanted, index, quantity, unit)))
        values = np.column_stack(columns) if columns else np.empty((len(self), 0))
        return Table(names, units, values)

    def part(self, first: int, last: int) -> Recording:
        """Samples ``first`` to ``last - 1`` as a recording of its own; shares the memory."""
        first, last, _ = slice(first, last).indices(len(self))
        start, end = np.searchsorted(self.arrays["contact_sample"], [first, last])
        arrays = dict(self.arrays)
        arrays[METERS] = self._meters[0]
        for key in [*PER_SAMPLE, METERS]:
            arrays[key] = arrays[key][first:last]
        for key in CONTACT:
            arrays[key] = arrays[key][start:end]
        arrays["contact_sample"] = arrays["contact_sample"] - first
        return Recording(self.mechanism, arrays, self.info, catalogue=self.catalogue,
                         scratch=self._scratch)

    def pick(self, samples: Integers) -> Recording:
        """Some samples, by rising number, as a recording of its own."""
        arrays = dict(self.arrays)
        arrays[METERS] = self._meters[0]
        for key in [*PER_SAMPLE, METERS]:
            arrays[key] = arrays[key][samples]
        place = np.full(len(self), -1, dtype=np.int64)
        place[samples] = np.arange(len(samples))
        rows = place[arrays["contact_sample"]]
        kept = np.flatnonzero(rows >= 0)
        for key in CONTACT:
            arrays[key] = arrays[key][kept]
        arrays["contact_sample"] = rows[kept]
        return Recording(self.mechanism, arrays, self.info, catalogue=self.catalogue)

    def parts(self, samples: int) -> Iterator[Recording]:
        """The recording in pieces of at most so many samples, in order."""
        for first in range(0, len(self), samples):
            yield self.part(first, min(first + samples, len(self)))

    def with_meters(self) -> Arrays:
        """All arrays, the meters among them as ``meter_value`` [n, meters] if there are any."""
        return {**self.arrays, METERS: self._meters[0]} if self.mechanism.meters else self.arrays

    def save(
        self, directory: str | os.PathLike[str], *, parameters: Mapping[str, float] | None = None
    ) -> None:
        """Write all files into ``directory``; see :mod:`sandbox.recording.store`.

        Raises:
            OutputError: it cannot be written.
        """
        from sandbox.recording import store

        store.save(self, directory, parameters=parameters)

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Recording:
        """The recording that was saved into ``directory``.

        Raises:
            OutputError: there is none, or it cannot be read.
        """
        from sandbox.recording import store

        return store.load(directory)

    @cached_property
    def contacts(self) -> Contacts:
        """The contact rows, for sums by body, pair and group."""
        return Contacts(self.arrays, samples=len(self), bodies=len(self.mechanism.bodies))

    @cached_property
    def reactions(self) -> Array:
        """Force of every joint on its body ``b`` in the world [N], [n, nj, 2].

        From the balance of the bodies, :mod:`sandbox.recording.reactions`; nan
        where that does not decide it.
        """
        from sandbox.recording.reactions import joint_reactions

        return joint_reactions(self)

    @cached_property
    def _meters(self) -> tuple[Array, list[str]]:
        if METERS in self.arrays:
            return self.arrays[METERS], []
        return meters.evaluate(self.mechanism, read=self.__getitem__, time=self.time)

    def _read(self, source: Source) -> Array:
        kind, index, quantity = source.kind, source.index, source.quantity
        if kind == "meter":
            result = self._meters[0][:, index]
        elif kind == "pair":
            result = self.contacts.of_pair(index, source.other, quantity)
        elif kind == "group":
            result = self.contacts.of_group(self._members(index), quantity.removeprefix("contact."))
        elif quantity.startswith("contact."):
            result = self.contacts.of_body(index, quantity.removeprefix("contact."))
        elif kind == "joint" and quantity in REACTION:
            result = self.reactions[:, index, REACTION.index(quantity)]
        elif quantity == "shortening":
            result = self.arrays["tendon_initial"][index] - self.arrays["tendon_length"][:, index]
        else:
            key, component = _COLUMN[kind, quantity]
            stored = self.arrays[key][:, index]
            result = stored if component is None else stored[:, component]
        result.setflags(write=False)
        return result

    def _members(self, group: int) -> list[int]:
        elements = self.catalogue.elements
        found = (elements.get(name) for name in self.mechanism.groups[group].bodies)
        return [e.index for e in found if e is not None and e.kind == "body"]


def _read_only(key: str, array: NDArray[Any]) -> NDArray[Any]:
    known = key in LAYOUT or key == METERS
    view = np.asarray(array, dtype=dtype_of(key) if known else None).view()
    view.setflags(write=False)
    return view
