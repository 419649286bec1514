"""``sandbox certify``: would a scene's verdict be the same at a finer step?"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.compiling import compilation_notices
from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.inspection import refuse_blocking
from sandbox.cli.options import chosen_limits, limit_options, override_option
from sandbox.cli.progress import Progress
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.errors import Problem, SceneError
from sandbox.pages import page_of, read_on

if TYPE_CHECKING:
    from sandbox.convergence.certificate import Certificate
    from sandbox.convergence.judgement import Trust
    from sandbox.scene.read.load import Loaded


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@override_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@limit_options
def certify(
    scene: str, overrides: dict[str, Any], as_json: bool, **limits: Any,
) -> int:
    """Run SCENE at its step h, at h/2 and at h/4.

    Prints, for every expected quantity, its value at each step, the order at
    which it converges, what is left of its error, how much is allowed, and
    whether it can be relied on; what the audits of the three runs ask for a look
    at; and what it would take. Exits 1 if the scene cannot be certified, 3 if
    one of the runs diverged. Writes no files.
    """
    from sandbox.convergence.certificate import certify as check_convergence
    from sandbox.engine.inspect import inspect

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    _refuse(loaded, limits)
    console = Console(as_json=as_json)
    with (compilation_notices(console),
          Progress("certify", shown=console.shows_progress) as progress):
        found = check_convergence(mechanism, progress=progress)
    code = (Exit.DIVERGED if found.diverged else Exit.DONE if found.certified else Exit.FAILED)
    if as_json:
        console.result_json({"status": code.name.lower(), "exit_code": int(code),
                             "scene": mechanism.name, **certificate_data(found)})
        return code
    for each in found.diverged:
        console.error(f"error: {each.run}: {each.reason}")
    console.warn(*read_on([page_of("the simulation diverged")] if found.diverged else []))
    console.say(*certificate_table(found), *_reasons(found), "", found.conclusion, *found.advice)
    return code


def _refuse(loaded: Loaded, limits: dict[str, Any]) -> None:
    """Refuse what cannot be certified, before any run.

    Raises:
        SceneError: a scene that expects nothing, that an event may stop or that is too
            short; one whose finest run is larger than allowed.
    """
    from sandbox.convergence.certificate import unfit
    from sandbox.convergence.runs import refined
    from sandbox.engine.inspect import look_over
    from sandbox.scene.read.limits import check_limits

    mechanism = loaded.mechanism
    if reason := unfit(mechanism):
        stops = any(event.stop for event in mechanism.events)
        place = "$.expect" if not mechanism.expect else "$.events" if stops else "$.run"
        raise SceneError([Problem(reason, place)], loaded.name)
    finest, allowed = refined(mechanism, 4), chosen_limits(limits)
    if problems := (check_limits(finest, allowed)
                    or list(look_over(finest).estimate.beyond(allowed))):
        raise SceneError([dataclasses.replace(
            problem, message=f"{problem.message} (of the run at a quarter of the step)")
            for problem in problems], loaded.name)


def certificate_table(found: Certificate) -> list[str]:
    """One row for each expectation."""
    h = 1e3 * found.steps[0]
    head = ["expectation of", "", f"h = {h:.4g} ms", "h/2", "h/4", "unit", "order", "error left",
            "allowed", "verdict"]
    rows = [[t.quantity, t.statistic, *(_number(v) for v in t.values),
             "" if t.unit == "1" else t.unit, _order(t), _small(t.error), _small(t.allowed), t.kind]
            for t in found.quantities]
    return table(head, rows, right="<<>>><>>>")


def _reasons(found: Certificate) -> list[str]:
    """What a verdict rests on, one line each, and what the audits ask for a look at."""
    return [*(f"{t.kind} {t.statistic} {t.quantity}: {t.reason}"
              for t in found.quantities if t.reason),
            *(f"look {look.figure.name} ({', '.join(look.runs)}): {_small(look.figure.value)}, at "
              f"most {_small(look.figure.threshold)} passes: {look.figure.why}"
              for look in found.looks)]


def _number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "-"


def _small(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "-"


def _order(trust: Trust) -> str:
    return f"{trust.order:.1f}" if math.isfinite(trust.order) else "-"


def certificate_data(found: Certificate) -> dict[str, Any]:
    """A certificate as JSON data; what is infinite or has no value is null."""
    return {
        "steps": list(found.steps), "certified": found.certified, "conclusion": found.conclusion,
        "advice": list(found.advice),
        "quantities": [_plain({**dataclasses.asdict(trust), "certified": trust.certified})
                       for trust in found.quantities],
        "looks": [{"runs": list(look.runs), **_plain(vars(look.figure))} for look in found.looks],
        "diverged": [dataclasses.asdict(each) for each in found.diverged],
    }


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
