"""``sandbox export``: wrong input."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.entry import invoke


@pytest.mark.parametrize(("words", "told"), [
    (["shape_change"], "swelling: MuJoCo has no counterpart of a changing radius; "
                       "--without swelling leaves it out"),
    (["single_finger", "--format", "mjfc"], "'mjfc' is not one of 'mjcf', 'pymunk'."),
    (["single_finger", "--without", "finger.tendn"], "Did you mean 'finger.tendon'?"),
    (["single_finger", "--out", "/dev/null/place.xml"],
     "cannot write /dev/null/place.xml: Not a directory"),
    (["singel_finger"], "Did you mean 'single_finger'?"),
])
def test_wrong_input_exits_2_and_writes_nothing(
    words: list[str], told: str, capfd: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    assert invoke(["export", *words]) == 2
    said = capfd.readouterr()
    assert told in said.err
    assert said.out == ""
    assert "Traceback" not in said.err
    assert list(Path().iterdir()) == []
