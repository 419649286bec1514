"""A scene's text: JSON to plain data, and where in the file each piece of it stands.

A valid file is read by :mod:`json`. Only for errors a slower scanner reads the same text: it finds
the line and column of every key and value, and describes what is not JSON (RFC 8259).
"""

from __future__ import annotations

import contextlib
import json
import math
import re
import stat
import sys
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import Any, NamedTuple, NoReturn

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import scenes_beside, shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.values.paths import JsonPath, shown_path
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted

LONGEST_NAME = 400  # characters of a path that messages show
_STRING = re.compile(r'"(?:[^"\\]|\\.)*+"?', re.DOTALL)
_FOR_SCANNER = re.compile(r"\\u[dD][89A-Fa-f]|[0-9][eE]\+?[0-9]{3}|[0-9]{300}")
"""Surrogates and huge numbers, which :mod:`json` accepts."""
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}")
_SPACE = re.compile(r"[ \t\n\r]*")
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(\.[0-9]+)?([eE][+-]?[0-9]+)?(?=[] \t\n\r,}/:\"]|$)")
_WORD = re.compile(r"[-+]?[A-Za-z_][A-Za-z0-9_]*")
_TEXT = re.compile(r'"(?:[^"\\\x00-\x1f]|\\.)*+"')  # possessive: no backtracking
_SURROGATE = re.compile("[\ud800-\udfff]")
_WORDS = {"true": True, "false": False, "null": None}


@dataclass(frozen=True)
class SceneSource:
    """A scene's data and the text that it came from (empty for data without a file)."""

    data: Any
    name: str = ""  # the file's path in messages
    text: str = ""
    limits: Limits = field(default=Limits(), repr=False)
    path: Path | None = None  # the file, if there is one; included files are relative to it

    @cached_property
    def _scan(self) -> Scan:
        return scan(self.text, self.limits.nesting, self.limits.values)

    def where(self, path: JsonPath, *, key: bool = False) -> tuple[int, int]:
        """Line and column, from 1, of the value (or key) at a path, or of its container."""
        if not self.text:
            return 0, 0
        while path and path not in self._scan.places:
            path, key = path[:-1], False
        place = self._scan.places[path]
        return self._scan.lines.at(place.key if key and place.key >= 0 else place.value)


def read_source(path: str | Path, *, limits: Limits | None = None) -> SceneSource:
    """Read and parse a scene's file."""
    limits, name, path = limits or Limits(), str(path), Path(path)
    name = name if len(name) <= LONGEST_NAME else f"{name[:LONGEST_NAME]}…"
    try:
        content = _read(path, limits)
        text = content.decode("utf-8-sig")
    except WrongValueError as error:
        raise SceneError([Problem.of(error, "$")], name) from None
    except UnicodeDecodeError as error:
        before = content[:error.start].decode("utf-8-sig", errors="replace")
        what = f"the file is not UTF-8 text (byte 0x{content[error.start]:02x})"
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            what = "the file is UTF-16 text; save it as UTF-8"
        raise SceneError([Problem("invalid-json", what, "$", *Lines(before).at(len(before)))],
                         name) from None
    return replace(parse_source(text, name=name, limits=limits), path=path)


def parse_source(text: str, *, name: str = "", limits: Limits | None = None) -> SceneSource:
    """Parse a scene's text."""
    def unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        if len(result := dict(pairs)) != len(pairs):
            raise ValueError("duplicate key")
        return result

    limits = limits or Limits()
    if not text.strip():
        raise SceneError([Problem("invalid-json",
                                  "the file is empty; a scene is an object {…}")], name)
    brackets = re.findall(r"[\[\]{}]", _STRING.sub("", text))
    depth = max(accumulate(1 if each in "[{" else -1 for each in brackets), default=0)
    if depth <= limits.nesting and not _FOR_SCANNER.search(text):
        try:
            data = json.loads(text, object_pairs_hook=unique, parse_constant=int)
            return SceneSource(data, name, text, limits)
        except (ValueError, RecursionError):
            pass  # the scanner reports what and where
    found = scan(text, limits.nesting, limits.values)
    if found.faults:
        raise SceneError(first_problems(found.faults, limits.problems), name)
    return SceneSource(found.data, name, text, limits)


def first_problems(problems: Sequence[Problem], limit: int) -> list[Problem]:
    """The first ``limit`` problems, and how many more there are."""
    more = [Problem("limit-exceeded", f"and {len(problems) - limit} more problems")]
    return [*problems[:limit], *(more if len(problems) > limit else ())]


def _read(path: Path, limits: Limits) -> bytes:
    def neighbour(path: Path) -> str:
        beside = {each.name: str(each) for each in scenes_beside(path)}
        found = near(path.name, beside)
        return repr(beside[found.strip("'\"")]) if found else near(path.stem, shipped_scenes())

    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise WrongValueError("file-not-found", "this is a directory, not a scene's file",
                                  hint=neighbour(path / "scene.json"))
        if status.st_size <= limits.file_bytes:
            with path.open("rb") as file:
                content = file.read(limits.file_bytes + 1)
            if len(content) <= limits.file_bytes:
                return content
    except (FileNotFoundError, NotADirectoryError):
        raise WrongValueError("file-not-found", "there is no such file",
                              hint=neighbour(path)) from None
    except WrongValueError:
        raise
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WrongValueError("file-not-found", f"the file cannot be read: {reason}") from None
    raise WrongValueError("limit-exceeded", "the file is larger than the limit 'file_bytes' of "
                          f"{limits.file_bytes} bytes",
                          allowed="a larger one when the limit is raised")


@dataclass
class Library:
    """The scenes beside a scene's file that it has read so far."""

    main: SceneSource
    limits: Limits
    read: dict[Path, SceneSource] = field(default_factory=dict)
    size: int = 0  # of all files together [bytes]

    def __post_init__(self) -> None:
        self.size = len(self.main.text.encode("utf-8", "surrogatepass"))

    def find(self, name: Any) -> Path:
        """The file that an ``include`` names."""
        if not isinstance(name, str):
            raise WrongValueError("bad-include",
                                  f"'include' is the name of a scene, not {kind_of(name)}")
        if self.main.path is None:
            raise WrongValueError("bad-include",
                                  "a scene that comes from no file has no folder to include from",
                                  allowed="the path of a scene's file in place of its data")
        folder, stem = self.main.path.parent, name.removesuffix(".json")
        others = [each.stem for each in scenes_beside(self.main.path)]
        if not _NAME.fullmatch(stem) or set(stem) == {"."}:
            raise WrongValueError("bad-include", f"{quoted(name)} is not the name of a scene in "
                                  "this scene's own folder", allowed="a plain name, without a "
                                  "path: files elsewhere are not read",
                                  hint=near(re.split(r"[/\\]", stem)[-1], others))
        path = folder / f"{stem}.json"
        try:
            real = path.resolve(strict=True)
            linked = real.parent != folder.resolve(strict=True)
            regular = stat.S_ISREG(real.stat().st_mode)
        except (OSError, RuntimeError):
            copied = (f"; 'sandbox new {stem}' copies the shipped one"
                      if stem in shipped_scenes() else "")
            raise WrongValueError(
                "bad-include", f"there is no scene {quoted(stem)} beside this one{copied}",
                hint=near(stem, others),
                allowed=listed(others) or "none: no other scene is in the folder") from None
        if linked:
            raise WrongValueError("bad-include", f"{quoted(path.name)} is a link that leads out of "
                                  "this scene's folder", allowed="a file of the folder itself")
        if not regular:
            raise WrongValueError("bad-include",
                                  f"{quoted(path.name)} is no file that holds a scene")
        return real

    def open(self, path: Path) -> SceneSource:
        """A scene's file."""
        if path in self.read:
            return self.read[path]
        name = str(Path(self.main.name).parent / path.name) if self.main.name else path.name
        with contextlib.suppress(OSError):  # reading it reports why
            self.size += path.stat().st_size
        if self.size > self.limits.file_bytes:
            raise WrongValueError("limit-exceeded", f"with {quoted(path.name)} the files of this "
                                  "scene are larger than the limit 'file_bytes' of "
                                  f"{self.limits.file_bytes} bytes", allowed="larger ones when the "
                                  "limit is raised")
        try:
            found = replace(read_source(path, limits=self.limits), name=name)
            if not isinstance(found.data, dict):
                raise SceneError([Problem("wrong-type", "a scene is an object {…}, not "
                                          f"{kind_of(found.data)}", "$", *found.where(()))])
        except SceneError as error:
            raise SceneError([replace(problem, file=name)
                              for problem in error.problems], name) from None
        self.read[path] = found
        return found


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


def scan(text: str, nesting: int, values: int = sys.maxsize) -> Scan:
    """Scan a JSON text with limits of the number and the nesting of its values."""
    found = Scan(text, nesting, values)
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

    def __init__(self, text: str, nesting: int, values: int) -> None:
        self.text, self.nesting, self.values = text, nesting, values
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
        if len(self.places) > self.values:
            self.fail(f"more values than the limit 'values' of {self.values}",
                      code="limit-exceeded")
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
        match = _TEXT.match(self.text, self.at)
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
