"""Stills: single moments of a run as PNG, SVG or PDF, or a strip: several side by side in one."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pygame

from sandbox.atomic_files import output_path
from sandbox.errors import OutputError
from sandbox.picture.frame import (
    MIN_TYPE,
    TYPE,
    Picture,
    arrange,
    draw_legend,
    picture_unit,
    type_size,
)
from sandbox.picture.meters import MeterPanel
from sandbox.picture.options import PRINT_TYPE, UNITS, PrintSize, check_run, paper_of, view_of
from sandbox.picture.palette import HAIRLINE, INK
from sandbox.picture.typesetter import Headline, Typesetter, ellipsis
from sandbox.samples.samples import Samples
from sandbox.scene.settings import View
from sandbox.values.numbers import number_from
from sandbox.wording import WrongValueError, near, quoted

if TYPE_CHECKING:
    from sandbox.picture.paper import Paper  # loads matplotlib

ENDINGS = (".png", ".svg", ".pdf")
WHAT = "a picture"
ENDS = ("start", "end")  # words for times
PICTURES, MAX_PICTURES = 5, 24  # of a strip: default and maximum
ACROSS = 6  # pictures in a row of a strip without a size
SHAPES = (0.35, 1.6)  # limits of height / width of a picture of a strip without a size
MIN_WIDTH = 0.42  # minimum width of a picture of a strip relative to the view's
INSIDE = 0.65  # size of words inside the pictures of a strip relative to its own
PRINT_UNIT = 0.75 * PRINT_TYPE / TYPE  # pixels per point on paper: lines are finer than letters
NARROWEST, SMALLEST = 40.0, 40
"""Pictures of a strip: minimum width on paper [mm], minimum width and height [pixels]."""
Instants = float | str | Sequence[float | str]


class Moment(NamedTuple):
    """A requested moment."""

    time: float  # [s]
    word: str  # in the name of its file: ``0.8s``, ``end``


def instants(run: Samples, at: Instants) -> list[Moment]:
    """The moments that ``at`` names: seconds, times with units, ``start``, ``end``; or a list.

    Raises:
        OutputError: values that are no times, or that the run does not reach; one a line.
    """
    found, problems = [], []
    for each in at if isinstance(at, (list, tuple, np.ndarray)) else [at]:
        try:
            found.append(_moment(run, each))
        except WrongValueError as error:
            problems.append(f"at={quoted(each)}: {error}")
    if problems or not found:
        raise OutputError("\n".join(problems) or
                          'at is an empty list: pass times, "start" or "end"', code="bad-time")
    return found


def _moment(run: Samples, given: Any) -> Moment:
    first, last = float(run.time[0]), float(run.time[-1])
    # a sample is taken within a step, so that none lies at the very start and end
    apart = (last - first) / max(len(run.time) - 1, 1) * (1 + 1e-9)
    start, end = (0.0 if first <= apart else first), run.mechanism.run.duration
    if isinstance(given, str) and (word := given.strip()) in ENDS:
        return Moment(start if word == ENDS[0] else last, word)
    number = given
    if isinstance(given, str):
        with suppress(ValueError):
            number = float(given)
    try:
        time = number_from(number, "time", {})
    except ValueError as error:
        hint = near(given, ENDS) if isinstance(given, str) else ""
        words = error.message if isinstance(error, WrongValueError) else str(error)
        raise WrongValueError("bad-time", words, hint=hint,
                              allowed='a time such as 0.8 or "0.8 s", "start", "end"') from None
    if not start <= time <= (max(last, end) if end - last <= 2 * apart else last):
        raise WrongValueError("bad-time", f"the run lasts from {start:g} s to {last:g} s")
    return Moment(time, f"{time:.6g}s")


def save_stills(
    run: Samples, path: Path, *, view: View, at: Instants | None = None,
    strip: bool | int = False, transparent: bool = False, bare: bool = False,
    scales: bool = False, sized: bool = False, paper: PrintSize | None = None,
) -> list[Path]:
    """Draw moments to ``path``; see :func:`sandbox.picture.film.render`.

    If ``sized``, the view's size is that of a strip as a whole; ``paper`` overrides it.
    """
    from sandbox.picture.paper import save

    moments = _moments(run, view, at, strip)
    times = [moment.time for moment in moments]
    made: Picture | Strip
    if strip is not False:
        made = Strip(run, times, view, bare=bare, scales=scales, paper=paper,
                     size=view.size if sized else None)
        moments = [Moment(times[0], "strip")]
    else:
        picture, size = partial(Picture, run, view=view, bare=bare, scales=scales,
                                moments=times), view.size
        if paper:
            picture, size = partial(picture, unit=PRINT_UNIT, least=PRINT_TYPE), paper.pixels
            if not size[1]:  # a layout in a tall picture finds the height
                size = size[0], round(picture(size=(size[0], 3 * size[0])).needs)
        made = picture(size=size)
    files = []
    for moment in moments:
        file = path
        if not path.suffix or path.is_dir():
            file = path / f"still_{moment.word}.png"
        elif len(moments) > 1:
            file = path.with_name(f"{path.stem}_{moment.word}{path.suffix}")
        save(output_path(file, WHAT), made, moment.time, transparent=transparent,
             per_inch=made.size[0] * UNITS["in"] / paper.width if paper else None)
        files.append(file)
    return files


def _moments(run: Samples, view: View, at: Instants | None, strip: bool | int) -> list[Moment]:
    if isinstance(strip, bool) and at is not None:
        return instants(run, at)
    if at is not None:
        raise OutputError(f"strip={strip} and at say both which pictures a strip has: "
                          "pass strip=True with at, or a number without", code="bad-picture")
    end = float(run.time[-1])
    if strip is False:
        return [Moment(end, ENDS[1])]
    count = PICTURES if strip is True else strip
    if not 2 <= count <= MAX_PICTURES:
        raise OutputError(f"strip={quoted(strip)}: a strip has 2 to {MAX_PICTURES} pictures",
                          code="bad-picture")
    return [Moment(t, f"{t:.6g}s") for t in np.linspace(min(view.start, end), end, count).tolist()]


def save_picture(
    run: Samples, path: str | Path, *, t: float | None = None,
    size: tuple[int, int] | str | None = None,
) -> None:
    """Draw one moment of a run, by default its end."""
    check_run(run)
    paper = paper_of(size)
    view = view_of(run.mechanism.view, {"size": None if paper else size})
    save_stills(run, output_path(path, WHAT), view=view, at=t, paper=paper)


class Strip:
    """Pictures at ``times`` [s] in rows, each above its time; title, meters and legend.

    Meters stand below all pictures, with a cursor for each. The size is ``size`` [pixels], or that
    of ``paper``, else each picture has about :data:`MIN_WIDTH` of the view's width. ``bare`` leaves
    title and legend out, ``scales`` keeps the scales of the legend.

    Raises:
        OutputError: the size has no room for so many pictures.
    """

    def __init__(self, run: Samples, times: Sequence[float], view: View, *, bare: bool = False,
                 scales: bool = False, size: tuple[int, int] | None = None,
                 paper: PrintSize | None = None) -> None:
        self.run, self.times, self.view = run, times, view
        self.titled, self.keyed, self.scales = not (bare or scales), scales or not bare, scales
        self.least = PRINT_TYPE if paper else 0
        if paper and paper.height:
            size = paper.pixels
        width, height = self._picture(view.size, picture_unit(view.size)).box.size  # [m]
        unit = PRINT_UNIT if paper else picture_unit(size or view.size)
        if size:
            for rows in (1, 2, 3, 4):
                self._surround(unit, size)
                across, pane = self._fitted(width, height, size, rows)
                self._lay_out(across, pane, unit if paper else INSIDE * unit, size)
                if len(self.legend) <= rows:
                    break
            return
        most = max(1, int(paper.width / NARROWEST)) if paper else ACROSS
        across = math.ceil(len(times) / math.ceil(len(times) / most))
        share = max(MIN_WIDTH, 1 / across)
        wide = paper.pixels[0] // across if paper else round(view.size[0] * share)
        shape = view.size[1] / view.size[0] if view.width and view.centre else float(
            np.clip(height / (view.width or max(width, 1e-9)), *SHAPES))
        own, pane = unit, (wide, round(wide * shape))
        for _ in range(1 if paper else 4):  # size of type and height depend on each other
            self._surround(unit, (across * wide, 10 * across * wide))
            high = self._high(1) + math.ceil(len(times) / across) * (
                pane[1] + self.line + self.pad)
            self.unit, unit = unit, max(own, picture_unit((across * wide, high)))
        self._lay_out(across, pane, own if paper else max(own, INSIDE * self.unit), None)

    def _picture(self, size: tuple[int, int], unit: float) -> Picture:
        view = self.view.model_copy(update={"meters": ()})
        return Picture(self.run, size=size, view=view, unit=unit, bare=True, moments=self.times,
                       least=self.least)

    def _surround(self, unit: float, size: tuple[int, int]) -> None:
        """Set title and meters."""
        self.unit, self.type = unit, Typesetter(type_size(unit), self.least)
        self.pad, self.line = round(0.8 * self.type.size), round(1.6 * self.type.size)
        title = self.run.mechanism.title or self.run.mechanism.name
        self.title = Headline.of(title, self.type, size[0] - 2 * self.pad, self.type.scaled(1.2),
                                 size[1]) if self.titled else None
        self.head = self.title.high if self.title else 0
        self.panel = MeterPanel(self.run, self.view, self.type, unit, size, len(self.times))

    def _high(self, rows: int) -> int:
        """Height [pixels] without pictures and times, with these rows of the legend."""
        return self.head + self.panel.below + (rows * self.line + self.pad if self.keyed else 0)

    def _fitted(self, width: float, height: float, size: tuple[int, int],
                rows: int) -> tuple[int, tuple[int, int]]:
        """Pictures in a row, and the size of one, for which a width and height [m] are largest."""
        best, found, count = 0.0, None, len(self.times)
        for down in range(1, count + 1):
            across = math.ceil(count / down)
            wide = size[0] // across
            high = (size[1] - self._high(rows)) // down - self.line - self.pad
            scale = min(wide / max(width, 1e-9), high / max(height, 1e-9))
            if min(wide, high) >= SMALLEST and scale > best:
                best, found = scale, (across, (wide, high))
        if found is None:
            raise OutputError(f"size={size[0]}x{size[1]}: a strip of {count} pictures has no room "
                              f"there; allowed: pictures of {SMALLEST} by {SMALLEST} pixels or "
                              "more besides title, times, meters and legend", code="bad-picture")
        return found

    def _lay_out(self, across: int, pane: tuple[int, int], inside: float,
                 size: tuple[int, int] | None) -> None:
        width = size[0] if size else across * pane[0]
        self.across, self.pane = across, self._picture(pane, inside)
        self.legend = [] if not self.keyed else arrange(
            self.pane.out.legend, self.pane.camera.scale, self.type, self.unit,
            width - 2 * self.pad, 8, scales=self.scales)
        self.cell = pane[1] + self.line + self.pad
        bottom = self.head + math.ceil(len(self.times) / across) * self.cell
        self.foot = bottom + self.panel.below
        self.panel.settle(pygame.Rect(0, bottom, width, self.panel.below), aside=False)
        self.size = size or (width, self.foot + len(self.legend) * self.line + (
            self.pad if self.keyed else 0))

    def paint(self, paper: Paper, t: float = 0.0) -> None:
        """Paint all of it, whatever the time."""
        (wide, high), unit = self.pane.size, self.unit
        texts, size = self._time_texts(wide - self.pad)
        for i, (time, text) in enumerate(zip(self.times, texts, strict=True)):
            x, y = i % self.across * wide, self.head + i // self.across * self.cell
            paper.move(x, y)
            instant = self.pane.paint_stage(paper, time)
            self.pane.write_labels(paper, instant)
            paper.move(0, 0)
            paper.write((round(x + (wide - self.type.width(text, size)) / 2),
                         round(y + high + (self.line - self.type.height(size)) / 2)),
                        text, size, INK)
        bottom = self.panel.rect.top - self.pad
        for column in range(1, self.across):
            paper.line([(column * wide, self.head), (column * wide, bottom)], HAIRLINE, unit)
        self.panel.draw_still(paper)
        self.panel.draw(paper, self.times)
        if self.title:
            self.title.write(paper, self.type, self.pad)
            edge = self.foot - self.pad / 2
            paper.line([(self.pad, edge), (self.size[0] - self.pad, edge)], HAIRLINE, unit)
        draw_legend(paper, instant, self.legend, self.type, unit, self.pad, self.foot, self.line)

    def _time_texts(self, room: int) -> tuple[list[str], int]:
        """Times below the pictures in a form and a size of type [pixels] that fit in ``room``."""
        forms = ["t = {:.3f} s", "{:.3f} s", "{:.2f} s", "{:.1f} s", "{:.0f} s"]
        every = [[form.format(t) for t in self.times] for form in forms]
        every = [texts for texts in every if len(set(texts)) == len(set(self.times))] or every[:2]
        least = max(MIN_TYPE, self.type.least)
        for size in range(self.type.size, least - 1, -1):
            for texts in every:
                if max(self.type.width(text, size) for text in texts) <= room:
                    return texts, size
        return [ellipsis(self.type, text, room, least) for text in every[-1]], least
