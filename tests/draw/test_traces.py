"""Ways of points: where they went, as far as they have come, whatever they cross."""

import numpy as np
import pytest

from sandbox.picture.bounds import body_box
from sandbox.picture.palette import TRACE
from sandbox.scene.mechanism import Mechanism
from tests.draw.painted import frames_of

from .conftest import recording

RADIUS = 0.04


def turning(turns=1.0, samples=101, traces=({"body": "arm", "at": [RADIUS, 0]},), **view):
    """An arm that turns about the middle, evenly, once in a second for each of ``turns``."""
    time = np.linspace(0, 1, samples)
    pose = np.zeros((samples, 1, 3))
    pose[:, 0, 2] = 2 * np.pi * turns * time
    return recording(Mechanism.model_validate({
        "bodies": [{"name": "arm", "mass": 1, "shapes": [{"type": "circle", "radius": 0.005}]}],
        "view": {"centre": [0, 0], "width": 0.12, "traces": list(traces), **view}}), time, pose)


def green(run, t, at):
    """Whether places [k, 2] of the world show the trace's colour at ``t``."""
    drawn = frames_of(run, size=(480, 480))
    picture = drawn.draw(t).astype(int)
    found = []
    for x, y in drawn.picture.camera.to_pixels(np.asarray(at, dtype=float)):
        near = picture[int(y) - 2:int(y) + 3, int(x) - 2:int(x) + 3].reshape(-1, 3)
        found.append(bool((np.abs(near - TRACE).max(axis=1) < 40).any()))
    return found


def on_circle(*degrees):
    angle = np.radians(degrees)
    return RADIUS * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def test_it_is_drawn_as_far_as_the_point_has_come():
    places = on_circle(30, 80, 130, 200, 300)
    assert green(turning(), 0.25, places) == [True, True, False, False, False]
    assert green(turning(), 1.0, places) == [True] * 5


def test_a_way_gone_twice_is_as_one_gone_once():
    """One outline around both would have its inside out."""
    places = on_circle(*range(5, 360, 15))
    assert all(green(turning(turns=2.0), 1.0, places))
    assert all(green(turning(turns=3.5), 1.0, places))


def test_the_picture_has_room_for_it():
    view = {"centre": None, "width": None}
    far = turning(traces=[{"body": "arm", "at": [0.5, 0]}], **view)
    assert body_box(far).width == pytest.approx(1.0, rel=0.01)
    assert body_box(turning(traces=(), **view)).width < 0.02
