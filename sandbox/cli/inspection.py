"""How what the inspection found is told, and what it refuses."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

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
        SceneError: the problems that block, with their places in the scene's file.
    """
    if blocking := [problem for problem in problems if problem.blocks]:
        from sandbox.scene.read.source import first_problems

        most = loaded.origins.source.limits.problems
        raise SceneError(first_problems(loaded.placed(blocking), most), loaded.name)
