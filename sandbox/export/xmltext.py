"""Numbers and comments as XML wants them."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from typing import cast

DIGITS = 12


def number(value: float) -> str:
    """A number with :data:`DIGITS` digits; never ``-0``."""
    return f"{value + 0.0:.{DIGITS}g}" if value else "0"


def text_of(value: str | bool | float | Sequence[float]) -> str:
    """The text of an attribute: a word, a truth, a number, or numbers in a row."""
    if isinstance(value, str):
        return _plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return number(value)
    return " ".join(number(v) for v in value)


Value = str | bool | float | Sequence[float] | None


def element(tag: str, /, **attributes: Value) -> ET.Element:
    """A new element; an attribute that is None is left out."""
    return ET.Element(tag, {
        key: text_of(value) for key, value in attributes.items() if value is not None})


def add(parent: ET.Element, tag: str, /, **attributes: Value) -> ET.Element:
    """A new element (see :func:`element`) at the end of ``parent``."""
    made = element(tag, **attributes)
    parent.append(made)
    return made


def _plain(text: str, kept: str = "") -> str:
    """The text with a blank for what does not print, most of which XML forbids, but ``kept``."""
    return "".join(c if c.isprintable() or c in kept else " " for c in text)


def comment(text: str) -> ET.Element:
    """A comment; what XML forbids in one is replaced."""
    plain = _plain(text, "\n")
    while "--" in plain:
        plain = plain.replace("--", "- -")
    return cast("ET.Element", ET.Comment(f" {plain} "))


def document(root: ET.Element) -> str:
    """The whole file's text, two spaces a level, a line feed at its end.

    Sections without content are dropped.
    """
    for section in list(root):
        if not len(section) and not section.attrib and not section.text:
            root.remove(section)
    ET.indent(root, "  ")
    return ET.tostring(root, encoding="unicode", xml_declaration=False) + "\n"
