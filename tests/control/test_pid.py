"""The PID law against closed forms of sampled loops and against scipy's exact filters."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.signal import lfilter, lsim

from sandbox.elements.controllers.pid import Pid, PidController

from .loops import Plant, closed, fed

H = 1e-3
ROUNDING = 1e-12
STEP = [0.0, *[1.0] * 3000]
"""At rest at the first act, where nothing has been integrated; the step comes with the second."""


def pid(kp: float = 0.0, ki: float = 0.0, kd: float = 0.0, *, h: float = H, **more: Any) -> Pid:
    return Pid(PidController.model_construct(kp=kp, ki=ki, kd=kd, **more), h)


@pytest.mark.parametrize("filter_time", [0.0, 0.04])
@pytest.mark.parametrize("gains", [(40.0, 300.0, 0.0), (60.0, 400.0, 1.5), (-40.0, -300.0, -0.5)])
def test_pid_on_a_mass_on_a_spring(gains, filter_time):
    """Target to reading is P C / (1 + P (C + D)), with P sampled exactly under a held input,
    C = kp + ki h/2 (z+1)/(z-1) and, on the reading alone, D = kd (1-a)/h (z-1)/(z-a).
    """
    h, (kp, ki, kd) = 0.01, gains
    plant = Plant([[0, 1], [-80, -6]], [0, math.copysign(2.0, kp)], [1, 0], h)
    law = pid(kp, ki, kd, h=h, filter=filter_time)
    got, _ = closed(law, plant, STEP, 500, h=h)

    a = math.exp(-h / filter_time) if filter_time else 0.0
    top, bottom = plant.fraction()
    C = np.array([kp + ki * h / 2, ki * h / 2 - kp])
    D = kd * (1 - a) / h * np.array([1, -1])
    low, integrator = np.array([1, -a]), np.array([1, -1])
    numerator = np.polymul(top, np.polymul(C, low))
    denominator = np.polyadd(np.polymul(bottom, np.polymul(integrator, low)),
                             np.polyadd(numerator, np.polymul(top, np.polymul(D, integrator))))
    numerator = np.concatenate([np.zeros(len(denominator) - len(numerator)), numerator])
    wanted = lfilter(numerator, denominator, STEP[:500])
    assert wanted.max() > 0.9
    assert np.abs(np.roots(denominator)).max() < 1
    # some ten roundings in each coefficient of the denominator, relative to its value at z = 1,
    # by which the filter's steady value is divided
    rounding = 10 * np.spacing(1) * np.abs(denominator).sum() / abs(np.polyval(denominator, 1))
    assert rounding < 1e-9
    np.testing.assert_allclose(got, wanted, rtol=0, atol=rounding)


def test_the_derivative_is_that_of_straight_lines_through_a_low_pass():
    """s/(tau s + 1) of a reading that goes straight from act to act, which lsim integrates
    exactly."""
    tau, readings = 7e-3, np.cumsum(np.random.default_rng(1).normal(size=400))
    law = pid(kd=1.0, filter=tau, bias=0.0)
    law.begin([readings[0]], [0.0], [0.0])
    got = [-law.act(k * H, [y], [0.0], [0.0])[0] for k, y in enumerate(readings)]
    t = H * np.arange(len(readings))
    _, exact, _ = lsim(([1, 0], [tau, 1]), readings - readings[0], t, interp=True)
    np.testing.assert_allclose(got, exact, rtol=0, atol=ROUNDING * np.abs(exact).max())


def test_a_target_that_jumps_gives_no_kick():
    """The output jumps by kp and by half a period of ki, whatever kd is."""
    def jump(kd: float) -> float:
        law = pid(3.0, 20.0, kd)
        law.begin([1.0], [1.0], [0.0])
        before = [law.act(k * H, [1.0], [1.0], [0.0])[0] for k in range(3)][-1]
        return law.act(3 * H, [1.0], [2.0], [before])[0] - before

    assert jump(0.0) == jump(50.0) == pytest.approx(3.0 + 20.0 * H / 2, abs=ROUNDING)


# --- the beginning


@pytest.mark.parametrize("bias", [None, 0.0, 100.0])
def test_a_loop_switched_on_again_continues_from_the_drive_value(bias):
    law = pid(4.0, 2.0, 1.0, bias=bias)
    law.begin([0.0], [1.0], [3.0])
    outputs = [law.act(k * H, [0.1 * k], [1.0], [0.0])[0] for k in range(9)]
    assert outputs[0] == (3.0 if bias is None else bias) + 4.0
    law.begin([2.0], [1.0], [-8.0])
    assert law.act(1.0, [2.0], [1.0], [-8.0])[0] == pytest.approx(-8.0, abs=ROUNDING * 100)
    # and then by the reading: no slope is kept from before, and an error counts from now on
    assert law.act(1.0 + H, [2.0], [1.0], [-8.0])[0] == pytest.approx(
        -8.0 - 2.0 * H, abs=ROUNDING * 100)


# --- windup: an error of +1 for n acts, then of -1, and an upper limit

UP, N = 1.0, 400
ERRORS = [1.0] * N + [-1.0] * 3000


def left(law: Pid, *, limit: float = UP) -> int:
    """How many acts after the error changed sign the output leaves its limit."""
    _, applied = fed(law, ERRORS, limits=(-1e9, limit))
    assert applied[N - 1] == limit
    return int(np.argmax(applied[N:] < limit))


def test_clamp_leaves_the_limit_as_soon_as_the_error_changes_sign():
    assert left(pid(0.3, 10.0, bias=0.0)) == 0


@pytest.mark.parametrize(("kp", "ki"), [(0.303, 10.0), (0.0, 9.3), (0.503, 5.0)])
def test_without_anti_windup_it_takes_as_long_as_the_integral_has_grown(kp, ki):
    """I = ki h (n-1) at its height and falls by ki h an act from the second on, until
    I - kp < limit: (ki h (n-1) - kp - limit) / (ki h) acts later.
    """
    over = (ki * H * (N - 1) - kp - UP) / (ki * H)
    assert left(pid(kp, ki, bias=0.0, anti_windup="none")) == math.floor(over) + 1
    assert over > 50


@pytest.mark.parametrize(("kp", "ki", "tracking"), [(0.3, 10.0, None), (0.3, 10.0, 0.01),
                                                    (0.3, 10.0, 1e-4), (0.0, 10.0, None)])
def test_back_calculation_settles_above_the_limit(kp, ki, tracking):
    """An act takes the share s = 1 - exp(-h/tracking) off the excess X and adds ki h:
    X -> ki h / s, by powers of 1 - s; with kp = 0, s = 1.
    """
    law = pid(kp, ki, bias=0.0, anti_windup="back_calculation", tracking=tracking)
    wanted, applied = fed(law, ERRORS[:N], limits=(-1e9, UP))
    excess = wanted - applied
    first = int(np.argmax(excess > 0))
    tau = tracking or kp / ki
    share = 1 - math.exp(-H / tau) if tau else 1.0
    end = ki * H / share
    exact = end + (excess[first] - end) * (1 - share) ** np.arange(N - first)
    np.testing.assert_allclose(excess[first:], exact, rtol=0, atol=ROUNDING)
    assert excess[-1] == pytest.approx(end, abs=1e-3)


def test_a_rate_limit_counts_as_a_cut():
    """Behind a ramp of 0.01 an act the integral waits; it moves once the output has caught up."""
    law = pid(1.0, 10.0, bias=0.0)
    wanted, applied = fed(law, [1.0] * 200, most=0.01)
    caught = int(np.argmax(wanted == applied))
    np.testing.assert_array_equal(wanted[:caught], 1.0)
    assert caught == 99
    # from then on by ki h an act, which the rate limit allows
    np.testing.assert_allclose(np.diff(wanted[caught:]), 10 * H, rtol=0, atol=ROUNDING)
