"""Messages lead to pages and sections of the docs that exist."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest

from sandbox import pages
from sandbox.pages import FAMILIES, MOST_TOLD, family_of, page_of, read_on
from sandbox.scene.document import Scene
from sandbox.scene.read.models import fields_at, fields_page

DOCS = Path(__file__).parent.parent / "docs"


def anchors(page: Path, level: str = "#+") -> set[str]:
    heads = re.findall(rf"^{level} (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_each_family_of_messages_has_its_section() -> None:
    assert anchors(DOCS / "messages.md", "###") == set(FAMILIES)


def test_the_fields_of_every_model_have_their_section(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(DOCS))
    import make_reference  # type: ignore[import-not-found]

    models = [model for groups in make_reference.PAGES.values() for of in groups.values()
              for model in of]
    del sys.modules["make_reference"]
    for address in [*map(fields_page, models), pages.STUDIES, pages.SEARCHES]:
        name, _, anchor = address.removeprefix(pages.FOLDER).partition("#")
        assert anchor in anchors(DOCS / name), address


@pytest.mark.parametrize(("message", "family"), [
    ("unknown key 'motor'", "unknown-key"),
    ("'is not JSON' is not allowed here", "is-not-allowed-here"),
    ("the simulation diverged at t = 0.1 s: cart: it moves at 1e+13 m/s",
     "the-simulation-diverged"),
    ("Invalid value for '--vary': 'a' is varied twice", "what-a-study-varies-and-keeps"),
    ("controller 'mine': act() at t = 0.2 s raised ValueError: no", "controller-act-at-t"),
    ("renders/x/run.npz: No space left on device", "cannot-write"),
    ("my own words", ""),
])
def test_what_an_author_wrote_says_nothing_of_the_family(message: str, family: str) -> None:
    assert family_of(message) == family
    assert page_of(message) == (family and f"{pages.MESSAGES}#{family}")


def test_of_a_limit_what_is_allowed_says_so() -> None:
    allowed = "at most 10 (the limit 'steps', raised by --limit steps=N)"
    assert page_of("this has an outline", allowed) == f"{pages.MESSAGES}#larger-than-the-limit"


def test_one_line_says_where_to_read_on() -> None:
    page = "docs/messages.md#unknown-key"
    assert read_on(["", ""]) == []
    assert read_on([page, "", page]) == [f"{page} explains it"]
    assert read_on([page, "b"], ["c", "", "c"]) == [f"{page}, b explain them; c has the fields"]
    several = [str(i) for i in range(MOST_TOLD + 1)]
    assert read_on(several, several[:2]) == [
        "0, 1, 2 explain them, docs/messages.md the others; 0, 1 have the fields"]


@pytest.mark.parametrize(("path", "address"), [
    (("springs", 0, "stiffness"), "elements.md#linearspring"),
    (("springs", 1), ""),
    (("parts", 0, "joints", 0, "limits", 1), "elements.md#pin"),
    (("materials", "steel", "friction"), "elements.md#material"),
    (("bodis",), "elements.md#scene"),
])
def test_a_place_of_a_scene_leads_to_its_fields(path: tuple[str | int, ...], address: str) -> None:
    scene = {
        "springs": [{"type": "linear", "stiffness": 3}, {"stiffness": 3}],
        "parts": [{"type": "assembly", "name": "jaw",
                   "joints": [{"type": "pin", "limits": [0, 1]}]}],
        "materials": {"steel": {"friction": 1}}, "bodis": [],
    }
    assert fields_at(Scene, scene, path) == (address and pages.FOLDER + address)
