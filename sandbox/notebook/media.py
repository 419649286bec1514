"""Pictures, films and plots of a run, which a notebook shows."""

from __future__ import annotations

import base64
import html
import inspect
import math
import os
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

from sandbox.atomic_files import atomic_file, output_path
from sandbox.errors import OutputError
from sandbox.figure import signals
from sandbox.picture.film import render
from sandbox.picture.stills import instants, save_picture
from sandbox.recording.recording import Recording
from sandbox.samples.samples import TIME
from sandbox.samples.targets import targets
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, listed, meant, quoted

FILM_SIZE = (640, 480)
"""Default size of a film [pixels]: fits a cell of a notebook, some 100 kB."""
FORMS = {"time": "seconds, or a time such as '0.8 s'",
         "length": "metres, or a length such as '85 mm'"}
"""Accepted values by dimension."""


@dataclass(frozen=True, repr=False)
class Media:
    """The bytes of a picture or a film."""

    data: bytes
    about: str
    """Alternative text."""
    ENDING: ClassVar[str]
    KIND: ClassVar[str]

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write it to a file.

        Raises:
            OutputError: another ending than its own, or it cannot be written.
        """
        file = output_path(path, "a picture")
        if file.suffix.lower() != self.ENDING:
            raise OutputError(f"{file}: this is a {self.ENDING} file; sandbox.render makes others",
                              code="bad-picture")
        with atomic_file(file) as aside:
            aside.write_bytes(self.data)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {self.about}, {len(self.data) / 1000:.0f} kB>"

    def tag(self, *, style: str = "max-width:100%") -> str:
        """An HTML element that needs no other file."""
        return (f'<img style="{style}" alt="{html.escape(self.about)}" '
                f'src="data:{self.KIND};base64,{base64.b64encode(self.data).decode()}">')

    def _repr_html_(self) -> str:
        return self.tag()


class Picture(Media):
    """A PNG."""

    ENDING, KIND = ".png", "image/png"


class Film(Media):
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
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "picture.png")
        save_picture(run, path, t=when, size=size)
        return Picture(path.read_bytes(), f"{run.mechanism.name or 'a run'} at t = {when:.6g} s")


def film(run: Recording, options: Mapping[str, Any]) -> Film:
    """See :meth:`sandbox.Recording.film`."""
    known = [name for name in inspect.signature(render).parameters if name not in ("run", "path")]
    for name in options:
        if name not in known:
            raise OutputError(f"film() has no option {quoted(name)}.{meant(name, known)} "
                              f"Allowed: {listed(known, most=len(known))}.", code="bad-picture")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.gif")
        render(run, path, **{"size": FILM_SIZE, **options})
        return Film(path.read_bytes(),
                    f"{run.mechanism.name or 'a run'} up to t = {run.time[-1]:.6g} s")


def plot(
    run: Recording, quantities: tuple[str, ...], x: str = "", begin: float | str = 0.0,
    end: float | str = math.inf, width: float | str | None = None, title: bool = True,
) -> Any:
    """See :meth:`sandbox.Recording.plot`."""
    if not quantities:
        some = next(iter(run.names()), "finger.mcp.angle")
        raise OutputError(f"plot() needs quantities, such as {some!r} or '*.angle'; run.names() "
                          "lists them", code="bad-picture")
    names = list(dict.fromkeys(name for each in quantities for name in run.names(each)))
    label = run.mechanism.title or run.mechanism.name
    if x and x != TIME:
        run.catalogue.find(x)
    return signals.draw([signals.Plotted(label, run, targets(run))], names,
                        x="" if x == TIME else x, window=signals.Window(
                            _number("begin", begin, "time"), _number("end", end, "time")),
                        width=None if width is None else _number("width", width, "length"),
                        titled=title)


def _number(name: str, value: float | str, dimension: str) -> float:
    """A number in SI."""
    if isinstance(value, float | int):
        return float(value)
    try:
        return number_from(value, dimension, {})
    except ValueError as error:
        said = error.message if isinstance(error, WrongValueError) else str(error)
        raise OutputError(f"{name}={quoted(value)}: {said}; pass {FORMS[dimension]}",
                          code="bad-picture") from None
