"""A command run in this process, in a directory of its own, with all that it prints."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.commands import invoke
from sandbox.cli.console import COMPILING
from tests.samples.controlled import recording
from tests.samples.controlled import scene as finger

BALL: dict[str, Any] = {
    "title": "A ball on the floor",
    "gravity": [0, -9.81],
    "run": {"duration": 0.05},
    "bodies": [
        {"name": "ball", "at": [0, 0.005], "mass": 0.01,
         "shapes": [{"type": "circle", "radius": 0.005}]},
        {"name": "floor", "motion": "fixed",
         "shapes": [{"type": "capsule", "start": [-0.1, -0.01], "end": [0.1, -0.01],
                     "radius": 0.01}]},
    ],
    "expect": [{"mean": "ball.contact.fy", "over": "last 20 ms", "is": "=0.01 * 9.81",
                "within": "1 %"}],
}
"""It starts at rest where it stays: m g is the floor's force, exit code 0."""


FIRST_RUN = rf"{re.escape(COMPILING)}\n|Compiled in [0-9.e-]+ s\n"
"""What a run says that has to compile."""


PAGES = re.compile(r"^(?:see 'sandbox explain|Try 'sandbox ).*\n", re.MULTILINE)
"""The line that says where to read on."""


@dataclass(frozen=True)
class Output:
    """What a command returned and printed."""

    code: int
    out: str
    err: str
    """Without the line that says where to read on."""
    pages: str = ""
    """That line; every message about wrong input has one, unless ``--quiet``."""


@pytest.fixture
def sandbox(
    capfd: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
) -> Callable[..., Output]:
    """Run ``sandbox WORDS`` in an empty directory; never a traceback, whatever the words."""
    monkeypatch.chdir(tmp_path)

    def run(*words: object) -> Output:
        capfd.readouterr()
        code = invoke([str(word) for word in words])
        out, err = capfd.readouterr()
        # what only the first run after a change of the engine says is no part of any other test
        err = re.sub(FIRST_RUN, "", err)
        message = "".join(PAGES.findall(err))
        output = Output(int(code), out, PAGES.sub("", err), message)
        assert "Traceback" not in output.out + output.err
        assert message or code != 2 or not err or {"--quiet", "-q"} & {*words}, err
        return output

    return run


@pytest.fixture
def scene(tmp_path: Path) -> Callable[..., Path]:
    """Write a scene: the ball's, with some of its keys changed; a string is written as it is."""
    def write(content: str | bytes | None = None, /, **changes: Any) -> Path:
        path = tmp_path / "ball.json"
        if isinstance(content, bytes):
            path.write_bytes(content)
        else:
            path.write_text(json.dumps(BALL | changes) if content is None else content)
        return path

    return write


@pytest.fixture
def runs(sandbox: Callable[..., Output]) -> Callable[..., Output]:
    """Two runs with controllers and one without, in renders/ of an empty directory."""
    recording(reach=(1, 1, 0.5)).save("renders/controlled")
    recording(finger("other"), zeta=0.3, omega=9).save("renders/other")
    recording(finger("free", controllers=[]), zeta=0.9).save("elsewhere/free")
    return sandbox
