"""``sandbox plot``: chosen quantities of saved runs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.options import read_length, read_time
from sandbox.cli.runs import (
    PICTURES,
    file_option,
    labels,
    matching,
    open_run,
    run_with,
    target_option,
    target_values,
)

if TYPE_CHECKING:
    from sandbox.recording.recording import Recording
    from sandbox.samples.response import Response


@click.command()
@click.argument("run")
@click.argument("quantities", nargs=-1, metavar="[QUANTITY]...")
@click.option("--figure", hidden=True)
@click.option("--with", "others", multiple=True, metavar="RUN",
              help="Another run in the same picture, in a colour of its own. May be given several "
                   "times.")
@click.option("--x", "across", metavar="QUANTITY", default="",
              help="What quantities are drawn against, in place of time.")
@click.option("--from", "begin", metavar="TIME", callback=read_time,
              help="Leave out what was before, as in '0.5s' or '200 ms'.")
@click.option("--to", "end", metavar="TIME", callback=read_time, help="Leave out what came after.")
@click.option("--width", metavar="LENGTH", callback=read_length,
              help="Of the figure on paper, as in '85mm'; 120 mm by default.")
@click.option("--no-title", "untitled", is_flag=True, help="Without the scene's title.")
@target_option
@file_option(PICTURES, "A .png, .svg or .pdf file; plot.png in the run's directory by "
             "default. May be given several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def plot(
    run: str, quantities: tuple[str, ...], figure: str | None, others: tuple[str, ...],
    across: str, begin: float | None, end: float | None, width: float | None, untitled: bool,
    targets: dict[str, str], files: tuple[Path, ...], as_json: bool, quiet: bool,
) -> int:
    """Plot quantities of a saved run.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. A QUANTITY is a name such as finger.mcp.angle, or a pattern such
    as 'finger.*.angle'; without any, those that the run has are listed. Nothing
    is simulated.
    """
    console = Console(as_json=as_json, quiet=quiet)
    if figure is not None:
        raise click.UsageError("figures by name are scripts now: python docs/studies/"
                               "finger_control.py; or name quantities: 'sandbox plot RUN "
                               "finger.tendon.shortening finger.mcp.angle'")
    wish = _Wish(others, across, begin, end, width, untitled)
    if wish and not quantities:
        raise click.UsageError("name the quantities to draw; 'sandbox plot RUN' lists them")
    directory, recording = open_run(run, console)
    if not quantities:
        return _list_quantities(console, recording, run)
    opened = [(directory, recording), *(open_run(word, console) for word in others)]
    recordings = [each for _, each in opened]
    given = target_values(targets, recordings)
    drawing, found, idle = _drawn(opened, quantities, given, wish)
    files = files or (directory / "plot.png",)
    _save(drawing, files)
    if as_json:
        console.result_json({
            "status": "done", "exit_code": int(Exit.DONE), "run": str(directory),
            "files": [str(file) for file in files],
            "left_out": idle,
            "responses": {name: response_data(answer) for name, answer in found.items()}})
        return Exit.DONE
    for name, answer in found.items():
        console.say(f"{name}: {_verdict(answer, recording.unit(name))}")
    if idle:
        console.say(f"left out, 0 in all runs: {', '.join(idle)}")
    console.say(*map(str, files))
    return Exit.DONE


@dataclass(frozen=True)
class _Wish:
    """How quantities are to be drawn."""

    others: tuple[str, ...]
    """Runs besides the first."""
    across: str
    """Against what; empty for time."""
    begin: float | None
    end: float | None
    """[s]"""
    width: float | None
    """[m]"""
    untitled: bool

    @property
    def whole(self) -> bool:
        """Whether it is all of one run over time that is drawn."""
        return not (self.others or self.across) and self.begin is None and self.end is None

    def __bool__(self) -> bool:
        """Whether anything is asked for that concerns quantities only."""
        return not self.whole or self.width is not None or self.untitled


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


def _list_quantities(console: Console, recording: Recording, word: str) -> int:
    """Say what the run can be asked for, and by which commands."""
    from sandbox.cli.quantities import quantity_data, quantity_lines

    if console.as_json:
        console.result_json({"quantities": quantity_data(recording)})
    else:
        console.result(*quantity_lines(recording, word))
    return Exit.DONE


def _drawn(
    opened: Sequence[tuple[Path, Recording]], quantities: tuple[str, ...],
    given: dict[str, float], wish: _Wish,
) -> tuple[Any, dict[str, Response], list[str]]:
    """The figure, how quantities with a target answer, and what was left out of it."""
    recordings = [each for _, each in opened]
    from sandbox.draw.figure.signals import Plotted, Window, draw
    from sandbox.samples.targets import responses, targets

    names = list(dict.fromkeys(name for pattern in quantities
                               for name in matching(pattern, recordings, option="QUANTITY")))
    idle = _idle(names, quantities, recordings) if wish.others else []
    names = [name for name in names if name not in idle]
    if wish.across:
        run_with(wish.across, recordings, option="--x")
    runs = [Plotted(label, each, {name: goal for name, goal in targets(each, given).items()
                                  if name in names})
            for label, each in zip(labels(opened), recordings, strict=True)]
    window = Window(wish.begin or 0.0, math.inf if wish.end is None else wish.end)
    drawing = draw(runs, names, x=wish.across, window=window, width=wish.width,
                   titled=not wish.untitled)
    # settling is counted over a whole run, and of several 'sandbox compare' tells it
    told = responses(recordings[0], runs[0].targets) if wish.whole else {}
    return drawing, told, idle


def _idle(
    names: Sequence[str], quantities: Sequence[str], recordings: Sequence[Recording],
) -> list[str]:
    """What patterns found that is 0 in all runs and would get a panel of its own; never all."""
    import numpy as np

    from sandbox.show.packing import NOTHING

    having = {name: [run for run in recordings if name in run] for name in names}
    sizes = {name: max(float(np.nanmax(np.abs(run[name]), initial=0.0)) for run in runs)
             for name, runs in having.items()}
    units = {name: runs[0].unit(name) for name, runs in having.items()}
    found = [name for name in names if name not in quantities and sizes[name] <= NOTHING * max(
        size for other, size in sizes.items() if units[other] == units[name])]
    return found if len(found) < len(names) else []


def _save(drawing: Any, files: tuple[Path, ...]) -> None:
    from sandbox.draw.figure.style import save_figure
    from sandbox.recording.new_run import made

    for file in files:
        save_figure(drawing, file)
        made(file)
