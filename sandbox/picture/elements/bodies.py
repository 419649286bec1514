"""Bodies: outlines in the style of their role, gears, wheels of tendons, lines to far anchors."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.model.joints import placed, slot_points
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.picture.geometry import XY, bare_outlines, shape_outline, united
from sandbox.picture.listing import flat, short
from sandbox.picture.palette import (
    BACKGROUND,
    INK,
    NIGHT,
    ROLES,
    WHEEL,
    Style,
    mixed,
)
from sandbox.picture.subject import BEHIND, Subject
from sandbox.picture.wheels import wheel_pictures
from sandbox.scene.bodies import Body, Capsule, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import solids
from sandbox.values.appearance import ALL, depth, rgb

EDGE, HAIR = 1.3, 0.5  # widths of an outline and of a pitch circle [points]
BAR, STALK = 8.0, 2.2
"""Widths of bodies without shapes, and of lines to anchors beside a body [points]."""
DARK = 90  # brightness, 0 to 255, below which a fill has an outline that is lighter
DEEP = 0.45  # share of the edge's colour in the fill of bodies in the lowest plane of their role
ORDER = ("ground", "object", "palm", "link", "pulley", "rocker", "phalanx")
"""Roles from back to front."""
WHEELS = ("gear", "rack", "roll")  # joints that hold wheels rather than points
ERROR = 0.2  # how far outlines of round shapes may be from their true lines [points]


def styles(model: Model) -> list[Style]:
    """The style of each body: own colour or material, else role, darker in lower planes."""
    bodies, found = model.mechanism.bodies, []
    moving = [bool(body.shapes) and not fixed and body.plane != ALL
              for body, fixed in zip(bodies, model.bodies.fixed.tolist(), strict=True)]
    planes: dict[str, set[int]] = {}
    for body, moves in zip(bodies, moving, strict=True):
        planes.setdefault(body.role, set()).update([depth(body.plane)] if moves else ())
    for body, moves in zip(bodies, moving, strict=True):
        style, own = ROLES[body.role], colour_of(model, body)
        ranks = sorted(planes[body.role], reverse=True)
        if own is not None:
            fill = rgb(own)
            dark = 0.3 * fill[0] + 0.59 * fill[1] + 0.11 * fill[2] < DARK
            style = Style(fill, mixed(fill, BACKGROUND if dark else INK, 0.6))
        elif moves and len(ranks) > 1:
            share = DEEP * ranks.index(depth(body.plane)) / (len(ranks) - 1)
            style = Style(mixed(style.fill, style.edge, share), style.edge)
        found.append(style)
    return found


def colour_of(model: Model, body: Body) -> str | None:
    """The colour that the scene gives a body or its material."""
    material = model.mechanism.materials.get(body.material or "")
    return body.colour or (material.colour if material else None)


def tokens(s: Subject, style: Style) -> tuple[str, str]:
    """The tokens of a style's fill and edge."""
    return (s.ink(style.fill, mixed(style.fill, NIGHT, 0.7)),
            s.ink(style.edge, mixed(style.edge, BACKGROUND, 0.3)))


def add_bodies(s: Subject) -> None:
    """All bodies that are shown, with their wheels; fixed ones have hatching."""
    model, looks = s.run.model, styles(s.run.model)
    wheels, joined, drives = wheel_pictures(model), joined_points(model), model.drives
    rails = model.joints.bodies[model.joints.grooved, 0].tolist()
    for i in s.layers.of("bodies"):
        body, fixed = model.mechanism.bodies[i], bool(model.bodies.fixed[i])
        driven = {int(drives.shape[k]): k for k in drives.giving("radius").tolist()
                  if drives.target[k] == i}
        deep = depth(body.plane)
        made = _Body(s, i, looks[i], {
            "plane": BEHIND if fixed and not driven and deep <= s.lowest else deep,
            "rank": 1000.0 * ORDER.index(body.role) + i / len(looks)})
        made.add_shapes(body, driven)
        if not body.shapes and not fixed and i not in rails:  # bars between its anchors
            for start, end in pairwise(sorted(joined.get(i, []))):
                if math.dist(start, end) > 1e-9:
                    made.path([{"c": [*flat(start, end), short(BAR / 2 * s.point)]}])
        for wheel in wheels.get(i, []):
            style = ROLES["pulley"] if body.role == "link" and not fixed else looks[i]
            fill, edge = tokens(s, style)
            made.path([flat(*ring) for ring in wheel.rings],
                      s.style(fill, edge, EDGE, hatched=int(fixed)))
            for path, width in ((wheel.pitch_line, HAIR), (wheel.spoke, EDGE)):
                if path is not None:
                    closed = path if len(path) == 2 else np.concatenate([path, path[:1]])
                    made.line(closed.tolist(), s.style("", edge, width))


class _Body:
    """Adds the items of one body."""

    def __init__(self, s: Subject, body: int, style: Style, place: dict[str, Any]) -> None:
        self.s, self.body, self.place = s, body, place
        self.fixed = bool(s.run.model.bodies.fixed[body])
        self.name = s.run.mechanism.bodies[body].name
        self.fill, self.edge = tokens(s, style)
        self.look = s.style(self.fill, self.edge, EDGE, hatched=int(self.fixed))

    def path(self, d: Sequence[Any], look: int | None = None, **fields: Any) -> None:
        self.s.add("bodies", "path", self.name, f=self.body, d=list(d),
                   s=self.look if look is None else look, **self.place, **fields)

    def line(self, points: Iterable[Iterable[float]], look: int) -> None:
        self.s.add("bodies", "line", self.name, s=look, **self.place,
                   p=[self.s.on(self.body, at) for at in points])

    def add_shapes(self, body: Body, driven: dict[int, int]) -> None:
        """Its shapes; ``driven`` are the drives that set radii, by shape."""
        error, paper = ERROR * self.s.point, self.s.style("paper")
        for shape in body.displaces:
            self.path([flat(*shape_outline(solid, 0.0, error)) for solid, _ in solids(shape)],
                      paper, m=1)
        if not body.fill:
            shapes = [shape for k, shape in enumerate(body.shapes) if k not in driven]
            for path in bare_outlines(shapes, error, turns=not self.fixed):
                self.line(path, self.s.style("", self.edge, EDGE))
        joined = united(body.shapes, driven) if body.fill else []
        if joined:
            self.path([d for k in joined for d in outline(body.shapes[k])], m=1)
        for k in back_to_front(body.shapes):
            shape = body.shapes[k]
            if k in joined or not (body.fill or k in driven):
                continue
            if isinstance(shape, Circle):
                self.add_circle(shape, driven.get(k))
            else:
                self.path(outline(shape), m=1 if isinstance(shape, Polyline) else None)

    def add_circle(self, shape: Circle, drive: int | None) -> None:
        (x, y), r = shape.at, shape.radius
        end = self.s.on(self.body, (x + r, y))
        if drive is None:
            self.path(outline(shape))
        else:
            radius = self.s.run.arrays["drive_value"][:, drive]
            pose = self.s.run.arrays["body_pose"][:, self.body]
            self.path([{"c": [*flat(shape.at, shape.at), self.s.out.varying(radius)]}])
            tip = np.column_stack([x + radius, np.full(len(pose), y)])
            end = self.s.out.spot(placed(pose, tip), pose[:, 2])
        if not self.fixed:
            self.s.add("bodies", "line", self.name, s=self.s.style("", self.edge, EDGE),
                       p=[self.s.on(self.body, shape.at), end], **self.place)


def outline(shape: Shape) -> list[Any]:
    """A shape as subpaths."""
    if isinstance(shape, Polyline):
        return [d for solid, _ in solids(shape) for d in outline(solid)]
    if isinstance(shape, Circle | Capsule):
        ends = (shape.at,) * 2 if isinstance(shape, Circle) else (shape.start, shape.end)
        return [{"c": [*flat(*ends), short(shape.radius)]}]
    rings = (shape.points, *shape.holes) if isinstance(shape, Polygon) else (shape_outline(shape),)
    return [flat(*each) for each in rings]


def back_to_front(shapes: Sequence[Shape]) -> list[int]:
    """Numbers of shapes as given; of circles about one centre the largest first."""
    order, places = list(range(len(shapes))), dict[XY, list[tuple[float, int]]]()
    for k, shape in enumerate(shapes):
        if isinstance(shape, Circle):
            places.setdefault(shape.at, []).append((-shape.radius, k))
    for circles in places.values():
        for (_, k), (_, other) in zip(circles, sorted(circles), strict=True):
            order[k] = other
    return order


def joined_points(model: Model, *, held: bool = False) -> dict[int, list[XY]]:
    """Where joints, springs, cylinders and tendon guides act on each body, in its frame [m].

    ``held`` leaves out grooves and tendon ends that an actuator pulls.
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
    """The point of a body's shapes nearest to a point outside, in its frame [m]; None if inside."""
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
    for table, some in ((springs, springs.straight), (lines, lines.joint == NONE)):
        points = table.anchor[some].reshape(-1, 2).tolist()
        ends |= {(body, (x, y)) for body, (x, y) in zip(
            table.bodies[some].ravel().tolist(), points, strict=True)}
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
        if not model.bodies.fixed[body] and body in shown:
            _, edge = tokens(s, ROLES[model.mechanism.bodies[body].role])
            for pair in pairs:
                s.add("stalks", "line", plane=s.plane(body), s=s.style("", edge, STALK),
                      p=[s.on(body, at) for at in pair])


def add_wheels(s: Subject) -> None:
    """Wheels of guides that no circle of their body shows, on each shaft the largest first.

    A circle that such a wheel would cover is painted again above it.
    """
    model, shafts = s.run.model, dict[tuple[int, XY], list[float]]()
    for guide in (guide for tendon in model.mechanism.tendons for guide in tendon.guides):
        if guide.radius > 0:
            shafts.setdefault((model.names.body[guide.body], guide.at), []).append(guide.radius)
    drives = model.drives
    swelling = {(int(drives.target[k]), int(drives.shape[k])) for k in drives.giving("radius")}
    for (body, at), radii in shafts.items():
        spec = model.mechanism.bodies[body]
        circles = [shape.radius for k, shape in enumerate(spec.shapes)
                   if isinstance(shape, Circle) and shape.at == at and (body, k) not in swelling]
        missing = {r for r in radii if not any(math.isclose(r, c) for c in circles)}
        steps = dict.fromkeys(missing, WHEEL)
        steps |= {c: ROLES[spec.role] for c in circles if c < max(missing, default=0.0)}
        for radius in sorted(steps, reverse=True):
            fill, edge = tokens(s, steps[radius])
            s.add("wheels", "path", plane=s.plane(body), f=body, s=s.style(fill, edge, 1.2),
                  d=[{"c": [*flat(at, at), short(radius)]}])
            if len(steps) > 1:
                s.add("wheels", "line", plane=s.plane(body), s=s.style("", edge, 1.2),
                      p=[s.on(body, at), s.on(body, (at[0] + radius, at[1]))])
