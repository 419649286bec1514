"""``sandbox check``: is it a scene, and would it do what its author meant?"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.failures import one_line, pages_line, problem_data
from sandbox.cli.inspection import inspection_data, inspection_lines, look_over, refuse_blocking
from sandbox.cli.options import chosen_limits, limit_options, override_option
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.engine.estimate import Estimate


@click.command()
@click.argument("scenes", metavar="SCENE...", nargs=-1, required=True,
                shell_complete=complete_scene)
@override_option
@click.option("--strict", is_flag=True, help="Let warnings fail the check too.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object.")
@limit_options
def check(
    scenes: tuple[str, ...], overrides: dict[str, Any], strict: bool, as_json: bool,
    **limits: Any,
) -> int:
    """Validate each SCENE, look it over, and tell what a run would take.

    Looks for joints that are not assembled, bodies that overlap, tendon guides
    that coincide, springs and dampers too strong for the step, springs that
    can snap over centre, quantities that do not exist; says how far trees of rockers and pulleys
    can go. Exits 2 on what no run can be made of, with --strict on warnings, too.
    """
    console = Console(as_json=as_json)
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
            console.say(f"{report['scene']}: {note}")
        console.warn(*report["pages"])
    return code


def report_of(scene: str, overrides: dict[str, Any], limits: dict[str, Any]) -> dict[str, Any]:
    """What is to be said about one scene; ``lines`` for a person, the rest for a machine."""
    from sandbox.engine.inspect_trees import reaches
    from sandbox.model.compile import compile_mechanism

    warned: list[str] = []
    others: list[Problem] = []
    findings: list[dict[str, Any]] = []
    notes: list[str] = []
    takes: Estimate | None = None
    try:
        loaded = load(scene_path(scene), overrides=overrides, limits=limits)
        found, takes = look_over(loaded, chosen_limits(limits))
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
