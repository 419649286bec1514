"""``include``: a scene of the same folder, found by its name and read within the limits."""

from __future__ import annotations

import dataclasses
import re
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}")
_MOST_LISTED = 1000
"""Files of a folder that are looked at for a near miss."""


@dataclass
class Library:
    """The scenes beside a scene's file that it has read so far."""

    main: SceneSource
    limits: Limits
    read: dict[Path, SceneSource] = field(default_factory=dict)
    size: int = 0
    """Of all files together [bytes]."""

    def __post_init__(self) -> None:
        self.size = len(self.main.text.encode("utf-8", "surrogatepass"))

    def find(self, name: Any) -> Path:
        """The file that an ``include`` names.

        Raises:
            WrongValueError: no name of a scene in the folder of the scene's file.
        """
        if not isinstance(name, str):
            raise WrongValueError("bad-include",
                                  f"'include' is the name of a scene, not {kind_of(name)}")
        if self.main.path is None:
            raise WrongValueError("bad-include",
                                  "a scene that comes from no file has no folder to include from",
                                  allowed="the path of a scene's file in place of its data")
        folder = self.main.path.parent
        stem = name.removesuffix(".json")
        if not _NAME.fullmatch(stem) or set(stem) == {"."}:
            raise WrongValueError("bad-include", f"{quoted(name)} is not the name of a scene in "
                                  "this scene's own folder", allowed="a plain name, without a "
                                  "path: files elsewhere are not read",
                                  hint=near(re.split(r"[/\\]", stem)[-1], _beside(folder)))
        path = folder / f"{stem}.json"
        try:
            real = path.resolve(strict=True)
            if real.parent != folder.resolve(strict=True):
                raise WrongValueError("bad-include",
                                      f"{quoted(path.name)} is a link that leads out of this "
                                      "scene's folder", allowed="a file of the folder itself")
            if not stat.S_ISREG(real.stat().st_mode):
                raise WrongValueError("bad-include",
                                      f"{quoted(path.name)} is no file that holds a scene")
        except (OSError, RuntimeError):
            others = _beside(folder)
            copied = (f"; 'sandbox new {stem}' copies the shipped one"
                      if stem in shipped_scenes() else "")
            raise WrongValueError(
                "bad-include", f"there is no scene {quoted(stem)} beside this one{copied}",
                hint=near(stem, others),
                allowed=listed(others) or "none: no other scene is in the folder") from None
        return real

    def open(self, path: Path, name: str) -> SceneSource:
        """A scene's file; ``name`` is what messages call it.

        Raises:
            WrongValueError: too large together with all that was read before.
            SceneError: it cannot be read; each problem names the file.
        """
        if path in self.read:
            return self.read[path]
        try:
            size = path.stat().st_size
        except OSError:
            size = 0  # reading it reports why
        if self.size + size > self.limits.file_bytes:
            raise WrongValueError("limit-exceeded", f"with {quoted(path.name)} the files of this "
                                  "scene are larger than the limit 'file_bytes' of "
                                  f"{self.limits.file_bytes} bytes", allowed="larger ones when the "
                                  "limit is raised")
        try:
            found = read_source(path, limits=self.limits)
        except SceneError as error:
            raise SceneError([dataclasses.replace(problem, file=name)
                              for problem in error.problems], name) from None
        found = dataclasses.replace(found, name=name)
        if not isinstance(found.data, dict):
            raise SceneError([Problem("wrong-type",
                                      f"a scene is an object {{…}}, not {kind_of(found.data)}", "$",
                                      *found.where(()), file=name)], name)
        self.size += size
        self.read[path] = found
        return found


def _beside(folder: Path) -> list[str]:
    """Names of the scenes in a folder."""
    names: list[str] = []
    try:
        for entry in folder.iterdir():
            if entry.suffix == ".json" and not entry.name.endswith(".schema.json"):
                names.append(entry.stem)
            if len(names) >= _MOST_LISTED:
                break
    except OSError:
        return []
    return sorted(names)
