"""Springs with force laws, and rotary springs too stiff for the step."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.audit.audit import audit
from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import H, fixed, mechanism, sound

STEP = 1e-3


def oscillator(x: float, *, step: float = STEP, duration: float = 1.0, v: float = 0.0,
               g: float = 0.0, tables: Any = None, **spring: Any) -> dict[str, Any]:
    """A mass of 1 kg on a spring of 1 m, released at rest at a stretch ``x``."""
    ball = {"name": "m", "at": [1 + x, 0], "mass": 1, "velocity": [v, 0],
            "shapes": [{"type": "circle", "radius": 0.01}]}
    return {"bodies": [{"name": "frame", "motion": "fixed"}, ball], "gravity": [g, 0],
            "tables": tables or {},
            "springs": [{"type": "linear", "name": "s", "a": "frame", "b": "m", "rest_length": 1,
                         **spring}],
            "run": {"duration": duration, "step": step, "sample_rate": 1 / step}}


def run_of(scene: dict[str, Any]) -> Recording:
    return sound(sandbox.simulate(sandbox.load_scene(scene)))


@pytest.mark.parametrize("k", [100.0, 1e5, 2e6, 1e8])
@pytest.mark.parametrize("damping", [0.0, 3.0])
def test_a_straight_law_is_a_linear_spring(k: float, damping: float) -> None:
    """Soft, even, stiff and damped: the rows are the same, up to rounding of k and c in them."""
    plain = run_of(oscillator(0.1, stiffness=k, damping=damping, duration=0.2))
    own = run_of(oscillator(0.1, force=f"={k} * stretch + {damping} * rate", duration=0.2))
    mixed = run_of(oscillator(0.1, force=f"={k} * stretch", damping=damping, duration=0.2))
    for run in (own, mixed):
        assert np.abs(run["m.x"] - plain["m.x"]).max() < 1e-11
        assert np.abs(run["s.force"] - plain["s.force"]).max() < 1e-9 * k


@pytest.mark.parametrize("c", [0.0, 400.0])
def test_a_spring_of_four_to_six_steps_a_period_moves_by_the_closed_form(c: float) -> None:
    """The mean of three poses, weights 1, 2, 1: z + 1/z - 2 = -(x (z + 2 + 1/z) + d (z - 1/z)) / 4
    for x(n) = Re(A z^n), x = h^2 k / m, d = 2 h c / m; undamped |z| = 1, so no energy is lost."""
    k = 2e6
    run = run_of(oscillator(0.1, stiffness=k, damping=c, duration=0.05))
    x, d = STEP**2 * k, 2 * STEP * c
    z = np.roots([1 + (x + d) / 4, x / 2 - 2, 1 + (x - d) / 4])[0]
    at = run["m.x"] - 1
    later = z ** np.arange(len(at))
    fit = np.linalg.lstsq(np.c_[later.real, later.imag], at, rcond=None)[0]
    assert np.abs(at - np.c_[later.real, later.imag] @ fit).max() < 1e-9
    assert abs(z) == pytest.approx(1.0, abs=1e-12) or c


@pytest.mark.parametrize("law", ["expression", "cubic table"])
def test_work_is_the_laws_integral(law: str) -> None:
    """W = U(s0) - U(s), U = k1 s^2 / 2 + k3 s^4 / 4, to second order of the step."""
    k1, k3, x0 = 100.0, 2e4, 0.1
    text, points = f"={k1} * stretch + {k3} * stretch ** 3", np.linspace(-0.15, 0.15, 61)
    tables = {}
    if law == "cubic table":
        tables = {"law": {"points": [[x, k1 * x + k3 * x**3] for x in points.tolist()],
                          "between": "cubic"}}
        text = "=law(stretch)"
    worst = []
    for step in (1e-3, 5e-4):
        run = run_of(oscillator(x0, force=text, tables=tables, step=step))
        s = run["m.x"] - 1
        stored = k1 * s**2 / 2 + k3 * s**4 / 4
        first = k1 * x0**2 / 2 + k3 * x0**4 / 4
        worst.append(float(np.abs(run["s.work"] + stored - first).max() / first))
    assert worst[0] < 3e-4
    assert worst[0] / worst[1] == pytest.approx(4, rel=0.3)


@pytest.mark.parametrize("k", [1e3, 1e5, 1e7, 1e9, 1e12])
def test_a_bump_stop_of_any_stiffness_neither_pulls_nor_throws(k: float) -> None:
    """Soft it gives all back; the stiffer against the step the less, as stiff springs do."""
    run = run_of(oscillator(0.05, stiffness=k, only="push", v=-1.0, duration=0.2))
    assert run["s.force"].max() == 0.0
    assert run["m.x"].min() > 1 - max(math.sqrt(1 / k), STEP) * 1.01
    assert -1e-9 <= run["m.vx"][-1] <= 1.0 + 1e-6
    if k * STEP**2 < 1e-2:
        assert run["m.vx"][-1] == pytest.approx(1.0, abs=math.sqrt(k) * STEP)


def test_a_law_of_the_rate_is_a_damper_of_any_strength() -> None:
    """dv/dt = -c v^3: v = v0 / sqrt(1 + 2 c v0^2 t); a hard one is stable."""
    run = run_of(oscillator(0.0, force="=2 * rate ** 3", v=1.0, duration=1.0))
    t = run.time
    assert run["m.vx"] == pytest.approx(1 / np.sqrt(1 + 4 * t), rel=1e-4)
    hard = run_of(oscillator(0.0, force="=1e7 * rate ** 3", v=1.0, duration=0.1))
    assert np.all(np.abs(np.diff(np.abs(hard["m.vx"]))) <= 1.0)
    assert 0.0 <= hard["m.vx"][-1] < 1e-2


def test_check_looks_at_the_largest_slope_and_at_gaps() -> None:
    """3 k s^2 at a stretch of 1 m, the farthest that is tried."""
    for stretch, law, message in (
        (0.1, "=1e7 * stretch ** 3", "too stiff for the step"),
        (0.1, "=sqrt(stretch)", "its law has no value at a stretch of -0.000977"),
        (0.0, "=0.01 / stretch", "its law has no value at a stretch of 0"),  # a pole: one warning
    ):
        scene = sandbox.load_scene(oscillator(stretch, force=law))
        (found,) = inspect(sandbox.expand(scene))
        assert message in found.message


def test_a_law_without_a_value_ends_the_run() -> None:
    with pytest.raises(sandbox.SimulationDiverged):
        sandbox.simulate(sandbox.load_scene(oscillator(0.1, force="=100 * sqrt(stretch)")))


@pytest.mark.parametrize("text", [
    "sin(stretch) + cos(rate) - tan(stretch / 3)", "asin(stretch) * acos(rate / 9) + atan(rate)",
    "atan2(stretch, rate) / hypot(stretch, rate)",
    "sqrt(0.1 + abs(stretch)) * exp(-rate / 9) + log(9 + rate) + tanh(9 * rate)",
    "sign(stretch) * floor(3 * rate) + ceil(rate)",
    "min(stretch, rate, 0.1) + max(stretch, -rate) + clip(stretch, -0.2, 0.2) ** 3 % 0.05",
    "1 if -0.5 < stretch <= 0.1 < 1 else rate",
    "(stretch > rate) - (stretch >= rate) + (rate < 1) * pi + 2 ** stretch - -rate / 3 + e",
    "stretch if stretch > 0 and rate > 0 and not rate > 0.5 else 2 * rate",
    "rate * (floor(2 * stretch) == 0 or floor(2 * rate) != -1 or 0) + (not stretch > 2)",
    "f(stretch) + g(3 * rate) - f(-9) + h(stretch * 50)"])
def test_every_function_of_expressions_is_computed_as_the_audit_does(text: str) -> None:
    """Beside a spring of 100 N/m, so that stretch and rate pass through both signs."""
    points = [[-1, 0], [0.2, 3], [0.5, 1]]
    tables = {"f": {"points": points},
              "g": {"points": points, "between": "cubic", "beyond": "extend"},
              "h": {"points": [*points, [3, 0]], "between": "cubic", "beyond": "repeat"}}
    run = sandbox.simulate(sandbox.load_scene(oscillator(
        0.4, v=0.3, force=f"=100 * stretch + ({text})", tables=tables, duration=0.7)))
    assert {figure.name: figure.verdict for figure in audit(run)}["spring.law"] == "pass"
    assert np.ptp(run["s.force"]) > 10


@pytest.mark.parametrize("pace", [3.0, 30.0, 3e3])
def test_a_stiff_rotary_spring_decays_as_backward_euler_does(pace):
    """Of its amplitude 1 / sqrt(1 + (h w)^2) is left by a step; 10 are given it to get going."""
    inertia, m, d = 2e-6, 0.01, 0.03
    k = (inertia + m * d**2) * (pace / H) ** 2
    run = simulate(mechanism(
        duration=0.05, bodies=[fixed("ground"), {"name": "flap", "mass": m, "inertia": inertia,
                                                 "centre": (d, 0.0), "angle": 0.1}],
        joints=[{"type": "pin", "name": "hinge", "a": "ground", "b": "flap", "on_b": (0, 0)}],
        springs=[{"type": "rotary", "name": "s", "joint": "hinge", "stiffness": k}]))
    swing = np.abs(run["hinge.angle"])
    assert swing.max() < 0.11
    assert swing[40:].max() < 0.1 / math.hypot(1, pace) ** 30 + 1e-12
