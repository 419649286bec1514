"""The World: pymunk's objects under the mechanism's names, read and written in batches."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import batch

from sandbox.engine import native
from sandbox.engine.contact_rules import Filters, make_filters
from sandbox.scene.elements.bodies import Body, Box, Capsule, Circle, Material, Polygon, Shape
from sandbox.scene.elements.drives import BrakeDrive, MotorDrive, StiffnessDrive
from sandbox.scene.elements.joints import Joint, Pin, Rod, Rope, Slot, Weld
from sandbox.scene.elements.springs import RotarySpring
from sandbox.scene.geometry import (
    MassProperties,
    anchors,
    corners,
    joint_angle_sign,
    mass_properties,
    pose_of,
    to_world,
)
from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]

STATE = (
    batch.BodyFields.POSITION | batch.BodyFields.ANGLE
    | batch.BodyFields.VELOCITY | batch.BodyFields.ANGULAR_VELOCITY
)
PUSH = batch.BodyFields.FORCE | batch.BodyFields.TORQUE
STOP_SLOP = 1e-6
"""How far a hinge may rest beyond its stop [rad]."""
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
    their velocities lead back to, as the clock's leapfrog has it. ``state``
    [nb, 6] (x, y, angle, vx, vy, omega) and ``force`` [nb, 3] are the memory
    that :meth:`read` fills and :meth:`write` sends; ``predicted`` [nb, 3] is the
    pose at which forces were worked out.
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
            range(len(mechanism.bodies)), key=lambda i: _LISTED.index(mechanism.bodies[i].motion))
        self.number = {mechanism.bodies[i].name: n for n, i in enumerate(self.order)}
        self.bodies: list[pymunk.Body] = []
        self.shapes: dict[str, list[pymunk.Shape]] = {}
        self.filters = make_filters(mechanism)
        for i in self.order:
            self._add_body(mechanism.bodies[i], i)
        self.reactions: list[pymunk.Constraint] = []
        self.stops: dict[int, list[pymunk.Constraint]] = {}
        self._specs = {body.name: body for body in mechanism.bodies}
        for i, joint in enumerate(mechanism.joints):
            self._add_joint(i, joint)
        self._add_rotary_springs()
        self.motors: dict[str, pymunk.SimpleMotor] = {}
        self._add_motors()
        self._answers: list[native.Array] = []
        self._add_callbacks()
        count = len(self.bodies)
        # pymunk moves a buffer elsewhere when it is filled to the brim: leave it room
        memory = np.zeros(6 * count + 6)
        self.state: Array = memory[: 6 * count].reshape(count, 6)
        self.force: Array = np.zeros((count, 3))
        self.predicted: Array = np.zeros((count, 3))
        self.reader = native.Channel(STATE, memory)
        self.writer = native.Channel(PUSH, self.force)
        self.addresses = native.addresses(self.space, self.reader, self.writer)
        self.get_impulse, self.handles = native.impulse_calls(
            [*self.reactions, *(half for stop in self.stops.values() for half in stop)])
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

    # -- building -------------------------------------------------------------------

    def _add_body(self, spec: Body, index: int) -> None:
        if spec.motion == "dynamic":
            mass = self.mass[spec.name]
            body = pymunk.Body(mass.mass, mass.inertia)
            centre = mass.centre
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
            centre = (0.0, 0.0)
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
            # close the whole gap in the next step; but a stop or a rope would give back any share
            # of the speed with which it was overrun, as the instant of impact has it
            one_sided = isinstance(constraint, (pymunk.RotaryLimitJoint, pymunk.SlideJoint))
            constraint.error_bias = math.exp(-1 / RECOVERY) if one_sided else 0.0
            self.space.add(constraint)
        self.reactions.append(constraints[0])
        if isinstance(joint, Pin) and joint.limits is not None:
            self.stops[index] = constraints[1:]
            # the first of the two holds what leans on it and leaves it where it is
            constraints[1].error_bias = math.exp(-1e-9 / self.h)

    def _local(self, body: Body, point: tuple[float, float]) -> tuple[float, float]:
        centre = self.mass[body.name].centre if body.name in self.mass else (0.0, 0.0)
        return point[0] - centre[0], point[1] - centre[1]

    def _add_rotary_springs(self) -> None:
        joints = {joint.name: joint for joint in self.mechanism.joints}
        driven = {drive.spring for drive in self.mechanism.drives
                  if isinstance(drive, StiffnessDrive)}  # those are among the forces
        for spring in self.mechanism.springs:
            if not isinstance(spring, RotarySpring) or spring.name in driven:
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

    def _add_motors(self) -> None:
        """What turns or holds a hinge with no more than a torque, by the name of its drive."""
        joints = {joint.name: joint for joint in self.mechanism.joints}
        for drive in self.mechanism.drives:
            if not isinstance(drive, MotorDrive | BrakeDrive):
                continue
            joint = joints[drive.joint]
            a, b = (self.bodies[self.number[name]] for name in (joint.a, joint.b))
            motor = pymunk.SimpleMotor(a, b, 0.0)
            motor.max_force = drive.torque if isinstance(drive, MotorDrive) else 0.0
            motor.collide_bodies = joint.collide
            self.space.add(motor)
            self.motors[drive.name] = motor

    @property
    def motor_impulses(self) -> dict[str, int]:
        """Addresses of the impulses of motors and brakes, by the name of their drive."""
        return {name: native.motor_impulse(motor) for name, motor in self.motors.items()}

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
    joint: Joint, a: pymunk.Body, b: pymunk.Body,
    local: Callable[[Body, tuple[float, float]], tuple[float, float]], spec_a: Body, spec_b: Body,
) -> list[pymunk.Constraint]:
    """The constraints that make a joint; the first carries its reaction, a stop's halves follow.

    Chipmunk lets go of a stop that is overrun by nothing at all, which a stop that is brought back
    to its very limit is every now and then: it would rattle. So one half begins at the limit
    and holds, the other begins ``STOP_SLOP`` later and brings back.
    """
    if isinstance(joint, Slot):
        on_b = joint.on_b or (0.0, 0.0)
        made: list[pymunk.Constraint] = [pymunk.GrooveJoint(
            a, b, local(spec_a, joint.start), local(spec_a, joint.end), local(spec_b, on_b))]
        if not joint.turns:
            made.append(pymunk.GearJoint(a, b, spec_b.angle - spec_a.angle, 1.0))
        return made
    points = anchors(joint, spec_a, spec_b)
    on_a, on_b = local(spec_a, points[0]), local(spec_b, points[1])
    match joint:
        case Pin():
            made = [pymunk.PivotJoint(a, b, on_a, on_b)]
            if joint.limits is not None:
                turned = [joint_angle_sign(joint) * (x + joint.zero) for x in joint.limits]
                made += [pymunk.RotaryLimitJoint(a, b, min(turned) - slop, max(turned) + slop)
                         for slop in (0.0, STOP_SLOP)]
            return made
        case Weld():
            return [pymunk.PivotJoint(a, b, on_a, on_b),
                    pymunk.GearJoint(a, b, spec_b.angle - spec_a.angle, 1.0)]
        case Rod():
            rod = pymunk.PinJoint(a, b, on_a, on_b)
            ends = to_world(pose_of(spec_a), points[0]), to_world(pose_of(spec_b), points[1])
            rod.distance = math.dist(*ends) if joint.length is None else joint.length
            return [rod]
        case Rope():
            return [pymunk.SlideJoint(a, b, on_a, on_b, joint.shortest, joint.longest)]
