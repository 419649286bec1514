"""The World: pymunk's objects under the mechanism's names, built once, read and written in batches."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch

from sandbox.engine import native
from sandbox.engine.contact_rules import Filters, make_filters
from sandbox.scene.bodies import Body, Box, Capsule, Circle, Material, Polygon, Shape
from sandbox.scene.geometry import (
    MassProperties,
    anchors,
    corners,
    joint_angle_sign,
    mass_properties,
    pose_of,
    to_world,
)
from sandbox.scene.joints import Joint, Pin, Rod, Rope, Slot, Weld
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.springs import RotarySpring

Array = NDArray[np.float64]

STATE = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE
    | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
PUSH = batch.BodyFields.FORCE | batch.BodyFields.TORQUE


class World:
    """A pymunk space for one run.

    Bodies stand at their centres of mass and are numbered as pymunk lists
    them: dynamic ones first. ``state`` [nb, 6] (x, y, angle, vx, vy, omega) and
    ``force`` [nb, 3] are the memory that :meth:`read` fills and :meth:`write` sends.
    """

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism = mechanism
        self.h = mechanism.run.step
        self.space = pymunk.Space()
        self.space.gravity = mechanism.gravity
        self.space.iterations = mechanism.run.iterations
        self.space.collision_slop = mechanism.run.slop
        # the share of a penetration that is left after one second; a fifth goes each step
        self.space.collision_bias = max(0.8 ** (1 / self.h), 1e-300)
        self.space.collision_persistence = 1  # an arbiter lives as long as its contact
        self.mass: dict[str, MassProperties] = {
            body.name: mass_properties(body)
            for body in mechanism.bodies if body.motion == "dynamic"
        }
        self.order = sorted(
            range(len(mechanism.bodies)), key=lambda i: mechanism.bodies[i].motion != "dynamic")
        self.number = {mechanism.bodies[i].name: n for n, i in enumerate(self.order)}
        self.bodies: list[pymunk.Body] = []
        self.shapes: dict[str, list[pymunk.Shape]] = {}
        self.filters = make_filters(mechanism)
        for i in self.order:
            self._add_body(mechanism.bodies[i], i)
        self.reactions: list[pymunk.Constraint] = []
        self.stops: dict[int, pymunk.RotaryLimitJoint] = {}
        self._specs = {body.name: body for body in mechanism.bodies}
        for i, joint in enumerate(mechanism.joints):
            self._add_joint(i, joint)
        self._add_rotary_springs()
        self._add_callbacks()
        count = len(self.bodies)
        # pymunk moves a buffer elsewhere when it is filled to the brim: leave it room
        memory = np.zeros(6 * count + 6)
        self.state: Array = memory[: 6 * count].reshape(count, 6)
        self.force: Array = np.zeros((count, 3))
        self.reader = native.Channel(STATE, memory)
        self.writer = native.Channel(PUSH, self.force)
        self.addresses = native.addresses(self.space, self.reader, self.writer)
        self._handles = native.impulse_of([*self.reactions, *self.stops.values()])
        self.read()

    # -- reading, writing, stepping -------------------------------------------------

    def read(self) -> None:
        """Fill ``state`` with all poses and velocities."""
        self.reader.buffer.clear()
        batch.get_space_bodies(self.space, STATE, self.reader.buffer)

    def write(self) -> None:
        """Send ``force`` to all bodies, for the next step."""
        self.writer.buffer.set_float_buf(self.force)
        batch.set_space_bodies(self.space, PUSH, self.writer.buffer)

    def step(self) -> None:
        """One step of pymunk."""
        self.space.step(self.h)

    def impulses(self) -> list[float]:
        """Size of the last step's impulse of every joint, then of every stop [N s, N m s]."""
        return native.impulses(self._handles)

    # -- building -------------------------------------------------------------------

    def _add_body(self, spec: Body, index: int) -> None:
        if spec.motion == "dynamic":
            mass = self.mass[spec.name]
            body = pymunk.Body(mass.mass, mass.inertia)
            body.position = to_world(pose_of(spec), mass.centre)
            centre = mass.centre
        else:
            kind = pymunk.Body.STATIC if spec.motion == "fixed" else pymunk.Body.KINEMATIC
            body = pymunk.Body(body_type=kind)
            body.position = spec.at
            centre = (0.0, 0.0)
        body.angle = spec.angle
        if spec.motion == "dynamic":
            body.velocity = spec.velocity
            body.angular_velocity = spec.angular_velocity
        self.space.add(body)
        self.bodies.append(body)
        material = self.mechanism.materials.get(spec.material or "", Material())
        self.shapes[spec.name] = [
            self._add_shape(body, shape, centre, material, index) for shape in spec.shapes
        ]

    def _add_shape(
        self, body: pymunk.Body, spec: Shape, centre: tuple[float, float], material: Material,
        index: int,
    ) -> pymunk.Shape:
        shape = make_shape(body, spec, centre)
        # pymunk multiplies the two coefficients of a pair; of two roots that is their mean
        shape.friction = math.sqrt(material.friction)
        shape.elasticity = math.sqrt(material.restitution)
        filters: Filters = self.filters
        shape.filter = pymunk.ShapeFilter(
            int(filters.group[index]), int(filters.category[index]), int(filters.mask[index]))
        shape.collision_type = index + 1
        self.space.add(shape)
        return shape

    def _add_joint(self, index: int, joint: Joint) -> None:
        a, b = (self.bodies[self.number[name]] for name in (joint.a, joint.b))
        constraints = make_constraints(
            joint, a, b, self._local, self._specs[joint.a], self._specs[joint.b])
        for constraint in constraints:
            constraint.collide_bodies = joint.collide
            constraint.error_bias = 0.0  # close the whole gap in the next step
            self.space.add(constraint)
        self.reactions.append(constraints[0])
        if isinstance(joint, Pin) and joint.limits is not None:
            stop = constraints[1]
            assert isinstance(stop, pymunk.RotaryLimitJoint)
            self.stops[index] = stop

    def _local(self, body: Body, point: tuple[float, float]) -> tuple[float, float]:
        centre = self.mass[body.name].centre if body.name in self.mass else (0.0, 0.0)
        return point[0] - centre[0], point[1] - centre[1]

    def _add_rotary_springs(self) -> None:
        joints = {joint.name: joint for joint in self.mechanism.joints}
        for spring in self.mechanism.springs:
            if not isinstance(spring, RotarySpring):
                continue
            joint = joints[spring.joint]
            assert isinstance(joint, Pin)  # references are checked when a scene is read
            a, b = (self.bodies[self.number[name]] for name in (joint.a, joint.b))
            # pymunk's rest angle is that of a against b; its own damper is far too strong in a
            # chain of light links, so the damping is added with all other forces instead
            rest = -joint_angle_sign(joint) * (spring.rest_angle + joint.zero)
            constraint = pymunk.DampedRotarySpring(a, b, rest, spring.stiffness, 0.0)
            constraint.collide_bodies = joint.collide
            self.space.add(constraint)

    def _add_callbacks(self) -> None:
        for pair in self.filters.refused:
            self.space.on_collision(pair[0] + 1, pair[1] + 1, begin=_refuse)
        for pair, friction in self.filters.friction.items():
            if self.filters.allowed[pair]:
                self.space.on_collision(pair[0] + 1, pair[1] + 1, pre_solve=_rub(friction))


def make_shape(body: pymunk.Body, spec: Shape, centre: tuple[float, float]) -> pymunk.Shape:
    """pymunk's shape for ``spec``, whose points are moved to a frame at ``centre``."""
    cx, cy = centre
    match spec:
        case Circle():
            return pymunk.Circle(body, spec.radius, (spec.at[0] - cx, spec.at[1] - cy))
        case Capsule():
            (x0, y0), (x1, y1) = spec.start, spec.end
            return pymunk.Segment(body, (x0 - cx, y0 - cy), (x1 - cx, y1 - cy), spec.radius)
        case Box() | Polygon():
            return pymunk.Poly(body, [(x - cx, y - cy) for x, y in corners(spec)])


def make_constraints(
    joint: Joint, a: pymunk.Body, b: pymunk.Body,
    local: Callable[[Body, tuple[float, float]], tuple[float, float]], spec_a: Body, spec_b: Body,
) -> list[pymunk.Constraint]:
    """pymunk's constraints for a joint; the first carries its reaction, a stop comes second."""
    if isinstance(joint, Slot):
        on_b = joint.on_b or (0.0, 0.0)
        made: list[pymunk.Constraint] = [pymunk.GrooveJoint(
            a, b, local(spec_a, joint.start), local(spec_a, joint.end), local(spec_b, on_b))]
        if not joint.turns:
            made.append(pymunk.GearJoint(a, b, b.angle - a.angle, 1.0))
        return made
    points = anchors(joint, spec_a, spec_b)
    on_a, on_b = local(spec_a, points[0]), local(spec_b, points[1])
    match joint:
        case Pin():
            made = [pymunk.PivotJoint(a, b, on_a, on_b)]
            if joint.limits is not None:
                turned = [joint_angle_sign(joint) * (x + joint.zero) for x in joint.limits]
                made.append(pymunk.RotaryLimitJoint(a, b, min(turned), max(turned)))
            return made
        case Weld():
            return [pymunk.PivotJoint(a, b, on_a, on_b),
                    pymunk.GearJoint(a, b, b.angle - a.angle, 1.0)]
        case Rod():
            rod = pymunk.PinJoint(a, b, on_a, on_b)
            if joint.length is not None:
                rod.distance = joint.length
            return [rod]
        case Rope():
            return [pymunk.SlideJoint(a, b, on_a, on_b, joint.shortest, joint.longest)]


def _refuse(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
    arbiter.process_collision = False


def _rub(friction: float) -> Callable[[pymunk.Arbiter, pymunk.Space, Any], None]:
    def set_friction(arbiter: pymunk.Arbiter, space: pymunk.Space, data: Any) -> None:
        arbiter.friction = friction

    return set_friction
