"""Every kind of drive is written to a MuJoCo model, or its facts say why it cannot be."""

from __future__ import annotations

from dataclasses import replace

import pytest

from sandbox.elements.drive import DriveSpec
from sandbox.elements.registry import KINDS
from sandbox.errors import SceneError
from sandbox.export import export_mechanism
from sandbox.scene.mechanism import Mechanism


def test_every_drive_with_a_counterpart_is_written() -> None:
    drives = KINDS["drives"]
    assert [tag for tag, kind in drives.items() if issubclass(kind, DriveSpec)
            and bool(kind.facts.mujoco) == (kind.write_mujoco is not DriveSpec.write_mujoco)] == []


SCENE = Mechanism.model_validate({
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "load", "at": (0.1, 0.0), "mass": 0.2, "inertia": 1e-4}],
    "joints": [{"type": "rod", "name": "strut", "a": "frame", "b": "load"}],
    "drives": [{"type": "force", "name": "jet", "body": "load", "direction": (1, 0), "value": 1}]})


@pytest.mark.parametrize(("kinds", "tag", "name"), [
    ("joints", "rod", "strut"), ("drives", "force", "jet")])
def test_the_facts_of_a_kind_alone_say_that_it_has_no_counterpart(
    kinds: str, tag: str, name: str, monkeypatch: pytest.MonkeyPatch,
) -> None:
    kind = KINDS[kinds][tag]
    monkeypatch.setattr(kind, "facts", replace(kind.facts, mujoco="a toy"))  # type: ignore[attr-defined]
    with pytest.raises(SceneError) as caught:
        export_mechanism(SCENE)
    assert [problem.path for problem in caught.value.problems] == [name]
    assert "no counterpart of a toy" in caught.value.problems[0].message
    assert export_mechanism(SCENE, without=[name]).left_out == (name,)
