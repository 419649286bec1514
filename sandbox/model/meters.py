"""Meters and expectations: checks of the quantities that they read, values of meters."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from graphlib import CycleError, TopologicalSorter

import numpy as np

from sandbox.elements.quantities import row_of
from sandbox.errors import Problem
from sandbox.model.catalogue import PAIR, Catalogue, pair_parts
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Expect, ShownMeter, View
from sandbox.values.expressions import RESERVED, is_expression, names_in, parse_expression, rings
from sandbox.values.units import UNITS, Measured, factor_of
from sandbox.wording import MAX_HINTED, WrongValueError, is_pattern, listed, quoted

Read = Callable[[str], Array]
_QUOTIENT = re.compile(r"([A-Za-z_][\w.]*) */ *([A-Za-z_][\w.]*)")


def order(mechanism: Mechanism) -> tuple[list[int], list[list[int]]]:
    """Indices of the meters after those that they read, and the cycles among them.

    Meters of a cycle, and those that read them, are not in the order.
    """
    place = {meter.name: i for i, meter in reversed([*enumerate(mechanism.meters)])}
    reads = {index: sorted(place[name] for name in names_in(meter.value) & place.keys())
             for index, meter in enumerate(mechanism.meters)}
    sorter, done = TopologicalSorter(reads), list[int]()
    circles = [ring[(at := ring.index(min(ring))):] + ring[:at] for ring in rings(reads)]
    with suppress(CycleError):  # it goes on as far as there is no cycle
        sorter.prepare()
    while ready := sorted(sorter.get_ready()):
        done += ready
        sorter.done(*ready)
    return done, circles


def evaluate(mechanism: Mechanism, *, read: Read, time: Array) -> tuple[Array, list[str]]:
    """All meters over a run, [n, nm], and notes on those without a value; ``read`` as of a run."""
    result = np.full((len(time), len(mechanism.meters)), np.nan)
    notes: dict[int, str] = {}
    known: dict[str, Array] = {"t": time}
    ordered, circles = order(mechanism)
    for index in ordered:
        meter = mechanism.meters[index]
        try:
            result[:, index] = worked_out(
                meter.value, mechanism, lambda name: known[name] if name in known else read(name))
        except (KeyError, ValueError) as error:
            notes[index] = f"meter {meter.name!r} has no value: {error}"
        column = known[meter.name] = result[:, index]
        bad = ~np.isfinite(column)
        column[bad] = np.nan
        if index not in notes and bad.any():
            notes[index] = (f"meter {meter.name!r} has no finite value in {bad.sum()} of "
                            f"{len(column)} samples, first at t = {time[bad.argmax()]:.6g} s")
    for index in sorted({index for circle in circles for index in circle}):
        notes[index] = f"meter {mechanism.meters[index].name!r} has no value: it depends on itself"
    return result, [notes[index] for index in sorted(notes)]


MAX_CURVES = 6  # largest number of curves of a meter


def curves(meter: ShownMeter, known: Catalogue) -> list[str]:
    """The quantities and expressions that a meter shows, each once."""
    found = (name for word in meter.of
             for name in ([word] if is_expression(word) else known.match(word)))
    return list(dict.fromkeys(found))


def worked_out(word: str, mechanism: Mechanism, read: Read) -> Array:
    """Values of an expression, nan without one; ``read`` gives quantities and ``t``."""
    expression = parse_expression(word)
    known = {name: read(name) for name in sorted(expression.names)}
    return np.asarray(expression.evaluate({**mechanism.functions, **known}, finite=False))


def check_shown(mechanism: Mechanism) -> list[Problem]:
    """Problems of the meters in the scene's picture: unknown quantities, too many curves."""
    return problems_of(Catalogue(mechanism), mechanism.view) if mechanism.view.meters else []


def problems_of(known: Catalogue, view: View) -> list[Problem]:
    """The same of any view of a mechanism whose catalogue is ``known``."""
    problems: list[Problem] = []
    known.hinted = 0
    for i, meter in enumerate(view.meters):
        path, missing = f"$.view.meters[{i}]", list[Problem]()
        for j, word in enumerate(meter.of):
            if is_expression(word):
                missing += misread(known, word, names_in(word), f"{path}.of[{j}]")
            elif not known.match(word):
                missing.append(unknown(known, word, f"{path}.of[{j}]"))
        problems += missing
        if missing:
            continue
        names = curves(meter, known)
        if len(names) > MAX_CURVES:
            problems.append(Problem(
                "bad-quantity", f"{len(names)} curves are too many for one meter: "
                f"{listed(names)}", path, allowed=f"at most {MAX_CURVES}"))
        units = sorted({known.find(name).unit for name in names if not is_expression(name)})
        if len(units) > 1:
            problems.append(Problem(
                "bad-quantity", "all curves of one meter need the same unit, these have "
                f"{listed(units)}", path, allowed="a meter for each unit"))
    return problems


def misread(
    known: Catalogue, text: str, names: Iterable[str], path: str, *,
    itself: str = "an expectation may use the pair itself", live: bool = False,
) -> Iterator[Problem]:
    """Unknown names in an expression, and pairs, which only ``itself`` may read."""
    pairs = [pair for pair in sorted({
        f"{one}/{other}" for one, other in _QUOTIENT.findall(text)}) if pair in known]
    for pair in pairs:
        *bodies, quantity = pair_parts(pair)
        sums = " or ".join(quoted(f"{body}.contact.{quantity}") for body in bodies)
        yield Problem("bad-quantity", f"'/' divides in an expression, so that {quoted(pair)} is no "
                      "pair there", path, allowed=f"{sums}, the sums of all that touches one of "
                      f"them; {itself.format(quoted(pair))}")
    halves = {half for pair in pairs for half in pair.split("/")}
    for name in sorted({*names} - {"t"} - halves):
        if name not in known:
            yield unknown(known, name, path, live=live)


def unknown(known: Catalogue, name: str, path: str, *, live: bool = False) -> Problem:
    """The problem of an unknown quantity; with ``live`` only those of a run are listed."""
    what = f"{'no quantity fits' if is_pattern(name) else 'unknown quantity'} {quoted(name)}"
    if lacking := known.lacking(name):
        return Problem("unknown-quantity", f"{what}: {lacking}", path)
    known.hinted += 1
    few = known.hinted <= MAX_HINTED
    near, allowed = known.near(name) if few else "", ""
    if live:
        allowed = next((f"of this {element.kind}: " + listed(
            key for key in element.quantities if row_of(element.kind, key).live)
            for head in (name, name.rpartition(".")[0])
            if (element := known.elements.get(head)) is not None), "")
    elif few:
        allowed = known.allowed(name)
    return Problem("unknown-quantity", what, path, hint=quoted(near) if near else "",
                   allowed=allowed)


def check_quantities(mechanism: Mechanism) -> list[Problem]:
    """Problems of the quantities, names and units in meters and expectations."""
    known = Catalogue(mechanism)
    meters, others = mechanism.meters, Catalogue(mechanism.model_copy(update={"meters": ()}))
    problems = []
    for i, meter in enumerate(meters):
        taken = ("is the name of a recorded quantity" if meter.name in others else
                 "means something in expressions" if meter.name in RESERVED else "")
        if taken:
            problems.append(Problem("duplicate-name", f"{quoted(meter.name)} {taken} already",
                                    f"$.meters[{i}].name"))
    for i, meter in enumerate(meters):
        problems += misread(known, meter.value, names_in(meter.value), f"$.meters[{i}].value")
    for circle in order(mechanism)[1]:
        ring = " → ".join(quoted(meters[i].name) for i in [*circle, circle[0]])
        problems.append(Problem("circular-definition", "meters depend on each other in a circle: "
                                f"{ring}", f"$.meters[{circle[0]}].value"))
    fits: dict[str, bool] = {}
    units: dict[str, list[str]] = {}
    for i, expect in enumerate(mechanism.expect):
        if beyond := expect.past_end(mechanism.run.duration):
            problems.append(Problem("bad-time", beyond, f"$.expect[{i}].at")
                            if expect.at is not None else Problem(
                                "bad-time", beyond, f"$.expect[{i}].over", severity="warning",
                                advice="the expectation has no value and fails"))
        name = expect.quantity
        if name not in fits:
            fits[name] = bool(known.match(name))
        if fits[name]:
            problems += _check_units(known, expect, f"$.expect[{i}]", units)
        else:
            problems.append(unknown(known, name, f"$.expect[{i}].{expect.key}"))
    return problems


def _check_units(
    known: Catalogue, expect: Expect, path: str, units: dict[str, list[str]],
) -> Iterator[Problem]:
    """Numbers in a unit of another dimension than the quantities; ``units`` is a cache."""
    name = expect.quantity
    numbers: list[tuple[str, object]] = [
        ("is", expect.value), ("within", expect.within), ("above", expect.above),
        ("below", expect.below),
        *((f"between[{j}]", value) for j, value in enumerate(expect.between or ())),
        *((f"over[{j}]", instant) for j, instant in enumerate(expect.over))]
    for place, number in numbers:
        if not isinstance(number, Measured):
            continue
        if name not in units:
            units[name] = sorted(set(PAIR.values()) if "/" in name else {
                known.find(each).unit for each in known.match(name)})
        for unit in ["s"] if place.startswith("over") else units[name]:
            if unit not in UNITS and unit != "1":  # a meter's own word for its unit
                continue
            try:
                factor_of(number.unit, UNITS[unit][1] if unit in UNITS else "ratio")
            except WrongValueError as error:
                yield Problem.of(error, f"{path}.{place}")
                break
