"""The push that moves an object, by search: against its closed form, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.study.push import BEYOND, pushes

MU, N = 0.4, 2.0
MASS = 0.1 + 3 * 0.02
"""Of the disc and all fingertips."""


@pytest.fixture(scope="module")
def disc() -> Mechanism:
    """The disc between three fingertips, with nothing else that pushes it."""
    return expand(load_scene("held_disc", overrides={"parameters.limit": 0}))


def test_a_disc_between_three_fingertips(disc: Mechanism) -> None:
    """It holds up to 3/2 mu N / max |cos|, then goes as F = r t drives all that moves at most.

    r t^3 / 6 m is the limit then, and it lets go no sooner than the bound says.
    """
    seen: list[float] = []
    found = pushes(disc, "disc", at=0.15, over=1.0, count=4, limit=1e-5, progress=seen.append)
    closed = 1.5 * MU * N / np.array([1.0, math.cos(math.pi / 6)] * 2)
    np.testing.assert_allclose(found.bound, closed, rtol=1e-9)
    np.testing.assert_allclose(found.most, BEYOND * closed, rtol=1e-9)
    rate = found.most / 1.0
    late = rate * ((6 * MASS * found.limit / rate) ** (1 / 3) + 2e-3)
    assert (found.found > closed).all()
    assert (found.found < closed + late).all()
    assert len(found.around) == len(found.bounds) >= 120
    np.testing.assert_allclose(found.bounds.max(), closed.max(), rtol=1e-9)
    assert seen == [0.0, 0.25, 0.5, 0.75]


def test_what_does_not_move_up_to_the_most(disc: Mechanism) -> None:
    found = pushes(disc, "disc", at=0.15, over=0.2, count=1, limit=0.5)
    assert np.isinf(found.found).all()


def test_without_a_bound_it_is_pushed_with_twice_what_presses() -> None:
    floor = {"name": "floor", "motion": "fixed",
             "shapes": [{"type": "box", "size": (1, 0.1), "at": (0, -0.05)}]}
    box = {"name": "box", "mass": 0.2, "at": (0, 0.02),
           "shapes": [{"type": "box", "size": (0.06, 0.04)}]}
    mechanism = expand(load_scene({
        "gravity": [0, -9.81], "bodies": [floor, box],
        "drives": [{"type": "force", "name": "study_push", "body": "box", "direction": [1, 0],
                    "value": 0}]}))
    found = pushes(mechanism, "box", at=0.05, over=0.3, count=4)
    weight = 0.2 * 9.81
    assert found.limit == pytest.approx(0.01 * math.hypot(0.03, 0.02))
    assert np.isinf(found.bound[3])
    assert np.isinf(found.found[3])
    assert found.most[3] == pytest.approx(2 * weight, rel=1e-6)
    np.testing.assert_allclose(found.bound[:3], [weight / 2, weight, weight / 2], rtol=1e-6)
    assert (found.found[:3] > found.bound[:3]).all()


@pytest.mark.parametrize(("body", "at", "told"), [
    ("disk", 0.1, "'disk' is no body"),
    ("frame", 0.1, "'frame' does not move freely"),
    ("lone", 0.1, "nothing touches 'lone' at t = 0.099"),
])
def test_what_cannot_be_pushed(disc: Mechanism, body: str, at: float, told: str) -> None:
    lone = disc.bodies[1].model_copy(update={"name": "lone", "at": (1.0, 1.0)})
    mechanism = disc.model_copy(update={"bodies": (*disc.bodies, lone)})
    with pytest.raises(SceneError) as refused:
        pushes(mechanism, body, at=at)
    assert told in str(refused.value)
    if body == "disk":
        assert refused.value.problems[0].hint == "'disc'"
