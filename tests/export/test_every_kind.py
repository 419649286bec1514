"""Every kind of joint, spring and drive is written by a row of a table, or says why it can't be."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import pytest

from sandbox.elements.kinds import DRIVES, JOINTS, SPRINGS
from sandbox.errors import SceneError
from sandbox.export import export_mechanism
from sandbox.export.elements import DRIVES as DRIVE_WRITERS
from sandbox.export.elements import LINKS
from sandbox.export.elements import SPRINGS as SPRING_WRITERS
from sandbox.export.tree import CARRIERS
from sandbox.scene.mechanism import Mechanism

TABLES: list[tuple[str, Mapping[str, Any], Iterable[str]]] = [
    ("export/tree.py: CARRIERS", CARRIERS,
     [tag for tag, kind in JOINTS.items() if not kind.mujoco and not kind.along_line]),
    ("export/elements.py: LINKS", LINKS,
     [tag for tag, kind in JOINTS.items() if not kind.mujoco and not kind.mujoco_loop]),
    ("export/elements.py: SPRINGS", SPRING_WRITERS,
     [tag for tag, kind in SPRINGS.items() if not kind.mujoco]),
    ("export/elements.py: DRIVES", DRIVE_WRITERS,
     [tag for tag, kind in DRIVES.items() if not kind.mujoco]),
]


@pytest.mark.parametrize(("place", "table", "kinds"), TABLES, ids=[row[0] for row in TABLES])
def test_every_kind_with_a_counterpart_is_written(
    place: str, table: Mapping[str, Any], kinds: Iterable[str],
) -> None:
    assert set(table) == set(kinds), f"sandbox/{place} has a row for each of {sorted(kinds)}"


SCENE = Mechanism.model_validate({
    "bodies": [{"name": "frame", "motion": "fixed"},
               {"name": "load", "at": (0.1, 0.0), "mass": 0.2, "inertia": 1e-4}],
    "joints": [{"type": "rod", "name": "strut", "a": "frame", "b": "load"}],
    "springs": [{"type": "linear", "name": "coil", "a": "frame", "b": "load", "stiffness": 1.0}],
    "drives": [{"type": "force", "name": "jet", "body": "load", "direction": (1, 0), "value": 1}]})


@pytest.mark.parametrize(("kinds", "tag", "name"), [
    (JOINTS, "rod", "strut"), (SPRINGS, "linear", "coil"), (DRIVES, "force", "jet")])
def test_a_kind_without_a_counterpart_says_so_in_its_row_and_nowhere_else(
    kinds: dict[str, Any], tag: str, name: str, monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setitem(kinds, tag, replace(kinds[tag], mujoco="a toy"))
    with pytest.raises(SceneError) as caught:
        export_mechanism(SCENE)
    assert [problem.path for problem in caught.value.problems] == [name]
    assert "no counterpart of a toy" in caught.value.problems[0].message
    assert export_mechanism(SCENE, without=[name]).left_out == (name,)
