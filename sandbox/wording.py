"""What a good refusal carries besides its message: what is allowed, and a near miss."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from typing import Any

MOST_NAMED = 12


class WrongValueError(ValueError):
    """A value that a scene cannot use.

    ``message`` says what is wrong; ``allowed`` what would be right; ``hint``
    the near miss. The three end up in a :class:`sandbox.errors.Problem`.
    """

    def __init__(self, message: str, *, allowed: str = "", hint: str = "") -> None:
        super().__init__(message)
        self.message, self.allowed, self.hint = message, allowed, hint

    def __str__(self) -> str:
        allowed = f" (allowed: {self.allowed})" if self.allowed else ""
        hint = f"; did you mean {self.hint}?" if self.hint else ""
        return f"{self.message}{hint}{allowed}"


def near(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """The choice most like ``word``, quoted, or ``""``; letter case counts for nothing."""
    folded: dict[str, str] = {}
    for choice in choices:
        folded.setdefault(choice.lower(), choice)
    found = difflib.get_close_matches(word[:100].lower(), folded, n=1, cutoff=cutoff)
    return quoted(folded[found[0]]) if found else ""


def listed(choices: Iterable[str], *, most: int = MOST_NAMED) -> str:
    """The choices as ``'a', 'b', 'c'``, cut short when there are many."""
    names = list(choices)
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(quoted(name) for name in names[:most]) + more


def quoted(value: object, *, most: int = 60) -> str:
    """A value as it may stand in a one-line message: escaped, and cut when long."""
    text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
    return text if len(text) <= most else f"{text[:most]}…"


def printable(text: str) -> str:
    r"""A text on one line of a terminal, or in a picture: what does not print is spelled out.

    Line breaks, what moves the cursor or begins a command of the terminal (ESC), what turns the
    direction of writing (U+202E) or takes no room, and halves of characters.

    >>> print(printable("ok\rFAIL"))
    ok\rFAIL
    """
    if text.isprintable():
        return text
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def kind_of(value: Any) -> str:
    """What a value is, in the words of a scene's author."""
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, dict):
        return "an object {…}"
    if isinstance(value, (list, tuple)):
        return "a list […]"
    if isinstance(value, str):
        return f"the text {quoted(value)}"
    if isinstance(value, (int, float)):
        return f"the number {number_text(value)}"
    return f"a {type(value).__name__}"


def number_text(value: float) -> str:
    """A number short enough for a message, however long its digits are."""
    try:
        return f"{value:.6g}"
    except OverflowError:
        return "of many digits"
