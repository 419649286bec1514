"""Stills: single moments of a run as PNG, SVG or PDF, or a strip: several side by side in one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pygame

from sandbox.atomic_files import output_path
from sandbox.errors import OutputError
from sandbox.picture.bounds import Rectangle, body_box, whole_box, width_shown
from sandbox.picture.build import subject_of
from sandbox.picture.frame import (
    LEAST_TYPE,
    TYPE,
    Picture,
    arrange,
    draw_legend,
    entries,
    picture_unit,
    type_size,
)
from sandbox.picture.meters import MeterPanel
from sandbox.picture.options import PrintSize, check_run, paper_of, view_of
from sandbox.picture.palette import HAIRLINE, INK
from sandbox.picture.run_data import MeteredRun
from sandbox.picture.typesetter import Headline, Typesetter, ellipsis
from sandbox.scene.settings import View
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, near, quoted

if TYPE_CHECKING:
    from sandbox.picture.paper import Paper  # loads matplotlib

ENDINGS = (".png", ".svg", ".pdf")
WHAT = "a picture"
ENDS = ("start", "end")
"""Words for times."""
ROOM = 3
"""Height in widths that no still on paper needs: what it needs is found in it."""
KEYS, MOST = 5, 24
"""Pictures of a strip, unless it is said how many; at most."""
ACROSS = 6
"""Pictures in a row of a strip, unless its size is given."""
SHAPES = (0.35, 1.6)
"""Least and largest height of a picture of a strip as a fraction of its width."""
LEAST = 0.42
"""Of the width that the view asks for: a picture of a strip is not narrower."""
INSIDE = 0.65
"""Size of the words in the pictures of a strip, in that of its own."""
SETTLED = 3
"""Times that the size of type and the height of what stands around, which has it, are found from
each other."""
NARROWEST, SMALLEST = 40.0, 40
"""Of a picture of a strip: least width on paper [mm], least width and height [pixels]."""
Instants = float | str | Sequence[float | str]


class Instant(NamedTuple):
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
    given = list(at) if isinstance(at, (list, tuple, np.ndarray)) else [at]
    found, problems = [], []
    for each in given:
        try:
            found.append(_instant(run, each))
        except WrongValueError as error:
            problems.append(f"at={quoted(each)}: {error}")
    if problems or not given:
        raise OutputError("\n".join(problems) or
                          'at is an empty list: pass times, "start" or "end"', code="bad-time")
    return found


def _instant(run: MeteredRun, given: Any) -> Instant:
    first, last = float(run.time[0]), float(run.time[-1])
    # a sample is taken within a step, so that none lies at the very start and end
    apart = (last - first) / max(len(run.time) - 1, 1) * (1 + 1e-9)
    least = 0.0 if first <= apart else first
    if isinstance(given, str) and (word := given.strip()) in ENDS:
        return Instant(least if word == ENDS[0] else last, word)
    try:
        time = number_from(_number(given), "time", {})
    except ValueError as error:
        hint = near(given, ENDS) if isinstance(given, str) else ""
        words = error.message if isinstance(error, WrongValueError) else str(error)
        raise WrongValueError("bad-time", words, hint=hint,
                              allowed='a time such as 0.8 or "0.8 s", "start", "end"') from None
    most = max(last, run.mechanism.run.duration) if run.mechanism.run.duration - last <= 2 * apart \
        else last
    if not least <= time <= most:
        raise WrongValueError("bad-time", f"the run lasts from {least:g} s to {most:g} s")
    return Instant(time, f"{time:.6g}s")


def _number(given: Any) -> Any:
    """A text without a unit as a number of seconds."""
    try:
        return float(given) if isinstance(given, str) else given
    except ValueError:
        return given


def save_stills(
    run: MeteredRun, path: Path, *, view: View, at: Instants | None = None,
    strip: bool | int = False, transparent: bool = False, bare: bool = False,
    scales: bool = False, sized: bool = False, paper: PrintSize | None = None,
) -> list[Path]:
    """Draw moments to ``path``; see :func:`sandbox.picture.film.render`.

    The view's size is that of a strip as a whole where it is ``sized``; that of ``paper`` takes
    its place.
    """
    from sandbox.picture.paper import paint_picture, save

    moments = _moments(run, view, at, strip)
    times = [moment.time for moment in moments]
    if strip is not False:
        made: Any = strip_of(run, times, view, bare=bare, scales=scales, paper=paper,
                             size=view.size if sized else None)
        paints, files = [made.paint], still_paths(path, [Instant(0.0, "strip")], several=False)
    else:
        worn: dict[str, Any] = {"view": view, "bare": bare, "scales": scales, "moments": times}
        if paper:
            worn |= {"unit": paper.unit(TYPE), "least": paper.least}
            high = paper.pixels_down or round(
                Picture(run, size=(paper.pixels, ROOM * paper.pixels), **worn).needs)
            worn["size"] = (paper.pixels, high)
        made = Picture(run, **worn)
        paints = [partial(paint_picture, made, t=t) for t in times]
        files = still_paths(path, moments, several=len(moments) > 1)
    for paint, file in zip(paints, files, strict=True):
        save(output_path(file, WHAT), made.size, made.type, paint, transparent=transparent,
             per_inch=paper.per_inch(made.size[0]) if paper else None)
    return files


def _moments(run: MeteredRun, view: View, at: Instants | None, strip: bool | int) -> list[Instant]:
    count = (KEYS if strip else 1) if isinstance(strip, bool) else strip
    if isinstance(strip, bool) and at is not None:
        return instants(run, at)
    if at is not None:
        raise OutputError(f"strip={strip} and at say both which pictures a strip has: "
                          "pass strip=True with at, or a number without", code="bad-picture")
    if strip is not False and not 2 <= count <= MOST:
        raise OutputError(f"strip={quoted(strip)}: a strip has 2 to {MOST} pictures",
                          code="bad-picture")
    end = float(run.time[-1])
    if strip is False:
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


def strip_of(run: MeteredRun, times: Sequence[float], view: View, *, bare: bool = False,
             scales: bool = False, size: tuple[int, int] | None = None,
             paper: PrintSize | None = None) -> Strip:
    """Pictures at ``times`` [s], each above its time; ``bare`` leaves title and legend out.

    Meters stand below all pictures, with a cursor for each. The strip has the ``size`` [pixels], or
    that of ``paper``, else what its pictures need, each about :data:`LEAST` of the view's width.

    Raises:
        OutputError: the size has no room for so many pictures.
    """
    around = partial(_Surround, run, view, titled=not (bare or scales), keyed=scales or not bare,
                     least=paper.least if paper else 0, count=len(times))
    made = partial(Strip, run, times, view, around, scales=scales)
    bodies = body_box(run, view, times)
    across = width_shown(bodies, 1.0, view.width)
    out = subject_of(run, view, width=across, point=across / 800, moments=times).out
    box = whole_box(out, run, bodies, view, times)
    if paper and paper.pixels_down:
        size = (paper.pixels, paper.pixels_down)
    if size is None:
        most = max(1, int(paper.width / NARROWEST)) if paper else ACROSS
        count = math.ceil(len(times) / math.ceil(len(times) / most))
        wide = paper.pixels // count if paper else round(view.size[0] * max(LEAST, 1 / count))
        shape = view.size[1] / view.size[0] if view.width and view.centre else float(
            np.clip(box.height / (view.width or max(box.width, 1e-9)), *SHAPES))
        pane = (wide, round(wide * shape))
        if paper:
            unit = paper.unit(TYPE)
            return made(count, pane, inside=unit, unit=unit)
        own = unit = picture_unit(view.size)
        for _ in range(SETTLED):
            stands = around(unit, (count * wide, 10 * count * wide), 1)
            high = stands.high + math.ceil(len(times) / count) * (
                pane[1] + stands.line + stands.pad)
            unit = max(own, picture_unit((count * wide, high)))
        return made(count, pane, inside=max(own, INSIDE * unit), unit=unit)
    unit = paper.unit(TYPE) if paper else picture_unit(size)
    for rows in (1, 2, 3, 4):
        count, pane = _fitted(box, len(times), size, around(unit, size, rows))
        strip = made(count, pane, inside=unit if paper else INSIDE * unit, unit=unit, size=size)
        if len(strip.legend) <= rows:
            break
    return strip


class _Surround:
    """What stands around the pictures, and its heights [pixels]."""

    def __init__(self, run: MeteredRun, view: View, unit: float, size: tuple[int, int], rows: int,
                 *, titled: bool, keyed: bool, least: int, count: int) -> None:
        self.least, self.keyed, self.type = least, keyed, Typesetter(type_size(unit), least)
        self.pad, self.line = round(0.8 * self.type.size), round(1.6 * self.type.size)
        title = run.mechanism.title or run.mechanism.name
        self.title = Headline.of(title, self.type, size[0] - 2 * self.pad, self.type.scaled(1.2),
                                 size[1]) if titled else None
        self.head = self.title.high if self.title else 0
        self.panel = MeterPanel(run, view, self.type, unit, size, count)
        self.high = self.head + self.panel.below + (rows * self.line + self.pad if keyed else 0)
        """All of it but the times below the pictures."""


def _fitted(box: Rectangle, count: int, size: tuple[int, int], around: _Surround,
            ) -> tuple[int, tuple[int, int]]:
    """How many pictures stand in a row so that they are largest, and the size of one."""
    best, found = 0.0, None
    for down in range(1, count + 1):
        across = math.ceil(count / down)
        wide = size[0] // across
        high = (size[1] - around.high) // down - around.line - around.pad
        scale = min(wide / max(box.width, 1e-9), high / max(box.height, 1e-9))
        if min(wide, high) >= SMALLEST and scale > best:
            best, found = scale, (across, (wide, high))
    if found is None:
        raise OutputError(f"size={size[0]}x{size[1]}: a strip of {count} pictures has no room "
                          f"there; allowed: pictures of {SMALLEST} by {SMALLEST} pixels or more "
                          "besides title, times, meters and legend", code="bad-picture")
    return found


class Strip:
    """Title, pictures in rows, meters and legend, laid out."""

    def __init__(self, run: MeteredRun, times: Sequence[float], view: View,
                 around: partial[_Surround], across: int, pane: tuple[int, int], *, inside: float,
                 unit: float, scales: bool, size: tuple[int, int] | None = None) -> None:
        self._times, self._across, self._unit = times, across, unit
        width = size[0] if size else across * pane[0]
        self._around = stands = around(unit, size or (width, 10 * width), 0)
        self.type, panel = stands.type, stands.panel
        self.pane = Picture(run, size=pane, view=view.model_copy(update={"meters": ()}),
                            unit=inside, bare=True, moments=times, least=stands.least)
        self.legend = [] if not stands.keyed else arrange(
            entries(self.pane.out.legend, self.pane.camera.scale, unit, scales=scales),
            self.type, unit, width - 2 * stands.pad, 8)
        self._cell = pane[1] + stands.line + stands.pad
        bottom = stands.head + math.ceil(len(times) / across) * self._cell
        panel.settle(pygame.Rect(0, bottom, width, panel.below), aside=False)
        self._foot = bottom + panel.below
        self.size = size or (width, self._foot + len(self.legend) * stands.line + (
            stands.pad if stands.keyed else 0))

    def paint(self, paper: Paper) -> None:
        """Paint all of it."""
        from sandbox.picture.paper import paint_stage

        (wide, high), stands, unit = self.pane.size, self._around, self._unit
        texts, size = self._time_texts(wide - stands.pad)
        for i, (t, text) in enumerate(zip(self._times, texts, strict=True)):
            x, y = i % self._across * wide, stands.head + i // self._across * self._cell
            paper.move(x, y)
            instant = paint_stage(self.pane, paper, t, (0, 0, wide, high))
            self.pane.write_grid(paper, instant)
            self.pane.write_labels(paper, instant)
            paper.clip(None)
            paper.move(0, 0)
            paper.write((round(x + (wide - self.type.width(text, size)) / 2),
                         round(y + high + (stands.line - self.type.height(size)) / 2)),
                        text, size, INK)
        bottom = stands.panel.rect.top - stands.pad
        for column in range(1, self._across):
            paper.line([(column * wide, stands.head), (column * wide, bottom)], HAIRLINE, unit)
        stands.panel.draw_still(paper)
        stands.panel.draw(paper, self._times)
        if stands.title:
            stands.title.write(paper, self.type, stands.pad)
            edge = self._foot - stands.pad / 2
            paper.line([(stands.pad, edge), (self.size[0] - stands.pad, edge)], HAIRLINE, unit)
        draw_legend(paper, instant, self.legend, self.type, unit, stands.pad, self._foot,
                    stands.line)

    def _time_texts(self, room: int) -> tuple[list[str], int]:
        """Times below the pictures and the size of their type, so that no two meet.

        Where they are too wide, they have no ``t =``, then fewer decimals, then smaller type.
        """
        forms = ["t = {:.3f} s", "{:.3f} s", "{:.2f} s", "{:.1f} s", "{:.0f} s"]
        every = [[form.format(t) for t in self._times] for form in forms]
        every = [texts for texts in every if len(set(texts)) == len(set(self._times))] or every[:2]
        least = max(LEAST_TYPE, self.type.least)
        for size in range(self.type.size, least - 1, -1):
            for texts in every:
                if max(self.type.width(text, size) for text in texts) <= room:
                    return texts, size
        return [ellipsis(self.type, text, room, least) for text in every[-1]], least
