"""The docs are tested: commands and Python blocks run, scenes load, links resolve.

A ``console`` block has commands (``$ sandbox ...``, with ``# exits 2`` for another exit code than
0; a backslash at the end of a line continues it) and below each of them parts of its output; ``…``
stands for anything. The blocks of a page run in order in one directory. A ``json scene`` block is a
whole scene, written to ``scene.json``; ``tests/golden`` simulates it with its expectations. One
that diverges on purpose is ``json scene diverges``. ``python NAME.py`` is written to that file, and
``json own`` is a scene that needs its elements. ``json broken`` is written to ``broken.json``,
``json study`` to ``study.json``. A ``json piece`` must occur in the next whole scene of its page. A
``sh`` block has commands that are too slow or too particular to run here.
"""

from __future__ import annotations

import importlib.util
import re
import shlex
import sys
from dataclasses import fields
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

from sandbox.cli.commands import invoke
from sandbox.cli.console import Exit
from sandbox.picture import film
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.reference import descriptions, scene_schema
from sandbox.values.messages import fields_page
from sandbox.values.units import UNITS

from .golden.scenes import WHOLE

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").rglob("*.md")
                                     if page.name != "validation.md")]
BLOCK = re.compile(r"^```([^\n]*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
GENERATED = ROOT / "docs" / "validation.md"
"""Page that the site build writes."""
MEASURED = {*(ROOT / "docs").glob("work_precision_*.png"), *(ROOT / "docs").glob("pymunk_*.png")}
"""Pictures that ``python -m benchmarks --draw docs`` makes."""


def blocks(page: Path) -> list[tuple[str, str]]:
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@cache
def script(name: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(name, ROOT / "docs" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


@cache
def whole(page: Path) -> str:
    """Text of a page with its generated tables, as the site shows it."""
    text: str = script("make_reference").filled(page.read_text(encoding="utf-8"))
    return text


def steps(text: str) -> list[tuple[list[str], int, list[str]]]:
    """Of a console block: the words of each command, its exit code, what it is to print."""
    found: list[tuple[list[str], int, list[str]]] = []
    for line in text.replace("\\\n", "").splitlines():
        if line.startswith("$ "):
            command, _, code = line[2:].partition("  # exits ")
            found.append((shlex.split(command), int(code or 0), []))
        elif line.strip():
            found[-1][2].append(line)
    return found


def fits(fragment: str, printed: str) -> bool:
    """Whether a line of the docs is somewhere in the output; white space counts for nothing."""
    pieces = [re.escape("".join(piece.split())) for piece in fragment.split("…")]
    return re.search(".*".join(pieces), "".join(printed.split())) is not None


def run_page(page: Path, capsys: Any) -> int:
    """Run everything on a page, in order; how many blocks there were."""
    found = blocks(page)
    for index, (kind, text) in enumerate(found):
        if kind == "json piece":
            whole = next((other for kind, other in found[index:] if kind in WHOLE), "")
            assert "".join(text.split()) in "".join(whole.split()), text
        elif kind in (*WHOLE, "json own"):
            Path("scene.json").write_text(text, encoding="utf-8")
        elif kind == "json broken":
            Path("broken.json").write_text(text, encoding="utf-8")
        elif kind == "json study":
            Path("study.json").write_text(text, encoding="utf-8")
        elif kind.endswith(".py"):
            Path(kind.split()[1]).write_text(text, encoding="utf-8")
        elif kind == "python":
            exec(compile(text, str(page), "exec"), {"__name__": "__main__"})
        elif kind == "console":
            for words, code, expected in steps(text):
                assert words[0] == "sandbox", words
                capsys.readouterr()
                assert invoke(words[1:]) == code, (words, capsys.readouterr())
                printed = "".join(capsys.readouterr())
                assert [line for line in expected if not fits(line, printed)] == [], printed
        else:
            assert kind == "sh" or kind.startswith("{"), kind  # those are for Sphinx
    return len(found)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_pages_run_as_written(
    page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    times = film.frame_times  # every twelfth one suffices: tests/draw tests films
    monkeypatch.setattr(film, "frame_times", lambda *args, **options: times(
        *args, **options)[::-12][::-1])
    monkeypatch.chdir(tmp_path)
    run_page(page, capsys)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", BLOCK.sub("", whole(page))):
        if target.startswith("http"):
            continue
        name, _, anchor = target.partition("#")
        other = (page.parent / name).resolve() if name else page
        if other == GENERATED:
            assert not anchor or anchor in {_anchor(case.title) for case in validation_cases()}
            continue
        assert other.exists(), target
        if anchor:
            heads = re.findall(r"^#+ (.+)$", whole(other), re.MULTILINE)
            assert anchor in {_anchor(head) for head in heads}, target


@cache
def validation_cases() -> list[Any]:
    generator = script("make_validation")
    return [case for module in generator.MODULES for case in generator.cases(module)]


def _anchor(head: str) -> str:
    return re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-")


def test_every_model_of_a_scene_is_described() -> None:
    reference = script("make_reference")
    assert reference.undescribed() == set()
    for page, groups in reference.PAGES.items():
        heads = {_anchor(head) for head in re.findall(
            r"^#+ (.+)$", whole(ROOT / "docs" / page), re.MULTILINE)}
        for model in (model for group in groups.values() for model in group):
            name, _, anchor = fields_page(model).removeprefix("docs/").partition("#")
            assert name == page, model
            assert anchor in heads, model


def test_every_field_of_every_element_is_described() -> None:
    """A sentence, in the table of its element and in the schema that editors show."""
    reference, schema = script("make_reference"), scene_schema()
    for model in (model for page in reference.PAGES.values() for group in page.values()
                  for model in group):
        shown = schema["$defs"].get(model.__name__, schema)["properties"]
        described = descriptions(model)
        for name, field in model.model_fields.items():
            fragment = described.get(name, "")
            assert len(fragment.split()) > 1, f"{model.__name__}.{name}"
            assert fragment.endswith("."), f"{model.__name__}.{name}"
            assert fragment in shown[field.alias or name]["description"], f"{model.__name__}.{name}"


def test_the_gallery_holds_what_the_docs_show() -> None:
    gallery = script("make_gallery")
    made = {gallery.FOLDER / name for name in gallery.PICTURES}
    shown = {
        (page.parent / target).resolve()
        for page in PAGES
        for target in re.findall(r"!\[[^\]]*\]\(([^)]+)\)", whole(page))
    }
    assert shown == made | MEASURED
    assert all(path.exists() for path in MEASURED)
    kept = {path: path.stat().st_size for path in gallery.FOLDER.rglob("*") if path.is_file()}
    assert set(kept) == made, "run python docs/make_gallery.py"
    small = {path: size for path, size in kept.items() if path.parent.name == "scenes"}
    assert [path.name for path, size in small.items() if size > 20_000] == []
    assert max(kept.values()) < 1_000_000
    assert sum(kept.values()) - sum(small.values()) < 8_000_000


def test_every_scene_has_one_topic_and_is_in_the_gallery() -> None:
    reference = script("make_reference")
    grouped = [name for topic in reference.TOPICS for name in topic.scenes]
    assert sorted(grouped) == sorted(shipped_scenes()), "put it into scenes/topics.toml"
    text = whole(ROOT / "docs" / "gallery.md")
    assert [name for name in grouped if f"`sandbox run {name}`" not in text] == []
    assert set(script("make_gallery").HOW) <= set(grouped)


def test_every_generated_table_is_shown_once() -> None:
    reference = script("make_reference")
    marks = [mark for page in PAGES for mark in reference.MARK.findall(page.read_text("utf-8"))]
    assert sorted(marks) == sorted(reference.TABLES)


def test_the_limits_and_exit_codes_are_those_of_the_program() -> None:
    text = (ROOT / "docs" / "limits.md").read_text(encoding="utf-8")
    message = dict(re.findall(r"^\| `(\w+)` \| ([\d ]+) \|", text, re.MULTILINE))
    limits = {field.name: getattr(Limits(), field.name) for field in fields(Limits)}
    assert {name: int(value.replace(" ", "")) for name, value in message.items()} == limits
    assert {int(code) for code in re.findall(r"^\| (\d+) \|", text, re.MULTILINE)} == {*Exit}


def test_the_units_are_those_of_the_program() -> None:
    text = (ROOT / "docs" / "scenes.md").read_text(encoding="utf-8")
    paragraph = text.partition("The units:")[2].partition("- an expression")[0]
    groups = [group.strip() for group in re.split(r"[;,\n]", paragraph)]
    message = {word for group in groups for word in ([group] if group in UNITS else group.split())}
    assert message == {unit for unit in UNITS if unit.isascii()}
