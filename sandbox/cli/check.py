"""``sandbox check``: validation of scenes, and findings of their inspection."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from typing import Any

import click

from sandbox.cli.console import Console, Exit, problem_data, see
from sandbox.cli.options import Source, refuse_blocking
from sandbox.engine.inspect_hands import reaches
from sandbox.errors import Problem, SceneError
from sandbox.model.compile import compile_mechanism
from sandbox.scene.expand import to_json
from sandbox.scene.read.limits import Limits
from sandbox.scene.read.load import Loaded
from sandbox.scene.reference import scene_schema


def check(
    scenes: tuple[str, ...], overrides: dict[str, Any], limits: Limits, strict: bool, expand: bool,
    schema: str | None, console: Console,
) -> int:
    """Check scenes, or print one expanded, or a schema."""
    sources = [Source(word, overrides, limits) for word in scenes]
    if schema or expand:
        if schema:
            from sandbox.sweeps.spec import study_schema
            found = study_schema() if schema == "study" else scene_schema()
            text = json.dumps(found, indent=2, ensure_ascii=False)
        elif len(scenes) == 1:
            text = to_json(sources[0].load().mechanism)
        else:
            raise click.UsageError("--expand prints one SCENE.")
        console.document(text)
        return Exit.DONE
    if not scenes:
        raise click.UsageError("Missing argument 'SCENE...'.")
    reports = [report_of(source, Console(quiet=console.as_json)) for source in sources]
    good = all(report["ok"] and not (strict and report["findings"]) for report in reports)
    code = Exit.DONE if good else Exit.INPUT
    return console.finish({"scenes": reports}, code=code) if console.as_json else code


def report_of(source: Source, console: Console) -> dict[str, Any]:
    """Check one scene and print the findings; returns them as JSON data."""
    report: dict[str, Any] = {"scene": source.word, "ok": True, "errors": [], "findings": [],
                              "estimate": None, "notes": []}
    lines, others, costs = list[str](), list[Problem](), list[str]()
    try:
        loaded = source.load()
        found, takes = source.inspect(loaded)
        others = [problem for problem in found if not problem.blocks]
        lines = inspection_lines(others, loaded)
        report |= {"findings": inspection_data(others, loaded), "estimate": takes.data}
        refuse_blocking(found, loaded)
        report["notes"] = list(reaches(compile_mechanism(loaded.mechanism)))
        costs = [str(takes), *(f"note: {note}" for note in report["notes"])]
    except SceneError as error:
        report |= {"ok": False, "errors": [problem_data(problem, error.source)
                                           for problem in error.problems]}
        lines = [*(problem.at(error.source) for problem in error.problems), *lines]
        others = [*error.problems, *others]
    console.warn(*lines)
    console.say(*(f"{source.word}: {line}" for line in ([] if lines else ["ok"]) + costs))
    console.warn(*see(*others))
    return report


def ready(
    source: Source, changes: Mapping[str, Any] | None = None,
) -> tuple[Loaded, list[Problem], list[str]]:
    """A scene that can be simulated, its warnings, and the lines that print them."""
    loaded = source.load(changes)
    problems = source.inspect(loaded).problems
    refuse_blocking(problems, loaded)
    return loaded, problems, [*inspection_lines(problems, loaded), *see(*problems)]


def inspection_lines(problems: list[Problem], loaded: Loaded) -> list[str]:
    """Format problems, one a line; those that differ only in numbers of names share one."""
    groups: dict[str, list[Problem]] = {}
    for problem in problems:
        groups.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", str(problem)), []).append(problem)
    placed = loaded.placed(first for first, *_ in groups.values())
    return [first.at(loaded.name) + (f" (and so for {len(group) - 1} more)" if group[1:] else "")
            for first, group in zip(placed, groups.values(), strict=True)]


def inspection_data(problems: list[Problem], loaded: Loaded) -> list[dict[str, Any]]:
    """Warnings with their places, as JSON data."""
    names = ("code", "severity", "element", "message", "advice", "path", "line", "column")
    return [{**{name: getattr(problem, name) for name in names},
             "file": problem.file or loaded.name} for problem in loaded.placed(problems)]
