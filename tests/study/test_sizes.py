"""What the errors of a quantity are measured against."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.study.sizes import SceneSizes, usual
from tests.support.mechanisms import fixed, mass, mechanism


def drifting(speed: float = 0.5) -> Recording:
    """Two bodies for 2 s: 3 kg that rest at 0.1 m, 1 kg that moves on from 0.4 m."""
    return simulate(mechanism(duration=2.0, step=1e-2, bodies=[
        fixed("wall"), mass("heavy", 3.0, (0.1, 0.0)),
        mass("light", 1.0, (0.4, 0.0), velocity=(speed, 0.0))]))


def test_usual_size_is_a_mean_that_no_blow_sets() -> None:
    assert usual(np.array([-1.0, 1.0, 1.0, -1.0])) == 1.0
    assert usual(np.array([1.0] * 99 + [101.0])) == 2.0
    assert usual(np.array([np.nan, 3.0, np.inf])) == 3.0
    assert usual(np.array([np.nan])) == 0.0
    assert usual(np.array([])) == 0.0


def test_where_all_is_nothing_mass_length_and_time_stand_in() -> None:
    sizes = SceneSizes([drifting()])
    length = sizes.of_unit("m")
    assert sizes.of_unit("N") == pytest.approx(3.0 * length / 2.0**2)
    assert sizes.of_unit("J") == pytest.approx(3.0 * length**2 / 2.0**2)
    assert sizes.of_unit("rad") == 1.0
    assert sizes.of_unit("1") == 1.0
    assert sizes.of_unit("furlong") == 0.0
