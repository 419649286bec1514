"""A display list at one time, as areas, lines and discs in pixels: what every painter takes."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sandbox.numeric import Array
from sandbox.picture.bounds import Camera
from sandbox.picture.geometry import (
    XY,
    Edges,
    arc_steps,
    arrow,
    capsule_outline,
    cut_line,
    cut_polygon,
    dashes,
    large_circle,
    polygon_grown,
    within,
)
from sandbox.picture.listing import Item, Listing
from sandbox.picture.moment import Moment
from sandbox.picture.palette import Colour, Painter
from sandbox.picture.scales import written

Plan = Callable[[Painter], None]
REACH = {"mark": 20.0, "span": 13.0, "taut": 6.0}
"""How far beside their points items of a kind reach, 7 points for others."""
ROUND = 0.15
"""Angle between corners of arcs, at most [rad]."""
DETAILS = frozenset(("dot", "eye"))
"""Glyphs that small pictures leave out; they have no hatching, either."""
FINEST, MARKS_APART, MOST_PIECES = 3.0, 9.0, 5000
"""Least length of the pieces of a trail, and least distance of its marks [points]; pieces at most:
the latest ones."""


class Label(NamedTuple):
    """A text of an instant: what it says, its point and where it stands."""

    item: Item
    key: int
    words: str
    point: XY
    away: XY
    ink: Colour
    side: int
    """-1 where it has no place."""
    clear: float


class Instant(Moment):
    """What to paint of a display list: for each item a function of the painter."""

    def __init__(self, out: Listing, camera: Camera, point: float, edges: Edges, *,
                 factor: float = 1.0, small: bool = False) -> None:
        """See :class:`Moment`."""
        super().__init__(out, camera, point, edges, factor=factor, small=small)
        self.texts: list[tuple[Item, int]] = []
        self.still_plans: list[Plan] = []
        self.plans: list[Plan] = []
        for item in out.items:
            self._plan(item)
        self._join()

    def _plan(self, item: Item) -> None:
        first = self._count
        plan: Plan | None = getattr(self, f"_{item['k']}")(item)
        if plan is None:
            return
        if self._count > first:
            self.outlines.append(slice(first, self._count))
        if not self.plans and self._stays(item):
            self.still_plans.append(plan)
            return
        self.plans.append(self._where(item["if"], plan) if "if" in item else plan)
        if self._count > first:
            self._extents.append((first, max(item["r"]) + 14 if item["k"] == "spiral"
                                  else REACH.get(item["k"], 7.0)))

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
        numbers = [item.get(key) for key in ("if", "by", "state", "wide", "turn")]
        numbers += [d["c"][4] for d in item.get("d", ()) if isinstance(d, dict)]
        return not (any(isinstance(number, list) for number in numbers)
                    or any(self._moves[frame] for frame in frames))

    def paint(self, painter: Painter) -> None:
        """Paint what moves."""
        self._list_points()
        self.touched.clear()
        for plan in self.plans:
            plan(painter)

    def paint_still(self, painter: Painter) -> None:
        """Paint what stays, behind all else."""
        self._list_points()
        for plan in self.still_plans:
            plan(painter)

    def _path(self, item: Item) -> Plan:
        if len(item["d"]) == 1 and isinstance(item["d"][0], dict):
            x0, y0, x1, y1, radius = item["d"][0]["c"]
            if (x0, y0) == (x1, y1):
                return self._circle(item, self._place([item["f"], x0, y0]), radius)
        union, width = bool(item.get("m")), self.out.styles[item["s"]][2]
        half = width / 2 * self.point * self.thin / self.scale
        rings = []
        for ring in self._rings(item["d"]):
            line = outer = inner = self._pool(item["f"], ring)
            if width:
                outer = self._pool(item["f"], polygon_grown(ring, half * (2 if union else 1)))
                inner = line if union else self._pool(item["f"], polygon_grown(ring, -half))
            rings.append((line, outer, inner))
        if self.out.styles[item["s"]][0] not in ("", "paper", "liquid"):
            self.fills += [line for line, _, _ in rings[:None if union else 1]]

        def paint(painter: Painter) -> None:
            fill, edge, now, _, hatch = self.look(item)
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

    def _circle(self, item: Item, at: int, radius: Any) -> Plan:
        if not isinstance(radius, list):  # its box
            x, y = item["d"][0]["c"][:2]
            self.fills.append(self._pool(item["f"], _square(x, y, radius)))

        def paint(painter: Painter) -> None:
            fill, edge, width, _, hatch = self.look(item)
            size, (x, y) = self.value(radius) * self.scale, self.points[at]
            if isinstance(radius, list):
                self.touch(*_square(x, y, size))
            left, top, right, bottom = self.edges
            if size < 4 * math.hypot(right - left, bottom - top):
                if math.isfinite(x + y) and (left - size <= x <= right + size
                                             and top - size <= y <= bottom + size):
                    painter.disc((x, y), size, fill, edge, width, hatch=hatch)
            elif len(ring := large_circle((x, y), size, self.edges)) > 2:
                painter.area([[ring, ring, ring]], fill, edge, width, hatch=hatch)
        return paint

    def _rings(self, subpaths: Sequence[Any]) -> Iterator[Array]:
        """Corners of closed subpaths, without those that repeat."""
        error = 0.3 / self.scale
        for one in subpaths:
            ring = np.array([] if isinstance(one, dict) else one).reshape(-1, 2)
            if isinstance(one, dict):
                x0, y0, x1, y1, r = one["c"]
                steps = min(400, arc_steps(max(r, 2 * error), error, 6))
                ring = capsule_outline((x0, y0), (x1, y1), r, steps)
            apart = np.hypot(*(ring - np.roll(ring, 1, axis=0)).T) > 0
            if apart.sum() > 2:
                yield ring[apart]

    def _line(self, item: Item) -> Plan:
        at = [self._place(point) for point in item["p"]]

        def paint(painter: Painter) -> None:
            self._stroke(painter, [self.points[i] for i in at], item)
        return paint

    def _stroke(self, painter: Painter, path: Sequence[XY], item: Item) -> None:
        """Connected lines in an item's style."""
        _, edge, width, dash, _ = self.look(item)
        self._draw_line(painter, path, edge, width, dash)

    def _draw_line(self, painter: Painter, path: Sequence[XY], ink: Colour | None, width: float,
                   dash: float = 0.0) -> None:
        """Connected lines, cut if they are far outside, in dashes if asked for."""
        if ink is None or len(path) < 2:
            return
        pieces: list[Sequence[XY]] = [path]
        if self.wild and not within(path, self.edges):
            pieces = [piece for a, b in pairwise(path) if (piece := cut_line(a, b, self.edges))]
        for one in pieces:
            for part in dashes(one, dash, 0.8 * dash) if dash else (one,):
                painter.line(part, ink, width)

    def _mark(self, item: Item) -> Plan | None:
        names = item["g"] if isinstance(item["g"], list) else [item["g"]]
        if self.small and DETAILS & set(names):
            return None
        at, made = self._place(item["at"]), [self.glyph(name) for name in names]
        ends = np.concatenate([points + sign * radius for _, points, radius, _ in made[-1]
                               for sign in (-1, 1)])
        self.marks.append((at, np.array([ends.min(axis=0), ends.max(axis=0)])))

        def paint(painter: Painter) -> None:
            state = round(self.value(item["state"])) if "state" in item else 0
            if not self.wild or within([self.points[at]], self.edges):
                self.stamp(painter, made[min(len(made) - 1, max(0, state))], self.points[at],
                           self.value(item.get("turn", 0.0)))
        return paint

    def glyph(self, name: str, point: float | None = None) -> list[Any]:
        """Parts of a glyph in pixels, y down: kind, points, radius, style."""
        parts: list[Any] = []
        point = point or self.point
        u = point * (0.85 if self.small else 1.0)
        for number, d in self.out.glyphs[name]:
            fill, edge, width, dash, _ = self.out.styles[number]
            kind, flat, radius = "ring", d, 0.0
            if isinstance(d, dict):
                kind, flat, radius = ("line", d["l"], 0.0) if "l" in d else (
                    "disc", d["c"][:2], d["c"][4] * u)
            parts.append((kind, np.array(flat, dtype=float).reshape(-1, 2) * (u, -u), radius,
                          (self.ink(fill, 1.0), self.ink(edge, 1.0), width * point, dash * point)))
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
                self._draw_line(painter, here, edge, width, dash)

    def _span(self, item: Item) -> Plan:
        a, b = self._place(item["a"]), self._place(item["b"])
        pattern = np.array(item["t"], dtype=float).reshape(-1, 2)

        def paint(painter: Painter) -> None:
            piece: tuple[XY, XY] | None = (self.points[a], self.points[b])
            if self.wild and not within((self.points[a], self.points[b]), self.edges):
                piece = cut_line(self.points[a], self.points[b], self.edges)
            if piece is None:
                return
            start, way = np.array(piece[0]), np.array(piece[1]) - np.array(piece[0])
            length = max(math.hypot(*way), 1e-9)
            along, side = way / length, np.array((way[1], -way[0])) / length  # side: left, y up
            if "every" in item:
                step = item["every"] * self.point
                stroke = self.point * (pattern[:, :1] * along + pattern[:, 1:] * side)
                _, edge, width, _, _ = self.look(item)
                for k in range(1, math.ceil(length / step)):
                    self._draw_line(painter, (start + k * step * along + stroke).tolist(), edge,
                                    width)
                return
            share, low, high = item["w"]
            half = min(max(share * length, low * self.point), high * self.point)
            path = start + pattern[:, :1] * way + half * pattern[:, 1:] * side
            self._stroke(painter, path.tolist(), item)
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
            keep, head = len(path), item.get("head", 0.0) * self.point
            if head:
                back = min(0.8 * abs(sweep), head / (radius[-1] * self.point))
                keep = max(2, round(len(path) * (1 - back / max(abs(sweep), 1e-9))))
            self._draw_line(painter, path[:keep], edge, width)
            if head:
                painter.simple(arrow(path[keep - 1], path[-1], width, head), edge, None, 0)
        return paint

    def _taut(self, item: Item) -> Plan:
        at = [self._place(point) for point in item["p"]]
        for frame, x, y, r, *_ in item["p"]:  # boxes of the wheels
            if not isinstance(r, list) and r:
                self._pool(frame, _square(x, y, r))

        def paint(painter: Painter) -> None:
            path: list[XY] = []
            for i, (_, _, _, r, _, *turn) in zip(at, item["p"], strict=True):
                x, y = self.points[i]
                if not turn:
                    path.append((x, y))
                    continue
                meets, leaves = self.value(turn[0]), self.value(turn[1])
                if math.isfinite(meets + leaves):
                    size = self.value(r) * self.scale
                    count = max(1, math.ceil(abs(leaves - meets) / ROUND)) if size else 0
                    for k in range(count + 1):
                        angle = meets + (leaves - meets) * k / max(count, 1)
                        path.append((x + size * math.cos(angle), y - size * math.sin(angle)))
            self._stroke(painter, [*path, path[0]] if item.get("c") else path, item)
        return paint

    def _sag(self, item: Item) -> Plan:
        a, b, share = self._place(item["a"]), self._place(item["b"]), np.linspace(0, 1, 13)

        def paint(painter: Painter) -> None:
            path = self.px[a] + share[:, None] * (self.px[b] - self.px[a])
            path[:, 1] += 4 * self.value(item["depth"]) * self.scale * share * (1 - share)
            self.touch(*path)
            self._stroke(painter, path.tolist(), item)
        return paint

    def _arrows(self, item: Item) -> Plan:
        shaft, head = item["size"]

        def paint(painter: Painter) -> None:
            fill, rim, width, _, _ = self.look(item)
            _, tails, tips, sizes = self.arrows(item)
            u = self.point * (0.8 if self.small else 1.0)
            for a, b, size in zip(tails.tolist(), tips.tolist(), sizes.tolist(), strict=True):
                self.touched.append((min(a[0], b[0]), min(a[1], b[1]), max(a[0], b[0]),
                                     max(a[1], b[1])))
                for ink, more in ((rim, width), (fill, 0.0)):
                    corners = self._cut(arrow(a, b, shaft * u + more, head * u + more / 2))
                    if ink is not None and len(corners) > 2:
                        painter.simple(corners, ink, None, 0)
                if size > item["most"] and rim is not None:
                    self._cut_bars(painter, a, b, (shaft + 6.5) / 2 * u, rim)
        return paint

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
            for corners in self.camera.to_pixels(self.rows(item)[:, 2:10].reshape(-1, 4, 2)):
                if within(corners.tolist(), self.edges):
                    self.touch(*corners)
                    painter.simple(corners.tolist(), fill, edge, width)
        return paint

    def _trail(self, item: Item) -> Plan:
        at, time, way = self._place(item["at"]), self.out.time, self.out.place(item["at"])
        kept, every = _apart(way, FINEST * self.point / self.scale), item["every"]
        first, last = (math.floor(float(time[k]) / every * (1 + sign * 1e-9))
                       for k, sign in ((0, -1), (-1, 1)))
        times = np.arange(first + 1, last + 1) * every
        spots = np.stack([np.interp(times, time, way[:, k]) for k in (0, 1)], axis=1)
        some = _apart(spots, MARKS_APART * self.point / self.scale)
        times, spots = times[some], spots[some]

        def paint(painter: Painter) -> None:
            fill, edge, width, _, _ = self.look(item)
            width = max(width, 1.5 / self.factor)
            passed = kept[:int(np.searchsorted(kept, self.sample, side="right"))][-MOST_PIECES:]
            path: list[XY] = [*self.camera.to_pixels(way[passed]).tolist(), self.points[at]]
            self._draw_line(painter, path, edge, width)
            for k in range(0, len(path) - 1, 8):
                self.touch(*path[k:k + 9])
            marks = self.camera.to_pixels(spots[times <= self.time * (1 + 1e-9)]).tolist()
            for centre, radius in (*((mark, item["mark"] * self.point) for mark in marks),
                                   (self.points[at], 1.5 * width)):
                if within([centre], self.edges):
                    painter.disc(centre, radius, fill, None, 0)
        return paint

    def _text(self, item: Item) -> None:
        self.texts.append((item, self._place(item["at"])))

    def labels(self) -> Iterator[Label]:
        """All texts and values of this instant, also those that have no place."""
        self._list_points()
        for item, at in self.texts:
            if ("if" in item and self.value(item["if"]) <= 0.5) or "edge" in item:
                continue
            place = [item["side"], item["show"]] if "side" in item else None
            yield self._label(item, 0, item["words"], self.value(item.get("value", 0.0)),
                              self.points[at], (0.0, 0.0), place)
        for item in self.out.items:
            places, names = item.get("labels", {}), item.get("names") or {}
            if item["k"] == "arrows":
                rows, tails, tips, sizes = self.arrows(item)
                values = rows[:, 6] if rows.shape[1] > 6 else sizes
                for key, tail, tip, size, value in zip(
                        rows[:, 1].astype(int).tolist(), tails.tolist(), tips.tolist(), sizes,
                        values.tolist(), strict=True):
                    if size >= 0.5 * item.get("told", 0.0):
                        away = (tip[0] - tail[0], tip[1] - tail[1])
                        yield self._label(item, key, names.get(key, ""), value, tip, away,
                                          places.get(key))
            elif item["k"] == "strips":
                for row in self.rows(item):
                    if row[10] >= item["least"]:
                        corners = self.camera.to_pixels(row[2:10].reshape(4, 2))
                        high = np.hypot(*(corners[[2, 3]] - corners[[1, 0]]).T)
                        tip, foot = corners[[2, 1]] if high[0] > high[1] else corners[[3, 0]]
                        yield self._label(item, int(row[1]), "", float(row[10]),
                                          tuple(tip.tolist()), tuple((tip - foot).tolist()),
                                          places.get(int(row[1])))

    def _label(self, item: Item, key: int, words: str, value: float, point: XY, away: XY,
               place: Any) -> Label:
        if "factor" in item:
            number = f"{written(value, item['factor'], item['decimals'])} {item['unit']}"
            words = f"{words} {number}".strip()
        fill, edge, *_ = self.look(item)
        ink = (edge if item["k"] == "text" else fill) or (0, 0, 0)
        side = int(place[0]) if place is not None and self.value(place[1]) > 0.5 else -1
        return Label(item, key, words, point, away, ink, side, item.get("clear", 0.0))


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
