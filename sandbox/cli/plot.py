"""``sandbox plot``: list, plot and compare the quantities of saved runs."""

from __future__ import annotations

import math
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import Any

import click

from sandbox.atomic_files import write_csv
from sandbox.cli.console import Console, first_of, table
from sandbox.cli.options import PICTURES
from sandbox.cli.runs import matching, open_run, run_with
from sandbox.elements.quantities import row_of
from sandbox.figure.signals import Plotted, draw
from sandbox.figure.style import number, save_figure, shown_as
from sandbox.recording.new_run import made
from sandbox.recording.recording import Recording
from sandbox.samples.targets import controlled, effort, ending, initial, response, tracked
from sandbox.samples.targets import targets as targets_of
from sandbox.values.units import UNITS, normal_unit, parse_quantity

KINDS = ("meter", "drive", "tendon", "joint", "spring", "load", "line", "valve", "group", "body")
"""Kinds of element, in the order in which they are listed."""
MAX_NAMES, MAX_PAIRS, MAX_TRIED = 8, 6, 200  # listed elements, listed pairs, examined pairs
Records = list[tuple[str, dict[str, Any]]]  # of runs, by their labels


def plot(
    run: str, quantities: tuple[str, ...], others: tuple[str, ...], targets: dict[str, str],
    across: str, begin: float | None, end: float | None, width: float | None, untitled: bool,
    files: tuple[Path, ...], console: Console,
) -> int:
    """List the quantities of a run, or plot and compare those of some runs."""
    opened = [open_run(word, console) for word in (run, *others)]
    directory, first = opened[0]
    recordings = [recording for _, recording in opened]
    restricted = bool(across) or begin is not None or end is not None
    if not (quantities or others or targets):
        if restricted or width is not None or untitled or files:
            raise click.UsageError("name the quantities to plot; 'sandbox plot RUN' lists them")
        described = []
        for name, unit in first.catalogue.units.items():
            source = first.catalogue.find(name)
            about = first.mechanism.meters[source.index].value if source.kind == "meter" else \
                _about(source.kind, source.quantity)
            described.append({"name": name, "unit": unit, "about": about})
        return console.finish({"quantities": described}, _listing(first, run))
    given = {}
    for name, text in targets.items():
        unit = run_with(name, recordings, option="--target").unit(name)
        _, dimension = UNITS.get(normal_unit(unit), (1.0, None))
        try:
            given[name] = parse_quantity(text, dimension)
        except ValueError as error:
            raise click.BadParameter(f"{name}: {error}", param_hint="--target") from None
    names = matching(quantities, recordings, option="QUANTITY") or _targeted(recordings, given)
    if across:
        run_with(across, recordings, option="--x")
    labels = next((found for found in ([run.mechanism.name for run in recordings],
                                       [path.name for path, _ in opened])
                   if len(set(found)) == len(found) and all(found)),
                  [str(path) for path, _ in opened])
    plotted = [Plotted(label, each, {name: goal for name, goal in targets_of(each, given).items()
                                     if name in names})
               for label, each in zip(labels, recordings, strict=True)]
    # settling and effort refer to a whole run over time
    responses = [] if restricted else _responses(plotted, names)
    efforts = _efforts(plotted) if others and not restricted else []
    files = files or (directory / "plot.png",)
    drawing = draw(plotted, names, x=across, width=width, titled=not untitled, window=(
        begin or 0.0, math.inf if end is None else end)) if any(
            file.suffix.lower() in PICTURES for file in files) else None
    for file in files:
        if file.suffix.lower() == ".csv":
            write_csv(file, _csv_rows([*responses, *efforts]))
        else:
            save_figure(drawing, file)
        made(file)
    return console.finish({"run": directory, "files": files, "runs": [
        {"run": one.label, "directory": path, "title": one.run.mechanism.title,
         "complete": one.run.complete,
         "quantities": [row for label, row in responses if label == one.label],
         "drives": [row for label, row in efforts if label == one.label]}
        for (path, _), one in zip(opened, plotted, strict=True)]},
        [*_tables(responses, efforts), *files])


def _targeted(recordings: Sequence[Recording], given: dict[str, float]) -> list[str]:
    names = [*(name for run in recordings for name in tracked(run)), *given]
    if not names:
        raise click.UsageError("no controller of these runs has a target: "
                               "name the quantities to compare")
    drives = [f"{name}.value" for run in recordings for name in controlled(run)]
    return list(dict.fromkeys([*names, *drives]))


def _responses(plotted: Sequence[Plotted], names: Sequence[str]) -> Records:
    """How quantities follow their targets in each run, and their mean at its end; SI."""
    drives = {f"{name}.value" for one in plotted for name in controlled(one.run)}
    targeted = {name for one in plotted for name in one.targets}
    found: Records = []
    for name in names:
        for one in plotted if name in targeted or name not in drives else ():
            if name in one.run:
                found.append((one.label, {
                    "quantity": name, "unit": one.run.unit(name),
                    "final": float(one.run.within(name, ending(one.run.time)).mean()),
                    "response": asdict(response(one.run, name, one.targets[name]))
                    if name in one.targets else None}))
    return found


def _efforts(plotted: Sequence[Plotted]) -> Records:
    drives = dict.fromkeys(name for one in plotted for name in controlled(one.run))
    return [(one.label, {"drive": drive, "unit": one.run.unit(f"{drive}.value"), **asdict(
                effort(one.run.time, one.run[f"{drive}.value"], initial(one.run, drive)))})
            for drive in drives for one in plotted if drive in controlled(one.run)]


def _tables(responses: Records, efforts: Records) -> list[str]:
    """A row for each run and quantity, angles in degrees; and for each run and controlled drive."""
    lines, rows = list[str](), []
    for run, row in responses:
        shown, r = shown_as(row["unit"]), row["response"]
        rows.append([row["quantity"], run, shown.unit, number(shown.factor * row["final"]),
                     *(["-"] * 5 if r is None else [
                         number(shown.factor * r["target"]), number(r["overshoot"], 3),
                         number(r["settling"]), f"{shown.factor * r['steady_error']:+.3g}",
                         f"{shown.factor * r['iae']:.4g}"])])
    if any(row["response"] for _, row in responses):
        lines += table(["quantity", "run", "unit", "end", "target", "overshoot %", "settling s",
                        "steady error", "IAE"], rows, right="<<<>>>>>>")
    if efforts:
        lines += ["", *table(
            ["drive", "run", "unit", "total variation", "peak", "largest rate /s"],
            [[row["drive"], run, row["unit"], number(row["variation"]), number(row["peak"]),
              f"{row['rate']:.4g}"] for run, row in efforts], right="<<<>>>")]
    return lines


def _csv_rows(records: Records) -> Iterator[tuple[str, ...]]:
    """One number a line, SI; empty for what never happens."""
    yield "run", "name", "measure", "value", "unit"
    for run, row in records:
        unit, name = str(row["unit"]), str(row.get("quantity") or row["drive"])
        units = {"overshoot": "%", "settling": "s", "iae": f"{unit} s", "rate": f"{unit}/s"}
        for measure, value in (row.get("response") or row).items():
            if isinstance(value, float):
                yield (run, name, measure,
                       f"{value:.12g}" if math.isfinite(value) else "", units.get(measure, unit))


def _listing(run: Recording, word: str) -> list[str]:
    """The quantities of a run by kind, and commands that plot some of them."""
    all_units = run.catalogue.units
    lines = [run.mechanism.title or run.mechanism.name,
             f"{len(run)} samples from 0 to {run.time[-1]:.3g} s of {len(all_units)} quantities"]
    for kind in KINDS:
        having = {name: entry for name, entry in run.catalogue.elements.items()
                  if entry.kind == kind}
        units: dict[str, list[str]] = {}
        for entry in having.values():
            for quantity, unit in entry.quantities.items():
                units.setdefault(quantity, []).append(unit)
        if kind == "meter":
            names, rows = "", [(name, entry.quantities[""], run.mechanism.meters[entry.index].value)
                               for name, entry in having.items()]
        else:
            names = first_of(list(having), MAX_NAMES)
            rows = [(f".{quantity}", " or ".join(dict.fromkeys(each)), _about(kind, quantity)
                     + ("" if len(each) == len(having) else f" ({len(each)} of {len(having)})"))
                    for quantity, each in units.items()]
        if having:
            many = "bodies" if kind == "body" else f"{kind}s"
            lines += ["", f"{many}: {names}".rstrip(), *_rows(rows)]
    pairs = [name.removesuffix(".normal") for name in run.match("*/*.normal")[:MAX_TRIED]
             if (run[name] > 0).any()]
    if pairs:
        lines += ["", f"pairs of bodies that touched: {first_of(pairs, MAX_PAIRS)}", *_rows([
            (f".{name}", "N", _about("pair", name)) for name in ("normal", "tangential")])]
    wanted = [*tracked(run), *chain(*run.catalogue.usual.values()), *all_units]
    other = next((name for name in wanted if all_units[name] != all_units[wanted[0]]), "")
    examples = [[wanted[0]], [other, "--x", wanted[0]] if other else [],
                [f"{pairs[0]}.normal"] if pairs else []]
    return [*lines, "", "to plot some:", *(f"  sandbox plot {shlex.join([word, *words])}"
                                           for words in examples if words)]


def _rows(rows: list[tuple[str, str, str]]) -> list[str]:
    return ["  " + line for line in table([], [
        (name, "" if unit == "1" else unit, about) for name, unit, about in rows])]


def _about(kind: str, quantity: str) -> str:
    return row_of(kind, quantity).about.replace("`", "'")
