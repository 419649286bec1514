"""Fingers, sections and trees: wrong counts and references."""


import pytest
from pydantic import ValidationError

from sandbox.errors import SceneError
from sandbox.scene.document import Scene
from sandbox.scene.expand import expand
from sandbox.scene.parts.finger import Finger
from tests.scene.hand import FINGER


@pytest.mark.parametrize(("changes", "field", "words"), [
    ({"radii": [0.009]}, "radii", "expected 3 entries, got 1"),
    ({"guides": [[0, 0]] * 3}, "guides", "expected 4 entries, got 3"),
    ({"damping": [1, 2]}, "damping", "expected 1 or 3 entries, got 2"),
    ({"springs": {"stiffness": [1, 2], "from": [0, 0], "to": [0, 0]}}, "springs", "'stiffness'"),
    ({"masses": None}, None, "either 'masses' or 'density'"),
    ({"density": 1100}, None, "either 'masses' or 'density'"),
])
def test_wrong_counts_are_named_where_they_are(changes, field, words):
    with pytest.raises(ValidationError) as caught:
        Finger.model_validate(FINGER | changes)
    (error,) = caught.value.errors()
    assert error["loc"] == ((field,) if field else ())
    assert words in error["msg"]


# --- expansion


def scene_of(*parts, **more):
    return Scene.model_validate({"parts": list(parts), **more})


def fingers(count):
    return [FINGER | {"name": f"f{i + 1}", "at": [0, 0.13 * i]} for i in range(count)]


def tree_of(*pulls, **more):
    return {"type": "rocker_tree", "name": "tree", "pulls": list(pulls), **more}


def problems(*parts, **more):
    with pytest.raises(SceneError) as caught:
        expand(scene_of(*parts, **more))
    return {problem.path: problem for problem in caught.value.problems}


def test_only_the_cause_is_reported_of_dependent_parts():
    """The cause alone: neither the tree that pulls the broken finger nor the tree that pulls it."""
    broken = FINGER | {"name": "g", "on": "plam"}
    trees = tree_of("f1", "g"), tree_of("tree", "f2") | {"name": "two"}
    assert set(problems(*fingers(2), broken, *trees)) == {"$.parts[2].on"}
    within = {"type": "assembly", "name": "hand", "parts": [broken]}
    assert set(problems(*fingers(1), within, tree_of("f1", "hand.g"))) == {"$.parts[1].parts[0].on"}
    assert set(problems(*fingers(1), broken, tree_of("f1", "g.tendon", "gg"))) == {
        "$.parts[1].on", "$.parts[2].pulls[2]"}


def test_a_finger_cannot_be_pulled_twice():
    two = tree_of("f2.tendon", "f3") | {"name": "two"}
    found = problems(*fingers(3), tree_of("f1", "f2"), two)
    assert list(found) == ["$.parts[4].pulls[0]"]
    assert "already" in found["$.parts[4].pulls[0]"].message
