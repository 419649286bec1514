"""Motors whose torque is on a line over speed, against closed forms; steps of second order."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene

from .machines import fixed, mechanism

STALL, NO_LOAD, INERTIA = 0.2, 50.0, 1e-3
TAU = INERTIA * NO_LOAD / STALL
"""I w0 / Ts, a quarter of a second."""


def motor(*, step: float = 1e-3, duration: float = 0.5, omega: float = 0.0, load: Any = None,
          positive: str = "counterclockwise", **more: Any) -> Recording:
    drives = [{"type": "motor", "name": "m", "joint": "p", "stall": STALL, "no_load": NO_LOAD,
               **more}]
    if load is not None:
        drives.append({"type": "torque", "name": "load", "joint": "p", "value": load})
    sense = 1.0 if positive == "counterclockwise" else -1.0
    run = simulate(mechanism(
        duration=duration, step=step, drives=drives, bodies=[
            fixed("wall"), {"name": "w", "mass": 1.0, "inertia": INERTIA,
                            "angular_velocity": sense * omega}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0),
                 "positive": positive}]))
    assert {f.name: f.why for f in audit(run) if f.verdict == "look"} == {}
    return run


@pytest.mark.parametrize(("value", "omega", "torque"), [
    (50.0, 20.0, 0.12),    # drives forwards
    (50.0, 80.0, -0.12),   # beyond its speed: brakes, and takes power in
    (50.0, -25.0, 0.3),    # turned against its sense: brakes with more than stall
    (-50.0, -20.0, -0.12), (-50.0, -80.0, 0.12), (-50.0, 25.0, -0.3),
    (25.0, 0.0, 0.1), (0.0, 50.0, -0.2)])  # half the voltage; none: it brakes itself
def test_all_quadrants(value: float, omega: float, torque: float) -> None:
    """T = Ts (u - w) / w0 whatever the signs; of the first sample, h / 2 after the start."""
    run = motor(value=value, omega=omega, duration=0.02)
    assert run["m.torque"][0] == pytest.approx(torque, rel=5e-3)  # h / 2 tau = 2e-3 of (u - w)
    power = run["m.torque"] * run["p.rate"]
    if omega:
        assert np.sign(power[0]) == np.sign(torque * omega)
    assert run["m.work"][-1] == pytest.approx(
        INERTIA / 2 * (run["w.omega"][-1] ** 2 - omega**2), rel=1e-3, abs=1e-5)


def test_a_limit_cuts_the_line_off() -> None:
    """Half the stall torque to half the speed, w = t Ts / 2 I, then the exponential.

    Mid-step is off by w0 / 2 (h / tau)^2 / 12 e, the step in which the bound is left by the change
    of torque in it, w0 / 2 (h / tau)^2 / 8: second order.
    """
    knee = INERTIA * NO_LOAD / STALL
    for step in (4e-3, 2e-3, 1e-3):
        run = motor(step=step, torque=STALL / 2)
        late = np.maximum(run.time - knee, 0.0)
        truth = np.where(run.time < knee, run.time * STALL / 2 / INERTIA,
                         NO_LOAD * (1 - 0.5 * np.exp(-late / TAU)))
        assert np.abs(run["p.rate"] - truth).max() < NO_LOAD * (step / TAU)**2 / 12
        assert run["m.torque"].max() == pytest.approx(STALL / 2, rel=1e-12)


def test_a_load_stalls_it() -> None:
    """Against a torque T it comes to w0 (1 - T / Ts); a line as steep as a wall is held."""
    run = motor(load=-0.05, duration=3.0)
    assert run["p.rate"][-1] == pytest.approx(NO_LOAD * 0.75, rel=1e-5)  # exp(-12)
    stiff = motor(stall=1e4, no_load=1.0, value=0.5, duration=0.01, omega=0.5)
    assert stiff["p.rate"] == pytest.approx(np.full(len(stiff), 0.5), abs=1e-12)


@pytest.mark.parametrize(("fields", "says"), [
    ({"stall": 1.0}, "'no_load' is missing"), ({"no_load": 1.0}, "'stall' is missing"),
    ({"value": 1.0}, "'torque'"), ({"torque": 1.0}, "'value'"),
    ({"stall": -1.0, "no_load": 1.0}, "0"), ({"stall": 1.0, "no_load": 0.0}, "0")])
def test_what_makes_no_sense_is_said(fields: dict[str, Any], says: str) -> None:
    scene = {"format": 1, "bodies": [{"name": "wall", "motion": "fixed"},
                                     {"name": "b", "mass": 1.0, "inertia": 1.0}],
             "joints": [{"type": "pin", "name": "p", "a": "wall", "b": "b", "on_a": [0, 0]}],
             "drives": [{"type": "motor", "name": "m", "joint": "p", **fields}],
             "run": {"duration": 0.1}}
    with pytest.raises(SceneError) as caught:
        load_scene(scene)
    problem, = caught.value.problems
    assert problem.path.startswith("$.drives[0]")
    assert says in f"{problem.message} {problem.allowed}"
