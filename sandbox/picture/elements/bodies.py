"""Bodies: outlines in the style of their role, gears, wheels of cords, lines to far anchors."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.model.joints import slot_points
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.picture.geometry import shape_outline
from sandbox.picture.listing import short
from sandbox.picture.palette import (
    BACKGROUND,
    INK,
    NIGHT,
    ROLES,
    WHEEL,
    WHEEL_EDGE,
    Colour,
    Style,
    mixed,
)
from sandbox.picture.subject import BEHIND, Subject
from sandbox.picture.wheels import WheelPicture, wheel_pictures
from sandbox.scene.bodies import Body, Capsule, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import solids
from sandbox.values.appearance import ALL, depth, rgb

XY = tuple[float, float]
EDGE, HAIR = 1.3, 0.5
"""Widths of an outline and of a pitch circle [points]."""
BAR = 8.0
"""Width of a body without shapes, a bar between its anchors [points]."""
STALK = 2.2
"""Width of a line from a body to an anchor beside it [points]."""
DARK = 90
"""Brightness, 0 to 255, below which a fill has an outline that is lighter."""
DEEP = 0.45
"""Share of the edge's colour in the fill of bodies in the lowest plane of their role."""
ORDER = ("ground", "object", "palm", "link", "pulley", "rocker", "phalanx")
"""Roles from back to front."""
WHEELS = ("gear", "rack", "roll")
"""Joints that hold wheels rather than points."""
ERROR = 0.2
"""How far outlines of round shapes may be from their true lines [points]."""


def styles(model: Model) -> list[Style]:
    """The style of each body: that of its role, darker the lower its plane.

    A body with a colour of its own, or of its material, is filled with that.
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


def tokens(s: Subject, style: Style) -> tuple[str, str]:
    """The tokens of a style's fill and edge."""
    white: Colour = (255, 255, 255)
    return (s.ink(style.fill, mixed(style.fill, NIGHT, 0.7)),
            s.ink(style.edge, mixed(style.edge, white, 0.3)))


def add_bodies(s: Subject) -> None:
    """All bodies that are shown, with their wheels; fixed ones have hatching."""
    model = s.run.model
    specs, looks = model.mechanism.bodies, styles(model)
    wheels, joined = wheel_pictures(model), joined_points(model)
    drives, shown = model.drives, set(s.layers.of("bodies"))
    radii = {(int(drives.target[k]), int(drives.shape[k])): k
             for k in drives.giving("radius").tolist()}
    driven = {body for body, _ in radii}
    rails = set(model.joints.bodies[model.joints.grooved, 0].tolist())
    for i, body in enumerate(specs):
        if i not in shown:
            continue
        stays = bool(model.bodies.fixed[i]) and i not in driven
        deep = depth(body.plane)
        maker = _BodyMaker(s, i, looks[i], BEHIND if stays and deep <= s.lowest else deep,
                           1000.0 * ORDER.index(body.role) + i / len(specs))
        maker.add(body, {k: drive for (owner, k), drive in radii.items() if owner == i})
        if not body.shapes and not model.bodies.fixed[i] and i not in rails:
            maker.add_bar(joined.get(i, []))
        for wheel in wheels.get(i, []):
            plain = body.role == "link" and not model.bodies.fixed[i]
            maker.add_wheel(wheel, ROLES["pulley"] if plain else looks[i])


class _BodyMaker:
    """Adds the items of one body."""

    def __init__(self, s: Subject, body: int, style: Style, plane: float, rank: float) -> None:
        self.s, self.body, self.plane, self.rank = s, body, plane, rank
        self.fixed = bool(s.run.model.bodies.fixed[body])
        self.name = s.run.mechanism.bodies[body].name
        self.fill, self.edge = tokens(s, style)
        self.look = s.style(self.fill, self.edge, EDGE, hatched=int(self.fixed))
        self.error = ERROR * s.point

    def path(self, d: Sequence[Any], look: int | None = None, **fields: Any) -> None:
        self.s.add("bodies", "path", self.name, plane=self.plane, rank=self.rank, f=self.body,
                   s=self.look if look is None else look, d=list(d), **fields)

    def line(self, points: Iterable[Iterable[float]], look: int) -> None:
        self.s.add("bodies", "line", self.name, plane=self.plane, rank=self.rank, s=look,
                   p=[self.s.point_on(self.body, at) for at in points])

    def add(self, body: Body, driven: dict[int, int]) -> None:
        """Its shapes; ``driven`` are the drives that set radii, by shape."""
        paper = self.s.style("paper")
        for shape in body.displaces:
            self.path([ring(shape_outline(solid, 0.0, self.error)) for solid, _ in solids(shape)],
                      paper, m=1)
        if not body.fill:
            shapes = [shape for k, shape in enumerate(body.shapes) if k not in driven]
            for path in bare_outlines(shapes, self.error, turns=not self.fixed):
                self.line(path, self.s.style("", self.edge, EDGE))
        joined = united(body.shapes, set(driven)) if body.fill else []
        if joined:
            self.path([d for k in joined for d in outline(body.shapes[k])], m=1)
        for k, shape in back_to_front(body.shapes):
            if k in joined or not (body.fill or k in driven):
                continue
            if isinstance(shape, Circle):
                self.add_circle(shape, driven.get(k))
            else:
                self.path(outline(shape), m=1 if isinstance(shape, Polyline) else None)

    def add_circle(self, shape: Circle, drive: int | None) -> None:
        (x, y), r = shape.at, shape.radius
        if drive is None:
            self.path(outline(shape))
            end = [self.body, short(x + r), short(y)]
        else:
            radius = self.s.run.arrays["drive_value"][:, drive]
            size: Any = self.s.out.varying(radius)
            self.path([{"c": [short(x), short(y), short(x), short(y), size]}])
            pose = self.s.run.arrays["body_pose"][:, self.body]
            c, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
            end = self.s.out.spot(np.column_stack([
                pose[:, 0] + c * (x + radius) - sine * y,
                pose[:, 1] + sine * (x + radius) + c * y]), pose[:, 2])
        if not self.fixed:
            line = self.s.style("", self.edge, EDGE)
            self.s.add("bodies", "line", self.name, plane=self.plane, rank=self.rank, s=line,
                       p=[[self.body, short(x), short(y)], end])

    def add_bar(self, anchors: Sequence[XY]) -> None:
        """A body without shapes: bars between its anchors."""
        far = [(a, b) for a, b in pairwise(sorted(anchors)) if math.dist(a, b) > 1e-9]
        for start, end in far:
            capsule = [short(v) for v in (*start, *end)]
            self.path([{"c": [*capsule, short(BAR / 2 * self.s.point)]}])

    def add_wheel(self, wheel: WheelPicture, style: Style) -> None:
        """A gear, a ring with teeth inside, a rack or a circle that rolls."""
        fill, edge = tokens(self.s, style)
        rings = [wheel.outline] if wheel.rim is None else [wheel.rim, wheel.outline]
        self.path([ring(each + wheel.centre) for each in rings],
                  self.s.style(fill, edge, EDGE, hatched=int(self.fixed)))
        for path, width in ((wheel.pitch_line, HAIR), (wheel.spoke, EDGE)):
            if path is not None:
                closed = path if len(path) == 2 else np.concatenate([path, path[:1]])
                self.line((closed + wheel.centre).tolist(), self.s.style("", edge, width))


def ring(points: Array) -> list[float]:
    """A closed outline as a subpath."""
    return [short(v) for at in points.tolist() for v in at]


def outline(shape: Shape) -> list[Any]:
    """A shape as subpaths."""
    if isinstance(shape, Circle):
        return [{"c": [*map(short, (*shape.at, *shape.at)), short(shape.radius)]}]
    if isinstance(shape, Polyline):
        return [d for solid, _ in solids(shape) for d in outline(solid)]
    if isinstance(shape, Capsule):
        return [{"c": [*map(short, (*shape.start, *shape.end)), short(shape.radius)]}]
    rings = (shape.points, *shape.holes) if isinstance(shape, Polygon) else (
        shape_outline(shape).tolist(),)
    return [[short(v) for at in each for v in at] for each in rings]


def back_to_front(shapes: Sequence[Shape]) -> list[tuple[int, Shape]]:
    """Shapes with their numbers, as given; of circles about one centre the largest first."""
    result = list(enumerate(shapes))
    places: dict[XY, list[tuple[int, Circle]]] = {}
    for k, shape in enumerate(shapes):
        if isinstance(shape, Circle):
            places.setdefault(shape.at, []).append((k, shape))
    for circles in places.values():
        by_size = sorted(circles, key=lambda entry: -entry[1].radius)
        for (k, _), entry in zip(circles, by_size, strict=True):
            result[k] = entry
    return result


def joined_points(model: Model, *, held: bool = False) -> dict[int, list[XY]]:
    """Where joints, springs, cylinders and tendon guides act on each body, in its own frame [m].

    ``held`` leaves out what holds nothing in place: grooves, and ends that an actuator pulls.
    """
    joints, springs, tendons, lines = model.joints, model.springs, model.tendons, model.lines
    found: dict[int, list[XY]] = {}

    def attach(body: int, points: Array) -> None:
        found.setdefault(body, []).extend((x, y) for x, y in points.tolist())

    grooved = set(joints.grooved.tolist())
    for k, (a, b) in enumerate(joints.bodies.tolist()):
        if k not in grooved:
            attach(a, joints.anchor[k, :1])
        elif not held:
            attach(a, slot_points(model, k))
        attach(b, joints.anchor[k, 1:])
    for table, some in ((springs, springs.straight), (lines, lines.joint == NONE)):
        for bodies, points in zip(table.bodies[some].tolist(), table.anchor[some], strict=True):
            attach(bodies[0], points[:1])
            attach(bodies[1], points[1:])
    for tendon, drive in enumerate(tendons.drive):
        guides = tendons.guides(tendon)
        for i in range(guides.start, guides.stop - (drive != NONE and held)):
            attach(int(tendons.guide_body[i]), tendons.guide_at[i:i + 1])
    return found


def beside(model: Model, body: int, at: XY) -> XY | None:
    """The place on a body's shapes that is nearest to a point beside them, in its frame [m].

    None if the point lies in one of the shapes, or there are none.
    """
    found: list[tuple[float, XY]] = []
    for shape in model.mechanism.bodies[body].shapes:
        for solid, _ in solids(shape):
            start = np.asarray(shape_outline(solid))
            side = np.roll(start, -1, axis=0) - start
            way = np.array(at) - start
            turn = side[:, 0] * way[:, 1] - side[:, 1] * way[:, 0]
            if (turn >= 0).all() or (turn <= 0).all():
                return None
            square = np.maximum((side**2).sum(axis=1), 1e-300)
            share = np.clip((way * side).sum(axis=1) / square, 0.0, 1.0)
            nearest = start + share[:, None] * side
            gap = np.hypot(*(nearest - at).T)
            k = int(gap.argmin())
            found.append((float(gap[k]), (float(nearest[k, 0]), float(nearest[k, 1]))))
    return min(found)[1] if found else None


def stalks(model: Model) -> dict[int, list[tuple[XY, XY]]]:
    """Of each body the anchors beside its shapes [m], each with the nearest place of the body."""
    joints, springs, lines = model.joints, model.springs, model.lines
    grooved, ends = set(joints.grooved.tolist()), set[tuple[int, XY]]()
    for k, kind in enumerate(joints.kind):
        if kind.keeps not in WHEELS:
            ends |= {(int(joints.bodies[k, end]), (float(x), float(y)))
                     for end, (x, y) in enumerate(joints.anchor[k]) if end or k not in grooved}
    for bodies, points in ((springs.bodies[springs.straight], springs.anchor[springs.straight]),
                           (lines.bodies[lines.joint == NONE], lines.anchor[lines.joint == NONE])):
        ends |= {(int(body), (float(x), float(y)))
                 for body, (x, y) in zip(bodies.ravel(), points.reshape(-1, 2), strict=True)}
    found: dict[int, list[tuple[XY, XY]]] = {}
    for body, at in sorted(ends):
        nearest = beside(model, body, at)
        if nearest is not None:
            found.setdefault(body, []).append((at, nearest))
    return found


def far_feet(model: Model, least: float) -> dict[int, list[XY]]:
    """Of fixed bodies the anchors that lie more than ``least`` [m] beside their shapes."""
    return {body: [at for at, nearest in pairs if math.dist(at, nearest) > least]
            for body, pairs in stalks(model).items() if model.bodies.fixed[body]}


def add_stalks(s: Subject) -> None:
    """Lines from moving bodies to anchors beside them, below the bodies."""
    model, shown = s.run.model, s.layers.of("bodies")
    for body, pairs in stalks(model).items():
        if model.bodies.fixed[body] or body not in shown:
            continue
        _, edge = tokens(s, ROLES[model.mechanism.bodies[body].role])
        for pair in pairs:
            s.add("stalks", "line", plane=s.plane(body), s=s.style("", edge, STALK),
                  p=[s.point_on(body, at) for at in pair])


def add_wheels(s: Subject) -> None:
    """Wheels of guides that no circle of their body shows, on each shaft the largest first.

    A circle that such a wheel would cover is painted again above it.
    """
    model, shafts = s.run.model, dict[tuple[int, XY], list[float]]()
    for tendon in model.mechanism.tendons:
        for guide in tendon.guides:
            if guide.radius > 0:
                shafts.setdefault((model.names.body[guide.body], guide.at), []).append(guide.radius)
    drives = model.drives
    swelling = {(int(drives.target[k]), int(drives.shape[k])) for k in drives.giving("radius")}
    for (body, at), radii in shafts.items():
        spec = model.mechanism.bodies[body]
        circles = [shape.radius for k, shape in enumerate(spec.shapes)
                   if isinstance(shape, Circle) and shape.at == at and (body, k) not in swelling]
        missing = {r for r in radii if not any(math.isclose(r, c) for c in circles)}
        steps = {r: Style(WHEEL, WHEEL_EDGE) for r in missing}
        steps |= {c: ROLES[spec.role] for c in circles if c < max(missing, default=0.0)}
        x, y = map(short, at)
        for radius in sorted(steps, reverse=True):
            fill, edge = tokens(s, steps[radius])
            s.add("wheels", "path", plane=s.plane(body), f=body, s=s.style(fill, edge, 1.2),
                  d=[{"c": [x, y, x, y, short(radius)]}])
            if len(steps) > 1:
                s.add("wheels", "line", plane=s.plane(body), s=s.style("", edge, 1.2),
                      p=[[body, x, y], [body, short(x + radius), y]])


TOUCHING = 1e-7
"""Shapes that are no farther apart touch [m]."""


def united(shapes: Sequence[Shape], changing: Collection[int]) -> list[int]:
    """The numbers of those convex shapes of a body that touch others of it and lie in none.

    What lies in another, such as a hub, is seen by its own outline, and so are circles that a drive
    changes and shapes of several pieces.
    """
    single = {k: shape for k, shape in enumerate(shapes)
              if k not in changing and not isinstance(shape, Polyline)
              and (not isinstance(shape, Polygon) or shape.whole)}
    rings = {k: shape_outline(shape) for k, shape in single.items()}
    outer = [k for k in rings if not any(
        _holds(rings[other], rings[k]) for other in rings
        if other != k and not (other > k and _holds(rings[k], rings[other])))]
    return [k for k in outer if any(
        other != k and _touch(rings[k], rings[other]) for other in outer)]


def bare_outlines(shapes: Sequence[Shape], error: float, *, turns: bool) -> list[Array]:
    """What is drawn of shapes without a fill: lines [n, 2] m.

    Their outlines without the parts that lie in others of them, but all of one that lies whole in
    another; of circles that turn a radius, which shows it. ``error`` [m] is how far lines may be
    from round ones.
    """
    rings = [_ccw(shape_outline(solid, 0.0, error)) for shape in shapes
             for solid, _ in solids(shape)]
    found: list[Array] = []
    for i, ring in enumerate(rings):
        others = [other for other in rings[:i] + rings[i + 1:] if not _holds(other, ring)]
        open_end = False
        for start, end in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            parts = _outside(start, end, others)
            for a, b in parts:
                piece = np.array([start + a * (end - start), start + b * (end - start)])
                if open_end and a == 0.0:
                    found[-1] = np.concatenate([found[-1], piece[1:]])
                else:
                    found.append(piece)
            open_end = bool(parts) and parts[-1][1] == 1.0
    return found + [np.array([shape.at, (shape.at[0] + shape.radius, shape.at[1])])
                    for shape in shapes if turns and isinstance(shape, Circle)]


def _ccw(ring: Array) -> Array:
    x, y = ring.T
    return ring if np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) >= 0 else ring[::-1]


def _outside(start: Array, end: Array, rings: Sequence[Array]) -> list[tuple[float, float]]:
    """The parts of a side, from 0 to 1 along it, that lie in no ring and on no seam with one."""
    free = [(0.0, 1.0)]
    for ring in rings:
        at, to = _depths(ring, np.array([start, end]))
        along = np.roll(ring, -1, axis=0) - ring
        along = along[np.hypot(*along.T) > 0]
        on_it = np.maximum(np.abs(at), np.abs(to)) <= TOUCHING
        if (on_it & (along @ (end - start) > 0)).any():
            continue  # a side of both, with both on the same hand
        least = np.where(on_it, -np.inf, TOUCHING)
        with np.errstate(divide="ignore", invalid="ignore"):
            cross = (least - at) / (to - at)
        if ((np.abs(to - at) < 1e-15) & (at < least)).any():
            continue
        low = max(0.0, float(np.max(cross[(to > at) & ~on_it], initial=0.0)))
        high = min(1.0, float(np.min(cross[(to < at) & ~on_it], initial=1.0)))
        if high > low:
            free = [part for a, b in free for part in ((a, min(b, low)), (max(a, high), b))
                    if part[1] - part[0] > 1e-9]
    return free


def _depths(ring: Array, points: Array) -> Array:
    """How deep points [n, 2] lie behind each side of a convex outline [m], [n, sides]."""
    side = np.roll(ring, -1, axis=0) - ring
    length = np.hypot(*side.T)
    side, start = side[length > 0] / length[length > 0, None], ring[length > 0]
    way = points[:, None] - start
    x, y = ring.T
    turns = np.sign(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return np.asarray(turns * (side[:, 0] * way[..., 1] - side[:, 1] * way[..., 0]))


def _holds(ring: Array, other: Array) -> bool:
    """Whether one convex outline lies in another."""
    return bool((_depths(ring, other) >= -TOUCHING).all())


def _touch(one: Array, other: Array) -> bool:
    """Whether two convex outlines meet: no side of either has all of the other before it."""
    return all(bool((_depths(a, b).max(axis=0) >= -TOUCHING).all())
               for a, b in ((one, other), (other, one)))
