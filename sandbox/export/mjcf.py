"""A mechanism as a MuJoCo model (MJCF): the same bodies, joints, tendons, contacts and drives.

The plane is x-y and z points at the viewer, so that a hinge turns about z. Joints that close loops
are equality constraints, contacts are explicit pairs. Units are SI, names are the scene's.
"""

from __future__ import annotations

import itertools
import math
import xml.etree.ElementTree as ET
from collections.abc import Mapping, Sequence

import sandbox
from sandbox.errors import SceneError
from sandbox.export.document import Draft, add, comment, document, number
from sandbox.export.elements import (
    add_closing_angles,
    add_drives,
    add_links,
    add_springs,
    add_start,
    add_tendons,
    hinge_law,
)
from sandbox.export.selection import contact_pairs, leave_out, without_counterpart
from sandbox.export.tree import Freedom, grow, vec
from sandbox.model.compile import compile_mechanism
from sandbox.model.model import NONE, Bodies
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Polygon, Polyline, Role, Shape, Solid
from sandbox.scene.geometry import Vec, corners, count_solids, solids
from sandbox.scene.mechanism import Mechanism

STIFFNESS = "0.9999 0.9999 0.001 0.5 2"
"""solimp: the hardest constraint that MuJoCo allows, whatever its depth."""
IMPEDANCE_RATIO = 10.0
"""impratio, of friction to normal force: MuJoCo's contacts creep less if it is large."""


def write_mjcf(
    mechanism: Mechanism, without: Sequence[str] = (),
) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    """The text of a MuJoCo model, notes on differences, and names of elements left out.

    Raises:
        SceneError: elements without a counterpart, or names in ``without`` that fit no element.
    """
    kept, left_out = leave_out(mechanism, without)
    model = compile_mechanism(kept)
    tree = grow(model)
    if problems := without_counterpart(model, tree):
        raise SceneError(problems)
    draft = Draft(model, tree)
    add_springs(draft)
    step = min(kept.run.step, add_tendons(draft))
    add_links(draft)
    add_drives(draft)
    add_closing_angles(draft)
    sense_bodies(draft)
    geoms = add_bodies(draft)
    _add_pairs(draft, geoms)
    add_start(draft)
    _add_settings(draft, step)
    if step < kept.run.step:
        draft.notes.append(f"an elastic tendon takes a time step of {number(step)} s here, "
                           f"not {number(kept.run.step)} s")
    return document(draft.root), tuple(draft.notes), left_out


def _add_settings(draft: Draft, step: float) -> None:
    mechanism, sections = draft.mechanism, draft.sections
    head = (f"{mechanism.title or mechanism.name or 'A mechanism'}; written by sandbox "
            f"{sandbox.__version__}. SI units; the plane is x-y.")
    draft.root.insert(0, comment(head))
    for name, text in {"angle": "radian", "autolimits": "true", "inertiafromgeom": "false"}.items():
        sections["compiler"].set(name, text)
    option: Mapping[str, str] = {
        "timestep": number(step),
        "gravity": f"{number(mechanism.gravity[0])} {number(mechanism.gravity[1])} 0",
        "integrator": "implicitfast", "cone": "elliptic", "impratio": number(IMPEDANCE_RATIO),
        "solver": "Newton", "iterations": "200", "tolerance": "1e-12",
    }
    for name, text in option.items():
        sections["option"].set(name, text)
    hard = f"{number(2 * step)} 1"  # the shortest time constant that MuJoCo takes
    defaults = sections["default"]
    # brakes creep, as friction does in MuJoCo: keep it small
    braked = any(hinge.brake is not None for hinge in draft.hinges.values())
    friction = {"solreffriction": hard, "solimpfriction": STIFFNESS} if braked else {}
    add(defaults, "joint", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "geom", contype="0", conaffinity="0")
    add(defaults, "site", size=0.0008, rgba="0.2 0.2 0.2 1")
    add(defaults, "tendon", solreflimit=hard, solimplimit=STIFFNESS, **friction)
    add(defaults, "equality", solref=hard, solimp=STIFFNESS)
    # sliding contacts chatter less with twice that time constant
    add(defaults, "pair", solref=f"{number(4 * step)} 1", solimp=STIFFNESS)


def _add_pairs(draft: Draft, geoms: Mapping[str, Sequence[str]]) -> None:
    """A contact pair for any two shapes that may touch; ``condim`` 1 has no friction."""
    names = draft.model.bodies.name
    for a, b, friction in contact_pairs(draft.model):
        for one, other in itertools.product(geoms[names[a]], geoms[names[b]]):
            add(draft.sections["contact"], "pair", geom1=one, geom2=other,
                condim="3" if friction else "1",
                friction=(friction, friction) if friction else None)


COLOURS: dict[Role, str] = {
    "link": "0.55 0.6 0.66 1", "ground": "0.5 0.5 0.5 1", "palm": "0.6 0.55 0.5 1",
    "phalanx": "0.88 0.74 0.6 1", "rocker": "0.45 0.6 0.75 1", "pulley": "0.45 0.6 0.75 1",
    "object": "0.5 0.7 0.5 1",
}
MARGIN = 1.05
"""Radius of the site of a touch sensor, relative to that of the body's shapes."""


def add_bodies(draft: Draft) -> dict[str, list[str]]:
    """Add all bodies to the world; return the names of each body's geoms."""
    world = draft.sections["worldbody"]
    add(world, "light", pos=(0, 0, 1), dir=(0, 0, -1), directional="true")
    places: dict[int, ET.Element] = {NONE: world}
    geoms: dict[str, list[str]] = {}
    for index, link in draft.tree.links.items():
        x, y, angle = link.pose
        place = add(places[link.parent], "body", name=draft.body_names[index], pos=(x, y, 0.0),
                    euler=(0.0, 0.0, angle) if angle else None)
        places[index] = place
        _add_inertia(place, draft.model.bodies, index)
        for move in draft.moves[index]:
            _add_joint(draft, place, move)
        body = draft.mechanism.bodies[index]
        deep = [(solid, depth(shape))
                for shape in body.shapes for solid, _ in solids(shape)]
        geoms[body.name] = [_add_shape(draft, place, body, i, solid, half)
                            for i, (solid, half) in enumerate(deep)]
    for index, place in places.items():
        place.extend(draft.on_body[index])
    return geoms


def _add_inertia(place: ET.Element, bodies: Bodies, index: int) -> None:
    if not bodies.free[index]:
        return
    inertia = float(bodies.inertia[index])
    # only the rotation about z matters; three equal values satisfy the triangle inequality
    add(place, "inertial", pos=(*vec(bodies.centre[index]), 0.0), mass=float(bodies.mass[index]),
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
    """Half the depth of a prism [m]; 0 for round shapes.

    It equals half the size of the shape, so that two prisms always separate in the plane.
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
    """Centre and radius [m] of a ball around all shapes of a body, with the depth of prisms."""
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
    """Add sensors for the quantities of bodies and hinges, and sites for contact forces."""
    for index, body in enumerate(draft.mechanism.bodies):
        if not draft.model.bodies.free[index]:
            continue
        own = draft.body_names[index]
        draft.sense("framepos", f"{body.name}.position", objtype="xbody", objname=own)
        draft.sense("framexaxis", f"{body.name}.xaxis", objtype="xbody", objname=own)
        draft.sense("framelinvel", f"{body.name}.velocity", objtype="body", objname=own)
        draft.sense("frameangvel", f"{body.name}.omega", objtype="body", objname=own)
        if body.shapes:
            centre, radius = enclosing(body)
            site = draft.site(index, f"{body.name}.skin", centre, size=MARGIN * radius,
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
