import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.picture.camera import Camera, Rectangle, Stage, place_camera, round_length, round_up

metres = st.floats(-10, 10)
sizes = st.floats(1e-4, 10)


@given(st.floats(1.0, 1e5), metres, metres, st.floats(-1000, 1000), st.floats(-1000, 1000),
       st.lists(st.tuples(metres, metres), min_size=1, max_size=5))
def test_pixels_and_back(scale, cx, cy, px, py, points):
    camera = Camera(scale, (cx, cy), (px, py))
    points = np.array(points)
    back = camera.to_world(camera.to_pixels(points))
    # rounding: pixels of up to 1e6 + 1e3 carry 1e6 eps, divided by the scale again
    assert np.abs(back - points).max() <= 8 * np.finfo(float).eps * (20 + 1000 / scale)


@given(metres, metres, sizes, sizes, st.integers(64, 2000), st.integers(64, 2000))
def test_fitted_box_lies_on_the_stage_and_touches_its_margin(x, y, w, h, width, height):
    stage = Stage(0, 30, width, height)
    camera = place_camera(Rectangle(x, y, x + w, y + h), stage)
    (left, bottom), (right, top) = camera.to_pixels(np.array([[x, y], [x + w, y + h]]))
    margins = [left / width, 1 - right / width, (top - 30) / height,
               1 - (bottom - 30) / height]
    assert min(margins) == pytest.approx(0.04, abs=1e-6)


def test_y_runs_up_and_aspect_is_equal():
    camera = place_camera(Rectangle(0, 0, 2, 1), Stage(0, 0, 400, 400))
    origin, right, up = camera.to_pixels(np.array([[0, 0], [1, 0], [0, 1.0]]))
    assert right[0] - origin[0] == pytest.approx(origin[1] - up[1])
    assert up[1] < origin[1]


def test_box_leaves_out_what_is_not_finite():
    box = Rectangle.around(np.array([[0, 0], [np.nan, 9], [1, 2], [np.inf, 0]]))
    assert box == Rectangle(0, 0, 1, 2)
    assert Rectangle.around(np.zeros((0, 2))) == Rectangle(0, 0, 0, 0)


@given(st.floats(1e-9, 1e9))
def test_round_length_is_round_and_not_above(largest):
    length = round_length(largest)
    assert length <= largest * (1 + 1e-8)
    assert largest < 2.5 * length * (1 + 1e-8)
    digit = length / 10 ** np.floor(np.log10(length) + 1e-9)
    assert min(abs(digit - d) for d in (1, 2, 5)) < 1e-6


@pytest.mark.parametrize(("value", "expected"), [(15, 15), (15.1, 20), (3.75, 4), (0.9, 1),
                                                 (0.83, 1), (0.0, 1), (5e-324, 1),
                                                 (1.4e308, 1.5e308)])
def test_round_up(value, expected):
    assert round_up(value) == pytest.approx(expected)
