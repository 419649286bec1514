"""Pictures and films of a run as values that a notebook shows and that can be saved."""

from __future__ import annotations

import base64
import html
import inspect
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from sandbox.draw.film.stills import instants
from sandbox.draw.film.video import render, save_picture
from sandbox.errors import OutputError
from sandbox.recording.recording import Recording
from sandbox.whole_files import place, written_whole
from sandbox.wording import listed, meant, quoted

FILM_SIZE = (640, 480)
"""Of a film that nobody gave a size: a notebook's cell, and a file of some hundred kB."""


@dataclass(frozen=True, repr=False)
class _Media:
    """Bytes of a file, and what they show."""

    data: bytes
    about: str
    """In a line, for who cannot see it."""
    ENDING: ClassVar[str]
    KIND: ClassVar[str]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file.

        Raises:
            OutputError: another ending than its own, or it cannot be written.
        """
        file = place(path, "a picture")
        if file.suffix.lower() != self.ENDING:
            raise OutputError(f"{file}: this is a {self.ENDING} file; sandbox.render makes others",
                              code="bad-picture")
        with written_whole(file) as aside:
            aside.write_bytes(self.data)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.about}, {len(self.data) / 1000:.0f} kB>"

    def tag(self, *, style: str = "max-width:100%") -> str:
        """It as an element of HTML that needs no other file."""
        return (f'<img style="{style}" alt="{html.escape(self.about)}" '
                f'src="data:{self.KIND};base64,{base64.b64encode(self.data).decode()}">')

    def _repr_html_(self) -> str:
        return self.tag()


class Picture(_Media):
    """A PNG."""

    ENDING, KIND = ".png", "image/png"


class Film(_Media):
    """A GIF."""

    ENDING, KIND = ".gif", "image/gif"


def picture(
    run: Recording, at: float | str = "end", size: tuple[int, int] | None = None,
) -> Picture:
    """See :meth:`sandbox.Recording.picture`."""
    if not len(run):
        raise OutputError("nothing was recorded, so there is nothing to draw", code="bad-time")
    found = instants(run, at)
    if len(found) != 1:
        raise OutputError(f"a picture shows one moment, at={quoted(at)} are {len(found)}; "
                          "sandbox.render draws several", code="bad-picture")
    when = found[0].time
    data = _written(lambda path: save_picture(run, path, t=when, size=size), "picture.png")
    return Picture(data, f"{run.mechanism.name or 'a run'} at t = {when:.6g} s")


def film(run: Recording, options: Mapping[str, Any]) -> Film:
    """See :meth:`sandbox.Recording.film`."""
    known = [name for name in inspect.signature(render).parameters if name not in ("run", "path")]
    for name in options:
        if name not in known:
            raise OutputError(f"film() has no option {quoted(name)}.{meant(name, known)} "
                              f"Allowed: {listed(known, most=len(known))}.", code="bad-picture")
    chosen = {"size": FILM_SIZE, **options}
    data = _written(lambda path: render(run, path, **chosen), "film.gif")
    return Film(data, f"{run.mechanism.name or 'a run'} up to t = {run.time[-1]:.6g} s")


def _written(write: Any, name: str) -> bytes:
    """What a function writes to a file with this name."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, name)
        write(path)
        return path.read_bytes()
