"""Shapes in pixels, by pygame; a picture as a list of them and of texts: what stills are made of.

Drawers draw on a :class:`Sheet` as on a :class:`Raster`, by :mod:`sandbox.draw.film.clip`.
Painted it gives the pixels that the same drawers give on a surface; :mod:`sandbox.draw.film.vector`
writes the same list as SVG or PDF. So a picture is the same in every format.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film.palette import BACKGROUND, Colour
from sandbox.draw.film.shapes import (
    XY,
    Area,
    DrawnBox,
    DrawnLines,
    FilledCircle,
    FilledPolygon,
    Hatching,
    Shape,
)

MASKS = (0xFF, 0xFF00, 0xFF0000, 0)
"""Red, green, blue in this order in memory, the fourth byte unused."""
BLACK: Colour = (0, 0, 0)


class WrittenFace(pygame.Surface):
    """A line of text as a small picture that still knows what it says."""

    def __init__(self, picture: pygame.Surface, text: str, type_size: int, colour: Colour,
                 baseline: float, rim: int) -> None:
        super().__init__(picture.get_size(), pygame.SRCALPHA, 32)
        self.blit(picture, (0, 0), special_flags=pygame.BLEND_RGBA_MAX)
        self.text, self.colour = text, colour
        self.type_size = type_size
        """As the typesetter counts it."""
        self.baseline = baseline
        """Below the top [pixels]."""
        self.rim = rim
        """Width of the white rim [pixels]; 0 without."""


class Raster(pygame.Surface):
    """A picture in memory; no display is needed."""

    def keep(self, shape: Shape) -> None:
        """Draw a shape on top."""
        paint(shape, self)


def new_surface(width: int, height: int) -> Raster:
    """A blank picture."""
    surface = Raster((width, height), 0, 32, MASKS)
    surface.fill(BACKGROUND)
    return surface


def paint(shape: Shape, surface: pygame.Surface) -> None:
    """A shape in pixels."""
    match shape:
        case FilledPolygon():
            pygame.draw.polygon(surface, shape.colour, shape.corners)
        case DrawnLines() if len(shape.path) == 2 and not shape.closed:
            pygame.draw.line(surface, shape.colour, shape.path[0], shape.path[1], shape.width)
        case DrawnLines():
            pygame.draw.lines(surface, shape.colour, shape.closed, shape.path, shape.width)
        case DrawnBox():
            pygame.draw.rect(surface, shape.colour, shape.area, shape.width)
        case FilledCircle():
            pygame.draw.circle(surface, shape.colour, shape.centre, shape.radius)
        case Hatching():
            _hatch(shape, surface)


def _hatch(shape: Hatching, surface: pygame.Surface) -> None:
    points = np.asarray(shape.corners)
    (left, top), (right, bottom) = (np.floor(points.min(axis=0)).astype(int).tolist(),
                                    np.ceil(points.max(axis=0)).astype(int).tolist())
    area = pygame.Rect(left, top, right - left + 1, bottom - top + 1)
    area = area.clip(surface.get_rect())
    if not area.width or not area.height:
        return
    lines = pygame.Surface(area.size, pygame.SRCALPHA, 32)
    for (x0, y0), (x1, y1) in shape.lines:
        pygame.draw.line(lines, shape.colour, (x0 - area.left, y0 - area.top),
                         (x1 - area.left, y1 - area.top), shape.width)
    mask = pygame.Surface(area.size, pygame.SRCALPHA, 32)
    pygame.draw.polygon(mask, (255, 255, 255, 255),
                        [(x - area.left, y - area.top) for x, y in shape.corners])
    lines.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MULT)
    surface.blit(lines, area)


@dataclass(frozen=True)
class Text:
    """A line of text, its upper left corner on the finished picture."""

    face: WrittenFace
    at: XY

    @property
    def rect(self) -> pygame.Rect:
        """What it covers."""
        return pygame.Rect(self.at, self.face.get_size())

    def paint(self, surface: pygame.Surface) -> pygame.Rect:
        """In pixels; returns what it covers of the surface."""
        return surface.blit(self.face, self.at)


@dataclass(frozen=True)
class Hair:
    """A line of one pixel of the finished picture."""

    colour: Colour
    start: XY
    end: XY

    def paint(self, surface: pygame.Surface) -> pygame.Rect:
        """In pixels; returns what it covers of the surface."""
        return pygame.draw.aaline(surface, self.colour, self.start, self.end).inflate(4, 4).clip(
            surface.get_rect())


@dataclass(frozen=True)
class Laid:
    """A shape where it lies: on the picture, or on a part of it that counts from its own corner."""

    shape: Shape
    area: Area | None
    """What it is cut to, counted as the shape is; None does not cut."""
    part: tuple[int, int, int, int]
    """Left, top, width, height of the part [pixels of the enlarged picture]."""

    def paint(self, surface: pygame.Surface) -> None:
        """In pixels."""
        part = surface.subsurface(pygame.Rect(self.part).clip(surface.get_rect()))
        part.set_clip(None if self.area is None else self.area)
        paint(self.shape, part)


@dataclass
class Sheet:
    """Shapes of the enlarged picture, back to front, and on them texts of the finished one."""

    size: tuple[int, int]
    """Of the finished picture [pixels]."""
    enlarged: int
    """So many pixels of the enlarged picture are one of the finished, along either side."""
    laid: list[Laid] = field(default_factory=list)
    words: list[Text | Hair] = field(default_factory=list)
    _area: Area | None = None

    def get_size(self) -> tuple[int, int]:
        """Of the enlarged picture, as of a surface."""
        return self.size[0] * self.enlarged, self.size[1] * self.enlarged

    def get_rect(self) -> pygame.Rect:
        """All of the enlarged picture."""
        return pygame.Rect(0, 0, *self.get_size())

    def set_clip(self, area: Sequence[float] | None) -> None:
        """What comes next is cut to ``area`` [pixels of the enlarged picture]."""
        self._area = None if area is None else (area[0], area[1], area[2], area[3])

    def keep(self, shape: Shape) -> None:
        """Lay a shape on top."""
        self.laid.append(Laid(shape, self._area, (0, 0, *self.get_size())))

    def place(self, other: Sheet, at: tuple[int, int]) -> None:
        """Lay another sheet, enlarged as this one, with its corner at ``at`` [finished pixels]."""
        dx, dy = (v * self.enlarged for v in at)
        for each in other.laid:
            left, top, width, height = each.part
            self.laid.append(replace(each, part=(left + dx, top + dy, width, height)))
        for word in other.words:
            if isinstance(word, Text):
                self.words.append(replace(word, at=(word.at[0] + at[0], word.at[1] + at[1])))
            else:
                self.words.append(replace(
                    word, start=(word.start[0] + at[0], word.start[1] + at[1]),
                    end=(word.end[0] + at[0], word.end[1] + at[1])))

    def painted(self, ground: Colour = BACKGROUND) -> NDArray[np.uint8]:
        """Red, green, blue of every pixel on a ground of one colour [h, w, 3]."""
        large = pygame.Surface(self.get_size(), 0, 32, MASKS)
        large.fill(ground)
        for each in self.laid:
            each.paint(large)
        small = pygame.Surface(self.size, 0, 32, MASKS)
        pygame.transform.smoothscale(large, self.size, small)
        for word in self.words:
            word.paint(small)
        return np.ascontiguousarray(pygame.surfarray.array3d(small).transpose(1, 0, 2))

    def see_through(self) -> NDArray[np.uint8]:
        """The same with an opacity in place of a ground [h, w, 4].

        What covers a pixel by a shows 255 (1 - a) less of a white ground than of a black one.
        """
        white, black = (self.painted(ground).astype(int) for ground in (BACKGROUND, BLACK))
        opacity = 255 - np.clip((white - black).max(axis=2, keepdims=True), 0, 255)
        colour = np.where(opacity > 0, np.minimum(255, (255 * black + opacity // 2)
                                                  // np.maximum(opacity, 1)), 255)
        return np.concatenate((colour, opacity), axis=2).astype(np.uint8)

