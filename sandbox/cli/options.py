"""Scenes and directories of the command line, which several commands share."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.errors import SceneError

if TYPE_CHECKING:
    from sandbox.engine.inspect import Inspection
    from sandbox.errors import Problem
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

PICTURES = (".png", ".svg", ".pdf")  # suffixes of figures
NAMES = {"best": "optimize"}  # searches whose names differ from those in study files


@dataclass(frozen=True)
class Source:
    """A scene of the command line: its file or name, and ``--set`` and ``--limit``."""

    word: str
    overrides: Mapping[str, Any]
    limits: Limits

    def load(self, changes: Mapping[str, Any] | None = None) -> Loaded:
        """Load the scene, with ``changes`` after those of ``--set``."""
        from sandbox.scene.library import find_scene
        from sandbox.scene.read.load import read_scene
        return read_scene(find_scene(self.word), overrides={**self.overrides, **(changes or {})},
                          limits=self.limits)

    def inspect(self, loaded: Loaded) -> Inspection:
        """Inspect a scene; a run that costs more than the limits allow is an error."""
        from sandbox.engine.inspect import look_over
        found = look_over(loaded.mechanism)
        beyond = list(found.estimate.beyond(self.limits))
        return found._replace(problems=[*beyond, *found.problems, *loaded.ignored])


def refuse_blocking(problems: Sequence[Problem], loaded: Loaded) -> None:
    """Refuse a scene that cannot be simulated."""
    if blocking := [problem for problem in problems if problem.blocks]:
        from sandbox.scene.read.source import first_problems
        most = loaded.origins.source.limits.problems
        raise SceneError(first_problems(loaded.placed(blocking), most), loaded.name)


def title_of(path: Path) -> str:
    """The title in a scene's file, read without validation; empty if it has none."""
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ""
    return str(data.get("title", "")) if isinstance(data, dict) else ""


RENDERS = Path("renders")


def safe_name(name: str) -> str:
    """The name of a scene without characters that could lead to another directory."""
    return re.sub(r"[^\w.-]+", "_", name).strip("._") or "scene"


def prepare(directory: Path) -> None:
    """Check that files can be written into a directory, and make it."""
    import tempfile

    from sandbox.atomic_files import output_errors
    with output_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=directory) as trial:
            trial.write(b"\0")


def written(directory: Path, names: Sequence[str]) -> list[str]:
    """The files of a list that a directory has."""
    return [name for name in names if (directory / name).is_file()]
