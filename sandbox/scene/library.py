"""The shipped scenes: in the wheel inside the package, in a checkout beside it."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple

from sandbox.errors import Problem, SceneError
from sandbox.wording import listed, near, nearest, quoted


@cache
def shipped_scenes() -> dict[str, Path]:
    """Name and file of every shipped scene: first those of the folder itself, each by name."""
    directory = _directory()
    files = [*sorted(directory.glob("*.json")), *sorted(directory.glob("*/*.json"))] if directory \
        else []
    return {path.stem: path for path in files if not path.name.endswith(".schema.json")}


class Topic(NamedTuple):
    """Shipped scenes that belong together."""

    title: str
    about: str
    scenes: list[str]


def scene_topics() -> list[Topic]:
    """The shipped scenes by topic, as ``topics.toml`` beside them has it."""
    directory = _directory()
    if directory is None:
        return []
    text = (directory / "topics.toml").read_text(encoding="utf-8")
    return [Topic(**topic) for topic in tomllib.loads(text)["topics"]]


def _directory() -> Path | None:
    package = Path(str(files("sandbox")))
    return next((each for each in (package / "_scenes", package.parent / "scenes")
                 if each.is_dir()), None)


def folder_of(path: Path) -> str:
    """The folder of a shipped scene's file, such as ``mechanisms``; empty if it lies in none."""
    name = path.parent.name
    return "" if name in ("_scenes", "scenes") else name


def find_scene(name_or_path: str | Path) -> Path:
    """The file of a scene: an existing file, or else a shipped scene by its name."""
    path, text, is_folder = Path(name_or_path), str(name_or_path), False
    try:
        if path.exists() and not path.is_dir():
            return path
        is_folder = bool(text) and path.is_dir()
    except OSError:  # a name that no file can have, such as a very long one
        path = Path()
    scenes = shipped_scenes()
    if text in scenes:
        return scenes[text]
    fault = f"{quoted(text)} is no scene: this is a directory" if is_folder else \
        f"there is no file {quoted(text)} and no shipped scene of that name"
    raise SceneError([Problem(
        "file-not-found", fault, path="", allowed=f"a path, or one of {listed(scenes)}",
        hint=similar_scene(path))])


def similar_scene(path: Path) -> str:
    """A file of a similar name beside a path, or a shipped scene, quoted; or ``""``."""
    beside = {each.name: str(each) for each in scenes_beside(path)}
    found = nearest(path.name, beside)
    return repr(beside[found]) if found else near(path.stem, shipped_scenes())


def scenes_beside(path: Path) -> list[Path]:
    """The scenes' files in the folder of a path."""
    try:
        return sorted(each for each in path.parent.glob("*.json")
                      if not each.name.endswith(".schema.json"))
    except (OSError, ValueError):
        return []
