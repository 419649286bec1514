"""check, expand, schema, list, render, completion, --version."""

from __future__ import annotations

import dataclasses
import json

import click
import pytest

import sandbox as package
from sandbox.cli.entry import COMMANDS, commands
from sandbox.cli.options import LIMITS
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits


def test_check_of_good_scenes(sandbox, scene):
    said = sandbox("check", scene(), scene())
    assert (said.code, said.err) == (0, "")
    assert said.out.count(": ok") == 2


def test_check_and_run_say_the_same_with_the_same_code(sandbox, scene):
    joint = {"type": "rope", "name": "rope", "a": "floor", "b": "ball", "longest": 0.001}
    path = scene(joints=[joint], expect=[])
    looked, ran = sandbox("check", path), sandbox("run", path, "--no-render")
    assert (looked.code, ran.code) == (0, 0)
    told = ": warning: $.joints[0]: rope: not assembled at t = 0"
    assert told in looked.err
    assert told in ran.err
    assert sandbox("check", path, "--strict").code == 2


def test_check_in_json(sandbox, scene):
    said = sandbox("check", scene(run={"duration": 0.1, "step": 3e-4}), "nothere.json", "--json")
    result = json.loads(said.out)
    good, bad = result["scenes"]
    assert (said.code, result["exit_code"]) == (2, 2)
    (found,) = good["findings"]
    assert (good["ok"], found["severity"]) == (True, "warning")
    assert (found["element"], found["path"], found["line"]) == ("run", "$.run", 1)
    assert found["file"].endswith("ball.json")
    assert bad["ok"] is False
    assert len(bad["errors"]) == 1


def test_expand_prints_a_scene_that_expands_to_itself(sandbox, tmp_path):
    said = sandbox("expand", "single_finger")
    assert said.code == 0, said.err
    path = tmp_path / "plain.json"
    path.write_text(said.out)
    assert "finger.proximal" in said.out
    assert "parts" not in json.loads(said.out)
    assert sandbox("expand", path).out == said.out


def test_schema_goes_to_stdout_or_a_file(sandbox, tmp_path):
    said = sandbox("schema")
    assert said.code == 0, said.err
    assert "bodies" in json.loads(said.out)["properties"]
    assert sandbox("schema", "--out", tmp_path / "s.json").out == ""
    assert (tmp_path / "s.json").read_text() == said.out
    assert sandbox("schema", "--out", tmp_path / "made" / "s.json").code == 0
    failed = sandbox("schema", "--out", tmp_path / "s.json" / "s.json")
    assert failed.code == 2
    assert "s.json" in failed.err


def test_list_in_json(sandbox):
    listed = json.loads(sandbox("list", "--json").out)["scenes"]
    assert [entry["name"] for entry in listed] == list(shipped_scenes())
    folders = {entry["name"]: entry["folder"] for entry in listed}
    assert folders["adaptive_grasp"] == ""
    assert folders["slider_crank"] == "mechanisms"


def test_render_draws_a_saved_run_in_another_size(sandbox, scene, tmp_path):
    from PIL import Image

    assert sandbox("run", scene(), "--no-render", "--out", "saved").code == 0
    said = sandbox("render", "saved", "--out", tmp_path / "x.gif", "--size", "320x200",
                   "--fps", 50, "--speed", 0.5, "--centre", "0,0.01", "--width", 0.1)
    assert said.code == 0, said.err
    with Image.open(tmp_path / "x.gif") as image:
        assert image.size == (320, 200)
    assert sandbox("render", "saved").code == 0
    assert (tmp_path / "saved" / "animation.gif").is_file()


@pytest.mark.parametrize(("words", "told"), [
    (["nowhere"], "nowhere"),
    ([".", "--size", "800"], "800x600"),
    ([".", "--centre", "1"], "0.1,-0.02"),
    ([".", "--fps", "30"], "25"),
    ([".", "--speed", "0"], "--speed"),
    ([".", "--show", "velocty"], "did you mean 'velocity'"),
    (["."], "there is no run"),
])
def test_render_refuses(sandbox, words, told):
    said = sandbox("render", *words)
    assert said.code == 2
    assert told in said.err


def test_a_shell_completes_commands(sandbox, monkeypatch, capfd):
    monkeypatch.setenv("_SANDBOX_COMPLETE", "bash_complete")
    monkeypatch.setenv("COMP_WORDS", "sandbox re")
    monkeypatch.setenv("COMP_CWORD", "1")
    with pytest.raises(SystemExit):
        sandbox()
    assert capfd.readouterr().out.split() == ["plain,render", "plain,report"]


def test_version(sandbox):
    said = sandbox("--version")
    assert (said.code, said.out) == (0, f"sandbox {package.__version__}\n")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_helps(sandbox, command):
    said = sandbox(command, "--help")
    assert said.code == 0
    assert said.out.startswith(f"Usage: sandbox {command}")
    assert command in sandbox("--help").out


def test_every_limit_is_an_option():
    assert list(LIMITS) == [field.name for field in dataclasses.fields(Limits)]


def test_no_two_options_of_a_command_share_a_parameter():
    """``--max-frames 100`` once set ``--frames``, whose name click gave to both."""
    for name in COMMANDS:
        command = commands.get_command(click.Context(commands), name)
        found = [parameter.name for parameter in command.params]
        assert len(set(found)) == len(found), name


def test_frames_can_be_asked_for_beside_their_limit(sandbox, scene, tmp_path):
    path = scene(view={"size": [64, 64]})
    said = sandbox("run", path, "--frames", "--max-frames", 100, "--no-audit")
    assert said.code == 0, said.err
    assert (tmp_path / "renders" / "ball" / "frames" / "frame_00000.png").is_file()
    said = sandbox("run", path, "--frames", "--max-frames", 1)
    assert said.code == 2
    assert "--max-frames" in said.err


def test_check_tells_what_a_run_would_take_and_both_refuse_what_is_too_much(sandbox, scene):
    path = scene()
    said = sandbox("check", path)
    assert f"{path}: would take about 0.01 s and " in said.out
    assert said.out.endswith("(100 steps, 50 samples)\n")
    (report,) = json.loads(sandbox("check", path, "--json").out)["scenes"]
    assert report["estimate"]["steps"] == 100
    assert report["estimate"]["contacts"] == 1
    long = ["--set", "run.duration=800 s", "--set", "run.sample_rate=10", "--max-seconds", "1"]
    looked, ran = sandbox("check", path, *long), sandbox("run", path, *long)
    assert looked.code == ran.code == 2
    assert "(the limit 'seconds', raised by --max-seconds)" in looked.err
    assert looked.err == ran.err


@pytest.mark.parametrize("words", [
    ["run", "single_finger"], ["render", "x"], ["export", "single_finger"], ["schema"],
    ["verify"], ["plot", "x"], ["compare", "x", "y"], ["bounds", "x"]])
@pytest.mark.parametrize("empty", ["", "  "])
def test_no_path_is_not_the_working_directory(sandbox, words, empty):
    said = sandbox(*words, "--out", empty)
    assert said.code == 2
    assert said.err.splitlines()[-1] == ("error: Invalid value for '--out': the path is empty; "
                                         "'.' is the directory that you are in.")


def test_new_copies_a_scene_with_what_it_includes(sandbox, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = sandbox("new", "gripper_mirrored")
    assert (said.code, sorted(path.name for path in tmp_path.iterdir())) == (
        0, ["gripper_mirrored.json", "jaw.json"])
    assert sandbox("check", "gripper_mirrored.json").code == 0
    again = sandbox("new", "gripper_mirrored")
    assert again.code == 2
    assert "exists already and is not overwritten" in again.err


def test_new_under_another_name_and_in_another_place(sandbox, tmp_path):
    shipped = shipped_scenes()
    assert sandbox("new", "gripper_mirrored", "--out", tmp_path / "a" / "mine.json").code == 0
    assert (tmp_path / "a" / "mine.json").read_bytes() == shipped["gripper_mirrored"].read_bytes()
    # what is included is there already, as it is shipped
    assert sandbox("new", "gripper_mirrored", "--out", tmp_path / "a").code == 0
    (tmp_path / "a" / "jaw.json").write_text("{}")
    assert sandbox("new", "gripper_mirrored", "--out", tmp_path / "a" / "third.json").code == 2
    assert not (tmp_path / "a" / "third.json").exists()
    assert (tmp_path / "a" / "jaw.json").read_text() == "{}"


def test_new_offers_a_near_miss(sandbox, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = sandbox("new", "griper_mirrored")
    assert said.code == 2
    assert "Did you mean 'gripper_mirrored'?" in said.err
    assert not list(tmp_path.iterdir())
