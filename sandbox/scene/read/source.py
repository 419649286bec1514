"""A scene's text: JSON to plain data, and where in the file each piece of it stands.

A valid file is read by :mod:`json`. Only for errors a slower scanner reads the same
text. It finds the line and column of every key and value, and describes what is
not JSON (RFC 8259).
"""

from __future__ import annotations

import json
import re
import stat
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import scenes_beside, shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.positions import Lines, Place, scan
from sandbox.values.paths import JsonPath
from sandbox.wording import near

MOST_NAME = 400
"""Characters of a path that messages show."""
_STRING = re.compile(r'"(?:[^"\\]|\\.)*+"?', re.DOTALL)
_BRACKETS = re.compile(r"[\[\]{}]")
_HALF = re.compile(r"\\u[dD][89A-Fa-f]")
_HUGE = re.compile(r"[0-9][eE]\+?[0-9]{3}|[0-9]{300}")


@dataclass(frozen=True)
class SceneSource:
    """A scene's data and the text that it came from (empty when it came from a dict)."""

    data: Any
    name: str = ""
    """What messages call it: the file's path."""
    text: str = ""
    limits: Limits = field(default=Limits(), repr=False)
    path: Path | None = None
    """The file, if there is one; included files are relative to it."""

    @cached_property
    def _places(self) -> dict[JsonPath, Place]:
        return scan(self.text, self.limits.nesting, self.limits.values).places if self.text else {}

    @cached_property
    def _lines(self) -> Lines:
        return Lines(self.text)

    def where(self, path: JsonPath, *, key: bool = False) -> tuple[int, int]:
        """Line and column, from 1, of the value (or key) at ``path``; (0, 0) if there is none.

        A path that the file does not have gets the place of what contains it.
        """
        while path and path not in self._places:
            path, key = path[:-1], False
        place = self._places.get(path)
        if place is None:
            return 0, 0
        return self._lines.at(place.key if key and place.key >= 0 else place.value)


def read_source(path: str | Path, *, limits: Limits | None = None) -> SceneSource:
    """Read and parse a scene's file.

    Raises:
        SceneError: no such file, a directory, unreadable, too large, not
            UTF-8, not JSON, nested too deep, duplicate keys, NaN or infinity.
    """
    limits, name = limits or Limits(), str(path)
    name = name if len(name) <= MOST_NAME else f"{name[:MOST_NAME]}…"
    text = _decode(_read(Path(path), limits, name), name)
    return replace(parse_source(text, name=name, limits=limits), path=Path(path))


def parse_source(text: str, *, name: str = "", limits: Limits | None = None) -> SceneSource:
    """Parse a scene's text.

    Raises:
        SceneError: empty, not JSON, nested too deep, duplicate keys, NaN or infinity.
    """
    limits = limits or Limits()
    if not text.strip():
        raise SceneError([Problem("invalid-json",
                                  "the file is empty; a scene is an object {…}")], name)
    if _depth(text) <= limits.nesting and not _HUGE.search(text) and not _HALF.search(text):
        try:
            data = json.loads(text, object_pairs_hook=_unique, parse_constant=_refuse)
            return SceneSource(data, name, text, limits)
        except (ValueError, RecursionError):
            pass  # the scanner reports what and where
    found = scan(text, limits.nesting, limits.values)
    if found.faults:
        raise SceneError(first_problems(found.faults, limits.problems), name)
    return SceneSource(found.data, name, text, limits)


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result = dict(pairs)
    if len(result) != len(pairs):
        raise ValueError("duplicate key")
    return result


def _refuse(constant: str) -> Any:
    raise ValueError(f"{constant} is not JSON")


def _depth(text: str) -> int:
    """How deep the brackets outside strings nest."""
    depth = deepest = 0
    for bracket in _BRACKETS.findall(_STRING.sub("", text)):
        depth += 1 if bracket in "[{" else -1
        deepest = max(deepest, depth)
    return deepest


def first_problems(problems: Sequence[Problem], most: int) -> list[Problem]:
    """The first ``most`` problems, and how many more there are."""
    if len(problems) <= most:
        return list(problems)
    return [*problems[:most], Problem("limit-exceeded",
                                      f"and {len(problems) - most} more problems")]


def _read(path: Path, limits: Limits, name: str) -> bytes:
    try:
        status = path.stat()
        if stat.S_ISDIR(status.st_mode):
            raise SceneError([Problem("file-not-found", "this is a directory, not a scene's file",
                                      hint=_neighbour(path / "scene.json"))], name)
        if status.st_size <= limits.file_bytes:
            with path.open("rb") as file:
                content = file.read(limits.file_bytes + 1)
            if len(content) <= limits.file_bytes:
                return content
    except (FileNotFoundError, NotADirectoryError):
        raise SceneError([Problem("file-not-found",
                                  "there is no such file", hint=_neighbour(path))],
                         name) from None
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise SceneError([Problem("file-not-found",
                                  f"the file cannot be read: {reason}")], name) from None
    raise SceneError(
        [Problem("limit-exceeded",
                 f"the file is larger than the limit 'file_bytes' of {limits.file_bytes} bytes",
                 allowed="a larger one when the limit is raised")], name)


def _neighbour(path: Path) -> str:
    """A scene in the same folder, or a shipped one, with a similar name."""
    beside = {each.name: str(each) for each in scenes_beside(path)}
    if found := near(path.name, beside):
        return repr(beside[found.strip("'\"")])
    return near(path.stem, shipped_scenes())


def _decode(content: bytes, name: str) -> str:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        before = content[: error.start].decode("utf-8-sig", errors="replace")
        what = f"the file is not UTF-8 text (byte 0x{content[error.start]:02x})"
        if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
            what = "the file is UTF-16 text; save it as UTF-8"
        raise SceneError([Problem("invalid-json", what, "$", *Lines(before).at(len(before)))],
                         name) from None
