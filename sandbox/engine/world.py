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
MARGIN, MAX_MARGIN = 0.05, 1e-3
"""Of shapes in pymunk: a share of their smallest extent, maximum [m]."""
_LISTED = ("dynamic", "scheduled", "fixed")


class World:
    """A pymunk space for one run, which finds the bodies that are near one another.

    Bodies stand at their centres of mass and are numbered as pymunk lists them: dynamic, scheduled,
    fixed. They start half a step before t = 0, as the leapfrog has it. ``body`` [nb, 6] (x, y,
    angle, vx, vy, omega), ``velocity`` [nb, 3] and ``placed`` [nb, 3] are memory of the run
    (:mod:`sandbox.engine.state`).
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        run = model.mechanism.run
        self.h = run.step
        motions = [_LISTED.index(body.motion) for body in model.mechanism.bodies]
        self.order: Integers = np.argsort(motions, kind="stable").astype(np.int64)
        """The model's numbers of the bodies in pymunk's order, [nb]."""
        self.number: Integers = np.argsort(self.order)
        """Pymunk's numbers of the bodies in the model's order, [nb]."""
        self.filters = make_filters(model)
        count = len(self.order)
        self.body: Array = np.zeros((count, 6))
        self.placed: Array = np.zeros((count, 3))
        self.velocity: Array = np.zeros((count, 3))
        self.writer = native.Channel(PUSH, self.velocity)
        self.placer = native.Channel(POSE, self.placed)
        self.renew()
        self.shape_tables = ShapeTables(
            np.array(self._shape_rows, dtype=SHAPE),
            np.array([tuple(arc) for faces in self._faces for arc in faces.tolist()], dtype=FACE),
            np.concatenate([np.zeros((0, 2)), *self._cores]),
            np.concatenate([np.zeros(0, dtype=SPAN), *self._spans]))

    def renew(self) -> None:
        """Make the space and all in it anew, as at the start."""
        self.space = pymunk.Space()
        self.space.iterations = 1
        self.space.collision_persistence = 1  # an arbiter lives as long as its contact
        self.shapes: dict[int, list[list[pymunk.Shape]]] = {}
        """Of each body, by the model's number, and of each of its shapes, convex ones each."""
        self._shape_rows: list[tuple[float, ...]] = []
        self._faces: list[Array] = []
        self._cores: list[Array] = []
        self._spans: list[Records] = []
        self.bodies = [self._add_body(i) for i in self.order.tolist()]  # in pymunk's order
        for a, b in self.number[np.stack(joined(self.model), axis=1)].tolist():
            # the constraint that costs least, without force: it keeps its bodies from touching
            motor = pymunk.SimpleMotor(self.bodies[a], self.bodies[b], 0.0)
            motor.collide_bodies, motor.max_force = False, 0.0
            self.space.add(motor)
        self.room = Room(contacts=32 + 8 * len(self._shape_rows), rows=64 + 4 * len(self.bodies))
        self.finder = native.Finder(self.space, self.room.contacts)
        self.native = native.make_native(self.space, self.writer, self.placer, self.finder)
        self.read()

    def read(self) -> None:
        """Take all poses and velocities from pymunk."""
        for row, body in zip(self.body, self.bodies, strict=True):
            row[:] = *body.position, body.angle, *body.velocity, body.angular_velocity
        self.placed[:], self.velocity[:] = self.body[:, :3], self.body[:, 3:]

    def place(self, pose: Array, velocity: Array) -> None:
        """Put all bodies to poses [nb, 3] and give them velocities [nb, 3]."""
        for body, (x, y, angle) in zip(self.bodies, pose.tolist(), strict=True):
            body.position, body.angle = (x, y), angle
        self.space.reindex_static()
        self.body[:, :3], self.body[:, 3:] = pose, velocity
        self.placed[:], self.velocity[:] = pose, velocity

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
        self.shapes[index] = found = []
        for shape in spec.shapes:
            margin = min(MARGIN * _extent(shape), MAX_MARGIN)
            first, last, closed = -1, -1, isinstance(shape, kinds.Polygon)
            if isinstance(shape, kinds.Polygon | kinds.Polyline) and shape.nodes:
                first = sum(map(len, self._spans))
                for nodes in true_curves(shape):
                    self._spans.append(span_table(
                        nodes, centre, sum(map(len, self._spans)), closed=closed))
                last = sum(map(len, self._spans))
            curve = first, last, int(closed and first >= 0), len(self._shape_rows)
            found.append([self._add_shape(body, solid, faces, margin, centre, index, curve)
                          for solid, faces in solids(shape)])
        return body

    def _add_shape(
        self, body: pymunk.Body, spec: kinds.Solid, faces: Array | None, margin: float, centre: Vec,
        index: int, curve: tuple[int, int, int, int],
    ) -> pymunk.Shape:
        shape = make_shape(body, spec, centre, margin)
        filters: Filters = self.filters
        shape.filter = pymunk.ShapeFilter(
            int(filters.group[index]), int(filters.category[index]), int(filters.mask[index]))
        first, last = -1, -1
        if faces is not None:
            first = sum(map(len, self._faces))
            last = first + len(faces)
            self._faces.append(faces)
        vertex, (points, radius) = sum(map(len, self._cores)), core(spec)
        self._cores.append(np.array(points) - centre)
        self._shape_rows.append((int(self.number[index]), margin, first, last, vertex,
                                 vertex + len(points), radius, *curve))
        shape.collision_type = len(self._shape_rows)
        self.space.add(shape)
        return shape


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
    found, count = np.zeros(len(spans.terms), dtype=SPAN), len(spans.terms)
    for name, column in zip(SPAN.names or (), spans.terms.T, strict=False):
        found[name] = column
    number = first + np.arange(count)
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
    kinds, kind = 0, np.zeros(0, dtype=np.int64)  # number of different rows, and of each body's
    if count:
        found, inverse = np.unique(rows, axis=0, return_inverse=True)
        kinds, kind = len(found), np.reshape(inverse, -1).astype(np.int64)
    bits = np.left_shift(np.int64(1), kind) if kinds <= CATEGORIES else np.ones_like(kind)
    mask = np.ones(count, dtype=np.int64)  # beyond that contacts are filtered later
    if kinds <= CATEGORIES:
        mask = np.array(
            [np.bitwise_or.reduce(bits[row], initial=0) for row in rows], dtype=np.int64)
    materials = [mechanism.materials.get(body.material or "", Material())
                 for body in mechanism.bodies]
    roots = np.sqrt([[m.friction, m.static, m.restitution] for m in materials]).reshape(-1, 3).T
    pairs = np.ascontiguousarray(roots[:, :, None] * roots[:, None, :])  # geometric means
    for rule in mechanism.contacts:
        for table, value in zip(pairs, (rule.friction, rule.static), strict=False):
            if value is not None:
                words.fill(table, rule, value)
    friction, static, restitution = pairs
    return Filters(group, bits, mask, allowed, friction, static, restitution,
                   pair_skins(mechanism))


class ShapeTables(NamedTuple):
    """Tables of the constants of the same names (:mod:`sandbox.engine.state`)."""

    shapes: Records
    faces: Records
    vertices: Array
    spans: Records


class Room(NamedTuple):
    """Room for points where shapes are near one another, and for bounded rows, in a step."""

    contacts: int
    rows: int
