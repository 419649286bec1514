"""Bodies are drawn plane by plane, whatever their role, and those that stay among them."""

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.bodies import DEEP, styles
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.palette import ROLES, mixed
from sandbox.model.compile import compile_mechanism
from sandbox.scene.mechanism import Mechanism

from .conftest import recording


def seen(*bodies):
    """The fill that is seen where bodies lie above one another; each is role, plane, motion."""
    run = recording(Mechanism.model_validate({
        "bodies": [{"name": f"b{i}", "role": role, "plane": plane, "motion": motion,
                    **({} if motion == "fixed" else {"mass": 1}),
                    "shapes": [{"type": "box", "size": [0.04, 0.04]}]}
                   for i, (role, plane, motion) in enumerate(bodies)],
        "view": {"centre": [0, 0], "width": 0.12}}),
        np.zeros(1), np.zeros((1, len(bodies), 3)))
    drawn = FrameRenderer(run, size=(480, 480))
    x, y = drawn.camera.to_pixels(np.array([[0.003, 0.005]]))[0]
    pixels = drawn.draw(0.0)[int(y) - 8:int(y) + 8, int(x) - 8:int(x) + 8].reshape(-1, 3)
    return [role for role, style in ROLES.items() if (pixels == style.fill).all(axis=1).any()]


@pytest.mark.parametrize("motion", ["dynamic", "fixed"])
def test_the_higher_plane_is_in_front(motion):
    assert seen(("object", 1, motion), ("phalanx", 0, "dynamic")) == ["object"]
    assert seen(("phalanx", 0, "dynamic"), ("object", 1, motion)) == ["object"]


def test_in_one_plane_the_role_decides_as_ever():
    assert seen(("phalanx", 0, "dynamic"), ("object", 0, "dynamic")) == ["phalanx"]
    assert seen(("phalanx", 0, "dynamic"), ("palm", 0, "fixed")) == ["phalanx"]


def test_what_meets_all_is_behind():
    assert seen(("object", -5, "dynamic"), ("phalanx", "all", "dynamic")) == ["object"]


def test_the_lower_of_a_role_are_darker():
    ball = {"mass": 1, "role": "phalanx", "shapes": [{"type": "circle", "radius": 0.01}]}
    bodies = [{**ball, "name": f"b{k}", "at": [0.1 * k, 0], "plane": plane}
              for k, plane in enumerate([0, 2, 7, "all"])]
    bodies += [{**ball, "name": "alone", "at": [1, 0], "role": "link", "plane": 5},
               {**ball, "name": "stays", "at": [2, 0], "motion": "fixed", "plane": -3}]
    model = compile_mechanism(sandbox.expand(sandbox.load_scene({"bodies": bodies})))
    low, middle, top, everywhere, alone, stays = styles(model)
    assert top == everywhere == stays == ROLES["phalanx"]
    assert alone == ROLES["link"]
    assert {style.edge for style in (low, middle, top)} == {ROLES["phalanx"].edge}
    assert sum(low.fill) < sum(middle.fill) < sum(top.fill)
    assert low.fill == mixed(ROLES["phalanx"].fill, ROLES["phalanx"].edge, DEEP)
