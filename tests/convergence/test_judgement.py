"""The verdict on a quantity, from made-up values at three steps."""

from __future__ import annotations

import math
from typing import Any

import pytest

from sandbox.convergence.certificate import Kind, Sizes, Trust, judge, tolerance
from sandbox.samples.expectations import Verdict


def verdict_of(values: tuple[float, float, float], low: float, high: float, *,
               own: float = 1.0, scene: float = 1.0,
               peak: float | None = None, given: bool = False) -> Trust:
    verdict = Verdict("q", "mean", low, high, values[0], low <= values[0] <= high, "N")
    return judge(verdict, values, Sizes(own if peak is None else peak, own, scene), given=given)


def power(p: float, error: float) -> tuple[float, float, float]:
    """A quantity that is 1 in the limit and off by ``error`` at h, of order p."""
    return 1 + error, 1 + error / 2**p, 1 + error / 4**p


# -- what the scene allows ------------------------------------------------------------


def allowed(low: float, high: float, *, value: float = 1.0, own: float = 1.0, scene: float = 1.0,
            given: bool = False) -> float:
    return tolerance(Verdict("q", "mean", low, high, value, True), value, Sizes(own, own, scene),
                     given=given)


@pytest.mark.parametrize(("low", "high", "more", "expected"), [
    (0.98, 1.02, {}, 0.02), (0.98, 1.02, {"given": True}, 0.02),
    (-math.inf, 1.03, {}, 0.03), (0.96, math.inf, {}, 0.04), (-math.inf, 0.97, {}, 0.03),
    (-1e3, 1e3, {"own": 2.0, "scene": 50.0}, 0.2),
    (-1e3, math.inf, {"own": 2.0, "scene": 50.0}, 0.2)])
def test_a_tolerance_is_half_the_width_or_the_distance_from_one_bound(
    low: float, high: float, more: dict[str, Any], expected: float,
) -> None:
    """Of a wide range a tenth of the quantity counts."""
    assert allowed(low, high, **more) == pytest.approx(expected)


# -- what does not settle -------------------------------------------------------------


def test_drifting_toward_its_range_s_end() -> None:
    assert verdict_of((1.0, 1.2, 1.6), 0.2, 1.9).kind is Kind.DIVERGES
    assert verdict_of((1.0, 1.3, 1.6), 0.2, 1.9).kind is Kind.WITHIN
    assert verdict_of((1.0, 1.3, 1.6), 0.2, 1.8).kind is Kind.OPEN


def test_the_step_that_would_do() -> None:
    """Of order 2, with an error of 0.04 where 0.002 is allowed: a factor of 20, so h/8, not h/4."""
    trust = verdict_of(power(2, 0.04), -9.0, 9.0, own=0.2)
    assert trust.kind is Kind.OPEN
    assert trust.allowed == pytest.approx(0.002)
    assert trust.finer == 8
    assert "falls with order 2.0" in trust.reason
    assert verdict_of(power(1, 0.04), -9.0, 9.0, own=0.2).finer == 32
    assert verdict_of(power(1, 0.04), -9.0, 9.0, own=1e-3).finer == 0  # finer than h/128
    assert verdict_of(power(2, 0.04), 0.96, 1.03).finer == 4  # it fails at h, and not by itself


def test_failing_at_h() -> None:
    trust = verdict_of((3.0, 1.0, 1.0), 0.0, 2.0)
    assert trust.kind is Kind.FAILS
    assert trust.reason == "it is outside its range at h, but not at h/4"
    assert verdict_of((3.0, 3.1, 3.12), 0.0, 2.0).reason == "it tends to 3.12667, outside 0 to 2"
    assert verdict_of((3.0, 3.1, 3.0), 0.0, math.inf).reason != ""
    assert verdict_of((-3.0, -3.1, -3.0), 0.0, math.inf).reason == "it is outside at least 0"
