"""Cards of scenes and runs: what they tell, that names stay text, that nothing of them runs."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from typing import Any

import pytest

import sandbox
from sandbox.notebook import at_start, card_of_scene
from sandbox.scene.library import shipped_scenes

HOSTILE = "<script>alert(1)</script><img src=x onerror=alert(1)>\"'&"
LARGEST = 200_000
"""Characters of a card: a notebook of fifty is then some megabytes."""


class Reader(HTMLParser):
    """All tags, attributes and text of a piece of HTML, and whether tags are closed."""

    VOID = frozenset({"img"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[str] = []
        self.attributes: list[tuple[str, str | None]] = []
        self.text = ""
        self.open: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append(tag)
        self.attributes += attrs
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data + " "


def harmless(card: str) -> Reader:
    """A card that runs nothing and asks for nothing from elsewhere."""
    read = Reader(card)
    assert set(read.tags) <= {"div", "span", "b", "img", "table", "thead", "tbody", "tr", "th",
                              "td"}
    for name, value in read.attributes:
        assert name in ("style", "src", "alt"), name
        assert name != "src" or (value or "").startswith("data:image/png;base64,")
        assert "url(" not in (value or "") or name != "style"
    assert len(card) < LARGEST
    return read


@pytest.fixture(scope="module")
def run() -> sandbox.Recording:
    return sandbox.simulate("single_finger")


def disc(**more: Any) -> dict[str, Any]:
    return {"run": {"duration": 0.01}, "gravity": [0, -9.81], "bodies": [
        {"name": "a", "mass": 1, "shapes": [{"type": "circle", "radius": 0.01}]}], **more}


def test_a_run_tells_its_end_its_verdict_and_its_audit(run: sandbox.Recording) -> None:
    read = harmless(run._repr_html_())
    assert read.tags.count("img") == 1
    for words in ("One finger on a disc", "the run completed", "7 of 7 expectations passed",
                  "30 checks passed", "finger.mcp.angle", "0.610691 to 0.61104"):
        assert words in read.text, words
    assert repr(run) == (
        "<Recording of 'single_finger': 1500 samples to t = 1.49975 s, the run completed>")


@pytest.mark.parametrize("name", sorted(shipped_scenes())[::12])
def test_scenes_have_pictures_without_a_step(name: str) -> None:
    scene = sandbox.load_scene(name)
    assert "img" in harmless(card_of_scene(scene)).tags
    assert "\n" not in repr(scene)
    assert len(repr(scene)) < 300


def test_a_scene_starts_where_its_run_does() -> None:
    """Poses and lengths of cords are those of a run that begins at rest."""
    scene = sandbox.load_scene("adaptive_grasp", overrides={"run.duration": 0.01})
    first, run = at_start(sandbox.expand(scene)), sandbox.simulate(scene)
    for name in run.names():
        if name.endswith((".x", ".y", "tendon.length")):
            assert first[name][0] == pytest.approx(run[name][0], abs=1e-5), name


def test_a_scene_that_is_not_sound_has_a_card_all_the_same() -> None:
    scene = sandbox.load_scene("single_finger")
    broken = scene.model_copy(update={"parts": (scene.parts[0].model_copy(
        update={"on": "nothing"}),)})
    assert "no picture: " in harmless(card_of_scene(broken)).text


def test_names_and_titles_stay_text() -> None:
    scene = sandbox.load_scene(disc(
        name=HOSTILE, title=HOSTILE, about=HOSTILE,
        events=[{"name": "e", "at": 0.005, "stop": "fail", "because": HOSTILE}],
        expect=[{"mean": "a.x", "above": 3, "because": HOSTILE}]))
    for shown in (scene, sandbox.simulate(scene)):
        read = harmless(shown._repr_html_())
        assert HOSTILE in read.text
        assert not re.search(r"<script|<img src=x", shown._repr_html_())
