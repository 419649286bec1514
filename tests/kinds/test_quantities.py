"""The table of quantities: what is reserved, what can be read, what each kind has."""

import pytest

from sandbox.errors import SceneError
from sandbox.kinds.elements import NAMED
from sandbox.kinds.quantities import QUANTITIES, drive_quantities, joint_quantities, reserved
from sandbox.scene.read.load import load_scene

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


def test_other_names_are_free():
    assert load_scene(scene("disc.tension"))
    assert load_scene(scene("disc.normal"))


def test_the_head_of_a_quantity_is_reserved_too():
    assert "contact" in reserved("bodies")
    assert "contact.normal" in reserved("bodies")
    assert reserved("events") == frozenset()
    assert {kind for kind in NAMED if reserved(kind)} == {
        "bodies", "joints", "springs", "tendons", "lines", "valves", "loads", "drives", "groups"}


def test_what_a_kind_has():
    assert joint_quantities("rope", stops=False) == {
        "reaction": "N", "reaction_x": "N", "reaction_y": "N", "tension": "N"}
    assert list(joint_quantities("pin", stops=True))[-1] == "stop"
    assert drive_quantities("stiffness", spring="rotary") == {"value": "N m/rad"}
    assert drive_quantities("stiffness", spring="linear") == {"value": "N/m"}
    assert drive_quantities("motor") == {
        "value": "rad/s", "work": "J", "torque": "N m", "power": "W"}
