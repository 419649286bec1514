"""Signals: what an author may write, the units of their fields, their values over time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from pydantic import TypeAdapter, ValidationError

from sandbox.scene.values.signals import AnySignal, ForceSignal, Path, Signal, values

T = np.array([0.0, 0.5, 1.0, 1.5, 2.0])
ADAPTER: TypeAdapter[AnySignal] = TypeAdapter(Signal)
FORCE: TypeAdapter[AnySignal] = TypeAdapter(ForceSignal)


def _values(written: Any, **parameters: float) -> list[float]:
    signal = ADAPTER.validate_python(written, context={"parameters": parameters})
    return values(signal, T).tolist()


@pytest.mark.parametrize(("written", "expected"), [
    (3, [3.0] * 5), ("3 N", [3.0] * 5), ("=pull / 2", [2.0] * 5),
    ({"constant": "3 mN"}, [0.003] * 5),
    ({"to": 4, "over": "2 s"}, [0.0, 1.0, 2.0, 3.0, 4.0]),
    ({"ramp": {"from": 2, "to": "=pull", "start": "1 s", "over": "1 s"}},
     [2.0, 2.0, 2.0, 3.0, 4.0]),
    ({"from": 1, "to": 2, "start": 1, "over": 0}, [1.0, 1.0, 2.0, 2.0, 2.0]),
    ({"table": [[0.5, 1], [1.5, 3]]}, [1.0, 1.0, 2.0, 3.0, 3.0]),
    ({"table": [[0.5, 1], [1.5, 3]], "between": "step"}, [1.0, 1.0, 1.0, 3.0, 3.0]),
    ("=pull * t", [0.0, 2.0, 4.0, 6.0, 8.0]), ({"expression": "t + 1"}, [1.0, 1.5, 2.0, 2.5, 3.0]),
])
def test_values(written: Any, expected: list[float]) -> None:
    assert _values(written, pull=4.0) == expected


def test_a_signal_read_again_is_the_same() -> None:
    for written in (3, {"to": 4, "over": 2}, {"table": [[0, 1]]}, "=pull * t"):
        signal = ADAPTER.validate_python(written, context={"parameters": {"pull": 2.0}})
        assert ADAPTER.validate_python(signal.model_dump(by_alias=True)) == signal
        assert ADAPTER.validate_python(signal) == signal


@pytest.mark.parametrize(("written", "place", "words"), [
    ("3 mm", (), "'mm' is a unit of length, but this is a force"),
    ({"to": "3 mm", "over": 1}, ("to",), "unit of length"),
    ({"table": [[0, 1], [1, "3 deg"]]}, ("table", 1, 1), "unit of angle"),
    ({"to": 3, "over": "1 N"}, ("ramp", "over"), "unit of force, but this is a time"),
    ("=tt", (), "unknown name 'tt'"), ("=sin(t, 1)", (), "takes one argument"),
    ({"expression": "x + t"}, ("formula", "expression"), "unknown name 'x'"),
    ({"table": [[1, 0], [1, 2]]}, ("table", "table"), "must increase"),
    ({"too": 3}, (), "expected a number, a ramp"), (True, (), "expected a number, a ramp"),
    (None, (), "expected a number, a ramp"), ([1], (), "expected a number, a ramp"),
    ({"to": 1, "over": -1}, ("ramp", "over"), "0 or more"),
])
def test_refusals(written: Any, place: tuple[str | int, ...], words: str) -> None:
    with pytest.raises(ValidationError) as refused:
        FORCE.validate_python(written)
    (error,) = refused.value.errors()
    assert words in error["msg"]
    assert error["loc"][:len(place)] == place


def test_all_wrong_units_of_a_table_at_once() -> None:
    with pytest.raises(ValidationError) as refused:
        FORCE.validate_python({"table": [[0, "1 mm"], [1, "2 s"]]})
    assert len(refused.value.errors()) == 2


def test_a_path_says_something() -> None:
    with pytest.raises(ValidationError, match="at least one of x, y and angle"):
        Path.model_validate({})
    assert Path.model_validate({"angle": "90 deg"}).angle is not None
