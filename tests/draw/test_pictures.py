"""Stills of shipped scenes in numbers: what is drawn of each colour, where, and every text.

``python -m tests.draw.test_pictures`` writes ``pictures.json`` anew after a look at what moved.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import sandbox
from sandbox.draw.film.frames import FrameRenderer
from sandbox.draw.film.options import view_of
from sandbox.draw.film.shapes import DrawnLines, FilledCircle, FilledPolygon
from sandbox.draw.film.sheet import Text
from sandbox.scene.layers import LAYERS

KEPT = Path(__file__).with_name("pictures.json")
SCENES = ("actuators", "belt_drive", "capstan", "conveyor", "drums", "dry_friction", "fields",
          "finger_dual_control", "finger_joint_locks", "floating", "four_bar", "gear_pair",
          "hardening_spring", "hydraulic_lift", "motor_line", "outlines", "planetary", "planes",
          "pneumatic_hand", "pulley_differential", "release", "rope_differential", "servo_arm",
          "single_finger", "tendon_stiffness", "truss")
SECONDS, SIZE = 0.2, (640, 480)
NEAR = 1.0
"""Places may differ by this [pixels of the finished picture]; texts by more, as fonts do."""


def still(scene: str) -> dict[str, Any]:
    """Every text with its place; of each colour and kind of shape how many, where, how large."""
    loaded = sandbox.load_scene(scene, overrides={"run.duration": SECONDS})
    run = sandbox.simulate(loaded)
    view = view_of(run.mechanism.view, {"size": SIZE, "show": list(LAYERS)})
    frames = FrameRenderer(run, view=view, moments=[SECONDS])
    sheet, k = frames.sheet(SECONDS), frames.enlarged
    groups: dict[str, list[tuple[np.ndarray, float]]] = {}
    for shape in (laid.shape for laid in sheet.laid):
        match shape:
            case FilledPolygon(_, corners):
                points, size = corners, 0.0
            case DrawnLines(_, path, width):
                points, size = path, float(width)
            case FilledCircle(_, centre, radius):
                points, size = [centre], float(radius)
            case _:
                continue
        name = f"{type(shape).__name__} #{bytes(shape.colour[:3]).hex()}"
        groups.setdefault(name, []).append((np.asarray(points, float).reshape(-1, 2) / k, size / k))
    marks = {}
    for name, found in groups.items():
        points = np.concatenate([each for each, _ in found])
        marks[name] = [len(found), *points.mean(axis=0).round(1).tolist(),
                       *points.std(axis=0).round(1).tolist(),
                       round(float(np.mean([size for _, size in found])), 2)]
    words = [[word.face.text, *map(round, word.rect.center)] for word in sheet.words
             if isinstance(word, Text)]
    return {"marks": dict(sorted(marks.items())), "words": sorted(words)}


@pytest.mark.parametrize("scene", SCENES)
def test_a_still_shows_what_it_did(scene: str) -> None:
    kept, found = json.loads(KEPT.read_text())[scene], still(scene)
    assert [word[0] for word in found["words"]] == [word[0] for word in kept["words"]]
    for name, *place in kept["words"]:
        assert any(name == text and place == pytest.approx(at, abs=3) for text, *at in
                   found["words"]), (name, place)
    assert found["marks"].keys() == kept["marks"].keys()
    for name, row in kept["marks"].items():
        assert found["marks"][name][0] == row[0], name
        assert found["marks"][name][1:] == pytest.approx(row[1:], abs=NEAR), name


if __name__ == "__main__":
    KEPT.write_text(json.dumps({scene: still(scene) for scene in SCENES}, indent=None)
                    .replace('}, "', '},\n"').replace('], "', '],\n "') + "\n")
