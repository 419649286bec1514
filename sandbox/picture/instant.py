"""A display list at one time: poses, columns and points in pixels, as painters take them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sandbox.model.joints import placed
from sandbox.numeric import Array
from sandbox.picture import geometry
from sandbox.picture.bounds import Camera
from sandbox.picture.geometry import XY, Edges
from sandbox.picture.listing import Item, Listing
from sandbox.picture.palette import Colour, Ink, Painter
from sandbox.values.appearance import rgb

Plan = tuple[Any, Callable[[Painter], object]]  # where it is shown, and the function that paints
STEPS = 1e3  # steps of a number, from 0 to its maximum, that look different
FINEST, MARKS_APART, MAX_PIECES = 3.0, 9.0, 5000  # trails: pieces, marks [points]; number


class Label(NamedTuple):
    """A text of an instant: its words, its point and its side."""

    item: Item
    key: int
    words: str
    point: XY
    away: XY
    ink: Colour
    side: int  # -1 without a place


class Instant:
    """A display list for one camera: a function that paints each item; lengths are in pixels."""

    def __init__(self, out: Listing, camera: Camera, point: float, size: tuple[int, int], *,
                 enlarge: int = 1, small: bool = False) -> None:
        self.out, self.still_camera, self.camera, self.point = out, camera, camera, point
        self.size, self.factor = size, 1 / enlarge
        wide, high = size
        self.edges: Edges = (-wide, -high, 2 * wide, 2 * high)  # limits of coordinates [pixels]
        self.scale, self.small = camera.scale, small
        self.thin, self.hatch = (0.75, 0.0) if small else (1.0, 7.0 * point)  # of hatching [points]
        self._columns = np.array(out.columns).reshape(-1, len(out.time)).T
        self._steady = np.isin(np.arange(len(out.columns)), out.steady)
        self._first = {name: np.searchsorted(rows[:, 0], np.arange(len(out.time) + 1))
                       for name, rows in out.tables.items()}
        self._maxima = {name: _maxima(rows) for name, rows in out.tables.items() if len(rows)}
        self._sizes = _maxima(self._columns)
        self._inks = {token: rgb(pair[0]) for token, pair in out.inks.items()}
        self._ramps = {name: [[rgb(c) for c in side] for side in sides]
                       for name, sides in out.ramps.items()}
        self._glyphs = {name: self.glyph(name) for name in out.glyphs}
        self.px: Any = np.zeros((0, 2))  # all points [pixels]
        self.points: list[XY] = []  # the same, made when they are painted
        self.wild = False  # whether a point is far outside of the picture, or not finite
        self.texts: list[tuple[Item, int]] = []
        self._plans: list[Plan] = []
        self._places: list[Sequence[float]] = []  # frame, x, y and offset of all points
        for item in out.items:
            self._plan(item)
        places = np.array(self._places).reshape(-1, 5)
        self._frame, self._local = places[:, 0].astype(int), places[:, 1:3]
        self._offset = places[:, 3:] * (point, -point)

    def _place(self, point: Sequence[Any]) -> int:
        """Add a point of the list; its place in ``points``."""
        self._places.append((*point, 0.0, 0.0)[:5])
        return len(self._places) - 1

    def _place_ring(self, frame: int, ring: Array) -> slice:
        """Add points [n, 2] of a frame; their places."""
        first = len(self._places)
        self._places += [(frame, x, y, 0.0, 0.0) for x, y in ring.tolist()]
        return slice(first, len(self._places))

    def _plan(self, item: Item) -> None:
        kind = item["k"]
        points = item.get("p", [item[key] for key in ("at", "a", "b") if key in item])
        if self.small and item.get("g") in ("dot", "eye"):
            return
        if kind == "taut":  # what follows a guide's centre is no offset
            points = [point[:3] for point in points]
        at: list[Any] = [self._place(point) for point in points]
        if kind == "text":
            self.texts.append((item, at[0]))
            return
        if kind == "path":
            kind, at = self._outline(item)
        elif kind == "trail":
            at += self._trail_marks(item)
        self._plans.append((item.get("if", 1.0), partial(getattr(self, f"_{kind}"), item, at)))

    def go_to(self, t: float) -> None:
        """Set the time [s]: interpolate poses and columns, and project all points."""
        time, out = self.out.time, self.out
        j = int(np.clip(np.searchsorted(time, t), 0, len(time) - 1))
        i = max(j - 1, 0) if t < time[j] else j
        w = float((t - time[i]) / (time[j] - time[i])) if i < j else 0.0

        def between(rows: Array) -> Array:
            return np.asarray(rows[i] if i == j else (1 - w) * rows[i] + w * rows[j])

        self.time, self.sample = t, j if w > 0.5 else i
        self.values = np.where(self._steady, self._columns[self.sample],
                               between(self._columns)).tolist()
        if out.drift is not None:
            (x, y), (dx, dy) = self.still_camera.centre, between(out.drift).tolist()
            self.camera = self.still_camera._replace(centre=(x + dx, y + dy))
        self.px = self._offset + self.camera.to_pixels(
            placed(between(out.pose)[self._frame], self._local))
        self.points = []  # frames that look equal need none
        left, top, right, bottom = self.edges
        self.wild = bool(len(self.px)) and not (
            self.px.min() >= min(left, top) and self.px[:, 0].max() <= right
            and self.px[:, 1].max() <= bottom)

    def key(self) -> bytes:
        """Equal for times that look the same."""
        parts = [self.px, np.array(self.values) / self._sizes * STEPS]
        parts += [self.rows({"t": name})[:, 1:] / maxima[1:] * STEPS
                  for name, maxima in self._maxima.items()]
        if any(item["k"] == "trail" for item in self.out.items):
            parts.append(np.array([self.sample]))
        steps: Array = np.concatenate([part.ravel() for part in parts])
        return (np.rint(steps) + 0.0).tobytes()  # -0 looks like 0

    def value(self, number: Any) -> float:
        """A number, or a column's value."""
        return float(self.values[number[0]]) if isinstance(number, list) else float(number)

    def ink(self, token: str, by: float = 0.0) -> Ink:
        """The colour of a token; ``by`` is the place on a ramp."""
        if token[:1] == "@":
            ramp = self._ramps[token[1:]][by >= 0]
            return ramp[min(len(ramp) - 1, int(abs(by) * (len(ramp) - 1) + 0.5))]
        return self._inks.get(token)

    def look(self, item: Item) -> tuple[Ink, Ink, float, float, float]:
        """Fill, edge, width, dash and pitch of hatching [pixels] of an item now."""
        number = item["s"]
        if isinstance(number, list):
            number = number[min(len(number) - 1, max(0, round(self.value(item["state"]))))]
        fill, edge, width, dash, hatched = self.out.styles[number]
        by, wide = self.value(item.get("by", 0.0)), self.value(item.get("wide", 1.0))
        return (self.ink(fill, by), self.ink(edge, by), width * wide * self.point * self.thin,
                dash * self.point, self.hatch if hatched else 0.0)

    def rows(self, item: Item) -> Array:
        """The rows of an item's table in this sample."""
        first = self._first[item["t"]]
        return self.out.tables[item["t"]][first[self.sample]:first[self.sample + 1]]

    def paint(self, painter: Painter) -> None:
        """Paint all items."""
        self.points = self.points or self.px.tolist()
        for shown, plan in self._plans:
            if self.value(shown) > 0.5:
                plan(painter)

    def _outline(self, item: Item) -> tuple[str, list[Any]]:
        """The kind of a path, a circle or an area, and the places of its points."""
        first = item["d"][0]
        if len(item["d"]) == 1 and isinstance(first, dict) and first["c"][:2] == first["c"][2:4]:
            return "circle", [self._place([item["f"], *first["c"][:2]])]
        union, width = bool(item.get("m")), self.out.styles[item["s"]][2]
        half = width / 2 * self.point * self.thin / self.scale
        rings = []
        for ring in self._rings(item["d"]):
            line = outer = inner = self._place_ring(item["f"], ring)
            if width:
                grown = geometry.polygon_grown(ring, half * (2 if union else 1))
                outer = self._place_ring(item["f"], grown)
                if not union:
                    inner = self._place_ring(item["f"], geometry.polygon_grown(ring, -half))
            rings.append((line, outer, inner))
        return "area", rings

    def _area(self, item: Item, rings: Any, painter: Painter) -> None:
        fill, edge, now, _, hatch = self.look(item)
        found: list[Any] = [[self.points[part] for part in ring] for ring in rings]
        if self.wild:
            cut = ([geometry.cut_polygon(part, self.edges) for part in ring] for ring in found)
            found = [ring for ring in cut if all(len(part) > 2 for part in ring)]
        if found:
            painter.area(found, fill, edge, now, union=bool(item.get("m")), hatch=hatch)

    def _circle(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        fill, edge, width, _, hatch = self.look(item)
        size, (x, y) = self.value(item["d"][0]["c"][4]) * self.scale, self.points[at[0]]
        left, top, right, bottom = self.edges
        if size < 4 * math.hypot(right - left, bottom - top):
            if math.isfinite(x + y) and (left - size <= x <= right + size
                                         and top - size <= y <= bottom + size):
                painter.disc((x, y), size, fill, edge, width, hatch=hatch)
        elif len(ring := geometry.large_circle((x, y), size, self.edges)) > 2:
            painter.area([[ring, ring, ring]], fill, edge, width, hatch=hatch)

    def _rings(self, subpaths: Sequence[Any]) -> Iterator[Array]:
        """Corners of closed subpaths, without repeated ones."""
        error = 0.3 / self.scale
        for one in subpaths:
            if isinstance(one, dict):
                x0, y0, x1, y1, r = one["c"]
                steps = min(400, geometry.arc_steps(max(r, 2 * error), error, 6))
                ring = geometry.capsule_outline((x0, y0), (x1, y1), r, steps)
            else:
                ring = np.array(one).reshape(-1, 2)
            apart = np.hypot(*(ring - np.roll(ring, 1, axis=0)).T) > 0
            if apart.sum() > 2:
                yield ring[apart]

    def _draw_line(self, painter: Painter, path: Sequence[XY], ink: Ink, width: float,
                   dash: float = 0.0) -> None:
        """Connected lines, cut where they are far outside."""
        if ink is None or len(path) < 2:
            return
        pieces: list[Sequence[XY]] = [path]
        if self.wild and not geometry.within(path, self.edges):
            cut = (geometry.cut_line(a, b, self.edges) for a, b in pairwise(path))
            pieces = [piece for piece in cut if piece]
        for one in pieces:
            for part in geometry.dashes(one, dash, 0.8 * dash) if dash else (one,):
                painter.line(part, ink, width)

    def _stroke(self, painter: Painter, item: Item, paths: Iterable[Sequence[XY]]) -> None:
        _, edge, width, dash, _ = self.look(item)
        for path in paths:
            self._draw_line(painter, path, edge, width, dash)

    def _line(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        self._stroke(painter, item, [[self.points[i] for i in at]])

    def _sag(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        (a, b), share = self.px[at], np.linspace(0, 1, 13)
        path = a + share[:, None] * (b - a)
        path[:, 1] += 4 * self.value(item["depth"]) * self.scale * share * (1 - share)
        self._stroke(painter, item, [path.tolist()])

    def _taut(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        path: list[XY] = []
        for i, (_, _, _, r, _, *turn) in zip(at, item["p"], strict=True):
            x, y = self.points[i]
            if not turn:
                path.append((x, y))
                continue
            meets, leaves = self.value(turn[0]), self.value(turn[1])
            if math.isfinite(meets + leaves):
                size = r * self.scale
                count = max(1, math.ceil(abs(leaves - meets) / 0.15)) if size else 0
                for k in range(count + 1):
                    angle = meets + (leaves - meets) * k / max(count, 1)
                    path.append((x + size * math.cos(angle), y - size * math.sin(angle)))
        self._stroke(painter, item, [[*path, path[0]] if item.get("c") else path])

    def _span(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        piece: tuple[XY, XY] | None = (self.points[at[0]], self.points[at[1]])
        if self.wild and piece is not None and not geometry.within(piece, self.edges):
            piece = geometry.cut_line(*piece, self.edges)
        if piece is None:
            return
        pattern = np.array(item["t"], dtype=float).reshape(-1, 2)
        start, way = np.array(piece[0]), np.array(piece[1]) - np.array(piece[0])
        length = max(math.hypot(*way), 1e-9)
        along, side = way / length, np.array((way[1], -way[0])) / length  # side: left, y up
        if "every" in item:
            step = item["every"] * self.point
            stroke = self.point * (pattern[:, :1] * along + pattern[:, 1:] * side)
            paths = [start + k * step * along + stroke for k in range(1, math.ceil(length / step))]
        else:
            share, low, high = item["w"]
            half = min(max(share * length, low * self.point), high * self.point)
            paths = [start + pattern[:, :1] * way + half * pattern[:, 1:] * side]
        self._stroke(painter, item, [path.tolist() for path in paths])

    def _spiral(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        _, edge, width, _, _ = self.look(item)
        if edge is None or not geometry.within([self.points[at[0]]], self.edges):
            return
        share, sweep = np.linspace(0, 1, 30), self.value(item["sweep"])
        radius = item["r"][0] + (item["r"][1] - item["r"][0]) * share
        angle = self.value(item["start"]) + sweep * share
        path: list[XY] = (self.px[at[0]] + self.point * radius[:, None] * np.column_stack(
            (np.cos(angle), -np.sin(angle)))).tolist()
        keep, head = len(path), item.get("head", 0.0) * self.point
        if head:
            back = min(0.8 * abs(sweep), head / (radius[-1] * self.point))
            keep = max(2, round(len(path) * (1 - back / max(abs(sweep), 1e-9))))
        self._draw_line(painter, path[:keep], edge, width)
        if head:
            painter.simple(geometry.arrow(path[keep - 1], path[-1], width, head), edge, None, 0)

    def _mark(self, item: Item, at: Sequence[int], painter: Painter) -> None:
        names = item["g"] if isinstance(item["g"], list) else [item["g"]]
        name = names[min(len(names) - 1, max(0, round(self.value(item.get("state", 0.0)))))]
        if not self.wild or geometry.within([self.points[at[0]]], self.edges):
            self.stamp(painter, self._glyphs[name], self.points[at[0]],
                       self.value(item.get("turn", 0.0)))

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

    def arrows(self, item: Item) -> tuple[Array, Array, Array, Array]:
        """Rows with a visible arrow, tails and tips [k, 2] pixels, sizes; small ones first."""
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

    def _arrows(self, item: Item, _: Any, painter: Painter) -> None:
        (shaft, head), (fill, rim, width, *_) = item["size"], self.look(item)
        _, tails, tips, sizes = self.arrows(item)
        u = self.point * (0.8 if self.small else 1.0)
        for a, b, size in zip(tails.tolist(), tips.tolist(), sizes.tolist(), strict=True):
            for ink, more in ((rim, width), (fill, 0.0)):
                corners = geometry.cut_polygon(geometry.arrow(
                    a, b, shaft * u + more, head * u + more / 2), self.edges)
                if ink is not None and len(corners) > 2:
                    painter.simple(corners, ink, None, 0)
            if size <= item["most"] or rim is None:
                continue
            along = np.subtract(b, a) / (math.dist(a, b) or 1.0)  # two slanted bars across it
            bar = (shaft + 6.5) / 2 * u * along[::-1] * (1, -1) - 2 * self.point * along
            for share in (0.40, 0.50):
                middle = a + share * np.subtract(b, a)
                if geometry.within([middle], self.edges):
                    painter.line([(middle + bar).tolist(), (middle - bar).tolist()], rim,
                                 1.8 * self.point)

    def _strips(self, item: Item, _: Any, painter: Painter) -> None:
        fill, edge, width, *_ = self.look(item)
        for corners in self.camera.to_pixels(self.rows(item)[:, 2:10].reshape(-1, 4, 2)).tolist():
            if geometry.within(corners, self.edges):
                painter.simple(corners, fill, edge, width)

    def _trail_marks(self, item: Item) -> tuple[Array, Any, Array, Array]:
        """Places of a trail [m], numbers of those shown; times of its marks [s], their places."""
        time, way, every = self.out.time, self.out.place(item["at"]), item["every"]
        times = every * np.arange(math.floor(time[0] / every * (1 - 1e-9)) + 1,
                                  math.floor(time[-1] / every * (1 + 1e-9)) + 1)
        spots = np.stack([np.interp(times, time, column) for column in way.T], axis=1)
        some = _apart(spots, MARKS_APART * self.point / self.scale)
        return way, _apart(way, FINEST * self.point / self.scale), times[some], spots[some]

    def _trail(self, item: Item, marks: Sequence[Any], painter: Painter) -> None:
        at, way, kept, times, spots = marks
        fill, edge, width, *_ = self.look(item)
        width = max(width, 1.5 / self.factor)
        passed = kept[:int(np.searchsorted(kept, self.sample, side="right"))][-MAX_PIECES:]
        path: list[XY] = [*self.camera.to_pixels(way[passed]).tolist(), self.points[at]]
        self._draw_line(painter, path, edge, width)
        centres = self.camera.to_pixels(spots[times <= self.time * (1 + 1e-9)]).tolist()
        for centre, radius in (*((each, item["mark"] * self.point) for each in centres),
                               (self.points[at], 1.5 * width)):
            if geometry.within([centre], self.edges):
                painter.disc(centre, radius, fill, None, 0)

    def labels(self) -> Iterator[Label]:
        """All texts and values of this instant, also those without a place."""
        self.points = self.points or self.px.tolist()
        for item, at in self.texts:
            if ("if" not in item or self.value(item["if"]) > 0.5) and "edge" not in item:
                place = [item["side"], item["show"]] if "side" in item else None
                yield self._label(item, 0, item["words"], self.value(item.get("value", 0.0)),
                                  self.points[at], (0.0, 0.0), place)
        for item in self.out.items:
            places, names = item.get("labels", {}), item.get("names") or {}
            for key, value, tip, away in self._valued(item):
                yield self._label(item, key, names.get(key, ""), value, tip, away, places.get(key))

    def _valued(self, item: Item) -> Iterable[tuple[int, float, Any, Any]]:
        """Keys and values of the arrows or strips of an item, their tips and the ways there."""
        if item["k"] == "arrows":
            rows, tails, tips, sizes = self.arrows(item)
            some = sizes >= 0.5 * item.get("labelled", 0.0)
            values = rows[:, 6] if rows.shape[1] > 6 else sizes
        elif item["k"] == "strips":
            rows = self.rows(item)
            values, some = rows[:, 10], rows[:, 10] >= item["least"]
            a, b, c, d = self.camera.to_pixels(rows[:, 2:10].reshape(-1, 4, 2)).swapaxes(0, 1)
            higher = np.hypot(*(c - b).T) > np.hypot(*(d - a).T)
            tips, tails = np.where(higher[:, None], (c, b), (d, a))
        else:
            return ()
        return zip(rows[some, 1].astype(int).tolist(), *(
            each[some].tolist() for each in (values, tips, tips - tails)), strict=True)

    def _label(self, item: Item, key: int, words: str, value: float, point: XY, away: XY,
               place: Any) -> Label:
        if "factor" in item:
            number = f"{item['factor'] * value:z.{item['decimals']}f}"
            words = f"{words} {number} {item['unit']}".strip()
        fill, edge, *_ = self.look(item)
        ink = (edge if item["k"] == "text" else fill) or (0, 0, 0)
        side = int(place[0]) if place is not None and self.value(place[1]) > 0.5 else -1
        return Label(item, key, words, point, away, ink, side)


def _maxima(rows: Array) -> Array:
    return np.asarray(np.maximum(np.abs(np.nan_to_num(rows)).max(axis=0, initial=0.0), 1e-300))


def _apart(points: Array, least: float) -> Any:
    """Numbers of the points [n, 2] that are ``least`` apart, each from the last one."""
    kept: list[int] = []
    last = (math.inf, math.inf)
    for k, (x, y) in enumerate(points.tolist()):
        if math.isfinite(x + y) and not math.dist(last, (x, y)) < least:
            kept.append(k)
            last = (x, y)
    return np.array(kept, dtype=np.intp)

