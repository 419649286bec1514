"""Display lists of the shipped scenes, as they were when they were last looked at.

``python -m tests.draw.test_lists`` writes ``lists.json`` anew: digests of the lists of all scenes
at their start, and three lists in full, whose changes a person can read. Columns and poses of
those three are given at their first and last sample.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import pytest

import sandbox
from sandbox.notebook import at_start
from sandbox.picture.build import subject_of
from sandbox.picture.frame import Picture
from sandbox.picture.listing import SIDES, Listing
from sandbox.picture.options import view_of
from sandbox.scene.expand import expand
from sandbox.scene.layers import LAYERS
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.load import load_scene

KEPT = Path(__file__).with_name("lists.json")
FULL = ("four_bar", "hydraulic_lift", "single_finger")


def listed(run: Any) -> Listing:
    view = view_of(run.mechanism.view, {"show": list(LAYERS)})
    return subject_of(run, view, width=1.0, point=1.25e-3).out


def rounded(value: Any) -> Any:
    """Numbers with three digits: what is less is rounding."""
    if isinstance(value, float):
        return 0.0 if abs(value) < 1e-9 else float(f"{value:.3g}")
    if isinstance(value, dict):
        return {str(key): rounded(each) for key, each in value.items()}
    return [rounded(each) for each in value] if isinstance(value, list | tuple) else value


def at_its_start(name: str) -> Listing:
    return listed(at_start(expand(load_scene(shipped_scenes()[name]))))


def digest(name: str) -> str:
    head = json.dumps(rounded(at_its_start(name).head()), sort_keys=True)
    return hashlib.sha256(head.encode()).hexdigest()[:12]


def in_full(name: str) -> dict[str, Any]:
    run = sandbox.simulate(sandbox.load_scene(name, overrides={"run.duration": 0.1}))
    out = listed(run)
    ends = [0, len(out.time) - 1]
    head = {key: out.head()[key] for key in ("items", "styles", "legend")}
    return dict(rounded({**head, "columns": [column[ends].tolist() for column in out.columns],
                         "pose": out.pose[ends].tolist()}))


@pytest.mark.parametrize("name", shipped_scenes())
def test_a_scene_has_the_list_that_it_had(name: str) -> None:
    assert digest(name) == json.loads(KEPT.read_text())["digests"][name]


@pytest.mark.parametrize("name", FULL)
def test_the_list_is_the_one_that_was_looked_at(name: str) -> None:
    kept = json.loads(KEPT.read_text())["lists"][name]
    for part, found in in_full(name).items():
        assert found == kept[part], part


@pytest.mark.parametrize("size", [(400, 300), (800, 600)])
def test_numbers_do_not_jump_and_are_few_in_small_pictures(
        hand_run: Any, size: tuple[int, int]) -> None:
    """A number keeps its side of its arrow in all frames; at most six in a small picture."""
    picture = Picture(hand_run, size=size)
    instant, before, shown = picture.instant(1), dict[Any, Any](), 0
    for sample in range(0, len(hand_run.time), 4):
        instant.go_to(float(hand_run.time[sample]))
        for label in instant.labels():
            if label.side < 0:
                continue
            key = (id(label.item), label.key)
            assert before.setdefault(key, label.side) == label.side < len(SIDES)
            shown += "value" in label.item or label.item["k"] != "text"
        if size[0] < 500:
            assert len([label for label in instant.labels() if label.side >= 0
                        and (label.item["k"] != "text" or "value" in label.item)]) <= 6
    assert shown > 0


if __name__ == "__main__":
    made = {"digests": {name: digest(name) for name in shipped_scenes()},
            "lists": {name: in_full(name) for name in FULL}}
    KEPT.write_text(json.dumps(made).replace('}, {"k"', '},\n {"k"').replace('", "', '",\n "')
                    + "\n")
