"""The package's table of equations: whole, true, and every entry called by a test."""

from __future__ import annotations

import ast
import re
from importlib import import_module
from pathlib import Path

import pytest

import sandbox.mechanics

ROWS = [(int(number), name) for number, name in re.findall(
    r"^\| \((\d+)\) \| `([\w.]+)` \|", sandbox.mechanics.__doc__, re.M)]


def found(name: str) -> object:
    """What a dotted name of the table stands for."""
    module, *attributes = name.split(".")
    thing: object = import_module(f"sandbox.mechanics.{module}")
    for attribute in attributes:
        thing = getattr(thing, attribute)
    return thing


def numbers(text: str) -> set[int]:
    """The equations that a docstring names."""
    return {int(n) for n in re.findall(r"\((\d+)\)", text)}


def test_table_has_every_equation_once() -> None:
    assert [number for number, _ in ROWS] == list(range(1, 34))


@pytest.mark.parametrize(("number", "name"), ROWS)
def test_docstring_names_its_equation_and_units(number: int, name: str) -> None:
    """The function says which equation it is and in what unit, its module writes the formula."""
    own = found(name).__doc__
    assert number in numbers(own), f"{name} does not say ({number})"
    assert re.search(r"\[(m|rad|N|1/s|m/s)[\], ]|action|shape \[\.\.\., n, 3, 3\]", own)
    assert number in numbers(import_module(f"sandbox.mechanics.{name.split('.')[0]}").__doc__)


def test_every_entry_is_called_by_a_test_of_its_own() -> None:
    """Beside this file: each function or method of the table occurs in a test that mirrors it."""
    here = Path(__file__).parent
    called: set[str] = set()
    for file in here.glob("test_*.py"):
        if file.name != Path(__file__).name:
            for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call):
                    function = node.func
                    called.add(function.attr if isinstance(function, ast.Attribute)
                               else getattr(function, "id", ""))
    missing = [name for _, name in ROWS if name.split(".")[-1] not in called]
    assert not missing
