"""The largest push that can be balanced, against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.evidence import Evidence
from sandbox.audit.pushes import push_limits
from sandbox.engine.simulate import simulate
from sandbox.recording.recording import Recording
from tests.engine.machines import mechanism

G, MASS = 9.81, 0.2
WEIGHT = MASS * G
RIGHT, UP, LEFT, DOWN = np.radians([0, 90, 180, 270])


def standing(mu, width, height, *more, slope=0.0):
    """A box on a floor that is tilted about the origin, at rest."""
    c, s = np.cos(slope), np.sin(slope)
    return simulate(mechanism(
        duration=0.02, gravity=(0.0, -G),
        bodies=[
            {"name": "floor", "motion": "fixed", "angle": slope, "material": "m",
             "shapes": [{"type": "box", "size": (1.0, 0.1), "at": (0.0, -0.05)}]},
            {"name": "box", "mass": MASS, "angle": slope, "material": "m",
             "at": (-s * height / 2, c * height / 2),
             "shapes": [{"type": "box", "size": (width, height)}]}, *more],
        materials={"m": {"friction": mu}}))


def limits(run, *directions, body="box"):
    number = [each.name for each in run.mechanism.bodies].index(body)
    return push_limits(Evidence(run), number, directions)


@pytest.mark.parametrize(("mu", "width", "height"), [(0.3, 0.06, 0.04), (0.9, 0.04, 0.06)])
def test_a_box_slides_or_tips(mu, width, height):
    """By mu W or W b / h, whichever is less: the sides are flat, so that an edge may carry all."""
    least = min(mu * WEIGHT, WEIGHT * width / height)
    found = limits(standing(mu, width, height), RIGHT, LEFT, UP, DOWN)
    np.testing.assert_allclose(found[:3], [least, least, WEIGHT], rtol=1e-6)
    assert np.isinf(found[3])


def test_steep_pushes_down_on_a_box_jam():
    """Within the friction cone no push is too large; a degree outside of it one is.

    F cos(a) = mu (W + F sin(a)).
    """
    mu = 0.5
    cone = np.arctan(1 / mu)
    inside, outside = -cone - np.radians(1), -cone + np.radians(1)
    found = limits(standing(mu, 0.2, 0.02), inside, outside)
    assert np.isinf(found[0])
    assert found[1] == pytest.approx(
        mu * WEIGHT / (np.cos(outside) + mu * np.sin(outside)), rel=1e-6)


def test_on_a_slope():
    """mu W cos less or plus W sin, along it."""
    mu, slope = 0.5, np.radians(15)
    found = limits(standing(mu, 0.06, 0.02, slope=slope), slope, slope + np.pi)
    hold, pull = mu * WEIGHT * np.cos(slope), WEIGHT * np.sin(slope)
    np.testing.assert_allclose(found, [hold + pull, hold - pull], rtol=1e-6)


def test_what_nothing_touches_and_what_nothing_balances():
    ball = {"name": "ball", "mass": 0.1, "at": (0.3, 1.0),
            "shapes": [{"type": "circle", "radius": 0.01}]}
    run = standing(0.3, 0.06, 0.04, ball)
    assert limits(run, RIGHT, UP, body="ball").tolist() == [0.0, 0.0]
    arrays = {key: np.array(value) for key, value in run.arrays.items()}
    arrays["body_acceleration"][-1, 1, 1] = -2 * G  # faster than it falls: a floor cannot pull
    assert np.isnan(limits(Recording(run.mechanism, arrays, run.info), RIGHT)).all()


def test_what_is_pressed_by_a_hand_that_gives_way():
    """A block between a wall and a jaw pushed with P: towards the jaw P, into the wall no bound.

    Across, friction of both sides: 2 mu P. It weighs nothing here.
    """
    mu, P = 0.4, 3.0
    run = simulate(mechanism(
        duration=0.05, materials={"m": {"friction": mu}}, bodies=[
            {"name": "wall", "motion": "fixed", "material": "m", "role": "palm",
             "shapes": [{"type": "box", "size": (0.02, 0.2), "at": (-0.01, 0.0)}]},
            {"name": "block", "mass": MASS, "at": (0.02, 0.0), "role": "object", "material": "m",
             "shapes": [{"type": "box", "size": (0.04, 0.04)}]},
            {"name": "jaw", "mass": 0.05, "at": (0.05, 0.0), "role": "phalanx", "material": "m",
             "shapes": [{"type": "box", "size": (0.02, 0.04)}]}],
        joints=[{"type": "slot", "name": "guide", "a": "wall", "b": "jaw", "on_b": (0, 0),
                 "start": (0.0, 0.0), "end": (0.2, 0.0), "turns": False}],
        drives=[{"type": "force", "name": "press", "body": "jaw", "direction": (-1, 0),
                 "value": P}]))
    found = limits(run, RIGHT, LEFT, UP, DOWN, body="block")
    np.testing.assert_allclose(found[[0, 2, 3]], [P, 2 * mu * P, 2 * mu * P], rtol=1e-6)
    assert np.isinf(found[1])
