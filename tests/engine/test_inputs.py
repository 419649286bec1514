"""Drives and scheduled bodies are what their signals say, at the instants that count."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.inputs import CHUNK
from sandbox.engine.inspect_control import Checked
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.recording.recording import Recording

from .machines import H, disc, fixed, mass, mechanism

LONG = (CHUNK + 500) * H
"""[s] reaches well into the second chunk."""


def driven(value: Any, duration: float = LONG) -> Recording:
    return simulate(Checked(mechanism(
        duration=duration, bodies=[mass("m", 0.5, (0.0, 0.0))],
        drives=[{"type": "force", "name": "f", "body": "m", "direction": (1, 0), "value": value}])))


@pytest.mark.parametrize(("signal", "formula"), [
    ({"from": 1.0, "to": 3.0, "start": 1.0, "over": 1.5},
     lambda t: 1 + 2 * np.clip((t - 1.0) / 1.5, 0, 1)),
    ({"table": [(0.0, 1.0), (1.9, 4.0), (2.2, -1.0)]},
     lambda t: np.interp(t, [0, 1.9, 2.2], [1, 4, -1])),
    ({"table": [(0.0, 1.0), (2.0481, 2.0)], "between": "step"},
     lambda t: np.where(t >= 2.0481, 2.0, 1.0)),
    ("=2 * sin(3 * t) + 0.1 * t", lambda t: 2 * np.sin(3 * t) + 0.1 * t),
    (0.7, lambda t: np.full_like(t, 0.7)),
], ids=["ramp", "table", "steps", "expression", "constant"])
def test_drive_values_across_the_border(signal: Any, formula: Any) -> None:
    """Value and motion at t = (k - 1/2) h, beyond the chunk of steps sampled first.

    a = F / m at the same instant: the velocities differ by F h / m, rounding over h.
    """
    run = driven(signal)
    expected = formula(run.time)
    np.testing.assert_allclose(run["f.value"], expected, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(run["m.ax"], expected / 0.5, rtol=1e-6, atol=1e-9)


PATH = {"x": {"expression": "=0.1 * sin(7 * t)"}, "y": {"from": 0.0, "to": 0.2, "over": 2.0},
        "angle": {"expression": "=3 * t ** 2"}}


def test_a_scheduled_body_moves_along_its_path() -> None:
    """Central differences of the path: v + h^2 / 6 v'', a + h^2 / 12 a''; not h / 2 or h late.

    Of 0.1 sin(7 t): 34 m/s^3 * h^2 / 6 = 1.4e-6 m/s, 240 m/s^4 * h^2 / 12 = 5e-6 m/s^2, where a lag
    of h / 2 would be 1.2e-3 m/s. The first step begins at rest at t = 0; the last one's end is
    beyond the run, where the velocity goes on as before: h^2 / 2 v'' and h a'' more. Poses are
    sums of h v with v = difference / h: 4600 roundings of 1e-16 m.
    """
    run = simulate(mechanism(
        duration=LONG, bodies=[{"name": "b", "motion": "scheduled", "path": PATH}]))
    np.testing.assert_allclose(run["b.x"], 0.1 * np.sin(7 * run.time), atol=1e-12)
    np.testing.assert_allclose(run["b.y"], 0.1 * run.time.clip(0, 2), atol=1e-12)
    np.testing.assert_allclose(run["b.angle"], 3 * run.time**2, atol=1e-10)
    t = run.time[1:]
    np.testing.assert_allclose(run["b.vx"][1:-1], 0.7 * np.cos(7 * t[:-1]), atol=2e-6)
    np.testing.assert_allclose(run["b.omega"][1:], 6 * t, atol=1e-8)
    np.testing.assert_allclose(run["b.ax"][1:-1], -4.9 * np.sin(7 * t[:-1]), atol=1e-5)
    np.testing.assert_allclose(run["b.alpha"][1:-1], 6.0, atol=1e-6)
    assert run["b.vx"][-1] == pytest.approx(0.7 * np.cos(7 * t[-1]), abs=34 * H**2)
    np.testing.assert_allclose(run["b.ax"][-1], -4.9 * np.sin(7 * t[-1]), atol=5 * 34 * H)


@pytest.mark.parametrize("motion", ["fixed", "dynamic"])
def test_radius_drive_moves_the_surface(motion: str) -> None:
    """A disc that swells from 10 to 30 mm pushes another, 38 mm away, which then flies on.

    Its surface moves at 0.1 m/s, which the other one takes over, a step's growth behind: gaps are
    those of the pose. pymunk keeps the bounds of fixed shapes; beyond the first 10 mm they must
    have been renewed.
    """
    heavy = {"motion": "fixed"} if motion == "fixed" else {"mass": 1e5}
    run = simulate(mechanism(
        duration=0.3,
        bodies=[disc("big", 0.01, (0.0, 0.0), **heavy), disc("b", 0.01, (0.038, 0.0))],
        drives=[{"type": "radius", "name": "r", "body": "big",
                 "value": {"from": 0.01, "to": 0.03, "over": 0.2}}]))
    assert run["r.value"][-1] == pytest.approx(0.03)
    apart = run["b.x"] - run["big.x"]
    pushed = (run.time > 0.181) & (run.time < 0.199)
    np.testing.assert_allclose(apart[pushed], 0.01 + run["r.value"][pushed], atol=0.101 * H)
    assert apart[-1] == pytest.approx(0.04 + 0.1 * (run.time[-1] - 0.2), abs=0.101 * H)
    first = run.arrays["contact_sample"].min()
    # touched when the radius is 28 mm, at t = 0.18 s
    assert run.time[first] == pytest.approx(0.18, abs=2 * H)


def test_an_input_that_cannot_be_computed() -> None:
    """A scene error that names the drive, whenever it happens."""
    with pytest.raises(SceneError, match="drive f"):
        driven("=sqrt(1 - t)")
    with pytest.raises(SceneError, match="drive f"):
        driven("=sqrt(2.2 - t)")  # in the second chunk


def test_paths_are_evaluated_up_to_the_end_of_the_run() -> None:
    """sqrt(T - t) is fine up to T = the duration."""
    run = simulate(mechanism(duration=0.05, bodies=[
        {"name": "b", "motion": "scheduled", "path": {"x": {"expression": "=sqrt(0.05 - t)"}}},
        fixed("wall")]))
    assert run["b.x"][-1] == pytest.approx(np.sqrt(H / 2), rel=1e-6)
