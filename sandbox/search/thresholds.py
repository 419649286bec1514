"""Thresholds: the least pull that holds, the largest push, the smallest friction."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sandbox.errors import SandboxError
from sandbox.figure.sweeps import FoundLine
from sandbox.search.session import (
    RefusedError,
    Result,
    Session,
    check_unit,
    failure_of,
    parse_conditions,
    row_holds,
)
from sandbox.sweeps.spec import ThresholdSearch
from sandbox.sweeps.vary import Range

WITHIN = 1e-3
"""Default width of the bracket, as a fraction of the range."""
NARROWEST = 1e-9
"""Of the range: narrower brackets are rounding."""
QUARTERS = (0.25, 0.5, 0.75)


@dataclass(frozen=True, repr=False)
class ThresholdFound(Result):
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

    @property
    def middle(self) -> float:
        """Of the bracket, SI."""
        return (self.low + self.high) / 2

    def _lines(self) -> list[str]:
        side = "below" if self.holds_below else "above"
        unit = f" {self.unit}" if self.unit else ""
        return [f"{self.condition} holds {side} {self.path} = {self.middle:.6g}{unit} "
                f"(between {self.low:.8g} and {self.high:.8g}{unit}; {self.runs} runs)",
                *self.remarks]


class NoBracketError(SandboxError):
    """The condition has the same answer at both ends of the range."""

    code = "no-threshold"


@dataclass(frozen=True)
class Bracket:
    """Two fractions of a range of which one holds and the other does not."""

    low: float
    high: float
    low_holds: bool
    answers: tuple[bool, ...]
    """All answers, in the order of their fractions."""


def bisect(holds_at: Callable[[Sequence[float]], Sequence[bool]], within: float) -> Bracket:
    """The bracket, no wider than ``within``, to which halving the range from 0 to 1 leads.

    The middle and the middles of both halves are evaluated together, so that two halvings take the
    time of one where there are three processors; the answers are those of plain bisection.
    """
    fractions = [0.0, *QUARTERS, 1.0]
    known = dict(zip(fractions, holds_at(fractions), strict=True))
    if known[0.0] == known[1.0]:
        raise NoBracketError("holds" if known[0.0] else "does not hold")
    low, high = 0.0, 1.0
    while True:
        for _ in range(2):
            middle = (low + high) / 2
            low, high = (middle, high) if known[middle] == known[low] else (low, middle)
        if high - low <= within:
            return Bracket(low, high, known[low], tuple(known[at] for at in sorted(known)))
        fractions = [low + quarter * (high - low) for quarter in QUARTERS]
        known.update(zip(fractions, holds_at(fractions), strict=True))


def find_threshold(session: Session, options: ThresholdSearch) -> ThresholdFound:
    """The value of one path at which conditions begin or cease to hold."""
    question = session.question
    if len(question.paths) != 1 or not question.of_kind(Range):
        raise RefusedError("a threshold search varies one path with a range, as in "
                           f"'2 N:8 N', not {len(question.paths)} paths with ranges, lists or "
                           "distributions")
    path, = question.paths
    unit = question.unit(path)
    wanted = parse_conditions(options.where, question.kept)
    if not wanted and not question.plan.loaded.mechanism.expect:
        raise RefusedError('the scene has no expectations: give a condition, as "moved < 1 mm"')
    condition = " and ".join(each.text for each in wanted) or "every expectation"

    def numbers(*fractions: float) -> list[float]:
        """Values of the path at fractions of its range, SI."""
        found: list[float] = question.numbers([[each] for each in fractions])[:, 0].tolist()
        return found

    def holds_at(fractions: Sequence[float], *, halved: bool = False) -> list[bool]:
        """Whether the conditions hold at fractions of the range."""
        quantiles = [[each] for each in fractions]
        found = []
        for row, point in zip(session.rows(quantiles, halved=halved), question.points(quantiles),
                              strict=True):
            answer = row_holds(row, wanted)
            if answer is None:
                raise SandboxError(f"with {path} = {point[path]} the run does not decide "
                                   f"{condition}: {failure_of(row)}", code="no-answer")
            found.append(answer)
        return found

    begin, end = numbers(0.0, 1.0)
    narrow = WITHIN
    if options.within is not None:
        check_unit(options.within, unit, f"'within' of {path}")
        narrow = options.within / abs(end - begin)
        if not narrow >= NARROWEST:
            raise RefusedError(f"a bracket is no narrower than {NARROWEST:g} of the range, not "
                               f"{options.within:g}")
    try:
        bracket = bisect(holds_at, narrow)
    except NoBracketError as error:
        raise NoBracketError(f"{path} from {begin:.6g} to {end:.6g} {unit} has no threshold at its "
                             f"ends: {condition} {error} at both") from None
    low, high = numbers(bracket.low, bracket.high)
    same, detail = True, "both ends of the bracket answer as before"
    again = holds_at([bracket.low, bracket.high], halved=True)
    if again != [bracket.low_holds, not bracket.low_holds]:
        try:
            other = bisect(lambda fractions: holds_at(fractions, halved=True), narrow)
        except NoBracketError as error:
            same, detail = False, f"there it {error} at both ends of the range"
        else:
            least, most = numbers(other.low, other.high)
            same, detail = False, f"there it is between {least:.8g} and {most:.8g} {unit}".rstrip()
    turns = sum(one != other for one, other in itertools.pairwise(bracket.answers))
    remarks = (f"the answer changes {turns} times along the range: this is one of several "
               "thresholds",) if turns > 1 else ()
    found = ThresholdFound(path, unit, low, high, bracket.low_holds, condition,
                           len(bracket.answers), same, detail, remarks)
    at = f"{found.middle:.6g} {unit}".rstrip()
    session.write("threshold", options, found, wanted=wanted, middle=found.middle, line=FoundLine(
        path, low, found.middle, high,
        f"Dashed: {condition} holds {'below' if found.holds_below else 'above'} {at}."))
    return found
