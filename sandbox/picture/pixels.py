"""Paints with pygame, on an enlarged picture that is scaled down: smooth edges, fast for films."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.picture.geometry import ribbon
from sandbox.picture.painter import XY, hatch_ink, hatch_lines
from sandbox.picture.palette import BACKGROUND, Colour, lighter
from sandbox.picture.typesetter import Typesetter

MASKS = (0xFF, 0xFF00, 0xFF0000, 0)
"""Red, green, blue in this order in memory, the fourth byte unused."""
COLOUR = np.uint32(0xFFFFFF)
"""The fourth byte of a word is anything."""
LONG = 60
"""Lines with more corners have no mitres, which would take long."""
HATCHED = 400
"""Areas whose hatching is kept."""


def new_surface(width: int, height: int) -> pygame.Surface:
    """A blank picture in memory; no display is needed."""
    surface = pygame.Surface((width, height), 0, 32, MASKS)
    surface.fill(BACKGROUND)
    return surface


class Pixels:
    """A painter on a surface ``enlarge`` times as large as the finished picture."""

    def __init__(self, size: tuple[int, int], enlarge: int, typesetter: Typesetter) -> None:
        self.size, self.enlarge, self.type = size, enlarge, typesetter
        self.large = new_surface(size[0] * enlarge, size[1] * enlarge)
        self.small = new_surface(*size)
        self.texts: list[tuple[XY, str, int, Colour, Sequence[XY]]] = []
        self.plain: list[tuple[XY, str, int, Colour]] = []
        self._hatched: dict[bytes, tuple[pygame.Surface, pygame.Rect]] = {}

    def area(self, rings: Sequence[Sequence[Sequence[XY]]], fill: Colour | None,
             edge: Colour | None, width: float, *, union: bool = False, hatch: float = 0.0) -> None:
        """See :class:`sandbox.picture.painter.Painter`."""
        polygon, large = pygame.draw.polygon, self.large
        if fill is not None and (union or len(rings) == 1):
            if edge is not None and width:
                for _, outer, _ in rings:
                    polygon(large, edge, outer)
            for _, _, inner in rings:
                polygon(large, fill, inner)
        else:  # one ring with holes, or an outline
            if fill is not None:
                polygon(large, fill, _bridged([ring for ring, _, _ in rings]))
            if edge is not None and width:
                self._outline(rings, edge, width)
        if hatch and edge is not None:
            inside = [inner for _, _, inner in rings]
            for part in inside if union else [_bridged(inside)]:
                self._hatch(part, edge, hatch)

    def _outline(self, rings: Sequence[Sequence[Sequence[XY]]], edge: Colour,
                 width: float) -> None:
        for ring, outer, inner in rings:
            if len(outer) == len(ring) == len(inner):
                for k in range(len(ring)):
                    pygame.draw.polygon(self.large, edge,
                                        (outer[k - 1], outer[k], inner[k], inner[k - 1]))
            else:
                pygame.draw.lines(self.large, edge, True, ring, max(1, round(width)))

    def _hatch(self, corners: Sequence[XY], edge: Colour, pitch: float) -> None:
        key = np.asarray(corners, dtype=np.float32).round(1).tobytes() + bytes(edge)
        if key not in self._hatched:
            if len(self._hatched) >= HATCHED:
                self._hatched.clear()
            self._hatched[key] = self._hatching(corners, edge, pitch)
        lines, area = self._hatched[key]
        self.large.blit(lines, area)

    def _hatching(self, corners: Sequence[XY], edge: Colour,
                  pitch: float) -> tuple[pygame.Surface, pygame.Rect]:
        xs, ys = [at[0] for at in corners], [at[1] for at in corners]
        area = pygame.Rect(math.floor(min(xs)), math.floor(min(ys)),
                           math.ceil(max(xs) - min(xs)) + 2, math.ceil(max(ys) - min(ys)) + 2)
        area = area.clip(self.large.get_rect())
        lines = pygame.Surface(area.size, pygame.SRCALPHA, 32)
        for (x0, y0), (x1, y1) in hatch_lines(corners, round(pitch)):
            pygame.draw.line(lines, hatch_ink(edge), (x0 - area.x, y0 - area.y),
                             (x1 - area.x, y1 - area.y), max(1, round(0.13 * pitch)))
        mask = pygame.Surface(area.size, pygame.SRCALPHA, 32)
        pygame.draw.polygon(mask, (255,) * 4, [(x - area.x, y - area.y) for x, y in corners])
        lines.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MULT)
        return lines, area

    def line(self, path: Sequence[XY], ink: Colour, width: float) -> None:
        """See :class:`sandbox.picture.painter.Painter`."""
        if (len(path) == 2 and width > 2.5) or (2 < len(path) < LONG and width > 2.5 and (
                not _turns_back(path))):
            pygame.draw.polygon(self.large, ink, ribbon(path, width))
        elif len(path) == 2:
            pygame.draw.line(self.large, ink, path[0], path[1], max(1, round(width)))
        else:
            pygame.draw.lines(self.large, ink, False, path, max(1, round(width)))

    def simple(self, corners: Sequence[XY], fill: Colour | None, edge: Colour | None,
               width: float) -> None:
        """See :class:`sandbox.picture.painter.Painter`."""
        if fill is not None:
            pygame.draw.polygon(self.large, fill, corners)
        if edge is not None and width:
            pygame.draw.lines(self.large, edge, True, corners, max(1, round(width)))

    def disc(self, centre: XY, radius: float, fill: Colour | None, edge: Colour | None,
             width: float, *, hatch: float = 0.0) -> None:
        """See :class:`sandbox.picture.painter.Painter`."""
        if edge is not None and width:
            if fill is None:
                pygame.draw.circle(self.large, edge, centre, radius + width / 2,
                                   max(1, round(width)))
            else:
                pygame.draw.circle(self.large, edge, centre, radius + width / 2)
        if fill is not None:
            inside = radius - width / 2 if edge is not None else radius
            pygame.draw.circle(self.large, fill, centre, max(1.0, inside))
        if hatch and edge is not None:
            self._hatch(_circle(centre, radius - width / 2), edge, hatch)

    def text(self, middle: XY, words: str, size: int, ink: Colour, leader: Sequence[XY]) -> None:
        """Keep a text for the finished picture."""
        self.texts.append((middle, words, size, ink, leader))

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """See :class:`sandbox.picture.painter.SheetPainter`."""
        self.plain.append((corner, words, size, ink))

    def write_texts(self) -> list[pygame.Rect]:
        """Write the texts that were kept on the finished picture; returns what they cover."""
        found = [self.small.blit(self.type.render(words, size=size, colour=ink), corner)
                 for corner, words, size, ink in self.plain]
        self.plain.clear()
        for (x, y), words, size, ink, leader in self.texts:
            if leader:
                drawn = pygame.draw.aaline(self.small, lighter(ink, 0.35), leader[0], leader[1])
                found.append(drawn.inflate(4, 4).clip(self.small.get_rect()))
            face = self.type.render(words, size=size, colour=ink, halo=True)
            found.append(self.small.blit(face, (round(x - face.get_width() / 2),
                                                round(y - face.get_height() / 2))))
        self.texts.clear()
        return found

    def scale_down(self, areas: Sequence[pygame.Rect] = ()) -> None:
        """Scale the enlarged picture down, all of it or some areas of the finished one."""
        k = self.enlarge
        if not areas:
            pygame.transform.smoothscale(self.large, self.size, self.small)
        for rect in areas:
            source = self.large.subsurface([v * k for v in rect])
            pygame.transform.smoothscale(source, rect.size, self.small.subsurface(rect))

    def packed(self) -> NDArray[np.uint32]:
        """The finished picture as words of red + 256 green + 65536 blue, (height, width)."""
        words: NDArray[np.uint32] = pygame.surfarray.pixels2d(self.small).T & COLOUR
        return words


def _bridged(rings: Sequence[Sequence[XY]]) -> Sequence[XY]:
    """A ring and its holes as one even-odd polygon."""
    return rings[0] if len(rings) == 1 else [at for ring in rings for at in (*ring, ring[0])]


def _circle(centre: XY, radius: float, sides: int = 64) -> list[XY]:
    angles = [math.tau * k / sides for k in range(sides)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def _turns_back(path: Sequence[XY]) -> bool:
    """Whether a line may lie on itself, where the polygon around it would have holes."""
    points = np.asarray(path)
    step = np.diff(points, axis=0)
    turn = step[:-1, 0] * step[1:, 1] - step[:-1, 1] * step[1:, 0]
    along = (step[:-1] * step[1:]).sum(axis=1)
    return bool(np.abs(np.arctan2(turn, along)).sum() > 4.5)
