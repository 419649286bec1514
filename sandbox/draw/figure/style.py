"""The house of styles of all figures: sizes, colours, type, axes, labels, numbers, files.

Type is 7 to 9.5 pt in a figure of one width, that of a column and a half: so a figure is not
scaled in print, and can be read where it is 400 pixels wide. What needs more room gets it below.
matplotlib's ``Figure`` is used without pyplot, so that no display and no global
state is involved.
"""

from __future__ import annotations

import io
import math
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.atomic_files import atomic_file
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.wording import printable

WIDTH = 120.0
"""Of a figure, however much is in it [mm]."""
MOST_LETTERS = 200
"""Of a text: more do not fit on a page's width."""
MM, MM_PER_POINT = 1 / 25.4, 25.4 / 72
"""Inches in a millimetre, millimetres in a point of type."""
DPI = 200
TINY, SMALL, PLAIN, HEAD = 7, 8, 8.5, 9.5
"""Sizes of type [pt]."""
LETTER, BOLD, LINES = 0.52, 0.62, 1.3
"""Of type of size 1: the mean width of a letter, and of a bold one; from line to line."""
SAMPLE, NAME, LONGEST = 14.0, 5.0, 60
"""Width of a legend's sample with the space about it, height of a row of a legend [mm]; letters of
a run's name there."""
BLUE, ORANGE, GREEN, VIOLET = "#2f6690", "#d1742f", "#4f8a6b", "#8a5a9e"
OCHRE, SLATE, RED = "#9a7b3f", "#5b6673", "#b5485d"
COLOURS = (BLUE, ORANGE, GREEN, VIOLET, OCHRE, SLATE, RED)
"""Of curves, in this order. Calm, and apart in lightness as well as in hue."""
INK, QUIET, GREY, FAINT, BAND = "#222831", SLATE, "#a9b1bb", "#e3e6ea", "#dfe5ec"
"""Of type, of notes, of lines that mark an instant, of the grid, of what is shaded."""
GOOD, BAD = "#3d6b52", "#a63f4d"
"""What settles, and what does not."""
HOLDS, FAILS, UNDECIDED, UNANSWERED = "#cfe0d6", "#f3ddcf", "#f8efcf", "#ffffff"
"""Of areas in which something holds, does not, is undecided, has no answer."""
LINE = 1.5
"""Thickness of a curve [pt]."""
DASHES: tuple[Any, ...] = ("solid", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)))
"""Line styles, for more curves than there are colours."""
TARGET: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (4, 3))}
STOP: dict[str, Any] = {"linewidth": 0.8, "linestyle": (0, (2, 3)), "color": QUIET}
"""How a target, and a limit of what is possible, are drawn."""
PLAIN_POWERS = (-3, 5)
"""Powers of ten between which the numbers at an axis are written out."""
SUFFIXES = (".png", ".svg", ".pdf")
MANY_MM = 0.5
"""Lengths below this [m] are shown in millimetres."""


@dataclass(frozen=True)
class Shown:
    """How a quantity is shown: SI times ``factor``, in ``unit``."""

    factor: float
    unit: str
    sign: str
    """After a number: `` mm``, ``°``."""


@dataclass(frozen=True)
class SideLabel:
    """A label to the right of the axes, at the height of ``y`` (as plotted)."""

    y: float
    text: str
    colour: str = INK


def shown_as(unit: str, *rows: Array) -> Shown:
    """Angles in degrees, lengths in mm where all are small, everything else as it is.

    Args:
        unit: SI, as a recording gives it.
        rows: what is to be shown, SI, any shapes; nan counts for nothing.
    """
    if unit in ("rad", "rad/s"):
        return Shown(180 / math.pi, unit.replace("rad", "deg"), "°" if unit == "rad" else " deg/s")
    if unit == "m" and all(np.nanmax(np.abs(row), initial=0.0) < MANY_MM for row in rows):
        return Shown(1e3, "mm", " mm")
    return Shown(1.0, "" if unit == "1" else unit, f" {unit}" if unit not in ("1", "") else "")


def number(value: float, digits: int = 4) -> str:
    """A number to so many digits, never as a power of ten.

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


def seconds(value: float) -> str:
    """A time to three digits, zeros kept: ``1.90 s``."""
    return f"{value:#.3g} s" if 0.001 <= value < 99.95 else f"{number(value, 3)} s"


def hue(place: int) -> str:
    """The colour of the curve at this place; after the last the first again."""
    return COLOURS[place % len(COLOURS)]


def load() -> None:
    """Load matplotlib, for whoever has to wait for something else before there is a figure."""
    import_module("matplotlib.figure")
    import_module("matplotlib.backends.backend_agg")


def new_figure(height: float, width: float = WIDTH) -> Any:
    """An empty figure, of the page's width by default; both in millimetres."""
    from matplotlib.figure import Figure
    from matplotlib.layout_engine import ConstrainedLayoutEngine

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.05, wspace=0.03, hspace=0.03)
    figure: Any = Figure(figsize=(width * MM, height * MM), dpi=DPI, layout=layout)
    # notebooks ask for it; matplotlib tells them how only once pyplot is loaded
    figure._repr_png_ = partial(_png, figure)
    return figure


def _png(figure: Any) -> bytes:
    """A figure for a notebook, less fine than in a file: a column is some 900 pixels wide."""
    file = io.BytesIO()
    figure.savefig(file, format="png", dpi=0.75 * DPI, metadata={"Software": None})
    return file.getvalue()


def title(figure: Any, text: str) -> None:
    """The figure's title, flush left; nothing for an empty one."""
    if text:
        figure.suptitle(_in_lines(figure, plain(text), HEAD, BOLD), x=0.01, ha="left",
                        fontsize=HEAD, color=INK, fontweight="bold")


def footnote(figure: Any, text: str) -> None:
    """Quiet lines under everything."""
    figure.supxlabel(_in_lines(figure, text, SMALL, LETTER), x=0.01, ha="left", fontsize=SMALL,
                     color=QUIET)


def _in_lines(figure: Any, text: str, size: float, letter: float) -> str:
    """A text broken where the figure ends, and the figure higher by all lines but the first."""
    width = figure.get_figwidth() / MM
    lines = [part for line in text.split("\n")
             for part in textwrap.wrap(line, int(width / (letter * size * MM_PER_POINT)))]
    figure.set_figheight(figure.get_figheight() + (len(lines) - 1) * LINES * size / 72)
    return "\n".join(lines)


def plain(text: str) -> str:
    """Text that prints, is no longer than a page, and in which a dollar sign begins no formula."""
    lines = "\n".join(map(printable, text[:MOST_LETTERS].split("\n")))
    return lines.replace("$", r"\$")


def dress(axes: Any, head: str, y: str, *, x: str = "", letter: str = "") -> None:
    """Frame, grid, title (after a bold letter) and the labels of the axes."""
    lead = rf"$\bf{{{letter}}}$   " if letter else ""
    if lead or head:
        axes.set_title(lead + plain(head), fontsize=PLAIN, color=INK, loc="left", pad=5)
    axes.set_ylabel(plain(y), fontsize=SMALL, color=INK)
    if x:
        axes.set_xlabel(plain(x), fontsize=SMALL, color=INK)
    axes.tick_params(labelsize=SMALL, colors=INK, which="both", length=2.5)
    axes.tick_params(which="minor", length=1.5)
    axes.grid(visible=True, color=FAINT, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.yaxis.set_offset_position("right")  # a power of ten: at the left are names and remarks
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def powers(axes: Any) -> None:
    """Very large and very small numbers at a linear y axis share a power of ten above it.

    They never share a summand: 10 stays 10, however little about it is shown.
    """
    axes.ticklabel_format(axis="y", scilimits=PLAIN_POWERS, useMathText=True, useOffset=False)
    axes.yaxis.offsetText.set(fontsize=SMALL, color=INK)


def over_time(grid: Sequence[Any], used: int, columns: int, *runs: Recording) -> None:
    """Time from 0 to the end of ``runs`` on panels that share their x axis.

    Its numbers stand under each column.

    Args:
        grid: all axes, row by row.
        used: so many of them hold something; the others are hidden.
        columns: of the grid.
        runs: one or several recordings.
    """
    # a sample belongs to the middle of a step
    end = max(run.time[-1] + 0.5 * run.mechanism.run.step for run in runs)
    for i, axes in enumerate(grid):
        axes.set_visible(i < used)
        axes.set_xlim(0, end)
        if i < used <= i + columns:
            axes.tick_params(labelbottom=True)
        if i < used and i // columns == (used - 1) // columns:
            axes.set_xlabel("time [s]", fontsize=SMALL, color=INK)


def legend(where: Any, *lines: Any, **how: Any) -> None:
    """A legend on white, without a frame: lines that it has to lie on shine through.

    Args:
        where: a figure or axes.
        lines: as matplotlib's ``legend`` takes them: none, or handles and labels.
        how: where it stands and how it is set.
    """
    where.legend(*lines, labelcolor=INK, facecolor="white", edgecolor="none", framealpha=0.85,
                 **{"fontsize": SMALL, "handlelength": 1.8, **how})


def name_runs(figure: Any, labels: Sequence[str]) -> None:
    """The names of several runs above a figure, each in its colour; the figure grows by them."""
    from matplotlib.lines import Line2D

    labels = [label if len(label) <= LONGEST else f"…{label[1 - LONGEST:]}" for label in labels]
    wide = LETTER * PLAIN * MM_PER_POINT * max(map(len, labels)) + SAMPLE
    columns = max(1, min(len(labels), int(figure.get_figwidth() / MM / wide)))
    rows = math.ceil(len(labels) / columns)
    figure.set_figheight(figure.get_figheight() + rows * NAME * MM)
    legend(figure, [Line2D([], [], color=hue(i), linewidth=LINE) for i in range(len(labels))],
           [plain(label) for label in labels], loc="outside upper left", ncols=columns,
           fontsize=PLAIN, borderaxespad=0.2)


def name_above(axes: Any, curves: Sequence[tuple[str, str, Any]], columns: int) -> None:
    """The names of curves above a panel: of each its label, colour and dashes."""
    from matplotlib.lines import Line2D

    samples = [Line2D([], [], color=colour, linewidth=LINE, linestyle=dash)
               for _, colour, dash in curves]
    legend(axes, samples, [plain(label) for label, _, _ in curves], loc="lower left", ncols=columns,
           bbox_to_anchor=(0.0, 1.0), borderaxespad=0.1, borderpad=0.2, columnspacing=1.2)


def roomy(axes: Any, *rows: Array, least: float = 0.0) -> None:
    """Limits of a linear y axis that leave a little room about the values of all rows.

    Args:
        axes: of matplotlib.
        rows: as plotted, any shapes; nan counts for nothing.
        least: the span shown at least.
    """
    values = np.concatenate([np.ravel(row) for row in rows])
    values = values[np.isfinite(values)]
    if not len(values):
        return
    low, high = float(values.min()), float(values.max())
    span = max(high - low, least, 1e-3 * max(abs(low), abs(high)), 1e-9)
    middle = 0.5 * (low + high)
    low, high = min(low, middle - 0.5 * span), max(high, middle + 0.5 * span)
    axes.set_ylim(low - 0.06 * span, high + 0.08 * span)


def label_side(axes: Any, labels: Sequence[SideLabel], *, height: float) -> None:
    """Write labels to the right of the axes, moved apart where they would overlap.

    Args:
        axes: their limits and scale are set already.
        labels: any order; what has no value is left out.
        height: of the axes, about [mm].
    """
    labels = [label for label in labels if math.isfinite(label.y)]
    if not labels:
        return
    to_axes = axes.transScale + axes.transLimits
    wanted = np.array([to_axes.transform((0.0, label.y))[1] for label in labels])
    gap = 1.25 * SMALL / 72 / (height * MM)
    places = apart(np.clip(wanted, 0.0, 1.0), gap)
    if len(labels) * gap <= 1:  # all of them beside the axes, if they have room there
        places += max(0.0, -places.min()) - max(0.0, places.max() - 1.0)
    for label, at in zip(labels, places, strict=True):
        axes.annotate(plain(label.text), (1.0, at), xycoords="axes fraction", xytext=(4, 0),
                      textcoords="offset points", va="center", fontsize=SMALL,
                      color=label.colour, annotation_clip=False)


def apart(wanted: Array, gap: float) -> Array:
    """The places nearest to those wanted (least squares) that keep ``gap`` and the order.

    With i·gap taken off the i-th place, "at least gap apart" is "not falling", and
    neighbours that fall are pooled at their mean (isotonic regression).

    Args:
        wanted: shape [n].
        gap: least distance.

    Returns:
        shape [n], in the order of ``wanted``.
    """
    order = np.argsort(wanted, kind="stable")
    pools: list[tuple[float, int]] = []
    for rank, index in enumerate(order):
        mean, count = float(wanted[index]) - rank * gap, 1
        while pools and pools[-1][0] > mean:
            other, more = pools.pop()
            mean, count = (mean * count + other * more) / (count + more), count + more
        pools.append((mean, count))
    places = np.repeat([mean for mean, _ in pools], [count for _, count in pools])
    result = np.empty(len(wanted))
    result[order] = places + gap * np.arange(len(wanted))
    return result


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure as PNG, SVG or PDF by the file's ending; equal figures give equal bytes.

    Raises:
        OutputError: it cannot be written.
        ValueError: another ending.
    """
    import matplotlib

    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise ValueError(f"a figure is written as {', '.join(SUFFIXES)}, not {suffix!r}")
    # no dates, no versions, no chance names: the file says what is drawn and nothing else
    metadata = {".png": {"Software": None}, ".svg": {"Date": None},
                ".pdf": {"CreationDate": None, "Producer": None, "Creator": None}}[suffix]
    with matplotlib.rc_context({"svg.hashsalt": "sandbox", "pdf.fonttype": 42}), \
            atomic_file(path) as aside:
        figure.savefig(aside, metadata=metadata)
