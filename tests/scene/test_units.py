"""Quantities: every unit, every spelling, and nothing but WrongValueError for the rest."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.values.units import UNITS, parse_quantity
from sandbox.wording import WrongValueError

ONE = {
    # SI Brochure, 9th edition, tables 2 to 8; inch and pound by the agreement of 1959, the
    # pound-force at the standard acceleration 9.80665 m/s^2 of 1901
    "length": {"m": "1", "dm": "1/10", "cm": "1/100", "mm": "1/1000", "um": "1/1000000",
               "µm": "1/1000000", "in": "254/10000"},
    "mass": {"kg": "1", "g": "1/1000", "mg": "1/1000000",
             "lb": "45359237/100000000"},
    "time": {"s": "1", "ms": "1/1000", "us": "1/1000000", "µs": "1/1000000", "min": "60"},
    "force": {"N": "1", "mN": "1/1000", "kN": "1000", "MN": "1000000",
              "lbf": "44482216152605/10000000000000"},
    "pressure": {"Pa": "1", "kPa": "1000", "MPa": "1000000", "GPa": "1000000000",
                 "bar": "100000", "mbar": "100",
                 "psi": f"{44482216152605 * 10**8}/{10**13 * 254**2}"},
    "energy": {"J": "1", "mJ": "1/1000", "kJ": "1000", "MJ": "1000000"},
    "power": {"W": "1", "mW": "1/1000", "kW": "1000", "MW": "1000000"},
    "torque": {"N m": "1", "N mm": "1/1000", "mN m": "1/1000", "N cm": "1/100",
               "kN m": "1000", "kN mm": "1", "kN cm": "10", "MN m": "1000000"},
    "stiffness": {"N/m": "1", "N/mm": "1000", "kN/m": "1000", "N/cm": "100",
                  "kN/mm": "1000000", "MN/m": "1000000"},
    "rotary stiffness": {"N m/rad": "1", "N mm/rad": "1/1000", "kN m/rad": "1000"},
    "damping": {"N s/m": "1", "N s/mm": "1000", "kN s/m": "1000"},
    "rotary damping": {"N m s/rad": "1", "N mm s/rad": "1/1000", "kN m s/rad": "1000"},
    "density": {"kg/m^3": "1", "g/cm^3": "1000"},
    "inertia": {"kg m^2": "1", "kg mm^2": "1/1000000", "g mm^2": "1/1000000000"},
    "frequency": {"Hz": "1", "kHz": "1000", "1/s": "1"},
    "speed": {"m/s": "1", "mm/s": "1/1000", "cm/s": "1/100"},
    "acceleration": {"m/s^2": "1", "mm/s^2": "1/1000"},
    "angle": {"rad": "1", "mrad": "1/1000"},
    "angular speed": {"rad/s": "1"},
    "ratio": {"%": "1/100"},
    "area": {"m^2": "1", "cm^2": "1/10000", "mm^2": "1/1000000"},
    "volume": {"m^3": "1", "l": "1/1000", "ml": "1/1000000", "cm^3": "1/1000000",
               "mm^3": "1/1000000000"},
    "flow": {"m^3/s": "1", "l/s": "1/1000", "l/min": "1/60000", "ml/s": "1/1000000",
             "ml/min": "1/60000000", "cm^3/s": "1/1000000", "mm^3/s": "1/1000000000"},
    "displacement": {"m^3/rad": "1", "ml/rad": "1/1000000", "cm^3/rad": "1/1000000"},
    "flow resistance": {"Pa s/m^3": "1", "bar s/l": "100000000", "bar s/ml": "100000000000",
                        "kPa s/ml": "1000000000"},
}
"""What one of each unit is in SI, as a fraction; written for this test, not taken from UNITS."""
OF_A_TURN = {"angle": {"deg": "1/360", "°": "1/360", "turn": "1"},
             "angular speed": {"deg/s": "1/360", "rpm": "1/60"}}
"""Those that are so much of a turn, 2 pi rad."""


@pytest.mark.parametrize(("dimension", "unit", "factor"), [
    *((dimension, unit, float(Fraction(one))) for dimension, units in ONE.items()
      for unit, one in units.items()),
    *((dimension, unit, float(Fraction(turns)) * 2 * math.pi)
      for dimension, units in OF_A_TURN.items() for unit, turns in units.items()),
    ("rotary stiffness", "N m/deg", 360 / (2 * math.pi)),
])
def test_units_have_their_si_values(dimension: str, unit: str, factor: float) -> None:
    assert parse_quantity(f"1 {unit}", dimension) == pytest.approx(factor, rel=4e-16)
    assert parse_quantity(f"-2.5 {unit}", dimension) == pytest.approx(-2.5 * factor, rel=4e-16)


def test_no_unit_and_no_dimension_is_left_out_of_that_list() -> None:
    listed = {(unit, dimension) for units in (ONE, OF_A_TURN) for dimension in units
              for unit in units[dimension]} | {
                  ("N m/deg", "rotary stiffness"), ("ml/turn", "displacement")}
    assert {(unit, dimension) for unit, (_, dimension) in UNITS.items()} == listed


@pytest.mark.parametrize(("text", "dimension", "value"), [
    ("15 deg", "angle", math.pi / 12), ("15°", "angle", math.pi / 12), ("2 N·m", "torque", 2.0),
    ("2 N*m", "torque", 2.0), ("2N m", "torque", 2.0),
    ("2 Nm", "torque", 2.0), ("2Nmm", "torque", 0.002), ("3 kNm", "torque", 3e3),
    ("3 MNm", "torque", 3e6), ("2 mNm", "torque", 0.002),
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
    ("12 nm", "length", "unknown unit 'nm'", ""), ("12 GN m", "torque", "unknown unit 'GN m'", ""),
    ("12 km2", "area", "unknown unit 'km2'", ""),
    ("12 KN", "force", "unknown unit 'KN'", "'kN'"),
    ("12 mm2", "area", "unknown unit 'mm2'", "'mm^2'"),
    ("12 gmm^2", "inertia", "unknown unit 'gmm^2'", "'g mm^2'"),
    ("12 lbs", "mass", "unknown unit 'lbs'", "'lb'"),
    ("12 lb", "force", "'lb' is a unit of mass, but this is a force", "'lbf'"),
    ("12 rad", "angular speed", "'rad' is a unit of angle, but this is an angular speed",
     "'rad/s'"),
    ("12 rpm", "frequency", "'rpm' is a unit of angular speed, but this is a frequency", ""),
    ("12 degrees", "angle", "unknown unit 'degrees'", "'deg'"),
    ("twelve mm", "length", "'twelve mm' is not a number with a unit", ""),
    ("1e400 m", "length", "'1e400 m' is too large a number", ""),
    ("", "length", "'' is not a number with a unit", ""),
    ("1.2.3 m", "length", "'1.2.3 m' is not a number with a unit", ""),
])
def test_refusals_say_why(text: str, dimension: str, words: str, hint: str) -> None:
    with pytest.raises(WrongValueError) as refused:
        parse_quantity(text, dimension)
    assert refused.value.message == words
    assert refused.value.hint == hint
