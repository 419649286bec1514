"""What is changed in a scene from outside measures what it measured."""

import pytest

from sandbox.errors import SceneError
from sandbox.scene.read.load import load_scene

SCENE = {"name": "two", "parameters": {"r": "20 mm", "k": 3, "twice": "=2 * r"},
         "bodies": [{"name": "disc", "mass": 1, "shapes": [{"type": "circle", "radius": "=r"}]}]}


@pytest.mark.parametrize("wrong", ["3 kg", "2 N/m", "10 deg"])
def test_a_parameter_of_another_dimension_is_told(wrong):
    with pytest.raises(SceneError, match=r"unit of .*, and 'r' is in 'mm'.*Allowed: m, dm, cm"):
        load_scene(SCENE, overrides={"parameters.r": wrong})


@pytest.mark.parametrize(("path", "value"), [
    ("parameters.r", "1 in"), ("parameters.r", 0.03), ("parameters.r", "=0.01 * k"),
    ("parameters.k", "4 N"), ("parameters.twice", "4 N")])
def test_without_a_unit_before_or_now_any_is_taken(path, value):
    assert load_scene(SCENE, overrides={path: value})
