"""Spans of cords that guides hold by friction: pieces between such guides, each of one tension."""

from __future__ import annotations

import itertools
from typing import NamedTuple

from sandbox.model.model import Tendons


class CordSpan(NamedTuple):
    """A piece of a cord from one guide that holds it to the next, or to an end."""

    tendon: int
    guides: tuple[int, ...]
    """Numbers of the model's guides, in order; its first and last one hold it, or are ends."""
    into: int
    """Which of :attr:`sandbox.model.model.Tendons.grips` feeds it; -1 at an end."""
    out_of: int
    """Which takes from it; -1 at an end."""


def spans_of(tendons: Tendons, tendon: int) -> list[CordSpan]:
    """The spans of a tendon in its order, of a loop from its first guide that holds it; or none."""
    grips = tendons.gripped(tendon).tolist()
    if not grips:
        return []
    path = tendons.guides(tendon)
    held = tendons.grips[grips].tolist()
    between = [CordSpan(tendon, tuple(range(a, b + 1)), grips[k], grips[k + 1])
               for k, (a, b) in enumerate(itertools.pairwise(held))]
    if tendons.closed[tendon]:
        on = (*range(held[-1], path.stop - 1), *range(path.start, held[0] + 1))
        return [*between, CordSpan(tendon, on, grips[-1], grips[0])]
    return [CordSpan(tendon, tuple(range(path.start, held[0] + 1)), -1, grips[0]), *between,
            CordSpan(tendon, tuple(range(held[-1], path.stop)), grips[-1], -1)]
