"""What a drawer draws on, what it draws from, and text."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.camera import Camera
from sandbox.draw.film.geometry import ribbon
from sandbox.draw.film.palette import BACKGROUND, INK, Colour
from sandbox.draw.film.sheet import MASKS, Face
from sandbox.numeric import Array
from sandbox.wording import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

XY = tuple[float, float]
FINER = 4
"""Letters are drawn this many times larger, then scaled down."""
MOST_LETTERS = 1000
"""Of a text; no picture is as wide."""


def new_surface(width: int, height: int) -> pygame.Surface:
    """A blank picture in memory; no display is needed."""
    surface = pygame.Surface((width, height), 0, 32, MASKS)
    surface.fill(BACKGROUND)
    return surface


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
    spots: Iterable[XY]
    """Middles of the text [pixels of the finished picture], best first."""
    colour: Colour = INK
    required: bool = False
    """Placed at the first spot when none is free, rather than left out."""


@dataclass
class Canvas:
    """The enlarged picture, the camera that made it, and labels to set later."""

    surface: clip.Paper
    camera: Camera
    unit: float
    """Pixels of the enlarged picture per point; 600 points make a picture's height."""
    enlarged: int
    drift: XY = (0.0, 0.0)
    """How far the world has gone on the picture since t = 0 [pixels of the enlarged picture]."""
    labels: list[Label] = field(default_factory=list)
    busy: list[pygame.Rect] = field(default_factory=list)
    """Where no label may lie [pixels of the finished picture]."""
    touched: list[tuple[float, float, float, float]] = field(default_factory=list)
    """Boxes (left, top, right, bottom) that were drawn on [pixels of the enlarged picture]."""

    def clear(self) -> None:
        """Forget the last frame's labels and boxes."""
        self.labels.clear()
        self.busy.clear()
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


class Typesetter:
    """Texts as small pictures, kept: most of them come again in the next frame."""

    MOST = 2000

    def __init__(self, size: int) -> None:
        pygame.font.init()
        self.size = size
        self._fonts: dict[int, pygame.Font] = {}
        self._kept: dict[tuple[str, int, Colour, bool], Face] = {}

    def font(self, size: int) -> pygame.Font:
        """The font that travels with pygame: the same on every machine."""
        if size not in self._fonts:
            self._fonts[size] = pygame.font.Font(None, size)
        return self._fonts[size]

    def width(self, text: str, size: int | None = None) -> int:
        """How long the text is in pixels."""
        return round(self.font(FINER * (size or self.size)).size(letters(text))[0] / FINER)

    def render(
        self, text: str, *, size: int | None = None, colour: Colour = INK, halo: bool = False
    ) -> Face:
        """The text with a see-through ground, and with a white rim where ``halo``."""
        text = letters(text)
        size = size or self.size
        key = (text, size, colour, halo)
        if key not in self._kept:
            if len(self._kept) >= self.MOST:
                self._kept.clear()
            picture, rim = self._fine(text, size, colour), max(1, round(size / 9)) if halo else 0
            self._kept[key] = Face(
                self._rimmed(text, size, picture, rim) if halo else picture, text, size, colour,
                self.font(FINER * size).get_ascent() / FINER + rim, rim)
        return self._kept[key]

    def _fine(self, text: str, size: int, colour: Colour) -> pygame.Surface:
        """Letters drawn larger and scaled down: small ones keep their shapes and spacing."""
        font = self.font(FINER * size)
        # accents alone take no room, and pygame draws no text without
        large = font.render(text if font.size(text)[0] else " ", True, colour)
        # an even ground of the text's colour, so that scaling mixes the opacity alone
        even = pygame.Surface(large.get_size(), pygame.SRCALPHA, 32)
        even.fill((*colour, 0))
        even.blit(large, (0, 0), special_flags=pygame.BLEND_RGBA_MAX)
        width, height = large.get_size()
        return pygame.transform.smoothscale(
            even, (max(1, round(width / FINER)), max(1, round(height / FINER))))

    def _rimmed(self, text: str, size: int, face: pygame.Surface, rim: int) -> pygame.Surface:
        ground = self._fine(text, size, BACKGROUND)
        whole = pygame.Surface((face.get_width() + 2 * rim, face.get_height() + 2 * rim),
                               pygame.SRCALPHA, 32)
        for dx in range(-rim, rim + 1):
            for dy in range(-rim, rim + 1):
                if dx * dx + dy * dy <= rim * rim + 1:
                    whole.blit(ground, (rim + dx, rim + dy))
        whole.blit(face, (rim, rim))
        return whole


def ellipsis(type_: Typesetter, text: str, room: int, size: int) -> str:
    """``text`` cut to ``room`` pixels, with three dots where something is missing."""
    text = letters(text)
    if type_.width(text, size) <= room:
        return text
    kept = bisect_right(range(1, len(text)), room,
                        key=lambda length: type_.width(text[:length] + "...", size))
    return text[:kept].rstrip() + "..." if kept else ""


def letters(text: str) -> str:
    """What is written of a text: what does not print spelled out, and :data:`MOST_LETTERS`."""
    return printable(text[:MOST_LETTERS])[:MOST_LETTERS]
