"""A JSON scanner that records positions and describes syntax errors (RFC 8259).

Faults of content (a repeated key, NaN) are collected. The first syntax error ends the scan, since
nothing after it can be trusted.
"""

from __future__ import annotations

import json
import math
import re
import sys
from bisect import bisect_right
from functools import cached_property
from typing import Any, NamedTuple, NoReturn

from sandbox.errors import Problem
from sandbox.values.paths import JsonPath, shown_path

_SPACE = re.compile(r"[ \t\n\r]*")
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?(?=[] \t\n\r,}/:\"]|$)")
_WORD = re.compile(r"[-+]?[A-Za-z_][A-Za-z0-9_]*")
_STRING = re.compile(r'"(?:[^"\\\x00-\x1f]|\\.)*+"')  # possessive: no backtracking
_SURROGATE = re.compile("[\ud800-\udfff]")
_WORDS = {"true": True, "false": False, "null": None}


def half_character(text: str) -> str:
    """The fault of a text with a lone surrogate, which no file can hold; empty without one."""
    found = _SURROGATE.search(text)
    return f"the text has half a character (\\u{ord(found.group()):04x}) in it" if found else ""


class Lines:
    """Lines of a text."""

    def __init__(self, text: str) -> None:
        self.text = text

    @cached_property
    def _starts(self) -> list[int]:
        return [0, *(match.end() for match in re.finditer("\n", self.text))]

    def at(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of an offset."""
        line = bisect_right(self._starts, offset)
        return line, offset - self._starts[line - 1] + 1


class Place(NamedTuple):
    """Offsets of a value, and of its key (-1 without one)."""

    value: int
    key: int = -1


class _SyntaxError(Exception):
    """The text cannot be read any further."""


def scan(text: str, nesting: int, most: int = sys.maxsize) -> Scan:
    """Scan a JSON text of at most ``most`` values whose brackets nest at most ``nesting`` deep."""
    found = Scan(text, nesting, most)
    try:
        found.space()
        found.data = found.value(0)
        if found.space():
            found.fail("there is more text after the end of the scene")
    except _SyntaxError:
        pass  # it is among the faults
    except RecursionError:
        found.note("nested too deep to be read", found.at, "limit-exceeded")
    return found


class Scan:
    """A scan of a text: the data, the place of every value, and all faults so far."""

    def __init__(self, text: str, nesting: int, most: int) -> None:
        self.text, self.nesting, self.most = text, nesting, most
        self.data: Any = None
        self.places: dict[JsonPath, Place] = {}
        self.faults: list[Problem] = []
        self.lines = Lines(text)
        self.at = 0
        self.path: JsonPath = ()

    def note(self, message: str, offset: int, code: str = "invalid-json") -> None:
        """Collect a fault at an offset."""
        self.faults.append(Problem(code, message, shown_path(self.path), *self.lines.at(offset)))

    def fail(
        self, message: str, offset: int | None = None, code: str = "invalid-json",
    ) -> NoReturn:
        """End the scan with a fault, by default at the current offset."""
        self.note(message, self.at if offset is None else offset, code)
        raise _SyntaxError

    def space(self) -> str:
        """Skip white space; the character that follows, or ``""`` at the end."""
        match = _SPACE.match(self.text, self.at)
        self.at = match.end() if match else self.at
        if self.text.startswith(("//", "/*"), self.at):
            self.fail('JSON has no comments; use "about"')
        return self.text[self.at:self.at + 1]

    def value(self, depth: int, key: int = -1) -> Any:
        """Read the value at the offset, with its key at another one."""
        self.places[self.path] = Place(self.at, key)
        if len(self.places) > self.most:
            self.fail(f"more values than the limit 'values' of {self.most}", code="limit-exceeded")
        char = self.text[self.at:self.at + 1]
        if char == '"':
            return self.string()
        if char not in ("{", "["):
            return self.scalar()
        if depth >= self.nesting:
            self.fail(f"nested deeper than the limit 'nesting' of {self.nesting}",
                      code="limit-exceeded")
        return self.container(depth, char == "{")

    def container(self, depth: int, is_object: bool) -> Any:
        """Read an object or a list."""
        start, path = self.at, self.path
        closing, kind = ("}", "object") if is_object else ("]", "list")
        entries: dict[str, Any] = {}
        items: list[Any] = []

        def following() -> str:
            if not (char := self.space()):
                line, column = self.lines.at(start)
                self.fail(f"the file ends inside the {kind} that begins at line {line}, column "
                          f"{column}")
            return char

        self.at += 1
        while (char := following()) != closing:
            if entries or items:
                if char != ",":
                    self.fail(f"expected a comma or '{closing}' here; is a comma missing?")
                comma, self.at = self.at, self.at + 1
                if following() == closing:
                    self.fail(f"a comma before '{closing}' is one too many", comma)
            if not is_object:
                self.path = (*path, len(items))
                items.append(self.value(depth + 1))
            else:
                key_at = self.at
                if self.text[key_at] != '"':
                    self.fail('expected a key in double quotes, such as "name"')
                key = self.string()
                if following() != ":":
                    self.fail(f"expected ':' after the key {json.dumps(key[:60])}")
                self.at += 1
                following()
                self.path = (*path, key)
                if key in entries:
                    line, column = self.lines.at(self.places[self.path].key)
                    self.note(f"the key {json.dumps(key[:60])} is repeated, first at line {line}, "
                              f"column {column}", key_at)
                entries[key] = self.value(depth + 1, key_at)
            self.path = path
        self.at += 1
        return entries if is_object else items

    def string(self) -> str:
        """Read a text."""
        match = _STRING.match(self.text, self.at)
        try:
            if match:
                value: str = json.loads(match.group())
                if half := half_character(value):
                    self.note(half, self.at)
                self.at = match.end()
                return value
        except ValueError:
            self.fail("this text has an unknown escape after a backslash")
        rest = self.text[self.at + 1:]
        self.fail("the file ends inside the text that begins here" if not {"\n", '"'} & {*rest} else
                  f"the text that begins here has no closing {chr(34)} on its line")

    def scalar(self) -> Any:
        """Read a number or a word."""
        start = self.at
        if word := _WORD.match(self.text, start):
            text, self.at = word.group(), word.end()
            if text in _WORDS:
                return _WORDS[text]
            if text.lstrip("+-").lower() not in ("nan", "inf", "infinity"):
                hint = f"; write {text.lower()}" if text.lower() in _WORDS else ""
                self.fail(f"{text[:40]} is not a value: put text in double quotes{hint}", start)
            self.note(f"{text} is not a number that a scene can use", start)
            return 0.0
        number = _NUMBER.match(self.text, start)
        if number is None:
            self.fail(_not_a_value(self.text[start:start + 1]))
        self.at = number.end()
        try:
            value: float = float(number[0]) if number[1] or number[2] else int(number[0])
            if math.isfinite(value):
                return value
        except (OverflowError, ValueError):
            pass
        self.note("this number is too large", start)
        return 0.0


def _not_a_value(char: str) -> str:
    """The fault of a character that begins no value."""
    if char == "'":
        return 'put text in double quotes ("…"), not in single quotes'
    if char == "=":
        return 'put an expression in double quotes: "=pull / 2"'
    if char and char in "+.0123456789-":
        return "this is not a JSON number (write 0.5, -2, 1e-3)"
    if char in (",", "}", "]", ":"):
        return f"a value is missing before '{char}'"
    return "expected a value: a number, \"text\", {…}, […], true, false or null"
