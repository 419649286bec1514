"""Equilibria followed along a value of the scene, with their folds: :func:`rest_along`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from sandbox.equilibria.balance import PoseBalance
from sandbox.equilibria.following import WITHIN, Along, OnBranch
from sandbox.equilibria.rest import AtRest, sensible, settled
from sandbox.equilibria.restless import refuse
from sandbox.equilibria.search import Search, Unsettled
from sandbox.errors import Problem, SceneError, SimulationDiverged
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism

MOST_POINTS = 10
"""Times the count: a branch that is longer is cut off."""
MOST_BRANCHES = 8
MOST_VALUES = 10_000
SHORTEST = 1e-3
"""Of a step, of the usual one: where none leads on the branch ends."""
FOLDS = 40
"""Halvings, at most, by which a fold is placed."""
FLAT = 1e-7
"""A branch that turns so little is at its fold: the value is off by the square of it."""
BEYOND = 1e-3
"""Share of the range beyond a fold from which the mechanism is let go."""
NEAR = 1e-3
"""Of the size: what stands so near to a branch at the same value is on it, and what stands nearer
than a quarter of the way between its points."""


@dataclass(frozen=True)
class BranchRest:
    """One equilibrium along a branch."""

    value: float
    rest: AtRest
    fold: bool
    """Whether the branch turns back here."""


@dataclass
class Branch:
    """Equilibria that hang together, in order along the branch."""

    stops: list[BranchRest] = field(default_factory=list)
    ends: str = ""
    """Why it ends before the range does, in words; empty if it does not."""

    def __repr__(self) -> str:
        return f"<Branch: {len(self.stops)} at rest, {len(self.folds)} folds>"

    @property
    def folds(self) -> list[BranchRest]:
        """Where it turns back."""
        return [stop for stop in self.stops if stop.fold]


def rest_along(
    make: Callable[[float], Mechanism], begin: float, end: float, count: int, *,
    at: float | None = None, stages: int | None = None,
    heard: Callable[[int, float], None] | None = None,
) -> list[Branch]:
    """Follow the equilibrium of a mechanism along a value, round folds.

    The first branch begins at rest under a slow load, at the first value. Where one turns back and
    leaves the range again where it began, or ends, the mechanism is let go beyond that place, and
    from where it comes to rest then the next branch is followed.

    Args:
        make: the mechanism of a value.
        begin: the first value.
        end: the last one.
        count: of values, evenly from first to last, at which there is a point of rest; between
            them as many more as folds take.
        at: the time whose values of drives are held [s]; by default the end of the scene.
        stages: as for :func:`~sandbox.equilibria.rest.rest`.
        heard: is told of each point how many there are, and its value.

    Raises:
        SceneError: as :func:`~sandbox.equilibria.rest.rest`; a range of one value, fewer than two
            values; a mechanism whose stiffness is not told, along which nothing leads on.
    """
    if not begin != end or not 2 <= count <= MOST_VALUES:
        raise SceneError([Problem("bad-argument",
                                  f"{begin:g} to {end:g} in {count} values is no range", "along",
                                  allowed=f"two different values and a count of 2 to {MOST_VALUES}"
                                  )])
    for value in (end, begin):  # what no field takes is told before anything is followed
        mechanism = make(value)
        refuse(mechanism)
        sensible(mechanism, at, stages)
    following = Along(make, at, abs(end - begin))
    search = following.at(begin)
    try:
        search.follow(stages)
        first = _rest_of(search)
    except (Unsettled, SimulationDiverged) as error:
        raise SceneError([Problem("no-rest", f"it does not come to rest at {begin:g}: {error}",
                                  "along")]) from None
    if first.balance is None:
        raise SceneError([Problem(
            "no-rest",
            f"it can't be followed along a value: its stiffness is not told, for {first.untold}",
            "along", allowed="--set, value by value")])
    return _Tracer(following, begin, end, count, heard).all(first.balance)


def _rest_of(search: Search, balance: PoseBalance | None = None) -> AtRest:
    before = search.relaxation.moved
    if balance is None:
        return settled(search, "", before)
    return AtRest(balance.run, "", balance, "", 0, search.size)


class _Tracer:
    """Follows branches within a range."""

    def __init__(
        self, along: Along, begin: float, end: float, count: int,
        heard: Callable[[int, float], None] | None,
    ) -> None:
        self.along, self.begin, self.end, self.count = along, begin, end, count
        self.sense = 1.0 if end > begin else -1.0
        self.grid = np.linspace(begin, end, count)
        self.length = 1.0 / (count - 1)
        self.branches: list[Branch] = []
        self.points = 0
        self._heard = heard

    def all(self, first: PoseBalance) -> list[Branch]:
        """All branches, beginning with that of an equilibrium of the first value."""
        goes_through, branch = self._follow(self.begin, first, self.sense)
        self.branches.append(branch)
        while not goes_through and len(self.branches) < MOST_BRANCHES:
            found = self._let_go(branch)
            if found is None:
                break
            _, before = self._follow(*found, -self.sense)
            goes_through, branch = self._follow(*found, self.sense)
            self.branches.append(Branch([*before.stops[:0:-1], *branch.stops],
                                        branch.ends or before.ends))
        return self.branches

    def _follow(self, value: float, balance: PoseBalance, sense: float) -> tuple[bool, Branch]:
        """One branch from a point on, and whether it leaves the range at its end.

        It begins towards higher values (``sense`` 1) or lower ones (-1).
        """
        branch = Branch()
        point = self.along.point(value, balance, None)
        if point.turning * sense < 0:
            point = OnBranch(point.value, point.pose, point.balance, -point.way)
        self._add(branch, point)
        for _ in range(MOST_POINTS * self.count):
            step = self._next(point)
            if step is None:
                branch.ends = f"it is lost beyond {point.value:.6g}"
                return False, branch
            if step.turning * point.turning < 0:
                fold = self._fold(point, step)
                self._add(branch, fold, fold=True)
            if (step.value - self.begin) * (step.value - self.end) > 0:
                step = self._onto(point, self._edge(step.value)) or point
            if step is not point:
                self._add(branch, step)
            point = step
            at_edge = abs(point.value - self._edge(point.value)) <= WITHIN * self.along.span
            if at_edge and self._leaves(point):
                return self._edge(point.value) == self.end, branch
        branch.ends = f"it goes on at {point.value:.6g}"
        return False, branch

    def _edge(self, value: float) -> float:
        """The end of the range that a value is nearer to."""
        return min((self.begin, self.end), key=lambda edge: abs(value - edge))

    def _leaves(self, point: OnBranch) -> bool:
        inward = (self.begin + self.end) / 2 - point.value
        return point.turning * inward < 0

    def _next(self, point: OnBranch) -> OnBranch | None:
        """The next point: at the next value of the grid if that is near, else a length on."""
        if (onto := self._grid_value(point)) is not None and (
                found := self._onto(point, onto)) is not None:
            return found
        length = self.length
        while length > SHORTEST * self.length:
            found = self.along.step(point, length)
            if found is not None and found.way @ point.way > 0.5:
                return found
            length /= 4
        return None

    def _grid_value(self, point: OnBranch) -> float | None:
        """The next value that the branch leads to, if it does not bend much before."""
        ahead = (self.grid - point.value) * np.sign(point.turning)
        ahead = np.where(ahead > WITHIN * self.along.span, ahead, np.inf)
        k = int(np.argmin(ahead))
        if not np.isfinite(ahead[k]):
            return None
        far = ahead[k] / self.along.span / max(abs(point.turning), 1e-12)
        return float(self.grid[k]) if far <= 2 * self.length else None

    def _onto(self, point: OnBranch, value: float) -> OnBranch | None:
        """The branch's point of a value, near another; None where it is not there."""
        if not abs(point.turning) > 0:
            return None
        length = (value - point.value) / self.along.span / point.turning
        size = point.balance.size
        pose = point.balance.pose_after(point.pose, point.way[:-1] * length * size)
        balance = self.along.met(value, pose)
        if balance is None or len(balance.mass) != len(point.balance.mass):
            return None
        off = point.balance.way_from(pose, balance.still.pose) / size
        if np.abs(off).max() > max(0.5 * abs(length), 1e-9):
            return None
        found = self.along.point(value, balance, point.way)
        return found if found.way @ point.way > 0.5 else None

    def _fold(self, before: OnBranch, after: OnBranch) -> OnBranch:
        """Where the branch turns back between two points: where the value does not change."""
        low, high = 0.0, float(before.way @ np.append(
            before.balance.way_from(before.pose, after.pose) / before.balance.size,
            (after.value - before.value) / self.along.span))
        ends = [before.turning, after.turning]
        best = before if abs(before.turning) < abs(after.turning) else after
        for k in range(FOLDS):
            share = ends[0] / (ends[0] - ends[1])
            share = 0.5 if k % 3 == 2 else min(max(share, 0.01), 0.99)
            at = low + share * (high - low)
            point = self.along.step(before, at)
            if point is None:
                return best
            if abs(point.turning) < abs(best.turning):
                best = point
            if abs(point.turning) <= FLAT:
                return point
            if point.turning * ends[0] > 0:
                low, ends[0] = at, point.turning
            else:
                high, ends[1] = at, point.turning
        return best

    def _let_go(self, branch: Branch) -> tuple[float, PoseBalance] | None:
        """Rest beyond one of the branch's folds, or its end, that is on no branch yet."""
        for stop in (*branch.folds, branch.stops[-1]):
            value = stop.value + BEYOND * self.sense * self.along.span
            if (value - self.end) * self.sense > 0:
                continue
            search = self.along.at(value)
            search.start(_centres(search, stop.rest.recording.arrays["body_pose"][0]))
            try:
                rest = _rest_of(search)
            except (Unsettled, SimulationDiverged):
                continue
            if rest.balance is not None and not self._known(value, rest):
                return value, rest.balance
        return None

    def _known(self, value: float, rest: AtRest) -> bool:
        """Whether some branch has that rest between two of its points."""
        place = _places(rest)
        for branch in self.branches:
            for one, two in pairwise(branch.stops):
                if not min(one.value, two.value) <= value <= max(one.value, two.value):
                    continue
                share = (value - one.value) / ((two.value - one.value) or 1.0)
                begin, end = _places(one.rest), _places(two.rest)
                off = np.abs(begin + share * (end - begin) - place).max()
                if off <= NEAR * rest.size + np.abs(end - begin).max() / 4:
                    return True
        return False

    def _add(self, branch: Branch, point: OnBranch, *, fold: bool = False) -> None:
        search = self.along.at(point.value)
        branch.stops.append(BranchRest(point.value, _rest_of(search, point.balance), fold))
        self.points += 1
        if self._heard:
            self._heard(self.points, point.value)


def _places(rest: AtRest) -> Array:
    """Where bodies are, and how they are turned, in lengths, [nb, 3] m."""
    return np.asarray(rest.recording.arrays["body_pose"][0] * (1.0, 1.0, rest.size))


def _centres(search: Search, frames: Array) -> Array:
    """Poses of frames as those of centres of mass, [nb, 3]."""
    c, s = np.cos(frames[:, 2]), np.sin(frames[:, 2])
    x, y = search.model.bodies.centre.T
    return np.asarray(frames + np.stack([c * x - s * y, s * x + c * y, 0 * x], axis=1))

