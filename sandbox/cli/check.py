"""``sandbox check``: validate scenes, print them as plain elements, print the JSON Schema."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console
from sandbox.cli.failures import Exit, one_line, pages_line, problem_data
from sandbox.cli.options import json_option, limit_option, scene_options
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.engine.inspect import Estimate, Inspection
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded


@click.command()
@click.argument("scenes", metavar="SCENE...", nargs=-1, shell_complete=complete_scene)
@scene_options
@click.option("--strict", is_flag=True, help="Let warnings fail the check.")
@click.option("--expand", is_flag=True,
              help="Print the one SCENE as plain elements, itself a scene.")
@click.option("--schema", is_flag=False, flag_value="scene", metavar="[KIND]",
              type=click.Choice(["scene", "study"]),
              help="Print the JSON Schema of scenes, for editors; 'study' for that of study files.")
@json_option
@limit_option
def check(
    scenes: tuple[str, ...], overrides: dict[str, Any], strict: bool, expand: bool,
    schema: str | None, as_json: bool, limits: Limits,
) -> int:
    """Validate scenes, and estimate the cost of a run.

    Looks for joints that are not assembled, bodies that overlap, tendon guides
    that coincide, springs and dampers too strong for the step, springs that can
    snap over centre, and unknown quantities. Exits 2 if a scene cannot be run;
    with --strict on warnings, too.
    """
    console = Console(as_json=as_json)
    if schema:
        from sandbox.scene.reference import scene_schema
        from sandbox.sweeps.spec import study_schema

        found = study_schema() if schema == "study" else scene_schema()
        console.document(json.dumps(found, indent=2, ensure_ascii=False))
        return Exit.DONE
    if not scenes:
        raise click.UsageError("Missing argument 'SCENE...'.")
    if expand:
        return _expand(scenes, overrides, limits, console)
    reports = [report_of(scene, overrides, limits) for scene in scenes]
    good = all(report["ok"] and not (strict and report["findings"]) for report in reports)
    code = Exit.DONE if good else Exit.INPUT
    if as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code),
            "scenes": [{key: value for key, value in report.items()
                        if key not in ("lines", "takes", "pages")} for report in reports],
        })
    for report in [] if as_json else reports:
        if report["lines"]:
            console.error(*report["lines"])
        else:
            console.say(f"{report['scene']}: ok")
        if report["ok"]:
            console.say(f"{report['scene']}: {report['takes']}")
        for note in report["notes"]:
            console.say(f"{report['scene']}: note: {note}")
        console.warn(*report["pages"])
    return code


def _expand(
    scenes: tuple[str, ...], overrides: dict[str, Any], limits: Limits, console: Console,
) -> int:
    """Print a scene without assemblies, templates, parameters and units."""
    from sandbox.scene.expand import to_json

    if len(scenes) > 1:
        raise click.UsageError("Got unexpected extra scenes: --expand prints one.")
    loaded = load(scene_path(scenes[0]), overrides=overrides, limits=limits)
    console.document(to_json(loaded.mechanism))
    return Exit.DONE


def report_of(scene: str, overrides: dict[str, Any], limits: Limits) -> dict[str, Any]:
    """Check one scene; ``lines``, ``takes`` and ``pages`` are text, the rest is JSON data."""
    from sandbox.engine.inspect_hands import reaches
    from sandbox.model.compile import compile_mechanism

    warned: list[str] = []
    others: list[Problem] = []
    findings: list[dict[str, Any]] = []
    notes: list[str] = []
    takes: Estimate | None = None
    try:
        loaded = load(scene_path(scene), overrides=overrides, limits=limits)
        found, takes = inspect_scene(loaded, limits)
        others = [problem for problem in found if not problem.blocks]
        warned = inspection_lines(others, loaded)
        findings = inspection_data(others, loaded)
        refuse_blocking(found, loaded)
        notes = list(reaches(compile_mechanism(loaded.mechanism)))
        problems, source = [], ""
    except SceneError as error:
        problems, source = error.problems, error.source
    return {
        "scene": scene,
        "ok": not problems,
        "errors": [problem_data(problem, source) for problem in problems],
        "findings": findings,
        "estimate": takes.data if takes else None,
        "takes": str(takes) if takes else "",
        "notes": notes,
        "lines": [*(one_line(problem, source) for problem in problems), *warned],
        "pages": pages_line([*problems, *others]),
    }


def inspect_scene(loaded: Loaded, limits: Limits) -> Inspection:
    """Inspect a scene; a run that costs more than the limits allow is an error."""
    from sandbox.engine.inspect import look_over

    found = look_over(loaded.mechanism)
    beyond = list(found.estimate.beyond(limits))
    return found._replace(problems=[*beyond, *found.problems])


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
