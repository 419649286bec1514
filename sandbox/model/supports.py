"""Redundant joints, whose loads statics does not determine: more rows than degrees of freedom.

The forces of joints are the multipliers of their rows J of the velocities of bodies. Where rows
depend on one another, J^T p = 0 has nonzero solutions, and the reactions of each joint with a part
in one of them are not unique; the engine finds the minimum sum of squares, weighted by the masses.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import flank_of, meeting, outward, place_in_slot, rotated
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers, connected_components
from sandbox.scene.geometry import Vec

LARGEST_GROUP = 300  # largest number of connected rows that are examined
RANK = 1e-9  # singular values below this share of the largest count as none
PART = 1e-6  # minimum component of a joint in a unit vector of the null space


class Shared(NamedTuple):
    """Redundant joints in a pose."""

    joints: set[int]  # those whose reactions are not unique
    examined: bool  # whether any group of joints had at most LARGEST_GROUP rows


def shared_joints(model: Model, pose: Array) -> Shared:
    """Joints, ropes left out, whose reactions statics does not determine in a pose [nb, 3]."""
    found: set[int] = set()
    examined = False
    for joints in together(model):
        if len(joints) > LARGEST_GROUP:
            continue
        rows = [joint_rows(model, pose, joint) for joint in joints]
        of = np.repeat(joints, [len(each) for each in rows])
        if not 0 < len(of) <= LARGEST_GROUP:
            continue
        examined = True
        left, values, _ = np.linalg.svd(_matrix(model, joints, np.concatenate(rows)))
        rank = int(np.count_nonzero(values > RANK * values[0]))
        found.update(of[np.linalg.norm(left[:, rank:], axis=1) > PART].tolist())
    return Shared(found, examined)


def parting_wheels(model: Model, pose: Array) -> set[int]:
    """Gears and racks whose distance joints, with teeth, let change in a pose [nb, 3]."""
    found: set[int] = set()
    for joints in together(model):
        toothed = [j for j in joints if model.joints.kind[j].teeth]
        if not toothed or len(joints) > LARGEST_GROUP:
            continue
        rows = [joint_rows(model, pose, joint, flank=1) for joint in joints]
        for joint in toothed:  # the row of the distance of two wheels, or of a gear from its rack
            a, b = model.joints.bodies[joint].tolist()
            x, y = (float(v) for v in outward(model, joint, pose))
            ax, ay = _arm(pose[a], model.joints.anchor[joint, 0])
            bx, by = pose[a, 0] + ax - pose[b, 0], pose[a, 1] + ay - pose[b, 1]
            rows.append(_rows(pose, a, b, [(x, y)], (ax, ay), (bx, by)))
        J = _matrix(model, joints, np.concatenate(rows))
        if len(J) - len(toothed) > LARGEST_GROUP:
            continue
        kept, parting = J[:-len(toothed)], J[-len(toothed):]
        _, values, right = np.linalg.svd(kept, full_matrices=False)
        held = right[values > RANK * values[0]]
        left = parting - parting @ held.T @ held
        free = np.linalg.norm(left, axis=1) > PART * np.linalg.norm(parting, axis=1)
        found |= {joint for joint, is_free in zip(toothed, free, strict=True) if is_free}
    return found


def _rows(pose: Array, a: int, b: int, directions: Sequence[Vec], on_a: Vec, on_b: Vec) -> Array:
    """Rows [m, nb, 3] of directions at points of two bodies relative to their frames."""
    rows = np.zeros((len(directions), len(pose), 3))
    for row, (x, y) in zip(rows, directions, strict=True):
        row[a] = -x, -y, -(on_a[0] * y - on_a[1] * x)
        row[b] = x, y, on_b[0] * y - on_b[1] * x
    return rows


def _matrix(model: Model, joints: list[int], rows: Array) -> Array:
    """Rows of the free bodies of some joints, [m, 3 n]; moments by the longest arm of each."""
    bodies = np.unique(model.joints.bodies[joints])
    J = rows[:, bodies[model.bodies.free[bodies]]].reshape(len(rows), -1)
    J[:, 2::3] /= np.maximum(np.abs(J[:, 2::3]).max(axis=0), 1e-300)
    return J


def components(count: int, pairs: Sequence[Sequence[int]] | Array | Integers) -> list[int]:
    """The number of the connected component of each of ``count`` bodies that ``pairs`` link."""
    one, two = np.array(pairs, dtype=np.int64).reshape(-1, 2).T
    links = np.zeros((count, count), dtype=bool)
    links[one, two] = links[two, one] = True
    found = np.zeros(count, dtype=np.int64)
    for number, group in enumerate(connected_components(links)):
        found[group] = number
    return found.tolist()


def together(model: Model) -> list[list[int]]:
    """Joints in groups that free bodies connect."""
    free, pairs = model.bodies.free, model.joints.bodies
    group = components(len(free), pairs[free[pairs].all(axis=1)])
    found: dict[int, list[int]] = {}
    for joint, pair in enumerate(pairs.tolist()):
        if moving := [body for body in pair if free[body]]:
            found.setdefault(group[moving[0]], []).append(joint)
    return list(found.values())


def joint_rows(model: Model, pose: Array, joint: int, *, flank: int = 0) -> Array:
    """Rows of a joint: coefficients of bodies about their frames' origins, [m, nb, 3].

    Teeth are elastic: they have a row only for a given ``flank``, +1 or -1.
    """
    joints = model.joints
    a, b = joints.bodies[joint].tolist()
    kind = joints.kind[joint]
    (ax, ay), (bx, by) = (_arm(pose[body], joints.anchor[joint, side])
                          for side, body in enumerate((a, b)))
    px, py = pose[b, 0] + bx - pose[a, 0] - ax, pose[b, 1] + by - pose[a, 1] - ay
    along: list[Vec] = []
    if kind.keeps == "point":
        along = [(1.0, 0.0), (0.0, 1.0)]
    elif kind.keeps == "groove":
        place = place_in_slot(model, joint, pose)
        along = [(-float(place.y), float(place.x))] if place.x or place.y else [(1.0, 0.0)]
        ax, ay = pose[b, 0] + bx - pose[a, 0], pose[b, 1] + by - pose[a, 1]
    elif kind.keeps in ("distance", "roll"):
        length = float(np.hypot(px, py))
        along = [(px / length, py / length)] if length > 0 else [(1.0, 0.0)]
    if kind.teeth and flank:
        push = flank_of(model, joint, pose, flank)
        along = [(float(push.x), float(push.y))]
    if kind.keeps == "roll":
        along.append((-along[0][1], along[0][0]))
    if kind.wheels:
        x, y = (float(v) for v in meeting(model, joint, pose))
        ax, ay, bx, by = x - pose[a, 0], y - pose[a, 1], x - pose[b, 0], y - pose[b, 1]
    rows = _rows(pose, a, b, along, (ax, ay), (bx, by))
    return rows if joints.turns[joint] else np.concatenate([rows, turning_row(model, joint)])


def turning_row(model: Model, joint: int) -> Array:
    """The rotation of ``b`` against ``a``, or a couple on them, [1, nb, 3]."""
    row = np.zeros((1, len(model.bodies.name), 3))
    row[0, model.joints.bodies[joint], 2] = -1.0, 1.0
    return row


def about_centres(model: Model, pose: Array, wrenches: Array) -> Array:
    """Forces x, y and moments about the bodies' frames, [m, nb, 3], as moments about centres."""
    (x, y), found = rotated(model.bodies.centre, pose[:, 2]).T, wrenches.copy()
    found[..., 2] -= x * wrenches[..., 1] - y * wrenches[..., 0]
    return found


def _arm(pose: Array, point: Array) -> Vec:
    x, y = rotated(point, pose[2]).tolist()
    return x, y
