"""A display list at one time, as areas, lines and discs in pixels: what every painter takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any, Protocol

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.camera import Camera
from sandbox.picture.cut import cut_line, cut_polygon, large_circle, within
from sandbox.picture.geometry import arrow, capsule_outline, dashes, polygon_grown
from sandbox.picture.listing import SIDES, Item, Listing
from sandbox.picture.palette import Colour, lighter
from sandbox.picture.scales import written

XY = tuple[float, float]
Plan = Callable[["Painter"], None]
ROUND = 0.15
"""Angle between corners of arcs, at most [rad]."""
PITCH = 7.0
"""Of hatching [points]."""
DETAILS = frozenset(("dot", "eye"))
"""Glyphs that small pictures leave out; they have no hatching, either."""
FINEST, MARKS_APART = 3.0, 9.0
"""Least length of the pieces of a trail, and least distance of its marks [points]."""
MOST_PIECES = 5000
"""Pieces of a trail, at most: the latest ones."""
LOOKS_EQUAL = 0.02
"""Columns that differ by less look the same."""


class Painter(Protocol):
    """What paints shapes, in pixels, y down."""

    def area(self, rings: Sequence[Sequence[Sequence[XY]]], fill: Colour | None,
             edge: Colour | None, width: float, *, union: bool = False, hatch: float = 0.0) -> None:
        """Paint rings, each as its line and that line moved by half the width outwards, inwards.

        With ``union`` they are one area with one outline outside of it; otherwise the second and
        later rings are holes. ``hatch`` is the pitch of slanted lines.
        """

    def line(self, path: Sequence[XY], ink: Colour, width: float) -> None:
        """Paint connected lines."""

    def simple(self, corners: Sequence[XY], fill: Colour | None, edge: Colour | None,
               width: float) -> None:
        """Paint a small polygon with an outline about its line."""

    def disc(self, centre: XY, radius: float, fill: Colour | None, edge: Colour | None,
             width: float, *, hatch: float = 0.0) -> None:
        """Paint a circle with an outline about its line."""

    def text(self, middle: XY, words: str, size: int, ink: Colour, leader: Sequence[XY]) -> None:
        """Write a label with a rim, and a thin line to what it belongs to."""


class SheetPainter(Painter, Protocol):
    """What paints a whole picture: shapes on a picture that may be enlarged, and plain texts."""

    enlarge: int
    """Pixels of shapes per finished pixel."""

    def write(self, corner: XY, words: str, size: int, ink: Colour) -> None:
        """Write words right of and below a corner [finished pixels]."""


class Label:
    """A text of an instant: what it says, its point and where it stands."""

    __slots__ = ("away", "clear", "ink", "item", "key", "point", "side", "words")

    def __init__(self, item: Item, key: int, words: str, point: XY, away: XY, ink: Colour,
                 side: int, clear: float) -> None:
        self.item, self.key, self.words, self.point = item, key, words, point
        self.away, self.ink, self.side, self.clear = away, ink, side, clear


class Instant:
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
        self.texts: list[tuple[Item, int]] = []
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
        self.still_plans: list[Plan] = []
        self.plans: list[Plan] = []
        self._extents: list[tuple[int, int]] = []
        self.wild = False
        """Whether some point is far outside of the picture, or not finite."""
        self.touched: list[tuple[float, float, float, float]] = []
        self.outlines: list[slice] = []
        """Points along the items, in a row for each: where labels hide something."""
        for item in out.items:
            self._plan(item)
        self._join()

    def _plan(self, item: Item) -> None:
        first = self._count
        plan = getattr(self, f"_{item['k']}")(item)
        if plan is None:
            return
        if "if" in item:
            plan = self._where(item["if"], plan)
        if self._count > first:
            self.outlines.append(slice(first, self._count))
        stays = not self.plans and self._stays(item)
        (self.still_plans if stays else self.plans).append(plan)
        if not stays and self._count > first:
            self._extents.append((first, self._count))

    def _where(self, shown: Any, plan: Plan) -> Plan:
        def paint(painter: Painter) -> None:
            if self.value(shown) > 0.5:
                plan(painter)
        return paint

    def _stays(self, item: Item) -> bool:
        """Whether an item looks the same in all samples."""
        if self.out.drift is not None or item["k"] not in ("path", "line", "mark", "span"):
            return False
        points = item.get("p", [item[key] for key in ("at", "a", "b") if key in item])
        frames = [item["f"]] if "f" in item else [point[0] for point in points]
        changing = any(isinstance(item.get(key), list) for key in (
            "if", "by", "state", "wide", "turn"))
        radii = [d["c"][4] for d in item.get("d", ()) if isinstance(d, dict)]
        return not (changing or any(isinstance(r, list) for r in radii)
                    or any(self._moves[frame] for frame in frames))

    def _join(self) -> None:
        self._frame = np.concatenate([np.zeros(0, np.intp), *self._frames]).astype(np.intp)
        self._local = np.concatenate([np.zeros((0, 2)), *self._points])
        offsets = np.concatenate([np.zeros((0, 2)), *self._offsets])
        self._offset = offsets if offsets.any() else None
        self._starts = np.array([a for a, _ in self._extents], dtype=np.intp)
        self._ends = np.array([b for _, b in self._extents], dtype=np.intp)

    # -- a time -----------------------------------------------------------------------------------

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
        self.points: list[XY] = [(x, y) for x, y in self.px.tolist()]
        left, top, right, bottom = self.edges
        self.wild = bool(len(self.px)) and not (
            self.px.min() >= min(left, top) and self.px[:, 0].max() <= right
            and self.px[:, 1].max() <= bottom)

    def key(self) -> bytes:
        """Equal for instants that look the same."""
        parts = [np.clip(np.nan_to_num(np.rint(self.px), nan=-9e8), -1e9, 1e9).astype(
            np.int32).tobytes(), np.round(np.array(self.values) / LOOKS_EQUAL).tobytes()]
        for name, first in self._first.items():
            rows = self.out.tables[name][first[self.sample]:first[self.sample + 1], 1:]
            parts.append(np.round(np.nan_to_num(rows) * 1e4).tobytes())
        if any(item["k"] == "trail" for item in self.out.items):
            parts.append(str(self.sample).encode())
        return b"".join(parts)

    def boxes(self) -> Array:
        """Left, top, right and bottom of each moving item with points, [k, 4] pixels."""
        if not len(self._starts):
            return np.array(self.touched).reshape(-1, 4)
        px = np.nan_to_num(self.px, nan=-1e6, posinf=1e6, neginf=-1e6)
        ends = np.append(self._starts, 0)
        low = np.minimum.reduceat(px, ends[:-1], axis=0)
        high = np.maximum.reduceat(px, ends[:-1], axis=0)
        own = np.hstack((low, high))
        return np.concatenate([own, np.array(self.touched).reshape(-1, 4)])

    def touch(self, *points: Any) -> None:
        """Note the box of some points [pixels] that belong to no frame."""
        x, y = np.asarray(points, dtype=float).reshape(-1, 2).T
        self.touched.append((x.min(), y.min(), x.max(), y.max()))

    def paint(self, painter: Painter) -> None:
        """Paint what moves."""
        self.touched.clear()
        for plan in self.plans:
            plan(painter)

    def paint_still(self, painter: Painter) -> None:
        """Paint what stays, behind all else."""
        for plan in self.still_plans:
            plan(painter)

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

    def to_pixels(self, world: Array) -> Array:
        """Pixels of points of the world [..., 2] m."""
        return self.camera.to_pixels(world)

    # -- plans ------------------------------------------------------------------------------------

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

    def _path(self, item: Item) -> Plan:
        circle = item["d"][0]["c"] if len(item["d"]) == 1 and isinstance(item["d"][0], dict) \
            else None
        if circle is not None and circle[0] == circle[2] and circle[1] == circle[3]:
            return self._circle(item, circle)
        union, (_, _, width, _, hatched) = bool(item.get("m")), self.out.styles[item["s"]]
        half = width / 2 * self.point * self.thin / self.scale
        by = half * (2 if union else 1)
        rings = []
        for ring in self._rings(item["d"]):
            line = self._pool(item["f"], ring)
            outer = self._pool(item["f"], polygon_grown(ring, by)) if width else line
            inner = line if union or not width else self._pool(
                item["f"], polygon_grown(ring, -half))
            rings.append((line, outer, inner))
        hatch = PITCH * self.point if hatched and not self.small else 0.0

        def paint(painter: Painter) -> None:
            fill, edge, now, _, _ = self.look(item)
            found: list[list[Sequence[XY]]] = [[self.points[part] for part in ring]
                                               for ring in rings]
            if self.wild:
                found = [ring for ring in ([self._cut(part) for part in ring] for ring in found)
                         if all(len(part) > 2 for part in ring)]
            if found:
                painter.area(found, fill, edge, now, union=union, hatch=hatch)
        return paint

    def _cut(self, corners: Sequence[XY]) -> Sequence[XY]:
        return corners if within(corners, self.edges) else cut_polygon(corners, self.edges)

    def _circle(self, item: Item, circle: Sequence[Any]) -> Plan:
        x, y, _, _, radius = circle
        at = self._place([item["f"], x, y])
        if not isinstance(radius, list):  # its box
            self._pool(item["f"], _square(x, y, radius))

        def paint(painter: Painter) -> None:
            fill, edge, width, _, hatched = self.look(item)
            hatch = PITCH * self.point if hatched and not self.small else 0.0
            size = self.value(radius) * self.scale
            if isinstance(radius, list):
                self.touch(*_square(*self.points[at], size))
            self._disc(painter, self.points[at], size, fill, edge, width, hatch)
        return paint

    def _disc(self, painter: Painter, centre: XY, radius: float, fill: Colour | None,
              edge: Colour | None, width: float, hatch: float = 0.0) -> None:
        left, top, right, bottom = self.edges
        if radius < 4 * math.hypot(right - left, bottom - top):
            if math.isfinite(centre[0] + centre[1]) and (
                    left - radius <= centre[0] <= right + radius
                    and top - radius <= centre[1] <= bottom + radius):
                painter.disc(centre, radius, fill, edge, width, hatch=hatch)
            return
        ring = large_circle(centre, radius, self.edges)
        if len(ring) > 2:
            painter.area([[ring, ring, ring]], fill, edge, width, hatch=hatch)

    def _rings(self, subpaths: Sequence[Any]) -> Iterator[Array]:
        """Corners of closed subpaths, without those that repeat."""
        error = 0.3 / self.scale
        for one in subpaths:
            if isinstance(one, dict):
                x0, y0, x1, y1, r = one["c"]
                steps = max(6, min(400, math.ceil(math.pi / (2 * math.acos(
                    max(0.0, 1 - error / max(r, 2 * error)))))))
                ring = capsule_outline((x0, y0), (x1, y1), r, steps)
            else:
                ring = np.array(one).reshape(-1, 2)
            apart = np.hypot(*(ring - np.roll(ring, 1, axis=0)).T) > 0
            if apart.sum() > 2:
                yield ring[apart]

    def _line(self, item: Item) -> Plan:
        at = [self._place(point) for point in item["p"]]

        def paint(painter: Painter) -> None:
            _, edge, width, dash, _ = self.look(item)
            self._stroke(painter, [self.points[i] for i in at], edge, width, dash)
        return paint

    def _stroke(self, painter: Painter, path: Sequence[XY], ink: Colour | None, width: float,
                dash: float = 0.0) -> None:
        """Connected lines, cut if they are far outside, in dashes if asked for."""
        if ink is None or len(path) < 2:
            return
        pieces: list[Sequence[XY]] = [path]
        if self.wild and not within(path, self.edges):
            pieces = [piece for a, b in pairwise(path) if (piece := cut_line(a, b, self.edges))]
        for one in pieces:
            for part in dashes(list(one), dash, 0.8 * dash) if dash else (one,):
                painter.line(part, ink, width)

    def _mark(self, item: Item) -> Plan | None:
        names = item["g"] if isinstance(item["g"], list) else [item["g"]]
        if self.small and DETAILS & set(names):
            return None
        at, made = self._place(item["at"]), [self.glyph(name) for name in names]

        def paint(painter: Painter) -> None:
            state = round(self.value(item["state"])) if "state" in item else 0
            turn = self.value(item["turn"]) if "turn" in item else 0.0
            if not self.wild or within([self.points[at]], self.edges):
                self.stamp(painter, made[min(len(made) - 1, max(0, state))], self.points[at], turn)
        return paint

    def glyph(self, name: str, point: float | None = None) -> list[Any]:
        """Parts of a glyph in pixels, y down: kind, points or radius, style."""
        parts: list[Any] = []
        point = point or self.point
        u = point * (0.85 if self.small else 1.0)
        for number, d in self.out.glyphs[name]:
            fill, edge, width, dash, _ = self.out.styles[number]
            look = (self.ink(fill, 1.0), self.ink(edge, 1.0), width * point, dash * point)
            if isinstance(d, dict) and "c" in d:
                parts.append(("disc", np.array([[d["c"][0] * u, -d["c"][1] * u]]), d["c"][4] * u,
                              look))
            else:
                flat = d["l"] if isinstance(d, dict) else d
                points = np.array(flat, dtype=float).reshape(-1, 2) * (u, -u)
                parts.append(("line" if isinstance(d, dict) else "ring", points, 0.0, look))
        return parts

    def stamp(self, painter: Painter, glyph: Sequence[Any], at: XY, turn: float = 0.0) -> None:
        """Paint a glyph at a point, turned counter-clockwise [rad]."""
        for kind, points, radius, (fill, edge, width, dash) in glyph:
            if turn:
                c, s = math.cos(turn), math.sin(turn)
                points = points @ np.array([[c, -s], [s, c]])
            here: list[XY] = (points + at).tolist()
            if kind == "disc":
                painter.disc(here[0], radius, fill, edge, width)
            elif kind == "ring":
                painter.simple(here, fill, edge, width)
            else:
                self._stroke(painter, here, edge, width, dash)

    def _span(self, item: Item) -> Plan:
        a, b = self._place(item["a"]), self._place(item["b"])
        pattern = np.array(item["t"], dtype=float).reshape(-1, 2)

        def paint(painter: Painter) -> None:
            _, edge, width, dash, _ = self.look(item)
            piece = (self.points[a], self.points[b])
            if self.wild and not within(piece, self.edges):
                cut = cut_line(*piece, self.edges)
                if cut is None:
                    return
                piece = cut
            start, way = np.array(piece[0]), np.array(piece[1]) - np.array(piece[0])
            length = max(math.hypot(*way), 1e-9)
            along, side = way / length, np.array((way[1], -way[0])) / length  # side: left, y up
            if "every" in item:
                step = item["every"] * self.point
                stroke = self.point * (pattern[:, :1] * along + pattern[:, 1:] * side)
                for k in range(1, math.ceil(length / step)):
                    self._stroke(painter, (start + k * step * along + stroke).tolist(), edge,
                                 width)
                return
            share, low, high = item["w"]
            half = min(max(share * length, low * self.point), high * self.point)
            path = start + pattern[:, :1] * way + half * pattern[:, 1:] * side
            self._stroke(painter, path.tolist(), edge, width, dash)
        return paint

    def _spiral(self, item: Item) -> Plan:
        at, share = self._place(item["at"]), np.linspace(0, 1, 30)
        radius = item["r"][0] + (item["r"][1] - item["r"][0]) * share

        def paint(painter: Painter) -> None:
            _, edge, width, _, _ = self.look(item)
            if edge is None or not within([self.points[at]], self.edges):
                return
            sweep = self.value(item["sweep"])
            angle = self.value(item["start"]) + sweep * share
            path: list[XY] = (self.px[at] + self.point * radius[:, None] * np.column_stack(
                (np.cos(angle), -np.sin(angle)))).tolist()
            head = item.get("head", 0.0) * self.point
            if not head:
                self._stroke(painter, path, edge, width)
                return
            back = min(0.8 * abs(sweep), head / (radius[-1] * self.point))
            keep = max(2, round(len(path) * (1 - back / max(abs(sweep), 1e-9))))
            self._stroke(painter, path[:keep], edge, width)
            painter.simple(arrow(path[keep - 1], path[-1], width, head), edge, None, 0)
        return paint

    def _taut(self, item: Item) -> Plan:
        at = [self._place(point) for point in item["p"]]
        for frame, x, y, r, *_ in item["p"]:  # boxes of the wheels
            if not isinstance(r, list) and r:
                self._pool(frame, _square(x, y, r))

        def paint(painter: Painter) -> None:
            _, edge, width, dash, _ = self.look(item)
            path: list[XY] = []
            for i, (_, _, _, r, _, *turn) in zip(at, item["p"], strict=True):
                x, y = self.points[i]
                if not turn:
                    path.append((x, y))
                    continue
                meets, leaves = self.value(turn[0]), self.value(turn[1])
                if not math.isfinite(meets + leaves):
                    continue
                size = self.value(r) * self.scale
                count = max(1, math.ceil(abs(leaves - meets) / ROUND)) if size else 0
                for k in range(count + 1):
                    angle = meets + (leaves - meets) * k / max(count, 1)
                    path.append((x + size * math.cos(angle), y - size * math.sin(angle)))
            if item.get("c"):
                path.append(path[0])
            self._stroke(painter, path, edge, width, dash)
        return paint

    def _sag(self, item: Item) -> Plan:
        a, b, share = self._place(item["a"]), self._place(item["b"]), np.linspace(0, 1, 13)

        def paint(painter: Painter) -> None:
            _, edge, width, dash, _ = self.look(item)
            depth = 4 * self.value(item["depth"]) * self.scale * share * (1 - share)
            path = self.px[a] + share[:, None] * (self.px[b] - self.px[a])
            path[:, 1] += depth
            self.touch(*path)
            self._stroke(painter, path.tolist(), edge, width, dash)
        return paint

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

    def _arrows(self, item: Item) -> Plan:
        shaft, head = item["size"]

        def paint(painter: Painter) -> None:
            fill, rim, width, _, _ = self.look(item)
            _, tails, tips, sizes = self.arrows(item)
            u = self.point * (0.8 if self.small else 1.0)
            for a, b, size in zip(tails.tolist(), tips.tolist(), sizes.tolist(), strict=True):
                self.touched.append((min(a[0], b[0]), min(a[1], b[1]), max(a[0], b[0]),
                                     max(a[1], b[1])))
                if rim is not None:
                    self._solid(painter, arrow(a, b, shaft * u + width, head * u + width / 2), rim)
                self._solid(painter, arrow(a, b, shaft * u, head * u), fill)
                if size > item["most"] and rim is not None:
                    self._cut_bars(painter, a, b, (shaft + 6.5) / 2 * u, rim)
        return paint

    def _solid(self, painter: Painter, corners: Sequence[XY], fill: Colour | None) -> None:
        corners = self._cut(corners)
        if len(corners) > 2:
            painter.simple(corners, fill, None, 0)

    def _cut_bars(self, painter: Painter, tail: XY, tip: XY, half: float, ink: Colour) -> None:
        """Two slanted bars across an arrow that would be longer."""
        length = math.dist(tail, tip) or 1.0
        ux, uy = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
        lean = 2 * self.point
        for share in (0.40, 0.50):
            x, y = (a + share * (b - a) for a, b in zip(tail, tip, strict=True))
            if within([(x, y)], self.edges):
                painter.line([(x + uy * half - ux * lean, y - ux * half - uy * lean),
                              (x - uy * half + ux * lean, y + ux * half + uy * lean)], ink,
                             1.8 * self.point)

    def _strips(self, item: Item) -> Plan:
        def paint(painter: Painter) -> None:
            fill, edge, width, _, _ = self.look(item)
            for row in self.rows(item):
                corners: list[XY] = self.to_pixels(row[2:10].reshape(4, 2)).tolist()
                if within(corners, self.edges):
                    self.touch(*corners)
                    painter.simple(corners, fill, edge, width)
        return paint

    def _trail(self, item: Item) -> Plan:
        at, out = self._place(item["at"]), self.out
        way = out.place(item["at"])
        step = FINEST * self.point / self.scale
        kept = _apart(way, step)
        every, first = item["every"], float(out.time[0])
        count = math.floor(first / every * (1 - 1e-9)) + 1
        times = np.arange(count, math.floor(float(out.time[-1]) / every * (1 + 1e-9)) + 1) * every
        spots = np.stack([np.interp(times, out.time, way[:, k]) for k in (0, 1)], axis=1)
        spots_kept = _apart(spots, MARKS_APART * self.point / self.scale)

        def paint(painter: Painter) -> None:
            fill, edge, width, _, _ = self.look(item)
            width = max(width, 1.2 / self.factor)
            passed = kept[:int(np.searchsorted(kept, self.sample, side="right"))][-MOST_PIECES:]
            path: list[XY] = [*self.to_pixels(way[passed]).tolist(), self.points[at]]
            self._stroke(painter, path, edge, width)
            for k in range(0, len(path) - 1, 8):
                self.touch(*path[k:k + 9])
            seen = [k for k in spots_kept.tolist() if times[k] <= self.time * (1 + 1e-9)]
            marks = self.to_pixels(spots[seen]).tolist() if seen else []
            for centre, radius in (*((mark, item["mark"]) for mark in marks),
                                   (self.points[at], 1.5 * width / self.point)):
                if within([centre], self.edges):
                    painter.disc(centre, radius * self.point, fill, None, 0)
        return paint

    def _text(self, item: Item) -> None:
        item_at = self._place(item["at"])
        self.texts.append((item, item_at))

    # -- labels -----------------------------------------------------------------------------------

    def labels(self) -> Iterator[Label]:
        """All texts and values of this instant, also those that have no place."""
        for item, at in self.texts:
            if ("if" in item and self.value(item["if"]) <= 0.5) or "edge" in item:
                continue
            words = item["words"]
            if "value" in item:
                value = self.value(item["value"])
                words = f"{words} {self.write(item, value)}".strip()
            yield self._label(item, 0, words, self.points[at], (0.0, 0.0), item,
                              item.get("clear", 0.0))
        for item in self.out.items:
            if item["k"] == "arrows":
                rows, tails, tips, sizes = self.arrows(item)
                values = rows[:, 6] if rows.shape[1] > 6 else sizes
                for row, tail, tip, size, value in zip(rows, tails.tolist(), tips.tolist(), sizes,
                                                       values.tolist(), strict=True):
                    if size >= 0.5 * item.get("told", 0.0):
                        key = int(row[1])
                        name = (item.get("names") or {}).get(key, "")
                        away = (tip[0] - tail[0], tip[1] - tail[1])
                        yield self._label(item, key, f"{name} {self.write(item, value)}".strip(),
                                          tip, away, item.get("labels", {}).get(key))
            elif item["k"] == "strips":
                for row in self.rows(item):
                    if row[10] >= item["least"]:
                        corners = self.to_pixels(row[2:10].reshape(4, 2))
                        high = np.hypot(*(corners[[2, 3]] - corners[[1, 0]]).T)
                        tip, foot = (corners[[2, 1]] if high[0] > high[1] else corners[[3, 0]])
                        yield self._label(item, int(row[1]), self.write(item, float(row[10])),
                                          tuple(tip.tolist()), tuple((tip - foot).tolist()),
                                          item.get("labels", {}).get(int(row[1])))

    def _label(self, item: Item, key: int, words: str, point: XY, away: XY, place: Any,
               clear: float = 0.0) -> Label:
        fill, edge, *_ = self.look(item)
        ink = (edge if item["k"] == "text" else fill) or (0, 0, 0)
        side = -1
        if isinstance(place, dict):  # a text has its place in the item itself
            place = [place["side"], place["show"]] if "side" in place else None
        if place is not None and self.value(place[1]) > 0.5:
            side = int(place[0])
        return Label(item, key, words, point, away, ink, side, clear)

    @staticmethod
    def write(item: Item, value: float) -> str:
        """A value with its unit, as the item says."""
        return f"{written(value, item['factor'], item['decimals'])} {item['unit']}"


def offset(side: int, half: tuple[float, float], clear: float, point: float) -> XY:
    """From a label's point to its middle [pixels], for half its size, y down."""
    dx, dy, far = SIDES[side]
    reach = (3 + far) * point + clear
    return dx * (half[0] + reach), -dy * (half[1] + reach)


def paint_labels(instant: Instant, painter: Painter, type_size: int,
                 half: Callable[[str], tuple[float, float]]) -> None:
    """Write the labels that have a place."""
    factor = instant.factor
    for label in instant.labels():
        if label.side < 0 or not within([label.point], instant.edges):
            continue
        x, y = label.point[0] * factor, label.point[1] * factor
        point = instant.point * factor
        dx, dy = offset(label.side, half(label.words), label.clear * point, point)
        leader: list[XY] = []
        if SIDES[label.side][2]:
            ux, uy, far = SIDES[label.side]
            reach = (far + 2) * point + label.clear * point
            leader = [(x + ux * 2 * point, y - uy * 2 * point), (x + ux * reach, y - uy * reach)]
        painter.text((x + dx, y + dy), label.words, type_size, label.ink, leader)


def _apart(points: Array, least: float) -> Any:
    """Numbers of the points [n, 2] that are ``least`` apart, each from the last one."""
    kept: list[int] = []
    last = (math.inf, math.inf)
    for k, (x, y) in enumerate(points.tolist()):
        if math.isfinite(x + y) and not math.dist(last, (x, y)) < least:
            kept.append(k)
            last = (x, y)
    return np.array(kept, dtype=np.intp)


def _square(x: float, y: float, half: float) -> list[XY]:
    """The corners of a square, whose box holds a circle however it is turned."""
    return [(x + half * a, y + half * b) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]


def _rgb(colour: str) -> Colour:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def hatch_ink(edge: Colour) -> Colour:
    """The colour of hatching in a fill with this edge."""
    return lighter(edge, 0.45)


def hatch_lines(corners: Sequence[XY], pitch: float) -> list[tuple[XY, XY]]:
    """Slanted lines over the box of some corners; neighbouring areas have the same ones."""
    points = np.asarray(corners)
    (x0, y0), (x1, y1) = points.min(axis=0).tolist(), points.max(axis=0).tolist()
    starts = np.arange((x0 + y0) // pitch * pitch, x1 + y1 + pitch, pitch).tolist()
    return [((c - y0, y0), (c - y1, y1)) for c in starts]

