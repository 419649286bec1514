"""What ``check`` does grows with a scene and no faster: counted in calls, never timed."""

from __future__ import annotations

import gc
import json
import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest

from sandbox import wording
from sandbox.cli.check import report_of
from sandbox.cli.console import Console
from sandbox.cli.options import Source
from sandbox.engine import inspect_elements
from sandbox.errors import SceneError
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import load_scene, read_scene
from sandbox.values.expressions import names_in, parse_expression
from tests.growth.scenes import SCENES

FASTEST = 2.6
"""How many times as many calls the second doubling may add as the first; 4 is quadratic."""
FEW = 3_000
"""Calls that do not matter."""
DAILY = ("chain", "cords of a row", "expectations by pattern", "contact rules of all",
         "fingers on one palm", "wrong references")
assert set(DAILY) < set(SCENES)


def calls(work: Callable[[], object]) -> int:
    """How many functions are called, of Python and of C."""
    count = 0

    def note(frame: FrameType, event: str, argument: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    parse_expression.cache_clear()
    names_in.cache_clear()
    gc.collect()  # what pymunk's objects call when they are collected counts for nobody
    gc.disable()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(None)
        gc.enable()
    return count


@pytest.fixture
def low_caps(monkeypatch: pytest.MonkeyPatch) -> None:
    """Caps that small scenes reach, too."""
    monkeypatch.setattr(wording.NearMisses.__init__, "__defaults__", (3,))
    monkeypatch.setattr(inspect_elements, "MAX_PAIRS", 30)
    monkeypatch.setattr("sandbox.scene.read.compose.DEEPEST_LIKE", 3)
    monkeypatch.setattr("sandbox.model.meters.MAX_HINTED", 3)


@pytest.mark.usefixtures("low_caps")
@pytest.mark.parametrize("kind", [
    kind if kind in DAILY else pytest.param(kind, marks=pytest.mark.nightly) for kind in SCENES])
def test_twice_as_much_takes_twice_as_long(kind: str, tmp_path: Path) -> None:
    file, counts, silent = tmp_path / "scene.json", [], Console(quiet=True)
    for n in (24, 24, 48, 96):  # the first to load what is loaded once
        file.write_text(SCENES[kind](n))
        counts.append(calls(lambda: report_of(Source(str(file), {}, Limits()), silent)))
    first, second = counts[2] - counts[1], counts[3] - counts[2]
    assert second <= max(FASTEST * first, FEW), counts


@pytest.mark.parametrize(("pairs", "whole"), [(45, True), (44, False)])
def test_unchecked_overlaps_are_reported(
    monkeypatch: pytest.MonkeyPatch, pairs: int, whole: bool,
) -> None:
    """Ten discs in one place are 45 pairs."""
    from sandbox.engine.inspect import inspect

    monkeypatch.setattr(inspect_elements, "MAX_PAIRS", pairs)
    loaded = read_scene(json.loads(SCENES["discs in one place"](10)))
    found = [problem.text for problem in inspect(loaded.mechanism)]
    assert len(found) == (45 if whole else 44 + 1)
    assert found[-1].startswith("further bodies may overlap") is not whole


def test_values_of_templates_count_towards_limits() -> None:
    big = {"type": "finger", **{f"key{i}": 1 for i in range(500)}}
    scene = {"templates": {"t": big}, "parts": [{"name": f"f{i}", "like": "t"} for i in range(100)]}
    with pytest.raises(SceneError, match=r"has 20 \d+ values and more") as refused:
        load_scene(scene, limits=Limits(values=20_000))
    assert len(refused.value.problems) == 1


def test_bodies_of_parts_count_towards_limits() -> None:
    finger = json.loads(SCENES["fingers"](4))["parts"][0]
    finger |= {"lengths": [0.01] * 30, "radii": [0.001] * 30, "masses": [0.01] * 30,
               "guides": [[0, 0]] * 31}
    parts = [{**finger, "name": f"f{i}"} for i in range(70)]
    with pytest.raises(SceneError, match=r"the mechanism has 2 170 bodies"):
        load_scene({"parts": parts})
