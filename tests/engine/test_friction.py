"""Dry friction of pins and slots, against closed forms and an independent integration.

A step changes velocities by (all impulses) / inertia exactly: where friction and load are constant,
speeds are right to rounding (1e-12 of them, over some hundred steps), and instants to a step.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from sandbox.audit.audit import audit
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import G, fixed, mechanism, sound

H = 1e-3
ROUNDING = 1e-12


# -- what holds ------------------------------------------------------------------------


def test_a_joint_held_by_a_servo_sticks() -> None:
    """A servo turns an arm and stops: it slips on the way, and sticks when nothing moves.

    What of the arm's weight friction takes and what the servo takes is open; both are all of it.
    """
    run = sound(simulate(mechanism(
        bodies=[fixed("frame"), {"name": "arm", "mass": 1.0, "inertia": 1e-3, "centre": [0.1, 0]}],
        joints=[{"type": "pin", "name": "p", "a": "frame", "b": "arm", "on_b": [0, 0],
                 "friction": 0.3}],
        drives=[{"type": "servo", "name": "servo", "joint": "p", "value": 0.5, "torque": 5,
                 "speed": 1.0}],
        gravity=[0, -G], run={"duration": 1.0, "step": H, "sample_rate": 1 / H})))
    moves = np.abs(run["p.rate"]) > 1e-6
    assert moves.sum() > 400
    assert not run["p.sticks"][moves].any()
    assert run["p.sticks"][run.time > 0.9].all()
    torque = (run["servo.torque"] + run["p.friction"])[-1]
    assert torque == pytest.approx(0.1 * G * math.cos(0.5), rel=1e-9)


# -- where the bound hangs on the motion -----------------------------------------------


def test_a_bead_is_held_on_a_turning_rod() -> None:
    """A bead on a rod that turns ever faster slips at m w^2 r = F and does not creep before.

    A step foresees the bend of its way to second order, h^3 w^3 r / 6 are left to the next.
    """
    r, hold = 0.1, 4.0
    run = simulate(mechanism(
        duration=0.6, step=H, bodies=[
            {"name": "rod", "motion": "scheduled", "path": {"angle": "=20 * t * t"}},
            {"name": "bead", "mass": 0.1, "inertia": 1e-6, "at": (r, 0.0)}],
        joints=[{"type": "slot", "name": "s", "a": "rod", "b": "bead", "start": (0, 0),
                 "end": (1, 0), "friction": hold}]))
    assert all(f.verdict == "pass" for f in audit(run) if f.name in ("joint.friction", "work"))
    lets_go = math.sqrt(hold / 0.1 / r) / 40
    held = run.time < lets_go - H
    assert (run["s.sticks"][held] == 1.0).all()
    assert run["s.sticks"][run.time > lets_go + H][0] == 0.0
    way = np.hypot(run["bead.x"], run["bead.y"])[held]
    w = 40 * run.time[held][-1]
    assert np.abs(way - r).max() < 1.5 * H**3 * w**3 * r / 6
    assert -run["s.friction"][held][10:] == pytest.approx(
        0.1 * (40 * run.time[held][10:]) ** 2 * r, rel=1e-2)


def ladder(angle: float, load: float, *, speed: float = 0.0, light: float = 0.1) -> Mechanism:
    """A weight in an upright groove, on a rod that pushes a light block along a level one."""
    c, s = math.cos(angle), math.sin(angle)
    return mechanism(
        duration=0.05, step=H, gravity=(0.0, 0.0), bodies=[
            fixed("wall"),
            {"name": "up", "mass": 1.0, "inertia": 1e-3, "at": (0.0, s), "velocity": (0, -speed)},
            {"name": "out", "mass": light, "inertia": 1e-3, "at": (c, 0.0),
             "velocity": (speed * s / c, 0.0)}],
        joints=[
            {"type": "slot", "name": "v", "a": "wall", "b": "up", "start": (0, 0), "end": (0, 2)},
            {"type": "slot", "name": "h", "a": "wall", "b": "out", "start": (0, 0), "end": (2, 0),
             "friction_coefficient": 0.5},
            {"type": "rod", "name": "r", "a": "up", "b": "out"}],
        drives=[{"type": "force", "name": "load", "body": "up", "direction": (0, -1),
                 "value": load}])


@pytest.mark.parametrize("load", [1.0, 1e4])
def test_a_self_locking_mechanism_holds_any_load(load: float) -> None:
    """A rod steeper than atan(1 / mu) presses more than it pushes, however much that is."""
    steep = math.atan(2.0)
    held = sound(simulate(ladder(steep * 1.001, load)))
    assert (held["h.sticks"] == 1.0).all()
    assert np.abs(held["out.vx"]).max() < 1e-9 * load
    assert held["h.reaction"][5:] == pytest.approx(np.full(45, load), rel=1e-7)
    assert (sound(simulate(ladder(steep * 0.99, 1.0)))["h.sticks"] == 0.0).all()


def test_a_mechanism_that_becomes_self_locking_stops_at_once() -> None:
    """Where sliding friction has no answer the block sticks: its speed goes in one step.

    Of a light block, mu sin - cos > sin^2 m / (M cos): were it to slide, the rod could neither push
    nor pull.
    """
    run = simulate(ladder(math.atan(2.0) * 1.2, 10.0, speed=0.1, light=0.01))
    assert np.abs(run["out.vx"][1:]).max() < 1e-9
    assert (run["h.sticks"] == 1.0).all()
    assert np.isfinite(run["h.reaction"]).all()


# -- engaged --------------------------------------------------------------------------


SLOT = {"type": "slot", "name": "s", "a": "wall", "b": "m", "start": (0, 0), "end": (3, 0),
          "turns": False, "friction": 3.0, "static": 1.5, "takes_up_in": "10 ms"}


def pushed(pushes: list[Any], *, speed: float = 0.0, events: list[Any]) -> Recording:
    """1 kg in a slot with 3 N of friction, without gravity."""
    return sound(simulate(mechanism(
        duration=0.5, step=H, bodies=[fixed("wall"), {
            "name": "m", "mass": 1.0, "inertia": 1e-3, "velocity": (speed, 0.0)}],
        joints=[SLOT],
        drives=[{"type": "force", "name": "push", "body": "m", "direction": (1, 0),
                 "value": {"table": pushes}}], events=events)))


def test_engaged_friction_holds_at_the_new_place() -> None:
    """Moved by 32 mm while released, it rests where the slot is engaged."""
    run = pushed([[0.06, 0], [0.1, 10], [0.14, 0], [0.18, -10], [0.22, 0]],
                 events=[{"name": "go", "at": 0.05, "release": ["s"]},
                         {"name": "back", "at": 0.3, "take_up": ["s"]}])
    after = run.time > 0.3
    assert run["m.x"][after] == pytest.approx(0.032, abs=1e-6)
    assert np.abs(run["m.vx"][after]).max() < 1e-9
    assert np.abs(run["s.friction"][after]).max() < 1e-6


def test_friction_that_starts_or_is_engaged_in_motion_slips() -> None:
    """With 3 N from the first step on, not with the 4.5 N that hold."""
    run = pushed([[0, 0], [1, 0]], speed=2.0, events=[
        {"name": "go", "at": 0.1, "release": ["s"]}, {"name": "back", "at": 0.2, "take_up": ["s"]}])
    held = (run.time < 0.1) | (run.time > 0.2)
    assert run["s.friction"][held] == pytest.approx(-3.0, abs=ROUNDING)
