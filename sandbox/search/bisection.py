"""Where a yes turns into a no, by bisection that asks for two halvings at a time."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from sandbox.errors import SandboxError

QUARTERS = (0.25, 0.5, 0.75)


class NoBracketError(SandboxError):
    """The two ends of a range have the same answer."""

    code = "no-threshold"


@dataclass(frozen=True)
class Bracket:
    """Two shares of a range of which one holds and the other does not."""

    low: float
    high: float
    low_holds: bool
    answers: tuple[tuple[float, bool], ...]
    """All that was asked, by share."""

    @property
    def turns(self) -> int:
        """How often the answer changes over all that was asked; 1 of a threshold."""
        said = [answer for _, answer in self.answers]
        return sum(one != other for one, other in itertools.pairwise(said))


def bisect(ask: Callable[[Sequence[float]], Sequence[bool]], within: float) -> Bracket:
    """The bracket, no wider than ``within``, that halving the range 0 to 1 leads to.

    The middle and the middles of both halves are asked for together, so that two halvings take
    the time of one where there are processors for three; the answers are those of plain bisection.

    Raises:
        NoBracketError: the ends have the same answer.
    """
    shares = [0.0, *QUARTERS, 1.0]
    known = dict(zip(shares, ask(shares), strict=True))
    if known[0.0] == known[1.0]:
        raise NoBracketError("holds" if known[0.0] else "does not hold")
    low, high = 0.0, 1.0
    while True:
        for _ in range(2):
            middle = (low + high) / 2
            low, high = (middle, high) if known[middle] == known[low] else (low, middle)
        if high - low <= within:
            return Bracket(low, high, known[low], tuple(sorted(known.items())))
        shares = [low + quarter * (high - low) for quarter in QUARTERS]
        known.update(zip(shares, ask(shares), strict=True))
