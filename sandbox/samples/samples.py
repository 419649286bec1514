"""Samples of a run, read by name: the input of everything after a simulation."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property, partial
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import CONTACT, MEAN, MEAN_CONTACT, METERS, PER_SAMPLE, Arrays, checked
from sandbox.elements.element import NAMED
from sandbox.elements.quantities import BOND_QUANTITIES, GRASP, QUANTITIES, numbered
from sandbox.model import meters
from sandbox.model.catalogue import Catalogue, MixedUnitsError, Source, UnknownQuantityError
from sandbox.model.compile import compile_mechanism
from sandbox.model.joints import link_tensions, normal_in_slot, of_wheels, slot_length
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.samples.cables import Frames, piece_tensions, wound_up
from sandbox.samples.contacts import Contacts, mean_arrays, mean_contact_rows
from sandbox.samples.grasps import MEASURES, STIFFNESS, Grasp
from sandbox.samples.loads import Loads
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import is_pattern, listed

OLDER = ("this recording has no directions of forces; pymunk and older versions give none: "
         "reaction_x and reaction_y have no value")
TIME = "time"  # What Samples.time is called, unless something of the mechanism has this name
TABLES = {kind: row.one for kind, row in NAMED.items() if row.axis}  # and what each holds


class Columns(NamedTuple):
    """Quantities of one kind side by side."""

    names: list[str]
    units: list[str]
    values: Array  # Shape [n, number of names]


class Samples:
    """The samples of a run, read by the names of its quantities.

    ``arrays`` are read-only, SI; :data:`sandbox.elements.arrays.ARRAYS` has their names, shapes and
    meanings. ``info`` says how the run ended and how it was computed. ``model`` is the compiled
    mechanism, if it is known.

    Raises:
        ValueError: arrays that are missing or do not fit the mechanism.
    """

    def __init__(
        self, mechanism: Mechanism, arrays: Mapping[str, NDArray[Any]], info: Outcome, *,
        catalogue: Catalogue | None = None, model: Model | None = None,
    ) -> None:
        self.mechanism: Mechanism = mechanism
        self.info = info
        self.arrays: Arrays = checked(mechanism, arrays)
        self._model = model
        self.catalogue = catalogue or Catalogue(mechanism)
        self._grasps: dict[int, Grasp] = {}
        self._means: Arrays = {}

    @property
    def time(self) -> Array:
        """Instants of the samples [s], shape [n]."""
        return self.arrays["time"]

    @property
    def complete(self) -> bool:
        """Whether the run came to its planned end."""
        return self.info.complete

    def __len__(self) -> int:
        return len(self.time)

    @property
    def model(self) -> Model:
        """The compiled mechanism."""
        if self._model is None:
            self._model = compile_mechanism(self.mechanism)
        return self._model

    @cached_property
    def contacts(self) -> Contacts:
        """The contact rows, for sums by body, pair and group."""
        return Contacts(self.arrays, self.mechanism, len(self))

    @property
    def notes(self) -> list[str]:
        """Notes for the reader, such as on meters without a value."""
        force = self.arrays["joint_force"]
        older = force.size and np.isnan(force).all()
        notes = [*self.info.notes, *broken(self), *ended(self), *stalled(self),
                 *([OLDER] if older else []), *self._meters[1]]
        return list(dict.fromkeys(notes))

    def __contains__(self, name: str) -> bool:
        return name in self.catalogue or name == TIME or bool(self.match(name))

    def __getitem__(self, name: str) -> Array:
        """The quantity ``name`` over time, shape [n], in the unit that :meth:`unit` gives.

        ``time`` is :attr:`time`. A pattern such as ``finger.*.angle`` gives a column for each of
        the quantities that :meth:`names` lists for it, shape [n, number of them].

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
            MixedUnitsError: a pattern that fits quantities of several units.
        """
        if name not in self.catalogue:
            if name == TIME:
                return self.time
            if is_pattern(name):
                self.unit(name)
                return np.column_stack([self[each] for each in self.names(name)])
        return self._read(self.catalogue.find(name))

    def within(self, name: str, chosen: slice) -> Array:
        """The quantity ``name`` in the chosen samples only, shape [k].

        Costly quantities are calculated in these samples, not in all: see :meth:`Grasp.stiffness`.

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
        """
        if name in self.catalogue:
            source = self.catalogue.find(name)
            if source.kind == "body" and source.quantity in STIFFNESS:
                return self.grasp(source.index).stiffness(source.quantity, chosen)
        return self[name][chosen]

    def unit(self, name: str) -> str:
        """The SI unit of a quantity, as scenes spell it (``N m``, ``rad/s``; ``1`` for counts).

        Raises:
            UnknownQuantityError: not in the catalogue; with a near miss.
            MixedUnitsError: a pattern that fits quantities of several units.
        """
        if name not in self.catalogue:
            if name == TIME:
                return "s"
            if is_pattern(name):
                units = dict.fromkeys(map(self.unit, self.names(name)))
                if len(units) > 1:
                    raise MixedUnitsError(
                        f"{name!r} fits quantities of {len(units)} units ({listed(units)}), which "
                        "make no array: read those of one unit, such as '*.angle', or a table with "
                        "to_pandas()")
                return next(iter(units))
        return self.catalogue.find(name).unit

    def names(self, pattern: str = "") -> list[str]:
        """All quantities except pairs, or those that fit a pattern, as :meth:`match` finds them.

        Raises:
            UnknownQuantityError: no quantity fits the pattern; with a near miss.
        """
        if not pattern:
            return list(self.catalogue.units)
        if found := self.match(pattern) or [TIME] * (pattern == TIME):
            return found
        raise UnknownQuantityError(pattern, self.catalogue.near(pattern),
                                   self.catalogue.lacking(pattern))

    def match(self, pattern: str) -> list[str]:
        """The quantities that fit a pattern such as ``finger*.tension``; pairs need a ``/``."""
        return self.catalogue.match(pattern)

    def table(self, kind: str) -> Columns:
        """All quantities of one of :data:`TABLES`, such as ``tendons``; fixed bodies are left out.

        So are grasp qualities, which are computed only when they are read.

        Raises:
            KeyError: another kind.
        """
        wanted, bodies = TABLES[kind], self.mechanism.bodies
        shown = [(head, Source(wanted, each.index, quantity, unit))
                 for head, each in self.catalogue.elements.items() if each.kind == wanted
                 and not (wanted == "body" and bodies[each.index].motion == "fixed")
                 for quantity, unit in each.quantities.items()
                 if not (wanted == "body" and quantity in GRASP)]
        columns = [self._read(source) for _, source in shown]
        return Columns([f"{head}.{source.quantity}".removesuffix(".") for head, source in shown],
                       [source.unit for _, source in shown],
                       np.column_stack(columns) if shown else np.empty((len(self), 0)))

    def part(self, first: int, last: int) -> Self:
        """Samples ``first`` to ``last - 1`` as a recording of its own; shares the memory."""
        first, last, _ = slice(first, last).indices(len(self))
        return self.pick(slice(first, max(first, last)))

    def pick(self, samples: slice | Integers) -> Self:
        """Some samples, by rising number, as a recording of its own."""
        arrays = {**self.arrays, METERS: self._meters[0]}
        for key in [*PER_SAMPLE, METERS]:
            arrays[key] = arrays[key][samples]
        means = [MEAN, MEAN_CONTACT] if "mean_sample" in self.arrays else []
        for of, *rest in (CONTACT, *means):  # the sample's number is the first of each
            numbers, kept = self.arrays[of], samples
            if isinstance(samples, slice):
                kept = slice(*np.searchsorted(numbers, [samples.start, samples.stop]))
                arrays[of] = numbers[kept] - samples.start
            else:
                kept = np.flatnonzero(np.isin(numbers, samples))
                arrays[of] = np.searchsorted(samples, numbers[kept])
            arrays |= {key: self.arrays[key][kept] for key in rest}
        return self.with_arrays(arrays)

    def with_arrays(self, arrays: Arrays) -> Self:
        """A recording of the same run with other arrays."""
        return type(self)(self.mechanism, arrays, self.info, catalogue=self.catalogue,
                          model=self._model)

    def means(self, *keys: str) -> Arrays:
        """The arrays, those of ``keys`` with means over sample intervals for forces of a step."""
        self._means |= mean_arrays(self.arrays, set(keys) - self._means.keys())
        return self.arrays | self._means

    @cached_property
    def mean_contacts(self) -> Contacts:
        """The contact rows as means over sample intervals."""
        return Contacts(mean_contact_rows(self.arrays), self.mechanism, len(self))

    def with_meters(self) -> Arrays:
        """All arrays, the meters among them as ``meter_value`` [n, meters] if there are any."""
        return {**self.arrays, METERS: self._meters[0]} if self.mechanism.meters else self.arrays

    @cached_property
    def _meters(self) -> tuple[Array, list[str]]:
        if METERS in self.arrays:
            return self.arrays[METERS], []
        return meters.evaluate(self.mechanism, read=self.__getitem__, time=self.time)

    def _read(self, source: Source) -> Array:
        kind, index, quantity = source.kind, source.index, source.quantity
        if kind == "meter":
            result = self._meters[0][:, index]
        elif kind == "body" and quantity in GRASP:
            result = MEASURES[quantity](self.grasp(index))
        elif kind == "pair":
            result = self.mean_contacts.of_pair(index, source.other, quantity)
        elif kind == "group":
            members = [self.catalogue.elements[name].index
                       for name in self.mechanism.groups[index].bodies]
            what = quantity.removeprefix("contact.")
            contacts = self.contacts if what == "count" else self.mean_contacts
            result = contacts.of_group(members, what)
        elif quantity.startswith("contact."):
            result = self.mean_contacts.of_body(index, quantity.removeprefix("contact."))
        elif quantity in BOND_QUANTITIES:
            result = self.arrays["held"][:, self.model.bonds.of(kind)[index]]
        elif kind == "drive" and quantity == "power":
            result = self._power(index)
        elif quantity == "shortening":
            tendons, a = self.model.tendons, self.arrays
            result = a["tendon_initial"][index] - a["tendon_length"][:, index]
            radii = tendons.guide_radius[tendons.guides(index)]
            if not tendons.closed[index] and (radii[0] or radii[-1]):
                result = result + wound_up(Frames(self.model, self.arrays), index)
        elif kind == "joint" and quantity == "tension":
            result = link_tensions(
                self.model, self.means("joint_force", "joint_reaction"), np.array([index]))[:, 0]
        elif kind == "joint" and not QUANTITIES[kind][quantity].array:
            of = normal_in_slot if quantity == "normal" else partial(of_wheels, quantity=quantity)
            result = of(self.model, self.means("joint_force"), index)
        elif at := numbered(kind, quantity):
            (what, number), tendons = at, self.model.tendons
            guide = int(tendons.first[index]) + number
            if what == "tension":
                arrays = self.means("tendon_tension", "guide_friction")
                result = piece_tensions(
                    self.model, arrays, np.flatnonzero(tendons.stretch_first == guide))[0]
            else:
                guides, key = (tendons.wheels, "guide_lifted") if what == "lifted" else (
                    tendons.grips, "guide_slip")
                result = self.arrays[key][:, guides.tolist().index(guide)]
        else:
            row = QUANTITIES[kind][quantity]
            stored = self.means(row.array)[row.array][:, index]
            result = stored if row.component is None else stored[:, row.component]
        result.setflags(write=False)
        return result

    def grasp(self, body: int) -> Grasp:
        """How the body of a number, an object with shapes, is held."""
        if body not in self._grasps:
            self._grasps[body] = Grasp(self, body)
        return self._grasps[body]

    def _power(self, drive: int) -> Array:
        """Power of a drive of a hinge or actuator, or of a surface [W], [n]."""
        drives, a = self.model.drives, self.arrays
        kind, joint = drives.kind[drive], int(drives.target[drive])
        if kind.gives == "surface":
            return np.array(a["drive_power"][:, drive])
        rate = a["joint_speed" if kind.gives == "push" else "joint_rate"][:, joint]
        return np.asarray(Loads(self).given[drive] * rate)


MAX_NOTES = 8  # Largest number of notes of one kind


def few(notes: list[str], others: str) -> list[str]:
    """The first notes, and how many others there are."""
    more = len(notes) - MAX_NOTES
    return notes[:MAX_NOTES] + [f"{more} more {others}"] * (more > 0)


def broken(run: Samples) -> list[str]:
    """A note on each joint, spring and tendon that broke, in order of time."""
    bonds, notes = run.model.bonds, []
    for one in run.info.broke:
        if one.event in bonds.name:
            bond = bonds.name.index(one.event)
            unit = "N m" if bond in bonds.spring[~run.model.springs.straight] else "N"
            notes.append(f"{one.event} broke at its load of {bonds.breaks_at[bond]:g} {unit}, "
                         f"t = {one.time:.6g} s")
    return few(notes, "broke after that")


AT_END = 1e-5  # Distance [m] from an end of a groove at which a point that presses is there
PRESSES = 1e-9  # Least force along the groove, relative to the joint's largest force


def ended(run: Samples) -> list[str]:
    """A note on each point that reached an end of its groove after the start, in order of time."""
    joints, found, notes = run.model.joints, [], []
    slots = joints.keeping("groove").tolist() if len(run) else []
    frames = Frames(run.model, run.arrays)
    for joint in slots:
        place, length = frames.place_in_slot(joint), slot_length(run.model, joint)
        force = np.nan_to_num(run.arrays["joint_force"][:, joint])
        along = np.abs(place.x * force[:, 0] + place.y * force[:, 1])
        pressed = along > PRESSES * np.abs(force).max()
        for left in (place.along, length - place.along):
            there = np.flatnonzero((left < AT_END) & pressed)
            if len(there) and left[0] >= AT_END:
                found.append((int(there[0]), joint, float(left[0])))
    divide = {name for group in run.mechanism.groups if group.tree for name in group.bodies}
    for sample, joint, gone in sorted(found):
        name = run.model.bodies.name[int(joints.bodies[joint, 1])]
        more = ", and divides its pull no longer while it is there" if name in divide else ""
        notes.append(
            f"{joints.name[joint]}: {name} reached the end of its slot, {1000.0 * gone:.4g} mm "
            f"from its start, t = {run.time[sample]:.6g} s{more}")
    return few(notes, "reached the ends of their slots later")


AT_REST = 1e-6  # Largest speed at rest [m/s, rad/s]
AT_MOST = 1e-6  # Distance from its limit, relative to it, at which a drive is at its limit


def stalled(run: Samples) -> Iterator[str]:
    """A note on each drive at its limit on bodies that are at rest at the end."""
    drives = run.model.drives
    if not len(run) or not len(drives.name):
        return
    loads = Loads(run)
    still = np.abs(run.arrays["body_velocity"]).max(axis=2) < AT_REST
    for i, kind in enumerate(drives.kind):
        if not kind.limited or not np.isfinite(drives.most[i]):
            continue
        a, b = run.model.joints.bodies[drives.target[i]].tolist()
        rests = still[:, a] & still[:, b] & (
            np.abs(loads.given[i]) >= (1 - AT_MOST) * drives.most[i])
        if rests[-1]:
            since = run.time[len(run) - np.argmin(rests[::-1])] if not rests.all() else run.time[0]
            unit = "N" if kind.gives == "push" else "N m"
            yield (f"{drives.name[i]} has stalled: from t = {since:.6g} s on it gives all of its "
                   f"{drives.most[i]:g} {unit}, and nothing moves")
