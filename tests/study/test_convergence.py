"""The verdict on a quantity, from made-up values at three steps."""

from __future__ import annotations

import math

import pytest

from sandbox.samples.expectations import Verdict
from sandbox.study.convergence import Kind, Trust, judge


def verdict_of(values: tuple[float, float, float], low: float, high: float, *,
               harder: float | None = None, scale: float = 1.0) -> Trust:
    verdict = Verdict("q", "mean", low, high, values[0], low <= values[0] <= high, "N")
    return judge(verdict, values, values[0] if harder is None else harder, scale)


def power(p: float, error: float) -> tuple[float, float, float]:
    """A quantity that is 1 in the limit and off by ``error`` at h, of order p."""
    return 1 + error, 1 + error / 2**p, 1 + error / 4**p


@pytest.mark.parametrize("p", [1.0, 2.0, 3.0])
def test_richardson_finds_order_and_error(p: float) -> None:
    trust = verdict_of(power(p, 0.01), 0.0, 2.0)
    assert trust.order == pytest.approx(p, abs=1e-9)
    assert trust.error == pytest.approx(0.01, rel=1e-9)
    assert trust.kind is Kind.CONVERGED


def test_error_beside_a_narrow_range() -> None:
    """The same convergence, but a range that the limit is not in."""
    trust = verdict_of(power(1, 0.01), 1.004, 1.02)
    assert trust.kind is Kind.STEP
    assert not trust.certified


def test_rounding_has_no_order() -> None:
    trust = verdict_of((1.0, 1.0 + 2e-12, 1.0 - 3e-12), 0.9, 1.1)
    assert math.isnan(trust.order)
    assert trust.kind is Kind.EXACT


def test_size_of_the_quantity_measures_rounding() -> None:
    """1e-12 is rounding of a tension of 4 N, and all of a quantity of 1e-12."""
    values = (1e-12, 3e-12, 2e-12)
    assert verdict_of(values, -1e-3, 1e-3, scale=4.0).kind is Kind.EXACT
    assert verdict_of(values, 0.0, 4e-12, scale=1e-12).kind is Kind.WITHIN


def test_no_limit_but_inside_its_range() -> None:
    trust = verdict_of((1.0, 1.2, 0.9), 0.2, 2.5)
    assert trust.kind is Kind.WITHIN
    assert trust.certified
    assert not trust.settled


def test_drifting_toward_its_range_s_end() -> None:
    assert verdict_of((1.0, 1.2, 1.6), 0.2, 1.9).kind is Kind.STEP


def test_iterations_that_matter() -> None:
    trust = verdict_of((1.0, 1.001, 1.0005), 0.9, 1.1, harder=1.5)
    assert trust.kind is Kind.ITERATIONS
    assert trust.iteration_change == pytest.approx(0.5)


def test_failing_at_h() -> None:
    assert verdict_of((3.0, 1.0, 1.0), 0.0, 2.0).kind is Kind.FAILS
    assert verdict_of((math.nan,) * 3, 0.0, 2.0).kind is Kind.FAILS


def test_open_ranges() -> None:
    assert verdict_of((5.0, 7.0, 7.0), 2.0, math.inf).kind is Kind.WITHIN
    assert verdict_of(power(2, 1e-3), 0.5, math.inf).kind is Kind.CONVERGED


def test_a_count_that_reading_between_samples_rounds() -> None:
    """2 contacts, read as 2 - 4e-16, where at least 2 are expected."""
    assert verdict_of((2.0, 2.0 - 4.4e-16, 2.0), 2.0, math.inf, scale=2.0).kind is Kind.EXACT
