"""``sandbox report``: the page of saved runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import click

from sandbox.atomic_files import write_atomic
from sandbox.cli.console import Console
from sandbox.cli.runs import matching, open_run
from sandbox.errors import OutputError
from sandbox.recording.new_run import PAGE, made
from sandbox.recording.recording import Recording
from sandbox.recording.store import saved_audit
from sandbox.web.page import MAX_RUNS, FoundOut
from sandbox.web.page import report as page_of_runs


def report(
    runs: tuple[str, ...], out: Path | None, plots: tuple[str, ...], console: Console,
) -> int:
    """Write one page that plays up to four runs."""
    if len(runs) > MAX_RUNS:
        raise click.UsageError(f"a page shows up to {MAX_RUNS} runs, {len(runs)} were given")
    directories, recordings = zip(*(open_run(word, console) for word in runs), strict=True)
    for k, directory in enumerate(directories):
        if directory.resolve() in [each.resolve() for each in directories[:k]]:
            raise click.UsageError(f"the run in {str(directory)!r} is given twice")
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
    text = page_of_runs(recordings, found, plots)
    if not path.parent.is_dir():
        raise OutputError(f"there is no directory {path.parent}")
    write_atomic(path, text)
    made(path)
    return len(text.encode())
