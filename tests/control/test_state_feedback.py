"""State feedback against matrices, and against the PID law where the two are the same."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.elements.controllers.pid import Pid, PidController
from sandbox.elements.controllers.state_feedback import StateFeedback, StateFeedbackController

from .loops import cut, fed

H = 1e-3


def law(gains: Any, integral: Any = None, **more: Any) -> StateFeedback:
    rows, columns = len(gains), len(gains[0])
    spec = {"type": "state_feedback", "name": "law", "reads": [f"x.q{j}" for j in range(columns)],
            "writes": [f"u{i}" for i in range(rows)], "targets": [0.0] * columns,
            "gains": gains, "integral_gains": integral, **more}
    return StateFeedback(StateFeedbackController.model_validate(spec), H)


def test_rows_are_those_of_the_matrices():
    """u = bias + K e + the trapezoidal sum of Ki e, for 2 drives and 3 readings."""
    rng = np.random.default_rng(2)
    K, Ki, bias = rng.normal(size=(2, 3)), rng.normal(size=(2, 3)), rng.normal(size=2)
    errors = rng.normal(size=(50, 3))
    u = law(K.tolist(), Ki.tolist(), bias=bias.tolist())
    readings = rng.normal(size=(50, 3))
    u.begin(list(readings[0]), list(errors[0] + readings[0]), [0.0, 0.0])
    applied, got = [0.0, 0.0], []
    for x, e in zip(readings, errors, strict=True):
        applied = u.act(0.0, list(x), list(e + x), applied)
        got.append(applied)
    sums = np.vstack([np.zeros(3), H * np.cumsum((errors[1:] + errors[:-1]) / 2, axis=0)])
    np.testing.assert_allclose(got, bias + errors @ K.T + sums @ Ki.T, rtol=0, atol=1e-13)


@given(st.floats(-50, 50), st.floats(-900, 900), st.floats(0.1, 10), st.floats(0.01, 10),
       st.lists(st.floats(-10, 10), min_size=2, max_size=40))
def test_one_row_is_a_pi(kp, ki, limit, most, errors):
    """The same to rounding, with limits and rate limits."""
    limits = (-limit, limit)
    wanted, applied = fed(law([[kp]], [[ki]], bias=[0.5]), errors, limits=limits, most=most)
    pi, pi_applied = fed(Pid(PidController.model_construct(kp=kp, ki=ki, bias=0.5), H),
                           errors, limits=limits, most=most)
    np.testing.assert_allclose(wanted, pi, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(applied, pi_applied, rtol=1e-12, atol=1e-12)


def test_only_the_row_that_is_cut_is_held():
    """Both rows integrate +1; the first drive stops at 0.02, the second continues."""
    u = law([[0.0], [0.0]], [[10.0], [10.0]], bias=[0.0, 0.0])
    applied = [0.0, 0.0]
    u.begin([0.0], [1.0], applied)
    for k in range(101):
        wanted = u.act(k * H, [0.0], [1.0], applied)
        applied = [cut(wanted[0], 0.0, (-0.5, 0.025), 1.0), wanted[1]]
    assert wanted[0] == pytest.approx(0.03, abs=1e-12)  # the first multiple of ki h beyond
    assert wanted[1] == pytest.approx(1.0, abs=1e-12)
    # and an error of the other sign leads back at once: the mean of 1 and -3 takes ki h off
    wanted = u.act(0.1, [3.0 + 1.0], [1.0], applied)
    assert wanted == pytest.approx([0.02, 0.99], abs=1e-12)


@pytest.mark.parametrize("active", [True, False])
def test_a_law_switched_on_late_continues_from_the_drive_values(active):
    """Rows that integrate do; the other one keeps to its bias."""
    u = law([[2.0, 1.0], [3.0, 0.0]], [[5.0, 0.0], [0.0, 0.0]], bias=[100.0, 200.0], active=active)
    if active:
        u.begin([0.0, 0.0], [1.0, 1.0], [0.0, 0.0])
        assert u.act(0.0, [0.0, 0.0], [1.0, 1.0], [0.0, 0.0]) == [103.0, 203.0]
    u.begin([0.0, 0.0], [1.0, 1.0], [-7.0, -8.0])
    assert u.act(0.0, [0.0, 0.0], [1.0, 1.0], [-7.0, -8.0]) == [-7.0, 203.0]
