"""The keys like, repeat and include: results, places of problems, limits."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import pytest

from sandbox.errors import Problem, SceneError
from sandbox.scene.expand import expand
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import load_scene

POINT = {"mass": 1, "inertia": 1}


def problems(scene: Any, **more: Any) -> list[Problem]:
    with pytest.raises(SceneError) as caught:
        load_scene(scene, **more)
    return caught.value.problems


def test_of_all_copies_the_first_wrong_one_is_told():
    found = problems({"bodies": [
        {**POINT, "name": "b{i}", "repeat": 9, "mass": "=1 - i", "at": [0, "3 kg"]}]})
    assert {(each.path, each.message[-11:]) for each in found} == {
        ("$.bodies[0].mass", "(for i = 1)"), ("$.bodies[0].at[1]", "(for i = 0)")}


def test_what_is_written_out_counts_as_bytes():
    found = problems({"bodies": [{**POINT, "name": "b{i}", "repeat": 100, "shapes": [
        {"type": "circle", "radius": 1}] * 100}]}, limits=Limits(file_bytes=100_000))
    assert [e.path for e in found] == ["$.bodies[0]"]
    assert "'file_bytes'" in found[0].message


def test_templates_that_double_forty_times():
    templates = {f"t{k}": {"type": "assembly", "parts": [
        {"like": f"t{k + 1}", "name": name} for name in "ab"]} for k in range(40)}
    found = problems({"templates": {**templates, "t40": {"type": "assembly"}},
                      "parts": [{"like": "t0", "name": "p"}]})
    assert len(found) == 1
    assert "nesting" in found[0].message


class TestInclude:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        self.write(tmp_path / "arm.json", {
            "title": "An arm", "gravity": [0, -1], "parameters": {"length": "10 mm"},
            "templates": {"b": POINT},
            "bodies": [{"like": "b", "name": "end", "at": ["=length", 0]}],
            "expect": [{"final": "end.x", "above": 5}]})
        return tmp_path

    def write(self, path: Path, data: Any) -> Path:
        path.write_text(json.dumps(data))
        return path

    def including(self, folder: Path, name: Any, **more: Any) -> Path:
        return self.write(folder / "main.json", {
            "parts": [{"name": "arm", **more, "include": name}]})

    def test_becomes_an_assembly_with_parameters(self, folder: Path):
        scene = load_scene(self.including(folder, "arm", at=[1, 0], parameters={"length": 2}))
        assert [(b.name, b.at) for b in expand(scene).bodies] == [("arm.end", (3.0, 0.0))]
        assert (scene.gravity, scene.expect, scene.title) == ((0.0, 0.0), (), "")

    def test_a_parameter_that_the_file_has_not(self, folder: Path):
        """Named as the outer one that it takes its value from, it depends on nothing of itself."""
        main = self.write(folder / "main.json", {"parameters": {"size": 2}, "parts": [
            {"name": "arm", "include": "arm", "parameters": {"size": "=size", "length": "=size"}}]})
        (problem,) = problems(main)
        assert problem.path == "$.parts[0].parameters.size"
        assert problem.message.startswith("the included scene has no parameter 'size'")
        assert problem.allowed == "'length'"

    @pytest.mark.parametrize("name", ["../arm", "/etc/passwd", "sub/arm", "..\\arm", "", "a\0b", 3])
    def test_only_scenes_of_the_folder(self, folder: Path, name: Any):
        (folder / "sub").mkdir()
        self.write(folder / "sub" / "arm.json", {})
        found = problems(self.including(folder, name))
        assert [e.path for e in found] == ["$.parts[0].include"]

    def test_no_link_out_of_the_folder(self, folder: Path):
        (folder / "away").mkdir()
        away = self.write(folder / "away" / "secret.json", {"bodies": []})
        (folder / "link.json").symlink_to(away)
        found = problems(self.including(folder, "link"))
        assert "leads out" in found[0].message
        (folder / "inner.json").symlink_to(folder / "arm.json")
        assert load_scene(self.including(folder, "inner")).parts

    @pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no pipes with names")
    def test_a_pipe_is_not_waited_for(self, folder: Path):
        os.mkfifo(folder / "pipe.json")
        assert "no file" in problems(self.including(folder, "pipe"))[0].message

    def test_a_ring_is_named(self, folder: Path):
        for one, other in (("x", "y"), ("y", "x")):
            self.write(folder / f"{one}.json", {"parts": [{"include": other, "name": "p"}]})
        found = problems(folder / "x.json")
        assert "x.json → y.json → x.json" in found[0].message
        assert Path(found[0].file).name == "y.json"

    def test_a_problem_names_both_files(self, folder: Path):
        self.write(folder / "bad.json", {"bodies": [{"name": "b", "mass": -1, "inertia": 1}]})
        main = self.including(folder, "bad")
        found = problems(main)
        assert (found[0].file, found[0].path, found[0].line) == (
            str(folder / "bad.json"), "$.bodies[0].mass", 1)
        assert f"included by {main}:1:" in found[0].message
        with pytest.raises(SceneError, match=r"bad\.json:1:.*included by .*main\.json"):
            load_scene(main)

    def test_one_that_is_no_scene_at_all(self, folder: Path):
        (folder / "broken.json").write_text('{"bodies": [}')
        found = problems(self.including(folder, "broken"))
        assert (Path(found[0].file).name, found[0].line) == ("broken.json", 1)
        self.write(folder / "list.json", [1])
        assert "a scene is an object" in problems(self.including(folder, "list"))[0].message
        self.write(folder / "odd.json", {"bodys": []})
        assert problems(self.including(folder, "odd"))[0].hint == "'bodies'"

    def test_data_without_a_file_has_no_folder(self):
        found = problems({"parts": [{"include": "arm", "name": "a"}]})
        assert "no folder" in found[0].message

    def test_all_files_together_have_one_limit(self, folder: Path):
        self.write(folder / "large.json", {"about": "x" * 1000})
        found = problems(self.including(folder, "large"), limits=Limits(file_bytes=900))
        assert "'file_bytes'" in found[0].message


def test_all_mistakes_of_an_entry_are_reported_at_once(tmp_path: Path) -> None:
    (tmp_path / "part.json").write_text(json.dumps({"no": 1, "nor": 2, "parameters": {"z": "=q"}}))
    file = tmp_path / "scene.json"
    file.write_text(json.dumps({
        "bodies": [{"name": "a{i}", "repeat": 2, "mass": "={m}", "at": ["={x}", "={y}"]}],
        "parts": [{"name": "p", "include": "part", "parameters": {"u": 1, "v": 2}}]}))
    assert sorted(problem.path for problem in problems(str(file))) == [
        "$.bodies[0].at[0]", "$.bodies[0].at[1]", "$.bodies[0].mass", "$.no", "$.nor",
        "$.parameters.z", "$.parts[0].parameters.u", "$.parts[0].parameters.v"]
