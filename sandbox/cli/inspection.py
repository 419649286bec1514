"""How what the inspection found is told, and what it refuses."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.scene.read.load import Loaded


def inspection_lines(problems: list[Problem]) -> list[str]:
    """A line for each problem; those that differ only in numbers of names share one."""
    alike: dict[str, list[str]] = {}
    for problem in problems:
        line = f"{problem.severity}: {problem}"
        alike.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", line), []).append(line)
    return [
        f"{first}{f' (and so for {len(others)} more)' if others else ''}"
        for first, *others in alike.values()
    ]


def inspection_data(problem: Problem) -> dict[str, Any]:
    """A problem that does not block as JSON data."""
    return {"severity": problem.severity, "element": problem.element,
            "message": problem.message, "advice": problem.advice}


def refuse_blocking(problems: list[Problem], loaded: Loaded) -> None:
    """Refuse a scene that cannot be simulated.

    Raises:
        SceneError: every problem that blocks, with its place in the scene's file.
    """
    if blocking := [problem for problem in problems if problem.blocks]:
        raise SceneError(loaded.placed(blocking), loaded.name)
