"""Which parts of a picture a frame touches: a grid of cells, handed out as rectangles."""

from __future__ import annotations

import numpy as np
import pygame

from sandbox.numeric import Array

CELL = 24
"""Side of a cell [pixels of the finished picture]."""
FAR_SIDES = np.array([0.0, 0.0, 1.0, 1.0])


class Cells:
    """Marks what is drawn, so that only this is cleared and scaled down."""

    def __init__(self, stage: pygame.Rect) -> None:
        self._stage = stage
        self._grid = np.zeros((-(-stage.height // CELL), -(-stage.width // CELL)), dtype=bool)

    def mark(self, boxes: Array) -> list[pygame.Rect]:
        """Rectangles without overlap that cover all ``boxes`` [n, 4] (left, top, right, bottom).

        What lies outside of the stage is cut off.
        """
        left, top = self._stage.topleft
        cells = np.floor((boxes - np.array([left, top, left, top])) / CELL) + FAR_SIDES
        cells = np.where(np.isnan(cells), 0.0, cells)
        rows, columns = self._grid.shape
        limit = (columns, rows, columns, rows)
        x0, y0, x1, y1 = np.minimum(np.maximum(cells, 0), limit).astype(np.intp).T
        # +1 and -1 at the corners: the running sum counts the boxes over each cell
        width = columns + 1
        corners = np.concatenate((y0 * width + x0, y1 * width + x1, y0 * width + x1,
                                  y1 * width + x0))
        signs = np.repeat((1.0, -1.0), 2 * len(boxes))
        steps = np.bincount(corners, signs, minlength=(rows + 1) * width)
        count = steps.reshape(rows + 1, width).cumsum(axis=0).cumsum(axis=1)
        self._grid = count[:rows, :columns] > 0.5
        return self._runs()

    def _runs(self) -> list[pygame.Rect]:
        """Marked cells joined along rows, and equal runs of neighbouring rows joined."""
        padded = np.zeros((self._grid.shape[0], self._grid.shape[1] + 2), dtype=np.int8)
        padded[:, 1:-1] = self._grid
        step = np.diff(padded, axis=1)
        rows, starts = np.nonzero(step == 1)
        _, ends = np.nonzero(step == -1)
        open_runs: dict[tuple[int, int], list[int]] = {}
        done: list[list[int]] = []
        for row, start, end in zip(rows.tolist(), starts.tolist(), ends.tolist(), strict=True):
            run = open_runs.get((start, end))
            if run is not None and run[3] == row:
                run[3] = row + 1
            else:
                run = [start, row, end, row + 1]
                open_runs[start, end] = run
                done.append(run)
        left, top = self._stage.topleft
        return [pygame.Rect(left + x0 * CELL, top + y0 * CELL, (x1 - x0) * CELL,
                            (y1 - y0) * CELL).clip(self._stage) for x0, y0, x1, y1 in done]
