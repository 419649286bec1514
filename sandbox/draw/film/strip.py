"""A strip: key frames of a run side by side in one picture, one camera and one legend for all."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from sandbox.draw.film import clip, legend
from sandbox.draw.film.bounds import body_box, whole_box
from sandbox.draw.film.camera import width_shown
from sandbox.draw.film.canvas import Canvas, Typesetter, ellipsis
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.frames import MOST_PIXELS, FrameRenderer
from sandbox.draw.film.palette import HAIRLINE, INK, Colour
from sandbox.draw.film.scales import force_scale
from sandbox.draw.film.sheet import Sheet, Text
from sandbox.scene.elements.settings import View

ACROSS = 6
"""Pictures in a row."""
SHAPES = (0.35, 1.6)
"""Least and largest height of a picture as a fraction of its width."""
LEAST = 0.42
"""Of the width that the view asks for: a picture of a strip is not narrower."""


def strip_sheet(run: Filmed, times: Sequence[float], view: View, *, enlarge: int,
                bare: bool = False) -> Sheet:
    """Frames at ``times`` [s], each above its time; ``bare`` leaves title and legend out.

    Meters are left out, too.
    """
    view = view.model_copy(update={"meters": ()})
    across = _in_a_row(len(times))
    wide = round(view.size[0] * max(LEAST, 1 / across))
    high = round(wide * _shape(run, view))
    down = math.ceil(len(times) / across)
    while enlarge > 1 and across * wide * down * high * enlarge**2 > MOST_PIXELS:
        enlarge //= 2
    unit = _unit(view)
    pane = FrameRenderer(run, size=(wide, high), view=view, enlarge=enlarge, unit=unit, bare=True)
    return _Page(pane, unit, across, down, bare=bare).compose(times)


def _in_a_row(count: int) -> int:
    """Rows as even as can be, none longer than :data:`ACROSS`."""
    return math.ceil(count / math.ceil(count / ACROSS))


def _unit(view: View) -> float:
    """Pixels per point."""
    return min(view.size[0] / 800, view.size[1] / 600)


def _shape(run: Filmed, view: View) -> float:
    """Height over width of a picture of the strip, by what it shows."""
    bodies = body_box(run, view)
    across = width_shown(bodies, 1.0, view.width)
    box = whole_box(run, bodies, force_scale(run, across, view), across, view)
    wide = view.width or max(box.width, 1e-9)
    if view.width and view.centre:
        return view.size[1] / view.size[0]
    return float(np.clip(box.height / wide, *SHAPES))


class _Page:
    """Title, pictures in rows, legend."""

    def __init__(self, pane: FrameRenderer, unit: float, across: int, down: int, *,
                 bare: bool) -> None:
        self._pane, self._across, self._bare = pane, across, bare
        # of the page as a whole, which is looked at smaller than one picture
        self._unit = max(unit, across * pane.size[0] / 1000)
        self._type = Typesetter(max(11, round(16 * self._unit)))
        self._pad = round(0.8 * self._type.size)
        self._line = round(1.6 * self._type.size)
        wide, high = pane.size
        self._width, self._cell = across * wide, high + self._line + self._pad
        self._head = 0 if bare else round(2.2 * self._type.size)
        self._rows = [] if bare else legend.arrange(
            legend.items_for(pane.content, pane.camera.scale, self._unit), self._type,
            self._unit, self._width - 2 * self._pad, 8)
        self._foot = self._head + down * self._cell
        self.height = self._foot + len(self._rows) * self._line + (0 if bare else self._pad)

    def compose(self, times: Sequence[float]) -> Sheet:
        """All of it."""
        pane, k = self._pane, self._pane.enlarged
        page = Sheet((self._width, self.height), k)
        wide, high = pane.size
        for i, t in enumerate(times):
            x, y = i % self._across * wide, self._head + i // self._across * self._cell
            page.place(pane.sheet(t), (x, y))
            self._write(page, f"t = {t:.3f} s", x + wide / 2, y + high + self._line / 2, 0.5)
        canvas = Canvas(page, pane.camera.magnified(k), self._unit * k, k)
        for column in range(1, self._across):
            x = column * wide * k
            clip.line(page, HAIRLINE, (x, self._head * k), (x, (self._foot - self._pad) * k),
                      canvas.width(1))
        if self._bare:
            return page
        mechanism, size = pane.run.mechanism, round(1.2 * self._type.size)
        title = ellipsis(self._type, mechanism.title or mechanism.name,
                         self._width - 2 * self._pad, size)
        self._write(page, title, self._pad, self._head / 2 + 1, 0.0, size)
        edge = (self._foot - self._pad / 2) * k
        clip.line(page, HAIRLINE, (self._pad * k, edge), ((self._width - self._pad) * k, edge),
                  canvas.width(1))
        page.words += legend.draw_rows(canvas, self._type, self._rows, self._pad, self._foot,
                                       self._line)
        return page

    def _write(self, page: Sheet, text: str, x: float, middle: float, share: float,
               size: int | None = None, colour: Colour = INK) -> None:
        """A text of which ``share`` lies left of ``x``."""
        face = self._type.render(text, size=size, colour=colour)
        page.words.append(Text(face, (round(x - share * face.get_width()),
                                      round(middle - face.get_height() / 2))))
