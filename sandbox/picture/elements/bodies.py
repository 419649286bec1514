"""Bodies: outlines in the style of their role, gears, wheels of tendons, lines to far anchors."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.model.joints import placed, slot_points
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.picture.geometry import XY, holds, shape_outline, united
from sandbox.picture.listing import Look, flat, short
from sandbox.picture.palette import BACKGROUND, INK, NIGHT, ROLES, WHEEL, Style, mixed
from sandbox.picture.subject import BEHIND, Subject
from sandbox.picture.wheels import wheel_pictures
from sandbox.samples.nearby import from_sides
from sandbox.scene.bodies import Body, Capsule, Circle, Polygon, Polyline, Shape
from sandbox.scene.geometry import solids
from sandbox.values.appearance import ALL, depth, rgb

EDGE, HAIR = 1.3, 0.5  # widths of an outline and of a pitch circle [points]
BAR, ANCHOR_LINE = 8.0, 2.2  # widths of bodies without shapes, of lines to outer anchors [points]
ORDER = ("ground", "object", "palm", "link", "pulley", "rocker", "phalanx")  # from back to front


def styles(model: Model) -> list[Style]:
    """The style of each body: own colour or material, else role, darker in lower planes."""
    bodies, found = model.mechanism.bodies, []
    moving = [bool(body.shapes) and not fixed and body.plane != ALL
              for body, fixed in zip(bodies, model.bodies.fixed.tolist(), strict=True)]
    planes = {(body.role, depth(body.plane))
              for body, moves in zip(bodies, moving, strict=True) if moves}
    for body, moves in zip(bodies, moving, strict=True):
        style, own = ROLES[body.role], colour_of(model, body)
        ranks = sorted((deep for role, deep in planes if role == body.role), reverse=True)
        if own is not None:
            fill = rgb(own)
            dark = 0.3 * fill[0] + 0.59 * fill[1] + 0.11 * fill[2] < 90  # of 255
            style = Style(fill, mixed(fill, BACKGROUND if dark else INK, 0.6))
        elif moves and len(ranks) > 1:
            share = 0.45 * ranks.index(depth(body.plane)) / (len(ranks) - 1)
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
    """All visible bodies with their wheels; fixed ones are hatched."""
    model, looks = s.run.model, styles(s.run.model)
    wheels, joined, drives = wheel_pictures(model), joined_points(model), model.drives
    rails = model.joints.bodies[model.joints.keeping("groove"), 0].tolist()
    for i in s.layers.get("bodies", ()):
        body, fixed = model.mechanism.bodies[i], bool(model.bodies.fixed[i])
        driven = {int(drives.shape[k]): k for k in drives.giving("radius").tolist()
                  if drives.target[k] == i}
        behind = fixed and not driven and depth(body.plane) <= s.lowest
        add = partial(s.add, "bodies", name=body.name,
                      plane=BEHIND if behind else depth(body.plane),
                      rank=1000.0 * ORDER.index(body.role) + i / len(looks))
        fill, edge = tokens(s, looks[i])
        look = (fill, edge, EDGE, 0, int(fixed))
        _add_shapes(s, i, add, look, driven)
        if not body.shapes and not fixed and i not in rails:  # bars between its anchors
            for start, end in pairwise(sorted(joined.get(i, []))):
                if math.dist(start, end) > 1e-9:
                    add("path", f=i, d=[{"c": [*flat(start, end), short(BAR / 2 * s.point)]}],
                        s=look)
        if i in wheels and body.role == "link" and not fixed:
            fill, edge = tokens(s, ROLES["pulley"])
        for wheel in wheels.get(i, []):
            add("path", f=i, d=[flat(*ring) for ring in wheel.rings],
                s=(fill, edge, EDGE, 0, int(fixed)))
            for path, width in ((wheel.pitch_line, HAIR), (wheel.spoke, EDGE)):
                if path is not None:
                    closed = path if len(path) == 2 else np.concatenate([path, path[:1]])
                    add("line", p=[s.on(i, at) for at in closed], s=("", edge, width))


def _add_shapes(s: Subject, i: int, add: Callable[..., None], look: Look,
                driven: dict[int, int]) -> None:
    """The shapes of a body; ``driven`` are the drives that set radii, by shape."""
    body, fixed = s.run.mechanism.bodies[i], bool(look[-1])
    if not body.fill:
        look = ("", *look[1:])
    path, line = partial(add, "path", f=i), partial(add, "line", s=("", look[1], EDGE))
    for shape in body.displaces:
        path(d=[flat(*shape_outline(solid, 0.0, 0.2 * s.point)) for solid, _ in solids(shape)],
             s=("paper",), m=1)
    joined = united(body.shapes, driven) if body.fill else []
    if joined:
        path(d=[d for k in joined for d in outline(body.shapes[k])], s=look, m=1)
    circles_last = sorted(enumerate(body.shapes), key=lambda each: -each[1].radius if isinstance(
        each[1], Circle) else -math.inf)  # the largest first
    for k, shape in circles_last:
        if k in joined:
            continue
        paths, radius = outline(shape), None
        if k in driven:
            radius = s.run.arrays["drive_value"][:, driven[k]]
            paths[0]["c"][-1] = s.out.varying(radius)
        path(d=paths, s=look, m=1 if body.fill and isinstance(shape, Polyline) else None)
        if isinstance(shape, Circle) and not fixed:
            (x, y), pose = shape.at, s.run.arrays["body_pose"][:, i]
            end = s.on(i, (x + shape.radius, y)) if radius is None else s.out.spot(
                placed(pose, np.column_stack([x + radius, np.full(len(pose), y)])), pose[:, 2])
            line(p=[s.on(i, shape.at), end])


def outline(shape: Shape) -> list[Any]:
    """A shape as subpaths."""
    if isinstance(shape, Polyline):
        return [d for solid, _ in solids(shape) for d in outline(solid)]
    if isinstance(shape, Circle | Capsule):
        ends = (shape.at,) * 2 if isinstance(shape, Circle) else (shape.start, shape.end)
        return [{"c": [*flat(*ends), short(shape.radius)]}]
    rings = (shape.points, *shape.holes) if isinstance(shape, Polygon) else (shape_outline(shape),)
    return [flat(*each) for each in rings]


def _anchors(model: Model, *, grooves: bool, wheels: bool = True) -> Iterator[tuple[int, Array]]:
    """Bodies with points [n, 2] m where joints, straight springs and cylinders act on them."""
    joints, springs, lines = model.joints, model.springs, model.lines
    for k, (a, b) in enumerate(joints.bodies.tolist()):
        if wheels or joints.kind[k].keeps not in ("gear", "rack", "roll"):
            groove = joints.kind[k].keeps == "groove"
            if grooves or not groove:
                yield a, slot_points(model, k) if groove else joints.anchor[k, :1]
            yield b, joints.anchor[k, 1:]
    for table, some in ((springs, springs.straight), (lines, lines.joint == NONE)):
        yield from zip(table.bodies[some].ravel().tolist(), table.anchor[some].reshape(-1, 1, 2),
                       strict=True)


def joined_points(model: Model, *, held: bool = False) -> dict[int, list[XY]]:
    """Where elements act on each body [m]; ``held``: without grooves and actuated tendon ends."""
    tendons, found = model.tendons, dict[int, list[XY]]()
    every = list(_anchors(model, grooves=not held))
    for tendon, drive in enumerate(tendons.drive):
        guides = tendons.guides(tendon)
        some = slice(guides.start, guides.stop - (drive != NONE and held))
        every += zip(tendons.guide_body[some].tolist(), tendons.guide_at[some, None], strict=True)
    for body, points in every:
        found.setdefault(body, []).extend((x, y) for x, y in points.tolist())
    return found


def beside(model: Model, body: int, at: XY) -> XY | None:
    """The point of a body's shapes nearest to a point outside, in its frame [m]; None if inside."""
    rings = [shape_outline(solid) for shape in model.mechanism.bodies[body].shapes
             for solid, _ in solids(shape)]
    if not rings or any(holds(ring, np.array([at])) for ring in rings):
        return None
    start = np.concatenate(rings)
    side = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings]) - start
    away = from_sides(np.array([at]), start, side)[0]
    x, y = (at - away[np.hypot(*away.T).argmin()]).tolist()
    return x, y


def outer_anchors(model: Model) -> list[tuple[int, XY, XY]]:
    """Bodies with each of their anchors beside their shapes [m], and the nearest point of these."""
    ends = {(body, (x, y)) for body, points in _anchors(model, grooves=False, wheels=False)
            for x, y in points.tolist()}
    return [(body, at, nearest) for body, at in sorted(ends)
            if (nearest := beside(model, body, at))]


def add_anchor_lines(s: Subject) -> None:
    """Lines from moving bodies to anchors beside them, below the bodies."""
    model = s.run.model
    for body, *ends in outer_anchors(model):
        if not model.bodies.fixed[body] and body in s.layers.get("bodies", ()):
            _, edge = tokens(s, ROLES[model.mechanism.bodies[body].role])
            s.add("anchor lines", "line", plane=s.plane(body), s=("", edge, ANCHOR_LINE),
                  p=[s.on(body, at) for at in ends])


def add_wheels(s: Subject) -> None:
    """Wheels of guides that no circle of their body shows, with the smaller circles above them."""
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
            s.add("wheels", "path", plane=s.plane(body), f=body, s=(fill, edge, 1.2),
                  d=[{"c": [*flat(at, at), short(radius)]}])
            if len(steps) > 1:
                s.add("wheels", "line", plane=s.plane(body), s=("", edge, 1.2),
                      p=[s.on(body, at), s.on(body, (at[0] + radius, at[1]))])
