"""Samples of a run, read by name: what everything after a simulation works on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from sandbox.kinds.arrays import (
    CONTACT,
    METERS,
    PER_SAMPLE,
    Arrays,
)
from sandbox.kinds.elements import NAMED
from sandbox.kinds.quantities import QUANTITIES
from sandbox.model.catalogue import Catalogue, Source
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.samples import meters
from sandbox.samples.outcome import Outcome
from sandbox.samples.stored import Stored
from sandbox.scene.mechanism import Mechanism

OLDER = ("this recording was made before joints' forces were kept as vectors: reaction_x and "
         "reaction_y have no value")
TABLES = {kind: row.one for kind, row in NAMED.items() if row.axis}
"""The tables of a recording and the kind of element each holds."""


class Columns(NamedTuple):
    """Quantities of one kind side by side."""

    names: list[str]
    units: list[str]
    values: Array
    """Shape [n, number of names]."""


class Samples(Stored):
    """What was sampled of a run, read by the names of its quantities.

    Raises:
        ValueError: arrays that are missing or do not fit the mechanism.
    """

    def __init__(
        self, mechanism: Mechanism, arrays: Mapping[str, NDArray[Any]], info: Outcome, *,
        catalogue: Catalogue | None = None, model: Model | None = None, scratch: object = None,
    ) -> None:
        """``scratch`` is kept alive as long as the samples: files that their arrays live in."""
        super().__init__(mechanism, arrays, info, model=model, scratch=scratch)
        self.catalogue = catalogue or Catalogue(mechanism)

    @property
    def notes(self) -> list[str]:
        """What a reader should know, such as meters without a value."""
        older = self.reactions.size and np.isnan(self.reactions).all()
        notes = [*self.info.notes, *([OLDER] if older else []), *self._meters[1]]
        return list(dict.fromkeys(notes))

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

    def table(self, kind: str) -> Columns:
        """All quantities of one of :data:`TABLES`, such as ``tendons``; fixed bodies are left out.

        Raises:
            KeyError: another kind.
        """
        wanted, names, units, columns = TABLES[kind], [], [], []
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
        return Columns(names, units, values)

    def part(self, first: int, last: int) -> Self:
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
        return type(self)(self.mechanism, arrays, self.info, catalogue=self.catalogue,
                          model=self._model, scratch=self._scratch)

    def pick(self, samples: Integers) -> Self:
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
        return type(self)(self.mechanism, arrays, self.info, catalogue=self.catalogue,
                          model=self._model)

    def parts(self, samples: int) -> Iterator[Self]:
        """The recording in pieces of at most so many samples, in order."""
        for first in range(0, len(self), samples):
            yield self.part(first, min(first + samples, len(self)))

    def with_meters(self) -> Arrays:
        """All arrays, the meters among them as ``meter_value`` [n, meters] if there are any."""
        return {**self.arrays, METERS: self._meters[0]} if self.mechanism.meters else self.arrays

    @property
    def reactions(self) -> Array:
        """Force of every joint on its body ``b`` in the world [N], [n, nj, 2].

        nan in recordings from before it was kept; :attr:`notes` says so.
        """
        return self.arrays["joint_force"]

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
        elif quantity == "shortening":
            result = self.arrays["tendon_initial"][index] - self.arrays["tendon_length"][:, index]
        else:
            row = QUANTITIES[kind][quantity]
            stored = self.arrays[row.array][:, index]
            result = stored if row.component is None else stored[:, row.component]
        result.setflags(write=False)
        return result

    def _members(self, group: int) -> list[int]:
        elements = self.catalogue.elements
        found = (elements.get(name) for name in self.mechanism.groups[group].bodies)
        return [e.index for e in found if e is not None and e.kind == "body"]
