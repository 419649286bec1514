"""``sandbox render``: pictures of a saved run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from sandbox.cli.console import Console, Progress
from sandbox.cli.runs import run_directory
from sandbox.errors import OutputError
from sandbox.picture.film import is_still
from sandbox.picture.film import render as draw
from sandbox.recording.new_run import made
from sandbox.recording.recording import Recording
from sandbox.scene.read.limits import Limits


def render(
    run: str, outs: tuple[Path, ...], ending: str | None, at: tuple[str, ...], strip: int | None,
    labels: str, fps: str | None, bodies: tuple[str, ...], limits: Limits, console: Console,
    **view: Any,
) -> None:
    """Draw a saved run as an animation or as stills."""
    if outs and ending is not None:
        raise click.UsageError("give --format or --out FILE, not both: the name of FILE already "
                               "sets the format")
    directory = run_directory(run)
    recording = Recording.load(directory)
    if strip is not None:
        name = f"strip.{ending or 'png'}"
    elif len(at) == 1:
        name = f"still_{''.join(at[0].split())}.{ending or 'png'}"
    elif at or ending in ("png", "svg", "pdf"):
        name = f"still{'' if at else '_end'}.{ending or 'png'}"
    else:
        name = f"animation.{ending or 'gif'}"
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
