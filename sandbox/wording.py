"""Parts of messages: suggestions, lists of allowed values, quoted and printable text."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterable
from typing import Any

MAX_NAMED = 8  # names listed in a message; the rest is counted
LONGEST = 100  # characters of a name that are compared: the maximum length of a name
MAX_COMPARED = 1_000  # choices that are compared with a word; the rest is ignored
MAX_HINTED = 50  # problems of one kind that get a suggestion


class WrongValueError(ValueError):
    """A value that a scene cannot use; a :class:`sandbox.errors.Problem` once it has a path."""

    def __init__(self, code: str, message: str, *, allowed: str = "", hint: str = "") -> None:
        super().__init__(code, message)
        self.code, self.message, self.allowed, self.hint = code, message, allowed, hint

    def __str__(self) -> str:
        allowed = f" (allowed: {self.allowed})" if self.allowed else ""
        hint = f"; did you mean {self.hint}?" if self.hint else ""
        return f"{self.message}{hint}{allowed}"


def refuse_if(
    fault: object, message: str, code: str = "conflicting-keys", *, allowed: str = "",
) -> None:
    """Raise a WrongValueError where ``fault`` is true."""
    if fault:
        raise WrongValueError(code, message, allowed=allowed)


def near(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """The choice closest to ``word``, quoted, or ``""``."""
    found = nearest(word, choices, cutoff=cutoff)
    return quoted(found) if found else ""


def meant(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """A suggestion as a sentence, `` Did you mean 'mass'?``, or ``""``."""
    hint = near(word, choices, cutoff=cutoff)
    return f" Did you mean {hint}?" if hint else ""


def or_near(word: str, choices: Iterable[str]) -> str:
    """A suggestion as the end of a sentence, ``; did you mean 'mass'?``, or ``""``."""
    hint = near(word, choices)
    return f"; did you mean {hint}?" if hint else ""


def nearest(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """The choice closest to ``word``, or ``""``; letter case is ignored.

    A choice that begins with a word of three letters or more comes first, then one whose last
    parts it is, the shortest of them: ``rest`` suggests ``rest_length``, not ``breaks_at``, and
    ``pull`` suggests ``parameters.pull``. A choice of one letter is suggested for that letter only.
    """
    word = word[:LONGEST].lower()
    folded: dict[str, str] = {}
    for choice in itertools.islice(choices, MAX_COMPARED):
        if len(choice) > 1 or {choice.lower()} == {*word}:
            folded.setdefault(choice[:LONGEST].lower(), choice)
    longer = [choice for choice in folded if choice.startswith(word)] or \
        [choice for choice in folded if choice.endswith(f".{word}")]
    if len(word) >= 3 and longer:
        return folded[min(longer, key=len)]
    import difflib  # slow to load
    found = difflib.get_close_matches(word, folded, n=1, cutoff=cutoff)
    return folded[found[0]] if found else ""


class NearMisses:
    """Suggestions for the first :data:`MAX_HINTED` unknown names of an input."""

    def __init__(self, most: int = MAX_HINTED) -> None:
        self._left = most

    def __call__(self, word: str, choices: Iterable[str]) -> str:
        """As :func:`near`; ``""`` after the first ones."""
        self._left -= 1
        return near(word, choices) if self._left >= 0 else ""


def is_pattern(text: str) -> bool:
    """Whether a name has a wildcard (``*``, ``?``, ``[``)."""
    return not {"*", "?", "["}.isdisjoint(text)


def listed(choices: Iterable[str], *, most: int = MAX_NAMED) -> str:
    """The choices as ``'a', 'b', 'c'``; long lists are cut."""
    names = choices if isinstance(choices, Collection) else list(choices)
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(quoted(name) for name in itertools.islice(names, most)) + more


def quoted(value: object, *, most: int = 60) -> str:
    """The ``repr`` of a value for a one-line message: escaped, long values are cut."""
    text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
    return text if len(text) <= most else f"{text[:most]}…"


def counted(number: int, noun: str) -> str:
    """A number and its noun, ``1 spring``; ``noun`` may give the plural, ``"body|bodies"``."""
    one, _, several = noun.partition("|")
    return f"{number} {one if number == 1 else several or f'{one}s'}"


class Count(int):
    """An integer whose format is a noun: ``"{count:body|bodies}"``."""

    def __format__(self, noun: str) -> str:
        return counted(int(self), noun) if noun else str(int(self))


def printable(text: str) -> str:
    r"""A text for a terminal or a picture, with escapes (``\r``) for characters that do not print.

    These include line breaks, terminal commands, changes of the writing direction and surrogates.
    """
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)


def kind_of(value: Any) -> str:
    """The kind of a value in terms of JSON, for messages."""
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, dict):
        return "an object {…}"
    if isinstance(value, (list, tuple)):
        return "a list […]"
    if isinstance(value, str):
        return f"the text {quoted(value)}"
    if isinstance(value, (int, float)):
        many = isinstance(value, int) and abs(value) >= 10**308  # no float
        return "the number of many digits" if many else f"the number {value:.6g}"
    return f"a {type(value).__name__}"
