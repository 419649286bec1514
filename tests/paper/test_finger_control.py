"""The better controllers against what they are for, and the studies on small fare."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.paper.finger_plant import TARGET, Plant
from sandbox.paper.finger_trials import (
    BETTER,
    PAPER,
    RATE,
    TrialController,
    trial,
)
from sandbox.paper.finger_variants import VARIANTS
from sandbox.paper.least_pull import SURE, bisect, expected, reach
from sandbox.paper.redundancy import dual_end, line

DUAL = 2.39
"""Settling of the paper's dual control [s], of two independent programs."""
PAPER_TIMES = {"paper, 15 N": 1.90, "paper, 10 N": 1.45, "paper, dual": DUAL}


@pytest.mark.parametrize("controller", PAPER, ids=lambda c: c.name)
def test_the_papers_controllers_settle_when_the_reference_does(controller: TrialController):
    assert trial(controller).settling == pytest.approx(PAPER_TIMES[controller.name], rel=0.03)


@pytest.mark.parametrize("controller", BETTER, ids=lambda c: c.name)
class TestBetter:
    def test_twenty_times_sooner_without_overshoot(self, controller: TrialController):
        plain = trial(controller)
        assert plain.settling < DUAL / 20
        assert plain.overshoot < 2.0
        assert plain.steady_error < 0.5


@pytest.mark.parametrize(("name", "settling", "overshoot"), [
    ("gains only, 14 N", 0.155, 66), ("dual, Tp = 0", 1.80, 73), ("dual, Ti = 0", 2.54, 102),
    ("dual, loops retuned", 0.140, 29), ("10 N, slow springs, pull rises", 1.56, 34),
    ("PID retuned, slow springs, slower reference", 0.236, 20)])
def test_variants(name: str, settling: float, overshoot: float):
    """As the study's page quotes them, to their last digit."""
    found = trial(*next(each for each in VARIANTS if each[0].name == name))
    assert found.settling == pytest.approx(settling, rel=0.005)
    assert found.overshoot == pytest.approx(overshoot, abs=0.5)
    assert (found.stiffness.rate <= RATE * (1 + 1e-6)) == ("slow springs" in name)


class TestLeastPull:
    def test_bisection_finds_the_closed_form(self):
        """Within what the halving resolves and what counts as reached: SURE / (h / K) = 0.006 N."""
        predicted, _ = Plant().pull_range(TARGET)
        low, high = bisect(predicted - 0.5, predicted + 0.4)
        assert high - low <= 0.01
        assert low - 0.006 < predicted < high + 0.006

    @pytest.mark.parametrize("pull", [3.0, 5.0, 8.0])
    def test_where_the_finger_rests(self, pull):
        assert reach(pull).angles == pytest.approx(expected(pull), rel=SURE)

    def test_at_5_newton_the_knuckle_fails(self):
        assert not reach(5.0).reached
        assert math.degrees(reach(5.0).angles[0]) == pytest.approx(3.44, abs=0.05)


def test_the_dual_control_ends_on_the_line():
    """At 5 s its slowest integral still moves: 0.12 % of the rotation is left."""
    end = dual_end()
    assert end.stiffness == pytest.approx(line(np.array([end.pull]))[0], rel=2e-3)
    assert end.pull == pytest.approx(14.45, rel=5e-3)


class TestWhyDualControlTakesLonger:
    """The proportional part of the pull's loop holds the pull down while joints are too far in."""

    @pytest.mark.parametrize(("kp", "ki", "slowest"),
                             [(5000.0, 800.0, 1.06), (0.0, 800.0, 1.67), (0.0, 0.0, 1.62)])
    def test_the_slowest_pole(self, kp: float, ki: float, slowest: float):
        """(D + Tp g h^T) e' = -(KI + Ti g h^T) e at rest, D = Kp - T g', at 14.43 N."""
        plant, pull, step = Plant(), 14.43, 1e-5
        g, h = plant.stiffness(1.0, TARGET), plant.tendon_arms(TARGET)
        slope = (plant.stiffness(1.0, TARGET + step) - plant.stiffness(1.0, TARGET - step)) / (
            2 * step)
        moved = np.diag([2e5, 4e4, 1.5e4] - pull * slope) + kp * np.outer(g, h)
        pushed = np.diag([6e5, 1.5e5, 4e4]) + ki * np.outer(g, h)
        poles = np.linalg.eigvals(np.linalg.solve(moved, pushed))
        assert min(poles.real) == pytest.approx(slowest, abs=0.005)
