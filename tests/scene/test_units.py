"""Quantities: every unit, every spelling, and nothing but WrongValueError for the rest."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.values.units import UNITS, parse_quantity
from sandbox.wording import WrongValueError

PREFIXES = {"": 1, "k": 1000, "M": 10**6, "G": 10**9, "d": "1/10", "c": "1/100", "m": "1/1000",
            "u": "1/1000000", "µ": "1/1000000"}
ONES = {"m": "1", "g": "1/1000", "s": "1", "N": "1", "Pa": "1", "bar": "100000", "J": "1", "W": "1",
        "Hz": "1", "l": "1/1000", "rad": "1", "min": "60", "1": "1", "%": "1/100",
        "in": "254/10000", "lb": "45359237/100000000",
        "lbf": "44482216152605/10000000000000",
        "psi": f"{44482216152605 * 10**8}/{10**13 * 254**2}"}
"""SI Brochure, 9th edition, tables 2 to 8; inch and pound by the agreement of 1959, the pound-force
at the standard acceleration 9.80665 m/s^2 of 1901."""
TURNS = {"deg": "1/360", "°": "1/360", "turn": "1", "rpm": "1/60"}
"""Units that are so much of a turn, 2 pi rad."""


def _one(word: str) -> float:
    """A unit without products, such as ``mm^2``, in SI."""
    name, _, power = word.partition("^")
    if name in TURNS:
        return float(Fraction(TURNS[name])) * 2 * math.pi
    prefix = "" if name in ONES else name[0]
    return float((Fraction(PREFIXES[prefix]) * Fraction(ONES[name.removeprefix(prefix)]))
                 ** int(power or 1))


@pytest.mark.parametrize("unit", UNITS)
def test_units_are_products_of_their_words(unit: str) -> None:
    above, _, below = unit.partition("/")
    factor = math.prod(map(_one, above.split())) / math.prod(map(_one, below.split()))
    dimension = UNITS[unit][1]
    assert parse_quantity(f"1 {unit}", dimension) == pytest.approx(factor, rel=1e-15)
    assert parse_quantity(f"-2.5 {unit}", dimension) == pytest.approx(-2.5 * factor, rel=1e-15)


@pytest.mark.parametrize(("text", "dimension", "value"), [
    ("15°", "angle", math.pi / 12), ("2 N·m", "torque", 2.0), ("2 N*m", "torque", 2.0),
    ("2Nmm", "torque", 0.002), ("3 MNm", "torque", 3e6), ("2 mNm", "torque", 0.002),
    ("2 Nm/rad", "rotary stiffness", 2.0), ("2 Nms/rad", "rotary damping", 2.0),
    ("2 Ns/m", "damping", 2.0), ("60 rpm", "angular speed", 2 * math.pi),
    ("10 lbf", "force", 10 * 0.45359237 * 9.80665), ("1 psi", "pressure", 6894.757293168361),
    ("3 kg m²", "inertia", 3.0),
    ("1.5e-3 m", "length", 0.0015), (" .5 ms ", "time", 0.0005), ("−5 mm", "length", -0.005),
    ("5 1/s", "frequency", 5.0), ("90 °/s", "angular speed", math.pi / 2), ("7", "length", 7.0),
    ("0.1 %", "ratio", 0.001), ("4 μm", "length", 4e-6), ("2 N m / rad", "rotary stiffness", 2.0),
])
def test_spellings(text: str, dimension: str, value: float) -> None:
    assert parse_quantity(text, dimension) == pytest.approx(value, rel=1e-15)


@given(st.text(max_size=150), st.sampled_from([None, "length", "angle", "ratio"]))
def test_any_text_is_a_finite_number_or_refused(text: str, dimension: str | None) -> None:
    try:
        value = parse_quantity(text, dimension)
    except WrongValueError:
        return
    assert math.isfinite(value)


@pytest.mark.parametrize(("text", "dimension", "words", "hint"), [
    ("12 m/s", "length", "'m/s' is a unit of speed, but this is a length", ""),
    ("12 nm", "length", "unknown unit 'nm'", ""), ("12 KN", "force", "unknown unit 'KN'", "'kN'"),
    ("12 mm2", "area", "unknown unit 'mm2'", "'mm^2'"),
    ("12 lb", "force", "'lb' is a unit of mass, but this is a force", "'lbf'"),
    ("12 rad", "angular speed", "'rad' is a unit of angle, but this is an angular speed",
     "'rad/s'"),
    ("12 degrees", "angle", "unknown unit 'degrees'", "'deg'"),
    ("twelve mm", "length", "'twelve mm' is not a number with a unit", ""),
    ("1e400 m", "length", "'1e400 m' is too large a number", ""),
    ("1.2.3 m", "length", "'1.2.3 m' is not a number with a unit", ""),
])
def test_refusals_say_why(text: str, dimension: str, words: str, hint: str) -> None:
    with pytest.raises(WrongValueError) as refused:
        parse_quantity(text, dimension)
    assert refused.value.message == words
    assert refused.value.hint == hint
