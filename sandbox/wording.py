"""What a good refusal carries besides its message: what is allowed, and a near miss."""

from __future__ import annotations

import difflib
import heapq
import itertools
import re
from collections.abc import Collection, Iterable, Sequence
from typing import Any

_WILD = re.compile(r"[*?\[]")
MOST_NAMED = 8
"""Names of a list in a message; of a longer one it says how many there are more."""
LONGEST = 100
"""Characters of a name that a near miss looks at: as many as a name may have."""
MOST_COMPARED = 2_000
"""Choices that a near miss is looked for among; further ones are left aside."""
CLOSELY = 12
"""Of these, how many are compared letter by letter, which takes long."""
LEAST_BEGUN = 3
"""Letters of a word that say which of the choices was begun."""
MOST_HINTED = 50
"""Problems of one kind that are given a near miss."""


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


TOLD = 100
"""Letters of the line that stands for a result."""


def near(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """What :func:`nearest` finds, quoted, or ``""``."""
    found = nearest(word, choices, cutoff=cutoff)
    return quoted(found) if found else ""


def meant(word: str, choices: Iterable[str]) -> str:
    """The near miss as a sentence to go on with, `` Did you mean 'mass'?``, or ``""``."""
    hint = near(word, choices)
    return f" Did you mean {hint}?" if hint else ""


def or_near(word: str, choices: Iterable[str]) -> str:
    """The near miss behind what is wrong, ``; did you mean 'mass'?``, or ``""``."""
    hint = near(word, choices)
    return f"; did you mean {hint}?" if hint else ""


def nearest(word: str, choices: Iterable[str], *, cutoff: float = 0.6) -> str:
    """The choice most like ``word``, or ``""``; letter case counts for nothing.

    What begins with the whole word comes first, the shortest of it: who writes ``rest`` means
    ``rest_length`` and not ``breaks_at``, which has more letters in common. One letter, such as a
    joint's ``a``, is no near miss of a word with another: it is half of any word of two.

    Of many choices the most :func:`alike` are compared, so that it takes no longer than
    :data:`MOST_COMPARED` and :data:`CLOSELY` allow, however many there are.
    """
    folded: dict[str, str] = {}
    for choice in itertools.islice(choices, MOST_COMPARED):
        folded.setdefault(choice[:LONGEST].lower(), choice)
    word = word[:LONGEST].lower()
    longer = [choice for choice in folded if choice.startswith(word)]
    if len(word) >= LEAST_BEGUN and longer:
        return folded[min(longer, key=len)]
    close = [choice for choice in alike(word, folded) if len(choice) > 1 or {*choice} == {*word}]
    found = difflib.get_close_matches(word, close, n=1, cutoff=cutoff)
    return folded[found[0]] if found else ""


def alike(word: str, choices: Iterable[str], *, most: int = CLOSELY) -> list[str]:
    """Those of the choices that begin and end most like a word, in their own order.

    A slip of the pen leaves most of what is before and behind it as it was.
    """
    some = list(itertools.islice(choices, MOST_COMPARED))
    if len(some) <= most:
        return some
    drow = word[::-1]
    best = heapq.nlargest(most, range(len(some)), key=lambda i: min(
        _begin_alike(word, some[i]) + _begin_alike(drow, some[i][::-1]), len(word), len(some[i])))
    return [some[i] for i in sorted(best)]


def _begin_alike(one: str, other: str) -> int:
    """How many letters two words begin with alike."""
    low, high = 0, min(len(one), len(other))
    if one[:1] != other[:1]:
        return 0
    while low < high:
        middle = (low + high + 1) // 2
        low, high = (middle, high) if one[:middle] == other[:middle] else (low, middle - 1)
    return low


class NearMisses:
    """Near misses for the first :data:`MOST_HINTED` unknown names; later ones get none.

    Somebody has to read them: a file in which every name is wrong is no slip of the pen.
    """

    def __init__(self, most: int = MOST_HINTED) -> None:
        self._left = most

    def __call__(self, word: str, choices: Iterable[str]) -> str:
        """What :func:`near` finds, as long as there is somebody to read it."""
        self._left -= 1
        return near(word, choices) if self._left >= 0 else ""


def is_pattern(text: str) -> bool:
    """Whether a name has a wildcard (``*``, ``?``, ``[``)."""
    return _WILD.search(text) is not None


def listed(choices: Iterable[str], *, most: int = MOST_NAMED) -> str:
    """The choices as ``'a', 'b', 'c'``, cut short when there are many."""
    names = choices if isinstance(choices, Collection) else list(choices)
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(quoted(name) for name in itertools.islice(names, most)) + more


def quoted(value: object, *, most: int = 60) -> str:
    """A value as it may stand in a one-line message: escaped, and cut when long."""
    text = ascii(value) if isinstance(value, str) and not value.isprintable() else repr(value)
    return text if len(text) <= most else f"{text[:most]}…"


def counted(number: int, noun: str) -> str:
    """A number of things: ``1 spring``, ``3 springs``.

    >>> print(counted(1, "body|bodies"), counted(2, "body|bodies"))
    1 body 2 bodies

    Args:
        number: of them.
        noun: what one is; after a bar what several are, where that is not ``s`` more.
    """
    one, _, several = noun.partition("|")
    return f"{number} {one if number == 1 else several or f'{one}s'}"


class Count(int):
    """A number that text is formatted with by what it counts: ``"{count:body|bodies}"``."""

    def __format__(self, noun: str) -> str:
        return counted(int(self), noun) if noun else str(int(self))


def told_of(thing: object, lines: Sequence[str]) -> str:
    """A result in a line: what it is and the first of what it says."""
    first = lines[0].strip() if lines else "nothing"
    first = first if len(first) <= TOLD else f"{first[:TOLD]}…"
    return f"<{type(thing).__name__}: {first}>"


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


def percent(share: float) -> str:
    """A share in percent, to two digits below 10 %: ``0.0016`` is ``"0.16 %"``."""
    hundred = 100 * share
    return f"{hundred:.0f} %" if hundred >= 9.95 else f"{hundred:.2g} %"
