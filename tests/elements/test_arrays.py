"""The tables of arrays and of quantity names are those of recordings."""

from __future__ import annotations

import pytest

from sandbox.elements.arrays import (
    MEAN,
    METERS,
    PER_SAMPLE,
    row_bytes,
)
from sandbox.elements.quantities import QUANTITIES
from sandbox.engine.simulate import simulate
from sandbox.errors import SceneError
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene


@pytest.mark.parametrize("scene", ["adaptive_grasp", "finger_joint_locks", "rope_differential"])
def test_bytes_of_a_sample_are_those_of_a_recording(scene):
    mechanism = expand(load_scene(scene, overrides={"run.duration": 0.005}))
    run = simulate(mechanism)
    kept = sum(array.nbytes for key, array in run.arrays.items()
               if len(array) == len(run) and "_contact" not in f"_{key}" and key != METERS
               and key not in MEAN)
    assert len(run) not in (len(mechanism.bodies), len(mechanism.tendons))
    assert row_bytes(mechanism, PER_SAMPLE) * len(run) == kept


OWNERS = {"body": "disc", "joint": "hinge", "spring": "coil", "tendon": "cord", "drive": "pull",
          "group": "hand"}


def scene(extra):
    def bar(name):
        return {"name": name, "mass": 1, "inertia": 1}

    return {
        "bodies": [bar("disc"), bar("arm"), bar(extra)],
        "joints": [{"type": "pin", "name": "hinge", "a": "disc", "b": "arm", "on_a": [0, 0]}],
        "springs": [{"type": "rotary", "name": "coil", "joint": "hinge", "stiffness": 1}],
        "tendons": [{"name": "cord", "guides": [{"body": "disc"}, {"body": "arm", "at": [1, 0]}]}],
        "drives": [{"type": "pull", "name": "pull", "tendon": "cord", "value": 1}],
        "groups": [{"name": "hand", "kind": "finger", "bodies": ["disc"]}],
    }


@pytest.mark.parametrize("element", OWNERS)
def test_no_element_may_be_called_like_a_quantity_of_another(element):
    for quantity in QUANTITIES[element]:
        name = f"{OWNERS[element]}.{quantity}"
        with pytest.raises(SceneError, match="also means the quantity") as refused:
            load_scene(scene(name))
        assert len(refused.value.problems) == 1, name
