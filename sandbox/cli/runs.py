"""Saved runs: how RUN arguments and names of quantities are found."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sandbox.cli.console import Console
from sandbox.cli.options import RENDERS, safe_name, written
from sandbox.errors import OutputError
from sandbox.recording.new_run import ARCHIVE, FILES, FILMS, FRAMES, PAGE
from sandbox.recording.recording import Recording
from sandbox.recording.store import EDITED
from sandbox.sweeps import CSV, SPEC
from sandbox.wording import is_pattern, listed, or_near


def files_of(directory: Path) -> list[str]:
    """The files of a run that exist, ``run.json`` first."""
    names = written(directory, (*FILES, *FILMS, PAGE))
    return [*names, f"{FRAMES}/"] if (directory / FRAMES).is_dir() else names


def run_directory(word: str) -> Path:
    """The directory of a run, given as such or as the name or file of its scene."""
    path = Path(word)
    by_scene = RENDERS / safe_name(path.stem if path.suffix == ".json" else word)
    for candidate in (path, by_scene):
        if (candidate / ARCHIVE).is_file():
            return candidate
    for candidate in (path, by_scene):
        if (candidate / SPEC).is_file():
            raise OutputError(
                f"{str(candidate)!r} is a sweep, not a single run: its table is "
                f"{candidate / CSV}; docs/howto/figure.md plots one", code="no-run")
    kept = sorted(found.parent.name for found in RENDERS.glob(f"*/{ARCHIVE}"))
    raise OutputError(f"there is no run in {word!r} nor in {str(by_scene)!r}{or_near(word, kept)}; "
                      f"'sandbox run' makes one", code="no-run")


def open_run(word: str, console: Console) -> tuple[Path, Recording]:
    """A run's directory and its recording; warns if the run is incomplete or was edited."""
    directory = run_directory(word)
    recording = Recording.load(directory)
    if len(recording) < 2:
        raise OutputError(f"the run in {directory} holds {len(recording)} samples, "
                          "at least 2 are needed", code="bad-time")
    if not recording.complete:
        console.warn(f"note: the run in {directory} {recording.info.status.value} at "
                     f"{recording.time[-1]:.6g} s, before its end")
    console.warn(*(f"note: {directory / note}" for note in recording.info.notes
                   if note.endswith(EDITED)))
    return directory, recording


def run_with(name: str, runs: Sequence[Recording], *, option: str) -> Recording:
    """The first run that has a quantity."""
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


def matching(patterns: Sequence[str], runs: Sequence[Recording], *, option: str) -> list[str]:
    """The quantities that match any of some patterns in any of the runs, each once.

    A pattern leaves out pairs of bodies that never touched, unless none did.
    """
    found: dict[str, None] = {}
    for pattern in patterns:
        names = dict.fromkeys(name for run in runs for name in run.match(pattern))
        if not names:
            run_with(pattern, runs, option=option)
        if is_pattern(pattern) and "/" in pattern:
            names = {name: None for name in names if any(
                name in run.catalogue and run[name].any() for run in runs)} or names
        found |= names
    return list(found)
