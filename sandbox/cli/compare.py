"""``sandbox compare``: runs compared over one another, how they answer, and what it costs."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.plot import response_data
from sandbox.cli.runs import (
    PICTURES,
    file_option,
    labels,
    matching,
    open_run,
    target_option,
    target_values,
)

if TYPE_CHECKING:
    from sandbox.draw.figure.comparison import Compared
    from sandbox.recording.recording import Recording
    from sandbox.samples.response import Effort, Response


@dataclass(frozen=True)
class Answer:
    """How one run's quantity answers."""

    run: str
    quantity: str
    unit: str
    response: Response | None
    """None where the run has no target for it."""
    final: float
    """The mean of the end of the run, SI."""


@dataclass(frozen=True)
class Cost:
    """What a drive under control had to do in one run."""

    run: str
    drive: str
    unit: str
    effort: Effort


@click.command()
@click.argument("runs", nargs=-1, required=True, metavar="RUN...")
@click.option("--quantity", "quantities", multiple=True, metavar="QUANTITY",
              help="What is compared, patterns allowed; by default what controllers lead to "
                   "targets in any of the runs. May be given several times.")
@target_option
@file_option((*PICTURES, ".csv"), "A picture (.png, .svg, .pdf) or the table (.csv). May be given "
             "several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def compare(
    runs: tuple[str, ...], quantities: tuple[str, ...], targets: dict[str, str],
    files: tuple[Path, ...], as_json: bool, quiet: bool,
) -> int:
    """Compare saved runs: overshoot, settling, steady error, effort.

    A RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. Overshoot is a share of the step to the target; settling is the
    last time outside of +-2 % of the target; the steady error is the mean over
    the last 5 % of the run; IAE the integral of the error's size.
    """
    from sandbox.draw.figure.comparison import Compared
    from sandbox.recording.new_run import made
    from sandbox.samples.targets import controlled
    from sandbox.samples.targets import targets as goals_of

    console = Console(as_json=as_json, quiet=quiet)
    opened = [open_run(word, console) for word in runs]
    recordings = [recording for _, recording in opened]
    given = target_values(targets, recordings)
    compared = [Compared(label, recording, goals_of(recording, given))
            for label, recording in zip(labels(opened), recordings, strict=True)]
    names = _quantities(quantities, given, recordings)
    answers = [_answer(one, name) for name in names for one in compared if name in one.run]
    drives = list(dict.fromkeys(name for run in recordings for name in controlled(run)))
    costs = [_cost(one, drive) for drive in drives for one in compared
             if drive in controlled(one.run)]
    for file in files:
        _write(file, compared, names, drives, answers, costs)
        made(file)
    if as_json:
        console.result_json(_data(opened, compared, answers, costs, files))
        return Exit.DONE
    console.say(*answer_table(answers))
    if costs:
        console.say("", *cost_table(costs))
    if files:
        console.say("", *map(str, files))
    return Exit.DONE


def _quantities(
    patterns: tuple[str, ...], given: dict[str, float], recordings: Sequence[Recording],
) -> list[str]:
    """What is compared.

    Raises:
        UsageError: nothing is asked for, and nothing follows from the runs.
        BadParameter: a quantity that no run has.
    """
    from sandbox.samples.targets import led

    if patterns:
        return list(dict.fromkeys(name for pattern in patterns for name in
                                  matching(pattern, recordings, option="--quantity")))
    names = list(dict.fromkeys([*(name for run in recordings for name in led(run)), *given]))
    if not names:
        raise click.UsageError("no controller of these runs leads a quantity to a target: "
                               "say what to compare with --quantity")
    return names


def _answer(one: Compared, name: str) -> Answer:
    from sandbox.samples.response import ending
    from sandbox.samples.targets import responses

    run = one.run
    goals = {name: one.targets[name]} if name in one.targets else {}
    return Answer(one.label, name, run.unit(name), responses(run, goals).get(name),
                  float(run.within(name, ending(run.time)).mean()))


def _cost(one: Compared, drive: str) -> Cost:
    from sandbox.samples.response import effort
    from sandbox.samples.targets import initial

    name = f"{drive}.value"
    return Cost(one.label, drive, one.run.unit(name),
                effort(one.run.time, one.run[name], initial(one.run, drive)))


def answer_table(answers: Sequence[Answer]) -> list[str]:
    """A row for each run and quantity; angles in degrees."""
    from sandbox.draw.figure.style import number, shown_as

    rows = []
    for a in answers:
        shown, r = shown_as(a.unit), a.response
        cells = ["-"] * 5 if r is None else [
            number(shown.factor * r.target), number(r.overshoot, 3), number(r.settling),
            f"{shown.factor * r.steady_error:+.3g}", f"{shown.factor * r.iae:.4g}"]
        rows.append([a.quantity, a.run, shown.unit, number(shown.factor * a.final), *cells])
    return table(["quantity", "run", "unit", "end", "target", "overshoot %", "settles s",
                  "steady error", "IAE"], rows, right="<<<>>>>>>")


def cost_table(costs: Sequence[Cost]) -> list[str]:
    """A row for each run and drive under control."""
    from sandbox.draw.figure.style import number

    rows = [[c.drive, c.run, c.unit, number(c.effort.variation), number(c.effort.peak),
             f"{c.effort.rate:.4g}"] for c in costs]
    return table(["drive", "run", "unit", "total variation", "peak", "largest rate /s"], rows,
                 right="<<<>>>")


def _write(
    file: Path, compared: Sequence[Compared], names: Sequence[str], drives: Sequence[str],
    answers: Sequence[Answer], costs: Sequence[Cost],
) -> None:
    from sandbox.draw.figure import comparison
    from sandbox.draw.figure.style import save_figure
    from sandbox.whole_files import write_whole

    if file.suffix.lower() != ".csv":
        save_figure(comparison.draw(compared, names, drives), file)
        return
    write_whole(file, csv_text(answers, costs))


def csv_text(answers: Sequence[Answer], costs: Sequence[Cost]) -> str:
    """A line for each figure: run, name, measure, value, unit; SI. What never happens is empty."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["run", "name", "measure", "value", "unit"])

    def line(run: str, name: str, measure: str, value: float, unit: str) -> None:
        text = f"{value:.12g}" if math.isfinite(value) else ""
        writer.writerow([run, name, measure, text, unit])

    for a in answers:
        if a.response is None:
            line(a.run, a.quantity, "final", a.final, a.unit)
            continue
        units = {"overshoot": "%", "settling": "s", "iae": f"{a.unit} s"}
        for measure, value in asdict(a.response).items():
            line(a.run, a.quantity, measure, value, units.get(measure, a.unit))
    for c in costs:
        for measure, value in asdict(c.effort).items():
            line(c.run, c.drive, measure, value, f"{c.unit}/s" if measure == "rate" else c.unit)
    return out.getvalue()


def _data(
    opened: Sequence[tuple[Path, Recording]], compared: Sequence[Compared],
    answers: Sequence[Answer], costs: Sequence[Cost], files: Sequence[Path],
) -> dict[str, Any]:
    """Everything as JSON data, SI; what has no value or never happens is null."""
    reports = []
    for (directory, run), one in zip(opened, compared, strict=True):
        reports.append({
            "run": one.label, "directory": str(directory), "title": run.mechanism.title,
            "complete": run.complete,
            "quantities": [{"quantity": a.quantity, "unit": a.unit, "final": _finite(a.final),
                            "response": a.response and response_data(a.response)}
                           for a in answers if a.run == one.label],
            "drives": [{"drive": c.drive, "unit": c.unit,
                        **{key: _finite(value) for key, value in asdict(c.effort).items()}}
                       for c in costs if c.run == one.label]})
    return {"status": "done", "exit_code": int(Exit.DONE), "runs": reports,
            "files": [str(file) for file in files]}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
