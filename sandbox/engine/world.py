"""The World: pymunk's objects under the mechanism's names, read and written in batches."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pymunk
from pymunk import batch

from sandbox.engine import native
from sandbox.engine.contact_rules import Filters, make_filters
from sandbox.kinds.elements import STOP_SLOP
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.scene.elements.bodies import Body, Box, Capsule, Circle, Material, Polygon, Shape
from sandbox.scene.geometry import Vec, corners, pose_of, to_world

STATE = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE
    | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
PUSH = batch.BodyFields.FORCE | batch.BodyFields.TORQUE
RECOVERY = 0.005
"""Time [s] in which stops and ropes bring back what overran them, but for a share 1/e.

An overrun of omega h is then thrown back at omega h / RECOVERY, which falls with h; a share of
it each step would throw back the same share of omega at every h. A choice, not a
derivation: longer throws back less and takes longer to settle (20 and 10 ms were tried).
"""
_LISTED = ("dynamic", "scheduled", "fixed")


class World:
    """A pymunk space for one run.

    Bodies stand at their centres of mass and are numbered as pymunk lists
    them: dynamic, scheduled, fixed. They start half a step before t = 0, where
    their velocities lead back to, as the clock's leapfrog has it. ``body``
    [nb, 6] (x, y, angle, vx, vy, omega) and ``force`` [nb, 3] are the memory
    that :meth:`read` fills and :meth:`write` sends.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        run = model.mechanism.run
        self.h = run.step
        self.space = pymunk.Space()
        self.space.gravity = model.mechanism.gravity
        self.space.iterations = run.iterations
        self.space.collision_slop = run.slop
        # the share of a penetration that is left after one second; a fifth goes each step
        self.space.collision_bias = max(0.8 ** (1 / self.h), 1e-300)
        self.space.collision_persistence = 1  # an arbiter lives as long as its contact
        motions = [_LISTED.index(body.motion) for body in model.mechanism.bodies]
        self.order: Integers = np.argsort(motions, kind="stable").astype(np.int64)
        """The model's numbers of the bodies in pymunk's order, [nb]."""
        self.number = np.empty_like(self.order)
        """Pymunk's numbers of the bodies in the model's order, [nb]."""
        self.number[self.order] = np.arange(len(self.order))
        self.filters = make_filters(model)
        self.shapes: dict[int, list[pymunk.Shape]] = {}
        """Of each body, by the model's number."""
        self.bodies = [self._add_body(i) for i in self.order.tolist()]
        """In pymunk's order."""
        self.reactions: list[pymunk.Constraint] = []
        self.stops: dict[int, list[pymunk.Constraint]] = {}
        for i in range(len(model.joints.name)):
            self._add_joint(i)
        self._add_rotary_springs()
        self.motors = {i: self._add_motor(i) for i, kind in enumerate(model.drives.kind)
                       if kind.limited}
        """By the drive's number."""
        self._answers: list[Array] = []
        self._add_callbacks()
        count = len(self.bodies)
        # pymunk moves a buffer elsewhere when it is filled to the brim: leave it room
        memory = np.zeros(6 * count + 6)
        self.body: Array = memory[: 6 * count].reshape(count, 6)
        self.force: Array = np.zeros((count, 3))
        self.reader = native.Channel(STATE, memory)
        self.writer = native.Channel(PUSH, self.force)
        self.native = native.make_native(
            self.space, self.reader, self.writer,
            [*self.reactions, *(half for stop in self.stops.values() for half in stop)])
        self.read()

    # -- reading, writing, stepping -------------------------------------------------

    def read(self) -> None:
        """Fill ``body`` with all poses and velocities."""
        self.reader.buffer.clear()
        batch.get_space_bodies(self.space, STATE, self.reader.buffer)

    def write(self) -> None:
        """Send ``force`` to all bodies, for the next step."""
        self.writer.buffer.set_float_buf(self.force)
        batch.set_space_bodies(self.space, PUSH, self.writer.buffer)

    def step(self) -> None:
        """One step of pymunk."""
        self.space.step(self.h)

    # -- building -------------------------------------------------------------------

    def _pair(self, joint: int) -> tuple[pymunk.Body, pymunk.Body]:
        a, b = self.number[self.model.joints.bodies[joint]]
        return self.bodies[a], self.bodies[b]

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
            body.angle = spec.angle
        self.space.add(body)
        self.shapes[index] = self._add_shapes(body, spec, centre, index)
        return body

    def _add_shapes(
        self, body: pymunk.Body, spec: Body, centre: Vec, index: int,
    ) -> list[pymunk.Shape]:
        material = self.model.mechanism.materials.get(spec.material or "", Material())
        return [self._add_shape(body, shape, centre, material, index) for shape in spec.shapes]

    def _add_shape(
        self, body: pymunk.Body, spec: Shape, centre: Vec, material: Material, index: int,
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

    def _add_joint(self, index: int) -> None:
        joints = self.model.joints
        constraints = make_constraints(self.model, index, *self._pair(index))
        for constraint in constraints:
            constraint.collide_bodies = bool(joints.collide[index])
            # close the whole gap in the next step; but a stop or a rope would give back any share
            # of the speed with which it was overrun, as the instant of impact has it
            one_sided = isinstance(constraint, (pymunk.RotaryLimitJoint, pymunk.SlideJoint))
            constraint.error_bias = math.exp(-1 / RECOVERY) if one_sided else 0.0
            self.space.add(constraint)
        self.reactions.append(constraints[0])
        if np.isfinite(joints.stops[index]).all():
            self.stops[index] = constraints[1:]
            # the first of the two holds what leans on it and leaves it where it is
            constraints[1].error_bias = math.exp(-1e-9 / self.h)

    def _add_rotary_springs(self) -> None:
        """All whose stiffness stays as it is; the others are among the forces."""
        springs, joints = self.model.springs, self.model.joints
        for i in np.flatnonzero(~springs.straight & (springs.drive < 0)).tolist():
            joint = springs.joint[i]
            # pymunk's rest angle is that of a against b; its own damper is far too strong in a
            # chain of light links, so the damping is added with all other forces instead
            rest = -joints.sense[joint] * (springs.rest[i] + joints.zero[joint])
            constraint = pymunk.DampedRotarySpring(
                *self._pair(joint), rest.item(), springs.stiffness[i].item(), 0.0)
            constraint.collide_bodies = bool(joints.collide[joint])
            self.space.add(constraint)

    def _add_motor(self, drive: int) -> pymunk.SimpleMotor:
        """What turns or holds a hinge with no more than a torque."""
        drives = self.model.drives
        joint = drives.target[drive]
        motor = pymunk.SimpleMotor(*self._pair(joint), 0.0)
        motor.max_force = 0.0 if np.isnan(drives.most[drive]) else drives.most[drive].item()
        motor.collide_bodies = bool(self.model.joints.collide[joint])
        self.space.add(motor)
        return motor

    @property
    def motor_impulses(self) -> dict[int, int]:
        """Addresses of the impulses of motors and brakes, by the number of their drive."""
        return {drive: native.motor_impulse(motor) for drive, motor in self.motors.items()}

    def _add_callbacks(self) -> None:
        for a, b in sorted(self.filters.refused):
            self._answers.append(native.refuse(self.space, a + 1, b + 1))
        for (a, b), friction in self.filters.friction.items():
            if self.filters.allowed[a, b]:
                self._answers.append(native.rub(self.space, a + 1, b + 1, friction))


def make_shape(body: pymunk.Body, spec: Shape, centre: tuple[float, float]) -> pymunk.Shape:
    """The shape that ``spec`` means, its points moved to a frame at ``centre``."""
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
    model: Model, joint: int, a: pymunk.Body, b: pymunk.Body,
) -> list[pymunk.Constraint]:
    """The constraints that make a joint; the first carries its reaction, a stop's halves follow.

    Chipmunk lets go of a stop that is overrun by nothing at all, which a stop that is brought back
    to its very limit is every now and then: it would rattle. So one half begins at the limit
    and holds, the other begins ``STOP_SLOP`` later and brings back.
    """
    joints = model.joints
    made = [CONSTRAINTS[joints.kind[joint].keeps](model, joint, a, b)]
    if np.isfinite(joints.stops[joint]).all():
        turned = (joints.sense[joint] * (joints.stops[joint] + joints.zero[joint])).tolist()
        made += [pymunk.RotaryLimitJoint(a, b, min(turned) - slop, max(turned) + slop)
                 for slop in (0.0, STOP_SLOP)]
    if not joints.turns[joint]:
        first, second = model.bodies.pose[joints.bodies[joint], 2]
        made.append(pymunk.GearJoint(a, b, (second - first).item(), 1.0))
    return made


def _ends(model: Model, joint: int) -> tuple[Vec, Vec]:
    """The points that a joint holds, seen from the centres of mass of its bodies [m]."""
    joints = model.joints
    on_a, on_b = joints.anchor[joint] - model.bodies.centre[joints.bodies[joint]]
    return (on_a[0].item(), on_a[1].item()), (on_b[0].item(), on_b[1].item())


def _point(model: Model, joint: int, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.PivotJoint(a, b, *_ends(model, joint))


def _groove(model: Model, joint: int, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    joints = model.joints
    centre = model.bodies.centre[joints.bodies[joint, 0]]
    start, end = (tuple((point - centre).tolist()) for point in joints.groove[joint])
    return pymunk.GrooveJoint(a, b, start, end, _ends(model, joint)[1])


def _distance(model: Model, joint: int, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    rod = pymunk.PinJoint(a, b, *_ends(model, joint))
    rod.distance = model.joints.reach[joint, 0].item()
    return rod


def _range(model: Model, joint: int, a: pymunk.Body, b: pymunk.Body) -> pymunk.Constraint:
    return pymunk.SlideJoint(a, b, *_ends(model, joint), *model.joints.reach[joint].tolist())


CONSTRAINTS: Mapping[
    str, Callable[[Model, int, pymunk.Body, pymunk.Body], pymunk.Constraint],
] = {"point": _point, "groove": _groove, "distance": _distance, "range": _range}
"""How pymunk keeps what joints keep (:attr:`sandbox.kinds.elements.JointKind.keeps`)."""
