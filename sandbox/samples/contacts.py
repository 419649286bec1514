"""Contact rows: points of a pair added up, means, sums per body, pair and group.

A row is one touching pair in one sample. With the force f on ``body`` by ``other`` and the unit
normal u into ``body``, normal = f · u and tangential = f · (u turned by +90°). Both numbers are the
same for ``other``, whose force is −f and whose normal is −u.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import FORCES, Arrays
from sandbox.model.joints import placed
from sandbox.model.model import Model
from sandbox.model.pairs import friction_of, restitution_of, static_friction_of
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.mechanism import Mechanism

TOUCH = 1e-6  # Normal force [N] above which a body counts as touched
CANCELLED = 1e-6  # Minimum of a resultant with a line of action, over the sum of its forces


class Contacts:
    """The contact rows of a recording."""

    def __init__(
        self, arrays: Mapping[str, NDArray[Any]], mechanism: Mechanism, samples: int,
    ) -> None:
        self.mechanism, self.samples = mechanism, samples
        self.sample: Integers = arrays["contact_sample"]
        self.body: Integers = arrays["contact_body"]
        self.other: Integers = arrays["contact_other"]
        self.point: Array = arrays["contact_point"]
        self.force: Array = arrays["contact_force"]
        self.direction: Array = arrays["contact_normal"]
        (fx, fy), (nx, ny) = self.force.T, self.direction.T
        self.normal: Array = fx * nx + fy * ny  # Normal force of every row [N], [m]
        self.tangential: Array = fy * nx - fx * ny  # Tangential force, signed [N], [m]

    @cached_property
    def laws(self) -> Array:
        """Coefficients of friction, static friction and restitution of every row, [3, m]."""
        pairs, which = np.unique(
            np.stack([self.body, self.other]), axis=1, return_inverse=True)
        return np.array([[of(self.mechanism, *pair) for pair in pairs.T.tolist()] for of in (
            friction_of, static_friction_of, restitution_of)])[:, which.ravel()]

    def rows_of(self, body: int) -> tuple[Integers, Array]:
        """The rows that touch a body, and +1 where it is ``body``, -1 where it is ``other``."""
        first, second = (np.flatnonzero(side == body) for side in (self.body, self.other))
        return np.append(first, second), np.repeat([1.0, -1.0], [len(first), len(second)])

    def of_body(self, body: int, quantity: str) -> Array:
        """``normal`` or ``tangential`` (sums of magnitudes), ``fx`` or ``fy`` [N], shape [n]."""
        rows, sign = self.rows_of(body)
        if quantity in ("fx", "fy"):
            return self._per_sample(rows, sign * self.force[rows, int(quantity == "fy")])
        return self._per_sample(rows, np.abs(getattr(self, quantity)[rows]))

    def of_pair(self, body: int, other: int, quantity: str) -> Array:
        """``normal`` or ``tangential`` of a pair, in either order [N], shape [n]."""
        rows, _ = self.rows_of(body)
        rows = rows[(self.body[rows] == other) | (self.other[rows] == other)]
        return self._per_sample(rows, getattr(self, quantity)[rows])

    def of_group(self, members: list[int], quantity: str) -> Array:
        """``count`` of members touched from outside, or the ``normal`` forces on them [N]: [n]."""
        inside = np.zeros(len(self.mechanism.bodies), dtype=bool)
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


def slip_speeds(arrays: Mapping[str, NDArray[Any]], rows: Integers) -> Array:
    """Speeds of sliding at contact rows [m/s], [k]."""
    sample, normal, rates = arrays["contact_sample"][rows], arrays["contact_normal"][rows], []
    for body in (arrays["contact_body"][rows], arrays["contact_other"][rows]):
        x, y = (arrays["contact_point"][rows] - placed(
            arrays["body_pose"][sample, body], arrays["body_centre"][body])).T
        vx, vy, turn = arrays["body_velocity"][sample, body].T
        rates.append((vy + turn * x) * normal[:, 0] - (vx - turn * y) * normal[:, 1])
    return np.asarray(np.abs(rates[0] - rates[1]))


OBJECT = "object"  # The role of what is held
FARTHER = 1e-3  # Least relative difference of paths that is not rounding


def on_the_other(model: Model, arrays: Arrays, body: Integers, other: Integers) -> Flags:
    """Whether the force between two bodies is shown on ``other`` rather than on ``body``, [m].

    That is the only ``object`` of the two, else the one with the longer path in the run. Rotations
    of bodies that move freely count at the radius of gyration.
    """
    pose, mass, inertia = (arrays[f"body_{key}"] for key in ("pose", "mass", "inertia"))
    x, y = np.moveaxis(placed(pose, arrays["body_centre"]), -1, 0)
    free = np.isfinite(mass) & np.isfinite(inertia) & (mass > 0)
    square = np.where(free, inertia, 0.0) / np.where(free, mass, 1.0)
    steps = np.diff(x, axis=0) ** 2 + np.diff(y, axis=0) ** 2 + (
        square * np.diff(pose[..., 2], axis=0) ** 2)
    path = np.sqrt(steps).sum(axis=0)
    held = np.array([each.role == OBJECT for each in model.mechanism.bodies], dtype=bool)
    farther = path[other] > (1 + FARTHER) * path[body]
    return np.asarray(np.where(held[body] == held[other], farther, held[other]), dtype=bool)


def contacts_on(model: Model, arrays: Arrays) -> tuple[Integers, Array]:
    """The body that the force of every row is shown on, [m], and the force on it [N], [m, 2]."""
    body, other = arrays["contact_body"], arrays["contact_other"]
    count = len(model.mechanism.bodies)
    pairs, back = np.unique(body * count + other, return_inverse=True)
    swapped = on_the_other(model, arrays, pairs // count, pairs % count)[back]
    return (np.where(swapped, other, body),
            np.where(swapped[:, None], -1.0, 1.0) * arrays["contact_force"])


def said_of(model: Model, shown_on: Integers, other: Integers) -> str:
    """The legend's words for forces on ``shown_on`` [k] by ``other`` [k]: ``on the object``."""
    held = np.array([each.role == OBJECT for each in model.mechanism.bodies], dtype=bool)
    one, two = held[shown_on], held[other]
    objects = "on the object" if len(set(shown_on[one].tolist())) == 1 else "on the objects"
    if not len(shown_on) or not one.any():
        return "on what moves more"
    return objects if (one & ~two).all() else f"{objects}, else on what moves more"


def mean_contact_rows(arrays: Arrays) -> Arrays:
    """Contact rows of means over sample intervals; rows of the steps where there are none."""
    keys = ("sample", "body", "other", "point", "force", "normal")
    if "mean_sample" not in arrays:
        return {f"contact_{key}": arrays[f"contact_{key}"] for key in keys}
    numbers = arrays["mean_contact_force"]
    place, normal, force, weight = (
        numbers[:, :2], numbers[:, 2:4], numbers[:, 4:6], numbers[:, 6:])
    normal = np.where(np.hypot(*normal.T)[:, None] > CANCELLED * weight, normal, force)
    size = np.hypot(*normal.T)
    rows = merge_contacts(
        arrays["mean_contact_sample"], arrays["mean_contact_body"], arrays["mean_contact_other"],
        place / weight, force, normal / size[:, None], size, *np.zeros((2, len(numbers))))
    single = ~np.isin(arrays["contact_sample"], arrays["mean_sample"])
    found = {key: np.concatenate([arrays[f"contact_{key}"][single], rows[key]]) for key in keys}
    order = np.lexsort((found["other"], found["body"], found["sample"]))
    return {f"contact_{key}": column[order] for key, column in found.items()}


MEANS = ("joint_force", "joint_couple", "joint_stop", "joint_friction", "joint_reaction",
         "tendon_tension", "guide_friction", "drive_torque")
"""Arrays that have means over sample intervals."""


def mean_arrays(arrays: Arrays, keys: Iterable[str]) -> Arrays:
    """Those of the arrays that are among :data:`MEANS`, with these means."""
    wanted = set(MEANS).intersection(keys)
    if not wanted or "mean_sample" not in arrays:
        return {}
    rows, (joints, tendons, guides) = arrays["mean_sample"], (
        arrays[key].shape[1] for key in ("joint_stop", "tendon_tension", "guide_friction"))
    parts = np.split(arrays["mean_force"], np.cumsum([FORCES * joints, tendons, guides]), axis=1)
    forces = parts[0].reshape(len(rows), joints, FORCES)
    means = dict(zip(MEANS, (
        forces[..., :2], *(forces[..., k] for k in range(2, FORCES)),
        np.hypot(*forces.T[:2]).T, *parts[1:]), strict=True))
    found: Arrays = {}
    for key in wanted:
        found[key] = np.array(arrays[key])
        found[key][rows] = np.where(np.isnan(found[key][rows]), np.nan, means[key])
    return found


def merge_contacts(
    sample: Integers, body: Integers, other: Integers, point: Array, force: Array, normal: Array,
    weight: Array, gap: Array, twist: Array,
) -> dict[str, NDArray[Any]]:
    """One row per touching pair of bodies and sample, of points [r] in order of samples.

    The point is the mean weighted by the normal forces ``weight``, moved onto the line of action of
    the resultant. ``twist`` is the moment on ``other`` besides that of the force [N m].
    """
    bodies = 1 + max(body.max(initial=0), other.max(initial=0))
    pair = (sample * bodies + body) * bodies + other
    order = np.argsort(pair, kind="stable")  # of bodies with several shapes
    sample, body, other, pair = (column[order] for column in (sample, body, other, pair))
    point, force, normal, weight, gap, twist = (
        column[order] for column in (point, force, normal, weight, gap, twist))
    start = np.flatnonzero(np.diff(pair, prepend=-1))
    merged = np.diff(start, append=len(sample)).astype(float)
    if len(start) < len(sample):
        weight = weight[:, None]
        total = np.add.reduceat(weight, start)
        mean, sizes = np.add.reduceat(point * weight, start) / total, np.hypot(*force.T)
        arm = point - np.repeat(mean, merged.astype(int), axis=0)
        moment = np.add.reduceat(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0], start)
        force = np.add.reduceat(force, start)
        square = (force**2).sum(axis=1)
        acts = square > (CANCELLED * np.add.reduceat(sizes, start)) ** 2  # couples stay in place
        way = np.where(acts, moment / np.where(acts, square, 1.0), 0.0)
        point = mean + way[:, None] * np.stack([force[:, 1], -force[:, 0]], axis=1)
        normals = np.add.reduceat(normal * weight, start)
        size = np.hypot(*normals.T)[:, None]
        acts = size > CANCELLED * total  # squeezed from both sides: the first point's
        normal = np.where(acts, normals / np.where(acts, size, 1.0), normal[start])
        gap, twist = np.minimum.reduceat(gap, start), np.add.reduceat(twist, start)
    return {
        "sample": sample[start], "body": body[start], "other": other[start],
        "point": point, "force": force, "normal": normal, "gap": gap, "merged": merged,
        "twist": twist,
    }
