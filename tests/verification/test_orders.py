"""Order of accuracy of every element that carries force; see :mod:`sandbox.study.exact_motions`.

Whether each reaches its order is one of the cases (``order_...`` in test_cases.py). Here: that
the yardsticks are right, and that a wrong scheme would be found out.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.study import independent as reference
from sandbox.study.exact_motions import elements
from sandbox.study.orders import measure
from sandbox.verification.cases import CASES
from sandbox.verification.cases.case import carry_out

ELEMENTS = {element.name: element for element in elements()}


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


def test_trajectory_is_an_oscillation() -> None:
    t = np.linspace(0.01, 1.0, 50)
    found = reference.trajectory(t, lambda _, x, v: -400.0 * x, [0.3])[:, 0]
    np.testing.assert_allclose(found, reference.oscillation(t, 20.0, 0.3), atol=1e-9)
