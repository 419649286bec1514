"""Bodies: filled outlines in the style of their role; fixed ones hatched."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.geometry import capsule_outline, polygon_grown, shape_outline
from sandbox.draw.film.palette import BACKGROUND, INK, ROLES, Style, lighter, mixed
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.unions import bare_outlines, united
from sandbox.draw.film.wheels import WheelPicture, wheel_pictures
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.bodies import Body, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import corners, solids
from sandbox.values.colours import rgb
from sandbox.values.planes import ALL, depth

EDGE = 1.3
"""Width of an outline in points."""
HAIR = 0.5
"""Width of a pitch circle in points."""
BAR = 4.0
"""Half width in points of a body without shapes, drawn as a bar between its anchors."""
DARK = 90
"""Brightness, 0 to 255, below which a fill's outline is lighter than it."""
DEEP = 0.45
"""Share of its edge's colour in what lies in the lowest of the planes of its role."""
ORDER = ("ground", "object", "palm", "link", "pulley", "rocker", "phalanx")


@dataclass(frozen=True)
class _Filled:
    """A polygon: where its outer and inner outline are pooled."""

    outer: slice
    inner: slice
    style: Style
    hatched: bool


@dataclass(frozen=True)
class _Layers:
    """A shape of several convex pieces: where the corners of what is filled are pooled."""

    below: tuple[slice, ...]
    """In the colour of the edge."""
    inside: tuple[slice, ...]
    above: tuple[slice, ...]
    """In the colour of the edge, over what is hatched."""
    style: Style
    hatched: bool


@dataclass(frozen=True)
class _Disc:
    """A circle: its centre and a point at angle 0 of its body."""

    centre: int
    radius: float
    drive: int | None
    style: Style
    marked: bool
    """Whether a line from the centre shows how it is turned; otherwise it is hatched."""


@dataclass(frozen=True)
class _Ridge:
    """A line on a body: a spoke, or a pitch circle."""

    path: slice
    style: Style
    width: float
    """In points."""


def styles(model: Model) -> list[Style]:
    """The style of each body: that of its role, darker the lower its plane.

    So fingers that lie one above the other are told apart. Of bodies of one role that move the
    uppermost ones have the role's own colour, and so has what stays or lies in all planes. A body
    that has a colour, or whose material has one, is filled with that.
    """
    bodies, stays = model.mechanism.bodies, model.bodies.fixed.tolist()
    layers: dict[str, list[int]] = {}
    for body, fixed in zip(bodies, stays, strict=True):
        if body.shapes and not fixed and body.plane != ALL:
            layers.setdefault(body.role, []).append(depth(body.plane))
    ranks = {role: sorted(set(depths), reverse=True) for role, depths in layers.items()}
    found = []
    for body, fixed in zip(bodies, stays, strict=True):
        style, planes, own = ROLES[body.role], ranks.get(body.role, []), colour_of(model, body)
        if own is not None:
            style = filled_with(own)
        elif body.shapes and not fixed and body.plane != ALL and len(planes) > 1:
            share = DEEP * planes.index(depth(body.plane)) / (len(planes) - 1)
            style = Style(mixed(style.fill, style.edge, share), style.edge)
        found.append(style)
    return found


def colour_of(model: Model, body: Body) -> str | None:
    """The colour that the scene gives a body or its material."""
    material = model.mechanism.materials.get(body.material or "")
    return body.colour or (material.colour if material else None)


def filled_with(colour: str) -> Style:
    """A style with this fill and an outline that is darker, or lighter where the fill is dark."""
    fill = rgb(colour)
    dark = 0.3 * fill[0] + 0.59 * fill[1] + 0.11 * fill[2] < DARK
    return Style(fill, mixed(fill, BACKGROUND if dark else INK, 0.6))


class BodyDrawer:
    """Draws the bodies that ``moving`` selects; those that stay are drawn once and kept.

    One that stays in a plane above some that move is drawn with them.
    """

    def __init__(
        self, model: Model, pool: PointPool, canvas: Canvas, *, moving: bool,
        joined: dict[int, list[tuple[float, float]]], shown: Sequence[int] | None = None,
    ) -> None:
        """``shown`` are the bodies that are drawn, all by default."""
        self._parts: list[_Filled | _Layers | _Disc | _Ridge] = []
        self._dry: list[slice] = []
        wheels = wheel_pictures(model)
        self._pool = pool
        self._fixed = model.bodies.fixed.tolist()
        self._styles = styles(model)
        self._half = EDGE / 2 * canvas.unit / canvas.camera.scale
        # a quarter of a finished pixel, less where stills are enlarged more
        self._error = 0.5 / canvas.camera.scale
        self._bar = BAR * canvas.unit / canvas.camera.scale
        bodies, drives = model.mechanism.bodies, model.drives
        self._drives = {(int(drives.target[k]), int(drives.shape[k])): k
                        for k in drives.giving("radius").tolist()}
        order = sorted(range(len(bodies)), key=lambda i: (
            depth(bodies[i].plane), ORDER.index(bodies[i].role), i))
        stays = model.bodies.fixed.copy()
        stays[[body for body, _ in self._drives]] = False
        lowest = min((depth(bodies[i].plane) for i in order if not stays[i]), default=0)
        for i in order:
            behind = bool(stays[i]) and depth(bodies[i].plane) <= lowest
            if behind != moving and (shown is None or i in shown):
                self._add(model, i, joined.get(i, []))
                for wheel in wheels.get(i, []):
                    plain = bodies[i].role == "link" and not model.bodies.fixed[i]
                    self._wheel(i, wheel, ROLES["pulley"] if plain else self._styles[i])

    def _add(self, model: Model, i: int, joined: list[tuple[float, float]]) -> None:
        body, style = model.mechanism.bodies[i], self._styles[i]
        marked = not model.bodies.fixed[i]
        for shape in body.displaces:
            self._dry += [self._pool.add(i, shape_outline(solid, 0.0, self._error))
                          for solid, _ in solids(shape)]
        driven = {k for owner, k in self._drives if owner == i}
        if not body.fill:
            self._outline(i, [shape for k, shape in enumerate(body.shapes) if k not in driven],
                          style)
        joined_up = united(body.shapes, driven) if body.fill else []
        if joined_up:
            self._parts.append(self._union(i, [body.shapes[k] for k in joined_up], style))
        for k, shape in back_to_front(body.shapes):
            if k in joined_up or not (body.fill or k in driven):
                continue
            if isinstance(shape, Circle):
                centre = self._pool.add(i, [shape.at, (shape.at[0] + shape.radius, shape.at[1])])
                self._parts.append(_Disc(centre.start, shape.radius, self._drives.get((i, k)),
                                         style, marked))
            elif isinstance(shape, Polyline):
                self._parts.append(self._chain(i, shape, style))
            elif isinstance(shape, Polygon) and not shape.whole:
                self._parts.append(self._cut_up(i, shape, style))
            else:
                self._fill(i, shape_outline(shape, self._half, self._error),
                           shape_outline(shape, -self._half, self._error), style)
        rail = i in model.joints.bodies[model.joints.grooved, 0]
        if not body.shapes and marked and not rail:
            far = sorted(joined)
            for start, end in pairwise(far):
                if math.dist(start, end) > 1e-9:
                    self._fill(i, capsule_outline(start, end, self._bar + self._half),
                               capsule_outline(start, end, self._bar - self._half), style)

    def _outline(self, body: int, shapes: Sequence[Shape], style: Style) -> None:
        """Shapes without a fill."""
        self._parts += [_Ridge(self._pool.add(body, line), style, EDGE) for line in
                        bare_outlines(shapes, self._error, turns=not self._fixed[body])]

    def _union(self, body: int, shapes: Sequence[Shape], style: Style) -> _Layers:
        """Shapes without the outlines that lie in one another; where they touch nothing is seen."""
        each = [solid for shape in shapes for solid, _ in solids(shape)]
        outer, inner = (tuple(self._pool.add(body, shape_outline(one, by, self._error))
                              for one in each) for by in (2 * self._half, 0.0))
        return _Layers(outer, inner, (), style, self._fixed[body])

    def _wheel(self, body: int, wheel: WheelPicture, style: Style) -> None:
        """A gear, a ring with teeth inside, a rack or a circle that rolls."""
        rings = [wheel.outline] if wheel.rim is None else [wheel.rim, wheel.outline]
        edges = [(polygon_grown(ring, self._half) + wheel.centre,
                  polygon_grown(ring, -self._half) + wheel.centre) for ring in rings]
        if wheel.rim is None:
            self._fill(body, *edges[0], style)
        else:
            hollow = np.concatenate([np.concatenate([ring, ring[:1]]) + wheel.centre
                                     for ring in (wheel.rim, wheel.outline[::-1])])
            strips = [np.array([outer[k - 1], outer[k], inner[k], inner[k - 1]])
                      for outer, inner in edges for k in range(len(outer))]
            self._parts.append(_Layers(
                (), (self._pool.add(body, hollow),),
                tuple(self._pool.add(body, strip) for strip in strips), style, self._fixed[body]))
        for path, width in ((wheel.pitch_line, HAIR), (wheel.spoke, EDGE)):
            if path is not None:
                closed = path if len(path) == 2 else np.concatenate([path, path[:1]])
                self._parts.append(_Ridge(
                    self._pool.add(body, closed + wheel.centre), style, width))

    def _fill(self, body: int, outer: Array, inner: Array, style: Style) -> None:
        self._parts.append(_Filled(
            self._pool.add(body, outer), self._pool.add(body, inner), style, self._fixed[body]))

    def _cut_up(self, body: int, shape: Polygon, style: Style) -> _Layers:
        """The pieces without their seams, below the outline and those of holes."""
        inside = tuple(self._pool.add(body, corners(solid)) for solid, _ in solids(shape)
                       if isinstance(solid, Polygon))
        edges = []
        for ring in (shape.points, *shape.holes):
            outer, inner = (polygon_grown(np.array(ring), by) for by in (self._half, -self._half))
            for k in range(len(ring)):
                strip = [outer[k - 1], outer[k], inner[k], inner[k - 1]]
                edges.append(self._pool.add(body, np.array(strip)))
        return _Layers((), inside, tuple(edges), style, self._fixed[body])

    def _chain(self, body: int, shape: Polyline, style: Style) -> _Layers:
        """The outlines of all segments below their insides, so that joints do not show."""
        segments = [solid for solid, _ in solids(shape)]
        outer, inner = (tuple(self._pool.add(body, shape_outline(each, by, self._error))
                              for each in segments) for by in (self._half, -self._half))
        return _Layers(outer, inner if shape.radius > self._half else (), (), style,
                       self._fixed[body])

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All of them, back to front, over what they keep a liquid out of."""
        for piece in self._dry:
            clip.polygon(canvas.surface, BACKGROUND, moment.points[piece])
        for part in self._parts:
            if isinstance(part, _Filled):
                self._draw_filled(canvas, moment, part)
            elif isinstance(part, _Layers):
                self._draw_layers(canvas, moment, part)
            elif isinstance(part, _Ridge):
                canvas.polyline(part.style.edge, moment.points[part.path], part.width)
            else:
                self._draw_disc(canvas, moment, part)

    def _draw_filled(self, canvas: Canvas, moment: Moment, part: _Filled) -> None:
        inner = moment.points[part.inner]
        clip.polygon(canvas.surface, part.style.edge, moment.points[part.outer])
        clip.polygon(canvas.surface, part.style.fill, inner)
        if part.hatched:
            hatch(canvas, inner, part.style)

    def _draw_layers(self, canvas: Canvas, moment: Moment, part: _Layers) -> None:
        edge, fill = part.style.edge, part.style.fill
        for pieces, colour in ((part.below, edge), (part.inside, fill)):
            for where in pieces:
                clip.polygon(canvas.surface, colour, moment.points[where])
        for where in part.inside if part.hatched else ():
            hatch(canvas, moment.points[where], part.style)
        for where in part.above:
            clip.polygon(canvas.surface, edge, moment.points[where])

    def _draw_disc(self, canvas: Canvas, moment: Moment, part: _Disc) -> None:
        centre, rim = moment.points[part.centre], moment.points[part.centre + 1]
        radius = part.radius if part.drive is None else float(moment.drives[part.drive])
        pixels = radius * canvas.camera.scale
        half = EDGE / 2 * canvas.unit
        clip.circle(canvas.surface, part.style.edge, centre, pixels + half)
        clip.circle(canvas.surface, part.style.fill, centre, max(1.0, pixels - half))
        reach = pixels + EDGE * canvas.unit
        canvas.touched.append((centre[0] - reach, centre[1] - reach,
                               centre[0] + reach, centre[1] + reach))
        if not part.marked:
            hatch(canvas, circle_corners(canvas, centre, pixels - half), part.style)
        if part.marked and part.radius > 0:
            fraction = radius / part.radius
            end = (centre[0] + (rim[0] - centre[0]) * fraction,
                   centre[1] + (rim[1] - centre[1]) * fraction)
            clip.line(canvas.surface, part.style.edge, centre, end, canvas.width(EDGE))


def back_to_front(shapes: Sequence[Shape]) -> list[tuple[int, Shape]]:
    """Shapes with their numbers, as given; of circles about one centre the largest first."""
    result = list(enumerate(shapes))
    places: dict[tuple[float, float], list[tuple[int, Circle]]] = {}
    for k, shape in enumerate(shapes):
        if isinstance(shape, Circle):
            places.setdefault(shape.at, []).append((k, shape))
    for circles in places.values():
        by_size = sorted(circles, key=lambda entry: -entry[1].radius)
        for (k, _), entry in zip(circles, by_size, strict=True):
            result[k] = entry
    return result


def circle_corners(
    canvas: Canvas, centre: tuple[float, float], radius: float,
) -> list[tuple[float, float]]:
    """A circle as a polygon of 64 corners; of a very large one what the picture shows."""
    if clip.is_large(canvas.surface, radius):
        return clip.large_circle(canvas.surface, centre, radius)
    angles = [math.tau * k / 64 for k in range(64)]
    return [(centre[0] + radius * math.cos(a), centre[1] + radius * math.sin(a)) for a in angles]


def hatch(canvas: Canvas, corners: Sequence[tuple[float, float]], style: Style) -> None:
    """Thin slanted lines inside a polygon: this body does not move."""
    corners = clip.cut_polygon(canvas.surface, corners)
    if len(corners) < 3:
        return
    xs, ys = [c[0] for c in corners], [c[1] for c in corners]
    width, height = canvas.surface.get_size()
    left, top = max(math.floor(min(xs)), 0), max(math.floor(min(ys)), 0)
    right, bottom = min(math.ceil(max(xs)) + 1, width), min(math.ceil(max(ys)) + 1, height)
    if right <= left or bottom <= top:
        return
    pitch = canvas.width(7)
    # the phase hangs on the world, not on the body, so that neighbours agree
    phase = clip.near(canvas.drift[0] + canvas.drift[1])
    first = (left + top - phase) // pitch * pitch + phase
    starts = range(first, right + bottom + pitch, pitch)
    lines = [((c - top, top), (c - bottom, bottom)) for c in starts]
    clip.hatching(canvas.surface, lighter(style.edge, 0.45), lines, canvas.width(0.9), corners)
