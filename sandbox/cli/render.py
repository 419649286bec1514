"""``sandbox render``: a saved run drawn again, in another size, speed or view."""

from __future__ import annotations

from pathlib import Path

import click

from sandbox.cli.console import Console
from sandbox.cli.options import OUT, chosen_limits, read_point, read_size, show_option
from sandbox.cli.progress import Progress


@click.command()
@click.argument("directory", metavar="RUN_DIR", type=click.Path(path_type=Path, file_okay=False))
@click.option("--out", type=OUT, metavar="FILE",
              help="A .gif or .mp4 file, or a directory for PNG frames; "
                   "RUN_DIR/animation.gif by default.")
@click.option("--size", callback=read_size, metavar="WxH", help="Of the picture in pixels.")
@click.option("--fps", type=click.Choice(["20", "25", "50"]), help="Frames per second.")
@click.option("--speed", type=click.FloatRange(min=0, min_open=True), metavar="FACTOR",
              help="Seconds of motion per second of film.")
@click.option("--centre", callback=read_point, metavar="X,Y", help="Of the view in metres.")
@click.option("--width", type=click.FloatRange(min=0, min_open=True), metavar="METRES",
              help="Of the view.")
@show_option
@click.option("--follow", metavar="BODY", help="Body that the picture goes with.")
@click.option("--fit", "bodies", multiple=True, metavar="BODY",
              help="Name or pattern of bodies that the picture is fitted to, as in 'finger*'. May "
                   "be given several times.")
@click.option("--max-frames", type=click.IntRange(min=1), metavar="N",
              help="Allow so many frames of a film.")
@click.option("--quiet", "-q", is_flag=True, help="Print errors only.")
def render(
    directory: Path, out: Path | None, size: tuple[int, int] | None, fps: str | None,
    speed: float | None, centre: tuple[float, float] | None, width: float | None,
    show: str | None, follow: str | None, bodies: tuple[str, ...], max_frames: int | None,
    quiet: bool,
) -> None:
    """Draw the run saved in RUN_DIR again.

    Nothing is simulated.
    """
    from sandbox.draw import render as draw
    from sandbox.recording.new_run import made
    from sandbox.recording.recording import Recording

    console = Console(quiet=quiet)
    recording = Recording.load(directory)
    path = out or directory / "animation.gif"
    with Progress("draw", shown=console.shows_progress) as progress:
        draw(recording, path, size=size, fps=None if fps is None else int(fps), speed=speed,
             centre=centre, width=width, show=show, follow=follow, bodies=bodies or None,
             progress=progress,
             most_frames=chosen_limits({"frames": max_frames}).frames)
    made(path)
    console.say(str(path))
