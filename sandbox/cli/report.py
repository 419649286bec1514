"""``sandbox report``: saved runs as one page for a browser."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from sandbox.cli.console import Console
from sandbox.cli.exits import Exit
from sandbox.cli.options import OUT
from sandbox.cli.runs import matching, open_run
from sandbox.errors import OutputError

if TYPE_CHECKING:
    from sandbox.audit.figures import Figure
    from sandbox.recording.recording import Recording
    from sandbox.samples.expectations import Verdict


@click.command()
@click.argument("runs", nargs=-1, required=True, metavar="RUN...")
@click.option("--out", type=OUT, metavar="FILE",
              help="The page; report.html in the first run's directory by default.")
@click.option("--plot", "plots", multiple=True, metavar="QUANTITY",
              help="A quantity or pattern that is plotted at once, such as 'finger.*.angle'; by "
                   "default meters of the view, then what the scene expects. May be given "
                   "several times.")
@click.option("--json", "as_json", is_flag=True, help="Print one JSON object and nothing else.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def report(
    runs: tuple[str, ...], out: Path | None, plots: tuple[str, ...], as_json: bool, quiet: bool,
) -> int:
    """Write one page that plays up to four runs, with plots and tables.

    RUN is the directory of a run, or the name of a scene whose run lies in
    renders/. The page is a single HTML file that works offline: send it, or
    open it in any browser. Nothing is simulated.
    """
    from sandbox.recording.store import saved_audit, saved_parameters
    from sandbox.show.page import MOST_RUNS

    console = Console(as_json=as_json, quiet=quiet)
    if len(runs) > MOST_RUNS:
        raise click.UsageError(f"a page shows up to {MOST_RUNS} runs, {len(runs)} were given")
    opened = [open_run(word, console) for word in runs]
    _refuse_twice([directory for directory, _ in opened])
    recordings = [recording for _, recording in opened]
    names = list(dict.fromkeys(name for pattern in plots
                               for name in matching(pattern, recordings, option="--plot")))
    path = _file(out, opened[0][0])
    size = write_page(recordings, path, sources=[str(directory) for directory, _ in opened],
                      plots=names, figures=[saved_audit(directory) for directory, _ in opened],
                      parameters=[saved_parameters(directory) for directory, _ in opened])
    if as_json:
        console.result_json({"status": "done", "exit_code": int(Exit.DONE), "file": str(path),
                             "bytes": size, "runs": [str(directory) for directory, _ in opened]})
    else:
        console.say(f"{path}  ({size / 1e6:.1f} MB)")
    return Exit.DONE


def _refuse_twice(directories: Sequence[Path]) -> None:
    """Refuse a run that was given more than once, under whatever name."""
    seen: dict[Path, Path] = {}
    for directory in directories:
        if (first := seen.setdefault(directory.resolve(), directory)) is not directory:
            also = "" if first == directory else f", as {str(first)!r} too"
            raise click.UsageError(f"the run in {str(directory)!r} is given twice{also}")


def _file(out: Path | None, directory: Path) -> Path:
    """Where the page goes; into a directory under its usual name."""
    from sandbox.recording.new_run import PAGE

    if out is None:
        return directory / PAGE
    if out.is_dir():
        return out / PAGE
    if out.suffix.lower() not in (".html", ".htm"):
        raise click.BadParameter(f"{str(out)!r} does not end in .html", param_hint="--out")
    return out


def write_page(
    recordings: Sequence[Recording], path: Path, *, sources: Sequence[str],
    plots: Sequence[str] = (), figures: Sequence[Sequence[Figure]],
    judged: Sequence[Sequence[Verdict]] = (), parameters: Sequence[Mapping[str, float]] = (),
) -> int:
    """Write the page of some runs; its bytes.

    ``judged`` are their verdicts where they are known, ``parameters`` those of their scenes, SI.

    Raises:
        OutputError: it cannot be written.
    """
    from sandbox.atomic_files import write_atomic
    from sandbox.recording.new_run import made
    from sandbox.show.header import FoundOut
    from sandbox.show.page import report as page_of_runs

    found = judged or [() for _ in recordings]
    told = [FoundOut(verdicts=v, figures=f, source=source, parameters=p)
            for v, f, source, p in zip(found, figures, sources,
                                       parameters or [{} for _ in found], strict=True)]
    text = page_of_runs(recordings, told, plots)
    if not path.parent.is_dir():
        raise OutputError(f"there is no directory {path.parent}")
    write_atomic(path, text)
    made(path)
    return len(text.encode())
