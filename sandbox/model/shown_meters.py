"""Which quantities the meters of a picture show."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from sandbox.errors import Problem
from sandbox.model import meters
from sandbox.model.asked import unknown
from sandbox.model.catalogue import Catalogue
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import ShownMeter, View
from sandbox.values.expressions import names_in, parse_expression
from sandbox.wording import is_pattern, listed

MOST = 6
"""Curves of a meter: more can be told apart by nobody."""


def is_expression(word: str) -> bool:
    """Whether a curve is to be worked out, not read."""
    return word.lstrip().startswith("=")


def curves(meter: ShownMeter, known: Catalogue) -> list[str]:
    """The quantities and expressions that a meter shows, each once."""
    found = (name for word in meter.of
             for name in ([word] if is_expression(word) else known.match(word)))
    return list(dict.fromkeys(found))


def worked_out(word: str, mechanism: Mechanism, read: Callable[[str], Array]) -> Array:
    """The values of an expression, which may be none; ``read`` gives quantities and ``t``."""
    expression = parse_expression(word)
    known = {name: read(name) for name in sorted(expression.names)}
    value = expression.evaluate({**mechanism.functions, **known}, finite=False)
    return np.asarray(value, dtype=float)


def check_shown(mechanism: Mechanism) -> list[Problem]:
    """What meters of the scene's picture ask for that a run does not have, or no plot can hold."""
    return problems_of(Catalogue(mechanism), mechanism.view) if mechanism.view.meters else []


def problems_of(known: Catalogue, view: View) -> list[Problem]:
    """The same of any view of a mechanism whose catalogue is ``known``."""
    problems: list[Problem] = []
    for i, meter in enumerate(view.meters):
        path = f"$.view.meters[{i}]"
        missing = [problem for j, word in enumerate(meter.of)
                   for problem in _missing(known, word, f"{path}.of[{j}]", len(problems))]
        problems += missing
        if not missing:
            problems += _together(known, meter, path)
    return problems


def _missing(known: Catalogue, word: str, path: str, rank: int) -> Iterator[Problem]:
    if not is_expression(word):
        if not known.fits(word):
            what = "no quantity fits" if is_pattern(word) else "unknown quantity"
            yield unknown(known, what, word, path, rank)
        return
    pairs = [pair for pair in meters.quotients(word) if pair in known]
    yield from (meters.no_pair(pair, path) for pair in pairs)
    halves = {half for pair in pairs for half in pair.split("/")}
    for name in sorted(names_in(word) - {"t"} - halves):
        if name not in known:
            yield unknown(known, "unknown quantity", name, path, rank)


def _together(known: Catalogue, meter: ShownMeter, path: str) -> Iterator[Problem]:
    names = curves(meter, known)
    if len(names) > MOST:
        yield Problem("bad-quantity", f"{len(names)} curves are too many for one meter: "
                      f"{listed(names)}", path, allowed=f"at most {MOST}")
    units = sorted({known.find(name).unit for name in names if not is_expression(name)})
    if len(units) > 1:
        yield Problem("bad-quantity", "the curves of one meter have one unit, these have "
                      f"{listed(units)}", path, allowed="a meter for each unit")
