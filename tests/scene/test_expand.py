"""Expansion: parts become plain elements; what is printed reads back as the same mechanism."""


import pytest

from sandbox.errors import SceneError
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand, to_json
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene
from tests.scene.test_parts import SET_G


def scene(*parts, **more):
    return Scene.model_validate({"parts": list(parts), **more})


def fingers(count):
    return [SET_G | {"name": f"f{i + 1}", "at": [0, 0.13 * i]} for i in range(count)]


def tree(*pulls, **more):
    return {"type": "rocker_tree", "name": "tree", "pulls": list(pulls), **more}


def problems(*parts, **more):
    with pytest.raises(SceneError) as caught:
        expand(scene(*parts, **more))
    return {problem.path: problem for problem in caught.value.problems}


@pytest.mark.parametrize(("named", "pulled"), [("tree", "tree.tendon"), ("f3", "f3.tendon"),
                                               ("f3.tendon", "f3.tendon")])
def test_pull_drive_may_name_a_part(named, pulled):
    drive = {"type": "pull", "name": "actuator", "tendon": named, "value": 5}
    mechanism = expand(scene(*fingers(3), tree("f1", "f2"), drives=[drive]))
    assert mechanism.drives[0].tendon == pulled


def test_of_what_hangs_on_a_broken_part_nothing_is_told():
    """The cause alone: neither the tree that pulls the broken finger nor the tree that pulls it."""
    broken = SET_G | {"name": "g", "on": "plam"}
    trees = tree("f1", "g"), tree("tree", "f2") | {"name": "two"}
    assert set(problems(*fingers(2), broken, *trees)) == {"$.parts[2].on"}
    within = {"type": "assembly", "name": "hand", "parts": [broken]}
    assert set(problems(*fingers(1), within, tree("f1", "hand.g"))) == {"$.parts[1].parts[0].on"}
    assert set(problems(*fingers(1), broken, tree("f1", "g.tendon", "gg"))) == {
        "$.parts[1].on", "$.parts[2].pulls[2]"}


def test_a_finger_cannot_be_pulled_twice():
    found = problems(*fingers(3), tree("f1", "f2"), tree("f2.tendon", "f3") | {"name": "two"})
    assert list(found) == ["$.parts[4].pulls[0]"]
    assert "already" in found["$.parts[4].pulls[0]"].message


@pytest.mark.parametrize("name", [
    pytest.param(name, marks=[pytest.mark.nightly] * (i % 12 > 0))
    for i, name in enumerate(sorted(shipped_scenes()))])
def test_printed_mechanism_reads_back_equal(name, tmp_path):
    mechanism = expand(load_scene(shipped_scenes()[name]))
    printed = tmp_path / f"{name}.json"
    printed.write_text(to_json(mechanism), encoding="utf-8")
    assert expand(load_scene(printed)) == mechanism
