"""A sheet of shapes as SVG or PDF, by matplotlib: text stays text.

A pixel of the finished picture is 1/96 inch, as in CSS, unless it is said how large it is on paper.
The letters are those of the pixels: a PDF holds their font, an SVG names it, and beside it what
looks much the same where it is not installed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pygame

from sandbox.draw.film.palette import BACKGROUND, Colour
from sandbox.draw.film.shapes import (
    DrawnBox,
    DrawnLines,
    FilledCircle,
    FilledPolygon,
    Hatching,
    Shape,
)
from sandbox.draw.film.sheet import Hair, Laid, Sheet, Text
from sandbox.draw.film.typesetter import EM
from sandbox.figure.style import save_figure

SCREEN_PER_INCH = 96
"""Pixels of what is shown; a size on paper has its own."""
POINTS = 72
"""Of a document in an inch."""
FAMILIES = ("FreeSans", "Helvetica", "Arial", "Liberation Sans", "sans-serif")
"""The font, and those that are as wide."""


def save_vector(sheet: Sheet, path: Path, *, transparent: bool = False,
                per_inch: float = SCREEN_PER_INCH) -> None:
    """Write a sheet as SVG or PDF by the file's ending; equal sheets give equal bytes.

    Raises:
        OutputError: it cannot be written.
    """
    import matplotlib

    with matplotlib.rc_context({"svg.fonttype": "none", "font.sans-serif": []}):
        save_figure(_figure(sheet, transparent=transparent, per_inch=per_inch), path)


def _figure(sheet: Sheet, *, transparent: bool, per_inch: float = SCREEN_PER_INCH) -> Any:
    """A figure of matplotlib with an artist for each shape, in its order."""
    from matplotlib.figure import Figure

    width, height = sheet.size
    figure = Figure(figsize=(width / per_inch, height / per_inch), dpi=per_inch)
    figure.patch.set_visible(not transparent)
    figure.patch.set_facecolor(_colour(BACKGROUND))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(0, width)
    axes.set_ylim(height, 0)
    for laid in sheet.laid:
        _lay(axes, laid, sheet.enlarged, POINTS / per_inch)
    for word in sheet.words:
        if isinstance(word, Hair):
            _stroke(axes, word.colour, np.array([word.start, word.end]), POINTS / per_inch)
        else:
            _write(axes, word, POINTS / per_inch)
    return figure


def _colour(colour: Any) -> tuple[float, float, float]:
    red, green, blue = (v / 255 for v in colour[:3])
    return red, green, blue


def _lay(axes: Any, laid: Laid, enlarged: int, point: float) -> None:
    """The artist of a shape, moved, scaled down and cut; ``point`` is points per pixel."""
    from matplotlib.patches import Rectangle
    from matplotlib.path import Path as Outline
    from matplotlib.transforms import Affine2D

    left, top, width, height = laid.part
    place = Affine2D().translate(left, top).scale(1 / enlarged) + axes.transData
    artist = _artist(laid.shape, point / enlarged)
    artist.set_transform(place)
    area = laid.area or (0, 0, width, height)
    axes.add_artist(artist)
    if isinstance(laid.shape, Hatching):
        artist.set_clip_path(Outline(np.asarray(laid.shape.corners, dtype=float)), place)
    else:
        artist.set_clip_path(Rectangle(area[:2], *area[2:], transform=place))


def _artist(shape: Shape, scale: float) -> Any:
    """A shape as matplotlib has it; ``scale`` is points per pixel of the shape."""
    from matplotlib import patches
    from matplotlib.path import Path as Outline

    colour = _colour(shape.colour)
    line: dict[str, Any] = {"facecolor": "none", "edgecolor": colour, "capstyle": "butt",
                            "joinstyle": "round"}
    filled: dict[str, Any] = {"facecolor": colour, "edgecolor": "none"}
    match shape:
        case FilledPolygon(_, corners):
            return patches.Polygon(np.asarray(corners, dtype=float), closed=True, **filled)
        case FilledCircle(_, centre, radius):
            return patches.Circle(centre, radius, **filled)
        case DrawnBox(_, (x, y, wide, high), width):
            if not width:
                return patches.Rectangle((x, y), wide, high, **filled)
            # pygame's line lies within the rectangle
            return patches.Rectangle((x + width / 2, y + width / 2), wide - width, high - width,
                                     linewidth=width * scale, **line)
        case DrawnLines(_, path, width, closed):
            points = np.asarray(path, dtype=float)
            return patches.PathPatch(Outline(np.concatenate([points, points[:1]]) if closed
                                             else points, closed=closed),
                                     linewidth=width * scale, **line)
        case Hatching(_, lines, width, _):
            ends = np.asarray(lines, dtype=float).reshape(-1, 2)
            codes = np.tile([Outline.MOVETO, Outline.LINETO], len(lines))
            return patches.PathPatch(Outline(ends, codes), linewidth=width * scale, **line)


def _stroke(axes: Any, colour: Colour, path: Any, width: float) -> None:
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path as Outline

    axes.add_artist(PathPatch(Outline(path), facecolor="none", edgecolor=_colour(colour),
                              linewidth=width)).set_clip_on(False)


def _write(axes: Any, word: Text, point: float) -> None:
    """A text, on a rim of the background's colour where it has one."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.patches import PathPatch
    from matplotlib.textpath import TextPath
    from matplotlib.transforms import Affine2D

    face = word.face
    font = FontProperties(family=list(FAMILIES), weight="bold",
                          fname=str(Path(pygame.__file__).parent / pygame.font.get_default_font()))
    x, y = word.at[0] + face.rim, word.at[1] + face.baseline
    size = EM * face.type_size
    if face.rim:
        rim = PathPatch(TextPath((0, 0), face.text, size=size, prop=font, usetex=False),
                        facecolor="none", edgecolor=_colour(BACKGROUND),
                        linewidth=2 * face.rim * point, joinstyle="round")
        rim.set_transform(Affine2D().scale(1, -1).translate(x, y) + axes.transData)
        axes.add_artist(rim).set_clip_on(False)
    axes.text(x, y, face.text, fontproperties=font, fontsize=size * point, va="baseline",
              ha="left", color=_colour(face.colour), parse_math=False)
