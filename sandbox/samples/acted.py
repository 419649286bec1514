"""On which of two bodies a force is said to act: the one rule of films, pages and tables."""

from __future__ import annotations

import numpy as np

from sandbox.elements.arrays import Arrays
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers

OBJECT = "object"
"""The role of what is held."""
FARTHER = 1e-3
"""Share by which a way is longer than another, at least; what is less may be rounding."""


def ways(arrays: Arrays) -> Array:
    """How far each body goes in a run [m], [nb]: the way of its centre, and of its turning.

    A turn counts at the radius of gyration, by which it has the kinetic energy of a way as long. A
    body that does not move freely has no such radius; only its centre counts.
    """
    pose, centre = arrays["body_pose"], arrays["body_centre"]
    c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
    x = pose[..., 0] + c * centre[:, 0] - s * centre[:, 1]
    y = pose[..., 1] + s * centre[:, 0] + c * centre[:, 1]
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
