"""Thresholds: the least pull that holds, the largest push, the smallest friction."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.draw.figure.sweeps import FoundLine
from sandbox.errors import SandboxError
from sandbox.numeric import Array, Flags
from sandbox.search.asking import Asking, Where, affordable, asking
from sandbox.search.bisection import NoBracketError, bisect
from sandbox.search.criteria import (
    Condition,
    RefusedError,
    conditions,
    holds,
    measures_as,
    why_none,
)
from sandbox.search.logistic import Posterior, posterior, wilson
from sandbox.search.question import Question
from sandbox.wording import told_of

WITHIN = 1e-3
"""Of the range: how narrow a bracket is, if nothing else is said."""
WITHIN_RANDOM = 0.05
LEAST = 1e-9
"""Of the range: narrower ones are rounding."""
ENDS, FIRST, BATCH = 8, 16, 8
"""Random starts at each end, between them at first, and at a time later."""
BINS = 10


@dataclass(frozen=True)
class ThresholdFound:
    """Where a condition begins or ceases to hold."""

    path: str
    unit: str
    """SI; empty for none."""
    low: float
    """Of the bracket, or of the 95 % interval, SI."""
    high: float
    holds_below: bool
    """Whether it is below that it holds."""
    condition: str
    runs: int
    certified: bool
    """Whether it is the same at half the step."""
    certificate: str
    """In which sense."""
    share: float = 1.0
    """Of random starts that hold at the threshold; 1 where nothing is random."""
    middle: float = float("nan")
    """The likeliest threshold, SI; the middle of a bracket."""
    shares: tuple[tuple[float, float, int, int, float, float], ...] = ()
    """With random starts: from, to, held, runs, and the 95 % interval of the share that holds."""
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def lines(self) -> list[str]:
        """What was found, for a person."""
        side = "below" if self.holds_below else "above"
        unit = f" {self.unit}" if self.unit else ""
        if not self.shares:
            told = [f"{self.condition} holds {side} {self.path} = {self.middle:.6g}{unit} "
                    f"(between {self.low:.8g} and {self.high:.8g}{unit}; {self.runs} runs)"]
        else:
            told = [f"{self.condition} holds for {100 * self.share:g} % of random starts at "
                    f"{self.path} = {self.middle:.6g}{unit}, for more {side} (95 % interval "
                    f"{self.low:.6g} to {self.high:.6g}{unit}; {self.runs} runs)"]
            told += [f"  {a:.4g} to {b:.4g}{unit}: {held} of {count} hold (share {low:.2f} to "
                     f"{high:.2f})" for a, b, held, count, low, high in self.shares]
        return [*told, *self.remarks,
                f"half the step: {'the same' if self.certified else 'NOT the same'}; "
                f"{self.certificate}"]


def find_threshold(
    question: Question, where: Sequence[str] = (), *, within: float | None = None,
    share: float = 0.5, runs: int = 200, seed: int = 0, place: Where | None = None,
) -> ThresholdFound:
    """Where a condition begins or ceases to hold along one range.

    Paths with a distribution are random starts: then it is where ``share`` of them hold.

    Args:
        question: one path with a range, and any with distributions.
        where: conditions such as ``"moved < 1 mm"``; without, the scene's expectations.
        within: how narrow the bracket or the interval is to be [SI]; by default a thousandth of
            the range, a twentieth with random starts.
        share: of random starts.
        runs: at most so many random starts.
        seed: of random starts.
        place: where it runs and what it leaves behind.

    Raises:
        NoBracketError: both ends have the same answer.
        RefusedError: not one range, or a word that does not fit it.
        SandboxError: a run without an answer.
    """
    space = question.space
    if len(space.spans) != 1 or space.lists:
        raise RefusedError("a threshold is looked for along one path with a range, as in "
                           f"'2 N:8 N', not {len(space.spans)}; others may have distributions, "
                           "as random starts")
    if not 0 < share < 1:
        raise RefusedError(f"a share of random starts is between 0 and 1, not {share:g}")
    wanted = conditions(where, question.kept)
    if not wanted and not question.plan.loaded.mechanism.expect:
        raise RefusedError("the scene expects nothing: say what must hold, as in \"moved < 1 mm\"")
    affordable(question, runs, seed)
    place = place or Where()
    path = space.spans[0]
    ends = _numbers(question, path, [0.0, 1.0])
    if within is not None:
        measures_as(within, space.units[path], f"'within' of {path}")
    narrow = None if within is None else within / abs(ends[1] - ends[0])
    if narrow is not None and not narrow >= LEAST:
        raise RefusedError(f"a bracket is no narrower than {LEAST:g} of the range, not {within:g}")
    with asking(question, place) as work:
        line = _OnePath(work, wanted, path, seed)
        try:
            found = _blurred(line, narrow or WITHIN_RANDOM, share, runs) if space.random else \
                _sharp(line, narrow or WITHIN)
        except NoBracketError as error:
            raise NoBracketError(
                f"{path} from {ends[0]:.6g} to {ends[1]:.6g} {space.units[path]} has no threshold "
                f"at its ends: {line.condition} {error} at both") from None
        if place.out:
            work.leave(place.out, "threshold", vars(found), wanted=wanted, line=_line(found),
                       where=where, within=within, share=share, runs=runs, seed=seed)
    return found


class _OnePath:
    """The range of one path, and random starts of the others."""

    def __init__(
        self, work: Asking, wanted: tuple[Condition, ...], path: str, seed: int,
    ) -> None:
        self.work, self._wanted, self.path, self.seed = work, wanted, path, seed
        self.space = work.question.space
        self.column = self.space.paths.index(path)
        self.condition = " and ".join(each.text for each in wanted) or "what the scene expects"

    def answers(
        self, shares: Sequence[float], *, first: int = 0, halved: bool = False,
    ) -> list[bool]:
        """Whether it holds at shares of the range, with random starts from the ``first`` on.

        Raises:
            SandboxError: a run has no answer.
        """
        points = np.array([np.random.default_rng([self.seed, first + k]).random(
            len(self.space.paths)) for k in range(len(shares))])
        points[:, self.column] = shares
        rows = self.work.rows(points, halved=halved)
        found = []
        for row, point in zip(rows, self.space.points(points), strict=True):
            answer = holds(row, self._wanted)
            if answer is None:
                raise SandboxError(f"with {self.path} = {point[self.path]} the run tells nothing "
                                   f"of whether {self.condition}: {why_none(row)}",
                                   code="no-answer")
            found.append(answer)
        return found

    def numbers(self, shares: Sequence[float]) -> list[float]:
        """Values of the path, SI."""
        return _numbers(self.work.question, self.path, shares)


def _line(found: ThresholdFound) -> FoundLine:
    """What the figure shows of it."""
    side = "below" if found.holds_below else "above"
    at = f"{found.middle:.6g} {found.unit}".rstrip()
    words = f"Dashed: {found.condition} holds {side} {at}." if not found.shares else (
        f"Dashed: {found.condition} holds for {100 * found.share:g} % of random starts at {at}, "
        f"for more {side}; shaded: its 95 % interval.")
    return FoundLine(found.path, found.low, found.middle, found.high, words)


def _numbers(question: Question, path: str, shares: Sequence[float]) -> list[float]:
    space = question.space
    points = np.full((len(shares), len(space.paths)), 0.5)
    column = space.paths.index(path)
    points[:, column] = shares
    return [float(value) for value in space.numbers(points)[:, column]]


def _sharp(line: _OnePath, within: float) -> ThresholdFound:
    found = bisect(line.answers, within)
    low, middle, high = line.numbers([found.low, (found.low + found.high) / 2, found.high])
    unit = line.space.units[line.path]
    again = line.answers([found.low, found.high], halved=True)
    if certified := again == [found.low_holds, not found.low_holds]:
        certificate = "both ends of the bracket answer as before"
    else:
        try:
            other = bisect(lambda shares: line.answers(shares, halved=True), within)
            ends = line.numbers([other.low, other.high])
            certificate = f"there it is between {ends[0]:.8g} and {ends[1]:.8g} {unit}".rstrip()
        except NoBracketError as error:
            certificate = f"there it {error} at both ends of the range"
    remarks = (f"the answer changes {found.turns} times along the range: this is one of several "
               "thresholds",) if found.turns > 1 else ()
    return ThresholdFound(
        line.path, unit, low, high, found.low_holds, line.condition, len(found.answers),
        certified, certificate, middle=middle, remarks=remarks)


def _blurred(line: _OnePath, within: float, share: float, runs: int) -> ThresholdFound:
    shares = np.array([0.0, 1.0] * ENDS + list((np.arange(FIRST) + 0.5) / FIRST))
    held = np.array(line.answers(list(shares)), dtype=bool)
    low, high = held[:2 * ENDS:2].mean(), held[1:2 * ENDS:2].mean()
    if (low - share) * (high - share) >= 0:
        raise NoBracketError(f"holds for {100 * low:.0f} % of starts at one end and for "
                             f"{100 * high:.0f} % at the other, not for {100 * share:g} %")
    rises = bool(high > low)
    rng = np.random.default_rng([line.seed, 1])
    left = posterior(shares, held, rises=rises)
    while len(held) < runs and np.ptp(left.level(share)) > within:
        more = left.telling(min(BATCH, runs - len(held)), rng)
        held = np.append(held, line.answers(list(more), first=len(held)))
        shares = np.append(shares, more)
        left = posterior(shares, held, rises=rises)
    low, middle, high = left.level(share)
    remarks = [] if high - low <= within else [
        f"after {len(held)} random starts the interval is still wider than asked for: more runs "
        "narrow it"]
    if low < 0 or high > 1:
        remarks.append("the interval reaches beyond the range: a wider one tells more")
    certified, certificate = _agrees(line, shares, held, left, share)
    numbers = line.numbers([min(max(each, 0.0), 1.0) for each in (low, middle, high)])
    return ThresholdFound(
        line.path, line.space.units[line.path], numbers[0], numbers[2], not rises, line.condition,
        len(held), certified, certificate, share, numbers[1], _bins(line, shares, held),
        tuple(remarks))


def _agrees(
    line: _OnePath, shares: Array, held: Flags, before: Posterior, share: float,
) -> tuple[bool, str]:
    """Whether the same starts at half the step have their middle inside the interval."""
    again = np.array(line.answers(list(shares), halved=True), dtype=bool)
    low, _, high = before.level(share)
    _, middle, _ = posterior(shares, again, rises=before.rises).level(share)
    value = line.numbers([min(max(middle, 0.0), 1.0)])[0]
    return low <= middle <= high, (
        f"{int((again == held).sum())} of {len(held)} starts answer as before, and the threshold "
        f"is {value:.6g} {line.space.units[line.path]}".rstrip())


def _bins(
    line: _OnePath, shares: Array, held: Flags,
) -> tuple[tuple[float, float, int, int, float, float], ...]:
    edges = np.linspace(0.0, 1.0, BINS + 1)
    numbers = line.numbers(list(edges))
    place = np.minimum((shares * BINS).astype(int), BINS - 1)
    found = []
    for k in range(BINS):
        count, yes = int((place == k).sum()), int(held[place == k].sum())
        if count:
            found.append((numbers[k], numbers[k + 1], yes, count, *wilson(yes, count)))
    return tuple(found)
