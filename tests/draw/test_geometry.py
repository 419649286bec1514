import math

import numpy as np
import pytest
from hypothesis import strategies as st

from sandbox.picture import geometry as g
from sandbox.scene.elements.bodies import Box, Capsule, Polygon

radius = st.floats(0.0, 1.0)
place = st.floats(-5, 5)
side = st.sampled_from([-1, 1])


def area(corners):
    x, y = np.asarray(corners).T
    return 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)


def test_capsule_has_its_area():
    capsule = Capsule(type="capsule", start=(0, 0), end=(3, 4), radius=2)
    exact = math.pi * 4 + 5 * 4
    error = 0.01
    outline = g.shape_outline(capsule, error=error)
    # a chord lies at most `error` inside of its arc
    assert exact - 2 * math.pi * 2 * error <= area(outline) <= exact
    assert area(g.shape_outline(capsule, 1.0)) > area(outline)


@pytest.mark.parametrize("shape", [
    Box(type="box", size=(2, 4), at=(1, 1), angle=0.3),
    Polygon(type="polygon", points=((0, 0), (0, 2), (4, 2), (4, 0))),
])
def test_grown_rectangles(shape):
    assert area(g.shape_outline(shape)) == pytest.approx(8)
    assert area(g.shape_outline(shape, 0.5)) == pytest.approx(15)
    assert area(g.shape_outline(shape, -0.5)) == pytest.approx(3)


