"""Thresholds: the smallest pull that holds, the largest push, the smallest friction."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from sandbox.errors import SandboxError
from sandbox.figure.sweeps import FoundLine
from sandbox.search.session import RefusedError, Result, Session, held
from sandbox.sweeps.options import ThresholdSearch
from sandbox.sweeps.spec import Range

WITHIN = 1e-3  # default width of the bracket, as a fraction of the range
NARROWEST = 1e-9  # of the range: narrower brackets are rounding


@dataclass(frozen=True, repr=False)
class ThresholdFound(Result):
    """The value of a path at which a condition begins or ceases to hold."""

    path: str
    unit: str  #: SI; empty for none
    low: float  #: of the bracket, SI; the condition holds at one of its ends only
    middle: float
    high: float
    holds_below: bool  #: whether the condition holds below the threshold
    condition: str

    def _lines(self) -> list[str]:
        side = "below" if self.holds_below else "above"
        unit = f" {self.unit}" if self.unit else ""
        return [f"{self.condition} holds {side} {self.path} = {self.middle:.6g}{unit} "
                f"(between {self.low:.8g} and {self.high:.8g}{unit}; {self.runs} runs)"]


def bisect(
    holds_at: Callable[[Sequence[float]], Sequence[bool]], within: float,
) -> tuple[float, float, dict[float, bool]]:
    """The bracket, no wider than ``within``, to which halving the range from 0 to 1 leads.

    The middle and the middles of both halves are evaluated together, so that two halvings take the
    time of one where there are three processors. Also returns all answers by their fraction. If
    both ends of the range have the same answer, they are the bracket.
    """
    low, high, known = 0.0, 1.0, dict[float, bool]()
    while not known or high - low > within:
        fractions = [low + part * (high - low) for part in (0.0, 0.25, 0.5, 0.75, 1.0)]
        fractions = [each for each in fractions if each not in known]
        known.update(zip(fractions, holds_at(fractions), strict=True))
        if known[low] == known[high]:
            break
        for _ in range(2):
            middle = (low + high) / 2
            low, high = (middle, high) if known[middle] == known[low] else (low, middle)
    return low, high, known


def find_threshold(session: Session, options: ThresholdSearch) -> ThresholdFound:
    """The value of one path at which conditions begin or cease to hold."""
    if len(session.paths) != 1 or not session.of_kind(Range):
        raise RefusedError("a threshold search varies one path with a range, as in "
                           f"'2 N:8 N', not {len(session.paths)} paths with ranges, lists or "
                           "distributions")
    path, = session.paths
    unit, wanted = session.units[path], session.conditions(options.where)
    if not wanted and not session.plan.loaded.mechanism.expect:
        raise RefusedError('the scene has no expectations: give a condition, as "moved < 1 mm"')
    condition = " and ".join(each.text for each in wanted) or "every expectation"

    def holds_at(fractions: Sequence[float], *, halved: bool = False) -> list[bool]:
        quantiles = [[each] for each in fractions]
        rows = session.rows(quantiles, halved=halved)
        found = held(rows, wanted)
        for row, holds, point in zip(rows, found, session.points(quantiles), strict=True):
            if np.isnan(holds):
                raise SandboxError(f"with {path} = {point[path]} the run does not decide "
                                   f"{condition}: {row.failure}", code="no-answer")
        return [bool(holds) for holds in found]

    begin, end = session.numbers([[0.0], [1.0]])[:, 0].tolist()
    narrow = WITHIN
    if options.within is not None:
        session.check_unit(options.within, unit, f"'within' of {path}", "within")
        narrow = options.within / abs(end - begin)
        if not narrow >= NARROWEST:
            raise RefusedError(f"a bracket is no narrower than {NARROWEST:g} of the range, not "
                               f"{options.within:g}", "within")
    first, last, known = bisect(holds_at, narrow)
    below = known[first]
    if below == known[last]:
        why = f"{condition} holds at {'both' if below else 'neither'}" if wanted else \
            f"the verdict on the expectations does not change ({'' if below else 'not '}all hold)"
        raise SandboxError(f"{path} from {begin:.6g} to {end:.6g} {unit} has no threshold at its "
                           f"ends: {why}", code="no-threshold")
    low, high = session.numbers([[first], [last]])[:, 0].tolist()
    same, detail = True, "both ends of the bracket answer as before"
    if holds_at([first, last], halved=True) != [below, not below]:
        again, other, answers = bisect(partial(holds_at, halved=True), narrow)
        one, two = session.numbers([[again], [other]])[:, 0]
        same, detail = False, (
            f"there it is between {one:.8g} and {two:.8g} {unit}".rstrip()
            if answers[again] != answers[other] else "there it "
            f"{'holds' if answers[again] else 'does not hold'} at both ends of the range")
    middle, side = (low + high) / 2, "below" if below else "above"
    found = ThresholdFound(path, unit, low, middle, high, below, condition,
                           runs=len(known), certified=same, certificate=detail)
    session.write(found, wanted, FoundLine(
        path, low, middle, high,
        f"Dashed: {condition} holds {side} {f'{middle:.6g} {unit}'.rstrip()}."))
    return found
