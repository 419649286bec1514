"""``sandbox render``: a saved run drawn again, as a film or as stills, in another size or view."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sandbox.cli.console import Console
from sandbox.cli.options import (
    OUT,
    UNCOUNTED,
    chosen_limits,
    meter_option,
    read_count,
    read_point,
    read_size,
    show_option,
)
from sandbox.cli.progress import Progress
from sandbox.cli.runs import run_directory
from sandbox.errors import OutputError

FILM = "animation"
"""What a film is called in the directory of its run; stills are ``still_…`` and ``strip``."""


@click.command()
@click.argument("run", metavar="RUN")
@click.option("--out", "outs", type=OUT, multiple=True, metavar="FILE",
              help="A .gif or .mp4 film, a .png, .svg or .pdf still, or a directory for PNG "
                   "frames; RUN/animation.gif by default. May be given several times.")
@click.option("--format", "ending", type=click.Choice(["gif", "mp4", "png", "svg", "pdf"]),
              help="Of what is written into RUN where no --out is given.")
@click.option("--at", multiple=True, metavar="TIME",
              help="Draw a still of this moment: '0.8s', 'start' or 'end'. May be given several "
                   "times.")
@click.option("--strip", is_flag=False, flag_value=UNCOUNTED, callback=read_count, metavar="[N]",
              help="Draw N moments side by side in one picture, from the start of the film to its "
                   "end, 5 without N; or those that --at names.")
@click.option("--transparent", is_flag=True,
              help="See-through where nothing is drawn; of stills, PNG frames and a GIF.")
@click.option("--bare", is_flag=True, help="Without title, time and legend.")
@click.option("--scales", is_flag=True,
              help="Without them too, but with the scales of lengths, arrows and tensions.")
@click.option("--size", callback=read_size, metavar="WxH",
              help="Of the picture in pixels, of a strip as a whole; '2x' for twice that of "
                   "the scene's view, or twice a strip's own; of a still on paper '85mm' or "
                   "'85mmx70mm', with letters of at least 7 points.")
@click.option("--fps", type=click.Choice(["20", "25", "50"]), help="Frames per second.")
@click.option("--speed", type=click.FloatRange(min=0, min_open=True), metavar="FACTOR",
              help="Seconds of motion per second of film.")
@click.option("--centre", callback=read_point, metavar="X,Y", help="Of the view in metres.")
@click.option("--width", type=click.FloatRange(min=0, min_open=True), metavar="METRES",
              help="Of the view.")
@show_option
@meter_option
@click.option("--follow", metavar="BODY", help="Body that the picture goes with.")
@click.option("--fit", "bodies", multiple=True, metavar="BODY",
              help="Name or pattern of bodies or groups that the picture is fitted to, as in "
                   "'finger*'. May be given several times.")
@click.option("--max-frames", type=click.IntRange(min=1), metavar="N",
              help="Allow so many frames of a film.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def render(
    run: str, outs: tuple[Path, ...], ending: str | None, at: tuple[str, ...],
    strip: bool | int, fps: str | None, bodies: tuple[str, ...], meters: tuple[str, ...],
    max_frames: int | None, quiet: bool, **view: Any,
) -> None:
    """Draw a saved RUN again, as a film or as stills.

    RUN is the directory of a run, or the name of its scene. Nothing is simulated.
    """
    from sandbox.draw.film.video import render as draw
    from sandbox.recording.new_run import made
    from sandbox.recording.recording import Recording

    if outs and ending is not None:
        raise click.UsageError("--format says what is written into RUN; with --out the ending "
                               "of its file does: give one of the two")
    console = Console(quiet=quiet)
    directory = run_directory(run)
    recording = Recording.load(directory)
    paths = outs or (directory / _name(ending, at, strip),)
    _see_endings(paths, at=bool(at), strip=strip is not False, size=view["size"],
                 transparent=view["transparent"])
    for path in paths:
        with Progress("draw", shown=console.shows_progress) as progress:
            files = draw(recording, path, at=at or None,
                         strip=strip, fps=None if fps is None else int(fps), bodies=bodies or None,
                         meters=meters or None, progress=progress,
                         most_frames=chosen_limits({"frames": max_frames}).frames, **view)
        for file in files:
            made(file)
            console.say(str(file))


def _see_endings(paths: tuple[Path, ...], **asked: Any) -> None:
    """See that all files can be what is asked for, before the first is drawn.

    Raises:
        OutputError: those that cannot, a line each.
    """
    from sandbox.draw.film.video import is_still

    wrong = []
    for path in paths:
        try:
            is_still(path, **asked)
        except OutputError as error:
            wrong.append(str(error))
    if wrong:
        raise OutputError("\n".join(wrong), code="bad-picture")


def _name(ending: str | None, at: tuple[str, ...], strip: bool | int) -> str:
    """What is written into the directory of a run, unless it is said where to."""
    if strip is not False:
        return f"strip.{ending or 'png'}"
    if len(at) == 1:
        return f"still_{''.join(at[0].split())}.{ending or 'png'}"
    if at or ending in ("png", "svg", "pdf"):
        return f"still{'' if at else '_end'}.{ending or 'png'}"
    return f"{FILM}.{ending or 'gif'}"
