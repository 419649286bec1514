"""``sandbox export``: what it writes, what it tells, and its exit codes."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.entry import invoke


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_it_prints_the_model_and_tells_the_rest_aside(capfd: Any) -> None:
    assert invoke(["export", "single_finger"]) == 0
    said = capfd.readouterr()
    assert ET.fromstring(said.out).attrib["model"] == "single_finger"
    assert ": note: actuator: " in said.err


def test_it_writes_a_file_and_leaves_out_what_it_is_told(capfd: Any) -> None:
    words = ["export", "shape_change", "--without", "swelling", "--out", "hand.xml"]
    assert invoke(words) == 0
    said = capfd.readouterr()
    assert ET.parse("hand.xml").getroot().attrib["model"] == "shape_change"
    assert "left out: swelling" in said.err
    assert "wrote hand.xml" in said.out


@pytest.mark.parametrize(("words", "told"), [
    (["shape_change"], "swelling: MuJoCo has no counterpart of a changing radius; "
                       "--without swelling leaves it out"),
    (["single_finger", "--format", "mjfc"], "Did you mean 'mjcf'? Allowed: 'mjcf', 'pymunk'."),
    (["single_finger", "--without", "finger.tendn"], "Did you mean 'finger.tendon'?"),
    (["single_finger", "--out", "/dev/null/place.xml"],
     "cannot write /dev/null/place.xml: Not a directory"),
    (["singel_finger"], "Did you mean 'single_finger'?"),
])
def test_wrong_input_exits_2_and_writes_nothing(words: list[str], told: str, capfd: Any) -> None:
    assert invoke(["export", *words]) == 2
    said = capfd.readouterr()
    assert told in said.err
    assert said.out == ""
    assert "Traceback" not in said.err
    assert list(Path().iterdir()) == []
