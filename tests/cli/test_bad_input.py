"""Everything a scene can be that is not a scene: exit 2, clear messages, never a traceback."""

from __future__ import annotations

import json
import re

import pytest

from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Status

from .conftest import BALL


@pytest.mark.parametrize(("content", "words"), [
    ('{"gravity": [0, -9.81]}', "there is nothing to simulate"),
    (json.dumps(BALL, indent=1)[:-40], r":\d+:\d+"), (bytes(range(256)) * 20, "")])
def test_a_bad_scene_exits_2_with_a_message(sandbox, scene, tmp_path, content, words):
    output = sandbox("check", scene(content))
    assert output.code == 2
    lines = output.err.splitlines()
    assert 1 <= len(lines) <= 3, output.err
    assert all("ball.json" in line for line in lines)
    assert re.search(words, output.err), output.err
    assert sandbox("run", scene(content)).err == output.err
    assert not (tmp_path / "renders").exists()


@pytest.mark.parametrize("word", ["nothere.json", "no/such/dir/scene.json", ".", "/dev/null", ""])
def test_a_file_that_is_no_scene(sandbox, word):
    output = sandbox("run", word)
    assert output.code == 2
    assert len(output.err.splitlines()) == 1


def test_contacts_count_towards_what_may_be_recorded(sandbox, scene, tmp_path):
    """Nobody knows before how many there are: the run stops, keeps what it has, and says so."""
    ball, floor = BALL["bodies"]
    path = scene(run={"duration": 3, "step": 1e-3, "sample_rate": 1000}, expect=[], bodies=[
        {**ball, "at": [0, 0.007]}, floor, {**floor, "name": "second"}])  # two contacts, not one
    output = sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1e6")
    assert output.code == 2
    assert "take more than 1 000 000 bytes" in output.err
    assert "--limit recorded_bytes=N" in output.err
    assert "kept 2560 samples in renders/ball, marked incomplete" in output.err
    assert not (tmp_path / "renders/ball/run.json").exists()
    run = Recording.load(tmp_path / "renders/ball")
    assert (run.info.status, len(run)) == (Status.LIMITED, 2560)
    assert sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1.6e6").code == 0
    output = sandbox("run", path, "--no-render", "--limit", "recorded_bytes=1e6")
    assert "in renders/ball/incomplete, marked incomplete; the run that was in" in output.err
    assert Recording.load(tmp_path / "renders/ball").complete
    assert "recording would take" in sandbox("check", path, "--limit", "recorded_bytes=9e5").err
