"""Arrows that are shown on wish: velocities, accelerations, what hinges carry."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import LABELLED, MOST_LABELS, arrow_label, slim_arrow
from sandbox.draw.film.palette import ACCELERATION, REACTION, VELOCITY, Colour
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import LONGEST, ForceScale, number, rounding, typical
from sandbox.numeric import Array
from sandbox.samples.contacts import on_the_other, said_of

XY = tuple[float, float]
Place = tuple[int, XY]
"""A body, and a point in its frame [m]."""
SHORTEST = 5.0
"""Arrows that are too short for a head are left out [points]."""
STANDING = 1e-6
"""In widths of the picture, what goes no farther in the whole run stands still."""
LENGTH = 0.1
"""Length of an arrow that is typical of the large ones, as a fraction of the picture's width."""


@dataclass(frozen=True)
class Vectors:
    """Arrows of one kind: where they begin, and what they show in every sample."""

    places: Sequence[Place]
    values: Array
    """[n, k, 2], in the world."""
    unit: str
    words: str
    """For the legend."""
    colour: Colour
    least: float = 0.0
    """What is not larger is what rounding leaves, in widths of the picture [unit / m]."""


def moved_with(run: Filmed, places: Sequence[Place]) -> tuple[Array, Array]:
    """Velocity [m/s] and acceleration [m/s^2] of points of bodies, [n, k, 2] each.

    Of rigid bodies: v + omega x r and a + alpha x r - omega^2 r, with r from the centre of mass.
    """
    bodies = np.array([body for body, _ in places], dtype=np.intp)
    local = np.array([at for _, at in places]).reshape(-1, 2) - run.arrays["body_centre"][bodies]
    angle = run.arrays["body_pose"][:, bodies, 2]
    c, s = np.cos(angle), np.sin(angle)
    r = np.stack((c * local[:, 0] - s * local[:, 1], s * local[:, 0] + c * local[:, 1]), axis=-1)
    across = np.stack((-r[..., 1], r[..., 0]), axis=-1)
    v, a = run.arrays["body_velocity"][:, bodies], run.arrays["body_acceleration"][:, bodies]
    omega, alpha = v[..., 2:], a[..., 2:]
    return v[..., :2] + omega * across, a[..., :2] + alpha * across - omega**2 * r


def velocities(run: Filmed, places: Sequence[Place]) -> Vectors:
    """Velocities of points."""
    return Vectors(places, moved_with(run, places)[0], "m/s", "velocity", VELOCITY,
                   STANDING / _duration(run))


def accelerations(run: Filmed, places: Sequence[Place]) -> Vectors:
    """Accelerations of points."""
    return Vectors(places, moved_with(run, places)[1], "m/s²", "acceleration", ACCELERATION,
                   STANDING / _duration(run) ** 2)


def _duration(run: Filmed) -> float:
    return max(float(run.time[-1] - run.time[0]), 1e-9)


def hinges_of(run: Filmed, bodies: Sequence[int]) -> list[int]:
    """The pins, slots and welds that join one of ``bodies`` to another."""
    joints = run.model.joints
    return [k for k, kind in enumerate(joints.kind) if kind.keeps in ("point", "groove")
            and set(joints.bodies[k].tolist()) & set(bodies)]


def reactions(run: Filmed, bodies: Sequence[int]) -> Vectors:
    """What the :func:`hinges_of` some bodies carry.

    On the object, else on the body that moves more (:func:`on_the_other`).
    """
    joints = run.model.joints
    found = np.array(hinges_of(run, bodies), dtype=np.intp)
    a, b = joints.bodies[found].T if len(found) else np.zeros((2, 0), dtype=np.intp)
    swapped = on_the_other(run.model, run.arrays, b, a)
    places = [(int(joints.bodies[k, 1]), (float(x), float(y)))
              for k, (x, y) in zip(found, joints.anchor[found, 1], strict=True)]
    values = run.arrays["joint_force"][:, found] * np.where(swapped, -1.0, 1.0)[None, :, None]
    if np.abs(np.nan_to_num(values)).max(initial=0.0) <= rounding(run):
        values = np.zeros_like(values)
    on, by = np.where(swapped, a, b), np.where(swapped, b, a)
    return Vectors(places, values, "N", f"hinge force {said_of(run.model, on, by)}", REACTION)


def vector_scale(vectors: Vectors, time: Array, width: float) -> ForceScale:
    """How long arrows of one kind are on a picture ``width`` [m] wide; ``time`` [n] s."""
    values = np.nan_to_num(vectors.values)
    size = np.hypot(values[..., 0], values[..., 1])
    reference = typical(size.max(axis=1, initial=0.0), time)
    if reference <= vectors.least * width:
        reference = 0.0
    return ForceScale(LENGTH * width / reference if reference > 0 else 0.0, reference)


class VectorDrawer:
    """Draws arrows of one kind to a scale of their own."""

    def __init__(self, run: Filmed, vectors: Vectors, pool: PointPool, width: float) -> None:
        """``width`` of the picture [m]."""
        self.vectors = vectors
        self._values = np.nan_to_num(vectors.values)
        self._tails = [pool.add(body, [at]).start for body, at in vectors.places]
        self.scale = vector_scale(vectors, run.time, width)

    def tips(self, world: Array, sample: int) -> Array:
        """Where the arrows end [k, 2] m, for pooled points of a sample."""
        value = self._values[sample]
        size = np.maximum(np.hypot(value[:, 0], value[:, 1]), 1e-300)
        shown = np.minimum(1.0, self.scale.longest / size) * self.scale.metres
        return np.asarray(world[self._tails] + value * shown[:, None])

    def cuts(self, samples: Sequence[int]) -> bool:
        """Whether an arrow is cut short in any of the samples."""
        size = np.hypot(self._values[samples, :, 0], self._values[samples, :, 1])
        return self.scale.metres > 0 and bool((size > self.scale.longest).any())

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows; values of the largest go to the canvas as labels."""
        if self.scale.metres == 0:
            return
        tips = canvas.camera.to_pixels(self.tips(moment.world, moment.sample)).tolist()
        size = np.hypot(*self._values[moment.sample].T)
        order = np.argsort(-size, kind="stable").tolist()
        for k in reversed(order):
            tail, tip = moment.points[self._tails[k]], tips[k]
            if math.dist(tail, tip) >= SHORTEST * canvas.unit:
                slim_arrow(canvas, self.vectors.colour, tail, tip,
                           cut=bool(size[k] > LONGEST * self.scale.reference))
        for k in order[:MOST_LABELS]:
            if size[k] >= LABELLED * self.scale.reference:
                canvas.labels.append(arrow_label(
                    canvas, moment.points[self._tails[k]], tuple(tips[k]),
                    number(float(size[k]), self.scale.reference), self.vectors.unit,
                    self.vectors.colour))
