"""The engine against textbook motions of one or two bodies.

Poses are labelled t = (k - 1/2) h (a leapfrog): under a constant force they
are a h^2 / 8 off the parabola, under a spring their phase runs ahead by a
share (omega h)^2 / 24. Tolerances follow from these two.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sandbox.engine.simulate import simulate
from sandbox.scene.mechanism import Mechanism
from sandbox.study import independent as reference

from .machines import G, fixed, mass, mechanism

H = 5e-4


def on_plane(slope: float, friction: float, duration: float, shape: dict[str, Any],
             **block: Any) -> Mechanism:
    """A 0.2 kg body resting on a plane that falls toward +x, friction of the pair given."""
    c, s = np.cos(slope), np.sin(slope)
    return mechanism(
        duration=duration, step=H, gravity=(0.0, -G),
        materials={"rough": {"friction": friction}},
        bodies=[
            fixed("plane", angle=-slope, material="rough", shapes=[
                {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}]),
            {"name": "block", "mass": 0.2, "at": (0.01 * s, 0.01 * c), "angle": -slope,
             "material": "rough", "shapes": [shape], **block},
        ])


BOX = {"type": "box", "size": (0.06, 0.02)}


def test_block_slides_down() -> None:
    """A = g (sin - mu cos), from the speeds of two instants: linear in time, so the scheme is
    exact, and two corners that start from their last impulses leave the solver nothing to do.
    """
    slope, friction = np.radians(30.0), 0.3
    run = simulate(on_plane(slope, friction, 0.5, BOX))
    speed = np.hypot(run["block.vx"], run["block.vy"])
    slope_of_speed = (speed[-1] - speed[100]) / (run.time[-1] - run.time[100])
    assert slope_of_speed == pytest.approx(reference.slide(slope, friction, G), rel=1e-9)
    assert run["block.contact.normal"][-1] == pytest.approx(0.2 * G * np.cos(slope), rel=1e-9)
    assert run["block.contact.tangential"][-1] == pytest.approx(
        friction * run["block.contact.normal"][-1], rel=1e-9)


def test_block_holds_below_the_friction_angle() -> None:
    """tan(slope) < mu: at rest, N = m g cos and friction m g sin; it does not creep: less than
    a nanometre in 0.4 s, where a slide without friction goes 0.27 m.
    """
    slope, friction = np.radians(20.0), 0.5
    run = simulate(on_plane(slope, friction, 0.5, BOX))
    assert run["block.contact.normal"][-1] == pytest.approx(0.2 * G * np.cos(slope), rel=1e-9)
    assert run["block.contact.tangential"][-1] == pytest.approx(0.2 * G * np.sin(slope), rel=1e-9)
    at = np.stack([run["block.x"], run["block.y"]], axis=1)
    assert np.linalg.norm(at[-1] - at[100]) < 1e-9


def crossings(time: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Instants [s] at which ``value`` goes through 0, by straight lines between samples."""
    i = np.flatnonzero(np.diff(np.sign(value)))
    return time[i] - value[i] * (time[i + 1] - time[i]) / (value[i + 1] - value[i])


@pytest.mark.parametrize("degrees", [5.0, 60.0, 150.0])
def test_pendulum_period(degrees: float) -> None:
    """T = 4 sqrt(I / (m g l)) K(sin^2(A/2)) of a rod on a pin.

    Scheme: (omega h)^2 / 24 of a period for small swings, up to (2 omega h)^2 / 24 through the
    bottom of large ones, and the straight line between samples 2 h apart as much again: (omega h)^2
    = 2.4e-5 covers both. A period without K would be off by 5e-4 at 5 deg already.
    """
    length, kilograms, inertia, amplitude = 0.1, 0.05, 2e-5, np.radians(degrees)
    period = reference.pendulum_period(length, inertia, kilograms, amplitude, G)
    run = simulate(mechanism(
        duration=2.2 * period, step=H, gravity=(0.0, -G),
        bodies=[fixed("wall"), {"name": "rod", "mass": kilograms, "inertia": inertia,
                                "angle": amplitude, "centre": (0.0, -length)}],
        joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "rod", "on_a": (0.0, 0.0)}]))
    through = crossings(run.time, run["pin.angle"])
    omega = np.sqrt(kilograms * G * length / (inertia + kilograms * length**2))
    assert through[2] - through[0] == pytest.approx(period, rel=(omega * H)**2)


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_mass_on_a_spring(damping: float) -> None:
    """M x'' + c x' + k x = 0 from x = 10 mm.

    Phase error omega t (omega h)^2 / 24, omega = 63 rad/s, over 0.3 s: 19 rad times 4.1e-5, 0.8e-3
    of the amplitude. The damper is second order too: twice that in all.
    """
    kilograms, stiffness, start = 0.05, 200.0, 0.01
    run = simulate(mechanism(
        duration=0.3, step=H, bodies=[fixed("wall"), mass("load", kilograms, (0.05 + start, 0.0))],
        springs=[{"type": "linear", "name": "spring", "a": "wall", "b": "load",
                  "stiffness": stiffness, "damping": damping, "rest_length": 0.05}]))
    truth = reference.damped_spring(run.time, kilograms, stiffness, damping, start)
    omega = np.sqrt(stiffness / kilograms)
    allowed = start * 2 * omega * 0.3 * (omega * H)**2 / 24
    np.testing.assert_allclose(run["load.x"] - 0.05, truth, atol=allowed)
    # the force, k x + c x', from the same motion
    np.testing.assert_allclose(
        run["spring.force"], stiffness * truth + damping * np.gradient(truth, run.time),
        atol=stiffness * allowed + damping * start * omega * (omega * 1e-3)**2
        + damping * start * omega * omega * 1e-3)
