"""Order of accuracy of every element that carries force; see :mod:`sandbox.study.exact_motions`.

Whether each reaches its order is one of the cases (``order_...`` in test_cases.py). Here: that
the yardsticks are right, and that a wrong scheme would be found out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sandbox.recording.recording import Recording
from sandbox.study import independent as reference
from sandbox.study.exact_motions import elements
from sandbox.study.orders import EXACT, ExactMotion, Order, measure
from sandbox.verification.cases import CASES
from sandbox.verification.cases.case import carry_out

ELEMENTS = {element.name: element for element in elements()}


def test_every_element_that_carries_force_is_there() -> None:
    words = " ".join(ELEMENTS)
    for needed in ("gravity", "linear spring", "rotary spring", "linear damper", "rotary damper",
                   "pulled tendon", "elastic tendon", "stiff tendon", "hard stop", "landing",
                   "sliding after the landing", "slip"):
        assert needed in words


@pytest.mark.parametrize("element", ELEMENTS.values(), ids=lambda element: element.name)
def test_each_says_its_theory_and_why(element: ExactMotion) -> None:
    assert element.theory in (2, EXACT)
    assert (element.floor > 0) == (element.theory == EXACT)
    assert element.solution
    assert len(element.why) > 20 or element.why.startswith("as ")


def test_order_of_a_known_power() -> None:
    element = ELEMENTS["linear spring"]
    errors = tuple(3.0 * h**1.5 for h in element.steps)
    np.testing.assert_allclose(Order(element, errors).orders, 1.5, rtol=1e-12)


def test_no_order_is_measured_below_the_floor() -> None:
    """An error above it at either step is one, whatever the other is."""
    element = replace(ELEMENTS["linear spring"], floor=1e-12)
    assert Order(element, (9e-13, 3e-13, 5e-13)).orders == (EXACT, EXACT)
    assert Order(element, (4e-11, 1e-11, 5e-13)).orders == pytest.approx((2.0, np.log2(20)))
    assert Order(element, (5e-13, 8e-12, 8e-12)).orders == pytest.approx((-4.0, 0.0))


def test_a_stop_that_gives_back_is_no_longer_exact() -> None:
    """A wheel that left its stop with a millionth of its speed would be 1e6 times 1e-10 above."""
    element = ELEMENTS["hard stop"]

    def thrown(run: Recording) -> float:
        return element.error(run) + 1e-6 * 5.0 * 0.1

    case = next(case for case in CASES if case.name == "order_hard_stop")
    assert all(check.ok for check in carry_out(case).checks)
    assert min(measure(replace(element, error=thrown)).orders) < 0.1


def test_times_taken_at_the_end_of_the_step_show_order_one() -> None:
    """Labelled t = k h in place of (k - 1/2) h, a pose is half a step of motion off: order 1."""
    element = ELEMENTS["linear damper"]

    def late(run: object) -> float:
        time = run.time + run.info.step / 2
        truth = 0.1 + 0.5 / 50.0 * (1 - np.exp(-50.0 * time))
        return float(np.abs(run["load.x"] - truth).max())  # type: ignore[index]

    found = measure(replace(element, error=late))
    assert max(found.orders) < 1.3


def test_slide_and_roll() -> None:
    """It rolls with 2/3 of its speed, however rough the plane, and does not jump in between."""
    t = np.linspace(0, 0.4, 4001)
    for friction in (0.1, 0.5):
        x = reference.slide_and_roll(t, 0.5, friction, 9.81)
        v = np.diff(x) / np.diff(t)
        assert v[0] == pytest.approx(0.5, abs=friction * 9.81 * 1e-4)
        assert v[-1] == pytest.approx(1 / 3, rel=1e-9)
        assert np.abs(np.diff(v)).max() < 1.01 * friction * 9.81 * 1e-4


def test_trajectory_is_an_oscillation() -> None:
    t = np.linspace(0.01, 1.0, 50)
    found = reference.trajectory(t, lambda _, x, v: -400.0 * x, [0.3])[:, 0]
    np.testing.assert_allclose(found, reference.oscillation(t, 20.0, 0.3), atol=1e-9)
