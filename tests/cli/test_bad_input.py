"""Everything a scene can be that is not a scene: exit 2, clear messages, never a traceback."""

from __future__ import annotations

import copy
import json
import re
from typing import Any

import pytest

from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status

from .conftest import BALL


def edited(*path: Any, to: Any = None, drop: bool = False) -> str:
    """The ball's scene as text, with one place changed or dropped."""
    data = copy.deepcopy(BALL)
    place: Any = data
    for key in path[:-1]:
        place = place.setdefault(key, []) if isinstance(place, dict) else place[key]
    if drop:
        del place[path[-1]]
    elif isinstance(place, list) and path[-1] == len(place):
        place.append(to)
    else:
        place[path[-1]] = to
    return json.dumps(data, indent=1)


PIN = {"type": "pin", "name": "hinge", "a": "ball", "b": "flor", "on_a": [0, 0]}
CORD = {"name": "cord", "guides": [{"body": "ball"}]}
FORCE = {"type": "force", "name": "push", "body": "ball", "direction": [1, 0]}

CASES = {
    "unknown key": (edited("gravty", to=[0, 0]), r"\$\.gravty", "gravity"),
    "missing field": (edited("bodies", 0, "name", drop=True), r"\$\.bodies\[0\]", "name"),
    "wrong type": (edited("bodies", 0, "mass", to=[1]), r"\$\.bodies\[0\]\.mass", "list"),
    "wrong unit": (edited("bodies", 0, "mass", to="3 mm"), r"\$\.bodies\[0\]\.mass", "mm"),
    "unknown body": (edited("joints", to=[PIN]), r"\$\.joints\[0\]\.b", "floor"),
    "duplicate name": (edited("bodies", 0, "name", to="floor"), r"\$\.bodies\[1\]", "floor"),
    "NaN": (edited("bodies", 0, "mass", to=float("nan")), r"mass", "finite|NaN"),
    "negative mass": (edited("bodies", 0, "mass", to=-1), r"\$\.bodies\[0\]\.mass",
                      "greater than 0"),
    "one guide": (edited("tendons", to=[CORD]), r"\$\.tendons\[0\]\.guides", "2"),
    "a step of zero": (edited("run", "step", to=0), r"\$\.run\.step", "greater than 0"),
    "a year": (edited("run", "duration", to=365 * 86400), r"\$\.run\.duration", "limit"),
    "empty file": ("", "", "empty"),
    "not an object": ("[]", r"\$", "object"),
    "truncated": (edited("run", "step", to=1e-3)[:-40], r":\d+:\d+", ""),
    "deep nesting": ("[" * 100_000, "", "nest"),
    "division by zero": (edited("bodies", 0, "mass", to="=1 / 0"), r"mass", "zero"),
    "reaching Python": (edited("bodies", 0, "mass", to="=__import__('os').getpid()"), r"mass", ""),
    "a huge power": (edited("bodies", 0, "mass", to="=9**9**9**9"), r"mass", ""),
    "dividing by zero in time": (
        edited("drives", to=[FORCE | {"value": "=1 / (t - t)"}]), r"drives\[0\]", "zero|finite"),
    "an unknown quantity": (
        edited("expect", 0, "mean", to="ball.contact.fz"), r"\$\.expect\[0\]", "contact.f"),
    "binary": (bytes(range(256)) * 20, "", ""),
    "UTF-16": ('{"title": "ü"}'.encode("utf-16"), "", ""),
}


@pytest.mark.parametrize("case", CASES)
def test_a_bad_scene_is_told_and_exits_2(sandbox, scene, tmp_path, case):
    content, place, words = CASES[case]
    said = sandbox("check", scene(content))
    assert said.code == 2
    lines = said.err.splitlines()
    assert 1 <= len(lines) <= 3, said.err
    assert all("ball.json" in line for line in lines)
    assert re.search(place, said.err), said.err
    assert re.search(words, said.err), said.err
    assert sandbox("run", scene(content)).err == said.err
    assert not (tmp_path / "renders").exists()


def test_all_problems_are_told_at_once_each_with_its_line(sandbox, scene):
    data = copy.deepcopy(BALL)
    data["gravty"] = [0, 0]
    data["bodies"][0]["mass"] = -1
    data["run"]["step"] = "1 kg"
    text = json.dumps(data, indent=1)
    said = sandbox("check", scene(text))
    assert said.code == 2
    assert len(said.err.splitlines()) == 3
    for line in said.err.splitlines():
        number = int(re.search(r"ball\.json:(\d+):\d+: \$", line)[1])
        key = re.search(r"\$\.[\w.\[\]]*?(\w+):", line)[1]
        assert f'"{key}"' in text.splitlines()[number - 1]


def test_a_file_of_a_gigabyte_is_not_read(sandbox, tmp_path):
    path = tmp_path / "huge.json"
    with path.open("wb") as file:
        file.truncate(1 << 30)
    said = sandbox("run", path)
    assert said.code == 2
    assert "huge.json" in said.err
    assert len(said.err.splitlines()) == 1


@pytest.mark.parametrize("word", ["nothere.json", "no/such/dir/scene.json", ".", "/dev/null", ""])
def test_a_file_that_is_no_scene(sandbox, word):
    said = sandbox("run", word)
    assert said.code == 2
    assert len(said.err.splitlines()) == 1


@pytest.mark.parametrize("text", ["{}", '{"gravity": [0, -9.81]}'])
@pytest.mark.parametrize("command", ["run", "check"])
def test_nothing_to_simulate(sandbox: Any, tmp_path: Any, text: str, command: str) -> None:
    (tmp_path / "x.json").write_text(text)
    said = sandbox(command, "x.json")
    assert said.code == 2
    assert "there is nothing to simulate" in said.err or "expected an object" in said.err


def on_two_floors(scene):
    """Falls on both at once, so that there are two contacts where one was to be expected."""
    ball, floor = BALL["bodies"]
    return scene(run={"duration": 3, "step": 1e-3, "sample_rate": 1000}, expect=[], bodies=[
        {**ball, "at": [0, 0.007]}, floor, {**floor, "name": "second"}])


def test_contacts_count_towards_what_may_be_recorded(sandbox, scene, tmp_path):
    """Nobody knows before how many there are: the run stops, keeps what it has, and says so."""
    path = on_two_floors(scene)
    said = sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1e6")
    assert said.code == 2
    assert "take more than 1 000 000 bytes" in said.err
    assert "--limit recorded_bytes=N" in said.err
    assert "kept 2560 samples in renders/ball, marked incomplete" in said.err
    assert not (tmp_path / "renders/ball/run.json").exists()
    run = Recording.load(tmp_path / "renders/ball")
    assert (run.info.status, len(run)) == (Status.LIMITED, 2560)
    assert sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1.6e6").code == 0
    said = sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1e6")
    assert "in renders/ball/incomplete, marked incomplete; the run that was in" in said.err
    assert Recording.load(tmp_path / "renders/ball").complete
    assert "recording would take" in sandbox("check", path, "--limit", "recorded_bytes=9e5").err
