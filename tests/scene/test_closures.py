"""Closures against the evaluator of expressions: the same number, or no finite one in both."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.scene.values.closures import _FUNCTIONS, closure
from sandbox.scene.values.expressions import FUNCTIONS, parse_expression

NUMBERS = st.floats(-50, 50, allow_nan=False).map(lambda x: round(x, 3))
NAMES = ("a", "finger.mcp.angle", "t")


def texts() -> st.SearchStrategy[str]:
    leaf = st.one_of(st.sampled_from(NAMES), NUMBERS.map(lambda x: f"({x!r})"),
                     st.sampled_from(["pi", "deg"]))

    def grow(inner: st.SearchStrategy[str]) -> st.SearchStrategy[str]:
        signs = st.sampled_from(["+", "-", "*", "/", "%", "**", "<", ">=", "==", "!=", "and",
                                 "or"])
        binary = st.tuples(inner, signs, inner)
        calls = st.sampled_from(sorted(FUNCTIONS)).flatmap(lambda name: st.lists(
            inner, min_size=FUNCTIONS[name][1] or 2, max_size=FUNCTIONS[name][1] or 3,
        ).map(lambda given: f"{name}({', '.join(given)})"))
        return st.one_of(
            binary.map(lambda x: f"({x[0]} {x[1]} {x[2]})"), inner.map(lambda x: f"(-{x})"), calls,
            inner.map(lambda x: f"(not {x})"),
            st.tuples(inner, inner, inner).map(lambda x: f"({x[0]} if {x[1]} else {x[2]})"))

    return st.recursive(leaf, grow, max_leaves=6)


@given(text=texts(), values=st.tuples(NUMBERS, NUMBERS, NUMBERS))
def test_the_same_number(text, values):
    known = dict(zip(NAMES, values, strict=True))
    got = closure(text, lambda name: lambda: known[name])()
    try:
        wanted = parse_expression(text).evaluate(known)
    except ValueError:
        # a branch that is not taken may have no value; then only the array form fails
        assert math.isnan(got) or " if " in text
        return
    assert got == pytest.approx(wanted, rel=1e-12, abs=1e-300) or math.isnan(got)
    if math.isnan(got):  # on the way to a finite end something overflowed, or divided by zero
        assert any(symbol in text for symbol in ("/", "%", "**", "exp", "tan", "log", "sqrt",
                                                "asin", "acos"))


def test_every_function_is_known():
    assert _FUNCTIONS.keys() == FUNCTIONS.keys()


@pytest.mark.parametrize("text", ["1 / a", "sqrt(-1 - a)", "log(a)", "(-8.0) ** 0.5", "exp(1e6)",
                                  "2 ** 65", "min(a / a, 1)", "asin(2)"])
def test_without_a_finite_value_it_is_nan(text):
    assert math.isnan(closure(text, lambda name: lambda: 0.0)())


def test_nan_is_not_lost_in_a_minimum():
    for text in ("min(a, 1)", "min(1, a)", "max(1, a)", "clip(a, 0, 1)", "clip(1, a, 2)"):
        assert math.isnan(closure(text, lambda name: lambda: math.nan)())
