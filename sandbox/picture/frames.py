"""Frames of a film: only what changed is painted again."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.numeric import Array
from sandbox.picture.frame import Picture
from sandbox.picture.labels import paint_labels
from sandbox.picture.palette import BACKGROUND
from sandbox.picture.pixels import Pixels

CELL = 24
"""Side of a cell [pixels of the finished picture]."""
MOST_PIXELS = 60_000_000
"""Of the enlarged picture; very large pictures are enlarged less."""


def touched(boxes: Array, stage: pygame.Rect) -> list[pygame.Rect]:
    """Rectangles of whole cells, without overlap, that cover boxes on the stage.

    Args:
        boxes: left, top, right, bottom [k, 4] pixels of the finished picture.
        stage: what lies outside of it is cut off.
    """
    grid = np.zeros((-(-stage.height // CELL), -(-stage.width // CELL)), dtype=np.int8)
    cells = np.floor((boxes - np.tile(stage.topleft, 2)) / CELL) + np.array([0.0, 0.0, 1.0, 1.0])
    limit = (*grid.shape[::-1], *grid.shape[::-1])
    for x0, y0, x1, y1 in np.clip(np.nan_to_num(cells), 0, limit).astype(int).tolist():
        grid[y0:y1, x0:x1] = 1
    edges = np.diff(grid, axis=1, prepend=0, append=0)
    found: list[pygame.Rect] = []
    last = np.zeros(0, dtype=np.int64)
    for row, edge in enumerate(edges):
        ends = np.flatnonzero(edge)
        runs = ends.reshape(-1, 2).tolist()
        if np.array_equal(ends, last):  # of equal rows the rectangles go on
            for rect in found[len(found) - len(runs):]:
                rect.height += CELL
        else:
            found += [pygame.Rect(stage.left + a * CELL, stage.top + row * CELL, (b - a) * CELL,
                                  CELL) for a, b in runs]
        last = ends
    return [rect.clip(stage) for rect in found]


class Frames:
    """Paints a picture at any time, enlarged and scaled down so that edges are smooth.

    Args:
        picture: what to paint.
        enlarge: how many times larger it is painted; a power of 2.
    """

    def __init__(self, picture: Picture, enlarge: int = 2) -> None:
        self.picture, self.size = picture, picture.size
        width, height = self.size
        while enlarge > 1 and width * height * enlarge**2 > MOST_PIXELS:
            enlarge //= 2
        self.painter = painter = Pixels(self.size, enlarge, picture.type)
        self.instant = picture.instant(enlarge)
        self._stage = pygame.Rect(picture.stage)
        self.instant.go_to_sample(0)
        self._clip(on=True)
        self.instant.paint_still(painter)
        self._clip(on=False)
        self._blank_surround()
        picture.surround(painter, self.instant)
        picture.write_grid(painter, self.instant)
        panel = pygame.Rect(picture.panel.rect)
        self._panel_texts = [text for text in painter.plain if panel.collidepoint(text[0])]
        painter.scale_down()
        painter.write_texts()
        self._large_still, self._small_still = painter.large.copy(), painter.small.copy()
        self._areas: list[pygame.Rect] = []
        self._written: list[pygame.Rect] = []
        self._stamped: list[pygame.Rect] = []
        self._key: bytes | None = None

    def _clip(self, *, on: bool) -> None:
        k = self.painter.enlarge
        self.painter.large.set_clip([v * k for v in self._stage] if on else None)

    def _blank_surround(self) -> None:
        """Wipe what was painted outside of the stage."""
        k, (width, height), stage = self.painter.enlarge, self.size, self._stage
        for zone in ((0, 0, width, stage.top), (0, stage.bottom, width, height),
                     (stage.right, stage.top, width, stage.height)):
            self.painter.large.fill(BACKGROUND, [v * k for v in zone])

    def draw(self, t: float) -> NDArray[np.uint8]:
        """The picture at ``t`` [s]: (height, width, 3), red, green, blue.

        Times outside of the recording show its first or last sample.
        """
        return self.draw_packed(t).view(np.uint8).reshape(*self.size[::-1], 4)[..., :3]

    def draw_packed(self, t: float) -> NDArray[np.uint32]:
        """The picture at ``t`` [s] as words of red + 256 green + 65536 blue, (height, width)."""
        painter, instant = self.painter, self.instant
        instant.go_to(t)
        key = instant.key()
        if key != self._key:
            self._restore()
            self._clip(on=True)
            instant.paint(painter)
            self._clip(on=False)
            self._areas = touched(self._boxes(), self._stage)
            painter.scale_down(self._areas)
            paint_labels(instant, painter, self.picture.label_size, self.picture.half)
            self._written = painter.write_texts()
            self._key = key
        self._draw_meters(t)
        self._write_stamp(t)
        return painter.packed()

    def _restore(self) -> None:
        """Put back what the last frame covered."""
        k, painter = self.painter.enlarge, self.painter
        areas = [(rect.x * k, rect.y * k, rect.w * k, rect.h * k) for rect in self._areas]
        painter.large.blits([(self._large_still, area, area) for area in areas], doreturn=False)
        painter.small.blits([(self._small_still, rect, rect)
                             for rect in self._areas + self._written], doreturn=False)

    def _boxes(self) -> Array:
        """What the frame covers: left, top, right, bottom [k, 4] in finished pixels."""
        if self.picture.view.follow:
            stage = self._stage
            return np.array([(stage.left, stage.top, stage.right, stage.bottom)], dtype=float)
        return np.asarray(self.instant.boxes() / self.painter.enlarge)

    def _write_stamp(self, t: float) -> None:
        painter = self.painter
        for rect in self._stamped:
            painter.small.blit(self._small_still, rect, rect)
        self.picture.write_stamp(painter, t)
        self._stamped = painter.write_texts()

    def _draw_meters(self, t: float) -> None:
        """Cursors and values of meters, which change with time."""
        panel, painter = self.picture.panel, self.painter
        area = panel.rect
        if not panel or not area.width or not area.height:
            return
        k = painter.enlarge
        large = pygame.Rect([v * k for v in area])
        painter.large.blit(self._large_still, large, large)
        panel.draw(painter, t)
        painter.scale_down([area])
        painter.plain += self._panel_texts
        painter.write_texts()
