"""What controllers lead to what, read off a recording."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from sandbox.samples import targets
from sandbox.samples.outcome import Happened
from tests.samples.controlled import STIFFNESS, TARGETS, recording, scene, second_order

ANGLES = [f"finger.{joint}.angle" for joint in ("mcp", "pip", "dip")]


def loop(**changes: object) -> dict[str, object]:
    return {"type": "pid", "name": "loop", "writes": "pull", "reads": "finger.tendon.shortening",
            "target": 0.003, "kp": 1.0, **changes}


def test_targets_of_controllers() -> None:
    run = recording()
    found = targets.targets(run)
    assert list(found) == ANGLES
    for name, goal in zip(ANGLES, TARGETS, strict=True):
        assert found[name] == pytest.approx(np.full(len(run), goal))
    assert targets.tracked(run) == ANGLES
    assert targets.controlled(run) == ["k1", "k2", "k3"]


def test_meters_hold_targets_where_nothing_leads() -> None:
    meters = [{"name": "finger.mcp.angle.target", "value": "=0.3 * t", "unit": "rad"},
              {"name": "nothing.target", "value": "=1"}]
    run = recording(scene(controllers=[loop()], meters=meters))
    found = targets.targets(run)
    assert set(found) == {"finger.tendon.shortening", "finger.mcp.angle"}
    assert found["finger.mcp.angle"] == pytest.approx(0.3 * run.time)
    assert targets.tracked(run) == ["finger.tendon.shortening"]
    # a controller's target counts more, one by hand most
    run = recording(scene(meters=meters))
    assert targets.targets(run)["finger.mcp.angle"][0] == pytest.approx(TARGETS[0])
    given = targets.targets(run, {"finger.mcp.angle": 0.5, "no.such": 1})
    assert given["finger.mcp.angle"][0] == 0.5
    assert "no.such" not in targets.targets(run, {"no.such": 1.0})


@pytest.mark.parametrize(("lasts", "after"), [(None, 0.001), (0.5, 0.003)])
def test_events_change_targets(lasts: float | None, after: float) -> None:
    event = {"name": "less", "at": 1.0, "set": {"loop.target": 0.001},
             **({"lasts": lasts} if lasts else {})}
    told = {"events": (Happened("less", 1.0), Happened("gone", 2.0))}
    run = recording(scene(controllers=[loop()], events=[event]), info=told)
    goal = targets.targets(run)["finger.tendon.shortening"]
    assert goal[np.searchsorted(run.time, 0.999)] == 0.003
    assert goal[np.searchsorted(run.time, 1.001)] == 0.001
    assert goal[-1] == after
    # an event that did not happen changes nothing
    run = recording(scene(controllers=[loop()], events=[event]))
    assert np.ptp(targets.targets(run)["finger.tendon.shortening"]) == 0


def test_where_things_start() -> None:
    run = recording()
    assert [targets.start(run, name) for name in ANGLES] == pytest.approx([0, 0, 0])
    assert targets.start(run, "finger.tendon.shortening") == 0
    assert targets.start(run, "k2.value") == STIFFNESS[1]
    assert targets.start(run, "pull.value") == targets.initial(run, "pull") == 15
    assert targets.start(run, "finger.distal.x") == pytest.approx(0.071)
    assert targets.start(run, "finger.tendon.tension") is None
    assert targets.start(run, "finger.mcp.rate") is None


def test_a_step_is_counted_from_its_beginning() -> None:
    """A response so quick that the first sample is already half way."""
    run = recording(omega=2000, zeta=0.5)
    assert run["finger.mcp.angle"][0] > 0.3 * TARGETS[0]
    found = targets.response(run, "finger.mcp.angle", targets.targets(run)["finger.mcp.angle"])
    assert found.start == pytest.approx(0)
    highest = run["finger.mcp.angle"].max() / TARGETS[0]
    assert found.overshoot == pytest.approx(100 * (highest - 1))


# --- step responses


DT = 1e-3
T = np.arange(0, 3, DT)
ONE = np.ones_like(T)


@pytest.mark.parametrize(("tau", "first", "last"), [(0.05, 0.0, 1.0), (0.5, 0.0, -0.3)])
def test_first_order(tau: float, first: float, last: float) -> None:
    value = last + (first - last) * np.exp(-T / tau)
    found = targets.respond(T, value, last * ONE)
    # e'' / e' = 1 / tau: linear interpolation is off by at most dt^2 / (8 tau)
    assert found.settling == pytest.approx(tau * math.log(50), abs=DT**2 / (8 * tau) + 1e-12)
    assert found.overshoot == 0
    # trapezoids: dt^2 / 12 times the change of e'
    area = abs(last - first) * tau * (1 - math.exp(-T[-1] / tau))
    assert found.iae == pytest.approx(area, abs=abs(last - first) * DT**2 / (12 * tau) + 1e-12)
    assert found.start == first
    assert abs(found.steady_error) < 2 * math.exp(-0.95 * T[-1] / tau)


@pytest.mark.parametrize("zeta", [0.15, 0.7])
@pytest.mark.parametrize("omega", [12.0, 20.0])
def test_second_order(zeta: float, omega: float) -> None:
    goal = 0.25
    value = goal * second_order(T, zeta, omega)
    damped = omega * math.sqrt(1 - zeta**2)
    peak = 100 * math.exp(-math.pi * zeta / math.sqrt(1 - zeta**2))
    # the highest sample lies within dt / 2 of the peak, where |y''| <= omega^2
    assert targets.respond(T, value, goal * ONE).overshoot == pytest.approx(
        peak, abs=100 * (omega * DT)**2 / 8)

    # the last extremum beyond 2 %, then the crossing before the next one
    n = math.floor(-math.log(0.02) * damped / (zeta * omega * math.pi))
    a, b = n * math.pi / damped, (n + 1) * math.pi / damped
    exact = brentq(lambda t: abs(second_order(t, zeta, omega) - 1) - 0.02, a, b)
    found = targets.settling_time(T, value, goal * ONE)
    assert found == pytest.approx(exact, abs=DT)
    assert found <= -math.log(0.02 * math.sqrt(1 - zeta**2)) / (zeta * omega)


def test_what_does_not_settle() -> None:
    assert targets.settling_time(T, 0.97 * ONE, ONE) == math.inf
    late = np.where(np.arange(len(T)) >= 0.96 * len(T), 1.0, 0.9)
    assert targets.settling_time(T, late, ONE) == math.inf
    leaves = np.where(T > 2.9, 1.03, 1.0)
    assert targets.settling_time(T, leaves, ONE) == math.inf
    lost = ONE.copy()
    lost[-1] = math.nan
    assert targets.settling_time(T, lost, ONE) == math.inf
    assert math.isinf(targets.respond(T, late, ONE).settling)


def test_a_moving_target() -> None:
    """The band goes with it: what lags behind a ramp by 0.05 / s is in it once the ramp ends."""
    target = np.clip(T, 0, 1)
    value = np.clip(T - 0.05, 0, 1)
    # the lag of 0.05 shrinks to 0.02 at t = 1.03, exactly linearly
    assert targets.settling_time(T, value, target) == pytest.approx(1.03, abs=1e-9)


def test_effort_of_a_sine() -> None:
    amplitude, omega = 3.0, 2 * math.pi
    t = np.arange(0, 1 + DT / 2, DT)
    found = targets.effort(t, 5 + amplitude * np.sin(omega * t), before=5.0)
    # four quarters up and down; the extrema lie on samples
    assert found.variation == pytest.approx(4 * amplitude, rel=1e-9)
    assert found.peak == pytest.approx(8, rel=1e-9)
    assert found.rate == pytest.approx(amplitude * omega, rel=(omega * DT)**2 / 6)
