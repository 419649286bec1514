"""pymunk's objects of a mechanism, read and written in batches.

Contact rules become pymunk's shape filters: a group number (no contact within a group) and 32
category bits. The links of a finger become a group; bodies that meet the same others share a
category. This is exact up to 32 kinds of body; beyond, contacts are filtered when they are listed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np
import pymunk
from pymunk import batch

from sandbox.engine import native
from sandbox.engine.state import FACE, SHAPE, SPAN
from sandbox.model.model import Model
from sandbox.model.pairs import Words, allowed_pairs, joined, pair_skins
from sandbox.numeric import Array, Flags, Integers, Records
from sandbox.scene import bodies as kinds
from sandbox.scene.bodies import Material
from sandbox.scene.geometry import Vec, core, corners, pose_of, solids, to_world, true_curves
from sandbox.scene.outlines.curves import spans_of

POSE = batch.BodyFields.POSITION | batch.BodyFields.ANGLE
PUSH = batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
MARGIN, MAX_MARGIN = 0.05, 1e-3  # of shapes in pymunk: share of their smallest extent, maximum [m]
_LISTED = ("dynamic", "scheduled", "fixed")


class World:
    """A pymunk space for one run, which finds the bodies that are near one another.

    Bodies stand at their centres of mass, half a step before t = 0, and are numbered as pymunk
    lists them: dynamic, scheduled, fixed. Arrays are those of :mod:`sandbox.engine.state`.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        run = model.mechanism.run
        self.h = run.step
        motions = [_LISTED.index(body.motion) for body in model.mechanism.bodies]
        self.order: Integers = np.argsort(motions, kind="stable").astype(np.int64)
        """The model's numbers of the bodies in pymunk's order, [nb]."""
        self.number: Integers = np.argsort(self.order)  # pymunk's numbers in the model's order
        self.filters = make_filters(model)
        count = len(self.order)
        self.body: Array = np.zeros((count, 6))
        self.placed: Array = np.zeros((count, 3))
        self.velocity: Array = np.zeros((count, 3))
        self.writer = native.Channel(PUSH, self.velocity)
        self.placer = native.Channel(POSE, self.placed)
        self.shape_tables, self._pieces = _shape_tables(model, self.order, self.number)
        self.renew()

    def renew(self) -> None:
        """Make the space and all in it anew, as at the start."""
        self.space = pymunk.Space()
        self.space.iterations = 1
        self.space.collision_persistence = 1  # an arbiter lives as long as its contact
        self.shapes: dict[int, list[list[pymunk.Shape]]] = {}
        """Of each body, by the model's number, and of each of its shapes, convex ones each."""
        self.bodies = [self._add_body(i) for i in self.order.tolist()]  # in pymunk's order
        for a, b in self.number[np.stack(joined(self.model), axis=1)].tolist():
            # the constraint that costs least, without force: it keeps its bodies from touching
            motor = pymunk.SimpleMotor(self.bodies[a], self.bodies[b], 0.0)
            motor.collide_bodies, motor.max_force = False, 0.0
            self.space.add(motor)
        self.room = Room(contacts=32 + 8 * len(self.shape_tables.shapes),
                         rows=64 + 4 * len(self.bodies))
        self.finder = native.Finder(self.space, self.room.contacts)
        self.native = native.make_native(self.space, self.writer, self.placer, self.finder)
        self.read()

    def read(self) -> None:
        """Take all poses and velocities from pymunk."""
        for row, body in zip(self.body, self.bodies, strict=True):
            row[:] = *body.position, body.angle, *body.velocity, body.angular_velocity
        self.placed[:], self.velocity[:] = self.body[:, :3], self.body[:, 3:]

    def enlarge(self, found: int, rows: int) -> None:
        """Make room for twice ``found`` contacts, and for ``rows`` bounded rows."""
        self.room = Room(contacts=2 * max(self.room.contacts, found),
                         rows=max(self.room.rows, rows))
        self.native = self.native._replace(raw=self.finder.raw)

    def _add_body(self, index: int) -> pymunk.Body:
        spec, bodies = self.model.mechanism.bodies[index], self.model.bodies
        centre = bodies.centre[index, 0].item(), bodies.centre[index, 1].item()
        if bodies.free[index]:
            body = pymunk.Body(bodies.mass[index].item(), bodies.inertia[index].item())
            x, y = to_world(pose_of(spec), centre)
            body.position = x - self.h / 2 * spec.velocity[0], y - self.h / 2 * spec.velocity[1]
            body.angle = spec.angle - self.h / 2 * spec.angular_velocity
            body.velocity = spec.velocity
            body.angular_velocity = spec.angular_velocity
        else:
            kind = pymunk.Body.STATIC if spec.motion == "fixed" else pymunk.Body.KINEMATIC
            body = pymunk.Body(body_type=kind)
            body.position = spec.at
            body.angle = spec.angle  # of a scheduled one set anew by sandbox.engine.inputs
        self.space.add(body)
        rule = pymunk.ShapeFilter(*(int(each[index]) for each in (
            self.filters.group, self.filters.category, self.filters.mask)))
        self.shapes[index] = []
        for pieces in self._pieces[index]:
            self.shapes[index].append([])
            for piece, margin, number in pieces:
                shape = make_shape(body, piece, centre, margin)
                shape.filter, shape.collision_type = rule, number
                self.shapes[index][-1].append(shape)
                self.space.add(shape)
        return body


class ShapeTables(NamedTuple):
    """Tables of the constants of the same names (:mod:`sandbox.engine.state`)."""

    shapes: Records
    faces: Records
    vertices: Array
    spans: Records


Pieces = dict[int, list[list[tuple[kinds.Solid, float, int]]]]
"""Of each body and shape of the model: convex shapes with margins [m] and numbers from 1."""


def _shape_tables(model: Model, order: Integers, number: Integers) -> tuple[ShapeTables, Pieces]:
    rows: list[tuple[float, ...]] = []
    faces: list[tuple[float, ...]] = []
    vertices: list[Array] = []
    spans, pieces = [np.zeros(0, dtype=SPAN)], Pieces()
    for index in order.tolist():
        centre = model.bodies.centre[index, 0].item(), model.bodies.centre[index, 1].item()
        pieces[index] = []
        for shape in model.mechanism.bodies[index].shapes:
            margin, leader, curve = min(MARGIN * _extent(shape), MAX_MARGIN), len(rows), (-1, -1, 0)
            if isinstance(shape, kinds.Polygon | kinds.Polyline) and shape.nodes:
                first, closed = sum(map(len, spans)), isinstance(shape, kinds.Polygon)
                for nodes in true_curves(shape):
                    spans.append(span_table(nodes, centre, sum(map(len, spans)), closed=closed))
                curve = first, sum(map(len, spans)), int(closed)
            pieces[index].append([])
            for piece, arcs in solids(shape):
                face, vertex, (points, radius) = (-1, -1), len(vertices), core(piece)
                if arcs is not None:
                    face = len(faces), len(faces) + len(arcs)
                    faces += map(tuple, arcs.tolist())
                vertices += [*(np.array(points) - centre)]
                rows.append((int(number[index]), margin, *face, vertex, len(vertices), radius,
                             *curve, leader))
                pieces[index][-1].append((piece, margin, len(rows)))
    return ShapeTables(
        np.array(rows, dtype=SHAPE), np.array(faces, dtype=FACE),
        np.array(vertices).reshape(-1, 2), np.concatenate(spans)), pieces


def _extent(spec: kinds.Shape) -> float:
    """The smallest extent of a shape [m]; of one that is not convex, that of its hull."""
    match spec:
        case kinds.Circle() | kinds.Capsule():
            return 2 * spec.radius
        case kinds.Polyline():
            return 2 * spec.radius or max(math.dist(p, q) for p, q in pairwise(spec.points))
        case kinds.Box() | kinds.Polygon():
            points = np.array(corners(spec))
            edges = np.roll(points, -1, axis=0) - points
            normals = np.stack([-edges[:, 1], edges[:, 0]], axis=1)
            normals /= np.hypot(*normals.T)[:, None]
            across = points @ normals.T
            return float(np.min(across.max(axis=0) - across.min(axis=0)))


def span_table(nodes: Array, centre: Vec, first: int, *, closed: bool) -> Records:
    """The SPANs of one curve; ``first`` is the number of its first one."""
    spans = spans_of(nodes - [*centre, 0.0, 0.0], closed=closed)
    found = np.zeros(len(spans.terms), dtype=SPAN)
    for name, column in zip(SPAN.names or (), spans.terms.T, strict=False):
        found[name] = column
    number = first + np.arange(len(found))
    found["before"], found["after"] = np.roll(number, 1), np.roll(number, -1)
    found["corner"] = spans.corner
    if not closed:
        found["before"][0] = found["after"][-1] = -1
    return found


def make_shape(
    body: pymunk.Body, spec: kinds.Solid, centre: tuple[float, float], margin: float = 0.0,
) -> pymunk.Shape:
    """The convex shape of ``spec`` about ``centre``, larger all round by ``margin`` [m]."""
    cx, cy = centre
    match spec:
        case kinds.Circle():
            return pymunk.Circle(body, spec.radius + margin, (spec.at[0] - cx, spec.at[1] - cy))
        case kinds.Capsule():
            (x0, y0), (x1, y1) = spec.start, spec.end
            return pymunk.Segment(
                body, (x0 - cx, y0 - cy), (x1 - cx, y1 - cy), spec.radius + margin)
        case kinds.Box() | kinds.Polygon():
            return pymunk.Poly(body, [(x - cx, y - cy) for x, y in corners(spec)], radius=margin)


CATEGORIES = 32


@dataclass(frozen=True)
class Filters:
    """Contact rules: pymunk's filters of bodies, and matrices of pairs of bodies."""

    group: Integers  # of each body, in the model's order, [nb]
    category: Integers  # bits
    mask: Integers
    exact: bool  # whether these are the rules; else contacts are filtered later
    allowed: Flags  # pairs that may touch, [nb, nb]
    friction: Array
    static: Array
    restitution: Array
    skin: Array  # stiffness and damping of soft contacts, [2, nb, nb]; [2, 0, 0] without any


def make_filters(model: Model) -> Filters:
    """Filters for every body of a model."""
    mechanism, words = model.mechanism, Words(model.bodies.name)
    count = len(words.names)
    allowed = allowed_pairs(model)
    settled = np.eye(count, dtype=bool)  # pairs that need no category
    rests = ~model.bodies.free
    settled[np.ix_(rests, rests)] = True
    i, j = joined(model)
    settled[i, j] = settled[j, i] = True
    group = np.zeros(count, dtype=np.int64)
    for number, rule in enumerate(mechanism.contacts, start=1):
        if rule.collide or rule.between[0] != rule.between[1]:
            continue
        members = words(rule.between[0])
        block = np.ix_(members, members)
        if len(members) > 1 and not group[members].any() and not allowed[block].any():
            group[members] = number
            settled[block] = True
    rows = allowed | settled
    bits, mask, exact = np.ones(count, dtype=np.int64), np.ones(count, dtype=np.int64), True
    if count:
        kinds, kind = np.unique(rows, axis=0, return_inverse=True)
        exact = len(kinds) <= CATEGORIES
        if exact:
            bits = np.left_shift(np.int64(1), kind.reshape(-1).astype(np.int64))
            mask = np.bitwise_or.reduce(np.where(rows, bits, 0), axis=1)
    materials = [mechanism.materials.get(body.material or "", Material())
                 for body in mechanism.bodies]
    roots = np.sqrt([[m.friction, m.static, m.restitution] for m in materials]).reshape(-1, 3).T
    pairs = np.ascontiguousarray(roots[:, :, None] * roots[:, None, :])  # geometric means
    for rule in mechanism.contacts:
        for table, value in zip(pairs, (rule.friction, rule.static), strict=False):
            if value is not None:
                words.fill(table, rule, value)
    friction, static, restitution = pairs
    return Filters(group, bits, mask, exact, allowed, friction, static, restitution,
                   pair_skins(mechanism))


class Room(NamedTuple):
    """Room for points where shapes are near one another, and for bounded rows, in a step."""

    contacts: int
    rows: int
