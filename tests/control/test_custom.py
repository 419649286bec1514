"""Python callables as controllers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.elements.controllers.custom import Custom
from sandbox.errors import ControllerFailed


def custom(**more: Any) -> Custom:
    return Custom(**{"name": "mine", "reads": ["a.angle"], "writes": ["u"],
                     "act": lambda t, x: 0.0, **more})


def law_of(**more: Any) -> Any:
    return custom(**more).controller.make_law(None, 1e-3)


def test_one_name_one_pair_one_number_will_do():
    plain = custom(reads="a.angle", writes="u", limits=(0, 2), slew=5)
    assert (plain.reads, plain.writes) == (("a.angle",), ("u",))
    assert (plain.limits, plain.slew) == (((0.0, 2.0),), (5.0,))
    several = custom(writes=["u", "v"], limits=[(0, 2), [1, 3]], slew=(1, 2))
    assert (several.limits, several.slew) == (((0.0, 2.0), (1.0, 3.0)), (1.0, 2.0))
    assert custom(reads=[]).reads == ()
    assert custom(reads=["= a.angle - b.angle "]).reads == ("=a.angle - b.angle",)


@pytest.mark.parametrize(("more", "words"), [
    ({"name": "mine\n"}, "is not a name"), ({"name": 3}, "name: expected text, got the number 3"),
    ({"reads": [3]}, "reads[0]: expected text"), ({"reads": ["=a +"]}, "reads[0]: 'a +' is not"),
    ({"act": 3}, "act: input should be callable"), ({"rate": float("nan")}, "rate: must be finite"),
    ({"limits": (2, 1)}, "lowest, highest"), ({"limits": [(0, 1), (0, 1)]}, "expected 1 entries"),
    ({"limits": [(0, "one")]}, "limits[0]: 'one' is not a number"),
    ({"slew": 0}, "slew[0]: must be greater than 0"), ({"slew": [1, 2]}, "expected 1 entries"),
])
def test_wrong_arguments_are_refused(more, words):
    with pytest.raises(ValueError, match="controller") as error:
        custom(**more)
    assert words in str(error.value)


@pytest.mark.parametrize(("result", "wanted"), [
    (2, [2.0]), (np.float64(2), [2.0]), ([2], [2.0]), (np.array([2.0]), [2.0]), ((2.0,), [2.0]),
])
def test_a_number_or_one_for_each_drive(result, wanted):
    law = law_of(act=lambda t, x: result)
    law.begin([1.0], [], [0.0])
    assert law.act(0.5, [1.0], [], [0.0]) == wanted
    assert law.report() == {}


@pytest.mark.parametrize(("result", "words"), [
    ([1.0, 2.0], "2 values for 1 drives"), ([], "0 values for 1 drives"),
    (None, "returned None instead of numbers"), ("3", "'3' instead"), (["x"], "instead"),
    (1j, "instead"),
])
def test_a_wrong_return_is_named(result, words):
    law = law_of(act=lambda t, x: result)
    with pytest.raises(ControllerFailed, match=r"'mine': act\(\) at t = 0.25 s") as error:
        law.act(0.25, [1.0], [], [0.0])
    assert words in str(error.value)


def test_a_controller_without_outputs_returns_nothing():
    seen = []
    law = law_of(writes=[], act=lambda t, x: seen.append((t, *x)))
    assert law.act(0.5, [3.0], [], []) == []
    assert seen == [(0.5, 3.0)]
    with pytest.raises(ControllerFailed, match=r"returned 2\.0, but 'writes' names no drive"):
        law_of(writes=[], act=lambda t, x: 2.0).act(0.5, [3.0], [], [])
