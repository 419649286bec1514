"""A display list at one time: poses, columns and the pixels of all points of its items."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.camera import Camera
from sandbox.picture.listing import Item, Listing
from sandbox.picture.painter import XY
from sandbox.picture.palette import Colour

TOUCHED = 10.0
"""How far beside their ends arrows reach [points]."""
FINE = 1e3
"""Steps of a number, from 0 to its largest, that look different."""


class Moment:
    """A display list for one camera.

    Args:
        out: the list.
        camera: world to pixels of the painted picture, at the first sample if it follows a body.
        point: pixels per point.
        edges: what painters may be given: left, top, right, bottom [pixels].
        factor: finished pixels per pixel.
        small: leave details out, as in small pictures.
    """

    def __init__(self, out: Listing, camera: Camera, point: float,
                 edges: tuple[float, float, float, float], *, factor: float = 1.0,
                 small: bool = False) -> None:
        self.out, self.still_camera, self.camera, self.point = out, camera, camera, point
        self.scale, self.edges, self.small, self.factor = camera.scale, edges, small, factor
        self.thin = 0.75 if small else 1.0
        self._frames: list[Array] = []
        self._points: list[Array] = []
        self._offsets: list[Array] = []
        self._count = 0
        self._first = {name: np.searchsorted(rows[:, 0], np.arange(len(out.time) + 1))
                       for name, rows in out.tables.items()}
        self._columns = out.arrays()["columns"].T
        self._steady = np.zeros(self._columns.shape[1], dtype=bool)
        self._steady[out.steady] = True
        self._inks = {token: _rgb(pair[0]) for token, pair in out.inks.items()}
        self._ramps = {name: [[_rgb(c) for c in side] for side in sides]
                       for name, sides in out.ramps.items()}
        self._moves = np.ptp(np.nan_to_num(out.pose), axis=0).any(axis=1)
        self._extents: list[tuple[int, int, float]] = []
        """Where the points of each moving item begin and end, and how far beside them it reaches
        [points]."""
        self.points: list[XY] = []
        self._listed = False
        self.wild = False
        """Whether some point is far outside of the picture, or not finite."""
        self.touched: list[tuple[float, float, float, float]] = []
        self.outlines: list[slice] = []
        """Points along the items, in a row for each: where labels hide something."""
        self.fills: list[slice] = []
        """Corners of filled areas, a ring each."""
        self.marks: list[tuple[int, Array]] = []
        """The point of each glyph, and its box about that [pixels]: left, top and right, bottom."""
        self._sizes = np.maximum(np.abs(np.nan_to_num(self._columns)).max(axis=0, initial=0.0),
                                 1e-300)
        self._largest = {name: np.maximum(np.abs(np.nan_to_num(rows)).max(axis=0), 1e-300)
                         for name, rows in out.tables.items() if len(rows)}

    def _join(self) -> None:
        self._frame = np.concatenate([np.zeros(0, np.intp), *self._frames]).astype(np.intp)
        self._local = np.concatenate([np.zeros((0, 2)), *self._points])
        offsets = np.concatenate([np.zeros((0, 2)), *self._offsets])
        self._offset = offsets if offsets.any() else None
        self._starts = np.array([a for a, _, _ in self._extents], dtype=np.intp)
        self._reach = np.array([reach for _, _, reach in self._extents])

    def _pool(self, frame: int, points: Any, offset: XY = (0.0, 0.0)) -> slice:
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        self._frames.append(np.full(len(points), frame, dtype=np.intp))
        self._points.append(points)
        self._offsets.append(np.tile(np.asarray(offset, dtype=float), (len(points), 1)))
        self._count += len(points)
        return slice(self._count - len(points), self._count)

    def _place(self, point: Sequence[Any]) -> int:
        offset = (point[3], point[4]) if len(point) > 3 else (0.0, 0.0)
        return int(self._pool(point[0], [point[1:3]], offset).start)

    def go_to(self, t: float) -> None:
        """Work out poses and columns at a time [s], and the pixels of all points."""
        time = self.out.time
        i = int(np.clip(np.searchsorted(time, t) - 1, 0, max(len(time) - 2, 0)))
        j = min(i + 1, len(time) - 1)
        w = float(np.clip((t - time[i]) / (time[j] - time[i]), 0, 1)) if j > i else 0.0
        self.sample, self.time = (j if w > 0.5 else i), t
        self._set((1 - w) * self.out.pose[i] + w * self.out.pose[j],
                  (1 - w) * self._columns[i] + w * self._columns[j])
        if self.out.drift is not None:
            drift = (1 - w) * self.out.drift[i] + w * self.out.drift[j]
            self._follow(drift)
            self._set(self.pose, self._even)

    def go_to_sample(self, sample: int) -> None:
        """The same for a sample."""
        self.sample, self.time = sample, float(self.out.time[sample])
        if self.out.drift is not None:
            self._follow(self.out.drift[sample])
        self._set(self.out.pose[sample], self._columns[sample])

    def _follow(self, drift: Array) -> None:
        still = self.still_camera
        self.camera = Camera(still.scale, (still.centre[0] + float(drift[0]),
                                           still.centre[1] + float(drift[1])), still.pixel)

    def _set(self, pose: Array, even: Array) -> None:
        self.pose, self._even = pose, even
        self.values = np.where(self._steady, self._columns[self.sample], even).tolist()
        p = pose[self._frame]
        c, s = np.cos(p[:, 2]), np.sin(p[:, 2])
        x, y = self._local.T
        (px, py), (cx, cy) = self.camera.pixel, self.camera.centre
        self.px = np.empty((len(p), 2))
        self.px[:, 0] = px + self.scale * (p[:, 0] + c * x - s * y - cx)
        self.px[:, 1] = py - self.scale * (p[:, 1] + s * x + c * y - cy)
        if self._offset is not None:
            self.px += self._offset * (self.point, -self.point)
        self._listed = False
        left, top, right, bottom = self.edges
        self.wild = bool(len(self.px)) and not (
            self.px.min() >= min(left, top) and self.px[:, 0].max() <= right
            and self.px[:, 1].max() <= bottom)

    def list_points(self) -> None:
        """Make ``points`` of the pixels, which painters take; times that look equal need none."""
        if not self._listed:
            self.points, self._listed = cast("list[XY]", self.px.tolist()), True

    def key(self) -> bytes:
        """Equal for times that look the same: to 1/1000 of the largest value of each number."""
        parts = [np.clip(np.nan_to_num(np.rint(self.px), nan=-9e8), -1e9, 1e9).astype(
            np.int32).tobytes(), np.round(np.array(self.values) / self._sizes * FINE).tobytes()]
        for name, largest in self._largest.items():
            first = self._first[name]
            rows = self.out.tables[name][first[self.sample]:first[self.sample + 1]]
            parts.append(np.round(np.nan_to_num(rows / largest)[:, 1:] * FINE).tobytes())
        if any(item["k"] == "trail" for item in self.out.items):
            parts.append(str(self.sample).encode())
        return b"".join(parts)

    def boxes(self) -> Array:
        """Left, top, right and bottom of each moving item with points, [k, 4] pixels."""
        if not len(self._starts):
            own = np.array(self.touched).reshape(-1, 4)
            return np.asarray(own + TOUCHED * self.point * np.array((-1.0, -1.0, 1.0, 1.0)))
        px = np.nan_to_num(self.px, nan=-1e6, posinf=1e6, neginf=-1e6)
        ends = np.append(self._starts, 0)
        low = np.minimum.reduceat(px, ends[:-1], axis=0)
        high = np.maximum.reduceat(px, ends[:-1], axis=0)
        reach = self.point * np.concatenate([self._reach, np.full(len(self.touched), TOUCHED)])
        boxes = np.concatenate([np.hstack((low, high)), np.array(self.touched).reshape(-1, 4)])
        return np.asarray(boxes + reach[:, None] * (-1.0, -1.0, 1.0, 1.0))

    def touch(self, *points: Any) -> None:
        """Note the box of some points [pixels] that belong to no frame."""
        x, y = np.asarray(points, dtype=float).reshape(-1, 2).T
        self.touched.append((x.min(), y.min(), x.max(), y.max()))

    def to_pixels(self, world: Array) -> Array:
        """Pixels of points of the world [..., 2] m."""
        return self.camera.to_pixels(world)

    def value(self, number: Any) -> float:
        """A number, or a column's value."""
        return float(self.values[number[0]]) if isinstance(number, list) else float(number)

    def ink(self, token: str, by: float = 0.0) -> Colour | None:
        """The colour of a token; ``by`` of a ramp."""
        if token[:1] == "@":
            low, high = self._ramps[token[1:]]
            ramp = low if by < 0 else high
            return ramp[min(len(ramp) - 1, int(abs(by) * (len(ramp) - 1) + 0.5))]
        return self._inks.get(token)

    def look(self, item: Item) -> tuple[Colour | None, Colour | None, float, float, int]:
        """Fill, edge, width, dash [pixels] and hatching of an item now."""
        number = item["s"]
        if isinstance(number, list):
            number = number[min(len(number) - 1, max(0, round(self.value(item["state"]))))]
        fill, edge, width, dash, hatched = self.out.styles[number]
        by = self.value(item["by"]) if "by" in item else 0.0
        wide = self.value(item["wide"]) if "wide" in item else 1.0
        return (self.ink(fill, by), self.ink(edge, by), width * wide * self.point * self.thin,
                dash * self.point, hatched)

    def rows(self, item: Item) -> Array:
        """The rows of an item's table in this sample."""
        first = self._first[item["t"]]
        return self.out.tables[item["t"]][first[self.sample]:first[self.sample + 1]]

    def arrows(self, item: Item) -> tuple[Array, Array, Array, Array]:
        """Rows with an arrow in sight, its tails and tips [k, 2] pixels, sizes; small ones first.

        They are limited to arrows that are painted.
        """
        rows = self.rows(item)
        size = np.hypot(rows[:, 4], rows[:, 5])
        cut = np.minimum(1.0, item["most"] / np.maximum(size, 1e-30)) * item["metres"]
        tails = self.to_pixels(rows[:, 2:4])
        way = rows[:, 4:6] * cut[:, None] * (self.scale, -self.scale)
        left, top, right, bottom = self.edges
        x, y = tails.T
        there = (np.isfinite(way).all(axis=1) & (x > left) & (x < right) & (y > top)
                 & (y < bottom) & (np.hypot(*way.T) >= item["least"] * self.point))
        order = np.argsort(size[there], kind="stable")
        rows, size, tails, way = (each[there][order] for each in (rows, size, tails, way))
        return rows, tails, tails + way, size


def _rgb(colour: str) -> Colour:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)
