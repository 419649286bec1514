"""Saved runs: how they and their quantities are found, ``sandbox render``, ``sandbox report``."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console, Progress
from sandbox.cli.options import RENDERS, safe_name, written
from sandbox.errors import OutputError
from sandbox.recording.new_run import ARCHIVE, FILES, FILMS, FRAMES, PAGE, made
from sandbox.recording.recording import Recording
from sandbox.recording.store import EDITED, saved_audit
from sandbox.scene.read.limits import Limits
from sandbox.sweeps import CSV, SPEC
from sandbox.wording import is_pattern, listed, or_near

if TYPE_CHECKING:
    from sandbox.web.page import FoundOut


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
    close, there = (next(filter(None, found), "") for found in (
        (run.catalogue.near(name) for run in runs), (run.catalogue.allowed(name) for run in runs)))
    hint = f" Did you mean {close!r}?" if close else ""
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


def render(
    run: str, outs: tuple[Path, ...], ending: str | None, at: tuple[str, ...], strip: int | None,
    labels: str, fps: str | None, bodies: tuple[str, ...], limits: Limits, console: Console,
    **view: Any,
) -> None:
    """Draw a saved run as an animation or as stills."""
    from sandbox.picture.film import is_still
    from sandbox.picture.film import render as draw
    if outs and ending is not None:
        raise click.UsageError("give --format or --out FILE, not both: the name of FILE already "
                               "sets the format")
    directory = run_directory(run)
    recording = Recording.load(directory)
    if strip is None and not at and ending not in ("png", "svg", "pdf"):
        name = f"animation.{ending or 'gif'}"
    else:
        of = f"_{''.join(at[0].split())}" if len(at) == 1 else "" if at else "_end"
        name = f"{f'still{of}' if strip is None else 'strip'}.{ending or 'png'}"
    paths, wrong = outs or (directory / name,), []
    for path in paths:  # all are checked before the first is drawn
        try:
            is_still(path, at=bool(at), strip=strip is not None, size=view["size"],
                     transparent=view["transparent"])
        except OutputError as error:
            wrong.append(str(error))
    if wrong:
        raise OutputError("\n".join(wrong), code="bad-picture")
    for path in paths:
        with Progress("Drawing", console) as progress:
            files = draw(recording, path, at=at or None,
                         strip=False if strip is None else strip or True, bare=labels == "none",
                         scales=labels == "scales", fps=None if fps is None else int(fps),
                         bodies=bodies or None, progress=progress, most_frames=limits.frames,
                         **view)
        for file in files:
            made(file)
            console.say(file)


def report(
    runs: tuple[str, ...], out: Path | None, plots: tuple[str, ...], console: Console,
) -> int:
    """Write one page that plays up to four runs."""
    from sandbox.web.page import FoundOut
    directories, recordings = zip(*(open_run(word, console) for word in runs), strict=True)
    path = out or directories[0]
    path = path / PAGE if path.is_dir() else path
    if path.suffix.lower() not in (".html", ".htm"):
        raise click.BadParameter(f"{str(path)!r} does not end in .html", param_hint="--out")
    size = write_page(recordings, path, [
        FoundOut(figures=saved_audit(directory), source=str(directory))
        for directory in directories],
        matching(plots, recordings, option="--plot"))
    return console.finish({"file": path, "bytes": size, "runs": directories},
                          [f"{path}  ({size / 1e6:.1f} MB)"])


def write_page(
    recordings: Sequence[Recording], path: Path, found: Sequence[FoundOut],
    plots: Sequence[str] = (),
) -> int:
    """Write the page of some runs; its size in bytes."""
    from sandbox.web.page import report as page_of_runs
    text = page_of_runs(recordings, found, plots)
    write_atomic(path, text)
    made(path)
    return len(text.encode())
