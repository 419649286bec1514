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


def with_centre_off(disc: Mechanism, off: float) -> Mechanism:
    """The same with the origin of the disc's frame ``off`` beside its middle [m]."""
    bodies = [body if body.name != "disc" else body.model_copy(update={
        "at": (-off, 0.0),
        "shapes": tuple(shape.model_copy(update={"at": (off, 0.0)}) for shape in body.shapes)})
        for body in disc.bodies]
    return disc.model_copy(update={"bodies": tuple(bodies)})


@pytest.mark.parametrize("off", [0.0, 0.008])
def test_a_disc_between_three_fingertips(disc: Mechanism, off: float) -> None:
    """It holds up to 3/2 mu N / max |cos|, then goes as F = r t drives all that moves at most.

    r t^3 / 6 m is the limit then, and it lets go no sooner than the bound says.
    It is pushed at its centre of mass, wherever its frame has its origin.
    """
    disc = with_centre_off(disc, off)
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
    """Two floors with a gap between them carry it, half of its weight each."""
    floors = [{"name": f"floor{side + 1}", "motion": "fixed",
               "shapes": [{"type": "box", "size": (0.4, 0.1), "at": (0.21 * side, -0.05)}]}
              for side in (-1, 1)]
    box = {"name": "box", "mass": 0.2, "at": (0, 0.02),
           "shapes": [{"type": "box", "size": (0.06, 0.04)}]}
    mechanism = expand(load_scene({
        "gravity": [0, -9.81], "bodies": [*floors, box],
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


def test_what_nothing_holds_goes_from_the_first_step_on() -> None:
    """On a smooth floor, sideways: F = r t makes r t^3 / 6 m, which is the limit after 4 to 5 ms.

    Of that the first sample beyond it is told, one step later at most, and the step's own error is
    another one.
    """
    mass, limit, over, step = 0.2, 1e-6, 0.3, 5e-4
    mechanism = expand(load_scene({
        "gravity": [0, -9.81], "run": {"step": step}, "materials": {"ice": {"friction": 0}},
        "bodies": [{"name": "floor", "motion": "fixed", "material": "ice",
                    "shapes": [{"type": "box", "size": (1, 0.1), "at": (0, -0.05)}]},
                   {"name": "box", "mass": mass, "at": (0, 0.02), "material": "ice",
                    "shapes": [{"type": "box", "size": (0.06, 0.04)}]}]}))
    found = pushes(mechanism, "box", at=0.05, over=over, count=2, limit=limit)
    np.testing.assert_array_equal(found.bound, 0.0)
    rate = 2 * mass * 9.81 / over
    exact = (6 * mass * limit / rate) ** (1 / 3)
    assert 3e-3 < exact < 5e-3
    np.testing.assert_allclose(found.found, rate * (exact + step / 2), atol=1.5 * rate * step)


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
