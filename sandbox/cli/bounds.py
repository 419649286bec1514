"""``sandbox bounds``: between which values mechanics leaves the contact forces of a saved run."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.failures import see
from sandbox.cli.options import read_length
from sandbox.cli.runs import file_option, open_run

if TYPE_CHECKING:
    from sandbox.audit.bounds import Bounds, Interval
    from sandbox.recording.recording import Recording


@click.command()
@click.argument("run")
@click.option("--at", "instants", multiple=True, type=float, metavar="SECONDS",
              help="The sample nearest to this time; by default the last one. May be given "
                   "several times.")
@click.option("--near", metavar="LENGTH", callback=read_length,
              help="How near outlines count as touching, even if they carry nothing; by default "
                   "what a step may leave open (docs/audit.md tells how much that is). As 10um.")
@file_option((".csv",), "A .csv file; contact_bounds.csv in the run's directory by default. May "
             "be given several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def bounds(
    run: str, instants: tuple[float, ...], near: float | None, files: tuple[Path, ...],
    as_json: bool, quiet: bool,
) -> int:
    """Tell the least and the largest that contact forces of a saved run could be.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. With friction, single contact forces depend on the way to a grasp;
    what balance, friction and contacts that only push leave of them is an
    interval. What touches and carries nothing counts, with a force of 0.
    Exits 1 if a recorded force is outside of its interval.
    """
    from sandbox.audit.bounds import contact_bounds
    from sandbox.audit.evidence import Evidence
    from sandbox.recording.new_run import BOUNDS, made
    from sandbox.recording.store import save_bounds

    console = Console(as_json=as_json, quiet=quiet)
    directory, recording = open_run(run, console)
    evidence = Evidence(recording)
    found = {sample: contact_bounds(evidence, sample, near)
             for sample in _samples(recording, evidence, instants)}
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
            "bounds": [_data(evidence.run.time[sample], one, recording)
                       for sample, each in found.items() for one in each]})
        return code
    for sample, each in found.items():
        console.say(f"t = {evidence.run.time[sample]:.6g} s"
                    + ("" if each else ": nothing touches"))
        if each:
            console.say(*_table(each, recording), "")
    if outside:
        console.error(f"outside of what mechanics allows: {', '.join(outside[:4])}"
                      + (f" and {len(outside) - 4} more" if len(outside) > 4 else ""))
        console.warn(*see(["impossible-forces"]))
    console.say(*map(str, files))
    return code


def _samples(recording: Recording, evidence: Any, instants: tuple[float, ...]) -> list[int]:
    """Numbers of the samples nearest to some times, the last one by default.

    Raises:
        BadParameter: a time outside of the run.
    """
    time = evidence.run.time
    last = float(recording.time[-1])
    for instant in instants:
        if not 0 <= instant <= last + recording.info.step:
            raise click.BadParameter(f"{instant:g} s is not within the run's {last:g} s",
                                     param_hint="--at")
    return sorted({int(abs(time - instant).argmin()) for instant in instants} or {len(time) - 1})


def _parts(one: Bounds, recording: Recording) -> list[tuple[str, Interval]]:
    """The components of a row by their names."""
    first, second = (recording.mechanism.bodies[body].name for body in (one.body, one.other))
    return [(f"{first}/{second}.normal", one.normal),
            (f"{first}/{second}.tangential", one.tangential)]


def _table(each: list[Bounds], recording: Recording) -> list[str]:
    rows = [[label, *shown_numbers(part),
             "OUTSIDE" if part.outside else "decided" if _decided(part) else ""]
            for one in each for label, part in _parts(one, recording)]
    return table(["force of", "N", "could be", ""], rows, right="<>")


def shown_numbers(part: Interval) -> tuple[str, str]:
    """The force and its interval as text, so that rounding does not read as a contradiction.

    What is no more than rounding makes is 0, and an interval that the force is outside of by
    rounding alone reaches to it.
    """
    low, high = part.low, part.high
    if not part.outside:
        low, high = min(low, part.force), max(high, part.force)
    force, low, high = (0.0 if abs(value) <= known else value for value, known in zip(
        (part.force, low, high), (max(part.allowed), *part.allowed), strict=True))
    return f"{force:.6g}", f"{low:.6g} to {high:.6g}"


def _decided(part: Interval) -> bool:
    return part.high - part.low <= sum(part.allowed)


def _data(time: float, one: Bounds, recording: Recording) -> dict[str, Any]:
    names = [body.name for body in recording.mechanism.bodies]
    return {"time": float(time), "body": names[one.body], "other": names[one.other],
            **{kind: _interval(part) for kind, part in (("normal", one.normal),
                                                       ("tangential", one.tangential))}}


def _interval(part: Interval) -> dict[str, float | bool | None]:
    """Numbers in N; what has no bound, or where nothing balances, is null.

    ``tolerance`` is what rounding may make of them.
    """
    numbers = {"force": part.force, "low": part.low, "high": part.high,
               "tolerance": max(part.allowed)}
    return {**{key: value if math.isfinite(value) else None for key, value in numbers.items()},
            "decided": _decided(part), "outside": part.outside}
