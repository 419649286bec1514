"""How a RUN argument is found, and what several commands take of runs: targets, files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sandbox.cli.options import OUT, F
from sandbox.cli.output import default_directory
from sandbox.errors import OutputError
from sandbox.wording import is_pattern, listed, or_near

if TYPE_CHECKING:
    from sandbox.cli.console import Console
    from sandbox.recording.recording import Recording

RENDERS = Path("renders")
PICTURES = (".png", ".svg", ".pdf")
"""Endings of the files that figures are written into."""


def run_directory(word: str) -> Path:
    """The directory of a run: itself, or that of the scene whose name or file was given.

    Raises:
        OutputError: there is none; with a near miss.
    """
    from sandbox.recording.new_run import ARCHIVE
    from sandbox.sweeps.table import CSV as TABLE
    from sandbox.sweeps.table import SPEC as SWEEP

    path = Path(word)
    by_scene = default_directory(path.stem if path.suffix == ".json" else word)
    for candidate in (path, by_scene):
        if (candidate / ARCHIVE).is_file():
            return candidate
    for candidate in (path, by_scene):
        if (candidate / SWEEP).is_file():
            raise OutputError(
                f"{str(candidate)!r} holds a sweep, many runs, and no single run: its table is "
                f"{candidate / TABLE}; how it becomes a figure says docs/howto/figure.md",
                code="no-run")
    kept = sorted(found.parent.name for found in RENDERS.glob(f"*/{ARCHIVE}"))
    raise OutputError(f"there is no run in {word!r} nor in {str(by_scene)!r}{or_near(word, kept)}; "
                      f"'sandbox run' makes one", code="no-run")


def open_run(word: str, console: Console) -> tuple[Path, Recording]:
    """A run's directory and its recording; says so if it did not come to its end.

    Raises:
        OutputError: there is none, it cannot be read, or it holds less than two samples.
    """
    from sandbox.recording.recording import Recording
    from sandbox.recording.store import EDITED

    directory = run_directory(word)
    recording = Recording.load(directory)
    if len(recording) < 2:
        raise OutputError(f"the run in {directory} holds {len(recording)} samples, "
                          "at least 2 are needed", code="bad-time")
    if not recording.complete:
        console.warn(f"note: the run in {directory} {recording.info.status.value} at "
                     f"{recording.time[-1]:.6g} s, before its end")
    for note in recording.info.notes:
        if note.endswith(EDITED):
            console.warn(f"note: {directory / note}")
    return directory, recording


def labels(opened: Sequence[tuple[Path, Recording]]) -> list[str]:
    """What the runs are called: by their scenes; by their directories where these are equal."""
    names: tuple[Callable[[Path, Recording], str], ...] = (
        lambda _, run: run.mechanism.name, lambda path, _: path.name)
    for name in names:
        found = [name(path, run) for path, run in opened]
        if len(set(found)) == len(found) and all(found):
            return found
    return [str(path) for path, _ in opened]


def read_targets(
    ctx: click.Context, param: click.Parameter, words: tuple[str, ...],
) -> dict[str, str]:
    """``quantity=value`` words as a table; values are read when their units are known."""
    found = {}
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name.strip() or not text.strip():
            raise click.BadParameter(f"{word!r} is not of the form QUANTITY=VALUE, as in "
                                     "finger.mcp.angle=5deg", ctx, param)
        found[name.strip()] = text.strip()
    return found


target_option = click.option(
    "--target", "targets", multiple=True, metavar="QUANTITY=VALUE", callback=read_targets,
    help="What a quantity should be, as in 'finger.mcp.angle=5deg', in place of what a "
         "controller leads it to. May be given several times.")


def target_values(texts: dict[str, str], runs: Sequence[Recording]) -> dict[str, float]:
    """Targets in SI, read in the unit of their quantity.

    Raises:
        BadParameter: a quantity that no run has, with a near miss; a value that cannot be read.
    """
    from sandbox.scene.values.units import UNITS, normal_unit, parse_quantity

    found = {}
    for name, text in texts.items():
        run = run_with(name, runs, option="--target")
        _, dimension = UNITS.get(normal_unit(run.unit(name)), (1.0, None))
        try:
            found[name] = parse_quantity(text, dimension)
        except ValueError as error:
            raise click.BadParameter(f"{name}: {error}", param_hint="--target") from None
    return found


def run_with(name: str, runs: Sequence[Recording], *, option: str) -> Recording:
    """The first run that has a quantity.

    Raises:
        BadParameter: none has; with a near miss, and what there is.
    """
    for run in runs:
        if name in run.catalogue:
            return run
    if is_pattern(name) and (fits := [found for run in runs for found in run.match(name)]):
        raise click.BadParameter(f"{name!r} is a pattern, and one quantity is wanted: "
                                 f"{listed(dict.fromkeys(fits))}", param_hint=option)
    close = next((found for run in runs if (found := run.catalogue.near(name))), "")
    hint = f" Did you mean {close!r}?" if close else ""
    there = next((found for run in runs if (found := run.catalogue.allowed(name))), "")
    allowed = f" Allowed: {there}." if there else ""
    raise click.BadParameter(f"no quantity is named {name!r}.{hint}{allowed}", param_hint=option)


def matching(pattern: str, runs: Sequence[Recording], *, option: str) -> list[str]:
    """The quantities that fit a pattern in any of the runs, in the first one's order.

    Raises:
        BadParameter: nothing fits; with a near miss.
    """
    names = list(dict.fromkeys(name for run in runs for name in run.match(pattern)))
    if not names:
        run_with(pattern, runs, option=option)
    return names


def file_option(suffixes: Sequence[str], help_text: str) -> Callable[[F], F]:
    """An option ``--out FILE`` that may be given several times, with endings that are known."""
    def read(
        ctx: click.Context, param: click.Parameter, paths: tuple[Path, ...],
    ) -> tuple[Path, ...]:
        for path in paths:
            if path.suffix.lower() not in suffixes:
                raise click.BadParameter(f"{str(path)!r} does not end in one of "
                                         f"{', '.join(suffixes)}", ctx, param)
        return paths

    return click.option("--out", "files", multiple=True, type=OUT,
                        metavar="FILE", callback=read, help=help_text)
