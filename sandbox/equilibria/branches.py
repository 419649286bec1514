"""Equilibria along a parameter of a scene, through folds: :func:`rest_along`.

A point is a pose and a value. Along a branch Z^T f(x, p) = 0, so a step (Z z + c, dp) keeps balance
where K z = Z^T (df/dp - K c) dp, with c the motion of joints with the value. Newton's method for
balance and for the length along this direction finds the next point, also at folds, where dp = 0
(pseudo-arclength continuation, Keller 1977).
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from sandbox.engine.inspect_control import checked
from sandbox.equilibria.rest import AtRest, check_options, rest, settle
from sandbox.equilibria.settle import EXACT, PoseBalance, Settler, Unsettled, solve
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism

MAX_POINTS = 10  # points of a branch, times the count
MAX_BRANCHES = 8
MAX_VALUES = 10_000
MAX_ITERATIONS = 12  # of Newton's method for a point
SHORTEST = 1e-3  # shortest step, relative to the usual one; where none leads on, the branch ends
FLAT = 1e-7  # change of the value along the branch at a fold; the value there is off by its square
BEYOND = 1e-3  # fraction of the range beyond a fold from which the mechanism is released
NEAR = 1e-3  # distance of a point on a branch, relative to the size; or 1/4 of its points' distance
NUDGE = 1e-5  # fraction of the range by which the value is changed for derivatives
WITHIN = 1e-9  # fraction of the range within which a value is met
Make = Callable[[float], Mechanism]


@dataclass(frozen=True)
class BranchRest:
    """One equilibrium of a branch."""

    value: float
    rest: AtRest
    balance: PoseBalance  # that of the equilibrium
    pose: Array  # of the centres of mass, [nb, 3]
    way: Array  # unit vector along the branch: motions / size [n], the value / range
    fold: bool = False  # whether the branch turns back here

    @property
    def turning(self) -> float:
        """Change of the value along the branch; 0 at a fold."""
        return float(self.way[-1])

    def ahead(self, length: float) -> Array:
        """The pose at a length along the tangent, [nb, 3]."""
        return self.balance.pose_after(self.pose, self.way[:-1] * length * self.balance.size)


@dataclass(repr=False)
class Branch:
    """Connected equilibria, in order along the branch."""

    stops: list[BranchRest] = field(default_factory=list)
    ends: str = ""  # Why it ends within the range; empty if it does not

    @property
    def folds(self) -> list[BranchRest]:
        """Points where it turns back."""
        return [stop for stop in self.stops if stop.fold]


def rest_along(
    make: Make, begin: float, end: float, count: int, *, at: float | None = None,
    stages: int | None = None, on_point: Callable[[int, float], None] = lambda points, value: None,
) -> list[Branch]:
    """Follow the equilibria of a mechanism along a value, through folds.

    The first branch starts at the equilibrium of a slow load at the first value. Where a branch
    ends, or turns back and leaves the range where it began, the mechanism is released just beyond,
    and the next branch starts where it comes to rest.

    Args:
        make: the mechanism of a value.
        begin: the first value.
        end: the last one.
        count: number of evenly spaced values that have a point; more lie between them at folds.
        at: the time whose values the drives have [s]; by default the end of the scene.
        stages: as of :func:`~sandbox.equilibria.rest.rest`.
        on_point: called at each point with the number of points and its value.

    Raises:
        SceneError: as of :func:`~sandbox.equilibria.rest.rest`; a range of one value, or fewer than
            two values; a mechanism whose stiffness is unknown.
    """
    if not begin != end or not 2 <= count <= MAX_VALUES:
        raise SceneError([Problem(
            "bad-argument",
            f"{begin:g} to {end:g} in {count} values is no range", "along",
            allowed=f"two different values and a count of 2 to {MAX_VALUES}")])
    check_options(checked(make(end), ()), at, stages)  # before anything runs
    first = rest(make(begin), at=at, stages=stages).rests[0]
    if first.balance is None:
        raise SceneError([Problem(
            "no-rest",
            "the equilibrium cannot be followed along a value: its stiffness is not defined, for "
            f"{first.untold}",
            "along", allowed="--set, value by value")])
    return _Follower(make, at, begin, end, count, on_point).follow_all(first.balance)


class _Follower:
    """Follows branches within a range; arguments as of :func:`rest_along`."""

    def __init__(
        self, make: Make, time: float | None, begin: float, end: float, count: int,
        on_point: Callable[[int, float], None],
    ) -> None:
        self._make, self._time, self._on_point, self._count = make, time, on_point, count
        self._begin, self._end, self._grid = begin, end, np.linspace(begin, end, count)
        self._span, self._sense = abs(end - begin), 1.0 if end > begin else -1.0
        self._length, self._points = 1.0 / (count - 1), 0
        self._made: dict[float, Settler] = {}
        self._branches: list[Branch] = []

    def at(self, value: float) -> Settler:
        """The mechanism of a value; of the last few they are kept."""
        if value not in self._made:
            mechanism = self._make(float(value))
            if len(self._made) > 2:
                del self._made[next(iter(self._made))]
            self._made[value] = Settler(
                mechanism, mechanism.run.duration if self._time is None else self._time)
        return self._made[value]

    def _point(self, value: float, balance: PoseBalance, ahead: Array | None) -> BranchRest:
        """A point, with the direction of its branch along ``ahead``; upwards by default."""
        pose, size = balance.still.pose, balance.size
        slope, closing = self._derivatives(value, pose, balance)
        rows = np.column_stack([balance.stiffness * size, -slope * self._span])
        weight = np.abs(rows).max(initial=1e-300)
        null = np.linalg.svd(rows / weight)[2][-1] if len(rows) else np.ones(1)
        dp = float(null[-1])
        way = np.append(balance.free @ null[:-1] + closing * dp * self._span / size, dp)
        way /= np.linalg.norm(way)
        if (way @ ahead if ahead is not None and len(ahead) == len(way) else dp) < 0:
            way = -way
        self.at(value).start(pose)
        return BranchRest(value, AtRest(balance.run, "", balance, "", 0, size), balance, pose, way)

    def _derivatives(self, value: float, pose: Array, balance: PoseBalance) -> tuple[Array, Array]:
        """By the value: forces along free motions, and the motion of joints."""
        by = NUDGE * self._span
        settler = self.at(value + by)
        settler.start(pose)
        more = settler.look()
        closing = (more.closing() - balance.closing()) / by
        slope = balance.free.T @ ((more.force - balance.force) / by - balance.whole @ closing)
        return slope, closing

    def _onto(self, point: BranchRest, value: float) -> BranchRest | None:
        """The point of a value near another; None where there is none on the branch."""
        if point.turning == 0:
            return None
        length = (value - point.value) / self._span / point.turning
        found = self._step(point, length, value)
        return found if found is not None and found.way @ point.way > 0.5 else None

    def _step(
        self, point: BranchRest, length: float, target: float | None = None,
    ) -> BranchRest | None:
        """The point at a length along the branch, or of a target value near there.

        None where Newton's method fails.
        """
        size, value = point.balance.size, point.value + length * point.turning * self._span
        value, pose = value if target is None else target, point.ahead(length)
        for _ in range(MAX_ITERATIONS):
            settler = self.at(value)
            settler.start(pose)
            try:
                balance = settler.look()
            except ArithmeticError:
                return None
            if len(balance.mass) != len(point.balance.mass):
                return None
            if target is not None:
                z, dp = solve(balance.stiffness, balance.left), 0.0
                motion = balance.free @ z + balance.closing()
            else:  # motions along free directions z and the change of the value dp
                slope, closing = self._derivatives(value, pose, balance)
                k, way = len(balance.left), point.way
                missing = length - self._along(point, value, pose)
                system = np.zeros((k + 1, k + 1))
                system[:k, :k], system[:k, k] = balance.stiffness, -slope
                system[k, :k] = balance.free.T @ way[:-1] / size
                system[k, k] = point.turning / self._span + way[:-1] @ closing / size
                right = np.append(balance.left, missing - way[:-1] @ balance.closing() / size)
                rows = np.abs(system).max(axis=1)
                rows[rows == 0] = 1.0
                columns = np.append(np.ones(k), self._span / size)
                change = columns * solve(system / rows[:, None] * columns, right / rows)
                dp = float(change[-1])
                motion = balance.free @ change[:-1] + balance.closing() + closing * dp
            if max(np.abs(motion).max(initial=0.0) / size, abs(dp) / self._span) <= 10 * EXACT:
                settler.start(pose)
                return self._point(value, settler.look(), point.way)
            if np.abs(motion).max() > 4 * abs(length) * size or not np.isfinite(dp):
                return None
            pose = balance.pose_after(pose, motion)
            value += float(dp)
        return None

    def _along(self, point: BranchRest, value: float, pose: Array) -> float:
        balance = point.balance
        motion = (pose - point.pose)[balance.bodies].reshape(-1) / balance.scale / balance.size
        return float(point.way @ np.append(motion, (value - point.value) / self._span))

    def follow_all(self, first: PoseBalance) -> list[Branch]:
        passed, branch = self._follow(self._begin, first, self._sense)
        self._branches.append(branch)
        while not passed and len(self._branches) < MAX_BRANCHES and (
                found := self._release(branch)) is not None:
            _, before = self._follow(*found, -self._sense)
            passed, branch = self._follow(*found, self._sense)
            self._branches.append(Branch([*before.stops[:0:-1], *branch.stops],
                                         branch.ends or before.ends))
        return self._branches

    def _follow(self, value: float, balance: PoseBalance, sense: float) -> tuple[bool, Branch]:
        """Whether a branch, up or down by ``sense``, leaves the range at its end; the branch."""
        branch = Branch()
        point = self._point(value, balance, None)
        if point.turning * sense < 0:
            point = replace(point, way=-point.way)
        self._add(branch, point)

        def edge(value: float) -> float:
            return min((self._begin, self._end), key=lambda end: abs(value - end))

        for _ in range(MAX_POINTS * self._count):
            step = self._next(point)
            if step is None:
                branch.ends = f"it is lost beyond {point.value:.6g}"
                return False, branch
            if step.turning * point.turning < 0:
                self._add(branch, self._fold(point, step), fold=True)
            if (step.value - self._begin) * (step.value - self._end) > 0:
                step = self._onto(point, edge(step.value)) or point
            if step is not point:
                self._add(branch, step)
            point = step
            inward = (self._begin + self._end) / 2 - point.value
            near = edge(point.value)
            if abs(point.value - near) <= WITHIN * self._span and point.turning * inward < 0:
                return near == self._end, branch
        branch.ends = f"it goes on at {point.value:.6g}"
        return False, branch

    def _next(self, point: BranchRest) -> BranchRest | None:
        """The point of the next value of the grid if that is near, else one at a length."""
        ahead = (self._grid - point.value) * np.sign(point.turning)
        ahead = np.where(ahead > WITHIN * self._span, ahead, np.inf)
        k = int(np.argmin(ahead))
        near = ahead[k] / self._span <= 2 * self._length * max(abs(point.turning), 1e-12)
        if near and (found := self._onto(point, float(self._grid[k]))) is not None:
            return found
        length = self._length
        while length > SHORTEST * self._length:
            found = self._step(point, length)
            if found is not None and found.way @ point.way > 0.5:
                return found
            length /= 4
        return None

    def _fold(self, before: BranchRest, after: BranchRest) -> BranchRest:
        """The fold between two points: where the value does not change along the branch."""
        from scipy.optimize import brentq
        tried = [before, after]

        def turning(length: float) -> float:
            if (point := self._step(before, length)) is None:
                raise ArithmeticError
            tried.append(point)
            return 0.0 if abs(point.turning) <= FLAT else point.turning

        length = self._along(before, after.value, after.pose)
        with suppress(ArithmeticError, ValueError):  # no point between them, or no sign change
            brentq(turning, 0.0, length, xtol=1e-15)
        return min(tried, key=lambda point: abs(point.turning))

    def _release(self, branch: Branch) -> tuple[float, PoseBalance] | None:
        """An equilibrium beyond a fold or the end of a branch that is on no branch yet."""
        for stop in (*branch.folds, branch.stops[-1]):
            value = stop.value + BEYOND * self._sense * self._span
            if (value - self._end) * self._sense > 0:
                continue
            settler = self.at(value)
            settler.start(stop.pose)
            try:
                rest = settle(settler, "", settler.steps)
            except (Unsettled, SimulationDiverged):
                continue
            if rest.balance is not None and not self._known(value, rest):
                return value, rest.balance
        return None

    def _known(self, value: float, rest: AtRest) -> bool:
        def positions(rest: AtRest) -> Array:  # angles times the size, [nb, 3] m
            return np.asarray(rest.recording.arrays["body_pose"][0] * (1.0, 1.0, rest.size))

        for branch in self._branches:
            for one, two in pairwise(branch.stops):
                if not min(one.value, two.value) <= value <= max(one.value, two.value):
                    continue
                share = (value - one.value) / ((two.value - one.value) or 1.0)
                begin, end = positions(one.rest), positions(two.rest)
                off = np.abs(begin + share * (end - begin) - positions(rest)).max()
                if off <= NEAR * rest.size + np.abs(end - begin).max() / 4:
                    return True
        return False

    def _add(self, branch: Branch, point: BranchRest, *, fold: bool = False) -> None:
        branch.stops.append(replace(point, fold=fold))
        self._points += 1
        self._on_point(self._points, point.value)
