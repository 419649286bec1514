"""What a notebook shows of an error."""

from __future__ import annotations

from typing import Any

import pytest

import sandbox


def shown(cell: str, **names: Any) -> list[str]:
    """The lines that a notebook shows of the error that a cell ends in."""
    with pytest.raises(sandbox.SandboxError) as raised:
        exec(cell, {"__name__": "__main__", "sandbox": sandbox, **names})
    return raised.value._render_traceback_()


def test_a_notebook_shows_the_line_and_the_message_and_nothing_of_ours() -> None:
    lines = shown("name = 'single_fingr'\nsandbox.load_scene(name)")
    assert [line.partition(":")[0] for line in lines[1:]] == ["line 2", "SceneError"]
    assert lines[-1].startswith("SceneError: error: there is no file 'single_fingr' and no shipped "
                                "scene of that name. Did you mean 'single_finger'?")


def test_of_a_controller_the_line_that_failed_is_shown() -> None:
    lines = shown("\ndef act(t, readings):\n    return 1 / 0\n"
                  "law = sandbox.Custom('law', reads=[], writes=[], act=act)\n"
                  "sandbox.simulate('atwood', controllers=[law])")
    assert [line.partition(":")[0] for line in lines[1:]] == ["line 5", "line 3",
                                                              "ControllerFailed"]
