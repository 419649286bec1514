"""Force balance at a pose: residual forces, free motions and stiffness.

Constraints (joints, pressing contacts, limits, sticking friction) leave motions Z free. One step of
the engine from rest gives the acceleration a under all forces; the residual along Z is Z^T M a,
since constraint forces do no work there. Everything else has a stiffness K
(:mod:`sandbox.samples.yielding`). In equilibrium Z^T M a = 0; it is stable if all w^2 of
Z^T K Z z = w^2 Z^T M Z z are positive.

The engine evaluates stiff springs and tendons at the end of the step, dampers at its middle: along
them forces have already dropped by e a, e = h (c + h k) or h c / 2, which is added again.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.linalg import eigvalsh, null_space

from sandbox.engine.stiffness import stiff_cables, stiff_servos, too_stiff
from sandbox.engine.still import Still
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.samples.yielding import NOTHING, Yielding

RANK = 1e-9  # relative size of directions, and of stiffness, that are rounding


class PoseBalance:
    """Residual forces, free motions and stiffness at a pose.

    ``still`` is the engine after one step from rest, which ``run`` has recorded. ``size`` is the
    length that is equivalent to 1 rad [m].
    """

    def __init__(self, still: Still, run: Recording, size: float) -> None:
        self.still, self.run, self.size = still, run, size
        self.yielding = Yielding(run, 0, size)
        bodies = np.array(sorted(self.yielding.place), dtype=np.int64)
        self.bodies: Integers = bodies  # indices of the free bodies
        self.scale = np.tile([1.0, 1.0, 1 / size], len(bodies))
        self.mass = still.mass[bodies].reshape(-1)
        kept = np.array(self.yielding.kept).reshape(-1, len(self.mass)) * self.scale
        length = np.linalg.norm(kept, axis=1, keepdims=True)
        self._rows = (kept / np.maximum(length, 1e-300))[length[:, 0] > 0]
        self.free: Array = null_space(self._rows, rcond=RANK)
        """Motions that no constraint forbids, rotations as lengths, orthonormal [n, k]."""
        self.speed = still.speed[bodies].reshape(-1)  # velocities after the step from rest, [n]
        self.whole = np.asarray(self.scale * self.yielding.stiffness * self.scale[:, None])
        """Stiffness of all motions, [n, n] N/m."""
        self.stiffness = self.free.T @ self.whole @ self.free  # [k, k] N/m
        self.force = self.scale * self._force()  # residual forces, with constraint forces, [n] N
        self.largest = self.yielding.largest  # the largest force on anything [N]
        self.left = self.free.T @ self.force  # residual forces along free motions, [k] N

    def _force(self) -> Array:
        """M a, corrected for forces at the end of the step, [n]."""
        model, h = self.still.model, self.still.step_size
        a = self.speed / h
        force = self.mass * a
        for each in self.yielding.elastic():
            if each.kind == "spring":
                c = float(model.springs.damping[each.number])
                law = model.springs.law[each.number] is not None
                stiff = law or bool(too_stiff(model, h)[each.number])
            elif each.kind == "tendon":
                c = float(model.tendons.damping[each.number])
                stiff = bool(stiff_cables(model, h)[each.number])
            else:
                c, stiff = 0.0, bool(stiff_servos(model, h)[each.number])
            drop = h * (c + h * each.stiffness) if stiff else h * c / 2  # e [kg]
            force = force + drop * float(each.pull @ a) * each.pull
        return np.asarray(force)

    def closing(self) -> Array:
        """The motion across free motions that closes gaps of constraints, [n] scaled."""
        gaps = self._rows @ (self.speed / self.scale) * self.still.step_size
        return solve(self._rows, gaps)

    def pose_after(self, pose: Array, motion: Array) -> Array:
        """A pose after a motion [n], scaled, [nb, 3]."""
        after = pose.copy()
        after[self.bodies] += (self.scale * motion).reshape(-1, 3)
        return after

    def motion_between(self, one: Array, other: Array) -> Array:
        """The motion from one pose to another, scaled, [n]."""
        return np.asarray((other - one)[self.bodies].reshape(-1) / self.scale)

    @cached_property
    def soft(self) -> tuple[Array, Array, float]:
        """Stiffness values in ascending order, their motions, and the value that counts as 0."""
        stiffness = (self.stiffness + self.stiffness.T) / 2
        return (*np.linalg.eigh(stiffness), NOTHING * self.largest / self.size)

    @property
    def stable(self) -> bool:
        """Whether no motion is unstable, up to rounding."""
        values, _, zero = self.soft
        return not len(values) or bool(values[0] >= -zero)

    def modes(self) -> Array:
        """w^2 of small free motions in ascending order [1/s^2]."""
        inertia = self.free.T @ (self.scale**2 * self.mass * self.free.T).T
        return np.asarray(eigvalsh((self.stiffness + self.stiffness.T) / 2, inertia))


def solve(matrix: Array, right: Array) -> Array:
    """The smallest solution, without directions that the matrix hardly affects, [n]."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=RANK)[0])
