"""Time comes from the step's number."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.engine.clock import make_clock


@pytest.mark.parametrize(("duration", "step", "rate", "steps", "every"), [
    (1.0, 5e-4, 1000.0, 2000, 2),
    (0.3, 1e-4, 1000.0, 3000, 10),  # 0.3 / 1e-4 is 2999.9999999999995
    (0.7, 1e-4, 1000.0, 7000, 10),  # 0.7 / 1e-4 is 7000.000000000001
    (1.0, 3e-4, 1000.0, 3334, 3),  # no whole number: the run ends after, not before
    (1.0, 2e-3, 1000.0, 500, 1),  # no finer than the steps
    (1e-5, 5e-4, 1000.0, 1, 1),  # at least one step and one sample
    (0.01, 5e-4, 1.0, 20, 20),  # a sample at the end when the rate asks for none
])
def test_counts(duration: float, step: float, rate: float, steps: int, every: int) -> None:
    clock = make_clock(duration, step, rate)
    assert (clock.steps, clock.every) == (steps, every)


@given(st.floats(1e-6, 100), st.floats(1e-6, 0.1), st.floats(1e-3, 1e6))
def test_any_clock_is_sound(duration: float, step: float, rate: float) -> None:
    """Covers the duration, but not by a whole step more; samples lie inside the run."""
    clock = make_clock(duration, step, rate)
    assert clock.samples >= 1
    assert int(clock.sample_step(clock.samples - 1)) <= clock.steps
    assert clock.steps * step >= duration * (1 - 1e-8)
    assert (clock.steps - 1) * step < duration
