"""What meters and expectations of a scene ask of the catalogue, checked."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.errors import Problem
from sandbox.model import meters
from sandbox.model.catalogue import PAIR, Catalogue
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Expect
from sandbox.values.expressions import RESERVED
from sandbox.values.units import UNITS, Measured, factor_of
from sandbox.wording import MOST_HINTED, WrongValueError, is_pattern, quoted


def check_quantities(mechanism: Mechanism) -> list[Problem]:
    """What meters and expectations ask for that a run does not have.

    Unknown names (with near misses), patterns that fit nothing, meters whose
    names mean something else already, meters that depend on themselves, and
    numbers that an expectation holds a quantity of another dimension to.
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
    """Numbers of an expectation with a unit of another dimension than its quantities have.

    ``units`` are those of the patterns that were looked up, which what is new is added to.
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
    """The refusal of a quantity; what it may be only of those of small ``rank``."""
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
        path = f"$.meters[{i}].value"
        pairs = [pair for pair in meters.quotients(meter.value) if pair in known]
        problems.extend(meters.no_pair(pair, path) for pair in pairs)
        halves = {half for pair in pairs for half in pair.split("/")}
        for name in sorted(meters.names_read(meter) - {"t"} - halves):
            if name not in known:
                problems.append(unknown(known, "unknown quantity", name, path, len(problems)))
    for circle in meters.order(known.mechanism)[1]:
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
