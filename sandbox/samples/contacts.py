"""Contact forces summed per body, per pair and per group.

A row is one touching pair in one sample. With the force f on ``body`` by
``other`` and the unit normal u (the direction of the normal force on
``body``): normal = f · u, tangential = f · (u turned by +90°). On ``other``
the force is −f and the normal −u, so both numbers are the same seen from
either side.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import Arrays
from sandbox.model.joints import placed
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers

TOUCH = 1e-6
"""Normal force [N] above which a body counts as touched."""


class Contacts:
    """The contact rows of a recording, sorted by body when first asked for."""

    def __init__(self, arrays: Mapping[str, NDArray[Any]], *, samples: int, bodies: int) -> None:
        self.samples, self.bodies = samples, bodies
        self.sample: Integers = arrays["contact_sample"]
        self.body: Integers = arrays["contact_body"]
        self.other: Integers = arrays["contact_other"]
        self.force: Array = arrays["contact_force"]
        self.direction: Array = arrays["contact_normal"]

    @cached_property
    def normal(self) -> Array:
        """Normal force of every row [N], shape [m]."""
        force, direction = self.force, self.direction
        return force[:, 0] * direction[:, 0] + force[:, 1] * direction[:, 1]

    @cached_property
    def tangential(self) -> Array:
        """Tangential force of every row [N], shape [m]; signed."""
        return self.force[:, 1] * self.direction[:, 0] - self.force[:, 0] * self.direction[:, 1]

    @cached_property
    def _by_body(self) -> tuple[Integers, Integers]:
        """Both sides of all rows, sorted by body: side numbers [2 m] and where bodies begin."""
        owner = np.concatenate([self.body, self.other])
        order = np.argsort(owner, kind="stable")
        starts = np.searchsorted(owner[order], np.arange(self.bodies + 1))
        return order, starts

    def rows_of(self, body: int) -> tuple[Integers, Array]:
        """The rows that touch a body, and +1 where it is ``body``, -1 where it is ``other``."""
        order, starts = self._by_body
        side = order[starts[body]:starts[body + 1]]
        second = side >= len(self.body)
        return side - second * len(self.body), np.where(second, -1.0, 1.0)

    def of_body(self, body: int, quantity: str) -> Array:
        """``normal`` or ``tangential`` (sums of magnitudes), ``fx`` or ``fy`` [N], shape [n]."""
        rows, sign = self.rows_of(body)
        if quantity == "normal":
            weights = np.abs(self.normal[rows])
        elif quantity == "tangential":
            weights = np.abs(self.tangential[rows])
        else:
            weights = sign * self.force[rows, 0 if quantity == "fx" else 1]
        return self._per_sample(rows, weights)

    def of_pair(self, body: int, other: int, quantity: str) -> Array:
        """``normal`` or ``tangential`` of a pair, in either order [N], shape [n]."""
        rows, _ = self.rows_of(body)
        rows = rows[(self.body[rows] == other) | (self.other[rows] == other)]
        source = self.normal if quantity == "normal" else self.tangential
        return self._per_sample(rows, source[rows])

    def of_group(self, members: list[int], quantity: str) -> Array:
        """``count`` of members touched from outside, or the ``normal`` forces on them [N]: [n]."""
        inside = np.zeros(self.bodies, dtype=bool)
        inside[members] = True
        total = np.zeros(self.samples)
        for member in members:
            rows, _ = self.rows_of(member)
            rows = rows[inside[self.body[rows]] != inside[self.other[rows]]]
            if quantity == "count":
                rows = rows[self.normal[rows] > TOUCH]
                total[np.unique(self.sample[rows])] += 1.0
            else:
                total += self._per_sample(rows, np.abs(self.normal[rows]))
        return total

    def _per_sample(self, rows: Integers, weights: Array) -> Array:
        total = np.bincount(self.sample[rows], weights=weights, minlength=self.samples)
        return total.astype(np.float64, copy=False)


OBJECT = "object"
"""The role of what is held."""
FARTHER = 1e-3
"""Share by which a way is longer than another, at least; what is less may be rounding."""


def ways(arrays: Arrays) -> Array:
    """How far each body goes in a run [m], [nb]: the way of its centre, and of its turning.

    A turn counts at the radius of gyration, by which it has the kinetic energy of a way as long. A
    body that does not move freely has no such radius; only its centre counts.
    """
    pose = arrays["body_pose"]
    x, y = np.moveaxis(placed(pose, arrays["body_centre"]), -1, 0)
    mass, inertia = arrays["body_mass"], arrays["body_inertia"]
    free = np.isfinite(mass) & np.isfinite(inertia) & (mass > 0)
    square = np.where(free, inertia, 0.0) / np.where(free, mass, 1.0)
    steps = np.diff(x, axis=0) ** 2 + np.diff(y, axis=0) ** 2 + (
        square * np.diff(pose[..., 2], axis=0) ** 2)
    return np.asarray(np.sqrt(steps).sum(axis=0))


def on_the_other(model: Model, arrays: Arrays, body: Integers, other: Integers) -> Flags:
    """Whether the force between two bodies is shown on ``other`` rather than on ``body``, [m].

    It is shown on the one with the role ``object`` where one of the two has it, else on the one
    that goes farther in the run (:func:`ways`), and of two that go about as far on ``body``.
    """
    held = np.array([each.role == OBJECT for each in model.mechanism.bodies], dtype=bool)
    way = ways(arrays)
    same = held[body] == held[other]
    farther = way[other] > (1 + FARTHER) * way[body]
    return np.asarray(np.where(same, farther, held[other]), dtype=bool)


def contacts_on(model: Model, arrays: Arrays) -> tuple[Integers, Array]:
    """Of every row of contacts the body that its force is shown on [m], and the force [m, 2] N.

    It acts at ``contact_point``; turned round it is the force on the other of the two.
    """
    body, other = arrays["contact_body"], arrays["contact_other"]
    count = len(model.mechanism.bodies)
    pairs, back = np.unique(body * count + other, return_inverse=True)
    swapped = on_the_other(model, arrays, pairs // count, pairs % count)[back]
    return (np.where(swapped, other, body),
            np.where(swapped[:, None], -1.0, 1.0) * arrays["contact_force"])


def said_of(model: Model, shown_on: Integers, other: Integers) -> str:
    """The legend's words for such forces: ``on the object``, ``on what moves more``, or both.

    Args:
        model: the model.
        shown_on: bodies that forces are shown on, [k].
        other: those that they come from, [k].
    """
    held = np.array([each.role == OBJECT for each in model.mechanism.bodies], dtype=bool)
    one, two = held[shown_on], held[other]
    objects = "on the object" if len(set(shown_on[one].tolist())) == 1 else "on the objects"
    if not len(shown_on) or not one.any():
        return "on what moves more"
    return objects if (one & ~two).all() else f"{objects}, else on what moves more"
