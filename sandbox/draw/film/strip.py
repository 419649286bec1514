"""A strip: key frames of a run side by side in one picture, one camera and one legend for all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pygame

from sandbox.draw.film import clip, legend
from sandbox.draw.film.bounds import body_box, whole_box
from sandbox.draw.film.camera import Rectangle, width_shown
from sandbox.draw.film.canvas import LEAST_TYPE, TYPE, Canvas, picture_unit, type_size
from sandbox.draw.film.filmed import Metered
from sandbox.draw.film.frames import MOST_PIXELS, FrameRenderer
from sandbox.draw.film.headline import Headline
from sandbox.draw.film.meters import MeterPanel
from sandbox.draw.film.palette import HAIRLINE, INK, Colour
from sandbox.draw.film.paper import PrintSize
from sandbox.draw.film.scales import force_scale
from sandbox.draw.film.sheet import Sheet, Text
from sandbox.draw.film.typesetter import Typesetter, ellipsis
from sandbox.errors import OutputError
from sandbox.scene.settings import View

ACROSS = 6
"""Pictures in a row, unless the strip's size is asked for."""
SHAPES = (0.35, 1.6)
"""Least and largest height of a picture as a fraction of its width."""
LEAST = 0.42
"""Of the width that the view asks for: a picture of a strip is not narrower."""
INSIDE = 0.65
"""Size of the words in the pictures of a strip, in that of its own."""
SETTLED = 3
"""Times that the size of type and the height of what stands around, which has it, are found from
each other."""
NARROWEST = 40.0
"""Of a picture of a strip on paper [mm]."""
SMALLEST = 40
"""Least width and height of a picture [pixels]."""


def strip_sheet(run: Metered, times: Sequence[float], view: View, *, enlarge: int,
                bare: bool = False, scales: bool = False, size: tuple[int, int] | None = None,
                paper: PrintSize | None = None) -> Sheet:
    """Frames at ``times`` [s], each above its time; ``bare`` leaves title and legend out.

    Of the legend ``scales`` leaves those alone. Meters stand below all pictures, with a cursor for
    each. The strip as a whole has the ``size`` [pixels] that is asked for, or that of ``paper``,
    else as much as its pictures need, each about :data:`LEAST` times as wide as the view's.

    Raises:
        OutputError: the size has no room for so many pictures.
    """
    box = _box(run, view, times)
    worn = _Worn(bare or scales, scales or not bare, scales, paper.least if paper else 0)
    if paper and paper.pixels_down:
        size = (paper.pixels, paper.pixels_down)
    if size is None:
        most = max(1, int(paper.width / NARROWEST)) if paper else ACROSS
        across = math.ceil(len(times) / math.ceil(len(times) / most))
        wide = paper.pixels // across if paper else round(view.size[0] * max(LEAST, 1 / across))
        shape = view.size[1] / view.size[0] if view.width and view.centre else float(
            np.clip(box.height / (view.width or max(box.width, 1e-9)), *SHAPES))
        pane = (wide, round(wide * shape))
        if paper:
            unit = paper.unit(TYPE)
            return _StripPage(run, times, view, enlarge=enlarge, worn=worn, across=across,
                              pane=pane, inside=unit, unit=unit).compose()
        own = picture_unit(view.size)
        down, unit = math.ceil(len(times) / across), own
        for _ in range(SETTLED):
            around = _Surround(run, view, unit, (across * wide, 10 * across * wide), 1, worn,
                               len(times))
            high = around.high + down * (pane[1] + around.line + around.pad)
            unit = max(own, picture_unit((across * wide, high)))
        return _StripPage(run, times, view, enlarge=enlarge, worn=worn, across=across, pane=pane,
                          inside=max(own, INSIDE * unit), unit=unit).compose()
    unit = paper.unit(TYPE) if paper else picture_unit(size)
    page: _StripPage | None = None
    for rows in (1, 2, 3, 4):
        around = _Surround(run, view, unit, size, rows, worn, len(times))
        across, pane = _fitted(box, len(times), size, around)
        page = _StripPage(run, times, view, enlarge=enlarge, worn=worn, across=across, pane=pane,
                          inside=unit if paper else INSIDE * unit, unit=unit, size=size)
        if page.rows <= rows:
            break
    assert page is not None
    return page.compose()


def _box(run: Metered, view: View, times: Sequence[float]) -> Rectangle:
    """What a picture of the strip shows [m]."""
    bodies = body_box(run, view, times)
    across = width_shown(bodies, 1.0, view.width)
    return whole_box(run, bodies, force_scale(run, across, view), across, view, times)


class _Worn(NamedTuple):
    """What stands around the pictures, and in which type."""

    bare: bool
    """No title."""
    keyed: bool
    """A legend, ..."""
    scales: bool
    """... of which the scales alone."""
    least: int
    """No type is smaller [pixels, as a typesetter counts it]."""


class _Surround:
    """Heights of what stands around the pictures [pixels]."""

    def __init__(self, run: Metered, view: View, unit: float, size: tuple[int, int], rows: int,
                 worn: _Worn, count: int) -> None:
        type_ = Typesetter(type_size(unit), worn.least)
        self.pad, self.line = round(0.8 * type_.size), round(1.6 * type_.size)
        mechanism, room = run.mechanism, size[0] - 2 * self.pad
        self.title = None if worn.bare else Headline.of(
            mechanism.title or mechanism.name, type_, room, type_.scaled(1.2), size[1])
        self.head = self.title.high if self.title else 0
        self.panel = MeterPanel(run, view, type_, unit, size, count)
        self.legend = rows * self.line + self.pad if worn.keyed else 0

    @property
    def high(self) -> int:
        """All of it but the times below the pictures."""
        return self.head + self.panel.below + self.legend


def _fitted(box: Rectangle, count: int, size: tuple[int, int], around: _Surround,
            ) -> tuple[int, tuple[int, int]]:
    """How many pictures stand in a row so that they are largest, and the size of one."""
    best, found = 0.0, None
    for down in range(1, count + 1):
        across = math.ceil(count / down)
        wide = size[0] // across
        free = size[1] - around.high
        high = free // down - around.line - around.pad
        scale = min(wide / max(box.width, 1e-9), high / max(box.height, 1e-9))
        if min(wide, high) >= SMALLEST and scale > best:
            best, found = scale, (across, (wide, high))
    if found is None:
        raise OutputError(f"size={size[0]}x{size[1]}: a strip of {count} pictures has no room "
                          f"there; allowed: pictures of {SMALLEST} by {SMALLEST} pixels or more "
                          "besides title, times, meters and legend", code="bad-picture")
    return found


class _StripPage:
    """Title, pictures in rows, meters, legend."""

    def __init__(self, run: Metered, times: Sequence[float], view: View, *, enlarge: int,
                 worn: _Worn, across: int, pane: tuple[int, int], inside: float, unit: float,
                 size: tuple[int, int] | None = None) -> None:
        self._times, self._across, self._unit = times, across, unit
        (wide, high), down = pane, math.ceil(len(times) / across)
        while enlarge > 1 and across * wide * down * high * enlarge**2 > MOST_PIXELS:
            enlarge //= 2
        self._pane = FrameRenderer(run, size=pane, view=view.model_copy(update={"meters": ()}),
                                   enlarge=enlarge, unit=inside, bare=True, moments=times,
                                   least=worn.least)
        self._type = Typesetter(type_size(unit), worn.least)
        self._width = size[0] if size else across * wide
        around = _Surround(run, view, unit, size or (self._width, 10 * self._width), 0, worn,
                           len(times))
        self._title, self._head = around.title, around.head
        self._pad, self._line = around.pad, around.line
        self._cell, self._panel = high + self._line + self._pad, around.panel
        self._legend = [] if not worn.keyed else legend.arrange(
            legend.items_for(self._pane.content, self._pane.camera.scale, unit,
                             scales=worn.scales), self._type, unit,
            self._width - 2 * self._pad, 8)
        bottom = self._head + down * self._cell
        self._panel.settle(pygame.Rect(0, bottom, self._width, self._panel.below), aside=False)
        self._foot = bottom + self._panel.below
        needs = self._foot + len(self._legend) * self._line + (
            self._pad if worn.keyed else 0)
        self._height = size[1] if size else needs

    @property
    def rows(self) -> int:
        """Of the legend."""
        return len(self._legend)

    def compose(self) -> Sheet:
        """All of it."""
        pane, k = self._pane, self._pane.enlarged
        page = Sheet((self._width, self._height), k)
        wide, high = pane.size
        texts, type_size_ = self._time_texts(wide - self._pad)
        for i, (t, text) in enumerate(zip(self._times, texts, strict=True)):
            x, y = i % self._across * wide, self._head + i // self._across * self._cell
            page.place(pane.sheet(t), (x, y))
            self._write(page, text, x + wide / 2, y + high + self._line / 2, 0.5, type_size_)
        canvas = Canvas(page, pane.camera.magnified(k), self._unit * k, k)
        bottom = self._panel.rect.top
        for column in range(1, self._across):
            x = column * wide * k
            clip.line(page, HAIRLINE, (x, self._head * k), (x, (bottom - self._pad) * k),
                      canvas.width(1))
        page.words += self._panel.draw_moments(canvas, self._times)
        self._surround(page, canvas)
        return page

    def _surround(self, page: Sheet, canvas: Canvas) -> None:
        """Title and legend."""
        k, edge = canvas.enlarged, (self._foot - self._pad / 2) * canvas.enlarged
        if self._title:
            page.words += self._title.texts(self._type, self._pad)
            clip.line(page, HAIRLINE, (self._pad * k, edge),
                      ((self._width - self._pad) * k, edge), canvas.width(1))
        page.words += legend.draw_rows(canvas, self._type, self._legend, self._pad, self._foot,
                                       self._line)

    def _time_texts(self, room: int) -> tuple[list[str], int]:
        """What stands below the pictures and in which type, so that no two meet.

        As the film has it; without ``t =`` where that is too wide, then with fewer decimals while
        the times can be told apart, then in smaller type.
        """
        forms = ["t = {:.3f} s", "{:.3f} s", "{:.2f} s", "{:.1f} s", "{:.0f} s"]
        told = [[form.format(t) for t in self._times] for form in forms]
        told = [texts for texts in told if len(set(texts)) == len(set(self._times))] or told[:2]
        least = max(LEAST_TYPE, self._type.least)
        for size in range(self._type.size, least - 1, -1):
            for texts in told:
                if max(self._type.width(text, size) for text in texts) <= room:
                    return texts, size
        return [ellipsis(self._type, text, room, least) for text in told[-1]], least

    def _write(self, page: Sheet, text: str, x: float, middle: float, share: float,
               size: int | None = None, colour: Colour = INK) -> None:
        """A text of which ``share`` lies left of ``x``."""
        face = self._type.render(text, size=size, colour=colour)
        page.words.append(Text(face, (round(x - share * face.get_width()),
                                      round(middle - face.get_height() / 2))))
