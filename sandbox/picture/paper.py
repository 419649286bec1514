"""Painting with matplotlib's renderers: stills as PNG, SVG and PDF, without figures or artists."""

from __future__ import annotations

import io
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import matplotlib
import numpy as np
import pygame
from matplotlib.backends import backend_agg, backend_pdf, backend_svg
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath
from matplotlib.transforms import Affine2D, Bbox, TransformedPath
from numpy.typing import NDArray

from sandbox.atomic_files import atomic_file
from sandbox.picture.bounds import Rectangle
from sandbox.picture.geometry import XY, turned_area
from sandbox.picture.palette import BACKGROUND, EM, Colour, Ink, Rings, hatch_lines, lighter
from sandbox.picture.typesetter import Typesetter, letters, rim_of

if TYPE_CHECKING:
    from sandbox.picture.frame import Picture, Strip

SCREEN_PER_INCH, POINTS = 96, 72  # pixels per inch on the screen, as in CSS; points per inch
FAMILIES = ("FreeSans", "Helvetica", "Arial", "Liberation Sans", "sans-serif")
"""The font, and fonts of equal width, for an SVG."""


class Paper:
    """A painter on a renderer of matplotlib; shapes and texts are in finished pixels."""

    enlarge = 1

    def __init__(self, renderer: Any, size: tuple[int, int], typesetter: Typesetter,
                 factor: float) -> None:
        """``factor`` is the renderer's units per pixel."""
        self.renderer, self.size, self.type, self.factor = renderer, size, typesetter, factor
        self._clip: Any = None
        self._kept: list[Any] = []  # Agg knows clip paths by id: they have to live
        self.move(0.0, 0.0)

    def move(self, x: float, y: float) -> None:
        """Shift all that follows, for the parts of a strip."""
        self._flip = Affine2D().translate(x, y).scale(1, -1).translate(0, self.size[1]).scale(
            self.factor)

    def clip(self, area: Rectangle | None) -> None:
        """Clip what follows to an area, if there is one."""
        self._clip = None if area is None else Bbox(
            np.sort(self._flip.transform(area.corners), axis=0))

    def _draw(self, path: Any, fill: Ink, edge: Ink = None, width: float = 0.0,
              inside: Any = None, cap: str = "butt") -> None:
        gc = self.renderer.new_gc()
        gc.set_linewidth(width * self.factor if edge is not None else 0.0)
        gc.set_foreground(_ink(edge) if edge is not None else (0, 0, 0, 0), isRGBA=True)
        gc.set_joinstyle("round")
        gc.set_capstyle(cap)
        if self._clip is not None:
            gc.set_clip_rectangle(self._clip)
        if inside is not None:
            self._kept.append(TransformedPath(inside, self._flip))
            gc.set_clip_path(self._kept[-1])
        self.renderer.draw_path(gc, path, self._flip, _ink(fill) if fill is not None else None)
        gc.restore()

    def area(self, rings: Sequence[Rings], fill: Ink, edge: Ink, width: float, *,
             union: bool = False, hatch: float = 0.0) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        lines = [ring for ring, _, _ in rings]
        if union:
            for ring in lines:
                self._draw(_closed([ring]), None, edge, 2 * width)
            for ring in lines:  # one by one: overlapping rings have no holes
                self._draw(_closed([ring]), fill)
        else:
            self._draw(_closed(_holes(lines)), fill, edge if width else None, width)
        if hatch and edge is not None:
            for part in [[ring] for ring in lines] if union else [lines]:
                self._hatch(part, edge, hatch)

    def _hatch(self, rings: Rings, edge: Colour, pitch: float) -> None:
        """Slanted lines in the first ring, but not in the others."""
        lines = hatch_lines(rings[0], pitch)
        path = Outline(np.array(lines).reshape(-1, 2),
                       np.tile([Outline.MOVETO, Outline.LINETO], len(lines)))
        self._draw(path, None, lighter(edge, 0.45), 0.13 * pitch, _closed(_holes(rings)))

    def line(self, path: Sequence[XY], ink: Colour, width: float) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        self._draw(Outline(np.asarray(path)), None, ink, width)

    def simple(self, corners: Sequence[XY], fill: Ink, edge: Ink, width: float) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        self._draw(_closed([corners]), fill, edge, width)

    def disc(self, centre: XY, radius: float, fill: Ink, edge: Ink, width: float, *,
             hatch: float = 0.0) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        circle = Outline.circle(centre, radius)
        self._draw(circle, fill, edge if width else None, width)
        if hatch and edge is not None:
            self._hatch([np.asarray(circle.to_polygons()[0]).tolist()], edge, hatch)

    def text(self, middle: XY, words: str, size: int, ink: Colour, leader: Sequence[XY]) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        if leader:
            self.line(leader, lighter(ink, 0.35), 1.0)
        x = round(middle[0] - self.type.width(words, size) / 2)
        y = round(middle[1] - self.type.height(size) / 2)
        self._draw(self._letters(letters(words), size, x, y), None, BACKGROUND,
                   2 * rim_of(size), cap="round")
        self.write((x, y), words, size, ink)

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """See :class:`sandbox.picture.frames.Pixels`."""
        words = letters(words)
        if not words.strip():
            return
        if isinstance(self.renderer, backend_agg.RendererAgg):  # letters as in a film
            self._draw(self._letters(words, size, *corner), ink)
            return
        gc = self.renderer.new_gc()
        gc.set_foreground(_ink(ink), isRGBA=True)
        x, y = self._flip.transform((corner[0], corner[1] + self.type.baseline(size)))
        if self.renderer.flipy():  # y down
            y = self.size[1] * self.factor - y
        self.renderer.draw_text(gc, x, y, words, _font(EM * size * self.factor), 0.0)
        gc.restore()

    def _letters(self, words: str, size: int, x: float, y: float) -> Any:
        """The outlines of words right of and below a corner."""
        return _outline(words, EM * size).transformed(
            Affine2D().scale(1, -1).translate(x, y + self.type.baseline(size)))


@lru_cache(1000)
def _outline(words: str, size: float) -> Any:
    return TextPath((0, 0), words, size=size, prop=_font(size), usetex=False)


def _font(size: float) -> Any:
    """The font of the pixels, in units of the renderer."""
    name = Path(pygame.__file__).parent / pygame.font.get_default_font()
    return FontProperties(family=list(FAMILIES), weight="bold", fname=str(name), size=size)


def _holes(rings: Rings) -> list[Sequence[XY]]:
    """Rings of which the first runs counter-clockwise and the others, the holes, clockwise."""
    return [ring if (turned_area(np.asarray(ring)) > 0) == (k == 0) else ring[::-1]
            for k, ring in enumerate(rings)]


def _ink(ink: Colour) -> tuple[float, float, float, float]:
    return ink[0] / 255, ink[1] / 255, ink[2] / 255, 1.0


def _closed(rings: Rings) -> Any:
    return Outline.make_compound_path(*(
        Outline([*ring, ring[0]], closed=True) for ring in rings))


def _paint(renderer: Any, made: Picture | Strip, t: float, factor: float, *,
           transparent: bool) -> None:
    paper = Paper(renderer, made.size, made.type, factor)
    if not transparent:
        width, height = made.size
        paper.simple([(0, 0), (width, 0), (width, height), (0, height)], BACKGROUND, None, 0.0)
    made.paint(paper, t)


def pixels(made: Picture | Strip, t: float, *, transparent: bool = False) -> NDArray[np.uint8]:
    """Red, green, blue of a picture at a time [s], [h, w, 3]; and the opacity if transparent."""
    renderer = cast(Any, backend_agg).RendererAgg(*made.size, POINTS)
    _paint(renderer, made, t, 1.0, transparent=transparent)
    found = np.array(renderer.buffer_rgba())
    found[found[..., 3] == 0, :3] = 255
    return found if transparent else found[..., :3]


def save(path: Path, made: Picture | Strip, t: float, *, transparent: bool = False,
         per_inch: float | None = None) -> None:
    """Write a picture as PNG, SVG or PDF by the file's ending; equal ones give equal bytes."""
    ending, factor = path.suffix.lower(), POINTS / (per_inch or SCREEN_PER_INCH)
    (wide, high), text = (side * factor for side in made.size), io.StringIO()
    pdf, svg = cast(Any, backend_pdf), cast(Any, backend_svg)
    with atomic_file(path) as aside, matplotlib.rc_context({
            "svg.fonttype": "none", "font.sans-serif": [], "svg.hashsalt": "sandbox",
            "pdf.fonttype": 42}):
        if ending == ".png":
            from PIL import Image

            Image.fromarray(pixels(made, t, transparent=transparent)).save(
                aside, format="PNG", **({"dpi": (per_inch, per_inch)} if per_inch else {}))
            return
        if ending == ".svg":
            renderer = svg.RendererSVG(wide, high, text, image_dpi=POINTS, metadata={"Date": None})
        else:
            file = pdf.PdfFile(str(aside), metadata=dict.fromkeys(
                ("CreationDate", "Producer", "Creator")))
            file.newPage(wide / POINTS, high / POINTS)
            renderer = pdf.RendererPdf(file, POINTS, high / POINTS, wide / POINTS)
        _paint(renderer, made, t, factor, transparent=transparent)
        renderer.finalize()
        if ending == ".svg":
            aside.write_text(text.getvalue(), encoding="utf-8")
        else:
            file.finalize()
            file.close()
