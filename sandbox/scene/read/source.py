"""A scene's text: JSON to plain data, and where in the file each piece of it stands.

A valid file is read by :mod:`json`. Only for errors a slower scanner reads the same text: it finds
the line and column of every key and value, and describes what is not JSON (RFC 8259).
"""

from __future__ import annotations

import contextlib
import json
import re
import stat
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import accumulate
from pathlib import Path
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import scenes_beside, shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.positions import Lines, Scan, scan
from sandbox.values.paths import JsonPath
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted

LONGEST_NAME = 400  # characters of a path that messages show
_STRING = re.compile(r'"(?:[^"\\]|\\.)*+"?', re.DOTALL)
_FOR_SCANNER = re.compile(r"\\u[dD][89A-Fa-f]|[0-9][eE]\+?[0-9]{3}|[0-9]{300}")
"""Surrogates and huge numbers, which :mod:`json` accepts."""
_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}")


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
        """Line and column, from 1, of the value (or key) at ``path``; (0, 0) if there is none.

        A path that the file does not have gets the place of what contains it.
        """
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


def first_problems(problems: Sequence[Problem], most: int) -> list[Problem]:
    """The first ``most`` problems, and how many more there are."""
    more = [Problem("limit-exceeded", f"and {len(problems) - most} more problems")]
    return [*problems[:most], *(more if len(problems) > most else ())]


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
