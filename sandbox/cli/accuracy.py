"""``sandbox converge`` and ``sandbox bounds``: the accuracy of a scene and of contact forces."""

from __future__ import annotations

import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import click

from sandbox.atomic_files import write_atomic
from sandbox.audit.bounds import Interval, contact_bounds, push_limits
from sandbox.audit.evidence import Evidence
from sandbox.cli.check import ready
from sandbox.cli.console import Console, Exit, first_of, monitored, see, shown, table
from sandbox.cli.options import Source
from sandbox.cli.runs import open_run
from sandbox.convergence.certificate import certify, refined, unfit
from sandbox.engine.inspect import look_over
from sandbox.errors import SceneError
from sandbox.recording.new_run import BOUNDS, made
from sandbox.recording.store import bound_rows
from sandbox.scene.read.limits import check_limits
from sandbox.wording import or_near

MAX_NAMED = 4  # forces outside their bounds that are named
DIRECTIONS = 12  # directions of a push, evenly spaced


def converge(scene: Source, console: Console) -> int:
    """Print the verdicts on the expected quantities of a scene at three steps."""
    loaded, _, _ = ready(scene)
    finest = refined(loaded.mechanism, 4)
    if problems := unfit(loaded.mechanism) or [
            replace(each, message=f"{each.message} (of the run at a quarter of the step)")
            for each in check_limits(finest, scene.limits)
            or look_over(finest).estimate.beyond(scene.limits)]:
        raise SceneError(problems, loaded.name)
    with monitored(console, "Simulating") as progress:
        found = certify(loaded.mechanism, progress=progress)
    rows = [[t.quantity, t.statistic, *(shown(v, ".6g") for v in t.values),
             "" if t.unit == "1" else t.unit, shown(t.order, ".1f"), shown(t.error, ".1e"),
             shown(t.allowed, ".1e"), t.kind]
            for t in found.quantities]
    lines = [
        *table(["expectation of", "", f"h = {1e3 * found.steps[0]:.4g} ms", "h/2", "h/4", "unit",
                "order", "estimated error", "allowed", "result"], rows, right="<<>>><>>>"),
        *(f"{t.kind} {t.statistic} {t.quantity}: {t.reason}"
          for t in found.quantities if t.reason),
        *(f"warning {look.figure.name} ({', '.join(look.runs)}) = "
          f"{shown(look.figure.value, '.1e')}, at most "
          f"{shown(look.figure.threshold, '.1e')}: {look.figure.why}"
          for look in found.looks),
        "", found.conclusion, *found.advice]
    if found.diverged and not console.as_json:
        console.error(*(f"error: {each.run}: {each.reason}" for each in found.diverged),
                      *see("diverged"))
    return console.finish({
        "scene": loaded.mechanism.name, "steps": found.steps, "certified": found.certified,
        "conclusion": found.conclusion, "advice": found.advice,
        "quantities": [{**asdict(trust), "certified": trust.certified}
                       for trust in found.quantities],
        "looks": [{"runs": look.runs, **vars(look.figure)} for look in found.looks],
        "diverged": [each._asdict() for each in found.diverged],
    }, lines, Exit.DIVERGED if found.diverged else Exit.DONE if found.certified else Exit.FAILED)


def bounds(
    run: str, instants: tuple[float, ...], near: float | None, pushed: str | None,
    files: tuple[Path, ...], console: Console,
) -> int:
    """Print and write the intervals of contact forces, and the largest pushes of a body."""
    directory, recording = open_run(run, console)
    evidence = Evidence(recording)
    time, last = evidence.run.time, float(recording.time[-1])
    for instant in instants:
        if not 0 <= instant <= last + recording.info.step:
            raise click.BadParameter(f"{instant:g} s is not within the run's {last:g} s",
                                     param_hint="--at")
    samples = sorted({int(abs(time - t).argmin()) for t in instants} or {len(time) - 1})
    pushes = [] if pushed is None else [_pushes(evidence, pushed, sample) for sample in samples]
    found = {sample: contact_bounds(evidence, sample, near) for sample in samples}
    files = files or (directory / BOUNDS,)
    for file in files:
        write_atomic(file, "".join(bound_rows(evidence.run, found)))
        made(file)
    names = [body.name for body in recording.mechanism.bodies]
    lines, outside, data = list[str](), list[str](), list[dict[str, Any]]()
    for sample, contacts in found.items():
        rows = []
        for one in contacts:
            body, other = names[one.body], names[one.other]
            data.append({"time": float(time[sample]), "body": body, "other": other})
            for kind, part in (("normal", one.normal), ("tangential", one.tangential)):
                decided = part.high - part.low <= sum(part.allowed)
                data[-1][kind] = {"force": part.force, "low": part.low, "high": part.high,
                                  "tolerance": max(part.allowed), "decided": decided,
                                  "outside": part.outside}
                rows.append([f"{body}/{other}.{kind}", *_shown(part),
                             "OUTSIDE" if part.outside else "decided" if decided else ""])
        outside += [label for label, _, _, verdict in rows if verdict == "OUTSIDE"]
        lines.append(f"t = {time[sample]:.6g} s" + ("" if rows else ": nothing touches"))
        lines += [*table(["force of", "N", "interval", ""], rows, right="<>"), ""] if rows else []
    for push in pushes:
        rows = [[f"{angle:g}", f"{force:.6g}"]
                for angle, force in zip(push["direction_deg"], push["force"], strict=True)]
        lines += [f"largest push of {pushed} at t = {push['time']:.6g} s",
                  *table(["direction deg", "N"], rows, right=">>"), ""]
    code = console.finish({"run": directory, "files": files, "bounds": data, "pushes": pushes},
                          [*lines, *files], Exit.FAILED if outside else Exit.DONE)
    if outside and not console.as_json:
        console.error("outside the range that mechanics allows: " + first_of(outside, MAX_NAMED))
        console.warn(*see("impossible-forces"))
    return code


def _pushes(evidence: Evidence, body: str, sample: int) -> dict[str, Any]:
    """The largest push of a body in each direction [N] in a sample, as JSON data."""
    bodies = {each.name: each for each in evidence.run.mechanism.bodies}
    if body not in bodies or bodies[body].motion != "dynamic":
        why = f"{body!r} does not move freely: no push moves it" if body in bodies else \
            f"there is no body {body!r}{or_near(body, bodies)}"
        raise click.BadParameter(why, param_hint="--push")
    angles = [360 * k / DIRECTIONS for k in range(DIRECTIONS)]
    found = push_limits(evidence, [*bodies].index(body), [math.radians(each) for each in angles],
                        sample)
    return {"time": float(evidence.run.time[sample]), "body": body, "direction_deg": angles,
            "force": found.tolist()}


def _shown(part: Interval) -> tuple[str, str]:
    """The force and its interval as text, without contradictions by rounding."""
    low, high = part.low, part.high
    if not part.outside:
        low, high = min(low, part.force), max(high, part.force)
    force, low, high = (0.0 if abs(value) <= known else value for value, known in zip(
        (part.force, low, high), (max(part.allowed), *part.allowed), strict=True))
    return f"{force:.6g}", f"{low:.6g} to {high:.6g}"
