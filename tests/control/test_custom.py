"""Python callables as controllers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.elements.controllers.custom import Custom, StopRun
from sandbox.errors import ControllerFailed


def custom(**more: Any) -> Custom:
    return Custom(**{"name": "mine", "reads": ["a.angle"], "writes": ["u"],
                     "act": lambda t, x: 0.0, **more})


def test_one_name_one_pair_one_number_will_do():
    plain = custom(reads="a.angle", writes="u", limits=(0, 2), slew=5)
    assert (plain.reads, plain.writes) == (("a.angle",), ("u",))
    assert (plain.limits, plain.slew) == (((0.0, 2.0),), (5.0,))
    several = custom(writes=["u", "v"], limits=[(0, 2), [1, 3]], slew=(1, 2))
    assert (several.limits, several.slew) == (((0.0, 2.0), (1.0, 3.0)), (1.0, 2.0))
    assert custom(reads=[]).reads == ()
    assert custom(reads=["= a.angle - b.angle "]).reads == ("=a.angle - b.angle",)


@pytest.mark.parametrize(("more", "words"), [
    ({"name": "mine\n"}, "is not"), ({"name": 3}, "3 is not"),
    ({"reads": [3]}, "'reads' must be a list"), ({"reads": ["=a +"]}, "'reads': 'a +' is not"),
    ({"writes": ["u", "u"]}, "twice"), ({"act": 3}, "callable"), ({"rate": "1 kHz"}, "finite"),
    ({"rate": float("nan")}, "finite"), ({"limits": (2, 1)}, "lowest, highest"),
    ({"limits": [(0, 1), (0, 1)]}, "'limits' must be 1"), ({"limits": [(0, "1")]}, "finite"),
    ({"slew": 0}, "greater than 0"), ({"slew": [1, 2]}, "1 entries"),
])
def test_wrong_arguments_are_refused(more, words):
    with pytest.raises(ValueError, match="controller") as error:
        custom(**more)
    assert words in str(error.value)


@pytest.mark.parametrize(("result", "wanted"), [
    (2, [2.0]), (np.float64(2), [2.0]), ([2], [2.0]), (np.array([2.0]), [2.0]), ((2.0,), [2.0]),
])
def test_a_number_or_one_for_each_drive(result, wanted):
    law = custom(act=lambda t, x: result).law()
    law.begin([1.0], [], [0.0])
    assert law.act(0.5, [1.0], [], [0.0]) == wanted
    assert law.report() == {}


@pytest.mark.parametrize(("result", "words"), [
    ([1.0, 2.0], "2 values for 1 drives"), ([], "0 values for 1 drives"),
    (None, "returned None instead of numbers"), ("3", "'3' instead"), (["x"], "instead"),
    (1j, "instead"),
])
def test_a_wrong_return_is_named(result, words):
    law = custom(act=lambda t, x: result).law()
    with pytest.raises(ControllerFailed, match=r"'mine': act\(\) at t = 0.25 s") as error:
        law.act(0.25, [1.0], [], [0.0])
    assert words in str(error.value)


def test_a_controller_without_outputs_returns_nothing():
    seen = []
    law = custom(writes=[], act=lambda t, x: seen.append((t, *x))).law()
    assert law.act(0.5, [3.0], [], []) == []
    assert seen == [(0.5, 3.0)]
    with pytest.raises(ControllerFailed, match=r"returned 2\.0, but 'writes' names no drive"):
        custom(writes=[], act=lambda t, x: 2.0).law().act(0.5, [3.0], [], [])


def test_stop_run_passes_through():
    def enough(t, x):
        raise StopRun("far enough", verdict="fail")

    with pytest.raises(StopRun) as wish:
        custom(act=enough).law().act(0.5, [3.0], [], [0.0])
    assert (wish.value.because, wish.value.verdict) == ("far enough", "fail")
    with pytest.raises(ValueError, match="'pass' or 'fail', not 'done'"):
        StopRun(verdict="done")
