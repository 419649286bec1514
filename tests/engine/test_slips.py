"""Cords that guides hold by friction, and loops, against closed forms (Euler, Eytelwein)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, fixed, mass, mechanism

H = 5e-4
STIFF = 1e6


def guide(body: str, at: tuple[float, float] = (0.0, 0.0), radius: float = 0.0,
          side: str = "left", friction: float = 0.0) -> dict[str, Any]:
    return {"body": body, "at": at, "radius": radius, "side": side, "friction": friction}


def sound(run: Recording) -> Recording:
    """A run whose audit finds nothing; slack is no fault here."""
    wrong = {f.name: f.why for f in audit(run) if f.verdict == "look" and f.name != "tendon.slack"}
    assert wrong == {}
    return run


def pin(name: str, body: str, at: tuple[float, float], **more: Any) -> dict[str, Any]:
    return {"type": "pin", "name": name, "a": "ground", "b": body, "on_a": at, "on_b": (0, 0),
            **more}


def heavy_pulley(stiffness: float, friction: float) -> Mechanism:
    """1 kg and 2 kg over a free disc of 2 kg, already tight."""
    r = 0.05
    return mechanism(
        duration=0.4, gravity=(0.0, -G), step=H, bodies=[
            fixed("ground"), {"name": "wheel", "mass": 2.0, "inertia": 2.0 * r**2 / 2},
            mass("one", 1.0, (-r, -0.5)), mass("two", 2.0, (r, -0.5))],
        joints=[pin("axle", "wheel", (0.0, 0.0))],
        tendons=[{"name": "rope", "stiffness": stiffness, "pretension": 12.0, "damping": 200.0,
                  "guides": [guide("one"), guide("wheel", (0, 0), r, "right", friction),
                             guide("two")]}])


def test_a_heavy_pulley_is_turned_by_its_rope() -> None:
    """a = g (m2 - m1) / (m1 + m2 + I / r^2), exact but for the rope's stretch at the start."""
    run = sound(simulate(heavy_pulley(STIFF, 0.5)))
    a = G / 4
    strain = 2e-5  # T / EA, which goes from one side to the other with the rope
    assert run["two.ay"][-100:] == pytest.approx(np.full(100, -a), rel=strain)
    assert run["rope.tension"][-1] == run["rope.tension_1"][-1]
    assert run["rope.tension_1"][-1] == pytest.approx(2 * (G - a), rel=strain)
    assert run["rope.tension_0"][-1] == pytest.approx(G + a, rel=strain)
    assert run["wheel.omega"][-1] * 0.05 == pytest.approx(run["two.vy"][-1], rel=1e-3)
    assert np.abs(run["rope.slip_1"]).max() < 1e-12


def test_a_rope_that_cannot_hold_its_pulley_slides_at_eulers_ratio() -> None:
    """mu pi = 0.157: T2 / T1 = e^0.157 turns the wheel by less than the weights fall."""
    mu = 0.05
    run = sound(simulate(heavy_pulley(STIFF, mu)))
    ratio = run["rope.tension_1"][-50:] / run["rope.tension_0"][-50:]
    assert ratio == pytest.approx(np.full(50, math.exp(mu * math.pi)), rel=1e-12)
    e = math.exp(mu * math.pi)  # T1 = G + a, T2 = 2 (G - a)
    a = (2 * G - e * G) / (e + 2)
    assert run["two.ay"][-1] == pytest.approx(-a, rel=1e-6)
    turning = (run["rope.tension_1"][-1] - run["rope.tension_0"][-1]) * 0.05 / (2.0 * 0.05**2 / 2)
    assert abs(run["wheel.alpha"][-1]) == pytest.approx(turning, rel=1e-6)
    assert run["rope.slip_1"][-1] > 0.01


@pytest.mark.parametrize("step", [1e-3, 5e-4, 2.5e-4])
def test_a_capstan_lets_go_at_eulers_tension(step: float) -> None:
    """Pulled by 40 N/s more than its weight 1 kg first moves at T = m g e^(mu phi)."""
    phi, mu, ramp = math.pi / 2, 0.3, 40.0
    run = sound(simulate(mechanism(
        duration=0.5, step=step, gravity=(0.0, -G),
        bodies=[fixed("ground"), mass("load", 1.0, (0.05, -1.0))],
        tendons=[{"name": "rope", "stiffness": 1e7, "pretension": G, "guides": [
            guide("load"), guide("ground", (0, 0), 0.05, "left", mu),
            guide("ground", (-1, 0.05))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "rope", "value": f"={G} + {ramp} * t"}],
    )))
    e = math.exp(mu * phi)
    begins = G * (e - 1) / ramp
    t = np.maximum(run.time, begins)
    speed = (ramp * (t**2 - begins**2) / 2 + G * (t - begins)) / e - G * (t - begins)
    # the first slip falls within a step of its instant, and the acceleration begins at 0
    assert run["load.vy"] == pytest.approx(speed, abs=ramp * step**2)
    ratio = run["rope.tension_1"] / run["rope.tension_0"]
    assert ratio[run.time > begins + 0.01] == pytest.approx(e, rel=1e-12)
    friction = run.arrays["guide_friction"][:, 0]
    lost = float(np.sum(friction * np.diff(run["rope.slip_1"], prepend=0.0)))
    # by the rule of the middle to O(h)
    assert run["pull.work"][-1] - run["rope.work"][-1] == pytest.approx(lost, rel=0.02)


def test_whole_turns_count() -> None:
    """A load of 100 kg, three turns and a half round a bar, is held by m g e^(-mu phi)."""
    mu, r = 0.2, 0.05
    phi = 7 * math.pi
    hand = 100 * G * math.exp(-mu * phi)
    for share, slides in ((1.01, False), (0.99, True)):
        run = sound(simulate(mechanism(
            duration=0.3, step=H, gravity=(0.0, -G),
            bodies=[fixed("ground"), mass("load", 100.0, (r, -1.0))],
            tendons=[{"name": "rope", "stiffness": STIFF, "damping": 5e3, "pretension": 100 * G,
                      "guides": [guide("load"), guide("ground", (0, 0), r, "left", mu) | {
                          "turns": 3}, guide("ground", (-r, -1))]}],
            drives=[{"type": "pull", "name": "pull", "tendon": "rope", "value": share * hand}])))
        assert run["rope.length"][0] == pytest.approx(2.0 + phi * r, rel=1e-6)
        assert (abs(float(run["load.vy"][-1])) > 1e-4) is slides
        if slides:
            ratio = run["rope.tension_0"][-1] / run["rope.tension_1"][-1]
            assert ratio == pytest.approx(math.exp(mu * phi), rel=1e-9)


def belt(crossed: bool, stiffness: float, torque: str, damping: float = 0.0) -> Mechanism:
    r1, r2, apart = 0.05, 0.1, 0.3
    return mechanism(
        duration=0.3, step=H, bodies=[
            fixed("ground"), {"name": "small", "mass": 1.0, "inertia": 1e-3},
            {"name": "large", "mass": 1.0, "inertia": 1e6, "at": (apart, 0.0)}],
        joints=[pin("one", "small", (0.0, 0.0)), pin("two", "large", (apart, 0.0))],
        tendons=[{"name": "belt", "closed": True, "stiffness": stiffness, "pretension": 50.0,
                  "damping": damping, "guides": [
                      guide("small", (0, 0), r1, "left", 0.3),
                      guide("large", (0, 0), r2, "right" if crossed else "left", 0.3)]}],
        drives=[{"type": "torque", "name": "drive", "joint": "one", "value": torque}])


@pytest.mark.parametrize("crossed", [False, True])
@pytest.mark.parametrize(("stiffness", "damping"), [(1e5, 0.0), (2e4, 20.0)])
def test_a_belt_slips_at_twice_its_pretension(crossed: bool, stiffness: float,
                                              damping: float) -> None:
    """M = 2 T0 tanh(mu phi / 2) r on the small wheel; the sum of both tensions stays 2 T0."""
    run = sound(simulate(belt(crossed, stiffness, "=10 * t", damping)))
    half = math.asin((0.1 + 0.05) / 0.3) if crossed else -math.asin((0.1 - 0.05) / 0.3)
    phi = math.pi + 2 * half
    most = 2 * 50.0 * math.tanh(0.3 * phi / 2)
    assert run["belt.tension_0"][-1] - run["belt.tension_1"][-1] == pytest.approx(
        -most, rel=5e-3)  # of soft belts the sum of both tensions is no longer 2 T0
    begins = int(np.argmax(np.abs(run["belt.slip_0"]) > 1e-5))
    # what turns the small wheel on as the belt stretches is not there for the belt
    given = 10 * run.time[begins] - 1e-3 * run["small.alpha"][begins]
    assert given == pytest.approx(most * 0.05, rel=5e-3)
    if not crossed:  # then both wheels are held alike, and both slide
        assert np.abs(run["belt.slip_1"]).max() < 1e-9
    straight = 2 * math.sqrt(0.3**2 - (0.05 + (0.1 if crossed else -0.1))**2)
    arcs = 0.05 * phi + 0.1 * (phi if crossed else 2 * math.pi - phi)
    assert run["belt.length"] == pytest.approx(straight + arcs, rel=1e-12)


def test_a_loop_without_friction_has_one_tension() -> None:
    run = sound(simulate(mechanism(
        duration=0.05, step=H, bodies=[fixed("ground"), mass("one", 1.0, (0.4, 0.0))],
        tendons=[{"name": "loop", "closed": True, "stiffness": 1e3, "pretension": 10.0, "guides": [
            guide("ground", (0, 0), 0.05), guide("one", (0, 0), 0.05)]}])))
    assert run["loop.length"][0] == pytest.approx(0.8 + 0.1 * math.pi, rel=1e-5)
    assert run["one.ax"][0] == pytest.approx(-20.0, rel=2e-4)  # it has moved by 20 (h / 2)^2 / 2


def test_one_guide_alone_does_not_hold_a_loop() -> None:
    """What goes round a single wheel with friction drags on nothing: it is as without."""
    def loop(friction: float) -> Mechanism:
        return mechanism(
            duration=0.05, step=H, bodies=[fixed("ground"), mass("one", 1.0, (0.4, 0.0))],
            tendons=[{"name": "loop", "closed": True, "stiffness": 1e4, "pretension": 10.0,
                      "guides": [guide("ground", (0, 0), 0.05),
                                 guide("one", (0, 0), 0.05, "left", friction)]}])
    held, free = (simulate(loop(mu)) for mu in (0.5, 0.0))
    assert np.array_equal(held["one.x"], free["one.x"])


def test_friction_along_a_sheath_multiplies() -> None:
    """Eyes that bend a cord by 30, 45 and 60 degrees: e^(-mu sum phi) of the pull arrives."""
    mu, angle = 0.2, 0.0
    points = [(0.0, 0.0)]
    for turn in (0.0, 30.0, 45.0, 60.0):
        angle += math.radians(turn)
        x, y = points[-1]
        points.append((x + 0.1 * math.cos(angle), y + 0.1 * math.sin(angle)))
    run = sound(simulate(mechanism(
        duration=0.2, step=H, bodies=[fixed("ground"), mass("tip", 0.1, points[0])],
        joints=[{"type": "slot", "name": "rail", "a": "ground", "b": "tip", "start": (-0.1, 0.0),
                 "end": (0.05, 0.0), "on_b": (0, 0), "turns": False}],
        springs=[{"type": "linear", "name": "load", "a": "ground", "b": "tip", "on_a": (-0.2, 0.0),
                  "stiffness": 500.0, "damping": 5.0}],
        tendons=[{"name": "cord", "stiffness": 1e5, "guides": [
            guide("tip"), *(guide("ground", p, friction=mu) for p in points[1:-1]),
            guide("ground", points[-1])]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": "=100 * t"}])))
    arrives = run["cord.tension_0"][-1] / run["pull.value"][-1]
    assert arrives == pytest.approx(math.exp(-mu * math.radians(135.0)), rel=1e-9)


@pytest.mark.parametrize("stiffness", [2e3, 1e6])
def test_a_cord_that_hangs_is_taken_up_as_a_whole(stiffness: float) -> None:
    """1 kg falls 20 mm onto a slack cord over two guides with friction; nothing is lost of it."""
    run = sound(simulate(mechanism(
        duration=0.4, step=H, gravity=(0.0, -G),
        bodies=[fixed("ground"), mass("load", 1.0, (0.05, -0.5))],
        tendons=[{"name": "rope", "stiffness": stiffness, "slack": 0.02, "guides": [
            guide("load"), guide("ground", (0, 0), 0.05, "left", 0.3),
            guide("ground", (-0.5, 0.05), friction=0.2), guide("ground", (-1, -0.05))]}])))
    hangs = run["rope.tension"] == 0.0
    taken = float(run.time[np.argmin(hangs)])
    assert taken == pytest.approx(math.sqrt(2 * 0.02 / G), abs=2 * H)
    pieces = np.array([run[f"rope.tension_{k}"] for k in range(3)])
    assert (pieces[:, hangs] == 0.0).all()
    assert (pieces[:, ~hangs] > 0.0).all()


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_a_band_brake_stops_a_wheel_by_its_trailing_or_leading_end(sense: float) -> None:
    """20 N on one end, the other tied: M = T r (e^(mu phi) - 1) or T r (1 - e^(-mu phi))."""
    mu, r, inertia = 0.25, 0.1, 0.02
    run = sound(simulate(mechanism(
        duration=0.1, step=H, bodies=[
            fixed("ground"),
            {"name": "drum", "mass": 1.0, "inertia": inertia, "angular_velocity": sense * 50.0}],
        joints=[pin("axle", "drum", (0.0, 0.0))],
        tendons=[{"name": "band", "stiffness": STIFF, "damping": 1e3, "guides": [
            guide("ground", (r, -0.3)), guide("drum", (0, 0), r, "left", mu),
            guide("ground", (-r, -0.3))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "band", "value": 20.0}])))
    e = math.exp(mu * math.pi)
    # counter-clockwise it drags the band off its tied end, which then pulls the more
    torque = 20.0 * r * ((e - 1) if sense > 0 else (1 - 1 / e))
    assert run["drum.alpha"][-20:] == pytest.approx(-sense * torque / inertia, rel=1e-6)


def test_a_cord_let_go_slides_until_it_does_not_pull() -> None:
    """A pull that ends leaves no stretch behind a guide that would still hold some."""
    run = sound(simulate(mechanism(
        duration=0.3, step=H, bodies=[fixed("ground"), mass("load", 1.0, (-0.5, 0.0))],
        joints=[{"type": "weld", "name": "held", "a": "ground", "b": "load",
                 "on_b": (0.0, 0.0)}],
        tendons=[{"name": "cord", "stiffness": 1e4, "guides": [
            guide("load"), guide("ground", friction=0.3), guide("ground", (0.0, -0.5))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord",
                 "value": "=20 if abs(t - 0.15) > 0.05 else 0"}])))
    pulls = np.isclose(run["pull.value"], 20.0)
    holds = math.exp(0.3 * math.pi / 2)
    assert run["cord.tension_0"][~pulls] == pytest.approx(np.zeros((~pulls).sum()), abs=1e-9)
    # 20 N e^(-mu phi) again, after just the slip that stretches 0.5 m by it; what slides in the one
    # step makes the span stiffer by the strain, 1.25e-3
    assert run["cord.tension_0"][-1] == pytest.approx(20 / holds, rel=1.3e-3)
    stretched = 20 / holds / (1e4 * 1.0) * 0.5
    assert run["cord.slip_1"][-1] == pytest.approx(stretched, rel=1.3e-3)
    assert run["cord.slip_1"][~pulls][-1] == pytest.approx(0.0, abs=1e-3 * stretched)
