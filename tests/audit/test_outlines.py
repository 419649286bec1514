"""What a contact sees of a shape: the way to it along a normal, aside of it, its own normals."""

from __future__ import annotations

import numpy as np
import pytest

from sandbox.audit.outlines import seen
from sandbox.scene.elements.bodies import Box, Capsule, Circle, Polygon

CIRCLE = Circle(type="circle", radius=0.02, at=(0.1, 0.0))
BAR = Capsule(type="capsule", start=(0.0, 0.0), end=(0.1, 0.0), radius=0.01)
BOX = Box(type="box", size=(0.2, 0.1))
WEDGE = Polygon(type="polygon", points=((0.0, 0.0), (0.3, 0.0), (0.0, 0.4)))
UP, RIGHT, SLANT = (0.0, 1.0), (1.0, 0.0), (0.8, 0.6)


@pytest.mark.parametrize(("shape", "place", "out", "distance", "aside", "turned"), [
    (CIRCLE, (0.1, 0.03), UP, 0.01, 0.0, 0.0), (CIRCLE, (0.1, 0.015), UP, -0.005, 0.0, 0.0),
    (CIRCLE, (0.1 + 0.04 * 0.6, 0.04 * 0.8), UP, 0.012, 0.008, np.hypot(0.6, 0.2)),
    (BAR, (0.05, 0.013), UP, 0.003, 0.0, 0.0), (BAR, (0.1 + 0.016, 0.012), SLANT, 0.01, 0.0, 0.0),
    (BAR, (0.13, 0.01), UP, 0.0, np.hypot(0.03, 0.01) - 0.01, None),
    (BOX, (0.09, 0.052), UP, 0.002, 0.0, 0.0), (BOX, (0.099999, 0.049), UP, -0.001, 0.0, 0.0),
    (BOX, (0.104, 0.053), SLANT, 0.005, 0.0, np.hypot(0.2, 0.6)),
    (BOX, (0.13, 0.05), UP, 0.0, 0.03, 0.0), (BOX, (0.0, 0.05), RIGHT, -0.1, 0.0, 0.0),
    (WEDGE, (0.15 + 0.008, 0.2 + 0.006), SLANT, 0.01, 0.0, 0.0),
])
def test_ways_to_shapes(shape, place, out, distance, aside, turned):
    found = seen(shape, np.array([place]), np.array([out]))
    assert found.distance[0] == pytest.approx(distance, abs=1e-15)
    assert found.aside[0] == pytest.approx(aside, abs=1e-15)
    if turned is not None:
        assert found.turned[0] == pytest.approx(turned, abs=1e-12)


def test_a_radius_that_is_set_counts_instead_of_the_scenes():
    found = seen(CIRCLE, np.array([[0.1, 0.03]] * 2), np.array([UP] * 2), np.array([0.03, 0.01]))
    assert found.distance == pytest.approx([0.0, 0.02])
