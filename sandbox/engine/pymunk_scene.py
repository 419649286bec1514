"""A mechanism in plain pymunk: a space whose objects have names, and forces set before each step.

SI units. A script of ``sandbox export SCENE --to pymunk`` contains what it needs of this file.
"""

from __future__ import annotations

import cmath
import itertools
import math
from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any

import pymunk
from pymunk import Body, Vec2d

Point = tuple[float, float]
Value = float | Callable[[float], float]  # a number, or a function of the time [s]


def ramp(start: float, over: float, first: float, last: float) -> Value:
    """A value that goes from ``first`` to ``last``, from the time ``start`` on."""
    return lambda t: first + (last - first) * min(max((t - start) / max(over, 1e-12), 0.0), 1.0)


def table(times: Sequence[float], values: Sequence[float], *, linear: bool = True) -> Value:
    """A value that passes points on straight lines, or keeps each up to the next time."""
    def value(t: float) -> float:
        i = bisect_right(times, t)
        a, b = max(i - 1, 0), min(i, len(times) - 1)
        if a == b or not linear or i == 0:
            return values[a]
        return values[a] + (values[b] - values[a]) * (t - times[a]) / (times[b] - times[a])
    return value


class Scene:
    """A pymunk space with named bodies, shapes, constraints and tendons.

    pymunk moves bodies first and then computes their velocities. So poses and forces after n steps
    belong to the time (n - 1/2) h, velocities to n h, and bodies start half a step earlier.
    """

    def __init__(self, step: float, iterations: int, gravity: Point = (0.0, 0.0)) -> None:
        self.h, self.steps, self.space = step, 0, pymunk.Space()
        self.space.iterations, self.space.gravity = iterations, gravity
        self.bias = max(math.exp(-0.1 / step), 1e-300)  # errors fade in 10 steps
        self.space.collision_slop, self.space.collision_bias = 1e-5, self.bias
        self.bodies: dict[str, Body] = {}
        self.shapes: dict[str, list[pymunk.Shape]] = {}  # by body
        self.constraints: dict[str, pymunk.Constraint] = {}
        self.tendons: dict[str, Tendon] = {}
        self.drives: dict[str, float] = {}  # current values
        self.before: list[Callable[[float], None]] = []  # called before each step with its time

    def step(self) -> None:
        """Make one step."""
        for act in self.before:
            act((self.steps + 0.5) * self.h)
        for tendon in self.tendons.values():
            tendon.act()
        self.space.step(self.h)
        self.steps += 1

    def body(
        self, name: str, position: Point, angle: float, *shapes: tuple[Any, ...],
        mass: float = 0.0, moment: float = 0.0, centre: Point = (0.0, 0.0),
        velocity: Point = (0.0, 0.0), spin: float = 0.0, moves: bool = False,
        friction: float = 0.0, elasticity: float = 0.0, collides: Sequence[int] = (),
    ) -> None:
        """Add a body with shapes of pymunk's classes; without mass it is static, or kinematic."""
        kind = Body.DYNAMIC if mass else Body.KINEMATIC if moves else Body.STATIC
        body = self.bodies[name] = Body(mass, moment, kind)
        body.center_of_gravity, body.angle = centre, angle - spin * self.h / 2
        body.position = (Vec2d(*position) + Vec2d(*centre).rotated(angle)
                         - Vec2d(*velocity) * (self.h / 2) - Vec2d(*centre).rotated(body.angle))
        body.velocity, body.angular_velocity = velocity, spin
        self.shapes[name] = [getattr(pymunk, kind)(body, *outline) for kind, *outline in shapes]
        self.space.add(body, *self.shapes[name])
        for shape in self.shapes[name]:
            shape.friction, shape.elasticity = friction, elasticity
            shape.filter = pymunk.ShapeFilter(*collides)

    def pair_friction(self, one: str, other: str, friction: float) -> None:
        """Set the friction of two bodies, by default the product of that of their shapes."""
        a, b = (1 + list(self.bodies).index(name) for name in (one, other))
        for number, name in ((a, one), (b, other)):
            for shape in self.shapes[name]:
                shape.collision_type = number
        self.space.on_collision(a, b, pre_solve=lambda arbiter, _space, _data: setattr(
            arbiter, "friction", friction))

    def constraint(
        self, name: str, kind: str, a: str, b: str, *arguments: Any, **settings: Any,
    ) -> None:
        """Add a constraint of a pymunk class; ``settings`` are its attributes."""
        made = getattr(pymunk, kind)(self.bodies[a], self.bodies[b], *arguments)
        made.error_bias = self.bias
        for key, value in settings.items():
            setattr(made, key, value)
        self.constraints[name] = made
        self.space.add(made)

    def tendon(self, name: str, *guides: tuple[str, Point, float], **law: Any) -> None:
        """Add a tendon over guides: body, point, and wheel radius or 0."""
        path = [(self.bodies[body], at, radius) for body, at, radius in guides]
        self.tendons[name] = Tendon(path, self.h, **law)

    def drive(
        self, name: str, value: Value, act: Callable[[float], None] = lambda _: None, *,
        floor: float = -math.inf, later: float = 0.0,
    ) -> None:
        """Add a drive, whose value ``act`` gets before each step, that of so many steps later."""
        def before(t: float) -> None:
            now = value(t + later * self.h) if callable(value) else value
            self.drives[name] = max(now, floor)
            act(self.drives[name])
        self.before.append(before)

    def set(
        self, name: str, value: Value, owner: str, key: str, factor: float = 1.0, **more: Any,
    ) -> None:
        """Add a drive that sets an attribute of a constraint or tendon to ``factor`` * value."""
        made = self.constraints.get(owner) or self.tendons[owner]
        self.drive(name, value, lambda now: setattr(made, key, factor * now), **more)

    def push_point(
        self, name: str, value: Value, body: str, at: Point, way: Point, *, turns: bool = False,
    ) -> None:
        """Add a force on a point of a body; its direction may turn with the body."""
        one, along = self.bodies[body], Vec2d(*way)
        self.drive(name, value, lambda now: one.apply_force_at_world_point(
            now * (along.rotated(one.angle) if turns else along), one.local_to_world(at)))

    def twist(self, name: str, value: Value, a: str, b: str, factor: float = 1.0) -> None:
        """Add a torque of ``factor`` * value on ``b``, and the opposite on ``a``."""
        one, other = self.bodies[a], self.bodies[b]

        def act(now: float) -> None:
            one.torque -= factor * now
            other.torque += factor * now
        self.drive(name, value, act)

    def damper(self, name: str, a: str, b: str, damping: float) -> None:
        """Add a torque against the relative rotation of two bodies.

        A DampedRotarySpring takes bodies without their joints, which lets it damp a chain of
        bodies too much, by its iterations. So this is a SimpleMotor that holds still, with no more
        torque than the damper has at the rate before the step.
        """
        self.constraint(name, "SimpleMotor", a, b, 0.0)
        motor, one, other = self.constraints[name], self.bodies[a], self.bodies[b]
        self.before.append(lambda _: setattr(motor, "max_force", damping * abs(
            other.angular_velocity - one.angular_velocity)))

    def push_apart(self, name: str, value: Value, a: str, at_a: Point, b: str, at_b: Point) -> None:
        """Add a force that pushes two points apart."""
        one, other = self.bodies[a], self.bodies[b]

        def act(now: float) -> None:
            p, q = one.local_to_world(at_a), other.local_to_world(at_b)
            other.apply_force_at_world_point(now * (q - p).normalized(), q)
            one.apply_force_at_world_point(now * (p - q).normalized(), p)
        self.drive(name, value, act)

    def extend(self, name: str, value: Value, rod: str, **more: Any) -> None:
        """Add a drive that sets the speed of extension of a PinJoint."""
        made: Any = self.constraints[rod]
        a, b, at_a, at_b = made.a, made.b, made.anchor_a, made.anchor_b

        def act(now: float) -> None:
            way = b.local_to_world(at_b) - a.local_to_world(at_a)
            rate = way.normalized().dot(
                b.velocity_at_local_point(at_b) - a.velocity_at_local_point(at_a))
            made.distance = way.length + self.h * (rate + now)
        self.drive(name, value, act, **more)

    def servo(
        self, name: str, value: Value, motor: str, sense: float, zero: float, fastest: float,
    ) -> None:
        """Add a drive that turns a SimpleMotor towards an angle."""
        made: Any = self.constraints[motor]

        def act(now: float) -> None:
            missing = now - sense * (made.b.angle - made.a.angle) + zero
            made.rate = -sense * min(max(missing / (10 * self.h), -fastest), fastest)
        self.drive(name, value, act)

    def resize(self, name: str, value: Value, body: str, shape: int, **more: Any) -> None:
        """Add a drive that sets the radius of a circle."""
        circle: Any = self.shapes[body][shape]

        def act(now: float) -> None:
            circle.unsafe_set_radius(now)
            self.space.reindex_shape(circle)
        self.drive(name, value, act, **more)

    def move(self, body: str, **over_time: Value) -> None:
        """Move a kinematic body along ``x``, ``y`` and ``angle`` over time."""
        moved = self.bodies[body]
        start = {"x": moved.position.x, "y": moved.position.y, "angle": moved.angle}

        def act(t: float) -> None:
            x, y, angle = (value(t) if callable(value) else value
                           for value in (start | over_time).values())
            moved.velocity = (Vec2d(x, y) - moved.position) / self.h
            moved.angular_velocity = (angle - moved.angle) / self.h
        self.before.append(act)

    def contacts(self) -> dict[tuple[str, str], Vec2d]:
        """The force [N] on the first by the second body, for all pairs in the last step."""
        names = {body: name for name, body in self.bodies.items()}
        found: dict[tuple[str, str], Vec2d] = {}

        def note(arbiter: pymunk.Arbiter) -> None:
            one, other = (names[body] for body in arbiter.bodies)
            force = arbiter.total_impulse / self.h
            found[one, other] = found.get((one, other), Vec2d(0.0, 0.0)) + force
        for body in self.bodies.values():
            if body.body_type == Body.DYNAMIC:
                body.each_arbiter(note)
        return found


class Tendon:
    """A tendon over guides, as forces that are set before each step.

    A joint of pymunk has two bodies, so none holds a length along several guides. A drive may set
    the tension T as ``pulled``. Otherwise T = max(k s + c r, 0) for the stretch s and its rate r at
    the end of the step: with s1 after the motion of the step, r0 before T acts, and the inverse
    mass w of the bodies without their joints, T = (k s1 + (c + h k) r0) / (1 + 2 h w (c + h k)).
    The factor 2 keeps tendons stable that share a body; ``excess`` takes back, in some 100 steps,
    the stretch that the divisor adds. A radius is positive for a wheel right of the path; wheels at
    the ends wind the tendon up. Points and vectors are complex numbers.
    """

    def __init__(
        self, guides: Sequence[tuple[Body, Point, float]], h: float, *, stiffness: float = 0.0,
        damping: float = 0.0, rest: float | None = None, slack: float = 0.0,
    ) -> None:
        self.guides = [(body, complex(*at), radius) for body, at, radius in guides]
        self.h, self.stiffness, self.damping, self.tension = h, stiffness, damping, 0.0
        self.pulled: float | None = None
        self.normals: list[float] = []  # angles of the left normals of spans
        self.wound = self.excess = 0.0
        self.measure()
        (a, _, ra), (b, _, rb) = guides[0], guides[-1]
        self.wound = ra * (a.angle - self.normals[0]) + rb * (self.normals[-1] - b.angle)
        self.rest = (self.measure()[0] if rest is None else rest) + slack

    def measure(self) -> tuple[float, dict[Body, tuple[complex, float]]]:
        """Length [m]; force and moment about its centre of mass on each body per tension."""
        self.length, normals = -self.wound, list[float]()
        loads: dict[Body, tuple[complex, float]] = {}
        points = [(body, complex(*body.local_to_world((at.real, at.imag))), radius,
                   complex(*body.local_to_world(body.center_of_gravity)))
                  for body, at, radius in self.guides]
        for (a, start, ra, centre_a), (b, end, rb, centre_b) in itertools.pairwise(points):
            way, offset = end - start, ra - rb
            straight = math.sqrt(max(abs(way)**2 - offset**2, 0.0))
            normal = (offset + 1j * straight) * way / abs(way)**2
            for body, arm, force in ((a, start + ra * normal - centre_a, -1j * normal),
                                     (b, end + rb * normal - centre_b, 1j * normal)):
                total, moment = loads.get(body, (0j, 0.0))
                loads[body] = total + force, moment + (arm.conjugate() * force).imag
            self.length += straight
            normals.append(cmath.phase(normal))
            if len(self.normals) < len(normals):  # at first an arc goes once round its wheel
                before, side = (self.normals or normals)[-1], math.copysign(1.0, ra)
                arc = (side * (before - normals[-1]) + 1e-9) % (2 * math.pi) - 1e-9
                self.normals.append(before - side * arc)
        self.normals = [old + math.remainder(new - old, 2 * math.pi)
                        for old, new in zip(self.normals, normals, strict=True)]
        turns = [self.guides[0][0].angle, *self.normals, self.guides[-1][0].angle]
        self.length += sum(radius * (turns[i] - turns[i + 1])
                           for i, (_, _, radius) in enumerate(self.guides))
        return self.length, loads

    def act(self) -> None:
        """Let the tension act in the next step."""
        _, loads = self.measure()
        h, k, c, self.tension = self.h, self.stiffness, self.damping, self.pulled or 0.0
        if self.pulled is None:
            rate = -sum(force.real * body.velocity.x + force.imag * body.velocity.y
                        + moment * body.angular_velocity
                        for body, (force, moment) in loads.items())
            mobility = sum(abs(force)**2 / body.mass + moment**2 / body.moment
                           for body, (force, moment) in loads.items()
                           if body.body_type == Body.DYNAMIC)
            stretch = self.length - self.rest + h * rate
            pull = k * (stretch + self.excess) + (c + h * k) * rate
            self.tension = max(pull / (1 + 2 * h * mobility * (c + h * k)), 0.0)
            self.excess = max(self.excess + 0.01 * (stretch - self.tension / k), 0.0)
        for body, (force, moment) in loads.items():
            body.force += self.tension * Vec2d(force.real, force.imag)
            body.torque += self.tension * moment
