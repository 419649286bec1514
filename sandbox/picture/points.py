"""Points fixed to bodies, and all of them moved to pixels in one go for each frame."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.numeric import Array

XY = tuple[float, float]


class PointPool:
    """Points in body frames; each drawer adds its own and gets back where they are kept."""

    def __init__(self) -> None:
        self._bodies: list[NDArray[np.intp]] = []
        self._points: list[Array] = []
        self._count = 0

    def add(self, body: int, points: Array | list[XY]) -> slice:
        """Keep ``points`` [n, 2] m of ``body``; the slice finds them in :meth:`world`."""
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        self._bodies.append(np.full(len(points), body, dtype=np.intp))
        self._points.append(points)
        self._count += len(points)
        return slice(self._count - len(points), self._count)

    def close(self) -> None:
        """Join what was added; nothing may be added later."""
        sizes = [len(points) for points in self._points if len(points)]
        self._starts = np.cumsum([0, *sizes[:-1]]) if sizes else np.zeros(0, np.intp)
        self._body = np.concatenate([np.zeros(0, np.intp), *self._bodies])
        self._local = np.concatenate([np.zeros((0, 2)), *self._points])

    def world(self, pose: Array) -> Array:
        """All points [n, 2] m for ``pose`` [nb, 3] (x, y, angle), or [s, n, 2] for [s, nb, 3]."""
        c, s = np.cos(pose[..., 2]), np.sin(pose[..., 2])
        at = pose[..., self._body, :]
        c, s = c[..., self._body], s[..., self._body]
        x, y = self._local.T
        return np.stack((at[..., 0] + c * x - s * y, at[..., 1] + s * x + c * y), axis=-1)

    def place(self, number: int) -> tuple[int, XY]:
        """The body of a pooled point, and the point in its frame [m]."""
        x, y = self._local[number].tolist()
        return int(self._body[number]), (x, y)

    def boxes(self, pixels: Array) -> Array:
        """Left, top, right and bottom [k, 4] of every set of points that was added together."""
        if not len(self._starts):
            return np.zeros((0, 4))
        return np.hstack((np.minimum.reduceat(pixels, self._starts, axis=0),
                          np.maximum.reduceat(pixels, self._starts, axis=0)))


def moved(point: XY, pose: tuple[float, float, float]) -> XY:
    """A point of a body's frame in the world [m]."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    return (float(pose[0] + c * point[0] - s * point[1]),
            float(pose[1] + s * point[0] + c * point[1]))
