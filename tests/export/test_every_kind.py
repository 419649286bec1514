"""Every kind of joint, spring and drive is written by a row of a table, or says why it can't be."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import pytest

from sandbox.export.elements import DRIVES as DRIVE_WRITERS
from sandbox.export.elements import LINKS
from sandbox.export.elements import SPRINGS as SPRING_WRITERS
from sandbox.export.tree import CARRIERS
from sandbox.kinds.elements import DRIVES, JOINTS, SPRINGS

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
