"""``sandbox certify``: would a scene's verdict be the same at a finer step?"""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.inspection import refuse_blocking
from sandbox.cli.options import limit_options, override_option
from sandbox.cli.progress import Progress
from sandbox.cli.scenes import complete_scene, load, scene_path
from sandbox.errors import Problem, SceneError

if TYPE_CHECKING:
    from sandbox.scene.read.load import Loaded
    from sandbox.study.certify import Certificate
    from sandbox.study.convergence import Trust


@click.command()
@click.argument("scene", shell_complete=complete_scene)
@override_option
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@limit_options
def certify(
    scene: str, overrides: dict[str, Any], as_json: bool, **limits: Any,
) -> int:
    """Run SCENE at its step h, at h/2 and h/4, and with twice the iterations.

    Prints, for every expected quantity, its value at each step, the order at
    which it converges, what is left of its error, and whether it can be relied
    on. Exits 1 if one cannot. Writes no files.
    """
    from sandbox.engine.inspect import inspect
    from sandbox.study.certify import certify as run_study

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    _refuse(loaded, limits)
    console = Console(as_json=as_json)
    with Progress("certify", shown=console.shows_progress) as progress:
        found = run_study(mechanism, progress=progress)
    code = Exit.DONE if found.certified else Exit.FAILED
    if as_json:
        console.result_json({"status": code.name.lower(), "exit_code": int(code),
                             "scene": mechanism.name, **certificate_data(found)})
    else:
        console.say(certificate_table(found))
        console.say(found.conclusion)
    return code


def _refuse(loaded: Loaded, limits: dict[str, Any]) -> None:
    """Refuse what cannot be certified, before any run.

    Raises:
        SceneError: a scene that expects nothing, that an event may stop or that is too
            short; one whose finest run is larger than allowed.
    """
    from sandbox.scene.read.limits import Limits, check_limits
    from sandbox.study.certify import unfit, variants

    mechanism = loaded.mechanism
    if reason := unfit(mechanism):
        stops = any(event.stop for event in mechanism.events)
        place = "$.expect" if not mechanism.expect else "$.events" if stops else "$.run"
        raise SceneError([Problem(reason, place)], loaded.name)
    allowed = Limits(**{name: value for name, value in limits.items() if value is not None})
    if problems := check_limits(variants(mechanism)[2], allowed):
        raise SceneError([dataclasses.replace(
            problem, message=f"{problem.message} (of the run at a quarter of the step)")
            for problem in problems], loaded.name)


def certificate_table(found: Certificate) -> str:
    """One row for each expectation."""
    h = 1e3 * found.steps[0]
    head = ["expectation of", "", f"h = {h:.4g} ms", "h/2", "h/4", "unit", "order", "error left",
            "by iterations", "verdict"]
    rows = [[t.quantity, t.statistic, *(_number(v) for v in t.values),
             "" if t.unit == "1" else t.unit, _order(t), _small(t.error),
             _small(abs(t.iteration_change)), f"{t.kind}{f': {t.reason}' if t.reason else ''}"]
            for t in found.quantities]
    return table(head, rows, right="<<>>><>>>")


def _number(value: float) -> str:
    return f"{value:.6g}" if math.isfinite(value) else "-"


def _small(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "-"


def _order(trust: Trust) -> str:
    return f"{trust.order:.1f}" if math.isfinite(trust.order) else "-"


def certificate_data(found: Certificate) -> dict[str, Any]:
    """A certificate as JSON data; what is infinite or has no value is null."""
    return {
        "steps": list(found.steps), "iterations": list(found.iterations),
        "certified": found.certified, "conclusion": found.conclusion,
        "quantities": [_plain({
            **dataclasses.asdict(trust), "iteration_change": trust.iteration_change,
            "certified": trust.certified}) for trust in found.quantities],
    }


def _plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _plain(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
