"""The shipped scenes are found by name, in a checkout as in a wheel."""

import json
from pathlib import Path

import pytest

import sandbox
from sandbox.errors import SceneError
from sandbox.scene.library import find_scene, folder_of, shipped_scenes, shipped_studies, wholes


def test_every_scene_says_what_it_is_and_what_it_expects():
    for path in shipped_scenes().values():
        scene = json.loads(path.read_text(encoding="utf-8"))
        assert (path.parent / scene["$schema"]).resolve().is_file()
        assert scene["title"]
        assert scene["about"]
        assert scene["expect"]
        assert all(expect.get("because") for expect in scene["expect"])


def test_no_two_folders_share_a_name():
    folder = shipped_scenes()["adaptive_grasp"].parent
    names = [path.stem for path in folder.rglob("*.json")]
    assert len(set(names)) == len(names)
    # the schema is no scene
    assert len(shipped_scenes()) + len(shipped_studies()) == len(names) - 1


def test_wholes_are_what_nothing_includes():
    hands = wholes("hands")
    assert {"four_finger_opposed", "prosthesis", "objects"} <= set(hands)
    assert not {"digit", "thumb", "shelf", "object_l", "object_bottle"} & set(hands)
    assert "slider_crank" in wholes("mechanisms")


def test_unknown_scene_gets_a_near_miss():
    with pytest.raises(SceneError) as caught:
        find_scene("adaptive_grsap")
    (problem,) = caught.value.problems
    assert problem.hint == "'adaptive_grasp'"
    assert "'approach'" in problem.allowed


def test_a_directory_does_not_hide_a_shipped_scene(tmp_path, monkeypatch):
    (tmp_path / "adaptive_grasp").mkdir()
    monkeypatch.chdir(tmp_path)
    assert find_scene("adaptive_grasp").is_file()


@pytest.mark.parametrize("name", ["x" * 5000, "a\0b", "", "no/such/place.json"])
def test_names_that_no_file_can_have(name):
    with pytest.raises(SceneError):
        find_scene(name)


def test_scenes_travel_inside_the_package(tmp_path, monkeypatch):
    package = tmp_path / "sandbox"
    (package / "_scenes").mkdir(parents=True)
    (package / "_scenes" / "one.json").write_text("{}")
    (package / "_scenes" / "scene.schema.json").write_text("{}")
    (package / "_scenes" / "more").mkdir()
    (package / "_scenes" / "more" / "another.json").write_text("{}")
    monkeypatch.setattr(sandbox, "__path__", [str(package)])
    monkeypatch.setattr("sandbox.scene.library.files", lambda name: Path(package))
    assert shipped_scenes() == {"one": package / "_scenes" / "one.json",
                                "another": package / "_scenes" / "more" / "another.json"}
    assert [folder_of(path) for path in shipped_scenes().values()] == ["", "more"]
