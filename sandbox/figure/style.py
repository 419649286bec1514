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
from sandbox.numeric import Array
from sandbox.wording import printable

WIDTH = 120.0  # default width of a figure [mm]
MAX_LETTERS = 200  # longest text; more does not fit on a page
MM, MM_PER_POINT = 1 / 25.4, 25.4 / 72  # inches per millimetre, millimetres per typographic point
DPI = 200
SMALL, PLAIN, HEAD = 8, 8.5, 9.5  # font sizes [pt]
LETTER, BOLD = 0.52, 0.62
"""Mean width of a letter, and of a bold letter, as a multiple of the font size."""
MAX_NAME = 60  # letters of a name in a legend
BLUE, ORANGE, GREEN, VIOLET = "#2f6690", "#d1742f", "#4f8a6b", "#8a5a9e"
OCHRE, SLATE, RED = "#9a7b3f", "#5b6673", "#b5485d"
COLOURS = (BLUE, ORANGE, GREEN, VIOLET, OCHRE, SLATE, RED)
"""Colours of curves, in this order; they differ in lightness as well as in hue."""
INK, QUIET, GREY, FAINT, BAND = "#222831", SLATE, "#a9b1bb", "#e3e6ea", "#dfe5ec"
"""Colours of text, notes, event lines, grid and shaded ranges."""
LINE = 1.5  # width of a curve [pt]
DASHES: tuple[Any, ...] = ("solid", (0, (5, 1.5)), (0, (1.2, 1.2)), (0, (5, 1.5, 1.2, 1.5)))
"""Line styles, for more curves than colours."""
TARGET: dict[str, Any] = {"linewidth": 0.9, "linestyle": (0, (4, 3))}  # line properties of targets
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None}, ".svg": {"Date": None},
    ".pdf": {"CreationDate": None, "Producer": None, "Creator": None}}
"""Of files, by their suffix: no dates, versions and random ids."""
MANY_MM = 0.5  # lengths below this [m] are shown in millimetres
PRESSURES = ((1e6, "MPa"), (1e5, "bar"), (1e3, "kPa"), (1.0, "Pa"))  # units by size [Pa]


class Shown(NamedTuple):
    """How a quantity is shown: SI times ``factor``, in ``unit``."""

    factor: float
    unit: str

    def label(self, name: str) -> str:
        """Label of an axis."""
        return (f"{name} [{self.unit}]" if self.unit else name).strip()


def pressure_unit(largest: float) -> tuple[float, str]:
    """The unit of pressures up to ``largest`` [Pa]: its size [Pa] and its name."""
    return next(((f, u) for f, u in PRESSURES if largest >= 0.9995 * f), PRESSURES[-1])


def shown_as(unit: str, *rows: Array) -> Shown:
    """Angles in degrees, pressures and small lengths by the size of ``rows`` [SI], others in SI."""
    if unit in ("rad", "rad/s"):
        return Shown(180 / math.pi, unit.replace("rad", "deg"))
    if unit == "Pa":
        pascals, name = pressure_unit(max(
            (np.nanmax(np.abs(row), initial=0.0) for row in rows), default=0.0))
        return Shown(1 / pascals, name)
    if unit == "m" and all(np.nanmax(np.abs(row), initial=0.0) < MANY_MM for row in rows):
        return Shown(1e3, "mm")
    return Shown(1.0, "" if unit == "1" else unit)


def number(value: float, digits: int = 4) -> str:
    """A number with so many significant digits, never in exponential notation.

    >>> number(16474.3), number(2.97136), number(5.0)
    ('16470', '2.971', '5')
    """
    return np.format_float_positional(  # of -0.0, too, that is 0
        value + 0.0, digits, unique=False, fractional=False, trim="-") if math.isfinite(
            value) else "-"


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

    layout = ConstrainedLayoutEngine(w_pad=0.06, h_pad=0.06, wspace=0.03, hspace=0.0)
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
    """A legend without a frame on a figure or axes, in columns that fit a width [mm]; 0 for one."""
    names = [plain(name if len(name) <= MAX_NAME else f"…{name[1 - MAX_NAME:]}") for name, _ in key]
    column = LETTER * SMALL * MM_PER_POINT * max(map(len, names), default=0) + 14.0  # [mm]
    drawn = where.legend([artist for _, artist in key], names, **{
        "ncols": max(1, min(len(key), int(width / column))), "labelcolor": INK,
        "facecolor": "white", "edgecolor": "none", "borderpad": 0.2, "framealpha": 0.85,
        "fontsize": SMALL, "handlelength": 1.8, "labelspacing": 0.35, "columnspacing": 1.4,
        "alignment": "left", **how})
    drawn.get_title().set_color(INK)


def save_figure(figure: Any, path: Path) -> None:
    """Write a figure by its suffix, one of :data:`METADATA`; equal figures give equal bytes.

    Raises OutputError if the file cannot be written.
    """
    import matplotlib

    with matplotlib.rc_context({"svg.hashsalt": "sandbox", "pdf.fonttype": 42}), \
            atomic_file(path) as aside:
        figure.savefig(aside, metadata=METADATA[path.suffix.lower()])


NEAR, SHORT = 0.012, 0.04
"""Curves closer than this share of the axes' height coincide; where they do so for less than this
share of the width they cross."""
STROKE = 3.5  # length of each colour where curves coincide, as a multiple of the line width
GRID = 2000  # points at which curves are compared


def show_coincident(axes: Any, lines: Sequence[Any]) -> None:
    """Alternate the colours of lines where they coincide; set the limits of the axes before.

    Lines whose x does not increase, or with values that are not finite, are left as they are.
    """
    from scipy.ndimage import binary_opening

    to_axes = axes.transScale + axes.transLimits
    found = [(line, *to_axes.transform(line.get_xydata()).T) for line in lines]
    found = [(line, x, y) for line, x, y in found
             if len(x) > 1 and np.isfinite(x + y).all() and (np.diff(x) > 0).all()]
    if len(found) < 2:
        return
    x = np.linspace(min(x[0] for _, x, _ in found), max(x[-1] for _, x, _ in found), GRID)
    y = np.array([np.interp(x, xs, ys, np.nan, np.nan) for _, xs, ys in found])
    size = min(math.ceil(SHORT * GRID / (x[-1] - x[0])), GRID + 1)
    near = binary_opening(np.abs(y[:, None] - y) < NEAR, np.ones((1, 1, size)))
    for i, (line, *_) in enumerate(found):
        turns, rank = near[i].sum(axis=0), near[i, :i].sum(axis=0)
        points = to_axes.inverted().transform(np.column_stack([x, y[i]]))
        for count, place in sorted({*zip(turns.tolist(), rank.tolist(), strict=True)}):
            if count > 1:
                here = (turns == count) & (rank == place)
                # wider than the lines below, so that no gap shows between the colours
                axes.plot(points[:, 0], np.where(here, points[:, 1], np.nan), zorder=2.5,
                          color=line.get_color(), linewidth=1.2 * LINE, scalex=False, scaley=False,
                          linestyle=(STROKE * (count - place), (STROKE, STROKE * (count - 1))))
