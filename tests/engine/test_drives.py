"""Drives against closed forms: stiffness, brakes, motors, servos, actuators."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from sandbox.audit.audit import audit
from sandbox.engine.inspect import inspect
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording

from .machines import G, H, fixed, mass, mechanism

SENSES = pytest.mark.parametrize(("positive", "sense"), [("counterclockwise", 1),
                                                         ("clockwise", -1)])
ROUNDING = 1e-12


# -- stiffness ---------------------------------------------------------------------


WHEEL = {"name": "w", "mass": 0.1, "inertia": 4e-5}


def setting(value: Any) -> list[dict[str, Any]]:
    return [{"type": "stiffness", "name": "k", "spring": "s", "value": value}]


def test_force_of_a_spring_whose_stiffness_changes() -> None:
    """F = k(t) (l - l0) at every sample, k as the signal says; below 0 it counts as 0."""
    run = simulate(mechanism(
        duration=0.4, bodies=[fixed("wall"), mass("m", 0.1, (0.12, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "m", "stiffness": 40.0,
                  "rest_length": 0.1}], drives=setting({"from": 80.0, "to": -20.0, "over": 0.3})))
    k = np.clip(80 - 100 * run.time / 0.3, 0, None)
    np.testing.assert_allclose(run["k.value"], k, rtol=0, atol=1e-12)
    np.testing.assert_allclose(run["s.force"], k * (run["s.length"] - 0.1), rtol=0, atol=1e-14)
    assert (run["m.ax"][run.time > 0.25] == 0).all()


@SENSES
def test_torque_of_a_rotary_spring_whose_stiffness_changes(positive: str, sense: int) -> None:
    """tau = k(t) (angle - rest), against the hinge's own sense; I alpha = - tau."""
    run = simulate(mechanism(
        duration=0.4, bodies=[fixed("wall"), WHEEL],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0), "zero": 0.1,
                 "positive": positive}],
        springs=[{"type": "rotary", "name": "s", "joint": "p", "stiffness": 0.01,
                  "rest_angle": 0.2}], drives=setting("=0.02 + 0.015 * sin(40 * t)")))
    k = 0.02 + 0.015 * np.sin(40 * run.time)
    np.testing.assert_allclose(run["s.torque"], k * (run["p.angle"] - 0.2), rtol=0, atol=1e-14)
    np.testing.assert_allclose(4e-5 * sense * run["w.alpha"], -run["s.torque"], atol=1e-12)


# -- motors ------------------------------------------------------------------------


def motored(positive: str, **motor: Any) -> Recording:
    """A wheel on a hinge with a motor."""
    return simulate(mechanism(
        duration=0.5, bodies=[fixed("wall"), WHEEL],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0),
                 "positive": positive}],
        drives=[{"type": "motor", "name": "d", "joint": "p", **motor}]))


@SENSES
def test_a_free_motor_reaches_its_speed(positive: str, sense: int) -> None:
    """omega = tau t / I up to the speed, which it then keeps without torque."""
    run = motored(positive, value=20.0, torque=2e-3)
    ready = 20.0 * 4e-5 / 2e-3
    rate = np.minimum(run.time / ready, 1.0) * 20.0
    still = np.abs(run.time - ready) > H
    np.testing.assert_allclose(run["p.rate"][still], rate[still], rtol=1e-9)
    np.testing.assert_allclose(sense * run["w.omega"], run["p.rate"], rtol=ROUNDING)
    np.testing.assert_allclose(run["d.torque"][run.time < ready - H], 2e-3, rtol=ROUNDING)
    np.testing.assert_allclose(run["d.torque"][run.time > ready + H], 0.0, atol=1e-12)
    assert run["d.work"][-1] == pytest.approx(4e-5 * 20.0**2 / 2, rel=1e-9)
    assert run.unit("d.torque") == "N m"
    assert run.unit("d.value") == "rad/s"


@SENSES
@pytest.mark.parametrize(("value", "speed"), [
    ("=20 + 30 * t", lambda t: 20 + 30 * t),
    ("=20 + 4 * sin(9 * t)", lambda t: 20 + 4 * np.sin(9 * t))])
def test_a_motor_that_starts_at_speed_turns_from_the_end_of_the_first_step_on(
        positive: str, sense: int, value: str, speed: Any) -> None:
    """The first pose is that of the scene, so the angle lags by what the first half step lacks.

    A blow is no acceleration: led half a step back along it, the first pose would be h u / 8 off.
    Of what the signal changes by itself h^2 / 8 may be there.
    """
    run = motored(positive, value=value, torque=100.0)
    change = 36.0
    assert sense * run["w.angle"][0] == pytest.approx(0.0, abs=H**2 / 8 * change)
    turned = np.cumsum(H * speed(run.time + H / 2))[:-1]
    lead = run["p.angle"][1:] - turned - run["p.angle"][0]
    np.testing.assert_allclose(lead, 0.0, atol=1e-11)


# -- the machinery -----------------------------------------------------------------


@pytest.mark.parametrize(("value", "more"), [
    (40.0, {}), ({"to": 9e5, "over": 0.1}, {}), ({"table": [(0, 1.0), (0.1, 9e5)]}, {}),
    (40.0, {"controllers": [{"type": "schedule", "name": "c", "writes": "k", "value": 50.0,
                             "limits": (0.0, 9e5)}]}),
    (40.0, {"events": [{"name": "e", "at": 0.1, "set": {"k": 9e5}}]}),
])
def test_inspection_warns_of_a_stiffness_beyond_the_step(value: Any, more: Any) -> None:
    """h w = 5e-4 sqrt(9e5 / 0.1) = 1.5, a table's last point, a limit and an event included."""
    machine = mechanism(
        bodies=[fixed("wall"), mass("m", 0.1, (0.12, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "m", "stiffness": 40.0}],
        drives=setting(value), **more)
    warned = [f for f in inspect(machine) if f.element == "s"]
    plain = value == 40.0 and not more
    assert len(warned) == (0 if plain else 1)
    if not plain:
        assert (warned[0].code, "h w = 1.5" in warned[0].message) == ("stiff-step", True)


INERTIA, MAX_TORQUE = 4e-5, 2e-3


def servo_run(drive: dict[str, Any], *, step: float = 1e-3, duration: float = 0.5,
              **pin: Any) -> Recording:
    """A wheel on a hinge with a servo."""
    return simulate(mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), WHEEL],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0), **pin}],
        drives=[{"type": "servo", "name": "d", "joint": "p", **drive}]))


def slide(drive: dict[str, Any], *, step: float = 1e-3, duration: float = 0.5,
          velocity: tuple[float, float] = (0.0, 0.0), gravity: float = 0.0,
          **actuator: Any) -> Recording:
    """1 kg at the end of an actuator of 0.1 m, which turns freely about the origin."""
    return simulate(mechanism(
        duration=duration, step=step, gravity=(-gravity, 0.0),
        bodies=[fixed("wall"), mass("m", 1.0, (0.1, 0.0), velocity=velocity)],
        joints=[{"type": "actuator", "name": "c", "a": "wall", "b": "m", **actuator}],
        drives=[{"name": "d", "joint": "c", **drive}]))


def assert_audit_passes(run: Recording, *names: str) -> None:
    """Figures of its audit are computed and pass; none asks for a look."""
    found = {figure.name: figure for figure in audit(run)}
    assert [name for name, figure in found.items() if figure.verdict == "look"] == []
    assert [found[name].verdict for name in names] == ["pass"] * len(names)


# -- rigid ---------------------------------------------------------------------------


@SENSES
@pytest.mark.parametrize("step", [1e-3, 2.5e-4])
def test_a_rigid_servo_takes_the_least_time_and_does_not_overshoot(
        positive: str, sense: int, step: float) -> None:
    """Half the way with +T, half with -T: t = 2 sqrt(I q / T), to the step and 0.1 % of caution.

    It brakes in whole steps: what is left over of one carries it a h^2 / 8 too far at most.
    """
    run = servo_run({"value": 1.1, "torque": MAX_TORQUE}, step=step, positive=positive, zero=-0.1)
    accelerates = MAX_TORQUE / INERTIA
    least = 2 * math.sqrt(1.0 / accelerates)
    angle = run["p.angle"]
    assert angle[0] == pytest.approx(0.1, abs=1e-4)
    assert angle.max() < 1.1 + accelerates * step**2 / 8
    arrives = run.time[np.argmax(angle > 1.1 - 1e-4)]
    assert least - 3 * step - math.sqrt(2e-4 / accelerates) < arrives < 1.001 * least + step
    np.testing.assert_allclose(sense * run["w.omega"], run["p.rate"], rtol=ROUNDING, atol=1e-12)
    early, late = run.time < least / 2 - 2 * step, run.time > 1.05 * least
    np.testing.assert_allclose(run["d.torque"][early], MAX_TORQUE, rtol=ROUNDING)
    np.testing.assert_allclose(run["d.torque"][late], 0.0, atol=1e-9 * MAX_TORQUE)
    np.testing.assert_allclose(angle[late], 1.1, rtol=0, atol=1e-11)
    np.testing.assert_allclose(run["d.power"], run["d.torque"] * run["p.rate"], rtol=0, atol=0)
    assert_audit_passes(run, "drive.place", "work", "momentum.moment")


def test_a_servo_brakes_the_whole_arm_that_another_one_holds() -> None:
    """Shoulder and elbow of an arm, straight: it brakes with both in time, and does not overshoot.

    Were the elbow taken as free, the shoulder would feel less, and brake too late.
    """
    step, most, way = 1e-3, 0.02, 1.0
    about = INERTIA + 0.1 * 0.05**2 + INERTIA + 0.1 * 0.15**2
    links = [{"name": n, "mass": 0.1, "inertia": INERTIA, "at": (at, 0.0)}
             for n, at in (("upper", 0.05), ("fore", 0.15))]
    run = simulate(mechanism(
        duration=1.2, step=step, gravity=(0.0, 0.0), bodies=[fixed("wall"), *links], joints=[
            {"type": "pin", "name": "shoulder", "a": "wall", "b": "upper", "on_a": (0, 0)},
            {"type": "pin", "name": "elbow", "a": "upper", "b": "fore", "on_a": (0.05, 0)}],
        drives=[{"type": "servo", "name": "s", "joint": "shoulder", "value": way, "torque": most},
                {"type": "servo", "name": "e", "joint": "elbow", "value": 0.0, "torque": 10.0}]))
    angle, least = run["shoulder.angle"], 2 * math.sqrt(about * way / most)
    assert np.abs(run["elbow.angle"]).max() < 1e-9
    assert angle.max() < way + most / about * step**2 / 8
    np.testing.assert_allclose(angle[run.time > 1.05 * least], way, rtol=0, atol=1e-10)


def test_a_rigid_servo_follows_its_target() -> None:
    """With torque to spare the angle is the target's in every step, without lag."""
    run = servo_run({"value": "=0.3 * (1 - cos(9 * t))", "torque": 1.0})
    np.testing.assert_allclose(run["p.angle"][2:], 0.3 * (1 - np.cos(9 * run.time[2:])), rtol=0,
                               atol=1e-10)
    assert run["d.torque"][2:] == pytest.approx(
        INERTIA * 0.3 * 81 * np.cos(9 * run.time[2:]), abs=INERTIA * 0.3 * 9**4 * 1e-6 / 12 * 1.01)
    assert_audit_passes(run, "drive.place", "drive.signal")


# -- with a stiffness ------------------------------------------------------------------


def test_a_servo_of_four_steps_a_period_keeps_its_swing() -> None:
    """x(n) = Re(A z^n) with z + 1/z - 2 = -h^2 k / (4 I) (z + 2 + 1/z), so |z| = 1."""
    step, squared = 1e-3, 3.0
    run = servo_run({"value": 0.5, "torque": 1e3, "stiffness": squared * INERTIA / step**2},
                    step=step, duration=0.05)
    z = np.roots([1 + squared / 4, squared / 2 - 2, 1 + squared / 4])[0]
    later = (z ** np.arange(len(run))).view(float).reshape(-1, 2)
    swing = run["p.angle"] - 0.5
    assert np.abs(later @ np.linalg.lstsq(later, swing, rcond=None)[0] - swing).max() < 1e-9


def test_a_saturating_controller_is_that_of_an_ode() -> None:
    """I q'' = clip(k (u - q) - c q', T): second order.

    The torque has a kink where it leaves its limit, and no jump: of a step that it falls into what
    is missed is of second order, too. A leapfrog misses (w h)^2 / 12 of 0.5 rad at most.
    """
    k, c, most = 8 * MAX_TORQUE, 2e-4, 2 * MAX_TORQUE
    errors = []
    for step in (1e-3, 5e-4, 2.5e-4):
        run = servo_run({"value": 0.5, "torque": most, "stiffness": k, "damping": c}, step=step,
                        duration=0.3)

        def law(_t: float, y: Any) -> list[float]:
            return [y[1], min(max(k * (0.5 - y[0]) - c * y[1], -most), most) / INERTIA]

        truth = solve_ivp(law, (0.0, 0.3), [0.0, 0.0], rtol=1e-11, atol=1e-13, max_step=1e-3,
                          t_eval=run.time)
        errors.append(float(np.abs(run["p.angle"] - truth.y[0]).max()))
        assert np.abs(run["d.torque"]).max() == pytest.approx(most, rel=ROUNDING)
        assert_audit_passes(run, "drive.place", "work")
    w = math.sqrt(k / INERTIA)
    for step, error in zip((1e-3, 5e-4, 2.5e-4), errors, strict=True):
        assert error < 0.5 * (w * step)**2 / 12
    assert errors[0] / errors[2] > 10


# -- actuators ---------------------------------------------------------------------------


def test_a_push_acts_on_both_ends() -> None:
    """2 N between 1 kg and 3 kg: x = F t^2 / 2 m each, work F times the growth, no momentum.

    The first pose of a leapfrog lies half a step back: work counts F h^2 F / 8 m too much for that.
    """
    run = simulate(mechanism(
        duration=0.5, step=1e-3, gravity=(0.0, 0.0),
        bodies=[mass("a", 1.0, (0.0, 0.0)), mass("b", 3.0, (0.3, 0.4))],
        joints=[{"type": "actuator", "name": "c", "a": "a", "b": "b"}],
        drives=[{"type": "push", "name": "d", "joint": "c", "value": 2.0}]))
    grown = 2.0 * run.time**2 / 2 * (1 + 1 / 3)
    np.testing.assert_allclose(run["c.length"], 0.5 + grown, rtol=1e-13)
    np.testing.assert_allclose(run["c.speed"], 2.0 * run.time * 4 / 3, rtol=1e-11, atol=1e-14)
    np.testing.assert_allclose(run["d.work"], 2.0 * grown, rtol=1e-9,
                               atol=1.01 * 4.0 * (4 / 3) * 1e-6 / 8)
    np.testing.assert_allclose(run["d.power"], 2.0 * run["c.speed"], rtol=1e-14)
    np.testing.assert_allclose(run["a.vx"] + 3 * run["b.vx"], 0.0, atol=1e-14)
    np.testing.assert_allclose(run["b.vx"] / run["b.vy"], 0.75, rtol=1e-9)
    assert {run.unit(f"d.{name}") for name in ("value", "work", "power")} == {"N", "J", "W"}
    assert_audit_passes(run, "momentum.force", "energy.lost", "work")


@pytest.mark.parametrize("kind", ["extend", "length"])
def test_a_length_follows_its_signal_while_the_actuator_swings(kind: str) -> None:
    """L = 0.1 + 0.025 (1 - cos 8 t) with 0.5 m/s across it at t = 0: second order.

    Speeds are sums of h v at step's ends, the midpoint rule, 0.2 * 8 h^2 / 24 off for each second;
    how the line bends in a step is known to h^2 of v^2 / L^2: (5 h)^2 of 0.2 m/s at most. Told its
    length, it makes up for that in the next step, so that only a step's is left.
    """
    value = ("=0.2 * sin(8 * t)" if kind == "extend" else "=0.1 + 0.025 * (1 - cos(8 * t))")
    errors = []
    for step in (1e-3, 5e-4):
        run = slide({"type": kind, "value": value, "force": 1e4}, velocity=(0.0, 0.5), step=step)
        truth = 0.1 + 0.025 * (1 - np.cos(8 * run.time))
        errors.append(float(np.abs(run["c.length"] - truth).max()))
        allowed = 0.5 * (0.2 * 64 / 24 + 25 * 0.2) * step**2
        assert errors[-1] < (allowed if kind == "extend" else allowed * 50 * step)
        spin = run["m.x"] * run["m.vy"] - run["m.y"] * run["m.vx"]
        # the force is along the line, so that the spin about the origin stays
        np.testing.assert_allclose(spin, spin[0], rtol=0.05 * (step / 1e-3))
        assert_audit_passes(run, "work")
    assert 1.9 < math.log2(errors[0] / errors[1]) < 3.1


def test_a_rigid_length_goes_there_in_the_least_time() -> None:
    """2 sqrt(m L / F), as a servo; then it carries the weight."""
    run = slide({"type": "length", "value": 0.2, "force": 2.0}, longest=0.3, shortest=0.05,
                duration=0.8)
    least = 2 * math.sqrt(0.1 / 2.0)
    assert run["c.length"].max() < 0.2 + 2.0 * 1e-6 / 8
    assert run.time[np.argmax(run["c.length"] > 0.2 - 1e-5)] == pytest.approx(least, abs=8e-3)
    run = slide({"type": "length", "value": 0.2, "force": 20.0, "speed": 0.3}, gravity=G)
    assert run["c.length"].max() < 0.2 + 1e-6
    assert run["c.speed"].max() == pytest.approx(0.3, rel=1e-9)
    assert run["d.force"][-1] == pytest.approx(G, rel=1e-9)
    assert_audit_passes(run, "drive.place")


def test_ends_of_stroke_are_hard() -> None:
    """The drive pushes on; the reaction of the end of stroke equals its force."""
    run = slide({"type": "push", "value": 2.0}, longest=0.15)
    assert run["c.length"].max() < 0.15 + 1e-9
    assert run["c.reaction_x"][-1] == pytest.approx(-2.0, rel=1e-9)
    run = slide({"type": "extend", "value": -0.1, "force": 3.0}, shortest=0.08)
    assert run["c.length"].min() > 0.08 - 1e-9
    assert run["d.force"][-1] == pytest.approx(-3.0, rel=1e-12)


def test_a_rigid_servo_that_is_engaged_follows_its_target() -> None:
    """Its target went on meanwhile, as its wheel did: there is nothing to catch up with."""
    run = simulate(mechanism(
        duration=0.4, bodies=[fixed("wall"), {"name": "w", "mass": 1.0, "inertia": 0.01,
                                              "angular_velocity": 2.0}],
        joints=[{"type": "pin", "name": "p", "a": "wall", "b": "w", "on_a": (0, 0)}],
        drives=[{"type": "servo", "name": "d", "joint": "p", "value": "=2 * t", "torque": 0.05}],
        events=[{"name": "go", "at": 0.1, "release": ["p"]},
                {"name": "back", "at": 0.3, "take_up": ["p"]}]))
    assert run["p.held"].min() == 0
    # its target is a step's mean rate behind at first: rounding of angles over a step
    assert np.abs(run["d.torque"]).max() < 1e-6
    assert run["p.rate"] == pytest.approx(2.0, abs=1e-9)
