"""A scene's text: JSON to plain data, and where in the file each piece of it stands.

A valid file is read by :mod:`json`. For messages, a slower scan of the text finds the line and
column of every key and value, and describes what is not JSON (RFC 8259).
"""

from __future__ import annotations

import contextlib
import json
import math
import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate, count
from pathlib import Path
from typing import Any, NoReturn

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import scenes_beside, shipped_scenes, similar_scene
from sandbox.scene.read.limits import Limits
from sandbox.values.paths import JsonPath, path_text
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted, refuse_if

_STRING = re.compile(r'"(?:[^"\\]|\\.)*+"?', re.DOTALL)
_FOR_SCAN = re.compile(r"\\u[dD][89A-Fa-f]|[0-9][eE]\+?[0-9]{3}|[0-9]{300}")
"""Surrogates and huge numbers, which :mod:`json` accepts."""
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}")
_TOKEN = re.compile(r'"(?:[^"\\\x00-\x1f]|\\.)*+"|["\][{}:,]|[^][{}:," \t\n\r]+')
_NUMBER = re.compile(r"-?(?:0|[1-9][0-9]*)(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?")
_WORD = re.compile(r"[-+]?[A-Za-z_][A-Za-z0-9_]*")
_WORDS = ("true", "false", "null")
_NO_VALUE = {"'": 'put text in double quotes ("…"), not in single quotes',
             "=": 'put an expression in double quotes: "=pull / 2"',
             "+.0123456789-": "this is not a JSON number (write 0.5, -2, 1e-3)",
             ",}]:": "a value is missing before this"}
"""What is wrong with a token that is no value, by its first character."""


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
        return Scan(self.text, self.limits)

    def where(self, path: JsonPath, *, key: bool = False) -> tuple[int, int]:
        """Line and column, from 1, of the value (or key) at a path, or of its container."""
        if not self.text:
            return 0, 0
        while path and path not in self._scan.places:
            path, key = path[:-1], False
        value, of_key = self._scan.places[path]
        return self._scan.position(of_key if key and of_key >= 0 else value)


def read_source(path: str | Path, *, limits: Limits | None = None) -> SceneSource:
    """Read and parse a scene's file."""
    limits, name, path = limits or Limits(), str(path), Path(path)
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
        raise SceneError([Problem("invalid-json", what, "$", before.count("\n") + 1,
                                  len(before) - before.rfind("\n"))], name) from None
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
    try:
        if depth > limits.nesting or _FOR_SCAN.search(text):
            raise ValueError
        data = json.loads(text, object_pairs_hook=unique, parse_constant=int)
    except RecursionError:
        raise SceneError([Problem("limit-exceeded", "nested too deep to be read")], name) from None
    except ValueError:
        if faults := Scan(text, limits).faults:
            raise SceneError(first_problems(faults, limits.problems), name) from None
        data = json.loads(text)
    found = SceneSource(data, name, text, limits)
    if not isinstance(data, dict):
        raise SceneError([Problem("wrong-type", f"a scene is an object {{…}}, not {kind_of(data)}",
                                  "$", *found.where(()))], name)
    return found


def first_problems(problems: Sequence[Problem], limit: int) -> list[Problem]:
    """The first ``limit`` problems, and how many more there are."""
    more = [Problem("limit-exceeded", f"and {len(problems) - limit} more problems")]
    return [*problems[:limit], *(more if len(problems) > limit else ())]


def _read(path: Path, limits: Limits) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(limits.file_bytes + 1)
    except IsADirectoryError:
        raise WrongValueError("file-not-found", "this is a directory, not a scene's file",
                              hint=similar_scene(path / "scene.json")) from None
    except (FileNotFoundError, NotADirectoryError):
        raise WrongValueError(
            "file-not-found", "there is no such file", hint=similar_scene(path)) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise WrongValueError("file-not-found", f"the file cannot be read: {reason}") from None
    refuse_if(len(content) > limits.file_bytes, "the file is larger than the limit 'file_bytes' of "
              f"{limits.file_bytes} bytes", "limit-exceeded",
              allowed="a larger one when the limit is raised")
    return content


@dataclass
class Library:
    """The scenes beside a scene's file that it has read so far."""

    main: SceneSource
    read: dict[Path, SceneSource] = field(default_factory=dict)

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
            own = real.parent == folder.resolve(strict=True) and real.is_file()
        except (OSError, RuntimeError):
            copied = (f"; 'sandbox new {stem}' copies the shipped one"
                      if stem in shipped_scenes() else "")
            raise WrongValueError(
                "bad-include", f"there is no scene {quoted(stem)} beside this one{copied}",
                hint=near(stem, others),
                allowed=listed(others) or "none: no other scene is in the folder") from None
        refuse_if(not own, f"{quoted(path.name)} is a link that leads out of this scene's folder, "
                  "or no file", "bad-include", allowed="a file of the folder itself")
        return real

    def open(self, path: Path) -> SceneSource:
        """A scene's file."""
        if path in self.read:
            return self.read[path]
        name = str(Path(self.main.name).parent / path.name) if self.main.name else path.name
        try:
            found = replace(read_source(path, limits=self.main.limits), name=name)
        except SceneError as error:
            raise SceneError([replace(problem, file=name)
                              for problem in error.problems], name) from None
        maximum = self.main.limits.file_bytes
        size = sum(len(each.text) for each in (self.main, found, *self.read.values()))
        refuse_if(size > maximum, f"with {quoted(path.name)} the files of this scene are "
                  f"larger than the limit 'file_bytes' of {maximum} bytes",
                  "limit-exceeded", allowed="larger ones when the limit is raised")
        self.read[path] = found
        return found


class _SyntaxError(Exception):
    """The text cannot be read any further."""


class Scan:
    """The place of every value of a JSON text, and all faults up to the first of its syntax."""

    def __init__(self, text: str, limits: Limits) -> None:
        self.text, self.limits = text, limits
        self.lines = [0, *(match.end() for match in re.finditer("\n", text))]
        """Offsets of the first characters of all lines."""
        self.places: dict[JsonPath, tuple[int, int]] = {}
        """Offsets of each value and of its key (-1 without one)."""
        self.faults: list[Problem] = []
        self._tokens = _TOKEN.finditer(text)
        with contextlib.suppress(_SyntaxError):
            self._value((), *self._next(()))
            token, at = self._next(())
            if token:
                self._fail((), "there is more text after the end of the scene", at)

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of an offset."""
        line = bisect_right(self.lines, offset)
        return line, offset - self.lines[line - 1] + 1

    def _note(self, path: JsonPath, message: str, at: int, code: str = "invalid-json") -> None:
        self.faults.append(Problem(code, message, path_text(path), *self.position(at)))

    def _fail(self, path: JsonPath, message: str, at: int, code: str = "invalid-json") -> NoReturn:
        self._note(path, message, at, code)
        raise _SyntaxError

    def _next(self, path: JsonPath, inside: int = -1) -> tuple[str, int]:
        """The next token and its offset; ``inside`` is that of the bracket around it."""
        if match := next(self._tokens, None):
            token, at = match.group(), match.start()
            if token[0] != '"' and (comment := re.search(r"//|/\*", token)):
                self._fail(path, 'JSON has no comments; use "about"', at + comment.start())
            return token, at
        if inside >= 0:
            line, column = self.position(inside)
            kind = "object" if self.text[inside] == "{" else "list"
            self._fail(path, f"the file ends inside the {kind} that begins at line {line}, column "
                       f"{column}", len(self.text))
        return "", len(self.text)

    def _value(self, path: JsonPath, token: str, at: int, key: int = -1) -> None:
        self.places[path] = at, key
        if len(self.places) > self.limits.values:
            self._fail(path, f"more values than the limit 'values' of {self.limits.values}", at,
                       "limit-exceeded")
        if token in ("[", "{"):
            if len(path) >= self.limits.nesting:
                self._fail(path, f"nested deeper than the limit 'nesting' of {self.limits.nesting}",
                           at, "limit-exceeded")
            self._entries(path, "}" if token == "{" else "]", at)
        elif token[:1] == '"':
            self._string(path, token, at)
        elif word := _WORD.match(token):
            text = word.group()
            if text.lstrip("+-").lower() in ("nan", "inf", "infinity"):
                self._note(path, f"{text} is not a number that a scene can use", at)
            elif text not in _WORDS:
                hint = f"; write {text.lower()}" if text.lower() in _WORDS else ""
                self._fail(path, f"{text[:40]} is not a value: put text in double quotes{hint}", at)
        elif not _NUMBER.fullmatch(token):
            self._fail(path, next(
                (what for begin, what in _NO_VALUE.items() if token[0] in begin),
                'expected a value: a number, "text", {…}, […], true, false or null'), at)
        elif math.isinf(float(token)):
            self._note(path, "this number is too large", at)

    def _entries(self, path: JsonPath, closing: str, start: int) -> None:
        """All entries of the object or list that begins at ``start``."""
        keys: dict[str, int] = {}
        token, at = self._next(path, start)
        if token == closing:
            return
        for number in count():
            step: str | int = number
            key = -1
            if closing == "}":
                if token[0] != '"':
                    self._fail(path, 'expected a key in double quotes, such as "name"', at)
                name = self._string(path, token, at)
                step, key = name, at
                if keys.setdefault(name, key) != key:
                    line, column = self.position(keys[name])
                    self._note((*path, name), f"the key {json.dumps(name[:60])} is repeated, first "
                               f"at line {line}, column {column}", at)
                token, at = self._next(path, start)
                if token != ":":
                    self._fail(path, f"expected ':' after the key {json.dumps(name[:60])}", at)
                token, at = self._next(path, start)
            self._value((*path, step), token, at, key)
            token, comma = self._next(path, start)
            if token == closing:
                return
            if token != ",":
                self._fail(path, f"expected a comma or '{closing}' here; is a comma missing?",
                           comma)
            token, at = self._next(path, start)
            if token == closing:
                self._fail(path, f"a comma before '{token}' is one too many", comma)

    def _string(self, path: JsonPath, token: str, at: int) -> str:
        try:
            value = str(json.loads(token))
        except ValueError:
            if len(token) > 1:
                self._fail(path, "this text has an unknown escape after a backslash", at)
            ended = not {"\n", '"'} & {*self.text[at + 1:]}
            self._fail(path, "the file ends inside the text that begins here" if ended else
                       'the text that begins here has no closing " on its line', at)
        if any("\ud800" <= each <= "\udfff" for each in value):
            self._note(path, "the text has half a character (a surrogate) in it", at)
        return value
