"""Thresholds: the least pull that holds, the largest push, the smallest friction."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sandbox.errors import SandboxError
from sandbox.figure.sweeps import FoundLine
from sandbox.search.question import Question
from sandbox.search.session import (
    Condition,
    RefusedError,
    Session,
    Where,
    check_unit,
    failure_of,
    open_session,
    parse_conditions,
    row_holds,
    step_check,
)
from sandbox.sweeps.vary import Range
from sandbox.wording import told_of

WITHIN = 1e-3
"""Default width of the bracket, as a fraction of the range."""
NARROWEST = 1e-9
"""Of the range: narrower brackets are rounding."""
QUARTERS = (0.25, 0.5, 0.75)


@dataclass(frozen=True)
class ThresholdFound:
    """The value of a path at which a condition begins or ceases to hold."""

    path: str
    unit: str
    """SI; empty for none."""
    low: float
    """Of the bracket, SI; the condition holds at one of its ends only."""
    high: float
    holds_below: bool
    """Whether the condition holds below the threshold."""
    condition: str
    runs: int
    certified: bool
    """Whether the result is the same at half the step."""
    certificate: str
    """Details of this check."""
    remarks: tuple[str, ...] = ()

    def __repr__(self) -> str:
        return told_of(self, self.lines)

    @property
    def middle(self) -> float:
        """Of the bracket, SI."""
        return (self.low + self.high) / 2

    @property
    def lines(self) -> list[str]:
        """The result in words."""
        side = "below" if self.holds_below else "above"
        unit = f" {self.unit}" if self.unit else ""
        return [f"{self.condition} holds {side} {self.path} = {self.middle:.6g}{unit} "
                f"(between {self.low:.8g} and {self.high:.8g}{unit}; {self.runs} runs)",
                *self.remarks, step_check(self.certified, self.certificate)]


class NoBracketError(SandboxError):
    """The condition has the same answer at both ends of the range."""

    code = "no-threshold"


@dataclass(frozen=True)
class Bracket:
    """Two fractions of a range of which one holds and the other does not."""

    low: float
    high: float
    low_holds: bool
    answers: tuple[tuple[float, bool], ...]
    """All answers, by fraction."""


def bisect(ask: Callable[[Sequence[float]], Sequence[bool]], within: float) -> Bracket:
    """The bracket, no wider than ``within``, to which halving the range from 0 to 1 leads.

    The middle and the middles of both halves are evaluated together, so that two halvings take the
    time of one where there are three processors; the answers are those of plain bisection.

    Raises:
        NoBracketError: the ends have the same answer.
    """
    fractions = [0.0, *QUARTERS, 1.0]
    known = dict(zip(fractions, ask(fractions), strict=True))
    if known[0.0] == known[1.0]:
        raise NoBracketError("holds" if known[0.0] else "does not hold")
    low, high = 0.0, 1.0
    while True:
        for _ in range(2):
            middle = (low + high) / 2
            low, high = (middle, high) if known[middle] == known[low] else (low, middle)
        if high - low <= within:
            return Bracket(low, high, known[low], tuple(sorted(known.items())))
        fractions = [low + quarter * (high - low) for quarter in QUARTERS]
        known.update(zip(fractions, ask(fractions), strict=True))


def find_threshold(
    question: Question, where: Sequence[str] = (), *, within: float | None = None,
    place: Where | None = None,
) -> ThresholdFound:
    """The value of one path at which conditions begin or cease to hold.

    Args:
        question: one path with a range.
        where: conditions such as ``"moved < 1 mm"``; by default every expectation.
        within: width of the bracket [SI]; by default a thousandth of the range.
        place: where it runs, and where its files go.

    Raises:
        NoBracketError: both ends have the same answer.
        RefusedError: not one range, or options that do not fit it.
        SandboxError: a run without an answer.
    """
    space = question.space
    if len(space.paths) != 1 or not space.of_kind(Range):
        raise RefusedError("a threshold is looked for along one path with a range, as in "
                           f"'2 N:8 N', not {len(space.paths)} paths with ranges, lists or "
                           "distributions")
    wanted = parse_conditions(where, question.kept)
    if not wanted and not question.plan.loaded.mechanism.expect:
        raise RefusedError('the scene has no expectations: give a condition, as "moved < 1 mm"')
    path, = space.paths
    ends = _numbers(question, [0.0, 1.0])
    if within is not None:
        check_unit(within, space.units[path], f"'within' of {path}")
    narrow = WITHIN if within is None else within / abs(ends[1] - ends[0])
    if not narrow >= NARROWEST:
        raise RefusedError(f"a bracket is no narrower than {NARROWEST:g} of the range, not "
                           f"{within:g}")
    condition = " and ".join(each.text for each in wanted) or "every expectation"
    place = place or Where()
    with open_session(question, place) as session:
        def ask(fractions: Sequence[float], *, halved: bool = False) -> list[bool]:
            return _answers(session, wanted, condition, fractions, halved=halved)

        try:
            bracket = bisect(ask, narrow)
        except NoBracketError as error:
            raise NoBracketError(
                f"{path} from {ends[0]:.6g} to {ends[1]:.6g} {space.units[path]} has no threshold "
                f"at its ends: {condition} {error} at both") from None
        low, high = _numbers(question, [bracket.low, bracket.high])
        answers = [answer for _, answer in bracket.answers]
        turns = sum(one != other for one, other in itertools.pairwise(answers))
        found = ThresholdFound(
            path, space.units[path], low, high, bracket.low_holds, condition,
            len(answers), *_check(question, bracket, ask, narrow),
            (f"the answer changes {turns} times along the range: this is one of several "
             "thresholds",) if turns > 1 else ())
        if place.out:
            side = "below" if found.holds_below else "above"
            at = f"{found.middle:.6g} {found.unit}".rstrip()
            line = FoundLine(path, low, found.middle, high,
                             f"Dashed: {condition} holds {side} {at}.")
            session.write(place.out, "threshold", {**vars(found), "middle": found.middle},
                          wanted=wanted, line=line, where=where, within=within)
    return found


def _numbers(question: Question, fractions: Sequence[float]) -> list[float]:
    """Values of the path at fractions of its range, SI."""
    numbers: list[float] = question.space.numbers([[each] for each in fractions])[:, 0].tolist()
    return numbers


def _answers(
    session: Session, wanted: tuple[Condition, ...], condition: str, fractions: Sequence[float],
    *, halved: bool,
) -> list[bool]:
    """Whether the conditions hold at fractions of the range.

    Raises:
        SandboxError: a run has no answer.
    """
    rows = session.rows([[each] for each in fractions], halved=halved)
    found = []
    for row, point in zip(rows, session.question.space.points([[each] for each in fractions]),
                          strict=True):
        answer = row_holds(row, wanted)
        if answer is None:
            path, = point
            raise SandboxError(f"with {path} = {point[path]} the run does not decide "
                               f"{condition}: {failure_of(row)}", code="no-answer")
        found.append(answer)
    return found


def _check(
    question: Question, bracket: Bracket, ask: Callable[..., list[bool]], within: float,
) -> tuple[bool, str]:
    """Whether the bracket is the same at half the step, and details."""
    if ask([bracket.low, bracket.high], halved=True) == [bracket.low_holds, not bracket.low_holds]:
        return True, "both ends of the bracket answer as before"
    try:
        other = bisect(lambda fractions: ask(fractions, halved=True), within)
    except NoBracketError as error:
        return False, f"there it {error} at both ends of the range"
    low, high = _numbers(question, [other.low, other.high])
    unit, = question.space.units.values()
    return False, f"there it is between {low:.8g} and {high:.8g} {unit}".rstrip()
