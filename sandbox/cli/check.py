"""``sandbox check``: validate scenes, print them as plain elements, print the JSON Schema."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, Exit, one_line, pages_line, problem_data
from sandbox.cli.options import (
    Source,
    complete_scene,
    console_options,
    refuse_blocking,
    scene_options,
)
from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

FINDING = ("code", "severity", "element", "message", "advice", "path", "line", "column")
"""Fields of a warning in JSON."""


@click.command()
@click.argument("scenes", metavar="SCENE...", nargs=-1, shell_complete=complete_scene)
@click.option("--strict", is_flag=True, help="Let warnings fail the check.")
@click.option("--expand", is_flag=True,
              help="Print the one SCENE as plain elements, itself a scene.")
@click.option("--schema", is_flag=False, flag_value="scene", metavar="[KIND]",
              type=click.Choice(["scene", "study"]),
              help="Print the JSON Schema of scenes, for editors; 'study' for that of study files.")
@scene_options
@console_options("json")
def check(
    scenes: tuple[str, ...], overrides: dict[str, Any], limits: Limits, strict: bool, expand: bool,
    schema: str | None, console: Console,
) -> int:
    """Validate scenes, and estimate the cost of a run.

    Looks for joints that are not assembled, bodies that overlap, tendon guides
    that coincide, springs and dampers too strong for the step, springs that can
    snap over centre, and unknown quantities. Exits 2 if a scene cannot be run;
    with --strict on warnings, too.
    """
    if schema:
        from sandbox.scene.reference import scene_schema
        from sandbox.sweeps.spec import study_schema

        found = study_schema() if schema == "study" else scene_schema()
        console.document(json.dumps(found, indent=2, ensure_ascii=False))
        return Exit.DONE
    if not scenes:
        raise click.UsageError("Missing argument 'SCENE...'.")
    sources = [Source(word, overrides, limits) for word in scenes]
    if expand:
        from sandbox.scene.expand import to_json

        if len(scenes) > 1:
            raise click.UsageError("Got unexpected extra scenes: --expand prints one.")
        console.document(to_json(sources[0].load().mechanism))
        return Exit.DONE
    text = Console(quiet=console.as_json)
    reports = [report_of(source, text) for source in sources]
    good = all(report["ok"] and not (strict and report["findings"]) for report in reports)
    code = Exit.DONE if good else Exit.INPUT
    return console.finish({"scenes": reports}, code=code) if console.as_json else code


def report_of(source: Source, console: Console) -> dict[str, Any]:
    """Check one scene and print the findings; returns them as JSON data."""
    from sandbox.engine.inspect_hands import reaches
    from sandbox.model.compile import compile_mechanism

    report: dict[str, Any] = {"scene": source.word, "ok": True, "errors": [], "findings": [],
                              "estimate": None, "notes": []}
    lines, others = list[str](), list[Problem]()
    try:
        loaded = source.load()
        found, takes = source.inspect(loaded)
        others = [problem for problem in found if not problem.blocks]
        lines = inspection_lines(others, loaded)
        report |= {"findings": inspection_data(others, loaded), "estimate": takes.data}
        refuse_blocking(found, loaded)
        report["notes"] = list(reaches(compile_mechanism(loaded.mechanism)))
    except SceneError as error:
        report |= {"ok": False, "errors": [problem_data(problem, error.source)
                                           for problem in error.problems]}
        lines = [*(one_line(problem, error.source) for problem in error.problems), *lines]
        others = [*error.problems, *others]
    if lines:
        console.warn(*lines)
    else:
        console.say(f"{source.word}: ok")
    if report["ok"]:
        console.say(*(f"{source.word}: {line}" for line in (
            takes, *(f"note: {note}" for note in report["notes"]))))
    console.warn(*pages_line(others))
    return report


def inspection_lines(problems: list[Problem], loaded: Loaded) -> list[str]:
    """Format problems, one a line; those that differ only in numbers of names share one."""
    groups: dict[str, list[Problem]] = {}
    for problem in problems:
        groups.setdefault(re.sub(r"(?<=[A-Za-z_])\d+", "#", str(problem)), []).append(problem)
    placed = loaded.placed(first for first, *_ in groups.values())
    return [
        f"{one_line(first, loaded.name)}{f' (and so for {others} more)' if others else ''}"
        for first, others in zip(placed, (len(group) - 1 for group in groups.values()), strict=True)
    ]


def inspection_data(problems: list[Problem], loaded: Loaded) -> list[dict[str, Any]]:
    """Warnings with their places, as JSON data."""
    return [{**{name: getattr(problem, name) for name in FINDING},
             "file": problem.file or loaded.name} for problem in loaded.placed(problems)]
