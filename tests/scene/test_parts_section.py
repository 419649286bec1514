"""A section: circle, square, rod that gives way."""

import math

import numpy as np
import pytest
from pydantic import ValidationError

from sandbox.scene.parts.section import Section, expand_section

PLAIN = {"type": "section", "name": "s", "at": [0.1, 0.2], "circle": "16 mm"}
SQUARE = {"square": "12 mm", "rod": ["10 mm", "36 mm"], "angle": "90 deg"}


def section(**changes):
    return expand_section(Section.model_validate(PLAIN | changes))


def test_rigid_rod():
    rod = next(j for j in section(**SQUARE | {"rod": "36 mm"}).joints if j.name == "s.rod")
    assert (rod.type, rod.length) == ("rod", 0.036)


def test_the_square_is_held_equally_along_and_across_its_rod():
    made = section(**SQUARE, hold="5 N/m", damping=1)
    push, hold = made.springs
    assert (push.stiffness, push.rest_length) == (5, 0.036)
    assert hold.stiffness == pytest.approx(5 * 0.036**2)  # torque k r^2 phi = force k s at r
    pivot = next(j for j in made.joints if j.name == hold.joint)
    assert pivot.damping == pytest.approx(1 * 0.036**2)


def test_the_arm_weighs_and_turns_as_a_thin_rod_over_its_reach():
    """A fifth of the square's mass spread evenly over the reach: x^2 summed about its middle.

    Midpoints of n pieces miss the share 1 / n^2 of it.
    """
    for rod, reach in (("36 mm", 0.036), (["10 mm", "50 mm"], 0.05)):
        arm = next(b for b in section(**SQUARE | {"rod": rod}, mass="15 g").bodies
                   if b.name == "s.arm")
        pieces = (np.arange(1000) + 0.5) / 1000 * reach
        middle = pieces.mean()
        assert (arm.at, arm.angle) == ((0.1, 0.2), pytest.approx(math.pi / 2))
        assert arm.mass == pytest.approx(0.003, rel=1e-12)
        assert arm.centre == pytest.approx((middle, 0.0), rel=1e-12)
        assert arm.inertia == pytest.approx(
            0.003 * np.mean((pieces - middle) ** 2), rel=1.1e-6)


@pytest.mark.parametrize("changes", [
    {"square": "12 mm"}, {"rod": "30 mm"},
    {"square": "12 mm", "rod": ["30 mm", "20 mm"]}, {"circle": 0},
])
def test_wrong_sections(changes):
    with pytest.raises(ValidationError):
        section(**changes)
