"""What a drawer draws on, and what it draws from."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

from sandbox.draw.film import clip
from sandbox.draw.film.camera import Camera
from sandbox.draw.film.geometry import ribbon
from sandbox.draw.film.palette import INK, Colour
from sandbox.draw.film.shapes import Area, Paper
from sandbox.numeric import Array

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

XY = tuple[float, float]
Spots = Callable[[float, float], "Iterable[XY]"]
TYPE, LEAST_TYPE = 20, 11
"""Size of type in points: at half its size a picture of 800 by 600 pixels is still read. Type is no
smaller than so many pixels."""


def picture_unit(size: tuple[int, int]) -> float:
    """Pixels per point: a picture is 800 points wide, or 300 points high where it is a band.

    Pictures of one width have type of one size, as a page's column shows them.
    """
    return min(size[0] / 800, size[1] / 300)


def type_size(unit: float) -> int:
    """Of a picture's words [pixels] for so many pixels per point."""
    return max(LEAST_TYPE, round(TYPE * unit))


@dataclass
class Moment:
    """One instant, ready to draw: pixels of the enlarged picture."""

    sample: int
    """Nearest recorded sample."""
    time: float
    pose: Array
    """[nb, 3] m, rad, between samples."""
    drives: Array
    """[nd] drive values between samples."""
    world: Array
    """Pooled points [n, 2] m."""
    pixels: Array
    """Pooled points [n, 2] pixels."""
    points: list[XY]
    """The same as a list: what pygame reads fastest."""


@dataclass
class Label:
    """A text that wants a place: it goes to the first free of ``spots``."""

    text: str
    spots: Spots
    """Middles of the text [pixels of the finished picture], best first, for half its width and half
    its height."""
    colour: Colour = INK
    required: bool = False
    """Placed at the first spot when none is free, rather than left out."""
    unit: str = ""
    """What follows the text, and other texts that are listed with it."""
    at: XY | None = None
    """What it tells of [pixels of the finished picture], where a line may lead there and texts
    that tell of one place are listed."""
    alone: bool = False
    """Never in a list with others."""


def spots_at(*places: XY) -> Spots:
    """The same places for a text of any size."""
    return lambda _half_x, _half_y: places


@dataclass
class Canvas:
    """The enlarged picture, the camera that made it, and labels to set later."""

    surface: Paper
    camera: Camera
    unit: float
    """Pixels of the enlarged picture per point, as :func:`picture_unit` has them."""
    enlarged: int
    drift: XY = (0.0, 0.0)
    """How far the world has gone on the picture since t = 0 [pixels of the enlarged picture]."""
    labels: list[Label] = field(default_factory=list)
    busy: list[Area] = field(default_factory=list)
    """Where no label may lie [pixels of the finished picture]."""
    avoided: list[Area] = field(default_factory=list)
    """Where one may lie only if it finds no other place beside what it tells of [the same]."""
    touched: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Boxes (left, top, right, bottom) that were drawn on [pixels of the enlarged picture]."""

    def clear(self) -> None:
        """Forget the last frame's labels and boxes."""
        self.labels.clear()
        self.busy.clear()
        self.avoided.clear()
        self.touched.clear()

    def touch(self, at: XY, points: float) -> None:
        """Note a drawing that reaches ``points`` around ``at``."""
        r = points * self.unit
        self.touched.append((at[0] - r, at[1] - r, at[0] + r, at[1] + r))

    def touch_path(self, path: Sequence[XY], points: float) -> None:
        """Note a drawing that reaches ``points`` around each line of ``path``."""
        r = points * self.unit
        for (x0, y0), (x1, y1) in pairwise(path):
            self.touched.append((min(x0, x1) - r, min(y0, y1) - r,
                                 max(x0, x1) + r, max(y0, y1) + r))

    def width(self, points: float) -> int:
        """A line's width in pixels, at least 1."""
        return max(1, round(points * self.unit))

    def polyline(self, colour: Colour, path: Sequence[XY], points: float) -> None:
        """Connected lines of an even width."""
        if len(path) < 2:
            return
        clip.polygon(self.surface, colour, ribbon(path, points * self.unit))
        self.touch_path(path, points + 1)

    def disc(self, colour: Colour, centre: XY, points: float) -> None:
        """A filled circle of a radius in points."""
        clip.circle(self.surface, colour, centre, max(1.0, points * self.unit))

    def ring(self, fill: Colour, edge: Colour, centre: XY, points: float, line: float) -> None:
        """A filled circle with an outline."""
        self.disc(edge, centre, points)
        self.disc(fill, centre, points - line)


def around(canvas: Canvas, x: float, y: float) -> Spots:
    """Places for a text about a point [pixels of the finished picture], best first."""
    unit = canvas.unit / canvas.enlarged

    def spots(half_x: float, half_y: float) -> Iterator[XY]:
        aside, off = half_x + 8 * unit, half_y + 6 * unit
        for reach in (1.0, 1.5):
            yield from ((x, y - off * reach), (x, y + off * reach),
                        (x + aside * reach, y), (x - aside * reach, y))

    return spots
