"""``sandbox converge`` and ``sandbox bounds``: the accuracy of a scene and of contact forces."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.check import refuse_blocking
from sandbox.cli.console import Console, Progress, compilation_notices, table
from sandbox.cli.failures import Exit, see
from sandbox.cli.options import json_option, limit_option, quiet_option, read_length, scene_options
from sandbox.cli.runs import file_option, open_run
from sandbox.cli.scenes import load, scene_argument, scene_path
from sandbox.errors import Problem, SceneError
from sandbox.wording import or_near

if TYPE_CHECKING:
    from sandbox.audit.bounds import Bounds, Interval
    from sandbox.convergence.certificate import Certificate
    from sandbox.recording.recording import Recording
    from sandbox.scene.read.limits import Limits
    from sandbox.scene.read.load import Loaded

MAX_NAMED = 4
"""Forces outside their bounds that are named."""
DIRECTIONS = 12
"""Directions of a push, evenly spaced."""


@click.command()
@scene_argument
@scene_options
@json_option
@limit_option
def converge(scene: str, overrides: dict[str, Any], as_json: bool, limits: Limits) -> int:
    """Check SCENE for convergence: run it at steps h, h/2, h/4.

    Prints, for every expected quantity, its value at each step, the order of
    convergence, the estimated and the allowed error, and the result; the
    warnings of the consistency checks; and what to change. Exits 1 if the scene
    has not converged, 3 if a run diverged. Writes no files.
    """
    from sandbox.convergence.certificate import certify
    from sandbox.engine.inspect import inspect

    loaded = load(scene_path(scene), overrides=overrides, limits=limits)
    mechanism = loaded.mechanism
    refuse_blocking(inspect(mechanism), loaded)
    _refuse(loaded, limits)
    console = Console(as_json=as_json)
    with (compilation_notices(console),
          Progress("Simulating", shown=console.shows_progress) as progress):
        found = certify(mechanism, progress=progress)
    code = (Exit.DIVERGED if found.diverged else Exit.DONE if found.certified else Exit.FAILED)
    if as_json:
        console.result_json({"status": code.name.lower(), "exit_code": int(code),
                             "scene": mechanism.name, **_certificate_data(found)})
        return code
    for each in found.diverged:
        console.error(f"error: {each.run}: {each.reason}")
    console.warn(*see(["diverged"] if found.diverged else []))
    console.say(*_certificate_table(found), *_reasons(found), "", found.conclusion, *found.advice)
    return code


def _refuse(loaded: Loaded, limits: Limits) -> None:
    """Refuse a scene whose convergence cannot be checked, before any run.

    Raises:
        SceneError: a scene that expects nothing, that an event may stop or that is too
            short; one whose finest run exceeds a limit.
    """
    from sandbox.convergence.certificate import unfit
    from sandbox.convergence.runs import refined
    from sandbox.engine.inspect import look_over
    from sandbox.scene.read.limits import check_limits

    mechanism = loaded.mechanism
    if reason := unfit(mechanism):
        stops = any(event.stop for event in mechanism.events)
        place = "$.expect" if not mechanism.expect else "$.events" if stops else "$.run"
        raise SceneError([Problem("nothing-to-certify", reason, place)], loaded.name)
    finest = refined(mechanism, 4)
    if problems := (check_limits(finest, limits)
                    or list(look_over(finest).estimate.beyond(limits))):
        raise SceneError([dataclasses.replace(
            problem, message=f"{problem.message} (of the run at a quarter of the step)")
            for problem in problems], loaded.name)


def _certificate_table(found: Certificate) -> list[str]:
    """One row for each expectation."""
    h = 1e3 * found.steps[0]
    head = ["expectation of", "", f"h = {h:.4g} ms", "h/2", "h/4", "unit", "order",
            "estimated error", "allowed", "result"]
    rows = [[t.quantity, t.statistic, *(_format(v, ".6g") for v in t.values),
             "" if t.unit == "1" else t.unit, _format(t.order, ".1f"), _format(t.error, ".1e"),
             _format(t.allowed, ".1e"), t.kind]
            for t in found.quantities]
    return table(head, rows, right="<<>>><>>>")


def _reasons(found: Certificate) -> list[str]:
    """The reason for each result, and the warnings of the consistency checks."""
    return [*(f"{t.kind} {t.statistic} {t.quantity}: {t.reason}"
              for t in found.quantities if t.reason),
            *(f"warning {look.figure.name} ({', '.join(look.runs)}) = "
              f"{_format(look.figure.value, '.1e')}, at most "
              f"{_format(look.figure.threshold, '.1e')}: {look.figure.why}"
              for look in found.looks)]


def _format(value: float, how: str) -> str:
    return format(value, how) if math.isfinite(value) else "-"


def _certificate_data(found: Certificate) -> dict[str, Any]:
    """A certificate as JSON data; infinite and missing values are null."""
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


@click.command()
@click.argument("run")
@click.option("--at", "instants", multiple=True, type=float, metavar="SECONDS",
              help="Time of the sample; the last one by default. Repeatable.")
@click.option("--near", metavar="LENGTH", callback=read_length,
              help="Maximum gap of a contact, as 10um; by default the gap that a step may leave "
                   "(docs/audit.md).")
@click.option("--push", "pushed", metavar="BODY",
              help="Also print the largest push at this body's centre of mass that balance allows, "
                   "in 12 directions.")
@file_option((".csv",), "A .csv file; contact_bounds.csv in the run's directory by default. "
             "Repeatable.")
@json_option
@quiet_option
def bounds(
    run: str, instants: tuple[float, ...], near: float | None, pushed: str | None,
    files: tuple[Path, ...], as_json: bool, quiet: bool,
) -> int:
    """Bound indeterminate contact forces of a saved run.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. With friction, single contact forces depend on the history of a
    grasp. Balance, friction and unilateral contact leave an interval for each.
    Contacts without force count, too. Exits 1 if a recorded force is outside
    its interval.
    """
    from sandbox.audit.bounds import contact_bounds
    from sandbox.audit.evidence import Evidence
    from sandbox.recording.new_run import BOUNDS, made
    from sandbox.recording.store import save_bounds

    console = Console(as_json=as_json, quiet=quiet)
    directory, recording = open_run(run, console)
    evidence = Evidence(recording)
    samples = _samples(recording, evidence, instants)
    pushes = [] if pushed is None else [_pushes(evidence, pushed, sample) for sample in samples]
    found = {sample: contact_bounds(evidence, sample, near) for sample in samples}
    files = files or (directory / BOUNDS,)
    for file in files:
        save_bounds(evidence.run, found, file)
        made(file)
    outside = [label for each in found.values() for one in each
               for label, part in _parts(one, recording) if part.outside]
    code = Exit.FAILED if outside else Exit.DONE
    if as_json:
        console.result_json({
            "status": code.name.lower(), "exit_code": int(code), "run": str(directory),
            "files": [str(file) for file in files],
            "bounds": [_bounds_data(evidence.run.time[sample], one, recording)
                       for sample, each in found.items() for one in each],
            "pushes": _plain(pushes)})
        return code
    for sample, each in found.items():
        console.say(f"t = {evidence.run.time[sample]:.6g} s"
                    + ("" if each else ": nothing touches"))
        if each:
            rows = [[label, *shown_numbers(part),
                     "OUTSIDE" if part.outside else "decided" if _decided(part) else ""]
                    for one in each for label, part in _parts(one, recording)]
            console.say(*table(["force of", "N", "interval", ""], rows, right="<>"), "")
    for push in pushes:
        rows = [[f"{angle:g}", f"{force:.6g}" if math.isfinite(force) else str(force)]
                for angle, force in zip(push["direction_deg"], push["force"], strict=True)]
        console.say(f"largest push of {pushed} at t = {push['time']:.6g} s",
                    *table(["direction deg", "N"], rows, right=">>"), "")
    if outside:
        more = f" and {len(outside) - MAX_NAMED} more" if len(outside) > MAX_NAMED else ""
        message = "outside the range that mechanics allows"
        console.error(f"{message}: {', '.join(outside[:MAX_NAMED])}{more}")
        console.warn(*see(["impossible-forces"]))
    console.say(*map(str, files))
    return code


def _samples(recording: Recording, evidence: Any, instants: tuple[float, ...]) -> list[int]:
    """Numbers of the samples nearest to some times, the last one by default.

    Raises:
        BadParameter: a time outside the run.
    """
    time = evidence.run.time
    last = float(recording.time[-1])
    for instant in instants:
        if not 0 <= instant <= last + recording.info.step:
            raise click.BadParameter(f"{instant:g} s is not within the run's {last:g} s",
                                     param_hint="--at")
    return sorted({int(abs(time - instant).argmin()) for instant in instants} or {len(time) - 1})


def _pushes(evidence: Any, body: str, sample: int) -> dict[str, Any]:
    """The largest push of a body in each direction [N] in a sample, as JSON data.

    Raises:
        BadParameter: no such body, or one that does not move freely.
    """
    from sandbox.audit.bounds import push_limits

    names = [each.name for each in evidence.run.mechanism.bodies]
    if body not in names:
        raise click.BadParameter(f"there is no body {body!r}{or_near(body, names)}",
                                 param_hint="--push")
    if evidence.run.mechanism.bodies[names.index(body)].motion != "dynamic":
        raise click.BadParameter(f"{body!r} does not move freely: no push moves it",
                                 param_hint="--push")
    angles = [360 * k / DIRECTIONS for k in range(DIRECTIONS)]
    found = push_limits(evidence, names.index(body), [math.radians(each) for each in angles],
                        sample)
    return {"time": float(evidence.run.time[sample]), "body": body, "direction_deg": angles,
            "force": found.tolist()}


def _parts(one: Bounds, recording: Recording) -> list[tuple[str, Interval]]:
    """The normal and the tangential force of a pair, by name."""
    first, second = (recording.mechanism.bodies[body].name for body in (one.body, one.other))
    return [(f"{first}/{second}.normal", one.normal),
            (f"{first}/{second}.tangential", one.tangential)]


def shown_numbers(part: Interval) -> tuple[str, str]:
    """The force and its interval as text, without contradictions by rounding.

    Values within the rounding error are 0, and an interval is widened to a force that is outside
    it by rounding alone.
    """
    low, high = part.low, part.high
    if not part.outside:
        low, high = min(low, part.force), max(high, part.force)
    force, low, high = (0.0 if abs(value) <= known else value for value, known in zip(
        (part.force, low, high), (max(part.allowed), *part.allowed), strict=True))
    return f"{force:.6g}", f"{low:.6g} to {high:.6g}"


def _decided(part: Interval) -> bool:
    return part.high - part.low <= sum(part.allowed)


def _bounds_data(time: float, one: Bounds, recording: Recording) -> dict[str, Any]:
    """The bounds of a pair as JSON data [N]; infinite and missing values are null.

    ``tolerance`` is the rounding error.
    """
    names = [body.name for body in recording.mechanism.bodies]
    data: dict[str, Any] = {"time": float(time), "body": names[one.body],
                            "other": names[one.other]}
    for kind, part in (("normal", one.normal), ("tangential", one.tangential)):
        data[kind] = _plain({"force": part.force, "low": part.low, "high": part.high,
                             "tolerance": max(part.allowed), "decided": _decided(part),
                             "outside": part.outside})
    return data
