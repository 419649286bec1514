"""How the findings of the inspection are told."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.engine.inspect import Finding


def finding_lines(findings: list[Finding]) -> list[str]:
    """A line for each finding; those that differ only in numbers of names share one."""
    alike: dict[str, list[Finding]] = {}
    for finding in findings:
        alike.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", str(finding)), []).append(finding)
    return [
        f"{first}{f' (and so for {len(others)} more)' if others else ''}"
        for first, *others in alike.values()
    ]


def finding_data(finding: Finding) -> dict[str, Any]:
    """A finding as JSON data."""
    return {"severity": finding.severity, "element": finding.element,
            "message": finding.message, "advice": finding.advice}


def refuse_blocking(findings: list[Finding], path: Path) -> None:
    """Refuse a scene that cannot be simulated.

    Raises:
        SceneError: every finding that blocks, with its place in the file at ``path``.
    """
    from sandbox.scene.read.paths import parse_path
    from sandbox.scene.read.source import read_source

    blocking = [finding for finding in findings if finding.blocks]
    if not blocking:
        return
    source = read_source(path)
    problems = []
    for finding in blocking:
        advice = f"; {finding.advice}" if finding.advice else ""
        line, column = 0, 0
        if finding.element.startswith("$"):
            line, column = source.where(parse_path(finding.element))
        problems.append(Problem(f"{finding.message}{advice}", finding.element, line, column,
                                finding.allowed, finding.hint))
    raise SceneError(problems, str(path))
