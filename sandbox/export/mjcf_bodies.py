"""The tree of bodies of a MuJoCo model: inertias, joints, shapes, sites."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

from sandbox.export.freedoms import Freedom
from sandbox.export.mjcf_document import Draft
from sandbox.export.mjcf_joints import hinge_law
from sandbox.export.tree import vec
from sandbox.export.xmltext import add
from sandbox.model.model import NONE, Bodies
from sandbox.scene.elements.bodies import (
    Body,
    Box,
    Capsule,
    Circle,
    Polygon,
    Polyline,
    Role,
    Shape,
    Solid,
)
from sandbox.scene.geometry import Vec, corners, count_solids, solids

COLOURS: dict[Role, str] = {
    "link": "0.55 0.6 0.66 1", "ground": "0.5 0.5 0.5 1", "palm": "0.6 0.55 0.5 1",
    "phalanx": "0.88 0.74 0.6 1", "rocker": "0.45 0.6 0.75 1", "pulley": "0.45 0.6 0.75 1",
    "object": "0.5 0.7 0.5 1",
}
MARGIN = 1.05
"""By how much the site that feels a body's contacts reaches beyond its shapes."""


def add_bodies(draft: Draft) -> dict[str, list[str]]:
    """Fill the world with all bodies; the names of every body's geoms."""
    world = draft.sections["worldbody"]
    add(world, "light", pos=(0, 0, 1), dir=(0, 0, -1), directional="true")
    places: dict[int, ET.Element] = {NONE: world}
    geoms: dict[str, list[str]] = {}
    for number, link in draft.tree.links.items():
        x, y, angle = link.pose
        place = add(places[link.parent], "body", name=draft.body_names[number], pos=(x, y, 0.0),
                    euler=(0.0, 0.0, angle) if angle else None)
        places[number] = place
        _add_inertia(place, draft.model.bodies, number)
        for move in draft.moves[number]:
            _add_joint(draft, place, move)
        body = draft.mechanism.bodies[number]
        deep = [(solid, depth(shape))
                for shape in body.shapes for solid, _ in solids(shape)]
        geoms[body.name] = [_add_shape(draft, place, body, i, solid, half)
                            for i, (solid, half) in enumerate(deep)]
    for number, place in places.items():
        place.extend(draft.on_body[number])
    return geoms


def _add_inertia(place: ET.Element, bodies: Bodies, number: int) -> None:
    if not bodies.free[number]:
        return
    inertia = float(bodies.inertia[number])
    # only the turn about z can happen; three equal values are an inertia that a solid can have
    add(place, "inertial", pos=(*vec(bodies.centre[number]), 0.0), mass=float(bodies.mass[number]),
        diaginertia=(inertia, inertia, inertia))


def _add_joint(draft: Draft, place: ET.Element, move: Freedom) -> None:
    law = hinge_law(draft, move.joint) if move.joint != NONE else {}
    if move.loss:
        law["frictionloss"] = move.loss
    add(place, "joint", name=move.name, type=move.kind, axis=move.axis,
        pos=(*move.at, 0.0) if move.kind == "hinge" else None,
        ref=move.start or None, range=move.limits, **law)


def _add_shape(
    draft: Draft, place: ET.Element, body: Body, i: int, shape: Solid, half: float,
) -> str:
    wanted = body.name if count_solids(body) == 1 else f"{body.name}.{i}"
    name = wanted if wanted == body.name else draft.names.made("geom", wanted)
    colour = COLOURS[body.role]
    match shape:
        case Circle():
            add(place, "geom", name=name, type="sphere", size=shape.radius, pos=(*shape.at, 0.0),
                rgba=colour)
        case Capsule():
            _add_capsule(place, name, shape, colour)
        case Box():
            add(place, "geom", name=name, type="box", pos=(*shape.at, 0.0), rgba=colour,
                size=(shape.size[0] / 2, shape.size[1] / 2, half),
                euler=(0.0, 0.0, shape.angle) if shape.angle else None)
        case Polygon():
            points = corners(shape)
            mesh = draft.names.made("mesh", wanted)
            add(draft.sections["asset"], "mesh", name=mesh, vertex=[
                value for z in (-half, half) for x, y in points for value in (x, y, z)])
            add(place, "geom", name=name, type="mesh", mesh=mesh, rgba=colour)
    return name


def depth(shape: Shape) -> float:
    """How far a prism reaches to either side of the plane [m]; 0 of what is round.

    As far as it is large, so that two of them always part in the plane.
    """
    if not isinstance(shape, Box | Polygon):
        return 0.0
    points = corners(shape)
    return max(math.dist(p, q) for p in points for q in points) / 2


def _add_capsule(place: ET.Element, name: str, shape: Capsule, colour: str) -> None:
    if shape.start == shape.end:
        add(place, "geom", name=name, type="sphere", size=shape.radius, pos=(*shape.end, 0.0),
            rgba=colour)
    else:
        add(place, "geom", name=name, type="capsule", size=shape.radius, rgba=colour,
            fromto=(*shape.start, 0.0, *shape.end, 0.0))


def enclosing(body: Body) -> tuple[Vec, float]:
    """Centre and radius [m] of a ball that holds all of a body's shapes, prisms' depth and all."""
    points: list[tuple[Vec, float]] = []
    deep = 0.0
    for shape in body.shapes:
        match shape:
            case Circle():
                points.append((shape.at, shape.radius))
            case Polyline():
                points += [(point, shape.radius) for point in shape.points]
            case Capsule():
                points += [(shape.start, shape.radius), (shape.end, shape.radius)]
            case Box() | Polygon():
                points += [(corner, 0.0) for corner in corners(shape)]
                deep = max(deep, depth(shape))
    xs, ys = [p[0] for p, _ in points], [p[1] for p, _ in points]
    centre = (min(xs) + max(xs)) / 2, (min(ys) + max(ys)) / 2
    return centre, math.hypot(max(math.dist(centre, p) + r for p, r in points), deep)


def sense_bodies(draft: Draft) -> None:
    """Sensors for what is recorded of bodies and hinges; sites that feel contacts."""
    for number, body in enumerate(draft.mechanism.bodies):
        if not draft.model.bodies.free[number]:
            continue
        own = draft.body_names[number]
        draft.sense("framepos", f"{body.name}.position", objtype="xbody", objname=own)
        draft.sense("framexaxis", f"{body.name}.xaxis", objtype="xbody", objname=own)
        draft.sense("framelinvel", f"{body.name}.velocity", objtype="body", objname=own)
        draft.sense("frameangvel", f"{body.name}.omega", objtype="body", objname=own)
        if body.shapes:
            centre, radius = enclosing(body)
            site = draft.site(number, f"{body.name}.skin", centre, size=MARGIN * radius,
                              group="5")
            draft.sense("touch", f"{body.name}.contact.normal", site=site)
    for moves in draft.moves.values():
        for move in moves:
            if move.joint == NONE:
                continue
            draft.sense("jointpos", f"{move.name}.angle", joint=move.name)
            draft.sense("jointvel", f"{move.name}.rate", joint=move.name)
            if move.limits is not None:
                draft.sense("jointlimitfrc", f"{move.name}.stop", joint=move.name)
