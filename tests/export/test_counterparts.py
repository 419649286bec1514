"""What a format cannot express is refused: it is never left out without a message."""

from __future__ import annotations

import pytest

import sandbox
from sandbox.engine.pymunk_draft import to_pymunk
from sandbox.errors import SceneError
from sandbox.export.mjcf import write_mjcf


@pytest.mark.parametrize("write", [write_mjcf, to_pymunk])
@pytest.mark.parametrize(("scene", "name"), [("curved_slot", "track"),
                                             ("soft_grasp", "materials.skin")])
def test_paths_and_soft_skin_have_no_counterpart(write, scene, name) -> None:
    with pytest.raises(SceneError) as caught:
        write(sandbox.expand(sandbox.load_scene(scene)))
    assert name in {problem.path for problem in caught.value.problems}
    assert {problem.code for problem in caught.value.problems} == {"no-counterpart"}
