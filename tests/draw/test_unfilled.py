"""Bodies without a fill: what lies behind is seen, and the outline of all their shapes."""


import numpy as np
import pytest

from sandbox.picture.elements.bodies import bare_outlines
from sandbox.scene.bodies import Body
from sandbox.scene.mechanism import Mechanism
from tests.draw.painted import frames_of

from .conftest import recording

BOX = {"type": "box", "size": [0.2, 0.1]}
ELL = {"type": "polygon", "points": [
    [-0.1, -0.05], [0.1, -0.05], [0.1, 0.05], [0, 0.05], [0, 0.15], [-0.1, 0.15]]}


def length(shapes):
    body = Body.model_validate({"name": "b", "mass": 1, "shapes": shapes})
    return sum(np.hypot(*np.diff(line, axis=0).T).sum()
               for line in bare_outlines(body.shapes, 1e-6, turns=False))


@pytest.mark.parametrize(("shapes", "around"), [
    ([BOX], 0.6), ([ELL], 0.8),
    # beside each other, with a seam
    ([BOX, {**BOX, "at": [0.2, 0]}], 1.0),
    # apart; one in the other
    ([BOX, {**BOX, "at": [0.5, 0]}], 1.2), ([BOX, {"type": "box", "size": [0.1, 0.05]}], 0.9),
    # two discs whose centres are a radius apart: of either two thirds are seen
    ([{"type": "circle", "radius": 0.1}, {"type": "circle", "radius": 0.1, "at": [0.1, 0]}],
     2 * 2 / 3 * 2 * np.pi * 0.1)])
def test_the_outline_is_as_long_as_the_outline_of_all(shapes, around):
    assert length(shapes) == pytest.approx(around, rel=2e-3)


def run(fill):
    mechanism = Mechanism.model_validate({
        "bodies": [{"name": "behind", "motion": "fixed", "colour": "#ff0000", "plane": -1,
                    "shapes": [{"type": "box", "size": [1, 1]}]},
                   {"name": "b", "mass": 1, "fill": fill, "shapes": [BOX]}],
        "view": {"centre": [0, 0], "width": 0.4, "size": [400, 300]}})
    return recording(mechanism, np.array([0.0]), np.zeros((1, 2, 3)))


@pytest.mark.parametrize("fill", [True, False])
def test_what_lies_behind_is_seen(fill):
    renderer = frames_of(run(fill))
    picture = renderer.draw(0.0).astype(int)
    camera = renderer.picture.camera
    x, y = np.round(camera.to_pixels(np.array([[0.0, 0.0], [0.1, 0.0]]))).astype(int).T
    near = picture[y[0] - 9:y[0] + 10, x[0] - 9:x[0] + 10]
    assert (near == (255, 0, 0)).all(axis=2).any() != fill
    assert picture[y[1], x[1] - 1:x[1] + 2].sum(axis=1).min() < 500
