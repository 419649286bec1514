"""Contact rows: points of one pair of bodies added up, and means over sample intervals."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import FORCES, Arrays
from sandbox.numeric import Array, Integers

CANCELLED = 1e-6
"""Least magnitude of a resultant with a line of action, relative to the sum of its forces."""


def mean_contact_rows(arrays: Arrays) -> Arrays:
    """Contact rows of means over sample intervals: sample, body, other, point, force and normal.

    Samples without means of their own have the rows of their steps.
    """
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


def mean_arrays(arrays: Arrays, keys: Iterable[str]) -> Arrays:
    """The arrays that have means over sample intervals, with these means."""
    if "mean_sample" not in arrays:
        return {}
    rows, (joints, tendons, guides) = arrays["mean_sample"], (
        arrays[key].shape[1] for key in ("joint_stop", "tendon_tension", "guide_friction"))
    parts = np.split(arrays["mean_force"],
                     np.cumsum([FORCES * joints, tendons, guides]), axis=1)
    forces = parts[0].reshape(len(rows), joints, FORCES)
    means = {"joint_force": forces[..., :2], "joint_reaction": np.hypot(*forces.T[:2]).T,
             "joint_couple": forces[..., 2], "joint_stop": forces[..., 3],
             "joint_friction": forces[..., 4],
             **dict(zip(("tendon_tension", "guide_friction", "drive_torque"), parts[1:],
                        strict=True))}
    found: Arrays = {}
    for key in means.keys() & set(keys):
        found[key] = np.array(arrays[key])
        found[key][rows] = np.where(np.isnan(found[key][rows]), np.nan, means[key])
    return found


def merge_contacts(
    sample: Integers, body: Integers, other: Integers, point: Array, force: Array, normal: Array,
    weight: Array, gap: Array, twist: Array,
) -> dict[str, NDArray[Any]]:
    """One row per touching pair of bodies and sample.

    Points of one pair of bodies are summed. The position is the centre of pressure, the mean
    weighted by the normal forces, moved onto the line of action of the resultant, so that the
    resultant has the moment of all points.

    Args:
        sample: of each point, in order, [r].
        body: that the force acts on, [r].
        other: that it comes from, [r].
        point: place [m], [r, 2].
        force: on the body [N], [r, 2].
        normal: unit vector into the body, [r, 2].
        weight: sizes of the normal forces, in any unit, [r].
        gap: between the two [m], [r].
        twist: moment on the other body besides that of the force at the place [N m], [r].
    """
    bodies = 1 + max(body.max(initial=0), other.max(initial=0))
    pair = (sample * bodies + body) * bodies + other
    if (pair[1:] < pair[:-1]).any():  # bodies of several shapes
        order = np.argsort(pair, kind="stable")
        sample, body, other, pair = (column[order] for column in (sample, body, other, pair))
        point, force, normal, weight, gap, twist = (
            column[order] for column in (point, force, normal, weight, gap, twist))
    start = np.flatnonzero(np.diff(pair, prepend=-1))
    merged = np.diff(start, append=len(sample)).astype(float)
    if len(start) < len(sample):
        weight = weight[:, None]
        total = np.add.reduceat(weight, start)
        point = _on_line(np.add.reduceat(point * weight, start) / total, point, force, start)
        normals = np.add.reduceat(normal * weight, start)
        size = np.hypot(*normals.T)[:, None]
        acts = size > CANCELLED * total  # squeezed from both sides: the first point's
        normal = np.where(acts, normals / np.where(acts, size, 1.0), normal[start])
        force, gap = np.add.reduceat(force, start), np.minimum.reduceat(gap, start)
        twist = np.add.reduceat(twist, start)
    return {
        "sample": sample[start], "body": body[start], "other": other[start],
        "point": point, "force": force, "normal": normal, "gap": gap, "merged": merged,
        "twist": twist,
    }


def _on_line(mean: Array, point: Array, force: Array, start: Integers) -> Array:
    """Points ``mean`` [p, 2] moved onto the lines of action of the forces at ``point`` [m, 2].

    Rows of each pair begin at ``start``. Points of forces that almost cancel stay: such forces are
    a couple, which has no line of action.
    """
    pair = np.repeat(np.arange(len(start)), np.diff(start, append=len(point)))
    arm = point - mean[pair]
    moment = np.add.reduceat(arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0], start)
    total = np.add.reduceat(force, start)
    sizes = np.add.reduceat(np.hypot(force[:, 0], force[:, 1]), start)
    square = (total**2).sum(axis=1)
    acts = square > (CANCELLED * sizes) ** 2
    way = np.where(acts, moment / np.where(acts, square, 1.0), 0.0)
    moved: Array = mean + way[:, None] * np.stack([total[:, 1], -total[:, 0]], axis=1)
    return moved
