"""A strip: key frames of a run side by side in one picture, one camera and one legend for all."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pygame

from sandbox.errors import OutputError
from sandbox.picture.bounds import body_box, whole_box
from sandbox.picture.build import subject_of
from sandbox.picture.camera import Rectangle, width_shown
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
from sandbox.picture.labels import paint_labels
from sandbox.picture.meters import MeterPanel
from sandbox.picture.options import PrintSize
from sandbox.picture.palette import HAIRLINE, INK
from sandbox.picture.paper import Paper
from sandbox.picture.run_data import MeteredRun
from sandbox.picture.typesetter import Headline, Typesetter, ellipsis
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


class Worn(NamedTuple):
    """What stands around the pictures of a strip."""

    bare: bool
    """No title."""
    keyed: bool
    """A legend, of which ``scales`` leaves the glyphs out."""
    scales: bool
    least: int
    """The smallest type [pixels, as a typesetter counts it]."""


def strip_of(run: MeteredRun, times: Sequence[float], view: View, *, bare: bool = False,
             scales: bool = False, size: tuple[int, int] | None = None,
             paper: PrintSize | None = None) -> Strip:
    """Pictures at ``times`` [s], each above its time; ``bare`` leaves title and legend out.

    Meters stand below all pictures, with a cursor for each. The strip has the ``size`` [pixels], or
    that of ``paper``, else what its pictures need, each about :data:`LEAST` of the view's width.

    Raises:
        OutputError: the size has no room for so many pictures.
    """
    box = _box(run, view, times)
    worn = Worn(bare or scales, scales or not bare, scales, paper.least if paper else 0)
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
            return Strip(run, times, view, worn, across, pane, inside=unit, unit=unit)
        own = picture_unit(view.size)
        down, unit = math.ceil(len(times) / across), own
        for _ in range(SETTLED):
            around = _Surround(run, view, unit, (across * wide, 10 * across * wide), 1, worn,
                               len(times))
            high = around.high + down * (pane[1] + around.line + around.pad)
            unit = max(own, picture_unit((across * wide, high)))
        return Strip(run, times, view, worn, across, pane, inside=max(own, INSIDE * unit),
                     unit=unit)
    unit = paper.unit(TYPE) if paper else picture_unit(size)
    inside = unit if paper else INSIDE * unit
    for rows in (1, 2, 3, 4):
        around = _Surround(run, view, unit, size, rows, worn, len(times))
        across, pane = _fitted(box, len(times), size, around)
        made = Strip(run, times, view, worn, across, pane, inside=inside, unit=unit, size=size)
        if len(made.legend) <= rows:
            break
    return made


def _box(run: MeteredRun, view: View, times: Sequence[float]) -> Rectangle:
    """What a picture of the strip shows [m]."""
    bodies = body_box(run, view, times)
    across = width_shown(bodies, 1.0, view.width)
    out = subject_of(run, view, width=across, point=across / 800, moments=times).out
    return whole_box(out, run, bodies, view, times)


class _Surround:
    """Heights of what stands around the pictures [pixels]."""

    def __init__(self, run: MeteredRun, view: View, unit: float, size: tuple[int, int], rows: int,
                 worn: Worn, count: int) -> None:
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


class Strip:
    """Title, pictures in rows, meters and legend, laid out."""

    def __init__(self, run: MeteredRun, times: Sequence[float], view: View, worn: Worn,
                 across: int, pane: tuple[int, int], *, inside: float, unit: float,
                 size: tuple[int, int] | None = None) -> None:
        self._times, self._across, self._unit = times, across, unit
        (wide, high), down = pane, math.ceil(len(times) / across)
        self.pane = Picture(run, size=pane, view=view.model_copy(update={"meters": ()}),
                            unit=inside, bare=True, moments=times, least=worn.least)
        self.type = Typesetter(type_size(unit), worn.least)
        width = size[0] if size else across * wide
        around = _Surround(run, view, unit, size or (width, 10 * width), 0, worn, len(times))
        self._title, self._head = around.title, around.head
        self._pad, self._line = around.pad, around.line
        self._cell, self._panel = high + self._line + self._pad, around.panel
        self.legend = [] if not worn.keyed else arrange(
            entries(self.pane.out.legend, self.pane.camera.scale, unit, scales=worn.scales),
            self.type, unit, width - 2 * self._pad, 8)
        bottom = self._head + down * self._cell
        self._panel.settle(pygame.Rect(0, bottom, width, self._panel.below), aside=False)
        self._foot = bottom + self._panel.below
        needs = self._foot + len(self.legend) * self._line + (self._pad if worn.keyed else 0)
        self.size = size or (width, needs)

    def paint(self, paper: Paper) -> None:
        """Paint all of it."""
        wide, high = self.pane.size
        instant = self.pane.instant(1)
        texts, type_size_ = self._time_texts(wide - self._pad)
        for i, (t, text) in enumerate(zip(self._times, texts, strict=True)):
            x, y = i % self._across * wide, self._head + i // self._across * self._cell
            paper.move(x, y)
            paper.clip((0, 0, wide, high))
            instant.go_to(t)
            instant.paint_still(paper)
            instant.paint(paper)
            self.pane.write_grid(paper, instant)
            paint_labels(instant, paper, self.pane.label_size, self.pane.half)
            paper.clip(None)
            paper.move(0, 0)
            paper.write((round(x + (wide - self.type.width(text, type_size_)) / 2),
                         round(y + high + (self._line - self.type.height(type_size_)) / 2)),
                        text, type_size_, INK)
        bottom = self._panel.rect.top - self._pad
        for column in range(1, self._across):
            paper.line([(column * wide, self._head), (column * wide, bottom)], HAIRLINE,
                       self._unit)
        self._panel.draw_moments(paper, self._times)
        if self._title:
            self._title.write(paper, self.type, self._pad)
            edge = self._foot - self._pad / 2
            paper.line([(self._pad, edge), (self.size[0] - self._pad, edge)], HAIRLINE, self._unit)
        draw_legend(paper, instant, self.legend, self.type, self._unit, self._pad, self._foot,
                    self._line)

    def _time_texts(self, room: int) -> tuple[list[str], int]:
        """Times below the pictures and the size of their type, so that no two meet.

        Where they are too wide, they have no ``t =``, then fewer decimals, then smaller type.
        """
        forms = ["t = {:.3f} s", "{:.3f} s", "{:.2f} s", "{:.1f} s", "{:.0f} s"]
        told = [[form.format(t) for t in self._times] for form in forms]
        told = [texts for texts in told if len(set(texts)) == len(set(self._times))] or told[:2]
        least = max(LEAST_TYPE, self.type.least)
        for size in range(self.type.size, least - 1, -1):
            for texts in told:
                if max(self.type.width(text, size) for text in texts) <= room:
                    return texts, size
        return [ellipsis(self.type, text, room, least) for text in told[-1]], least
