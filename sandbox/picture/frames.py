"""Frames of a film by pygame: painted larger and scaled down, unless they look the same."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.picture.geometry import XY, thick_line
from sandbox.picture.instant import Instant
from sandbox.picture.palette import BACKGROUND, Colour, Ink, Rings, hatch_lines, lighter
from sandbox.picture.typesetter import Typesetter

if TYPE_CHECKING:
    from sandbox.picture.frame import Picture


def new_surface(width: int, height: int) -> pygame.Surface:
    """A blank picture in memory; no display is needed."""
    surface = pygame.Surface((width, height), 0, 32, (0xFF, 0xFF00, 0xFF0000, 0))
    surface.fill(BACKGROUND)
    return surface


class Pixels:
    """A painter on a surface ``enlarge`` times as large as the finished picture."""

    def __init__(self, size: tuple[int, int], enlarge: int, typesetter: Typesetter) -> None:
        self.size, self.enlarge, self.type = size, enlarge, typesetter
        self.large = new_surface(size[0] * enlarge, size[1] * enlarge)
        self.small = new_surface(*size)
        self.texts: list[tuple[pygame.Surface, XY]] = []  # with their corners, to be written
        self._leaders: list[tuple[Colour, XY, XY]] = []

    def area(self, rings: Sequence[Rings], fill: Ink, edge: Ink, width: float, *,
             union: bool = False, hatch: float = 0.0) -> None:
        """Paint rings (line, outer, inner edge) as one area, or the later ones as holes."""
        if fill is not None and (union or len(rings) == 1):
            for _, outer, _ in rings if width else ():
                self._polygon(edge or fill, outer)
            for _, _, inner in rings:
                self._polygon(fill, inner)
        else:  # one ring with holes, or an outline
            if fill is not None:
                self._polygon(fill, _bridged([ring for ring, _, _ in rings]))
            for ring, outer, inner in rings:
                if edge is None or not width or not len(outer) == len(ring) == len(inner):
                    self.simple(ring, None, edge, width)
                    continue
                for k in range(len(ring)):
                    self._polygon(edge, (outer[k - 1], outer[k], inner[k], inner[k - 1]))
        if hatch and edge is not None:
            inside = [inner for _, _, inner in rings]
            for part in inside if union else [_bridged(inside)]:
                self._hatch(part, edge, hatch)

    def _polygon(self, ink: Colour, corners: Sequence[XY]) -> None:
        pygame.draw.polygon(self.large, ink, corners)

    def _hatch(self, corners: Sequence[XY], edge: Colour, pitch: float) -> None:
        self.large.blit(*_hatching(tuple((x, y) for x, y in corners), edge, pitch,
                                   self.large.get_rect().size))

    def line(self, path: Sequence[XY], ink: Colour, width: float) -> None:
        """Paint connected lines; wide ones have round joints."""
        if width <= 2.5 or len(path) > 60:
            pygame.draw.lines(self.large, ink, False, path, max(1, round(width)))
            return
        for start, end in pairwise(path):
            self._polygon(ink, thick_line(start, end, width))
        for joint in path[1:-1]:
            pygame.draw.circle(self.large, ink, joint, width / 2)

    def simple(self, corners: Sequence[XY], fill: Ink, edge: Ink, width: float) -> None:
        """Paint a small polygon with an outline about its line."""
        if fill is not None:
            self._polygon(fill, corners)
        if edge is not None and width:
            pygame.draw.lines(self.large, edge, True, corners, max(1, round(width)))

    def disc(self, centre: XY, radius: float, fill: Ink, edge: Ink, width: float, *,
             hatch: float = 0.0) -> None:
        """Paint a circle with an outline about its line."""
        if edge is not None and width:
            pygame.draw.circle(self.large, edge, centre, radius + width / 2,
                               0 if fill is not None else max(1, round(width)))
        if fill is not None:
            inside = radius - width / 2 if edge is not None else radius
            pygame.draw.circle(self.large, fill, centre, max(1.0, inside))
        if hatch and edge is not None:
            angle = np.arange(64) * math.tau / 64
            ring = np.column_stack((np.cos(angle), np.sin(angle)))
            self._hatch((np.array(centre) + (radius - width / 2) * ring).tolist(), edge, hatch)

    def text(self, middle: XY, words: str, size: int, ink: Colour, leader: Sequence[XY]) -> None:
        """Write a label with a rim, and a thin line to its point."""
        if leader:
            self._leaders.append((lighter(ink, 0.35), leader[0], leader[1]))
        face = self.type.render(words, size=size, colour=ink, halo=True)
        self.texts.append((face, (round(middle[0] - face.get_width() / 2),
                                  round(middle[1] - face.get_height() / 2))))

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """Write words right of and below a corner [finished pixels]."""
        self.texts.append((self.type.render(words, size=size, colour=ink), corner))

    def write_texts(self) -> list[pygame.Rect]:
        """Write the texts that were kept on the finished picture; returns the covered areas."""
        found = [pygame.draw.aaline(self.small, *leader).inflate(4, 4).clip(self.small.get_rect())
                 for leader in self._leaders]
        found += self.small.blits(self.texts) or []
        self.texts, self._leaders = [], []
        return found

    def grey(self, instant: Instant) -> NDArray[np.uint8]:
        """How bright a picture of only the instant is, [height, width] 0 to 255."""
        self.large.fill(BACKGROUND)
        instant.paint(self)
        return pygame.surfarray.array_green(self.large).T

    def scale_down(self, areas: Sequence[pygame.Rect]) -> None:
        """Scale areas of the enlarged picture down."""
        for rect in areas:
            source = self.large.subsurface([v * self.enlarge for v in rect])
            pygame.transform.smoothscale(source, rect.size, self.small.subsurface(rect))


@lru_cache(100)
def _hatching(corners: tuple[XY, ...], edge: Colour, pitch: float,
              size: tuple[int, int]) -> tuple[pygame.Surface, pygame.Rect]:
    """Hatched corners on a picture of a size, and their place there."""
    xs, ys = zip(*corners, strict=True)
    (x0, y0), (x1, y1) = (min(xs), min(ys)), (max(xs), max(ys))
    area = pygame.Rect(math.floor(x0), math.floor(y0), math.ceil(x1 - x0) + 2,
                       math.ceil(y1 - y0) + 2).clip((0, 0, *size))
    lines, mask = (pygame.Surface(area.size, pygame.SRCALPHA, 32) for _ in range(2))
    for (ax, ay), (bx, by) in hatch_lines(corners, round(pitch)):
        pygame.draw.line(lines, lighter(edge, 0.45), (ax - area.x, ay - area.y),
                         (bx - area.x, by - area.y), max(1, round(0.13 * pitch)))
    pygame.draw.polygon(mask, (255,) * 4, [(x - area.x, y - area.y) for x, y in corners])
    lines.blit(mask, (0, 0), special_flags=pygame.BLEND_RGBA_MULT)
    return lines, area


def _bridged(rings: Sequence[Sequence[XY]]) -> Sequence[XY]:
    return rings[0] if len(rings) == 1 else [at for ring in rings for at in (*ring, ring[0])]


class Frames:
    """Paints a picture at any time, ``enlarge`` (a power of 2) times larger and scaled down."""

    def __init__(self, picture: Picture, enlarge: int = 2) -> None:
        self.picture, self.size = picture, picture.size
        width, height = self.size
        while enlarge > 1 and width * height * enlarge**2 > 60_000_000:  # of the enlarged picture
            enlarge //= 2
        self.painter = painter = Pixels(self.size, enlarge, picture.type)
        self.instant = picture.instant(enlarge)
        self._stage = pygame.Rect(picture.stage[:2], picture.stage.size)
        self._meters = [meter.cell.inflate([2 * picture.panel.margin] * 2).clip((0, 0, *self.size))
                        for meter in picture.panel.meters]
        self._written: list[pygame.Rect] = []
        self._stamped: list[pygame.Rect] = []
        self._key: bytes | None = None
        picture.surround(painter, self.instant)
        self._meter_texts = [text for text in painter.texts
                             if any(rect.collidepoint(text[1]) for rect in self._meters)]
        painter.scale_down([pygame.Rect(0, 0, width, height)])
        painter.write_texts()
        self._large_still, self._small_still = painter.large.copy(), painter.small.copy()

    def draw(self, t: float) -> NDArray[np.uint8]:
        """The picture at ``t`` [s], limited to the run: (height, width, 3), red, green, blue."""
        return self.draw_packed(t).view(np.uint8).reshape(*self.size[::-1], 4)[..., :3]

    def draw_packed(self, t: float) -> NDArray[np.uint32]:
        """The picture at ``t`` [s] as words of red + 256 green + 65536 blue, (height, width)."""
        painter, instant, picture, stage = self.painter, self.instant, self.picture, self._stage
        instant.go_to(t)
        key = instant.key()
        if key != self._key:
            for rect in self._written:
                painter.small.blit(self._small_still, rect, rect)
            self._restore([stage])
            painter.large.set_clip([v * painter.enlarge for v in stage])
            instant.paint(painter)
            painter.large.set_clip(None)
            painter.scale_down([stage])
            picture.write_labels(painter, instant)
            self._written = painter.write_texts()
            self._key = key
        if self._meters:  # cursors and values
            self._restore(self._meters)
            picture.panel.draw(painter, [t])
            painter.scale_down(self._meters)
            painter.texts += self._meter_texts
            painter.write_texts()
        for rect in self._stamped:
            painter.small.blit(self._small_still, rect, rect)
        picture.write_stamp(painter, t)
        self._stamped = painter.write_texts()
        words: NDArray[np.uint32] = pygame.surfarray.pixels2d(painter.small).T & np.uint32(0xFFFFFF)
        return words

    def _restore(self, areas: Sequence[pygame.Rect]) -> None:
        large = [tuple(v * self.painter.enlarge for v in rect) for rect in areas]
        self.painter.large.blits([(self._large_still, area, area) for area in large],
                                 doreturn=False)
