"""Which quantities meters read, and the order in which they can be worked out."""

from __future__ import annotations

import re

from sandbox.errors import Problem
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Meter
from sandbox.values.expressions import names_in
from sandbox.wording import quoted

_QUOTIENT = re.compile(r"([A-Za-z_][\w.]*) */ *([A-Za-z_][\w.]*)")


def names_read(meter: Meter) -> frozenset[str]:
    """The names in a meter's expression; empty where it cannot be parsed."""
    try:
        return names_in(meter.value)
    except ValueError:
        return frozenset()


def quotients(text: str) -> list[str]:
    """What an expression divides, name by name, spelled as the quantity of a pair is: ``a/b``."""
    return sorted({f"{one}/{other}" for one, other in _QUOTIENT.findall(text)})


def no_pair(
    pair: str, path: str, itself: str = "an expectation may ask for the pair itself",
) -> Problem:
    """The refusal of the quantity of a pair in an expression, where a body alone has no value.

    ``itself`` says where the pair can be had.
    """
    first, _, rest = pair.partition("/")
    second, _, quantity = rest.rpartition(".")
    sums = " or ".join(quoted(f"{body}.contact.{quantity}") for body in (first, second))
    return Problem("bad-quantity", f"'/' divides in an expression, so that {quoted(pair)} is no "
                   "pair there", path, allowed=f"{sums}, the sums of all that touches one of them; "
                   f"{itself}")


def order(mechanism: Mechanism) -> tuple[list[int], list[list[int]]]:
    """The order to evaluate meters in, and the circles among them, as places in the mechanism.

    A meter comes after those it reads. What stands in a circle, or reads one
    that does, is not in the order.
    """
    place: dict[str, int] = {}
    for index, meter in enumerate(mechanism.meters):
        place.setdefault(meter.name, index)
    reads = [sorted(place[name] for name in names_read(meter) & place.keys())
             for meter in mechanism.meters]
    readers: list[list[int]] = [[] for _ in reads]
    for index, others in enumerate(reads):
        for other in others:
            readers[other].append(index)
    missing = [len(others) for others in reads]
    done: list[int] = []
    step = [index for index, count in enumerate(missing) if not count]
    while step:  # those that read only what was done before
        done += step
        following = []
        for index in step:
            for reader in readers[index]:
                missing[reader] -= 1
                if not missing[reader]:
                    following.append(reader)
        step = sorted(following)
    return done, _circles(reads, [index for index, count in enumerate(missing) if count])


def _circles(reads: list[list[int]], waiting: list[int]) -> list[list[int]]:
    """One circle for every set of meters that wait for each other, each told once."""
    stuck, seen, found = set(waiting), set[int](), []
    for start in waiting:
        path: list[int] = []
        index = start
        while index not in seen:
            seen.add(index)
            path.append(index)
            index = next(other for other in reads[index] if other in stuck)
        if index in path:
            found.append(path[path.index(index):])
    return found
