"""Near misses: what was meant by a name that there is not."""

from __future__ import annotations

import pytest

from sandbox.wording import meant, near, nearest, quoted

SPRING = ("name", "a", "b", "stiffness", "damping", "rest_length", "breaks_at", "released")


@pytest.mark.parametrize(("word", "choice"), [
    ("rest", "rest_length"),  # which has less in common with it, letter by letter, than breaks_at
    ("REST", "rest_length"),
    ("stiff", "stiffness"),
    ("brakes_at", "breaks_at"),
    ("length", "rest_length"),
    ("at", ""),  # a single letter is half of it
    ("A", "a"),
    ("bb", "b"),
    ("st", ""),  # two letters are not enough to tell what was begun
    ("colour", ""),
])
def test_suggestions(word: str, choice: str) -> None:
    assert nearest(word, SPRING) == choice
    assert near(word, SPRING) == (repr(choice) if choice else "")
    assert meant(word, SPRING) == (f" Did you mean {choice!r}?" if choice else "")


def test_quoted_names_keep_their_letters_and_lose_control_characters() -> None:
    assert quoted("größe") == "'größe'"
    assert quoted("ö\n\x1b") == r"'\xf6\n\x1b'"
