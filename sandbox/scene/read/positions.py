"""A JSON scanner that records positions and describes syntax errors (RFC 8259).

It walks the text with a stack of its own, so that no nesting can exhaust
Python's. Faults of content (a key twice, NaN) are collected; the first fault
of form ends the scan, since nothing after it can be trusted.
"""

from __future__ import annotations

import json
import math
import re
import sys
from dataclasses import dataclass, field
from typing import Any

from sandbox.values.paths import JsonPath

_SPACE = re.compile(r"[ \t\n\r]*")
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?")
_WORD = re.compile(r"[-+]?[A-Za-z_][A-Za-z0-9_]*")
_STRING = re.compile(r'"(?:[^"\\\x00-\x1f]|\\.)*+"')  # possessive: no way back is remembered
_HALF = re.compile("[\ud800-\udfff]")
_WORDS = {"true": True, "false": False, "null": None}
_NOT_FINITE = {"nan", "inf", "infinity"}


def half_character(text: str) -> str:
    """What is wrong with a text that no file can be written with, or ``""``.

    JSON spells a character beyond U+FFFF as two halves; one alone is a character of nothing.
    """
    found = _HALF.search(text)
    return f"the text has half a character (\\u{ord(found.group()):04x}) in it" if found else ""


@dataclass(frozen=True, slots=True)
class Place:
    """Offsets of a value, and of its key (-1 where it has none)."""

    value: int
    key: int = -1


@dataclass(frozen=True)
class Fault:
    """Something wrong at an offset of the text.

    ``other`` is the offset of a second place, ``{place}`` in the message.
    """

    message: str
    offset: int
    path: JsonPath
    other: int | None = None
    code: str = "invalid-json"


@dataclass
class Scan:
    """What a scan found: the data, the place of every value, and all faults."""

    data: Any = None
    places: dict[JsonPath, Place] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)


class _FormError(Exception):
    def __init__(self, message: str, offset: int, other: int | None = None,
                 code: str = "invalid-json") -> None:
        super().__init__(message)
        self.message, self.offset, self.other, self.code = message, offset, other, code


def scan(text: str, nesting: int, most: int = sys.maxsize) -> Scan:
    """Scan a JSON text of at most ``most`` values whose brackets nest at most ``nesting`` deep."""
    scanner = _Scanner(text, nesting, most)
    try:
        scanner.run()
    except _FormError as error:
        scanner.found.faults.append(
            Fault(error.message, error.offset, scanner.path, error.other, error.code))
    return scanner.found


class _Scanner:
    """The state of a scan: the offset, and the containers that are open."""

    def __init__(self, text: str, nesting: int, most: int) -> None:
        self.text, self.nesting, self.most = text, nesting, most
        self.at = 0
        self.path: JsonPath = ()
        self.open: list[tuple[dict[str, Any] | list[Any], JsonPath, int]] = []
        self.found = Scan()

    def run(self) -> None:
        self._space()
        self.found.data = self._value(Place(self.at))
        while self.open:
            self._member()
        self._space()
        if self.at < len(self.text):
            raise _FormError("there is more text after the end of the scene", self.at)

    def _space(self) -> str:
        """Skip white space; the character that follows, or ``""`` at the end."""
        match = _SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at
        char = self.text[self.at:self.at + 1]
        if char == "/" and self.text[self.at + 1:self.at + 2] in ("/", "*"):
            raise _FormError('JSON has no comments; use "about"', self.at)
        return char

    def _value(self, place: Place) -> Any:
        """Read the value at the offset; a container is opened and filled later."""
        self.found.places[self.path] = place
        if len(self.found.places) > self.most:
            raise _FormError(f"more values than the limit 'values' of {self.most}", self.at,
                             code="limit-exceeded")
        char = self.text[self.at:self.at + 1]
        if char in ("{", "["):
            if len(self.open) >= self.nesting:
                raise _FormError(f"nested deeper than the limit 'nesting' of {self.nesting}",
                                 self.at, code="limit-exceeded")
            value: dict[str, Any] | list[Any] = {} if char == "{" else []
            self.open.append((value, self.path, self.at))
            self.at += 1
            return value
        if char == '"':
            return self._string()
        return self._scalar()

    def _member(self) -> None:
        """Read the next member of the innermost container, or its end."""
        container, self.path, start = self.open[-1]
        closing, kind = ("}", "object") if isinstance(container, dict) else ("]", "list")
        char = self._next(kind, start)
        if char == closing:
            self._close()
            return
        if container:
            if char != ",":
                raise _FormError(
                    f"expected a comma or '{closing}' here; is a comma missing?", self.at)
            comma = self.at
            self.at += 1
            if self._next(kind, start) == closing:
                raise _FormError(f"a comma before '{closing}' is one too many", comma)
        if isinstance(container, dict):
            self._entry(container)
        else:
            self.path = (*self.path, len(container))
            container.append(self._value(Place(self.at)))

    def _next(self, kind: str, start: int) -> str:
        char = self._space()
        if not char:
            raise _FormError(
                f"the file ends inside the {kind} that begins at {{place}}", self.at, start)
        return char

    def _close(self) -> None:
        self.open.pop()
        self.at += 1

    def _entry(self, container: dict[str, Any]) -> None:
        """Read ``"key": value`` of an object."""
        key_at, parent = self.at, self.path
        if self.text[key_at] != '"':
            raise _FormError('expected a key in double quotes, such as "name"', key_at)
        key = self._string()
        start = self.open[-1][2]
        if self._next("object", start) != ":":
            raise _FormError(f"expected ':' after the key {json.dumps(key[:60])}", self.at)
        self.at += 1
        self._next("object", start)
        self.path = (*parent, key)
        if key in container:
            self.found.faults.append(Fault(
                f"the key {json.dumps(key[:60])} is repeated, first at {{place}}",
                key_at, self.path, self.found.places[self.path].key))
        container[key] = None  # the first key of an object makes a comma due, whatever follows
        container[key] = self._value(Place(self.at, key_at))

    def _string(self) -> str:
        match = _STRING.match(self.text, self.at)
        try:
            if match:
                text = match.group()
                value: str = json.loads(text) if "\\" in text else text[1:-1]
                if half := half_character(value):
                    self.found.faults.append(Fault(half, self.at, self.path))
                self.at = match.end()
                return value
        except ValueError:
            raise _FormError("this text has an unknown escape after a backslash", self.at) from None
        line = self.text.find("\n", self.at)
        cut = f"the text that begins here has no closing {chr(34)} on its line"
        if line < 0 and self.text.find('"', self.at + 1) < 0:
            cut = "the file ends inside the text that begins here"
        raise _FormError(cut, self.at)

    def _scalar(self) -> Any:
        if word := _WORD.match(self.text, self.at):
            return self._word(word)
        number = _NUMBER.match(self.text, self.at)
        if number is None or _leads_on(self.text, number.end()):
            raise _FormError(self._not_a_value(), self.at)
        start, self.at = self.at, number.end()
        try:
            whole = number.group(1) is None and number.group(2) is None
            value: float = int(number.group()) if whole else float(number.group())
            if math.isfinite(value):
                return value
        except (OverflowError, ValueError):
            pass
        self.found.faults.append(Fault("this number is too large", start, self.path))
        return 0.0

    def _word(self, word: re.Match[str]) -> Any:
        text = word.group()
        if text in _WORDS:
            self.at = word.end()
            return _WORDS[text]
        if text.lstrip("+-").lower() not in _NOT_FINITE:
            hint = f"; write {text.lower()}" if text.lower() in _WORDS else ""
            raise _FormError(
                f"{text[:40]} is not a value: put text in double quotes{hint}", self.at)
        self.found.faults.append(Fault(
            f"{text} is not a number that a scene can use", self.at, self.path))
        self.at = word.end()
        return 0.0

    def _not_a_value(self) -> str:
        char = self.text[self.at:self.at + 1]
        if char == "'":
            return 'put text in double quotes ("…"), not in single quotes'
        if char == "=":
            return 'put an expression in double quotes: "=pull / 2"'
        if char in "+.0123456789-" and char:
            return "this is not a JSON number (write 0.5, -2, 1e-3)"
        if char in (",", "}", "]", ":"):
            return f"a value is missing before '{char}'"
        return "expected a value: a number, \"text\", {…}, […], true, false or null"


def _leads_on(text: str, end: int) -> bool:
    """Whether a number is followed by what belongs to neither it nor its surroundings."""
    return text[end:end + 1] not in ("", " ", "\t", "\n", "\r", ",", "]", "}", "/", ":", '"')
