"""The pages of docs/api have all that is public, and nothing that there is not."""

from __future__ import annotations

import pkgutil
import re
from pathlib import Path

import pytest

import sandbox
import sandbox.mechanics
from sandbox.build import BUILDERS
from sandbox.build.builders import Family

FOLDER = Path(__file__).parent.parent / "docs" / "api"
PAGES = sorted(FOLDER.rglob("*.md"))
MODULES = {"build", "gym", "search"}


def told(directive: str) -> list[str]:
    text = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    return re.findall(rf"^\.\. {directive}:: (\S+)$", text, re.MULTILINE)


NAMES = [name for directive in ("autofunction", "autoclass", "autoexception", "py:data")
         for name in told(directive)]


def below(prefix: str) -> set[str]:
    return {name.removeprefix(prefix) for name in NAMES if name.startswith(prefix)}


def test_every_public_name_is_told_once():
    assert len(NAMES) == len(set(NAMES))
    assert {name for name in below("sandbox.") if "." not in name} == (
        set(sandbox.__all__) - MODULES)
    for module in (sandbox.search, sandbox.gym):
        assert set(module.__all__) <= below(f"{module.__name__}.")


def test_every_builder_is_told():
    assert below("sandbox.build.") == {
        name for word, builder in BUILDERS.items()
        for name in ([f"{word}.{each}" for each in dir(builder)] if isinstance(builder, Family)
                     else [word])}


def test_every_module_of_closed_forms_is_told():
    modules = pkgutil.iter_modules(sandbox.mechanics.__path__, "sandbox.mechanics.")
    assert sorted(told("automodule")) == sorted(module.name for module in modules)


@pytest.mark.parametrize("name", NAMES)
def test_what_is_told_is_there_and_says_what_it_is(name):
    assert pkgutil.resolve_name(name).__doc__


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(FOLDER).as_posix())
def test_a_page_begins_with_what_one_can_do_and_an_example(page):
    _, first, *rest = page.read_text(encoding="utf-8").split("\n\n")
    assert first.startswith("After this page you ")
    assert any(paragraph.startswith("```python\n") for paragraph in rest)
