"""Pictures of what is far larger than they are: made in a moment, and right where they are seen."""

from __future__ import annotations

import numpy as np
import pygame
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.picture.bounds import Rectangle, place_camera
from sandbox.picture.frames import new_surface
from sandbox.picture.geometry import large_circle
from sandbox.scene.mechanism import Mechanism

from .conftest import frames_of, recording

SIZE = (160, 120)
RED = (255, 0, 0)
EDGES = (-160, -120, 320, 240)
CM = {"centre": [0, 0], "width": 0.01, "size": list(SIZE)}


def drawn(shape, *, view=None, title="", at=(0.0, 0.0), force=(0.0, 1.0), show=(), **more):
    """The picture of a body with one shape and a contact force, and these layers."""
    mechanism = Mechanism.model_validate({
        "name": "large", "title": title,
        "view": {**(CM if view is None else view), "show": list(show)},
        "bodies": [{"name": "body", "mass": 1, "shapes": [shape]},
                   {"name": "floor", "motion": "fixed", "shapes": [shape]}], **more})
    pose = np.zeros((3, 2, 3))
    pose[:, :, :2] = at
    run = recording(
        mechanism, np.array([0.0, 0.1, 0.2]), pose, contact_sample=np.array([1]),
        contact_body=np.array([0]), contact_other=np.array([1]),
        contact_point=np.zeros((1, 2)), contact_force=np.array([force]),
        contact_normal=np.array([[0.0, 1.0]]), contact_gap=np.zeros(1),
        contact_merged=np.array([2.0]), body_velocity=pose[:, ::-1], body_acceleration=pose)
    renderer = frames_of(run)
    return [renderer.draw(t).copy() for t in (0.0, 0.1, 0.2)][1]


FAR = 40 * max(SIZE)
"""Coordinates that cost next to nothing [pixels]: circles are drawn up to 6 pictures across."""
CIRCLE = {"type": "circle", "radius": 1000}
SMALL = {"type": "circle", "radius": 0.001}


@pytest.fixture
def reached(monkeypatch):
    """The largest number of every shape that pygame draws: it walks all of its pixels."""
    found = []

    def watched(draw):
        def watch(surface, colour, *where):
            found.append(max(np.abs(np.asarray(part, dtype=float)).max() for part in where))
            return draw(surface, colour, *where)
        return watch

    for name in ("line", "lines", "polygon", "circle", "rect"):
        monkeypatch.setattr(pygame.draw, name, watched(getattr(pygame.draw, name)))
    return found


@pytest.mark.parametrize(("shape", "options"), [
    (CIRCLE, {}), (CIRCLE, {"at": (1e9, 0.0)}),
    (SMALL, {"force": (1e300, 1e300), "view": {**CM, "force_scale": 1e3}}),
    (SMALL, {"at": (1e300, -1e300)}), (SMALL, {"at": (np.nan, np.nan)}),
    ({"type": "box", "size": [1, 1e6]}, {"view": {"size": list(SIZE)}}),
    ({"type": "capsule", "start": [-1e6, 0], "end": [1e6, 1], "radius": 1e3}, {}),
    (SMALL, {"title": "W" * 20_000 + "\u0301\x00\u200b"}),
])
@pytest.mark.filterwarnings("error")
def test_what_is_out_of_sight_is_cut_before_it_is_drawn(shape, options, reached):
    drawn(shape, **options, show=["all"])
    assert 0 < max(reached) <= FAR


@pytest.mark.parametrize(("angle", "radius"), [(0.0, 5e3), (0.7, 1e6), (-1.3, 1e9)])
def test_a_large_circle_is_where_its_rim_is(angle, radius):
    """Its rim passes the middle of the picture: one side is inside, the other is not."""
    surface = new_surface(*SIZE)
    way = np.array([np.cos(angle), np.sin(angle)])
    middle = np.array(SIZE) / 2
    pygame.draw.polygon(surface, RED, large_circle(tuple(middle - radius * way), radius, EDGES))
    for step in (3, 20, 50):
        inside, outside = (tuple((middle + sign * step * way).round().astype(int))
                           for sign in (-1, 1))
        assert surface.get_at(inside)[:3] == RED
        assert surface.get_at(outside)[:3] != RED


metres = st.floats(-10, 10)
sizes = st.floats(1e-4, 10)


@given(metres, metres, sizes, sizes, st.integers(64, 2000), st.integers(64, 2000))
def test_fitted_box_lies_on_the_stage_and_touches_its_margin(x, y, w, h, width, height):
    stage = Rectangle(0, 30, width, 30 + height)
    camera = place_camera(Rectangle(x, y, x + w, y + h), stage)
    (left, bottom), (right, top) = camera.to_pixels(np.array([[x, y], [x + w, y + h]]))
    margins = [left / width, 1 - right / width, (top - 30) / height, 1 - (bottom - 30) / height]
    assert min(margins) == pytest.approx(0.04, abs=1e-6)
