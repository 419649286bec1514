"""Settings that older scenes and recordings hold and that nothing reads any more."""

from __future__ import annotations

from typing import Any

import pytest

from sandbox.engine.inspect import inspect
from sandbox.errors import SceneError
from sandbox.scene.elements.settings import Run
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene, read_scene


def told(run: dict[str, Any]) -> list[str]:
    """What the inspection says of a scene with these settings."""
    scene = {"run": run, "bodies": [{"name": "still", "motion": "fixed"}]}
    return [str(found) for found in inspect(read_scene(scene).mechanism)]


@pytest.mark.parametrize("value", [40, 0, "many", None])
def test_whatever_they_are_they_do_nothing(value: object) -> None:
    """Not even wrong ones are refused: what is not read cannot be wrong."""
    run = load_scene({"run": {"step": "1 ms", "iterations": value, "slop": value}}).run
    assert run.model_dump() == Run(step=1e-3).model_dump()
    assert run.ignored == ("iterations", "slop")


def test_the_inspection_says_so_in_one_line() -> None:
    line, = told({"iterations": 40, "slop": "1 um"})
    assert line.startswith("warning: run: 'iterations' and 'slop' do nothing any more")
    assert line.endswith("leave them out")
    line, = told({"slop": "1 um"})
    assert line.startswith("warning: run: 'slop' does nothing any more")
    assert line.endswith("leave it out")
    assert told({"step": "1 ms"}) == []


def test_an_override_is_told_too() -> None:
    mechanism = read_scene({}, overrides={"run.iterations": 80}).mechanism
    assert mechanism.run.ignored == ("iterations",)


def test_recordings_that_hold_them_are_read() -> None:
    old = Mechanism().model_dump_json(by_alias=True).replace(
        '"sample_rate"', '"iterations":40,"slop":1e-06,"sample_rate"')
    assert '"slop"' in old
    assert Mechanism.model_validate_json(old).model_dump() == Mechanism().model_dump()


def test_other_keys_are_refused_as_before() -> None:
    with pytest.raises(SceneError, match="unknown key 'slob'"):
        load_scene({"run": {"iterations": 40, "slob": 1}})
