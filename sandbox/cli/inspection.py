"""How what the inspection found is told, and what it refuses."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from sandbox.cli.failures import one_line
from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.engine.inspect import Inspection
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded


def look_over(loaded: Loaded, limits: Limits) -> Inspection:
    """What an inspection finds; a run that would take more than the limits allow is an error."""
    from sandbox.engine.inspect import look_over

    found = look_over(loaded.mechanism)
    beyond = list(found.estimate.beyond(limits))
    return found._replace(problems=[*beyond, *found.problems])


def inspection_lines(problems: list[Problem], loaded: Loaded) -> list[str]:
    """A line for each problem; those that differ only in numbers of names share one.

    Each has its place, that of the first of those that share it.
    """
    alike: dict[str, list[Problem]] = {}
    for problem in problems:
        alike.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", str(problem)), []).append(problem)
    placed = loaded.placed(first for first, *_ in alike.values())
    return [
        f"{one_line(first, loaded.name)}{f' (and so for {others} more)' if others else ''}"
        for first, others in zip(placed, (len(group) - 1 for group in alike.values()), strict=True)
    ]


def inspection_data(problems: list[Problem], loaded: Loaded) -> list[dict[str, Any]]:
    """Problems that do not block, with their places, as JSON data."""
    return [{"code": problem.code, "severity": problem.severity, "element": problem.element,
             "message": problem.message, "advice": problem.advice,
             "file": problem.file or loaded.name, "path": problem.path, "line": problem.line,
             "column": problem.column}
            for problem in loaded.placed(problems)]


def refuse_blocking(problems: list[Problem], loaded: Loaded) -> None:
    """Refuse a scene that cannot be simulated.

    Raises:
        SceneError: the problems that block, with their places in the scene's file.
    """
    if blocking := [problem for problem in problems if problem.blocks]:
        from sandbox.scene.read.source import first_problems

        most = loaded.origins.source.limits.problems
        raise SceneError(first_problems(loaded.placed(blocking), most), loaded.name)
