"""A scene along one of its values: the mechanisms, and points of rest that hang together.

A point is a pose and a value. Along a branch of equilibria Z^T f(x, p) = 0, so a step (Z z + c, dp)
keeps balance where K z = Z^T (df/dp - K c) dp, c being how joints move with the value: a line in
the space of z and dp, found as the direction that [K, -f_p] takes to nothing. At a fold dp = 0.
Newton's method on balance and on the distance gone along that line finds the next point, round
folds, too (pseudo-arclength continuation, Keller 1977).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sandbox.equilibria.balance import PoseBalance
from sandbox.equilibria.polish import EXACT, solved
from sandbox.equilibria.search import Search
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism

NUDGE = 1e-5
"""Share of the range by which the value is changed to see what hangs on it."""
TIMES = 12
"""Iterations of a point."""
WITHIN = 1e-9
"""Share of the range within which a value is met."""


@dataclass(frozen=True)
class OnBranch:
    """One equilibrium of a branch."""

    value: float
    pose: Array
    """Of the centres of mass, [nb, 3]."""
    balance: PoseBalance
    way: Array
    """Unit direction of the branch: motions over the size [n], then the value over the range."""

    @property
    def turning(self) -> float:
        """How the value changes along the branch; 0 at a fold."""
        return float(self.way[-1])


class Along:
    """Mechanisms of one scene by the value of one of its fields.

    Args:
        make: the mechanism of a value.
        time: of the values of drives [s]; None for the end of each.
        span: of the values, to measure steps by.

    Raises:
        SceneError: as :class:`~sandbox.equilibria.search.Search`.
    """

    def __init__(
        self, make: Callable[[float], Mechanism], time: float | None, span: float,
    ) -> None:
        self._make, self._time, self.span = make, time, span
        self._made: dict[float, Search] = {}

    def at(self, value: float) -> Search:
        """The mechanism of a value, to look for rest in."""
        if value not in self._made:
            mechanism = self._make(value)
            time = mechanism.run.duration if self._time is None else self._time
            while len(self._made) > 2:
                del self._made[next(iter(self._made))]
            self._made[value] = Search(mechanism, time)
        return self._made[value]

    def met(self, value: float, pose: Array) -> PoseBalance | None:
        """Rest of a value near a pose, by Newton's method."""
        search = self.at(value)
        search.start(pose)
        try:
            return search.polished()
        except ArithmeticError:
            return None

    def point(self, value: float, balance: PoseBalance, ahead: Array | None) -> OnBranch:
        """A point of rest with the branch's direction, that on from ``ahead``; up by default."""
        search, n = self.at(value), len(balance.mass)
        pose = balance.still.pose
        size = balance.size
        slope, closing = self._slope(value, pose, balance)
        # unknowns: z over the size, the value over the span
        rows = np.column_stack([balance.stiffness * size, -slope * self.span])
        weight = np.abs(rows).max(initial=1e-300)
        right = np.linalg.svd(rows / weight)[2] if len(rows) else np.eye(1)
        z, dp = right[-1][:-1], float(right[-1][-1])
        way = np.append(balance.free @ z + closing * dp * self.span / size, dp)
        way /= np.linalg.norm(way)
        if (way @ ahead if ahead is not None and len(ahead) == n + 1 else dp) < 0:
            way = -way
        search.start(pose)
        return OnBranch(value, pose, balance, way)

    def _slope(self, value: float, pose: Array, balance: PoseBalance) -> tuple[Array, Array]:
        """How forces along free motions change with the value, and how joints move with it."""
        by = NUDGE * self.span
        search = self.at(value + by)
        search.start(pose)
        more = search.look()
        closing = (more.closing() - balance.closing()) / by
        slope = balance.free.T @ ((more.force - balance.force) / by - balance.whole @ closing)
        return slope, closing

    def step(self, point: OnBranch, length: float) -> OnBranch | None:
        """The point so far along a branch; None where Newton's method does not find it."""
        size, n = point.balance.size, len(point.balance.mass)
        value = point.value + length * float(point.way[-1]) * self.span
        pose = point.balance.pose_after(point.pose, point.way[:-1] * length * size)
        balance: PoseBalance | None = None
        for _ in range(TIMES):
            search = self.at(value)
            search.start(pose)
            try:
                balance = search.look()
            except ArithmeticError:
                return None
            if len(balance.mass) != n:
                return None
            gone = np.append(balance.way_from(point.pose, pose) / size,
                             (value - point.value) / self.span)
            short = length - float(point.way @ gone)
            slope, closing = self._slope(value, pose, balance)
            z, dp = self._corrected(point, balance, slope, closing, short)
            motion = balance.free @ z + balance.closing() + closing * dp
            if max(np.abs(motion).max(initial=0.0) / size, abs(dp) / self.span) <= 10 * EXACT:
                search.start(pose)
                return self.point(value, search.look(), point.way)
            if np.abs(motion).max() > 4 * abs(length) * size or not np.isfinite(dp):
                return None
            pose = balance.pose_after(pose, motion)
            value += dp
        return None

    def _corrected(
        self, point: OnBranch, balance: PoseBalance, slope: Array, closing: Array, short: float,
    ) -> tuple[Array, float]:
        """Motion along free directions [k] and change of the value that balance and go on."""
        size, k = balance.size, len(balance.left)
        system = np.zeros((k + 1, k + 1))
        system[:k, :k], system[:k, k] = balance.stiffness, -slope
        system[k, :k] = balance.free.T @ point.way[:-1] / size
        system[k, k] = point.way[-1] / self.span + point.way[:-1] @ closing / size
        right = np.append(balance.left, short - point.way[:-1] @ balance.closing() / size)
        rows = np.abs(system).max(axis=1)
        rows[rows == 0] = 1.0
        columns = np.append(np.ones(k), self.span / size)
        found = columns * solved(system / rows[:, None] * columns, right / rows)
        return found[:k], float(found[k])
