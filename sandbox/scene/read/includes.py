"""``include``: a scene of the same folder, found by its name and read within the limits."""

from __future__ import annotations

import contextlib
import dataclasses
import re
import stat
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from sandbox.errors import Problem, SceneError
from sandbox.scene.library import scenes_beside, shipped_scenes
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.source import SceneSource, read_source
from sandbox.wording import WrongValueError, kind_of, listed, near, quoted

_NAME = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}")


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
                                  hint=near(re.split(r"[/\\]", stem)[-1], self.others()))
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
            names = self.others()
            copied = (f"; 'sandbox new {stem}' copies the shipped one"
                      if stem in shipped_scenes() else "")
            raise WrongValueError(
                "bad-include", f"there is no scene {quoted(stem)} beside this one{copied}",
                hint=near(stem, names),
                allowed=listed(names) or "none: no other scene is in the folder") from None
        return real

    def others(self) -> list[str]:
        """Names of the scenes in the folder of the scene's file."""
        return [each.stem for each in scenes_beside(self.main.path)] if self.main.path else []

    def open(self, path: Path) -> SceneSource:
        """A scene's file.

        Raises:
            WrongValueError: too large together with all that was read before.
            SceneError: it cannot be read; each problem names the file.
        """
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
            found = dataclasses.replace(read_source(path, limits=self.limits), name=name)
            if not isinstance(found.data, dict):
                raise SceneError([Problem("wrong-type", "a scene is an object {…}, not "
                                          f"{kind_of(found.data)}", "$", *found.where(()))])
        except SceneError as error:
            raise SceneError([dataclasses.replace(problem, file=name)
                              for problem in error.problems], name) from None
        self.read[path] = found
        return found
