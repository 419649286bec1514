"""Balance about a pose: what is left of all forces, which motions are free, what answers them.

What is rigid (joints, contacts that press, stops, what sticks) leaves motions Z free. The engine's
step from rest tells the acceleration a with everything in it; what is left over along Z is
Z^T M a, for what rigid things carry does no work there. What is not rigid pushes back with K
(:mod:`sandbox.samples.yielding`). At rest Z^T M a = 0, and it is stable if no w^2 of Z^T K Z z =
w^2 Z^T M Z z is below 0.

Stiff springs and cords are taken at the step's end by the engine, dampers at its middle: along
them forces have fallen by e a already, e = h (c + h k) or h c / 2, which is added again.
"""

from __future__ import annotations

import numpy as np

from sandbox.engine.stiffness import stiff_cords, stiff_servos, too_stiff
from sandbox.engine.still import Still
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.samples.yielding import NOTHING, Elastic, Yielding

RANK = 1e-9
"""Directions with a smaller share of the largest are rounding."""


class PoseBalance:
    """What holds in a pose, as one step from rest has it.

    Args:
        still: where a step was made and kept.
        run: the one sample of it.
        size: of the mechanism, by which turns are measured [m].

    Raises:
        ArithmeticError: contacts whose place is not told, as in a notch.
    """

    def __init__(self, still: Still, run: Recording, size: float) -> None:
        self.still, self.run, self.size = still, run, size
        self.yielding = Yielding(run, 0, size)
        bodies = np.array(sorted(self.yielding.place), dtype=np.int64)
        self.bodies: Integers = bodies
        """Numbers of the free bodies; of each x, y and turn, in this order, are the n freedoms."""
        self.scale = np.tile([1.0, 1.0, 1 / size], len(bodies))
        self.mass = still.mass[bodies].reshape(-1)
        """[n]"""
        kept = np.array(self.yielding.kept).reshape(-1, len(self.mass)) * self.scale
        length = np.linalg.norm(kept, axis=1, keepdims=True)
        self._rows = (kept / np.maximum(length, 1e-300))[length[:, 0] > 0]
        self.free = self._motions()
        """Motions that nothing rigid forbids, turns in lengths, orthonormal [n, k]."""
        self.speed = still.speed[bodies].reshape(-1)
        """After the step from rest, [n]."""
        self.whole = self._scaled(self.yielding.stiffness)
        """What pushes back, of all motions, [n, n] N/m."""
        self.stiffness = self.free.T @ self.whole @ self.free
        """[k, k] N/m"""
        self.inertia = self.free.T @ (self.scale**2 * self.mass * self.free.T).T
        """[k, k] kg"""
        self.force = self.scale * self._force()
        """What is left of all forces, with those that rigid things carry, [n] N."""
        self.left = self.free.T @ self.force
        """What is left of all forces along free motions, [k] N."""

    def _scaled(self, matrix: Array) -> Array:
        return np.asarray(self.scale * matrix * self.scale[:, None])

    def _motions(self) -> Array:
        n = len(self.mass)
        if not len(self._rows):
            return np.eye(n)
        _, values, right = np.linalg.svd(self._rows)
        rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
        return np.asarray(right[rank:].T)

    def _force(self) -> Array:
        """M a, and what was taken off it as the step's end has it, [n]."""
        a = self.speed / self.still.step_size
        force = self.mass * a
        for each in self.yielding.elastic():
            force = force + self._eased(each) * float(each.pull @ a) * each.pull
        return np.asarray(force)

    def _eased(self, each: Elastic) -> float:
        model, h = self.still.model, self.still.step_size
        if each.kind == "spring":
            c = float(model.springs.damping[each.number])
            law = model.springs.law[each.number] is not None
            stiff = law or bool(too_stiff(model, h)[each.number])
        elif each.kind == "tendon":
            c = float(model.tendons.damping[each.number])
            stiff = bool(stiff_cords(model, h)[each.number])
        else:
            c, stiff = 0.0, bool(stiff_servos(model, h)[each.number])
        return h * (c + h * each.stiffness) if stiff else h * c / 2

    def closing(self) -> Array:
        """The motion of the step that closes what is open: across free motions, [n] scaled."""
        if not len(self._rows):
            return np.zeros_like(self.mass)
        ask = self._rows @ (self.speed / self.scale) * self.still.step_size
        return np.asarray(np.linalg.lstsq(self._rows, ask, rcond=RANK)[0])

    def moved(self, motion: Array) -> Array:
        """Where a motion [n], scaled, leads all bodies from where they are, [nb, 3]."""
        return self.pose_after(self.still.pose, motion)

    def pose_after(self, pose: Array, motion: Array) -> Array:
        """A pose after a motion [n], scaled, [nb, 3]."""
        after = pose.copy()
        after[self.bodies] += (self.scale * motion).reshape(-1, 3)
        return after

    def way_from(self, one: Array, other: Array) -> Array:
        """The motion between two poses, scaled, [n]."""
        return np.asarray((other - one)[self.bodies].reshape(-1) / self.scale)

    @property
    def stable(self) -> bool:
        """Whether nothing leads away, to rounding."""
        if not self.free.shape[1]:
            return True
        values = np.linalg.eigvalsh((self.stiffness + self.stiffness.T) / 2)
        return bool(values[0] >= -NOTHING * self.largest / self.size)

    @property
    def largest(self) -> float:
        """The largest force on anything [N]."""
        return self.yielding.largest

    def modes(self) -> tuple[Array, Array]:
        """w^2 [1/s^2] in order [k], and the motions, scaled, columns [n, k]."""
        if not self.free.shape[1]:
            return np.zeros(0), np.zeros((len(self.mass), 0))
        root = np.linalg.cholesky(self.inertia)
        half = np.linalg.solve(root, (self.stiffness + self.stiffness.T) / 2)
        values, vectors = np.linalg.eigh(np.linalg.solve(root, half.T))
        return values, self.free @ np.linalg.solve(root.T, vectors)
