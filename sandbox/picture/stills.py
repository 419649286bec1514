"""Stills: single moments of a run, or a strip of them, as PNG, SVG or PDF."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import output_path
from sandbox.errors import OutputError
from sandbox.picture.frame import TYPE, Picture
from sandbox.picture.options import PrintSize, check_run, paper_of, view_of
from sandbox.picture.paper import Paper, paint_picture, save
from sandbox.picture.run_data import MeteredRun
from sandbox.picture.strip import strip_of
from sandbox.scene.settings import View
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, near, quoted

ENDINGS = (".png", ".svg", ".pdf")
WHAT = "a picture"
ENDS = ("start", "end")
"""Words for times."""
ROOM = 3
"""Height in widths that no still on paper needs: what it needs is found in it."""
KEYS, MOST = 5, 24
"""Pictures of a strip, unless it is said how many; at most."""
Instants = float | str | Sequence[float | str]


@dataclass(frozen=True)
class Instant:
    """A moment that is asked for."""

    time: float
    """In seconds."""
    word: str
    """What a file of it is called: ``0.8s``, ``end``."""


def instants(run: MeteredRun, at: Instants) -> list[Instant]:
    """The moments that ``at`` names: seconds, times with units, ``start``, ``end``; or a list.

    Raises:
        OutputError: what is no time, or one that the run does not reach; one a line.
    """
    asked = list(at) if isinstance(at, (list, tuple, np.ndarray)) else [at]
    found, told = [], []
    for each in asked:
        try:
            found.append(_instant(run, each))
        except WrongValueError as error:
            told.append(f"at={quoted(each)}: {error}")
    if told or not asked:
        raise OutputError("\n".join(told) or 'at is an empty list: pass times, "start" or "end"',
                          code="bad-time")
    return found


def _instant(run: MeteredRun, asked: Any) -> Instant:
    first, last = float(run.time[0]), float(run.time[-1])
    # a sample is taken within a step, so that none lies at the very start and end
    apart = (last - first) / max(len(run.time) - 1, 1) * (1 + 1e-9)
    least = 0.0 if first <= apart else first
    if isinstance(asked, str) and asked.strip() in ENDS:
        word = asked.strip()
        return Instant(least if word == ENDS[0] else last, word)
    try:
        time = number_from(_number(asked), "time", {})
    except ValueError as error:
        hint = near(asked, ENDS) if isinstance(asked, str) else ""
        told = error.message if isinstance(error, WrongValueError) else str(error)
        raise WrongValueError("bad-time",
                              told, allowed='a time such as 0.8 or "0.8 s", "start", "end"',
                              hint=hint) from None
    most = max(last, run.mechanism.run.duration) if run.mechanism.run.duration - last <= 2 * apart \
        else last
    if not least <= time <= most:
        raise WrongValueError("bad-time", f"the run lasts from {least:g} s to {most:g} s")
    return Instant(time, f"{time:.6g}s")


def _number(asked: Any) -> Any:
    """A text without a unit as a number of seconds."""
    try:
        return float(asked) if isinstance(asked, str) else asked
    except ValueError:
        return asked


def save_stills(
    run: MeteredRun, path: Path, *, view: View, at: Instants | None = None,
    strip: bool | int = False, transparent: bool = False, bare: bool = False,
    scales: bool = False, sized: bool = False, paper: PrintSize | None = None,
) -> list[Path]:
    """Draw moments to ``path``; see :func:`sandbox.picture.film.render`.

    The view's size is that of a strip as a whole where it is ``sized``; that of ``paper`` takes
    its place.
    """
    moments = _moments(run, view, at, strip)
    per_inch = None
    if strip is not False:
        made = strip_of(run, [moment.time for moment in moments], view, bare=bare, scales=scales,
                        size=view.size if sized else None, paper=paper)
        files = still_paths(path, [Instant(0.0, "strip")], several=False)
        per_inch = paper.per_inch(made.size[0]) if paper else None
        save(output_path(files[0], WHAT), made.size, made.type, made.paint,
             transparent=transparent, per_inch=per_inch)
        return files
    worn: dict[str, Any] = {"view": view, "bare": bare, "scales": scales,
                            "moments": [moment.time for moment in moments]}
    if paper:
        worn |= {"unit": paper.unit(TYPE), "least": paper.least}
        worn["size"] = _paper_size(run, paper, worn)
        per_inch = paper.per_inch(worn["size"][0])
    picture = Picture(run, **worn)
    files = still_paths(path, moments, several=len(moments) > 1)
    for moment, file in zip(moments, files, strict=True):
        save(output_path(file, WHAT), picture.size, picture.type,
             partial(_paint, picture, moment.time), transparent=transparent, per_inch=per_inch)
    return files


def _paint(picture: Picture, t: float, paper: Paper) -> None:
    paint_picture(picture, paper, t)


def _paper_size(run: MeteredRun, paper: PrintSize, worn: dict[str, Any]) -> tuple[int, int]:
    """Of a still [pixels]: as high as it is said, or as what it shows."""
    wide, high = paper.pixels, paper.pixels_down
    if high is None:
        ample = Picture(run, size=(wide, ROOM * wide), **worn)
        high = round(ample.needs)
    return wide, high


def _moments(run: MeteredRun, view: View, at: Instants | None, strip: bool | int) -> list[Instant]:
    if isinstance(strip, bool):
        if at is not None:
            return instants(run, at)
        count = KEYS if strip else 1
    elif at is not None:
        raise OutputError(f"strip={strip} and at say both which pictures a strip has: "
                          "pass strip=True with at, or a number without", code="bad-picture")
    elif not 2 <= strip <= MOST:
        raise OutputError(f"strip={quoted(strip)}: a strip has 2 to {MOST} pictures",
                          code="bad-picture")
    else:
        count = strip
    end = float(run.time[-1])
    if count == 1:
        return [Instant(end, ENDS[1])]
    return [Instant(t, f"{t:.6g}s") for t in np.linspace(min(view.start, end), end, count).tolist()]


def still_paths(path: Path, moments: Sequence[Instant], *, several: bool) -> list[Path]:
    """One file for each moment: ``path`` itself, or its name with the moment's where several.

    In a directory they are ``still_0.8s.png`` and so on.
    """
    if not path.suffix or path.is_dir():
        return [path / f"still_{moment.word}.png" for moment in moments]
    if not several:
        return [path]
    return [path.with_name(f"{path.stem}_{moment.word}{path.suffix}") for moment in moments]


def save_picture(
    run: MeteredRun, path: str | Path, *, t: float | None = None,
    size: tuple[int, int] | str | None = None, view: View | None = None,
) -> None:
    """Draw one moment of a run, by default its end."""
    check_run(run)
    paper = paper_of(size)
    view = view_of(view or run.mechanism.view, {"size": None if paper else size})
    save_stills(run, output_path(path, WHAT), view=view, at=t, paper=paper)
