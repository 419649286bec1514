import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.picture import geometry as g
from sandbox.scene.elements.bodies import Box, Capsule, Polygon

radius = st.floats(0.0, 1.0)
place = st.floats(-5, 5)
side = st.sampled_from([-1, 1])


@given(place, place, radius, side, place, place, radius, side)
def test_cords_touch_wheels_at_right_angles(x1, y1, r1, s1, x2, y2, r2, s2):
    line = g.tangent((x1, y1), r1, s1, (x2, y2), r2, s2)
    distance = math.hypot(x2 - x1, y2 - y1)
    if line is None:
        assert distance <= abs(s1 * r1 - s2 * r2) or distance == 0
        return
    (ax, ay), (bx, by) = line
    # closed form: the cord's length is the leg of a right triangle
    gap = max(distance**2 - (s1 * r1 - s2 * r2) ** 2, 0.0)
    assert (bx - ax) ** 2 + (by - ay) ** 2 == pytest.approx(gap, abs=1e-9)
    for (cx, cy), (px, py), r, s in (((x1, y1), (ax, ay), r1, s1), ((x2, y2), (bx, by), r2, s2)):
        assert math.hypot(px - cx, py - cy) == pytest.approx(r, abs=1e-9)
        dot = (px - cx) * (bx - ax) + (py - cy) * (by - ay)
        assert dot == pytest.approx(0, abs=1e-9)
        turn = (bx - ax) * (cy - py) - (by - ay) * (cx - px)
        # s = +1: the centre lies right of the path, so this product is not positive
        assert s * turn <= 1e-9


@pytest.mark.parametrize("closed", [False, True])
def test_a_wheel_that_a_cord_goes_all_around_has_a_whole_turn_more(closed):
    """As a capstan has it; chords of 0.2 rad fall short of the arc by 0.2^2 / 24 of it."""
    points, radii, senses = [(-1.0, 3.0), (0.0, 0.0), (1.0, 3.0)], [0, 1, 0], [1, -1, 1]
    if closed:
        points, radii, senses = [(0.0, 0.0), (0.0, 5.0), (0.0, 0.0)], [1, 1, 1], [1, 1, 1]

    def length(**how):
        pieces = g.cord_pieces(points, radii, senses, closed=closed, **how)
        return sum(math.dist(p, q) for path in pieces for p, q in itertools.pairwise(path))

    turn = length(around=[0 if closed else 1]) - length()
    assert turn == pytest.approx(math.tau, rel=0.2**2 / 24 * 1.1)


def test_wound_part_lies_on_the_wheel_and_goes_on_smoothly():
    for sense in (1, -1):
        plain = g.cord_path([(0, 0), (4, 0)], [0, 1], [1, sense])
        path = g.cord_path([(0, 0), (4, 0)], [0, 1], [1, sense], 1.0)
        assert path[:2] == plain
        assert all(math.dist(p, (4, 0)) == pytest.approx(1) for p in path[1:])
        arrived = np.subtract(path[1], path[0]) / math.dist(path[0], path[1])
        first = np.subtract(path[2], path[1]) / math.dist(path[1], path[2])
        # five chords of 0.2 rad: the first one turns by half of that
        assert arrived @ first == pytest.approx(math.cos(0.1))
        back = g.cord_path([(4, 0), (0, 0)], [1, 0], [-sense, 1], 1.0)
        assert np.allclose(back, path[::-1])


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


def test_rope_hangs_to_its_length():
    length = 1.1
    points = g.sagging((0, 0), (1, 0), length, steps=400)
    measured = sum(math.dist(p, q) for p, q in itertools.pairwise(points))
    # the series length = span (1 + 8/3 q^2 - 32/5 q^4 ...), q = depth / span
    q2 = 0.1 * 3 / 8
    assert abs(measured - length) < 32 / 5 * q2**2
    assert max(p[1] for p in points) > 0.15
