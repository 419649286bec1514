"""A display list at one time: poses, columns and the pixels of all points of its items."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, cast

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.bounds import Camera
from sandbox.picture.geometry import XY, Edges
from sandbox.picture.listing import Item, Listing
from sandbox.picture.palette import Colour, from_css

TOUCHED = 10.0
"""How far beside their ends arrows reach [points]."""
FINE = 1e3
"""Steps of a number, from 0 to its largest, that look different."""
PITCH = 7.0
"""Of hatching [points]."""


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

    def __init__(self, out: Listing, camera: Camera, point: float, edges: Edges, *,
                 factor: float = 1.0, small: bool = False) -> None:
        self.out, self.still_camera, self.camera, self.point = out, camera, camera, point
        self.scale, self.edges, self.small, self.factor = camera.scale, edges, small, factor
        self.thin, self.hatch = (0.75, 0.0) if small else (1.0, PITCH * point)
        self._pooled: list[tuple[int, Array, XY]] = []
        """Frame, points and offset of each set of points."""
        self._count = 0
        self._columns = np.array(out.columns).reshape(-1, len(out.time)).T
        self._steady = np.isin(np.arange(len(out.columns)), out.steady)
        self._first = {name: np.searchsorted(rows[:, 0], np.arange(len(out.time) + 1))
                       for name, rows in out.tables.items()}
        self._largest = {name: _largest(rows) for name, rows in out.tables.items() if len(rows)}
        self._sizes = _largest(self._columns)
        self._inks = {token: from_css(pair[0]) for token, pair in out.inks.items()}
        self._ramps = {name: [[from_css(c) for c in side] for side in sides]
                       for name, sides in out.ramps.items()}
        self._moves = np.ptp(np.nan_to_num(out.pose), axis=0).any(axis=1)
        self._extents: list[tuple[int, float]] = []
        """Where the points of each moving item begin, and how far beside them it reaches
        [points]."""
        self.points: list[XY] = []
        self.wild = False
        """Whether some point is far outside of the picture, or not finite."""
        self.touched: list[tuple[float, float, float, float]] = []
        self.outlines: list[slice] = []
        """Points along the items, in a row for each: where labels hide something."""
        self.fills: list[slice] = []
        """Corners of filled areas, a ring each."""
        self.marks: list[tuple[int, Array]] = []
        """The point of each glyph, and its box about that [pixels]: left, top and right, bottom."""

    def _join(self) -> None:
        sizes = [len(points) for _, points, _ in self._pooled]
        self._frame = np.repeat([frame for frame, _, _ in self._pooled] or [0], sizes or [0])
        self._local = np.concatenate([np.zeros((0, 2)), *(each for _, each, _ in self._pooled)])
        offsets = np.array([at for *_, at in self._pooled]).reshape(-1, 2)
        self._offset = np.repeat(offsets, sizes, axis=0) if offsets.any() else None
        self._starts, self._reach = np.array(self._extents).reshape(-1, 2).T

    def _pool(self, frame: int, points: Any, offset: XY = (0.0, 0.0)) -> slice:
        points = np.asarray(points, dtype=float).reshape(-1, 2)
        self._pooled.append((frame, points, offset))
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
        self._go(i, j, w)
        self.time = t

    def go_to_sample(self, sample: int) -> None:
        """The same for a sample."""
        self._go(sample, sample, 0.0)
        self.time = float(self.out.time[sample])

    def _go(self, i: int, j: int, w: float) -> None:
        """Between samples i and j, a share w of the way."""
        def between(rows: Array) -> Array:
            return np.asarray(rows[i] if i == j else (1 - w) * rows[i] + w * rows[j])

        self.sample = j if w > 0.5 else i
        self.values = np.where(self._steady, self._columns[self.sample],
                               between(self._columns)).tolist()
        (px, py), (cx, cy) = self.still_camera.pixel, self.still_camera.centre
        if self.out.drift is not None:
            dx, dy = between(self.out.drift).tolist()
            cx, cy = cx + dx, cy + dy
            self.camera = self.still_camera._replace(centre=(cx, cy))
        p = between(self.out.pose)[self._frame]
        c, s = np.cos(p[:, 2]), np.sin(p[:, 2])
        x, y = self._local.T
        self.px = np.empty((len(p), 2))
        self.px[:, 0] = px + self.scale * (p[:, 0] + c * x - s * y - cx)
        self.px[:, 1] = py - self.scale * (p[:, 1] + s * x + c * y - cy)
        if self._offset is not None:
            self.px += self._offset * (self.point, -self.point)
        self.points = []
        left, top, right, bottom = self.edges
        self.wild = bool(len(self.px)) and not (
            self.px.min() >= min(left, top) and self.px[:, 0].max() <= right
            and self.px[:, 1].max() <= bottom)

    def key(self) -> bytes:
        """Equal for times that look the same: to 1/1000 of the largest value of each number."""
        parts = [np.clip(np.nan_to_num(np.rint(self.px), nan=-9e8), -1e9, 1e9).astype(
            np.int32).tobytes(), np.round(np.array(self.values) / self._sizes * FINE).tobytes()]
        for name, largest in self._largest.items():
            rows = self.rows({"t": name})
            parts.append(np.round(np.nan_to_num(rows / largest)[:, 1:] * FINE).tobytes())
        if any(item["k"] == "trail" for item in self.out.items):
            parts.append(str(self.sample).encode())
        return b"".join(parts)

    def boxes(self) -> Array:
        """Left, top, right and bottom of each moving item with points, [k, 4] pixels."""
        boxes = np.array(self.touched).reshape(-1, 4)
        reach = np.full(len(boxes), TOUCHED)
        if self._extents:
            px = np.nan_to_num(self.px, nan=-1e6, posinf=1e6, neginf=-1e6)
            low, high = (each.reduceat(px, self._starts.astype(int), axis=0)
                         for each in (np.minimum, np.maximum))
            boxes = np.concatenate([np.hstack((low, high)), boxes])
            reach = np.concatenate([self._reach, reach])
        return np.asarray(boxes + self.point * reach[:, None] * (-1.0, -1.0, 1.0, 1.0))

    def touch(self, *points: Any) -> None:
        """Note the box of some points [pixels] that belong to no frame."""
        x, y = np.asarray(points, dtype=float).reshape(-1, 2).T
        self.touched.append((x.min(), y.min(), x.max(), y.max()))

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

    def look(self, item: Item) -> tuple[Colour | None, Colour | None, float, float, float]:
        """Fill, edge, width, dash and pitch of hatching [pixels] of an item now."""
        number = item["s"]
        if isinstance(number, list):
            number = number[min(len(number) - 1, max(0, round(self.value(item["state"]))))]
        fill, edge, width, dash, hatched = self.out.styles[number]
        by = self.value(item["by"]) if "by" in item else 0.0
        wide = self.value(item["wide"]) if "wide" in item else 1.0
        return (self.ink(fill, by), self.ink(edge, by), width * wide * self.point * self.thin,
                dash * self.point, self.hatch if hatched else 0.0)

    def rows(self, item: Item) -> Array:
        """The rows of an item's table in this sample."""
        first = self._first[item["t"]]
        return self.out.tables[item["t"]][first[self.sample]:first[self.sample + 1]]

    def _list_points(self) -> None:
        """Make ``points`` of the pixels, which painters take; times that look equal need none."""
        self.points = self.points or cast("list[XY]", self.px.tolist())

    def arrows(self, item: Item) -> tuple[Array, Array, Array, Array]:
        """Rows with an arrow in sight, its tails and tips [k, 2] pixels, sizes; small ones first.

        They are limited to arrows that are painted.
        """
        rows = self.rows(item)
        size = np.hypot(rows[:, 4], rows[:, 5])
        cut = np.minimum(1.0, item["most"] / np.maximum(size, 1e-30)) * item["metres"]
        tails = self.camera.to_pixels(rows[:, 2:4])
        way = rows[:, 4:6] * cut[:, None] * (self.scale, -self.scale)
        left, top, right, bottom = self.edges
        x, y = tails.T
        there = (np.isfinite(way).all(axis=1) & (x > left) & (x < right) & (y > top)
                 & (y < bottom) & (np.hypot(*way.T) >= item["least"] * self.point))
        order = np.flatnonzero(there)[np.argsort(size[there], kind="stable")]
        return rows[order], tails[order], (tails + way)[order], size[order]


def _largest(rows: Array) -> Array:
    """The largest size in each column, above 0."""
    return np.asarray(np.maximum(np.abs(np.nan_to_num(rows)).max(axis=0, initial=0.0), 1e-300))
