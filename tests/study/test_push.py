"""The push that moves an object, by search: against its closed form, and what is refused."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene
from sandbox.study.push import BEYOND, FIRST, SLOWER, pushes

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

    r t^3 / 6 m is the limit then, and it lets go no sooner than the bound says. The slower push,
    whose r counts, is there because the first one tells some 5 % more.
    It is pushed at its centre of mass, wherever its frame has its origin.
    """
    disc = with_centre_off(disc, off)
    seen: list[float] = []
    found = pushes(disc, "disc", at=0.15, over=1.0, count=4, limit=1e-5, progress=seen.append)
    closed = 1.5 * MU * N / np.array([1.0, math.cos(math.pi / 6)] * 2)
    np.testing.assert_allclose(found.bound, closed, rtol=1e-9)
    np.testing.assert_allclose(found.most, BEYOND * closed, rtol=1e-9)
    rate = FIRST * closed / SLOWER / 1.0
    assert found.settled.all()
    late = rate * ((6 * MASS * found.limit / rate) ** (1 / 3) + 2e-3)
    assert (found.found > closed).all()
    assert (found.found < closed + late).all()
    assert len(found.around) == len(found.bounds) >= 120
    np.testing.assert_allclose(found.bounds.max(), closed.max(), rtol=1e-9)
    assert seen == [0.0, 0.25, 0.5, 0.75]


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
