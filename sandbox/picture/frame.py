"""The layout of a picture, and of several in one: title, mechanism, meters, legend, camera."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pygame

from sandbox.errors import OutputError
from sandbox.picture import bounds
from sandbox.picture.bounds import Camera, Rectangle
from sandbox.picture.build import subject_of
from sandbox.picture.elements.notes import grid
from sandbox.picture.geometry import arrow, within
from sandbox.picture.instant import Instant
from sandbox.picture.labels import SMALL, offset, place_labels
from sandbox.picture.listing import SIDES, Item, nearest
from sandbox.picture.meters import MeterPanel
from sandbox.picture.options import PRINT_TYPE, PrintSize
from sandbox.picture.palette import FAINT_INK, HAIRLINE, INK, Painter
from sandbox.picture.scales import prefixed, round_length
from sandbox.picture.typesetter import HEAD, Headline, Typesetter, ellipsis
from sandbox.samples.samples import Samples
from sandbox.scene.settings import View

if TYPE_CHECKING:
    from sandbox.picture.paper import Paper  # loads matplotlib

TYPE, MIN_TYPE = 20, 11  # size of type [points], and its minimum [pixels]
BAR, ARROW, RAMP = 80.0, 52.0, 64.0
"""Widths in the legend: lengths, arrows (maximum), ramps [points]."""
GAP, APART = 17.0, 5.0  # between rows of the legend, and between symbol and words [points]
SHAPES = (0.2, 1.5)  # limits of height / width of the motion where the height is free
STRIP_SHAPES = (0.35, 1.6)  # the same of a picture of a strip
MIN_WIDTH = 0.42  # minimum width of a picture of a strip relative to the view's
INSIDE = 0.65  # size of words inside the pictures of a strip relative to its own
PRINT_UNIT = 0.75 * PRINT_TYPE / TYPE  # pixels per point on paper: lines are finer than letters
NARROWEST, SMALLEST = 40.0, 40
"""Pictures of a strip: minimum width on paper [mm], minimum width and height [pixels]."""


def picture_unit(size: tuple[int, int]) -> float:
    """Pixels per point: a picture is 800 points wide, or 300 points high where it is a band."""
    return min(size[0] / 800, size[1] / 300)


def type_size(unit: float) -> int:
    """Size of type [pixels] for so many pixels per point."""
    return max(MIN_TYPE, round(TYPE * unit))


class Entry(NamedTuple):
    """A row of the legend: words, symbol, words; widths in finished pixels."""

    row: Item
    before: str
    symbol: float
    after: str


def arrange(legend: Sequence[Item], scale: float, type_: Typesetter, unit: float, width: float,
            max_rows: int, *, scales: bool) -> list[list[Entry]]:
    """The legend in lines no wider than ``width``; ``scale`` is pixels per metre."""
    lines: list[list[Entry]] = []
    used = width + 1.0
    for row, following in zip(legend, [*legend[1:], {}], strict=False):
        if following.get("instead") == row["l"] or (scales and row["k"] == "glyph"):
            continue
        if row["k"] == "scale":
            wide = ARROW if "size" in row else BAR
            size = round_length(wide * unit / (row["metres"] * scale))
            factor, written, _ = prefixed(size, "m") if wide == BAR else (1.0, row["unit"], 0)
            item = Entry(row, "", size * row["metres"] * scale,
                         f"{factor * size:.6g} {written} {row['words']}".rstrip())
        elif row["k"] == "ramp":
            item = Entry(row, row["before"], RAMP * unit, row["after"])
        else:
            item = Entry(row, "", row["width"] * unit, row["words"])
        needs = item.symbol + sum(type_.width(words) + APART * unit
                                  for words in (item.before, item.after) if words)
        if used + needs > width:
            if len(lines) == max_rows or needs > width:
                continue
            lines.append([])
            used = 0.0
        lines[-1].append(item)
        used += needs + GAP * unit
    return lines


def draw_legend(painter: Painter, instant: Instant, rows: Sequence[Sequence[Entry]],
                type_: Typesetter, unit: float, left: float, top: float, height: float) -> None:
    """Paint rows of the legend, the first at ``top`` [finished pixels]."""
    def write(words: str) -> float:
        painter.write((round(x), round(y - type_.height(type_.size) / 2)), words, type_.size,
                      FAINT_INK)
        return type_.width(words)

    k = painter.enlarge
    for number, row in enumerate(rows):
        x, y = left, top + (number + 0.5) * height
        for entry in row:
            if entry.before:
                x += write(entry.before) + APART * unit
            _symbol(painter, instant, entry, x * k, y * k, entry.symbol * k, unit * k)
            x += entry.symbol + APART * unit
            x += write(entry.after) + GAP * unit


def _symbol(painter: Painter, instant: Instant, entry: Entry, x: float, y: float,
            width: float, u: float) -> None:
    """The symbol of an entry, from x on [pixels of the painter]; ``u`` is pixels per point."""
    row = entry.row
    if row["k"] == "ramp":
        count = 32 if row["low"] < 0 else 24
        for k in range(count):
            share = row["low"] + (1 - row["low"]) * k / (count - 1)
            a, b = x + width * k / count, x + width * (k + 1) / count
            painter.simple([(a, y - 4.5 * u), (b + 0.5, y - 4.5 * u), (b + 0.5, y + 4.5 * u),
                            (a, y + 4.5 * u)], instant.ink(f"@{row['ramp']}", share), None, 0)
    elif row["k"] == "glyph":
        middle = x + width / 2 if row.get("centred") else x
        instant.stamp(painter, instant.glyph(row["g"], u), (middle, y))
    elif "size" in row:
        shaft, head = row["size"]
        fill = instant.ink(instant.out.styles[row["s"]][0])
        painter.simple(arrow((x, y), (x + width, y), shaft * u, head * u), fill, None, 0)
    else:
        painter.line([(x, y), (x + width, y)], INK, 1.6 * u)
        for end in (x, x + width):
            painter.line([(end, y - 4 * u), (end, y + 4 * u)], INK, 1.6 * u)


class Picture:
    """A picture of a run at any time, laid out; painters paint it.

    ``size`` [pixels] and ``view`` are by default the scene's; ``note`` is beside the time; ``unit``
    is pixels per point. ``bare`` leaves out title, time and legend; ``scales`` keeps the scales of
    the legend. ``least`` is the smallest type [pixels, as a typesetter counts it]. Only some
    ``moments`` [s] may be painted.
    """

    def __init__(self, run: Samples, *, size: tuple[int, int] | None = None,
                 view: View | None = None, note: str = "", unit: float | None = None,
                 bare: bool = False, scales: bool = False, least: int = 0,
                 moments: Sequence[float] | None = None) -> None:
        self.run, self.view = run, view or run.mechanism.view
        self.size = size or self.view.size
        self.unit = unit or picture_unit(self.size)
        self.note, self.moments = note, moments
        self.bare = bare or scales
        self.small = self.size[0] < SMALL and not least
        self.type = Typesetter(type_size(self.unit), least)
        self.label_size = max(MIN_TYPE, self.type.scaled(1.1))
        self.row, self.pad = round(1.5 * self.type.size), round(0.8 * self.type.size)
        self._instants: dict[int, Instant] = {}
        view, mechanism, (width, height) = self.view, run.mechanism, self.size
        room = width - 3 * self.pad - self.type.width(self.stamp(float(run.time[-1])))
        self.title = None if self.bare else Headline.of(
            mechanism.title or mechanism.name, self.type, room,
            self.type.scaled(1.0 if self.small else 1.25), height)
        self.head = self.title.high if self.title else 0
        self.panel = panel = MeterPanel(run, view, self.type, self.unit, self.size)
        bodies = bounds.body_box(run, view, moments)
        guess = bounds.place_camera(
            bodies, Rectangle(0, 0, width, max(8, height - self.head - self.row)),
            centre=view.centre, width=view.width)
        self.subject = subject_of(run, view, point=self.unit / guess.scale, moments=moments,
                                  width=bounds.width_shown(bodies, width / height, view.width))
        self.out = self.subject.out
        self.box = bounds.whole_box(self.out, run, bodies, view, moments)
        most = 0 if bare and not scales else 4 if least else 2  # rows of the legend
        rows = min(1, most)
        for _ in range(3):
            self._place_camera(rows * self.row + (self.pad if rows else 0))
            self.legend = arrange(self.out.legend, self.camera.scale, self.type, self.unit,
                                  width - 2 * self.pad, most, scales=scales)
            if len(self.legend) <= rows:
                break
            rows = len(self.legend)
        gap = self.pad // 2 if self.legend or not self.bare else 0
        self.foot = max(height - len(self.legend) * self.row - gap, self.head + 2)
        bottom = self.foot - gap
        beside, below = (panel.beside, 0) if self.aside else (0, panel.below)
        low = max(self.head + 1, bottom - below)
        self.stage = Rectangle(0, self.head, width - beside, low)
        panel.settle(pygame.Rect(width - beside, self.head, beside, bottom - self.head)
                     if self.aside else pygame.Rect(0, low, width, below), aside=self.aside)
        if "coordinates" in self.subject.layers:
            lines = grid(self.out, self.camera, self.stage, self.unit)
            self.out.items = [*(i for i in lines if i["k"] == "line"), *self.out.items,
                              *(i for i in lines if i["k"] == "text")]

    def _place_camera(self, foot: int) -> None:
        """Place the meters below or beside the motion, where it is larger."""
        (width, height), panel, given = self.size, self.panel, self.view.width
        high = height - self.head - foot
        if self.small:  # the mechanism comes first
            wide, tall = self.box.size
            panel.limit(high - round(min(0.75 * height, 1.1 * width * tall / max(wide, 1e-9))))

        def camera_on(wide: float, tall: float) -> Camera:
            seen = given if given is None else given * max(
                1.0, max(8, high) * wide / (width * tall))
            return bounds.place_camera(self.box, Rectangle(0, self.head, wide, self.head + tall),
                                       centre=self.view.centre, width=seen)

        self.camera, self.aside = camera_on(width, max(8, high - panel.below)), False
        if panel and not self.small and panel.tall <= high:
            beside = camera_on(max(8, width - panel.beside), high)
            if beside.scale > self.camera.scale:
                self.camera, self.aside = beside, True

    @property
    def needs(self) -> float:
        """The height at which the mechanism fills the picture's width [pixels]."""
        view = self.view
        wide, high = view.size if view.centre and view.width else self.box.size
        share = high / max(wide, 1e-9)
        around = self.head + self.panel.below + (
            len(self.legend) * self.row + self.pad if self.legend else 0)
        return around + self.size[0] * float(np.clip(share, *SHAPES))

    def stamp(self, t: float) -> str:
        """The time, after the note."""
        note = f"{self.note}   " if self.note else ""
        return f"{note}t = {min(t, float(self.run.time[-1])):.3f} s"

    def instant(self, enlarge: int) -> Instant:
        """The list for a picture that is painted so many times larger, with its labels placed."""
        if not self._instants:  # labels add columns to the list
            few = None if self.moments is None else nearest(self.run.time, self.moments)
            place_labels(self.out, self.camera, self.unit, self.size, self.stage, self.type,
                         self.label_size, speed=self.view.speed, samples=few)
        if enlarge not in self._instants:
            width, height = self.size
            self._instants[enlarge] = Instant(
                self.out, self.camera.enlarged(enlarge), self.unit * enlarge,
                (width * enlarge, height * enlarge), enlarge=enlarge, small=self.small)
        return self._instants[enlarge]

    def surround(self, painter: Painter, instant: Instant) -> None:
        """Paint title, legend and the constant part of the meters."""
        k, width = painter.enlarge, self.size[0]
        if self.legend and not self.bare:
            y = (self.foot - self.pad // 2) * k
            painter.line([(self.pad * k, y), ((width - self.pad) * k, y)], HAIRLINE, self.unit * k)
        draw_legend(painter, instant, self.legend, self.type, self.unit, self.pad, self.foot,
                    self.row)
        if self.title:
            self.title.write(painter, self.type, self.pad)
        self.panel.draw_still(painter)

    def write_stamp(self, painter: Painter, t: float) -> None:
        """Write the time in the header."""
        if not self.bare:
            words, line = self.stamp(t), round(HEAD * self.type.size)
            painter.write((self.size[0] - self.pad - self.type.width(words),
                           (line - self.type.height(self.type.size)) // 2 + 1), words,
                          self.type.size, FAINT_INK)

    def write_labels(self, painter: Painter, instant: Instant) -> None:
        """Write the numbers of the grid, and the labels that have a place."""
        for item, at in instant.texts:
            if "edge" in item:
                x, y = (v * instant.factor for v in instant.points[at])
                half = self.type.half(item["words"], self.label_size)
                middle = (x, self.stage.y1 - half[1] - 1) if item["edge"] == 0 else (
                    self.stage.x0 + half[0] + 3, y)
                painter.text(middle, item["words"], self.label_size, FAINT_INK, ())
        point = self.unit
        for label in instant.labels():
            if label.side < 0 or not within([label.point], instant.edges):
                continue
            x, y = (v * instant.factor for v in label.point)
            clear = label.item.get("clear", 0.0)
            dx, dy = offset(label.side, self.type.half(label.words, self.label_size), clear, point)
            ux, uy, far = SIDES[label.side]
            leader = [(x + ux * away * point, y - uy * away * point)
                      for away in (2, far + 2 + clear)] if far else []
            painter.text((x + dx, y + dy), label.words, self.label_size, label.ink, leader)

    def paint_stage(self, paper: Paper, t: float) -> Instant:
        """Paint the mechanism with its labels at a time [s]."""
        instant = self.instant(1)
        instant.go_to(t)
        paper.clip(self.stage)
        instant.paint(paper)
        paper.clip(None)
        return instant

    def paint(self, paper: Paper, t: float) -> None:
        """Paint all of it at a time [s]."""
        instant = self.paint_stage(paper, t)
        self.surround(paper, instant)
        self.write_labels(paper, instant)
        self.panel.draw(paper, [t])
        self.write_stamp(paper, t)


class Strip:
    """Pictures at ``times`` [s] in rows above their times, with title, meters and legend."""

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
                    return
            return
        most = max(1, int(paper.width / NARROWEST)) if paper else 6
        down = math.ceil(len(times) / most)
        across = math.ceil(len(times) / down)
        wide = paper.pixels[0] // across if paper else round(
            view.size[0] * max(MIN_WIDTH, 1 / across))
        shape = view.size[1] / view.size[0] if view.width and view.centre else float(
            np.clip(height / (view.width or max(width, 1e-9)), *STRIP_SHAPES))
        pane = wide, round(wide * shape)
        whole = across * wide, down * (pane[1] + round(3 * TYPE * unit)) + round(6 * TYPE * unit)
        inside = unit
        if not paper:
            inside = max(unit, INSIDE * picture_unit(whole))
            unit = max(unit, picture_unit(whole))
        self._surround(unit, (whole[0], 10 * whole[0]))
        self._lay_out(across, pane, inside, None)

    def _picture(self, size: tuple[int, int], unit: float) -> Picture:
        view = self.view.model_copy(update={"meters": ()})
        return Picture(self.run, size=size, view=view, unit=unit, bare=True, moments=self.times,
                       least=self.least)

    def _surround(self, unit: float, size: tuple[int, int]) -> None:
        self.unit, self.type = unit, Typesetter(type_size(unit), self.least)
        self.pad, self.line = round(0.8 * self.type.size), round(1.6 * self.type.size)
        title = self.run.mechanism.title or self.run.mechanism.name
        self.title = Headline.of(title, self.type, size[0] - 2 * self.pad, self.type.scaled(1.2),
                                 size[1]) if self.titled else None
        self.head = self.title.high if self.title else 0
        self.panel = MeterPanel(self.run, self.view, self.type, unit, size, len(self.times))

    def _fitted(self, width: float, height: float, size: tuple[int, int],
                rows: int) -> tuple[int, tuple[int, int]]:
        """Pictures in a row, and the size of one, for which a width and height [m] are largest."""
        best, found, count = 0.0, None, len(self.times)
        free = size[1] - self.head - self.panel.below - (
            rows * self.line + self.pad if self.keyed else 0)
        for down in range(1, count + 1):
            across = math.ceil(count / down)
            wide, high = size[0] // across, free // down - self.line - self.pad
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
        self.legend = arrange(self.pane.out.legend, self.pane.camera.scale, self.type, self.unit,
                              width - 2 * self.pad, 8 if self.keyed else 0, scales=self.scales)
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
        """Times below the pictures and a size of type [pixels], so that they fit in ``room``."""
        least = max(MIN_TYPE, self.type.least)
        forms = ("t = {:.3f} s", "{:.3f} s", "{:.1f} s")
        for size in range(self.type.size, least - 1, -1):
            for texts in ([form.format(t) for t in self.times] for form in forms):
                if len(set(texts)) == len(set(self.times)) and max(
                        self.type.width(text, size) for text in texts) <= room:
                    return texts, size
        return [ellipsis(self.type, f"{t:.3g} s", room, least) for t in self.times], least
