"""Wheels of several radii on one shaft: each is drawn, and none hides another."""

import numpy as np
import pytest

from sandbox.draw.film.camera import Camera
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import ROLES, WHEEL
from sandbox.scene.mechanism import Mechanism

from .conftest import recording

MM = 1e-3
PULLEY = ROLES["pulley"].fill


def picture(circles, drums):
    """A shaft at the origin, with circles and drums of these radii [mm]; drums have a cord each."""
    run = recording(Mechanism.model_validate({
        "bodies": [
            {"name": "shaft", "mass": 1, "role": "pulley",
             "shapes": [{"type": "circle", "radius": r * MM} for r in circles],
             **({} if circles else {"inertia": 1e-5})},
            {"name": "weight", "mass": 1, "at": [0, -0.2],
             "shapes": [{"type": "circle", "radius": 0.001}]}],
        "tendons": [{"name": f"cord{r}", "guides": [
            {"body": "weight"}, {"body": "shaft", "radius": r * MM}]} for r in drums],
        "view": {"centre": [0, 0], "width": 0.12}}),
        np.zeros(1), np.array([[[0, 0, 0.0], [0, -0.2, 0]]]))
    drawn = FrameRenderer(run, size=(480, 480))
    return drawn.draw(0.0), drawn.camera


def colours(circles, drums, at):
    """Colours below the shaft's left, at these distances from its axis [mm]: off mark and cords."""
    pixels, camera = picture(circles, drums)
    assert isinstance(camera, Camera)
    found = []
    for r in at:
        x, y = camera.to_pixels(np.array([[-0.8 * r * MM, -0.6 * r * MM]]))[0]
        found.append(tuple(int(c) for c in pixels[int(y), int(x)]))
    return found


@pytest.mark.parametrize("circles", [(20, 40), (40, 20)])
def test_the_smaller_of_two_circles_lies_above_in_any_order(circles):
    """Both fills are alike, so the small one's edge tells."""
    (edge,) = colours(circles, (), (20,))
    assert edge != PULLEY
    assert colours(circles, (), (10, 30)) == [PULLEY, PULLEY]


def test_drums_beside_a_circle_are_drawn():
    """Larger ones below it, smaller ones above: what hung in the air is a drum."""
    assert colours((20,), (40, 10), (5, 15, 30)) == [WHEEL, PULLEY, WHEEL]


def test_a_drum_that_a_circle_shows_is_not_drawn_again():
    assert colours((40,), (40,), (20,)) == [PULLEY]


def test_drums_without_a_circle_are_all_seen():
    inner, between, outer = colours((), (20, 40), (10, 20, 30))
    assert inner == outer == WHEEL
    assert between != WHEEL
