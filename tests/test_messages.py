"""docs/messages.md explains every message: the table, the page and the sources say the same."""

from __future__ import annotations

import ast
import importlib.util
import itertools
import re
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import sandbox
from sandbox import pages
from sandbox.pages import FAMILIES, MOST_TOLD, family_of, page_of, read_on
from sandbox.scene.document import Scene
from sandbox.scene.read.models import fields_at, fields_page

PACKAGE = Path(sandbox.__file__).parent
DOCS = Path(__file__).parent.parent / "docs"
MESSAGE_AT = {
    **dict.fromkeys(("Problem", "WrongValueError", "OutputError", "SandboxError", "RefusedError",
                     "BadParameter", "UsageError", "DrawingError", "RepeatError", "PartError",
                     "CamError", "LikeError", "NoBracketError", "CutError", "MixedUnitsError",
                     "UnknownQuantityError", "StdoutError", "problem"), 0),
    "PydanticCustomError": 1, "look": 2, "error": 2, "told": 2,
}
"""Calls that make a message, and which of their arguments it is."""
ELSEWHERE = {"mechanics", "notebook", "build", "gym"}
"""Rooms whose refusals are for programs: no command tells them."""
TOLD_BY_A_PAGE = {"engine/live.py", "engine/hand.py", "show/session.py", "show/controls.py"}
"""What a page of ``sandbox view`` refuses, it tells at what was played with."""
WITHOUT = {
    "and … more problems", "with … the scene is wrong: …", "show=…: …", "size=…: …", "its … is …",
    "… is no recording; pass what sandbox.simulate or sandbox.Recording.load gives",
    "… is no number of steps", "… is no search for the best", "holds", "does not hold",
}
"""Words that go round others, which have a family; and three refusals for programs alone."""


def literals(node: ast.expr) -> list[str]:
    """What a text can be, with ``…`` for what is put in."""
    if isinstance(node, ast.Constant):
        return [node.value] if isinstance(node.value, str) else []
    if isinstance(node, ast.JoinedStr):
        pieces = [literals(each) or ["…"] for each in node.values]
        return ["".join(some) for some in itertools.product(*pieces)]
    if isinstance(node, ast.FormattedValue):
        return [*literals(node.value.body), *literals(node.value.orelse)] \
            if isinstance(node.value, ast.IfExp) else []
    if isinstance(node, ast.BinOp):
        return [one + other for one in literals(node.left) or ["…"]
                for other in literals(node.right) or ["…"]]
    return [*literals(node.body), *literals(node.orelse)] if isinstance(node, ast.IfExp) else []


def told_by(path: Path) -> Iterator[str]:
    """The messages that a module can make, as far as they stand in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if not isinstance(node, ast.Call):
            continue
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        place = MESSAGE_AT.get(name)
        if place is not None and place < len(node.args):
            yield from (text for text in literals(node.args[place])
                        if re.search("[a-z]{3}", re.sub(r"\{\w+\}", "", text)))


MODULES = [path for path in sorted(PACKAGE.rglob("*.py"))
           if path.relative_to(PACKAGE).parts[0] not in ELSEWHERE
           and path.relative_to(PACKAGE).as_posix() not in TOLD_BY_A_PAGE and [*told_by(path)]]


def anchors(page: Path, level: str = "#+") -> set[str]:
    heads = re.findall(rf"^{level} (.+)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


def test_each_family_has_its_section_and_each_section_its_family() -> None:
    assert anchors(DOCS / "messages.md", "###") == set(FAMILIES)


def test_what_a_section_quotes_of_messages_leads_to_it() -> None:
    """Of what stands in code type: words of a message, not commands, columns or Python."""
    led = {}
    text = (DOCS / "messages.md").read_text(encoding="utf-8")
    for section in re.split(r"^### ", text, flags=re.MULTILINE)[1:]:
        head, _, body = section.partition("\n")
        anchor = re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")
        for quoted in re.findall(r"`([^`]+)`", re.sub(r"```.*?```", "", body, flags=re.DOTALL)):
            words = " ".join(quoted.split())
            if re.match(r"(?!sandbox |search |pip |python |if __name|x \[)[a-z'…]+.* .", words):
                led[anchor, words] = family_of(words)
    assert len(led) > 80
    assert [(*key, family) for key, family in led.items() if key[0] != family] == []


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.relative_to(PACKAGE).as_posix())
def test_every_message_of_the_sources_has_a_family(path: Path) -> None:
    assert [text for text in told_by(path) if not family_of(text) and text not in WITHOUT] == []


def test_most_messages_are_found_in_the_sources() -> None:
    assert sum(len([*told_by(path)]) for path in MODULES) > 500


@pytest.mark.parametrize(("message", "family"), [
    ("unknown key 'motor'", "unknown-key"),
    ("there is no body named 'drawing'", "there-is-no-body-named"),
    ("'pressure' is missing", "is-missing"),
    ("'is not JSON' is not allowed here", "is-not-allowed-here"),
    ("the simulation diverged at t = 0.1 s: cart: it moves at 1e+13 m/s",
     "the-simulation-diverged"),
    ("Invalid value for '--vary': 'a' is varied twice", "what-a-study-varies-and-keeps"),
    ("Missing argument 'SCENE'.", "no-such-option"),
    ("controller 'mine': act() at t = 0.2 s raised ValueError: no", "controller-act-at-t"),
    ("renders/x/run.npz: No space left on device", "cannot-write"),
    ("the key 'a' stands here a second time, first at line 1, column 2", "the-file-is-not-json"),
    ("its mass is 1e+22, outside of 1e-12 to 1e+12 kg", "must-be-greater-than"),
    ("'1 cam' is not a name: letters, digits and _, parts joined by dots", "the-name-is-taken"),
    ("'bar' is a unit of pressure, but this is a time", "unknown-unit"),
    ("expected a number, a ramp {…}, a table {…} or an expression (set by an override)",
     "expected-one-thing-got-another"),
    ("'slop' does nothing any more: gaps are closed, no overlap is left alone", "can-hardly-act"),
    ("'below' must be less than 'above'", "must-be-greater-than"),
    ("'node.y' is given twice; several values stand apart by commas",
     "it-does-not-come-to-rest"),
    ("a polyline has no area, so no body that moves freely has one",
     "an-outline-that-crosses-itself"),
    ("hole 0: the outline has no area", "an-outline-that-crosses-itself"),
    ("the file cannot be read: Permission denied", "there-is-no-such-file"),
    ("cannot write renders/distribution/run.npz: Permission denied", "cannot-write"),
    ("my own words", ""),
])
def test_what_an_author_wrote_says_nothing_of_the_family(message: str, family: str) -> None:
    assert family_of(message) == family


def test_of_a_limit_what_is_allowed_says_so() -> None:
    allowed = "at most 10 (the limit 'steps', raised by --max-steps)"
    assert page_of("this has an outline", allowed) == f"{pages.MESSAGES}#larger-than-the-limit"
    assert page_of("my own words") == ""


def test_one_line_says_where_to_read_on() -> None:
    page = "docs/messages.md#unknown-key"
    assert read_on(["", ""]) == []
    assert read_on([page, "", page]) == [f"{page} explains it"]
    assert read_on([page, "b"], ["c", "", "c"]) == [f"{page}, b explain them; c has the fields"]
    several = [str(i) for i in range(MOST_TOLD + 1)]
    assert read_on(several, several[:2]) == [
        "0, 1, 2 explain them, docs/messages.md the others; 0, 1 have the fields"]


def test_the_fields_of_every_model_have_their_section() -> None:
    spec = importlib.util.spec_from_file_location("make_reference", DOCS / "make_reference.py")
    assert spec is not None
    assert spec.loader is not None
    reference = importlib.util.module_from_spec(spec)
    sys.modules["make_reference"] = reference
    spec.loader.exec_module(reference)
    models = [model for groups in reference.PAGES.values() for of in groups.values()
              for model in of]
    for address in [*map(fields_page, models), pages.STUDIES, pages.SEARCHES]:
        name, _, anchor = address.removeprefix(pages.FOLDER).partition("#")
        assert anchor in anchors(DOCS / name), address


@pytest.mark.parametrize(("path", "address"), [
    (("springs", 0, "stiffness"), "elements.md#linearspring"),
    (("springs", 1), ""),
    (("parts", 0, "joints", 0, "limits", 1), "elements.md#pin"),
    (("parts", 0, "name"), "parts.md#assembly"),
    (("bodies", 0, "shapes", 0, "radius"), "elements.md#circle"),
    (("materials", "steel", "friction"), "elements.md#material"),
    (("run", "step"), "elements.md#run"),
    (("bodis",), "elements.md#scene"),
])
def test_a_place_of_a_scene_leads_to_its_fields(path: tuple[str | int, ...], address: str) -> None:
    scene = {
        "springs": [{"type": "linear", "stiffness": 3}, {"stiffness": 3}],
        "parts": [{"type": "assembly", "name": "jaw",
                   "joints": [{"type": "pin", "limits": [0, 1]}]}],
        "bodies": [{"shapes": [{"type": "circle", "radius": 1}]}],
        "materials": {"steel": {"friction": 1}}, "run": {"step": 1}, "bodis": [],
    }
    assert fields_at(Scene, scene, path) == (address and pages.FOLDER + address)
