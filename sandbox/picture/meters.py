"""Meters in the picture: quantities as small plots with a cursor of time, or as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import takewhile
from typing import NamedTuple

import numpy as np
import pygame

from sandbox.figure.style import COLOURS, shown_as
from sandbox.model.meters import curves, is_expression
from sandbox.numeric import Array
from sandbox.picture import palette
from sandbox.picture.listing import read_curve
from sandbox.picture.palette import Colour, Painter
from sandbox.picture.scales import pressure_unit, round_up
from sandbox.picture.typesetter import Typesetter, ellipsis
from sandbox.samples.samples import Samples
from sandbox.scene.settings import View

WIDE, PLOT, TALLEST = 236.0, 58.0, 120.0
"""Width of a meter, height of its curve (min., max.) [points]."""
TITLE, VALUE, SMALL, TICK = 0.95, 1.4, 0.95, 0.85  # sizes of type, in those of the legend
HUES: tuple[Colour, ...] = tuple(map(palette.from_css, COLOURS))


class Dial(NamedTuple):
    """Data of one meter."""

    title: str
    names: list[str]  # of the curves, as far as they differ; empty of a single one
    values: Array  # as shown, [curves, n]
    sign: str  # after values
    low: float  # lower limit of the plot, as shown
    high: float
    plotted: bool

    def texts(self, shown: Array) -> list[str]:
        """Some values of each curve [curves, k] with units and as many digits as the largest."""
        largest = float(np.nanmax(np.abs(self.values), initial=0.0))
        digits = min(max(0, 2 - math.floor(math.log10(largest))), 6) if largest else 0
        form = f".{digits}f" if not largest or 1e-4 <= largest < 1e6 else ".2e"
        found = []
        for name, values in zip(self.names, shown.tolist(), strict=True):
            words = ", ".join(f"{value:z{form}}" if math.isfinite(value) else "none"
                              for value in values)
            words += self.sign if any(map(math.isfinite, values)) else ""
            found.append(f"{name} {words}".strip())
        return found


def dials(run: Samples, view: View) -> list[Dial]:
    """Data of the meters of a view."""
    found = []
    for meter in view.meters:
        names = curves(meter, run.catalogue)
        rows = np.array([read_curve(run, name) for name in names]).reshape(-1, len(run.time))
        unit = next((run.unit(name) for name in names if not is_expression(name)), meter.unit)
        scaled = rows if meter.range is None else np.array(meter.range)
        if unit == "Pa":  # in the unit of the drawing; other quantities in those of plots
            largest = float(np.nanmax(np.abs(scaled), initial=0.0))
            size, name = pressure_unit(round_up(largest) if largest > 0 else 0.0)
            factor, sign = 1 / size, f" {name}"
        else:
            shown = shown_as(unit, *np.atleast_2d(scaled))
            factor, sign = shown.factor, shown.sign.replace("^2", "²").replace("^3", "³")
        values = factor * rows
        low, high = _range(values) if meter.range is None else (
            factor * meter.range[0], factor * meter.range[1])
        own, rest = _apart(names) if len(names) > 1 else ([""], names[0])
        found.append(Dial(meter.title or rest, own, values, sign, low, high,
                          meter.style == "plot" and len(run.time) > 1))
    return found


def _range(values: Array) -> tuple[float, float]:
    """Round limits of a plot about all values, with 0 if that is near."""
    found = values[np.isfinite(values)]
    low, high = (float(found.min()), float(found.max())) if len(found) else (0.0, 0.0)
    span = high - low
    if 0 < low < span:
        low = 0.0
    if -span < high < 0:
        high = 0.0
    if span <= 1e-9 * max(abs(low), abs(high)):
        low, high = min(low, 0.0), max(high, 0.0)
    if low == high:
        return 0.0, 1.0
    span = high - low
    step = 10.0 ** math.floor(math.log10(span / 2))
    step *= 5 if span / step > 10 else 2 if span / step > 5 else 1
    low, high = math.floor(low / step + 1e-6), math.ceil(high / step - 1e-6)
    return step * low, step * max(high, low + 1)


def _apart(names: Sequence[str]) -> tuple[list[str], str]:
    """The words in which names differ, and a pattern of them all for a title."""
    words = [name.split(".") for name in names]
    least = min(map(len, words))
    first = next((k for k in range(least) if len({w[k] for w in words}) > 1), least - 1)
    last = next((k for k in range(least - first) if len({w[-1 - k] for w in words}) > 1), 0)
    begin = _begin(names)
    end = _begin([name[len(begin):][::-1] for name in names])[::-1]
    title = f"{begin}*{end}" if begin or end else ", ".join(names)
    return [".".join(w[first:len(w) - last]) for w in words], title


def _begin(names: Sequence[str]) -> str:
    same = takewhile(lambda each: len(set(each)) == 1, zip(*names, strict=False))
    return "".join(each[0] for each in same)


class _Meter:
    """A meter in a picture [finished pixels]."""

    cell = plot = pygame.Rect(0, 0, 0, 0)  # all of it; its curves

    def __init__(self, dial: Dial, panel: MeterPanel, moments: int) -> None:
        type_, gap = panel.type, panel.gap
        self.dial = dial
        self.valued = not dial.plotted or 1 in (moments, len(dial.names))  # else names only
        self.size = type_.scaled(VALUE if len(dial.names) == 1 else SMALL)
        sizes = np.nan_to_num(np.abs(dial.values), posinf=0.0).max(axis=1)
        words = dial.texts(np.tile(-sizes[:, None], moments)) if self.valued else dial.names
        self.wide = max(type_.width(text, self.size) for text in words) + gap
        count = max(1, int((WIDE * panel.unit + gap) / self.wide))
        self.across = min(count, len(dial.names))  # values side by side
        self.head = (type_.scaled(TITLE, 1.2) + panel.margin
                     + -(-len(dial.names) // self.across) * round(0.95 * self.size))

    def down(self, values: Array) -> Array:
        share = (values - self.dial.low) / (self.dial.high - self.dial.low)
        return np.asarray(self.plot.bottom - self.plot.height * np.clip(share, -0.02, 1.02))


class MeterPanel:
    """The meters of a picture; the last ones are left out if there is no room."""

    def __init__(self, run: Samples, view: View, type_: Typesetter, unit: float,
                 size: tuple[int, int], moments: int = 1) -> None:
        """``size`` is that of the picture [pixels], ``moments`` the number of instants shown."""
        self._time, self.type, self.unit = run.time, type_, unit
        self._plot_points, self.gap, self.margin = PLOT, round(0.9 * type_.size), round(5 * unit)
        self._start, self._end = min(view.start, float(run.time[-1])), float(run.time[-1])
        found = [_Meter(dial, self, moments) for dial in dials(run, view)]
        most = max(1, int((size[0] - self.gap) / (WIDE * unit + self.gap)))
        each = -(-len(found) // max(1, -(-len(found) // most)))  # rows as even as can be
        self._rows = [found[k:k + each] for k in range(0, len(found), max(1, each))]
        self.limit(0.62 * size[1])  # most of a picture's height that meters below the motion take
        self.rect = pygame.Rect(0, 0, 0, 0)

    def __bool__(self) -> bool:
        return bool(self.meters)

    def _height(self, meter: _Meter) -> int:
        return meter.head + (round(self._plot_points * self.unit) + self.type.scaled(TICK, 1.2)
                             if meter.dial.plotted else 0)

    @property
    def below(self) -> int:
        """Its height below the motion."""
        return sum(max(map(self._height, row)) + self.gap for row in self._rows)

    @property
    def beside(self) -> int:
        """Its width beside the motion."""
        return round(WIDE * self.unit) + 2 * self.gap

    @property
    def tall(self) -> int:
        """Its height beside the motion."""
        return sum(self._height(meter) + self.gap for meter in self.meters)

    def limit(self, height: float) -> None:
        """Leave out the last rows that do not fit in a height [pixels] below the motion."""
        while self._rows and self.below > height:
            self._rows.pop()
        self.meters = [meter for row in self._rows for meter in row]

    def settle(self, rect: pygame.Rect, *, aside: bool) -> None:
        """Set its place on the finished picture."""
        self.rect, gap, y = rect, self.gap, rect.top
        if aside and (plots := sum(meter.dial.plotted for meter in self.meters)):
            free = (rect.height - self.tall) / self.unit / plots
            self._plot_points = min(TALLEST, PLOT + max(0.0, free))
        for row in [[meter] for meter in self.meters] if aside else self._rows:
            wide = (rect.width - gap * (len(row) + 1)) // len(row)
            high = max(map(self._height, row))
            for k, meter in enumerate(row):
                x = rect.left + gap + k * (wide + gap)
                axis = self.margin + max(self.type.width(f"{limit:.6g}", self.type.scaled(TICK))
                                         for limit in (meter.dial.low, meter.dial.high))
                left = min(wide // 2, axis)
                meter.cell = pygame.Rect(x, y, wide, high)
                meter.plot = pygame.Rect(x + left, y + meter.head, wide - left - self.margin,
                                         round(self._plot_points * self.unit))
            y += high + gap

    def draw_still(self, painter: Painter) -> None:
        """Paint titles, frames and pale curves."""
        size = self.type.scaled(TITLE)
        for meter in self.meters:
            cell, dial = meter.cell, meter.dial
            painter.write((cell.left, cell.top),
                          ellipsis(self.type, dial.title, cell.width, size), size, palette.INK)
            if dial.plotted:
                self._frame(painter, meter)
                for k in range(len(dial.values)):
                    self._curve(painter, meter, k, palette.lighter(HUES[k], 0.62), 1.2)

    def draw(self, painter: Painter, times: Sequence[float]) -> None:
        """Paint values, and curves up to a time [s] with its cursor, or with several cursors."""
        samples = [int(np.argmin(np.abs(self._time - t))) for t in times]
        for meter in self.meters:
            dial, plot = meter.dial, meter.plot
            self._values(painter, meter, samples)
            if not dial.plotted:
                continue
            k, line = painter.enlarge, self.unit * painter.enlarge
            across = (self._across(plot, np.asarray(times)) * k).tolist()
            for x in across:
                painter.line([(x, plot.top * k), (x, plot.bottom * k)], palette.FAINT_INK, line)
            for curve, hue in zip(range(len(dial.values)), HUES, strict=False):
                self._curve(painter, meter, curve, hue, 1.9,
                            until=samples[0] + 1 if len(samples) == 1 else None)
                heights = meter.down(dial.values[curve, samples]).tolist()
                for x, y in zip(across, heights, strict=True):
                    if math.isfinite(y):
                        painter.disc((x, y * k), 3.6 * line, hue, palette.BACKGROUND, 1.2 * line)

    def _across(self, plot: pygame.Rect, time: Array) -> Array:
        share = (time - self._start) / max(self._end - self._start, 1e-12)
        return np.asarray(plot.left + plot.width * np.clip(share, 0.0, 1.0))

    def _frame(self, painter: Painter, meter: _Meter) -> None:
        """Lines at the lowest value, the highest and 0, with numbers; the ends of time."""
        k, size, line = painter.enlarge, self.type.scaled(TICK), self.unit * painter.enlarge
        dial, plot = meter.dial, meter.plot
        for value in (dial.low, dial.high, 0.0) if dial.low < 0 < dial.high else (
                dial.low, dial.high):
            y, text = float(meter.down(np.array(value))), f"{value:.6g}"
            painter.line([(plot.left * k, y * k), (plot.right * k, y * k)], palette.HAIRLINE, line)
            if value in (dial.low, dial.high):
                painter.write((plot.left - self.margin - self.type.width(text, size),
                               round(y - self.type.height(size) / 2)), text, size,
                              palette.FAINT_INK)
        painter.line([(plot.left * k, plot.top * k), (plot.left * k, plot.bottom * k)],
                     palette.FAINT_INK, line)
        for share, t in ((0.0, self._start), (1.0, self._end)):
            text = f"{t:.3g} s"
            painter.write((round(plot.left + share * (plot.width - self.type.width(text, size))),
                           plot.bottom + round(2 * self.unit)), text, size, palette.FAINT_INK)

    def _curve(self, painter: Painter, meter: _Meter, curve: int, colour: Colour, points: float,
               until: int | None = None) -> None:
        of = slice(int(np.searchsorted(self._time, self._start)), until)
        for x, y in _pieces(self._across(meter.plot, self._time[of]),
                            meter.down(meter.dial.values[curve, of])):
            if len(x) > 1:
                path = [(px, py) for px, py in (painter.enlarge * np.column_stack((x, y))).tolist()]
                painter.line(path, colour, points * self.unit * painter.enlarge)

    def _values(self, painter: Painter, meter: _Meter, samples: Sequence[int]) -> None:
        """Values of all curves in columns, each in its colour, or their names."""
        cell, dial = meter.cell, meter.dial
        size = meter.size if len(samples) == 1 else min(meter.size, self.type.scaled(SMALL))
        top = cell.top + self.type.scaled(TITLE, 1.2)
        for k, text in enumerate(dial.texts(dial.values[:, samples]) if meter.valued
                             else dial.names):
            row, column = divmod(k, meter.across)
            painter.write((cell.left + column * meter.wide, top + row * round(0.95 * size)),
                          ellipsis(self.type, text, cell.width, size), size, HUES[k])


def _pieces(x: Array, y: Array) -> Iterator[tuple[Array, Array]]:
    """The parts of a curve with values; of many points in a column the minimum and maximum."""
    there = np.isfinite(y)
    edges = np.flatnonzero(np.diff(there, prepend=False, append=False)).tolist()
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        column = np.floor(x[start:end] / 1.5)
        first = np.flatnonzero(np.r_[True, column[1:] != column[:-1]]).tolist()
        if end - start <= 4 * len(first):
            yield x[start:end], y[start:end]
            continue
        kept = [start, end - 1]
        for a, b in zip(first, [*first[1:], end - start], strict=True):
            kept += [start + a + int(np.argmin(y[start + a:start + b])),
                     start + a + int(np.argmax(y[start + a:start + b]))]
        of = np.unique(kept)
        yield x[of], y[of]
