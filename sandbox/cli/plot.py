"""``sandbox plot``: list, plot and compare the quantities of saved runs."""

from __future__ import annotations

import csv
import io
import math
import shlex
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, table
from sandbox.cli.failures import Exit
from sandbox.cli.options import json_option, quiet_option, read_length, read_pairs, read_time
from sandbox.cli.runs import file_option, matching, open_run, run_with

if TYPE_CHECKING:
    from sandbox.figure.signals import Plotted
    from sandbox.recording.recording import Recording
    from sandbox.samples.targets import Effort, Response

PICTURES = (".png", ".svg", ".pdf")
"""Suffixes of figures."""
KINDS = {"meter": "meters", "drive": "drives", "tendon": "tendons", "joint": "joints",
         "spring": "springs", "load": "loads", "line": "lines", "valve": "valves",
         "group": "groups", "body": "bodies"}
"""Kinds of element, in the order in which they are listed."""
MAX_NAMES, MAX_PAIRS, MAX_TRIED = 8, 6, 200
"""Listed elements of a kind; listed pairs of bodies that touched, and pairs that are examined."""
MAX_CURVES = 12
"""Curves of the pattern in an example."""


@dataclass(frozen=True)
class Answer:
    """How a quantity of one run follows its target, if it has one; ``final`` is in SI."""

    run: str
    quantity: str
    unit: str
    response: Response | None
    final: float
    """Mean over the end of the run."""


@dataclass(frozen=True)
class Cost:
    """The effort of a controlled drive in one run."""

    run: str
    drive: str
    unit: str
    effort: Effort


@click.command()
@click.argument("run")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--with", "others", multiple=True, metavar="RUN",
              help="Another run in the same figure, in another colour. Repeatable.")
@click.option("--target", "targets", multiple=True, metavar="QUANTITY=VALUE", callback=read_pairs,
              help="Target of a quantity, as in 'finger.mcp.angle=5deg', in place of that of a "
                   "controller. Repeatable.")
@click.option("--x", "across", metavar="QUANTITY", default="",
              help="Plot against this quantity, in place of time.")
@click.option("--from", "begin", metavar="TIME", callback=read_time,
              help="Start of the plot, as in '0.5s' or '200 ms'.")
@click.option("--to", "end", metavar="TIME", callback=read_time, help="End of the plot.")
@click.option("--width", metavar="LENGTH", callback=read_length,
              help="Width of the figure on paper, as in '85mm'; 120 mm by default.")
@click.option("--no-title", "untitled", is_flag=True, help="Omit the scene's title.")
@file_option((*PICTURES, ".csv"), "A figure (.png, .svg, .pdf) or the table of responses (.csv); "
             "plot.png in the run's directory by default. Repeatable.")
@json_option
@quiet_option
def plot(
    run: str, quantities: tuple[str, ...], others: tuple[str, ...], targets: dict[str, str],
    across: str, begin: float | None, end: float | None, width: float | None, untitled: bool,
    files: tuple[Path, ...], as_json: bool, quiet: bool,
) -> int:
    """List or plot the quantities of a saved run, or compare runs.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. A QUANTITY is a name such as finger.mcp.angle, or a pattern such as
    'finger.*.angle'; without any, the quantities of the run are listed. --with
    compares runs, by default in the quantities that controllers lead to targets,
    and prints overshoot, settling time, errors and effort. Nothing is simulated.
    """
    from sandbox.figure.signals import Plotted, Window
    from sandbox.samples.targets import targets as targets_of

    console = Console(as_json=as_json, quiet=quiet)
    opened = [open_run(word, console) for word in (run, *others)]
    directory, first = opened[0]
    recordings = [recording for _, recording in opened]
    restricted = bool(across) or begin is not None or end is not None
    if not (quantities or others or targets):
        if restricted or width is not None or untitled or files:
            raise click.UsageError("name the quantities to plot; 'sandbox plot RUN' lists them")
        return _list_quantities(console, first, run)
    given = target_values(targets, recordings)
    names = matching(quantities, recordings, option="QUANTITY") or _led(recordings, given)
    idle = _idle(names, quantities, recordings) if others else []
    names = [name for name in names if name not in idle]
    if across:
        run_with(across, recordings, option="--x")
    plotted = [Plotted(label, each, {name: goal for name, goal in targets_of(each, given).items()
                                     if name in names})
               for label, each in zip(labels(opened), recordings, strict=True)]
    # settling and effort refer to a whole run over time
    answers, costs = ([], []) if restricted else _compared(plotted, names, with_costs=bool(others))
    files = files or (directory / "plot.png",)
    window = Window(begin or 0.0, math.inf if end is None else end)
    _write(files, plotted, names, answers, costs,
           x=across, window=window, width=width, titled=not untitled)
    if as_json:
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "run": str(directory),
            "files": [str(file) for file in files], "left_out": idle,
            "runs": _data(opened, plotted, answers, costs)})
        return Exit.DONE
    if any(answer.response for answer in answers):
        console.say(*answer_table(answers))
    if costs:
        console.say("", *cost_table(costs))
    if idle:
        console.say(f"left out, 0 in all runs: {', '.join(idle)}")
    console.say(*map(str, files))
    return Exit.DONE


def target_values(texts: dict[str, str], runs: Sequence[Recording]) -> dict[str, float]:
    """Targets in SI, read in the unit of their quantity.

    Raises:
        BadParameter: a quantity that no run has, with a suggestion; an unreadable value.
    """
    from sandbox.values.units import UNITS, normal_unit, parse_quantity

    found = {}
    for name, text in texts.items():
        run = run_with(name, runs, option="--target")
        _, dimension = UNITS.get(normal_unit(run.unit(name)), (1.0, None))
        try:
            found[name] = parse_quantity(text, dimension)
        except ValueError as error:
            raise click.BadParameter(f"{name}: {error}", param_hint="--target") from None
    return found


def labels(opened: Sequence[tuple[Path, Recording]]) -> list[str]:
    """Names of the runs: their scenes, or their directories where these are equal."""
    names: tuple[Callable[[Path, Recording], str], ...] = (
        lambda _, run: run.mechanism.name, lambda path, _: path.name)
    for name in names:
        found = [name(path, run) for path, run in opened]
        if len(set(found)) == len(found) and all(found):
            return found
    return [str(path) for path, _ in opened]


def _led(recordings: Sequence[Recording], given: dict[str, float]) -> list[str]:
    """The quantities with a target, and the drives of the controllers that lead them there.

    Raises:
        UsageError: there are none.
    """
    from sandbox.samples.targets import controlled, led

    names = [*(name for run in recordings for name in led(run)), *given]
    if not names:
        raise click.UsageError("no controller of these runs leads a quantity to a target: "
                               "name the quantities to compare")
    drives = [f"{name}.value" for run in recordings for name in controlled(run)]
    return list(dict.fromkeys([*names, *drives]))


def _idle(
    names: Sequence[str], quantities: Sequence[str], recordings: Sequence[Recording],
) -> list[str]:
    """Quantities found by a pattern that are 0 in all runs; never all of the names."""
    import numpy as np

    from sandbox.web.packing import NOTHING

    having = {name: [run for run in recordings if name in run] for name in names}
    sizes = {name: max(float(np.nanmax(np.abs(run[name]), initial=0.0)) for run in runs)
             for name, runs in having.items()}
    units = {name: runs[0].unit(name) for name, runs in having.items()}
    found = [name for name in names if name not in quantities and sizes[name] <= NOTHING * max(
        size for other, size in sizes.items() if units[other] == units[name])]
    return found if len(found) < len(names) else []


def _compared(
    plotted: Sequence[Plotted], names: Sequence[str], *, with_costs: bool,
) -> tuple[list[Answer], list[Cost]]:
    """The responses of quantities, and the effort of controlled drives if wanted."""
    from sandbox.samples.targets import controlled, effort, ending, initial, responses

    answers, costs = [], []
    drives = dict.fromkeys(name for one in plotted for name in controlled(one.run))
    for name in names:
        if name.removesuffix(".value") in drives and not any(name in one.targets
                                                             for one in plotted):
            continue
        for one in plotted:
            if name in one.run:
                goals = {name: one.targets[name]} if name in one.targets else {}
                answers.append(Answer(
                    one.label, name, one.run.unit(name), responses(one.run, goals).get(name),
                    float(one.run.within(name, ending(one.run.time)).mean())))
    for drive in drives if with_costs else ():
        value = f"{drive}.value"
        costs += [Cost(one.label, drive, one.run.unit(value),
                       effort(one.run.time, one.run[value], initial(one.run, drive)))
                  for one in plotted if drive in controlled(one.run)]
    return answers, costs


def answer_table(answers: Sequence[Answer]) -> list[str]:
    """A row for each run and quantity; angles in degrees."""
    from sandbox.figure.style import number, shown_as

    rows = []
    for a in answers:
        shown, r = shown_as(a.unit), a.response
        cells = ["-"] * 5 if r is None else [
            number(shown.factor * r.target), number(r.overshoot, 3), number(r.settling),
            f"{shown.factor * r.steady_error:+.3g}", f"{shown.factor * r.iae:.4g}"]
        rows.append([a.quantity, a.run, shown.unit, number(shown.factor * a.final), *cells])
    return table(["quantity", "run", "unit", "end", "target", "overshoot %", "settling s",
                  "steady error", "IAE"], rows, right="<<<>>>>>>")


def cost_table(costs: Sequence[Cost]) -> list[str]:
    """A row for each run and controlled drive."""
    from sandbox.figure.style import number

    rows = [[c.drive, c.run, c.unit, number(c.effort.variation), number(c.effort.peak),
             f"{c.effort.rate:.4g}"] for c in costs]
    return table(["drive", "run", "unit", "total variation", "peak", "largest rate /s"], rows,
                 right="<<<>>>")


def _write(
    files: Sequence[Path], plotted: Sequence[Plotted], names: Sequence[str],
    answers: Sequence[Answer], costs: Sequence[Cost], **how: Any,
) -> None:
    """Write the figures and tables."""
    from sandbox.atomic_files import write_atomic
    from sandbox.figure.signals import draw
    from sandbox.figure.style import save_figure
    from sandbox.recording.new_run import made

    drawing = draw(plotted, names, **how) \
        if any(file.suffix.lower() != ".csv" for file in files) else None
    for file in files:
        if file.suffix.lower() == ".csv":
            write_atomic(file, csv_text(answers, costs))
        else:
            save_figure(drawing, file)
        made(file)


def csv_text(answers: Sequence[Answer], costs: Sequence[Cost]) -> str:
    """One number a line: run, name, measure, value, unit; SI. What never happens is empty."""
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
    opened: Sequence[tuple[Path, Recording]], plotted: Sequence[Plotted],
    answers: Sequence[Answer], costs: Sequence[Cost],
) -> list[dict[str, Any]]:
    """The responses and efforts of each run as JSON data, SI; infinite and missing are null."""
    return [{
        "run": one.label, "directory": str(directory), "title": run.mechanism.title,
        "complete": run.complete,
        "quantities": [{"quantity": a.quantity, "unit": a.unit, **_finite({"final": a.final}),
                        "response": a.response and _finite(asdict(a.response))}
                       for a in answers if a.run == one.label],
        "drives": [{"drive": c.drive, "unit": c.unit, **_finite(asdict(c.effort))}
                   for c in costs if c.run == one.label],
    } for (directory, run), one in zip(opened, plotted, strict=True)]


def _finite(values: dict[str, float]) -> dict[str, float | None]:
    return {key: value if math.isfinite(value) else None for key, value in values.items()}


def _list_quantities(console: Console, run: Recording, word: str) -> int:
    """Print the quantities of a run by kind, and commands that plot some of them."""
    if console.as_json:
        console.result_json({"quantities": quantity_data(run)})
        return Exit.DONE
    lines = [run.mechanism.title or run.mechanism.name,
             f"{len(run)} samples from 0 to {run.time[-1]:.3g} s of "
             f"{len(run.catalogue.units)} quantities"]
    for kind, many in KINDS.items():
        lines += _kind_lines(run, kind, many)
    pairs = [name.removesuffix(".normal") for name in run.match("*/*.normal")[:MAX_TRIED]
             if (run[name] > 0).any()]
    if pairs:
        lines += ["", f"pairs of bodies that touched: {_first(pairs, MAX_PAIRS)}", *_rows([
            (f".{name}", "N", _about("pair", name)) for name in ("normal", "tangential")])]
    console.result(*lines, "", "to plot some:",
                   *(f"  {line}" for line in _examples(run, word, pairs)))
    return Exit.DONE


def quantity_data(run: Recording) -> list[dict[str, str]]:
    """Every quantity with its unit and description, as JSON data."""
    found = []
    for name, unit in run.catalogue.units.items():
        source = run.catalogue.find(name)
        about = run.mechanism.meters[source.index].value if source.kind == "meter" else \
            _about(source.kind, source.quantity)
        found.append({"name": name, "unit": unit, "about": about})
    return found


def _examples(run: Recording, word: str, pairs: list[str]) -> Iterator[str]:
    """Commands for one quantity, a pattern, one quantity against another, a contact force."""
    from sandbox.elements.quantities import USUAL
    from sandbox.samples.targets import led

    units, usual = run.catalogue.units, run.catalogue.usual
    wanted = list(dict.fromkeys([*led(run), *(name for names in usual.values() for name in names),
                                 *units]))
    plot, one = f"sandbox plot {shlex.quote(word)}", wanted[0]
    yield f"{plot} {shlex.quote(one)}"
    patterns = (pattern for tail in filter(None, USUAL.values()) for pattern in (
        f"*.{tail}", f"{one.partition('.')[0]}.*.{tail}"))
    if several := next((pattern for pattern in patterns
                        if 1 < len(run.match(pattern)) <= MAX_CURVES), ""):
        yield f"{plot} {shlex.quote(several)} --from {0.5 * run.time[-1]:.1g}s"
    if other := next((name for name in wanted if units[name] != units[one]), ""):
        yield f"{plot} {shlex.quote(other)} --x {shlex.quote(one)}"
    if pairs:
        yield f"{plot} {shlex.quote(f'{pairs[0]}.normal')}"


def _kind_lines(run: Recording, kind: str, many: str) -> list[str]:
    """The elements of a kind, and a row for each of their quantities."""
    having = {name: entry for name, entry in run.catalogue.elements.items() if entry.kind == kind}
    if not having:
        return []
    if kind == "meter":
        return ["", f"{many}:", *_rows([
            (name, entry.quantities[""], run.mechanism.meters[entry.index].value)
            for name, entry in having.items()])]
    units: dict[str, list[str]] = {}
    for entry in having.values():
        for quantity, unit in entry.quantities.items():
            units.setdefault(quantity, []).append(unit)
    rows = []
    for quantity, each in units.items():
        some = "" if len(each) == len(having) else f" ({len(each)} of {len(having)})"
        rows.append((f".{quantity}", " or ".join(dict.fromkeys(each)),
                     _about(kind, quantity) + some))
    return ["", f"{many}: {_first(list(having), MAX_NAMES)}", *_rows(rows)]


def _rows(rows: list[tuple[str, str, str]]) -> list[str]:
    wide, units = (max(len(row[i]) for row in rows) for i in (0, 1))
    return [f"  {name:{wide}}  {'' if unit == '1' else unit:{units}}  {about}".rstrip()
            for name, unit, about in rows]


def _about(kind: str, quantity: str) -> str:
    from sandbox.elements.quantities import about

    return about(kind, quantity).replace("`", "'")


def _first(names: list[str], most: int) -> str:
    more = len(names) - most
    return ", ".join(names[:most]) + (f" and {more} more" if more > 0 else "")
