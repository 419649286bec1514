"""Numbers, comments and names of a model."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import pytest

from sandbox.export.names import UniqueNames
from sandbox.export.xmltext import add, comment, document, number


@pytest.mark.parametrize(("value", "text"), [
    (0.0, "0"), (-0.0, "0"), (0.1, "0.1"), (1 / 3, "0.333333333333"), (1e-9, "1e-09"),
    (-2.5, "-2.5"), (1e6, "1000000"),
])
def test_numbers(value: float, text: str) -> None:
    assert number(value) == text


def test_any_title_can_stand_in_a_comment() -> None:
    root = ET.Element("a")
    root.append(comment("x -- y ----\x00\x07 <&> -"))
    add(root, "empty")
    again = ET.fromstring(document(root))
    assert len(again) == 0


def test_names_give_way_to_the_scene_s() -> None:
    names = UniqueNames(["load.x"])
    assert names.made("joint", "load.x") == "load.x_"
    assert names.made("joint", "load.x") == "load.x__"
    assert names.made("joint", "load.y") == "load.y"
    assert names.made("site", "load.y") == "load.y"
