"""Common style of all figures: sizes, colours, fonts, numbers, output files.

Fonts are 7 to 9.5 pt in a figure of 120 mm, a column and a half. So figures need no scaling in
print and stay readable at 400 pixels. ``matplotlib.figure.Figure`` is used without pyplot: no
display and no global state.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sandbox.atomic_files import atomic_file
from sandbox.numeric import Array, Flags
from sandbox.wording import printable

WIDTH = 120.0
"""Default width of a figure [mm]."""
MAX_LETTERS = 200
"""Longest text; more does not fit on a page."""
MM, MM_PER_POINT = 1 / 25.4, 25.4 / 72
"""Inches per millimetre, millimetres per typographic point."""
DPI = 200
TINY, SMALL, PLAIN, HEAD = 7, 8, 8.5, 9.5
"""Font sizes [pt]."""
LETTER, BOLD = 0.52, 0.62
"""Mean width of a letter, and of a bold letter, as a multiple of the font size."""
SAMPLE = 14.0
"""Width of a legend's line sample with the space around it [mm]."""
MAX_NAME = 60
"""Letters of a name in a legend."""
BLUE, ORANGE, GREEN, VIOLET = "#2f6690", "#d1742f", "#4f8a6b", "#8a5a9e"
OCHRE, SLATE, RED = "#9a7b3f", "#5b6673", "#b5485d"
COLOURS = (BLUE, ORANGE, GREEN, VIOLET, OCHRE, SLATE, RED)
"""Colours of curves, in this order; they differ in lightness as well as in hue."""
INK, QUIET, GREY, FAINT, BAND = "#222831", SLATE, "#a9b1bb", "#e3e6ea", "#dfe5ec"
"""Colours of text, notes, event lines, grid and shaded ranges."""
HOLDS = "#cfe0d6"
"""Colour of areas in which a condition holds."""
LINE = 1.5
"""Width of a curve [pt]."""
DASHES: tuple[Any, ...] = ("solid", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)))
"""Line styles, for more curves than colours."""
TARGET: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (4, 3))}
"""Line properties of targets."""
SUFFIXES = (".png", ".svg", ".pdf")
MANY_MM = 0.5
"""Lengths below this [m] are shown in millimetres."""


class Shown(NamedTuple):
    """How a quantity is shown: SI times ``factor``, in ``unit``."""

    factor: float
    unit: str
    sign: str
    """Suffix of a number: `` mm``, ``°``."""

    def label(self, name: str) -> str:
        """Label of an axis."""
        return (f"{name} [{self.unit}]" if self.unit else name).strip()


def shown_as(unit: str, *rows: Array) -> Shown:
    """Angles in degrees, lengths in mm if all are small, everything else in SI.

    Args:
        unit: SI unit, as in a recording.
        rows: values to be shown, SI, any shapes; NaN is ignored.
    """
    if unit in ("rad", "rad/s"):
        return Shown(180 / math.pi, unit.replace("rad", "deg"), "°" if unit == "rad" else " deg/s")
    if unit == "m" and all(np.nanmax(np.abs(row), initial=0.0) < MANY_MM for row in rows):
        return Shown(1e3, "mm", " mm")
    return Shown(1.0, "" if unit == "1" else unit, f" {unit}" if unit not in ("1", "") else "")


def number(value: float, digits: int = 4) -> str:
    """A number with so many significant digits, never in exponential notation.

    >>> number(16474.3), number(2.97136), number(5.0)
    ('16470', '2.971', '5')
    """
    if not math.isfinite(value):
        return "-"
    if value == 0:
        return "0"
    places = digits - 1 - math.floor(math.log10(abs(value)))
    text = f"{round(value, places):.{max(places, 0)}f}"
    return text.rstrip("0").rstrip(".") if "." in text else text


def hue(place: int) -> str:
    """Colour of the curve with this index; cyclic."""
    return COLOURS[place % len(COLOURS)]


def dash(place: int) -> Any:
    """Line style of the curve with this index: a new one when the colours start again."""
    return DASHES[place // len(COLOURS) % len(DASHES)]


def load() -> None:
    """Import matplotlib early, while the caller waits for something else."""
    import_module("matplotlib.figure")
    import_module("matplotlib.backends.backend_agg")


def new_figure(height: float, width: float = WIDTH) -> Any:
    """An empty figure; width and height in millimetres."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05, wspace=0.03, hspace=0.03)
    figure: Any = Figure(figsize=(width * MM, height * MM), dpi=DPI, layout=layout)
    # notebooks call this; matplotlib registers its own only once pyplot is loaded
    figure._repr_png_ = partial(_png, figure)
    return figure


def _png(figure: Any) -> bytes:
    """PNG for a notebook: coarser than a file, since a cell is some 900 pixels wide."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=0.75 * DPI, metadata={"Software": None})
    return file.getvalue()


def plain(text: str) -> str:
    """Printable text of limited length in which a dollar sign starts no formula."""
    lines = "\n".join(map(printable, text[:MAX_LETTERS].split("\n")))
    return lines.replace("$", r"\$")


def in_lines(text: str, width: float, size: float, letter: float = LETTER) -> str:
    """A plain text in lines of a width [mm] at a font size [pt]."""
    letters = int((width - 4.0) / (letter * size * MM_PER_POINT))
    return "\n".join(part for line in plain(text).split("\n")
                     for part in textwrap.wrap(line, letters))


def legend(where: Any, key: Sequence[tuple[str, Any]], width: float = 0.0, **how: Any) -> None:
    """A legend without a frame on a figure or axes.

    Args:
        where: figure or axes.
        key: names with their artists.
        width: in which its columns stand side by side [mm]; 0 for one column.
        how: options of matplotlib's ``legend``.
    """
    wide = LETTER * SMALL * MM_PER_POINT * max((len(name) for name, _ in key), default=0) + SAMPLE
    where.legend([artist for _, artist in key],
                 [plain(name if len(name) <= MAX_NAME else f"…{name[1 - MAX_NAME:]}")
                  for name, _ in key],
                 ncols=max(1, min(len(key), int(width / wide))),
                 **{"labelcolor": INK, "facecolor": "white", "edgecolor": "none", "borderpad": 0.2,
                    "framealpha": 0.85, "fontsize": SMALL, "handlelength": 1.8,
                    "labelspacing": 0.35, "columnspacing": 1.4, "alignment": "left", **how})


def apart(wanted: Array, gap: float) -> Array:
    """The nearest positions (least squares) that keep a gap and the order.

    Subtracting i·gap from the i-th position turns the constraint into monotonicity, which isotonic
    regression solves by pooling adjacent violators.

    Args:
        wanted: shape [n].
        gap: least distance.

    Returns:
        shape [n], in the order of ``wanted``.
    """
    from scipy.optimize import isotonic_regression

    order, steps = np.argsort(wanted, kind="stable"), gap * np.arange(len(wanted))
    result = np.empty(len(wanted))
    result[order] = isotonic_regression(wanted[order] - steps).x + steps
    return result


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure as PNG, SVG or PDF by the file's suffix; equal figures give equal bytes.

    Raises:
        OutputError: the file cannot be written.
        ValueError: another suffix.
    """
    import matplotlib

    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"a figure is written as {', '.join(SUFFIXES)}, not {suffix!r}")
    # without dates, versions and random ids
    metadata = {".png": {"Software": None}, ".svg": {"Date": None},
                ".pdf": {"CreationDate": None, "Producer": None, "Creator": None}}[suffix]
    with matplotlib.rc_context({"svg.hashsalt": "sandbox", "pdf.fonttype": 42}), \
            atomic_file(path) as aside:
        figure.savefig(aside, metadata=metadata)


NEAR = 0.012
"""Curves closer than this share of the axes' height coincide: about the width of a line."""
SHORT = 0.04
"""A shorter stretch, as a share of the axes' width, is a crossing."""
STROKE = 3.5
"""Length of each colour where curves coincide, as a multiple of the line width."""
MAX_POINTS = 2000
"""Approximate number of points of a curve that are compared."""


class Strand(NamedTuple):
    """A stretch of a curve."""

    first: int
    last: int
    """Inclusive: the next stretch begins here."""
    rank: int
    """Number of earlier curves that coincide here."""
    turns: int
    """Number of curves that coincide here, this one included."""


def take_apart(axes: Any, lines: Sequence[Any]) -> None:
    """Draw alternating colours where lines of axes coincide; the limits must be set."""
    lines = [line for line in lines if len(line.get_xdata()) > 1]
    to_axes = axes.transScale + axes.transLimits
    every = [max(1, len(line.get_xdata()) // MAX_POINTS) for line in lines]
    found = strands([tuple(to_axes.transform(line.get_xydata()[::step]).T)
                     for line, step in zip(lines, every, strict=True)])
    for line, step, parts in zip(lines, every, found, strict=True):
        points = np.asarray(line.get_xydata())
        for part in (part for part in parts if part.turns > 1):
            # where the next stretch begins the curves have parted already
            last = len(points) if part is parts[-1] else step * (part.last - 1) + 1
            # wider than the lines below, so that no gap shows between the colours
            axes.plot(*points[step * part.first:last].T, color=line.get_color(), zorder=2.5,
                      linewidth=1.2 * LINE, scalex=False, scaley=False, linestyle=(
                          STROKE * (part.turns - part.rank),
                          (STROKE, STROKE * (part.turns - 1))))


def strands(lines: Sequence[tuple[Array, Array]]) -> list[list[Strand]]:
    """Stretches in which each curve is alone or coincides with others.

    Args:
        lines: x and y, shape [n] each, n > 1, as shares of the axes' width and height. A curve
            whose x decreases coincides only with curves of the same x; a curve with values that
            are not finite coincides with none.
    """
    found = []
    forward = [bool((np.diff(x) > 0).all()) for x, _ in lines]
    finite = [bool(np.isfinite(x + y).all()) for x, y in lines]
    for i, (x, y) in enumerate(lines):
        count, rank = np.ones(len(x), dtype=int), np.zeros(len(x), dtype=int)
        way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(x)))))
        for j, (other_x, other_y) in enumerate(lines):
            same = np.array_equal(x, other_x)
            if j == i or not (finite[i] and finite[j]) or not (same or (forward[i] and forward[j])):
                continue
            within = (x >= other_x[0] - SHORT / 4) & (x <= other_x[-1] + SHORT / 4)
            gap = other_y - y if same else np.where(within, np.interp(x, other_x, other_y) - y, 1.0)
            near = np.abs(gap) < NEAR
            for first, last in _runs(near):  # without crossings
                if way[last] - way[first] < SHORT:
                    near[first:last + 1] = False
            count += near
            rank += near & (j < i)
        found.append([Strand(first, min(last + 1, len(x) - 1), int(rank[first]), int(count[first]))
                      for first, last in _runs(rank + (len(rank) + 1) * count)])
    return found


def _runs(values: Array | Flags) -> list[tuple[int, int]]:
    """First and last index of every run of equal values."""
    ends = [*np.flatnonzero(values[1:] != values[:-1]).tolist(), len(values) - 1]
    return list(zip([0, *(end + 1 for end in ends[:-1])], ends, strict=True))
