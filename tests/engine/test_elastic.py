"""Tendons and springs: second order in the step, slack tendons, damping, degenerate springs."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism

from .machines import disc, fixed, mass, mechanism


def snatch(h: float, damping: float = 0.0) -> Recording:
    """20 kg at 2 m/s take up 5 kg, once by a rope and once by a cord, after 50 ms."""
    bodies = [{"name": name, "mass": mass, "at": [x, y], "velocity": [v, 0],
               "shapes": [{"type": "circle", "radius": 0.02}]}
              for y, kind in ((0.0, "rope"), (0.1, "cord"))
              for name, mass, x, v in ((f"{kind}ed", 5, 0.0, 0.0), (f"{kind}er", 20, 0.1, 2.0))]
    return simulate(Mechanism.model_validate({
        "run": {"duration": 0.1, "step": h, "sample_rate": 500}, "bodies": bodies,
        "joints": [{"type": "rope", "name": "rope", "a": "ropeed", "b": "ropeer", "longest": 0.2}],
        "tendons": [{"name": "cord", "guides": [{"body": "corded"}, {"body": "corder"}],
                     "slack": 0.1, "damping": damping}]}))


@pytest.mark.parametrize("h", [2e-3, 5e-4, 5e-5])
def test_a_rope_gives_nothing_back_and_a_cord_what_the_step_leaves_it(h: float):
    """Together 1.6 m/s; half a period at the damping ratio h w / 2 on top of it.

    To first order in h: the next is (h w)^2 of it.
    """
    run, w = snatch(h), np.sqrt(1e5 / 4.0)
    assert run["ropeed.vx"][-1] == pytest.approx(1.6, abs=1e-9)
    assert run["corded.vx"][-1] == pytest.approx(
        1.6 * (1 + np.exp(-np.pi * h * w / 2)), abs=1.6 * (h * w)**2)


@pytest.mark.parametrize("stiffness", [100.0, 1e9])
@pytest.mark.parametrize("damping", [0.0, 1.0])
def test_a_spring_of_no_length_exerts_no_force(stiffness: float, damping: float) -> None:
    run = simulate(mechanism(
        duration=0.01, bodies=[fixed("wall"), mass("b", 0.1, (0.0, 0.0))],
        springs=[{"type": "linear", "name": "s", "a": "wall", "b": "b", "stiffness": stiffness,
                  "damping": damping, "rest_length": 0.1}]))
    np.testing.assert_array_equal(run.arrays["body_velocity"], 0.0)


@pytest.mark.parametrize("free", [("one", "two"), ("one",), ("two",)])
def test_motion_does_not_depend_on_which_end_of_a_spring_is_a(free):
    """Two discs held off their centres by a damper as strong as the step bears: the same motion."""
    bodies = [
        {**disc(name, 0.02, at, velocity=speed, angular_velocity=turn)}
        if name in free else fixed(name, at=at)
        for name, at, speed, turn in (("one", (0.0, 0.0), (0.3, -0.2), 9.0),
                                      ("two", (0.1, 0.03), (-0.1, 0.4), -15.0))]
    ends = {"one": (0.004, 0.017), "two": (-0.013, 0.009)}
    runs = [simulate(mechanism(duration=0.05, bodies=bodies, springs=[{
        "type": "linear", "name": "band", "a": a, "b": b, "on_a": ends[a], "on_b": ends[b],
        "stiffness": 300.0, "damping": 60.0}])) for a, b in (("one", "two"), ("two", "one"))]
    for key in ("body_pose", "body_velocity", "spring_force", "spring_work"):
        one, other = (run.arrays[key] for run in runs)
        assert one == pytest.approx(other, rel=1e-9, abs=1e-12)
