"""``sandbox plot``: figures of a saved run, by name or of chosen quantities."""

from __future__ import annotations

import dataclasses
import difflib
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console, table
from sandbox.cli.exits import Exit
from sandbox.cli.runs import (
    PICTURES,
    file_option,
    matching,
    open_run,
    target_option,
    target_values,
)

if TYPE_CHECKING:
    from sandbox.paper.figures import FigureKind
    from sandbox.recording.recording import Recording
    from sandbox.samples.response import Response


@click.command()
@click.argument("run")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--figure", metavar="NAME", help="A figure by name; '?' tells the names.")
@target_option
@file_option(PICTURES, "A .png, .svg or .pdf file; NAME.png (plot.png) in the run's directory by "
             "default. May be given several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def plot(
    run: str, quantities: tuple[str, ...], figure: str | None, targets: dict[str, str],
    files: tuple[Path, ...], as_json: bool, quiet: bool,
) -> int:
    """Plot a saved run: a figure by name, or any quantities against time.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. A QUANTITY is a name such as finger.mcp.angle, or a pattern such
    as 'finger.*.angle'. Nothing is simulated.
    """
    console = Console(as_json=as_json, quiet=quiet)
    if figure == "?":
        return _list_figures(console)
    kind = _chosen(figure, quantities)
    directory, recording = open_run(run, console)
    given = target_values(targets, [recording])
    drawing, found = _drawn(recording, kind, quantities, given)
    files = files or (directory / f"{kind.name if kind else 'plot'}.png",)
    _save(drawing, files)
    if as_json:
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "run": str(directory),
            "figure": kind.name if kind else None, "files": [str(file) for file in files],
            "responses": {name: response_data(answer) for name, answer in found.items()}})
        return Exit.DONE
    for name, answer in found.items():
        console.say(f"{name}: {_verdict(answer, recording.unit(name))}")
    console.say(*map(str, files))
    return Exit.DONE


def _verdict(answer: Response, unit: str) -> str:
    import numpy as np

    from sandbox.draw.figure.style import number, seconds, shown_as

    if answer.settles:
        return f"settled at {seconds(answer.settling)}"
    shown = shown_as(unit, np.array([answer.target]))
    return (f"does not settle: {number(shown.factor * answer.final)}{shown.sign} at the end, "
            f"target {number(shown.factor * answer.target)}{shown.sign}")


def response_data(answer: Response) -> dict[str, float | None]:
    """A response as JSON data, SI; what has no value or is infinite is null."""
    return {key: value if math.isfinite(value) else None
            for key, value in dataclasses.asdict(answer).items()}


def _chosen(figure: str | None, quantities: tuple[str, ...]) -> FigureKind | None:
    """The figure that is asked for; None for quantities.

    Raises:
        BadParameter: no figure of that name; with a near miss.
        UsageError: both, or neither.
    """
    from sandbox.paper.figures import FIGURES

    if figure is None:
        if not quantities:
            named = ", ".join(f"--figure {name}" for name in FIGURES)
            raise click.UsageError("name quantities, such as 'finger.*.angle', or a figure: "
                                   f"{named}")
        return None
    if quantities:
        raise click.UsageError("give either quantities or --figure")
    if figure not in FIGURES:
        near = difflib.get_close_matches(figure, FIGURES, n=1)
        hint = f" Did you mean {near[0]!r}?" if near else ""
        raise click.BadParameter(f"no figure is named {figure!r}.{hint} Figures: "
                                 f"{', '.join(FIGURES)}.",
                                 param_hint="--figure")
    return FIGURES[figure]


def _list_figures(console: Console) -> int:
    from sandbox.paper.figures import FIGURES

    if console.as_json:
        console.result_json({"figures": [{"name": kind.name, "about": kind.about}
                                         for kind in FIGURES.values()]})
    else:
        console.result(*table(["figure", ""], [[kind.name, kind.about]
                                               for kind in FIGURES.values()]))
    return Exit.DONE


def _drawn(
    recording: Recording, kind: FigureKind | None, quantities: tuple[str, ...],
    given: dict[str, float],
) -> tuple[Any, dict[str, Response]]:
    if kind is not None:
        return kind.draw(recording, given)
    from sandbox.draw.figure import signals
    from sandbox.samples.targets import responses, targets

    names = list(dict.fromkeys(name for pattern in quantities
                               for name in matching(pattern, [recording], option="QUANTITY")))
    goals = {name: goal for name, goal in targets(recording, given).items() if name in names}
    return signals.draw(recording, names, goals), responses(recording, goals)


def _save(drawing: Any, files: tuple[Path, ...]) -> None:
    from sandbox.draw.figure.style import save_figure
    from sandbox.recording.new_run import made

    for file in files:
        save_figure(drawing, file)
        made(file)
