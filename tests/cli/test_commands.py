"""The group of commands, list, new, explain, options that all commands share."""

from __future__ import annotations

import json

import pytest

import sandbox as package
from sandbox.cli.commands import commands
from sandbox.cli.explain import elements
from sandbox.elements.quantities import QUANTITIES
from sandbox.scene.library import shipped_scenes


def test_help_fits_on_a_screen_and_every_command_helps(sandbox):
    output = sandbox("--help")
    assert output.code == 0
    assert sandbox() == output
    lines = output.out.splitlines()
    assert len(lines) <= 45
    for command in commands.list_commands(None):
        assert any(line.startswith(f"  {command} ") for line in lines)
        helped = sandbox(command, "--help")
        assert helped.code == 0
        assert helped.out.startswith(f"Usage: sandbox {command}")
    assert sandbox("--version").out == f"sandbox {package.__version__}\n"


@pytest.mark.parametrize(("words", "message"), [
    (["rnu"], "Did you mean 'run'?"),
    (["compare", "a", "b"], "Use 'sandbox plot RUN --with RUN'."),
    (["run", "x", "--frames"], "Use 'sandbox render RUN --out DIR'."),
    (["run", "x", "--no-rnder"], "--no-render"),
    (["check", "x", "--limit", "stesp=9"], "Did you mean 'steps'? Limits: file_bytes, "),
    (["check", "x", "--limit", "steps=many"], "steps=many is not a valid positive integer"),
    (["check"], "Missing argument 'SCENE...'"),
    (["run", "x", "--set", "run.step"], "path=value"),
    (["check", "."], "error: '.' is no scene: this is a directory."),
    (["run", "single_fingr"], "Did you mean 'single_finger'?"),
    (["new", "griper_mirrored"], "Did you mean 'gripper_mirrored'?"),
    (["explain", "motr"], "Did you mean 'motor'?"),
    (["run", "single_finger", "--set", "pull=3"], "Did you mean 'parameters.pull'?"),
    (["check", "single_finger", "--set", "parts[0].mirror=up-down"], "(a key of 'assembly')"),
    (["equilibrium", "held_disc"], "it rests until t = 0.71 s: --at sets"),
])
def test_wrong_words(sandbox, words, message):
    output = sandbox(*words)
    assert output.code == 2
    assert message in output.err


@pytest.mark.parametrize("words", [
    ["run", "single_finger"], ["render", "x"], ["export", "single_finger"], ["plot", "x"],
    ["bounds", "x"]])
def test_no_path_is_not_the_working_directory(sandbox, words):
    output = sandbox(*words, "--out", " ")
    assert output.code == 2
    assert output.err.splitlines()[-1] == ("error: Invalid value for '--out': the path is empty; "
                                         "'.' is the directory that you are in.")


def test_list_has_every_scene_by_topic(sandbox):
    output = sandbox("list").out
    listed = json.loads(sandbox("list", "--json").out)["scenes"]
    assert [entry["name"] for entry in listed] == list(shipped_scenes())
    for entry in listed:
        assert f"  {entry['name']} " in output
        assert entry["topic"] in output.splitlines()
    folders = {entry["name"]: entry["folder"] for entry in listed}
    assert (folders["adaptive_grasp"], folders["slider_crank"]) == ("", "mechanisms")


def test_new_copies_a_scene_with_what_it_includes(sandbox, tmp_path):
    output = sandbox("new", "gripper_mirrored")
    assert (output.code, sorted(path.name for path in tmp_path.iterdir())) == (
        0, ["gripper_mirrored.json", "jaw.json"])
    assert sandbox("check", "gripper_mirrored.json").code == 0
    again = sandbox("new", "gripper_mirrored")
    assert again.code == 2
    assert "exists already and is not overwritten" in again.err
    assert sandbox("new", "gripper_mirrored", "--out", "a/mine.json").code == 0
    shipped = shipped_scenes()["gripper_mirrored"]
    assert (tmp_path / "a" / "mine.json").read_bytes() == shipped.read_bytes()
    assert sandbox("new", "gripper_mirrored", "--out", "a").code == 0  # what it includes is there
    (tmp_path / "a" / "jaw.json").write_text("{}")
    assert sandbox("new", "gripper_mirrored", "--out", "a/third.json").code == 2
    assert not (tmp_path / "a" / "third.json").exists()
    assert (tmp_path / "a" / "jaw.json").read_text() == "{}"


def test_explain_has_every_element_and_quantity(sandbox):
    overview = sandbox("explain").out
    assert len(overview.splitlines()) < 90
    words = set(overview.replace(",", " ").split())
    for each in elements():
        assert each.name in words
        output = sandbox("explain", each.name).out
        assert output.startswith(f"{each.name}: ")
        assert "Fields\n" in output
    assert {name for names in QUANTITIES.values() for name in names} <= words
    assert "angle          [rad] of b against a" in sandbox("explain", "pin").out
    assert "drives.motor" in sandbox("explain", "drives").out
    finger = " ".join(sandbox("explain", "finger").out.split())
    assert "object (parts.finger.springs). Ext" in finger
    assert "list of objects (tendons.guides). F" in finger
    assert '"last TIME", or [from, to]; default [0, null]' in sandbox("explain", "expect").out
    assert "backlash is a field of joints.gear" in sandbox("explain", "backlash").out
    assert "(joint: rod, rope)" in " ".join(sandbox("explain", "tension").out.split())
    assert "recorded_bytes" in sandbox("explain", "limits").out
    assert "backlash is a field" in sandbox("explain", "play").out
    several = " ".join(sandbox("explain", "winch", "clip", "unknown-key").out.split())
    assert "winch is a shipped scene: Winch" in several
    assert "clip(x, low, high)" in several
    assert "unknown-key The element has no such key." in several
    assert "velocity" in sandbox("explain", "layers").out
    assert "A consistency check: is F = m a" in sandbox("explain", "momentum.force").out
    assert "springs.rotary" in sandbox("explain", "Torsion spring").out
