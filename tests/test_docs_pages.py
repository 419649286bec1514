"""Every page begins with what it is for and with a picture, and its pictures say what one sees."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

DOCS = Path(__file__).parent.parent / "docs"
PAGES = sorted(DOCS.rglob("*.md"))
PICTURE = re.compile(r"!\[([^\]]*)\]\(([^)\s]+)\)")
SOON = 25
"""Lines within which a page has its first picture."""
WITHOUT_A_PICTURE = {
    "glossary.md": "a list of words; the pages that they lead to have the pictures",
    "limits.md": "numbers, options and messages: there is nothing to be seen of them",
    "messages.md": "what the program says is text",
}
"""Pages that need none, and why."""
FOLDERS_WITHOUT_A_PICTURE = {
    "api": "signatures: each page begins with an example to copy, and its index has a picture",
}
CAPTIONED = ("gallery.md", "mechanisms.md", "hands.md", "verification/index.md",
             "verification/benchmarks.md")
"""Pages that are made from scenes and cases: what a picture shows stands beside it, and its
alternative text is that title."""


def name(page: Path) -> str:
    return page.relative_to(DOCS).as_posix()


def excused(page: Path) -> bool:
    return name(page) in WITHOUT_A_PICTURE or (
        name(page).split("/")[0] in FOLDERS_WITHOUT_A_PICTURE and name(page) != "api/index.md")


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_a_page_begins_with_its_name_and_a_sentence(page: Path) -> None:
    title, first, *_ = page.read_text(encoding="utf-8").split("\n\n")
    assert re.fullmatch(r"# .+", title)
    assert re.match(r"[A-Z`\[]", first), "after the title comes a paragraph, no table, no heading"
    assert re.search(r"[.:?)]$", first, re.MULTILINE), "that is a sentence"


@pytest.mark.parametrize("page", [page for page in PAGES if not excused(page)], ids=name)
def test_a_page_has_a_picture_soon(page: Path) -> None:
    lines = page.read_text(encoding="utf-8").splitlines()[:SOON]
    assert any(PICTURE.search(line) for line in lines)


def test_who_is_excused_is_there_and_has_none() -> None:
    for page in WITHOUT_A_PICTURE:
        assert not PICTURE.search((DOCS / page).read_text(encoding="utf-8")), page
    assert all((DOCS / folder).is_dir() for folder in FOLDERS_WITHOUT_A_PICTURE)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_its_pictures_exist_and_say_what_one_sees(page: Path) -> None:
    least = 1 if name(page) in CAPTIONED else 4
    for said, target in PICTURE.findall(page.read_text(encoding="utf-8")):
        assert (page.parent / target).is_file(), target
        assert len(said.split()) >= least, f"{target}: {said!r} does not say what one sees"
        assert said != Path(target).stem, f"{target}: the name of a file"


def test_every_picture_is_shown() -> None:
    shown = {(page.parent / target).resolve()
             for page in PAGES for _, target in PICTURE.findall(page.read_text(encoding="utf-8"))}
    pictures = {path.resolve() for folder in (DOCS, DOCS.parent / "renders" / "gallery")
                for path in folder.rglob("*") if path.suffix in (".png", ".gif")}
    assert pictures
    assert sorted(str(path.relative_to(DOCS.parent)) for path in pictures - shown) == []
