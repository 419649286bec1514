"""What a text would cover: the lines of a picture, counted over any rectangle at once."""

from __future__ import annotations

import numpy as np
import pygame
from numpy.typing import NDArray

STEP = 56
"""Neighbouring pixels whose green differs by more lie at a line; hatching is fainter, and all that
is drawn as a line is darker than what it is drawn on."""
GREEN = 1


class Linework:
    """The lines of a finished picture, before anything is written on it."""

    def __init__(self, pixels: NDArray[np.uint8]) -> None:
        """``pixels`` are red, green, blue [h, w, 3]."""
        green = pixels[..., GREEN].astype(np.int16, order="C")
        height, width = green.shape
        edges = np.zeros((height, width), dtype=np.uint8)
        edges[:, 1:] += np.abs(green[:, 1:] - green[:, :-1]) > STEP
        edges[1:] += np.abs(green[1:] - green[:-1]) > STEP
        self._sums = np.zeros((height + 1, width + 1), dtype=np.int32)
        np.cumsum(edges, axis=0, out=self._sums[1:, 1:])
        np.cumsum(self._sums, axis=1, out=self._sums)

    @classmethod
    def of(cls, picture: pygame.Surface) -> Linework:
        """Those of a picture in memory."""
        return cls(pygame.surfarray.pixels3d(picture).swapaxes(0, 1))

    def under(self, rect: pygame.Rect) -> float:
        """How many lines a text there would hide a part of, one as long as the text is high."""
        rows, columns = (size - 1 for size in self._sums.shape)
        area = rect.clip(pygame.Rect(0, 0, columns, rows))
        sums = self._sums
        found = (sums[area.bottom, area.right] - sums[area.top, area.right]
                 - sums[area.bottom, area.left] + sums[area.top, area.left])
        return float(found) / (2 * max(rect.height, 1))
