"""Plain geometry of elements: positions at t = 0, and masses of bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from sandbox.elements.registry import Joint
from sandbox.numeric import Array
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Polygon, Polyline, Shape, Solid
from sandbox.scene.outlines.curves import reversed_nodes
from sandbox.scene.outlines.rings import chain_faces, pieces_of, signed_area, wound

Vec = tuple[float, float]
Pose = tuple[float, float, float]


def to_world(pose: Pose, point: Vec) -> Vec:
    """A point of a body's frame [m] in the world, for a pose (x, y, angle)."""
    x, y, angle = pose
    c, s = math.cos(angle), math.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


def to_body(pose: Pose, point: Vec) -> Vec:
    """A point of the world [m] in the frame of a body with a pose (x, y, angle)."""
    x, y, angle = pose
    c, s = math.cos(angle), math.sin(angle)
    dx, dy = point[0] - x, point[1] - y
    return c * dx + s * dy, -s * dx + c * dy


def pose_of(body: Body) -> Pose:
    """Pose (x, y, angle) of a body's frame at t = 0."""
    return (*body.at, body.angle)


def anchors(joint: Joint, a: Body, b: Body) -> tuple[Vec, Vec]:
    """Anchors of a joint in the frames of ``a`` and ``b`` [m]; the one left out is filled in."""
    on_a, on_b = joint.on_a, joint.on_b
    if on_a is None:
        assert on_b is not None  # the model demands one of the two
        on_a = to_body(pose_of(a), to_world(pose_of(b), on_b))
    if on_b is None:
        on_b = to_body(pose_of(b), to_world(pose_of(a), on_a))
    return on_a, on_b


def corners(shape: Box | Polygon) -> list[Vec]:
    """Corners of a box or of a polygon's outline in the body's frame, counter-clockwise."""
    if isinstance(shape, Box):
        w, h = shape.size[0] / 2, shape.size[1] / 2
        frame = (*shape.at, shape.angle)
        return [to_world(frame, p) for p in ((-w, -h), (w, -h), (w, h), (-w, h))]
    return list(wound(shape.points))


@lru_cache(maxsize=512)
def solids(shape: Shape) -> tuple[tuple[Solid, Array | None], ...]:
    """The convex shapes of a shape, each with the arcs of normals of its surface; None for all."""
    if isinstance(shape, Polyline):
        return tuple(
            (Capsule.model_construct(type="capsule", start=p, end=q, radius=shape.radius), faces)
            for (p, q), faces in zip(pairwise(shape.points), chain_faces(shape.points),
                                     strict=True))
    if isinstance(shape, Polygon) and not shape.whole:
        return tuple(
            (Polygon.model_construct(type="polygon", points=piece.ring, holes=()), piece.faces)
            for piece in pieces_of(shape.points, shape.holes))
    return ((shape, None),)


def true_curves(shape: Polygon | Polyline) -> list[Array]:
    """Nodes of the curves that contacts follow; of a polygon the material lies to their left."""
    curves = [np.array(nodes) for nodes in shape.nodes]
    if isinstance(shape, Polyline):
        return curves
    return [reversed_nodes(nodes) if (signed_area(ring) > 0) == (k > 0) else nodes for
            k, (nodes, ring) in enumerate(zip(curves, (shape.points, *shape.holes), strict=True))]


def count_solids(body: Body) -> int:
    """How many convex shapes a body has."""
    return sum(len(solids(shape)) for shape in body.shapes)


def outline(shape: Shape) -> list[Vec]:
    """Points whose bounds hold the shape, in the body's frame [m]."""
    points, r = (shape.points, shape.radius) if isinstance(shape, Polyline) else core(shape)
    return [(x + dx, y + dy) for x, y in points for dx in (-r, r) for dy in (-r, r)] if r else \
        list(points)


@dataclass(frozen=True)
class MassProperties:
    """Mass [kg], centre of mass in the body's frame [m], inertia about that centre [kg m^2]."""

    mass: float
    centre: Vec
    inertia: float


AreaProperties = tuple[float, Vec, float]
"""Area [m^2], centroid [m] and second moment of area about the centroid [m^4]."""


def area_properties(shape: Shape) -> AreaProperties:
    """Of a polygon those of its outline less those of its holes; a polyline has no area."""
    if isinstance(shape, Circle):
        area = math.pi * shape.radius**2
        return area, shape.at, area * shape.radius**2 / 2
    if isinstance(shape, Capsule):
        r, length = shape.radius, math.dist(shape.start, shape.end)
        bar, half = 2 * r * length, math.pi * r**2 / 2
        offset = 4 * r / (3 * math.pi)  # of a half disc's centroid from its flat side
        second = bar * (length**2 + 4 * r**2) / 12
        second += 2 * (half * r**2 / 2 - half * offset**2 + half * (length / 2 + offset) ** 2)
        centre = ((shape.start[0] + shape.end[0]) / 2, (shape.start[1] + shape.end[1]) / 2)
        return bar + 2 * half, centre, second
    if isinstance(shape, Polyline):
        return 0.0, shape.points[0], 0.0
    outer = _ring_properties(corners(shape))
    if isinstance(shape, Box) or not shape.holes:
        return outer
    rings = [outer, *(_ring_properties(list(wound(hole, -1))) for hole in shape.holes)]
    return _whole(rings)


def _whole(parts: list[AreaProperties]) -> AreaProperties:
    """Those of several shapes together; their centroid is the origin if they have no area."""
    area = sum(part[0] for part in parts)
    centre = (sum(a * c[0] for a, c, _ in parts) / area,
              sum(a * c[1] for a, c, _ in parts) / area) if area else (0.0, 0.0)
    return area, centre, sum(i + a * math.dist(c, centre) ** 2 for a, c, i in parts)


def _ring_properties(points: list[Vec]) -> AreaProperties:
    """Those inside corners; negative for a clockwise outline."""
    sides = list(zip(points, points[1:] + points[:1], strict=True))
    cross = [p[0] * q[1] - p[1] * q[0] for p, q in sides]
    area = sum(cross) / 2
    cx, cy = (sum((p[k] + q[k]) * c for (p, q), c in zip(sides, cross, strict=True)) / (6 * area)
              for k in (0, 1))
    local = [((p[0] - cx, p[1] - cy), (q[0] - cx, q[1] - cy)) for p, q in sides]
    second = sum((p[0] * q[1] - p[1] * q[0])
                 * (p[0] ** 2 + p[0] * q[0] + q[0] ** 2 + p[1] ** 2 + p[1] * q[1] + q[1] ** 2)
                 for p, q in local)
    return area, (cx, cy), second / 12


def centre_of(body: Body) -> Vec:
    """Centre of mass of any body in its frame [m]: as given, else that of its shapes' area."""
    return body.centre or _whole([area_properties(shape) for shape in body.shapes])[1]


def reach_of(body: Body, point: Vec) -> float:
    """Greatest distance of a body's outline from a point of its frame [m]; 0 without shapes."""
    cores = [core(solid) for shape in body.shapes for solid, _ in solids(shape)]
    return max((math.dist(at, point) + radius for points, radius in cores for at in points),
               default=0.0)


def core(solid: Solid) -> tuple[list[Vec], float]:
    """Points whose convex hull, grown by a radius, is the shape [m]; counter-clockwise."""
    if isinstance(solid, Circle):
        return [solid.at], solid.radius
    if isinstance(solid, Capsule):
        return [solid.start, solid.end], solid.radius
    return corners(solid), 0.0


def mass_properties(body: Body) -> MassProperties:
    """Mass, centre and inertia of a dynamic body: as given, else from its shapes.

    Shapes that overlap count twice where they do.
    """
    area, centre, second = _whole([area_properties(shape) for shape in body.shapes])
    mass = body.mass
    if mass is None:
        assert body.density is not None  # the model demands one of the two
        mass = body.density * body.thickness * area
    if body.centre is not None:
        second += area * math.dist(centre, body.centre) ** 2
        centre = body.centre
    inertia = body.inertia if body.inertia is not None else mass * second / area
    return MassProperties(mass, centre, inertia)
