"""Meters in the picture: quantities as small plots with a cursor of time, or as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import takewhile

import numpy as np
import pygame

from sandbox.figure.style import COLOURS, shown_as
from sandbox.model.meters import curves
from sandbox.numeric import Array, Integers
from sandbox.picture import palette
from sandbox.picture.listing import read_curve
from sandbox.picture.palette import Colour, Painter
from sandbox.picture.scales import round_length
from sandbox.picture.typesetter import Typesetter, ellipsis
from sandbox.samples.samples import Samples
from sandbox.scene.settings import ShownMeter, View
from sandbox.values.appearance import rgb
from sandbox.values.expressions import is_expression

WIDE, PLOT, TALLEST = 236.0, 58.0, 120.0
"""Width of a meter, height of its curve (min., max.) [points]."""
TITLE, VALUE, SMALL, TICK = 0.95, 1.4, 0.95, 0.85  # sizes of type, in those of the legend
HUES: tuple[Colour, ...] = tuple(map(rgb, COLOURS))


class Meter:
    """A meter of a run: its curves as shown, [curves, n], and its place [finished pixels]."""

    cell = plot = pygame.Rect(0, 0, 0, 0)  # all of it; its curves
    size = wide = across = head = 0  # of values: type, width, columns; height above the curves
    pieces: Sequence[Sequence[tuple[Integers, Array]]] = ()  # of the curves, see _pieces()

    def __init__(self, run: Samples, meter: ShownMeter) -> None:
        names = curves(meter, run.catalogue)
        rows = np.array([read_curve(run, name) for name in names]).reshape(-1, len(run.time))
        unit = next((run.unit(name) for name in names if not is_expression(name)), meter.unit)
        scaled = rows if meter.range is None else np.array(meter.range)
        factor, unit = shown_as(unit, *np.atleast_2d(scaled))
        self.sign = "°" if unit == "deg" else f" {unit}".replace("^2", "²").replace("^3", "³")
        self.values = factor * rows
        self.low, self.high = _range(self.values) if meter.range is None else (
            factor * meter.range[0], factor * meter.range[1])
        self.names, title = _apart(names) if len(names) > 1 else ([""], names[0])
        self.title = meter.title or title
        self.plotted = meter.style == "plot" and len(run.time) > 1

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

    def down(self, values: Array) -> Array:
        """Heights of values in the picture."""
        share = (values - self.low) / (self.high - self.low)
        return np.asarray(self.plot.bottom - self.plot.height * np.clip(share, -0.02, 1.02))


def _range(values: Array) -> tuple[float, float]:
    """Round limits of a plot about all values, with 0 if that is near."""
    found = values[np.isfinite(values)]
    low, high = (float(found.min()), float(found.max())) if len(found) else (0.0, 0.0)
    span = high - low
    flat = span <= 1e-9 * max(abs(low), abs(high))
    low = min(low, 0.0) if flat or low < span else low
    high = max(high, 0.0) if flat or high > -span else high
    if low == high:
        return 0.0, 1.0
    step = round_length((high - low) / 2)
    low, high = math.floor(low / step + 1e-6), math.ceil(high / step - 1e-6)
    return step * low, step * max(high, low + 1)


def _apart(names: Sequence[str]) -> tuple[list[str], str]:
    """The words in which names differ, and a pattern of them all for a title."""
    words = [name.split(".") for name in names]
    fewest = min(map(len, words))
    first = min(_alike(words), fewest - 1)
    last = min(_alike([each[::-1] for each in words]), fewest - 1 - first)
    begin = _alike(names)
    rest = names[0][begin:]
    end = rest[len(rest) - _alike([name[begin:][::-1] for name in names]):]
    title = f"{names[0][:begin]}*{end}" if begin or end else ", ".join(names)
    return [".".join(each[first:len(each) - last]) for each in words], title


def _alike(sequences: Sequence[Sequence[str]]) -> int:
    """Length of the common start."""
    return sum(1 for _ in takewhile(lambda each: len(set(each)) == 1,
                                    zip(*sequences, strict=False)))


class MeterPanel:
    """The meters of a picture; the last ones are left out if there is no room."""

    def __init__(self, run: Samples, view: View, type_: Typesetter, unit: float,
                 size: tuple[int, int], moments: int = 1) -> None:
        """``size`` is that of the picture [pixels], ``moments`` the number of instants shown."""
        self._time, self.type, self.unit, self.moments = run.time, type_, unit, moments
        self._plot_points, self.gap, self.margin = PLOT, round(0.9 * type_.size), round(5 * unit)
        self._start, self._end = min(view.start, float(run.time[-1])), float(run.time[-1])
        found = [Meter(run, meter) for meter in view.meters]
        for meter in found:
            count = len(meter.names)
            meter.size = type_.scaled(VALUE if count == 1 else SMALL)
            largest = np.nan_to_num(np.abs(meter.values), posinf=0.0).max(axis=1, keepdims=True)
            meter.wide = self.gap + max(type_.width(text, meter.size)
                                        for text in self._texts(meter, np.tile(-largest, moments)))
            meter.across = min(max(1, int((WIDE * unit + self.gap) / meter.wide)), count)
            meter.head = (type_.scaled(TITLE, 1.2) + self.margin
                          + -(-count // meter.across) * round(0.95 * meter.size))
        most = max(1, int((size[0] - self.gap) / (WIDE * unit + self.gap)))
        each = -(-len(found) // max(1, -(-len(found) // most)))  # rows as even as can be
        self._rows = [found[k:k + each] for k in range(0, len(found), max(1, each))]
        self.limit(0.62 * size[1])  # most of a picture's height that meters below the motion take
        self.rect = pygame.Rect(0, 0, 0, 0)

    def __bool__(self) -> bool:
        return bool(self.meters)

    def _texts(self, meter: Meter, values: Array) -> list[str]:
        """Values with names, or names only where there are too many."""
        valued = not meter.plotted or 1 in (self.moments, len(meter.names))
        return meter.texts(values) if valued else meter.names

    def _height(self, meter: Meter) -> int:
        return meter.head + (round(self._plot_points * self.unit) + self.type.scaled(TICK, 1.2)
                             if meter.plotted else 0)

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
        """Leave out curves, then rows, so that a height [pixels] below the motion suffices."""
        while self._rows and self.below > height:
            if not any(meter.plotted for meter in self._rows[-1]):
                self._rows.pop()
            else:
                for meter in self._rows[-1]:
                    meter.plotted = False
        self.meters = [meter for row in self._rows for meter in row]

    def settle(self, rect: pygame.Rect, *, aside: bool) -> None:
        """Set its place on the finished picture."""
        self.rect, gap, y = rect, self.gap, rect.top
        if aside and (plots := sum(meter.plotted for meter in self.meters)):
            free = (rect.height - self.tall) / self.unit / plots
            self._plot_points = min(TALLEST, PLOT + max(0.0, free))
        for row in [[meter] for meter in self.meters] if aside else self._rows:
            wide = (rect.width - gap * (len(row) + 1)) // len(row)
            high = max(map(self._height, row))
            for k, meter in enumerate(row):
                x = rect.left + gap + k * (wide + gap)
                left = min(wide // 2, self.margin + max(
                    self.type.width(f"{limit:.6g}", self.type.scaled(TICK))
                    for limit in (meter.low, meter.high)))
                meter.cell = pygame.Rect(x, y, wide, high)
                meter.plot = pygame.Rect(x + left, y + meter.head, wide - left - self.margin,
                                         round(self._plot_points * self.unit))
                across = self._across(meter.plot, self._time)
                first = int(np.searchsorted(self._time, self._start))
                meter.pieces = [list(_pieces(across, meter.down(row), first))
                                for row in meter.values]
            y += high + gap

    def draw_still(self, painter: Painter) -> None:
        """Paint titles, frames and pale curves."""
        size = self.type.scaled(TITLE)
        for meter in self.meters:
            cell = meter.cell
            painter.write((cell.left, cell.top),
                          ellipsis(self.type, meter.title, cell.width, size), size, palette.INK)
            if meter.plotted:
                self._frame(painter, meter)
                for k in range(len(meter.values)):
                    self._curve(painter, meter, k, palette.lighter(HUES[k], 0.62), 1.2)

    def draw(self, painter: Painter, times: Sequence[float]) -> None:
        """Paint values, and curves up to a time [s] with its cursor, or with several cursors."""
        samples = [int(np.argmin(np.abs(self._time - t))) for t in times]
        k, line = painter.enlarge, self.unit * painter.enlarge
        for meter in self.meters:
            cell, plot = meter.cell, meter.plot
            size = min(meter.size, self.type.scaled(VALUE if len(samples) == 1 else SMALL))
            top = cell.top + self.type.scaled(TITLE, 1.2)
            for curve, text in enumerate(self._texts(meter, meter.values[:, samples])):
                row, column = divmod(curve, meter.across)
                painter.write((cell.left + column * meter.wide, top + row * round(0.95 * size)),
                              ellipsis(self.type, text, cell.width, size), size, HUES[curve])
            if not meter.plotted:
                continue
            across = (self._across(plot, np.asarray(times)) * k).tolist()
            for x in across:
                painter.line([(x, plot.top * k), (x, plot.bottom * k)], palette.FAINT_INK, line)
            for curve, hue in zip(range(len(meter.values)), HUES, strict=False):
                self._curve(painter, meter, curve, hue, 1.9,
                            until=samples[0] + 1 if len(samples) == 1 else None)
                heights = meter.down(meter.values[curve, samples]).tolist()
                for x, y in zip(across, heights, strict=True):
                    if math.isfinite(y):
                        painter.disc((x, y * k), 3.6 * line, hue, palette.BACKGROUND, 1.2 * line)

    def _across(self, plot: pygame.Rect, time: Array) -> Array:
        share = (time - self._start) / max(self._end - self._start, 1e-12)
        return np.asarray(plot.left + plot.width * np.clip(share, 0.0, 1.0))

    def _frame(self, painter: Painter, meter: Meter) -> None:
        """Lines at the lowest value, the highest and 0, with numbers; the ends of time."""
        k, size, line = painter.enlarge, self.type.scaled(TICK), self.unit * painter.enlarge
        plot = meter.plot
        for value in {meter.low, meter.high, min(max(meter.low, 0.0), meter.high)}:
            y, text = float(meter.down(np.array(value))), f"{value:.6g}"
            painter.line([(plot.left * k, y * k), (plot.right * k, y * k)], palette.HAIRLINE, line)
            if value in (meter.low, meter.high):
                painter.write((plot.left - self.margin - self.type.width(text, size),
                               round(y - self.type.height(size) / 2)), text, size,
                              palette.FAINT_INK)
        painter.line([(plot.left * k, plot.top * k), (plot.left * k, plot.bottom * k)],
                     palette.FAINT_INK, line)
        for share, t in ((0.0, self._start), (1.0, self._end)):
            text = f"{t:.3g} s"
            painter.write((round(plot.left + share * (plot.width - self.type.width(text, size))),
                           plot.bottom + round(2 * self.unit)), text, size, palette.FAINT_INK)

    def _curve(self, painter: Painter, meter: Meter, curve: int, colour: Colour, line: float,
               until: int | None = None) -> None:
        for samples, points in meter.pieces[curve]:
            kept = None if until is None else int(np.searchsorted(samples, until))
            path = [(px, py) for px, py in (painter.enlarge * points[:kept]).tolist()]
            if len(path) > 1:
                painter.line(path, colour, line * self.unit * painter.enlarge)


def _pieces(x: Array, y: Array, first: int) -> Iterator[tuple[Integers, Array]]:
    """The parts of a curve with values from a sample on: samples, points [n, 2].

    Of many samples in a column of pixels these are the minimum and maximum.
    """
    there = np.isfinite(y) & (np.arange(len(y)) >= first)
    edges = np.flatnonzero(np.diff(there, prepend=False, append=False)).tolist()
    for start, end in zip(edges[::2], edges[1::2], strict=True):
        count = 1 + int((x[end - 1] - x[start]) / 1.5)
        of = np.arange(start, end)
        if end - start > 4 * count:
            of = np.unique([k for part in np.array_split(of, count) for k in (
                part[0], part[-1], part[y[part].argmin()], part[y[part].argmax()])])
        yield of, np.column_stack((x, y))[of]
