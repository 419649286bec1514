"""Grasp quality of an object in every sample: closed forms of its recorded contacts, and rest.

A hand consists of moving bodies with any role but ``ground`` and ``object``, and of fixed bodies
with a role of :data:`OF_HANDS`, so a table is none. Each touching pair is one contact; two flat
sides press on each other from end to end, and count as both ends.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator, Mapping
from functools import cached_property, partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from sandbox.elements.quantities import MAX_PRESSING, STRAY, WINDOW
from sandbox.mechanics.closure import force_spread, grasp_epsilon, grasp_isotropy
from sandbox.model.joints import placed, rotated
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.contacts import TOUCH, slip_speeds
from sandbox.samples.nearby import flat_sides, pressed
from sandbox.samples.stiffness import Linearization, without_stiffness
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import centre_of, reach_of

if TYPE_CHECKING:
    from sandbox.samples.samples import Samples

OF_HANDS = ("phalanx", "palm", "rocker", "pulley")  # Roles of parts of a hand that may be fixed
FLAT, IN_LINE = 1e-7, 1e-4  # [m, rad] from a plane, within which a whole side presses
STIFFNESS = ("stiffness_x", "stiffness_y", "stiffness_turn", "stiffness")  # of PushResponse
MAX_STIFFNESS_SAMPLES = 25  # Maximum number of samples of one reading with a new stiffness


class _Holding(NamedTuple):
    """The conditions of ``held`` in every sample."""

    hand: Flags  # Whether a hand presses on the object, [n]
    carried: Flags  # Whether another body that is no object does
    ready: Flags  # Whether the window lies within the run
    released: Flags  # Whether no hand pressed on it in some sample of the window
    path: Array  # Lengths of its travel and sliding within the window [m], [2, n]
    since: Integers  # The window's first sample, [n]


class Grasp:
    """An object of a recording and its contacts."""

    def __init__(self, run: Samples, body: int) -> None:
        self.run, self.body, contacts = run, body, run.contacts
        self.row: Integers = np.flatnonzero(
            ((contacts.body == body) | (contacts.other == body)) & (contacts.normal > TOUCH))
        """Numbers of the contacts that press among those of all bodies, [m]."""
        first = contacts.body[self.row] == body
        self.push: Array = contacts.normal[self.row]  # Normal forces [N], [m]
        self.normal: Array = np.where(first, 1.0, -1.0)[:, None] * contacts.direction[self.row]
        self.friction: Array = contacts.laws[1, self.row]  # Coefficients of static friction, [m]
        self.point: Array = contacts.point[self.row]
        self.sample: Integers = contacts.sample[self.row]
        self.other: Integers = np.where(
            first, contacts.other[self.row], contacts.body[self.row])
        bodies = run.mechanism.bodies
        roles = np.array([each.role for each in bodies])[self.other]
        self.of_hand: Flags = np.array([of_hand(each) for each in bodies])[self.other]
        self.of_others: Flags = ~self.of_hand & (roles != "object")  # Neither hand nor object, [m]
        self.on_finger: Flags = self.of_hand & (roles != "palm")
        self.count: Integers = np.bincount(self.sample[self.of_hand], minlength=len(run))
        """Contacts of the hand in every sample, [n]."""
        local = centre_of(bodies[body])
        self.size = reach_of(bodies[body], local)
        """rho: greatest distance of the outline from the centre of mass [m]."""
        self.centre = placed(run.arrays["body_pose"][:, body], np.asarray(local))  # Of mass, [n, 2]
        self._stiffnesses: dict[int, Array] = {}

    @cached_property
    def epsilon(self) -> Array:
        """Ferrari and Canny's measure, [n]; nan where no hand presses."""
        return self.of_contacts(grasp_epsilon)

    def of_contacts(self, measure: Callable[..., Array]) -> Array:
        """A measure of the hand's contacts, [n]; nan where there are none, or too many."""
        result, (rows, points) = np.full(len(self.run), np.nan), self._pressed
        few = self.count[self.sample[rows]] <= MAX_PRESSING
        rows, points = rows[few], points[few]
        for samples, at in self._equal_counts(self.sample[rows]):
            result[samples] = measure(
                points[at], self.normal[rows[at]], self.friction[rows[at]],
                centre=self.centre[samples], length=self.size)
        return result

    def _equal_counts(self, samples: Integers) -> Iterator[tuple[Integers, Integers]]:
        """Samples with equally many rows, and these rows, [k] and [k, m]."""
        count = np.bincount(samples, minlength=len(self.run))
        begin = np.cumsum(count) - count
        for m in np.unique(count[count > 0]).tolist():
            found = np.flatnonzero(count == m)
            yield found, begin[found, None] + np.arange(m)

    @cached_property
    def _pressed(self) -> tuple[Integers, Array]:
        """Rows of the hand [p] and the points at which each may press [p, 2]."""
        rows = np.flatnonzero(self.of_hand)
        bodies, pose = self.run.mechanism.bodies, self.run.arrays["body_pose"]
        in_line = np.ones(len(rows), dtype=bool)  # Both have a flat side along the plane
        for sign, on in ((-1.0, np.full(len(rows), self.body)), (1.0, self.other[rows])):
            n = sign * self.normal[rows]
            facing = np.arctan2(n[:, 1], n[:, 0]) - pose[self.sample[rows], on, 2]
            for body in np.unique(on).tolist():
                own = np.flatnonzero(on == body)
                off = facing[own, None] - flat_sides(bodies[body])
                in_line[own] &= (np.abs(np.sin(off / 2)) < IN_LINE).any(axis=1)
        flat = {row: ends for row in rows[in_line].tolist()
                if (ends := pressed(self.run, int(self.row[row]), FLAT)[0]) is not None
                and len(ends) == 2}
        twice = np.repeat(rows, 1 + np.isin(rows, list(flat)))
        points = self.point[twice]
        if flat:
            first = np.searchsorted(twice, list(flat))
            points[np.stack([first, first + 1], axis=1)] = list(flat.values())
        return twice, points

    def stiffness(self, name: str, chosen: slice = slice(None)) -> Array:
        """One of :data:`STIFFNESS` in the chosen samples, [k]; nan where it has no value.

        It is calculated in :data:`MAX_STIFFNESS_SAMPLES` of those in which the object is held,
        evenly spread. Samples in between repeat the value before.
        """
        numbers = np.arange(len(self.run))[chosen]
        result = np.full(len(numbers), np.nan)
        if without_stiffness(self.run.model):
            return result
        held = np.flatnonzero(self.held[numbers])
        count = min(len(held), MAX_STIFFNESS_SAMPLES)
        at = np.linspace(0, len(held) - 1, count).round().astype(np.int64)
        samples = numbers[held[at]].tolist()
        for sample in samples:
            if sample not in self._stiffnesses:
                self._stiffnesses[sample] = np.full(len(STIFFNESS), np.nan)
                with contextlib.suppress(ArithmeticError):
                    self._stiffnesses[sample] = Linearization(
                        self.run, sample, self.size).of(self.body).stiffness()
        values = np.array([self._stiffnesses[sample][STIFFNESS.index(name)] for sample in samples])
        result[held] = np.repeat(values, np.diff(at, append=len(held)))
        if len(self.run.model.tendons.grips):  # friction at guides adds to what holds
            result[np.isfinite(result)] = np.nan
        return result

    @property
    def no_stiffness(self) -> str:
        """Why stiffness has no value while the object is held."""
        friction = "tendons with friction" if len(self.run.model.tendons.grips) else ""
        return ("stiffness is not defined with "
                + (without_stiffness(self.run.model) or friction or "contacts in a notch"))

    @cached_property
    def fingers(self) -> Integers:
        """The number of every body's finger: its smallest group, else the body."""
        names = self.run.model.names.body
        finger = np.arange(len(names))
        for i, group in sorted(enumerate(self.run.mechanism.groups),
                               key=lambda each: -len(each[1].bodies)):
            finger[[names[name] for name in group.bodies if name in names]] = len(names) + i
        return finger

    def spread(self, part: Integers) -> Array:
        """Relative deviation of normal forces of parts [n], by the number ``part`` of each body."""
        rows = np.flatnonzero(self.on_finger)
        pairs, which = np.unique(
            np.stack([self.sample[rows], part[self.other[rows]]]), axis=1, return_inverse=True)
        total = np.bincount(which.ravel(), weights=self.push[rows], minlength=pairs.shape[1])
        result = np.full(len(self.run), np.nan)
        for samples, at in self._equal_counts(pairs[0]):
            result[samples] = force_spread(total[at])
        return result

    @cached_property
    def held(self) -> Flags:
        """Whether a hand alone has carried it at rest for :data:`WINDOW`, [n]."""
        rest = self._rest
        still = (rest.path < STRAY * self.size).all(axis=0)
        return np.asarray(rest.hand & ~rest.carried & rest.ready & ~rest.released & still)

    @cached_property
    def _rest(self) -> _Holding:
        n, time = len(self.run), self.run.time
        hand, carried = (np.bincount(self.sample[rows], minlength=n) > 0
                         for rows in (self.of_hand, self.of_others))
        since = np.searchsorted(time, time - WINDOW * (1 + 1e-9), side="left")
        ready = time - WINDOW >= (time[0] if n else 0.0) - WINDOW * 1e-9
        lost = np.cumsum(np.concatenate([[0.0], ~hand]))
        at, angle = self._in_palm()
        steps = np.hypot(*np.diff(at, axis=0).T) + self.size * np.abs(np.diff(angle))
        slides, rows = np.zeros(n), np.flatnonzero(self.of_hand)
        np.maximum.at(slides, self.sample[rows], slip_speeds(self.run.arrays, self.row[rows]))
        path = np.concatenate([np.zeros((2, min(1, n))), np.cumsum(
            [steps, slides[1:] * np.diff(time)], axis=1)], axis=1)
        return _Holding(hand, carried, ready, lost[1:] > lost[since], path - path[:, since], since)

    def why_not(self, sample: int) -> str:
        """The conditions of ``held`` that a sample does not meet, with numbers; empty if held."""
        rest, most = self._rest, f"{_mm(STRAY * self.size)} is the most"
        window = f"in the {WINDOW:g} s before"
        reasons = ["no body of a hand touches it" if not rest.hand[sample] else
                   f"the run was not {WINDOW:g} s old" if not rest.ready[sample] else
                   f"the hand released it {window}" if rest.released[sample] else ""]
        if rest.carried[sample]:
            rows = np.flatnonzero(self.of_others & (self.sample == sample))
            carrier = self._most(rows, self.push[rows])[0]
            reasons.append(f"{carrier!r}, which is no hand, carries it")
        moved, slid = rest.path[:, sample]
        if moved >= STRAY * self.size:
            reasons.append(f"it moved by {_mm(moved)} {window}, {most}")
        if slid >= STRAY * self.size:
            rows = np.flatnonzero(self.of_hand & (self.sample > rest.since[sample])
                                  & (self.sample <= sample))
            took = np.diff(self.run.time)[self.sample[rows] - 1]
            name, way = self._most(rows, slip_speeds(self.run.arrays, self.row[rows]) * took)
            reasons.append(f"it slid by {_mm(slid)} {window}, {most}, along {name!r} by {_mm(way)}")
        return "; ".join(filter(None, reasons))

    def _most(self, rows: Integers, amounts: Array) -> tuple[str, float]:
        """The touching body with the largest sum of amounts over contacts, and the sum."""
        bodies = self.run.mechanism.bodies
        total = np.bincount(self.other[rows], weights=amounts, minlength=len(bodies))
        return bodies[int(np.argmax(total))].name, float(total.max())

    def _in_palm(self) -> tuple[Array, Array]:
        """Its centre [n, 2] and angle [n] in the frame of a moving palm, else in the world."""
        pose = self.run.arrays["body_pose"]
        angle = pose[:, self.body, 2]
        palms = [i for i, body in enumerate(self.run.mechanism.bodies)
                 if body.role == "palm" and body.motion != "fixed"]
        if not palms:
            return self.centre, angle
        palm = pose[:, palms[0]]
        return rotated(self.centre - palm[:, :2], -palm[:, 2]), angle - palm[:, 2]

    def drift(self) -> Array:
        """Largest displacement of its points [m], [n], since the first sample of being held."""
        begins = self.held & ~np.concatenate([np.zeros(1, dtype=bool), self.held[:-1]])
        since = np.maximum.accumulate(np.where(begins, np.arange(len(begins)), 0))
        at, angle = self._in_palm()
        turned = 2 * self.size * np.abs(np.sin((angle - angle[since]) / 2))
        moved = np.hypot(*(at - at[since]).T) + turned
        return np.where(self.held, moved, np.nan)


MEASURES: Mapping[str, Callable[[Grasp], Array]] = {
    "held": lambda grasp: grasp.held.astype(np.float64),
    "drift": Grasp.drift,
    "closure": lambda grasp: np.where(grasp.count > MAX_PRESSING, np.nan, np.where(
        np.nan_to_num(grasp.epsilon) > 0, 1.0, 0.0)),
    "epsilon": lambda grasp: grasp.epsilon,
    **{name: partial(Grasp.stiffness, name=name) for name in STIFFNESS},
    "isotropy": lambda grasp: grasp.of_contacts(grasp_isotropy),
    "spread": lambda grasp: grasp.spread(grasp.fingers),
    "spread_bodies": lambda grasp: grasp.spread(np.arange(len(grasp.run.mechanism.bodies))),
}  # The function of each of sandbox.elements.quantities.GRASP


def of_hand(body: Body) -> bool:
    """Whether a body is part of a hand."""
    return body.role in OF_HANDS or (body.role == "link" and body.motion != "fixed")


def _mm(length: float) -> str:
    return f"{1e3 * length:.3g} mm"
