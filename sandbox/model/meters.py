"""Meters and expectations: checks of the quantities that they read, values of meters."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator

import numpy as np

from sandbox.errors import Problem
from sandbox.model.catalogue import PAIR, Catalogue
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Expect, Meter, ShownMeter, View
from sandbox.values.expressions import RESERVED, names_in, parse_expression
from sandbox.values.units import UNITS, Measured, factor_of
from sandbox.wording import MOST_HINTED, WrongValueError, is_pattern, listed, quoted

_QUOTIENT = re.compile(r"([A-Za-z_][\w.]*) */ *([A-Za-z_][\w.]*)")


def names_read(meter: Meter) -> frozenset[str]:
    """The names in a meter's expression; empty where it cannot be parsed."""
    try:
        return names_in(meter.value)
    except ValueError:
        return frozenset()


def quotients(text: str) -> list[str]:
    """Quotients of names in an expression, spelled as the quantity of a pair: ``a/b``."""
    return sorted({f"{one}/{other}" for one, other in _QUOTIENT.findall(text)})


def no_pair(
    pair: str, path: str, itself: str = "an expectation may use the pair itself",
) -> Problem:
    """The problem of a quantity of a pair in an expression; ``itself`` says where it is allowed."""
    first, _, rest = pair.partition("/")
    second, _, quantity = rest.rpartition(".")
    sums = " or ".join(quoted(f"{body}.contact.{quantity}") for body in (first, second))
    return Problem("bad-quantity", f"'/' divides in an expression, so that {quoted(pair)} is no "
                   "pair there", path, allowed=f"{sums}, the sums of all that touches one of them; "
                   f"{itself}")


def order(mechanism: Mechanism) -> tuple[list[int], list[list[int]]]:
    """The order in which to evaluate meters, and the cycles among them, as indices.

    A meter comes after those that it reads. Meters of a cycle, and those that read them, are not in
    the order.
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
    while step:  # meters that read only earlier ones
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
    """One cycle for every set of meters that depend on each other."""
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


def evaluate(
    mechanism: Mechanism, *, read: Callable[[str], Array], time: Array
) -> tuple[Array, list[str]]:
    """All meters over a run, shape [n, number of meters], and notes on those without a value.

    ``read`` gives a recorded quantity, shape [n], or raises ``KeyError``.
    """
    result = np.full((len(time), len(mechanism.meters)), np.nan)
    notes: dict[int, str] = {}
    known: dict[str, Array] = {}
    ordered, circles = order(mechanism)
    tables = mechanism.functions
    for index in ordered:
        meter = mechanism.meters[index]
        try:
            expression = parse_expression(meter.value)
            values = {name: known[name] if name in known else time if name == "t" else read(name)
                      for name in sorted(expression.names)}
            result[:, index] = expression.evaluate({**tables, **values}, finite=False)
        except (KeyError, ValueError) as error:
            notes[index] = f"meter {meter.name!r} has no value: {error}"
        known[meter.name] = result[:, index]
        _blank(result[:, index], time, meter.name, notes, index)
    for index in sorted({index for circle in circles for index in circle}):
        notes[index] = f"meter {mechanism.meters[index].name!r} has no value: it depends on itself"
    return result, [notes[index] for index in sorted(notes)]


def _blank(column: Array, time: Array, name: str, notes: dict[int, str], index: int) -> None:
    """Replace infinite values by nan, with a note of their number and first time."""
    bad = ~np.isfinite(column)
    column[bad] = np.nan
    if index not in notes and bad.any():
        notes[index] = (f"meter {name!r} has no finite value in {bad.sum()} of {len(column)} "
                        f"samples, first at t = {time[bad.argmax()]:.6g} s")


MOST = 6
"""Largest number of curves of a meter."""


def is_expression(word: str) -> bool:
    """Whether a curve is an expression, not a quantity."""
    return word.lstrip().startswith("=")


def curves(meter: ShownMeter, known: Catalogue) -> list[str]:
    """The quantities and expressions that a meter shows, each once."""
    found = (name for word in meter.of
             for name in ([word] if is_expression(word) else known.match(word)))
    return list(dict.fromkeys(found))


def worked_out(word: str, mechanism: Mechanism, read: Callable[[str], Array]) -> Array:
    """Values of an expression, nan without one; ``read`` gives quantities and ``t``."""
    expression = parse_expression(word)
    known = {name: read(name) for name in sorted(expression.names)}
    value = expression.evaluate({**mechanism.functions, **known}, finite=False)
    return np.asarray(value, dtype=float)


def check_shown(mechanism: Mechanism) -> list[Problem]:
    """Problems of the meters in the scene's picture: unknown quantities, too many curves."""
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
    yield from _unreadable(known, word, names_in(word), path, rank)


def _unreadable(
    known: Catalogue, text: str, names: frozenset[str], path: str, rank: int,
) -> Iterator[Problem]:
    """Names in an expression that are no quantities, and pairs, which it cannot read."""
    pairs = [pair for pair in quotients(text) if pair in known]
    yield from (no_pair(pair, path) for pair in pairs)
    halves = {half for pair in pairs for half in pair.split("/")}
    for name in sorted(names - {"t"} - halves):
        if name not in known:
            yield unknown(known, "unknown quantity", name, path, rank)


def _together(known: Catalogue, meter: ShownMeter, path: str) -> Iterator[Problem]:
    names = curves(meter, known)
    if len(names) > MOST:
        yield Problem("bad-quantity", f"{len(names)} curves are too many for one meter: "
                      f"{listed(names)}", path, allowed=f"at most {MOST}")
    units = sorted({known.find(name).unit for name in names if not is_expression(name)})
    if len(units) > 1:
        yield Problem("bad-quantity", "all curves of one meter need the same unit, these have "
                                      f"{listed(units)}", path, allowed="a meter for each unit")


def check_quantities(mechanism: Mechanism) -> list[Problem]:
    """Problems of the quantities in meters and expectations.

    Unknown names (with suggestions), patterns that fit nothing, names of meters that are taken,
    meters that depend on themselves, and numbers of another dimension than their quantity.
    """
    known = Catalogue(mechanism)
    problems = [*_check_meter_names(mechanism), *_check_meter_values(known)]
    fits: dict[str, bool] = {}
    units: dict[str, list[str]] = {}
    for i, expect in enumerate(mechanism.expect):
        if beyond := expect.past_end(mechanism.run.duration) if expect.at is not None else "":
            problems.append(Problem("bad-time", beyond, f"$.expect[{i}].at"))
        if expect.quantity not in fits:
            fits[expect.quantity] = known.fits(expect.quantity)
        if fits[expect.quantity]:
            problems.extend(_check_units(known, expect, f"$.expect[{i}]", units))
            continue
        what = "no quantity fits" if is_pattern(expect.quantity) else "unknown quantity"
        problems.append(unknown(
            known, what, expect.quantity, f"$.expect[{i}].{expect.key}", len(problems)))
    return problems


def _check_units(
    known: Catalogue, expect: Expect, path: str, units: dict[str, list[str]],
) -> Iterator[Problem]:
    """Numbers of an expectation in a unit of another dimension than its quantities.

    ``units`` caches the units of patterns.
    """
    for place, number, quantity in _numbers(expect):
        if not isinstance(number, Measured):
            continue
        if quantity and quantity not in units:
            units[quantity] = _units(known, quantity)
        for unit in units[quantity] if quantity else ["s"]:
            if unit not in UNITS and unit != "1":  # a meter's own word for its unit
                continue
            try:
                factor_of(number.unit, UNITS[unit][1] if unit in UNITS else "ratio")
            except WrongValueError as error:
                yield Problem.of(error, f"{path}.{place}")
                break


def _units(known: Catalogue, pattern: str) -> list[str]:
    """The units of the quantities that fit, each once."""
    if "/" in pattern:  # all that pairs have are forces
        return sorted(set(PAIR.values()))
    return sorted({known.find(name).unit for name in known.match(pattern)})


def _numbers(expect: Expect) -> Iterator[tuple[str, object, str]]:
    """The numbers of an expectation: where, which, and of what quantity; of time if of none."""
    for key, value in (("is", expect.value), ("within", expect.within), ("above", expect.above),
                       ("below", expect.below)):
        yield key, value, expect.quantity
    for j, value in enumerate(expect.between or ()):
        yield f"between[{j}]", value, expect.quantity
    for j, instant in enumerate(expect.over):
        yield f"over[{j}]", instant, ""


def unknown(known: Catalogue, what: str, name: str, path: str, rank: int) -> Problem:
    """The problem of an unknown quantity, with suggestions for those of small ``rank``."""
    if lacking := known.lacking(name):
        return Problem("unknown-quantity", f"{what} {quoted(name)}: {lacking}", path)
    near = known.near(name) if rank < MOST_HINTED else ""
    return Problem("unknown-quantity",
                   f"{what} {quoted(name)}", path, hint=quoted(near) if near else "",
                   allowed=known.allowed(name) if rank < MOST_HINTED else "")


def _check_meter_values(known: Catalogue) -> list[Problem]:
    problems: list[Problem] = []
    all_meters = known.mechanism.meters
    for i, meter in enumerate(all_meters):
        problems.extend(_unreadable(
            known, meter.value, names_read(meter), f"$.meters[{i}].value", len(problems)))
    for circle in order(known.mechanism)[1]:
        ring = " → ".join(quoted(all_meters[i].name) for i in [*circle, circle[0]])
        problems.append(Problem("circular-definition", "meters depend on each other in a circle: "
                                f"{ring}", f"$.meters[{circle[0]}].value"))
    return problems


def _check_meter_names(mechanism: Mechanism) -> list[Problem]:
    """A meter's name must mean nothing else: no other quantity, no word of expressions."""
    others = Catalogue(mechanism.model_copy(update={"meters": ()}))
    problems = []
    for i, meter in enumerate(mechanism.meters):
        if meter.name in others:
            problem = "is the name of a recorded quantity already"
        elif meter.name in RESERVED:
            problem = "means something in expressions already"
        else:
            continue
        problems.append(Problem("duplicate-name",
                                f"{quoted(meter.name)} {problem}", f"$.meters[{i}].name"))
    return problems
