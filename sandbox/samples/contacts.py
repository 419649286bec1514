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

from sandbox.numeric import Array, Integers

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
