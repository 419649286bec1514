import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.draw.film import geometry as g
from sandbox.scene.elements.bodies import Box, Capsule, Circle, Polygon

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


def test_open_and_crossed_belt_lengths():
    distance, r1, r2 = 5.0, 1.0, 0.5
    for s2, offset in ((1, r1 - r2), (-1, r1 + r2)):
        a, b = g.tangent((0, 0), r1, 1, (distance, 0), r2, s2)
        assert math.dist(a, b) == pytest.approx(math.sqrt(distance**2 - offset**2))


def test_half_turn_over_a_wheel_has_half_its_circumference():
    # down from the left, round below a wheel right ... the cord hangs like a U
    path = g.cord_path([(-1, 3), (0, 0), (1, 3)], [0, 1, 0], [1, -1, 1])
    below = [p for p in path if p[1] < 1e-9]
    assert min(p[1] for p in path) == pytest.approx(-1, abs=0.01)
    arc = sum(math.dist(p, q) for p, q in itertools.pairwise(below))
    # chords of 0.2 rad fall short of the arc by 0.2^2 / 24 of it
    assert arc == pytest.approx(math.pi, rel=0.2**2 / 24 * 1.1)


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


def test_a_wheel_passed_without_turning_adds_no_loop():
    path = g.cord_path([(-3, 1), (0, 0), (3, 1)], [0, 1, 0], [1, 1, 1])
    length = sum(math.dist(p, q) for p, q in itertools.pairwise(path))
    assert length == pytest.approx(6)


def test_cord_ends_where_it_is_wound_on():
    path = g.cord_path([(0, 0), (4, 0)], [0, 1], [1, 1])
    assert math.dist(path[-1], (4, 0)) == pytest.approx(1)
    assert math.dist(*path) == pytest.approx(math.sqrt(15))


@pytest.mark.parametrize("radius", [3.0, 60.0, 900.0])
def test_corners_of_a_wound_part_stand_off_its_wheel_by_a_tenth_of_a_pixel(radius):
    """Half way between two corners a chord is nearest to the middle."""
    corners = np.array([(radius, 0.0), *g.wound_on((0.0, 0.0), (radius, 0.0), 1.5)])
    middles = (corners[1:] + corners[:-1]) / 2
    assert (radius - np.hypot(*middles.T)).max() <= 0.1 * 1.001


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


def test_plain_points_stay():
    points = [(0.0, 0.0), (1.0, 2.0), (3.0, 1.0)]
    assert g.cord_path(points, [0, 0, 0], [1, -1, 1]) == points


def test_touching_eyes_do_not_break_the_cord():
    assert g.cord_path([(0, 0), (0, 0), (1, 0)], [0, 0, 0], [1, 1, 1])[-1] == (1, 0)


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


def test_circle_outline_is_round():
    circle = Circle(type="circle", radius=2, at=(1, 1))
    assert np.hypot(*(g.shape_outline(circle, 0.5) - 1).T) == pytest.approx(2.5)


def test_arrow_points_and_shrinks():
    corners = g.arrow((0, 0), (10, 0), 2, 3)
    assert corners[3] == (10, 0)
    assert {c[0] for c in corners} == {0, 7, 10}
    short = g.arrow((0, 0), (1, 0), 2, 3)
    assert min(c[0] for c in short) == 0
    assert max(c[0] for c in short) == 1


def test_rope_hangs_to_its_length():
    length = 1.1
    points = g.sagging((0, 0), (1, 0), length, steps=400)
    measured = sum(math.dist(p, q) for p, q in itertools.pairwise(points))
    # the series length = span (1 + 8/3 q^2 - 32/5 q^4 ...), q = depth / span
    q2 = 0.1 * 3 / 8
    assert abs(measured - length) < 32 / 5 * q2**2
    assert max(p[1] for p in points) > 0.15


def test_dashes_run_on_through_corners():
    pieces = g.dashes([(0, 0), (3, 0), (3, 3)], 2, 2)
    assert pieces == [((0, 0), (2, 0)), ((3, 1), (3, 3))]


def test_ribbon_is_as_wide_as_asked():
    corners = g.ribbon([(0, 0), (10, 0), (10, 10)], 2)
    assert abs(area(corners)) == pytest.approx(2 * 20)
    assert g.ribbon([(1, 1), (1, 1)], 2)


def test_coil_spans_its_ends():
    lines = g.along_lines(g.coil_template(), np.array([[0, 0.0]]), np.array([[0, 5.0]]),
                          np.array([0.5]))
    assert lines[0, 0].tolist() == [0, 0]
    assert lines[0, -1].tolist() == [0, 5]
    assert np.abs(lines[0, :, 0]).max() == 0.5


def test_spiral_turns_as_far_as_asked():
    path = g.spiral(3.0, 0.5, 1.0, 2.0)
    assert np.hypot(*path[-1]) == pytest.approx(2)
    assert math.atan2(path[-1, 1], path[-1, 0]) == pytest.approx(3.5 - math.tau)
