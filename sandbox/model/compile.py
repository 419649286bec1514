"""From a mechanism to its :class:`sandbox.model.model.Model`: names become numbers, here only."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np

from sandbox.elements.drives import (
    BrakeDrive,
    Drive,
    ExtendDrive,
    FlowDrive,
    ForceDrive,
    HoldDrive,
    LengthDrive,
    MotorDrive,
    OpeningDrive,
    PressureDrive,
    PullDrive,
    PushDrive,
    RadiusDrive,
    ServoDrive,
    StiffnessDrive,
    SurfaceDrive,
    TorqueDrive,
    kind_of,
)
from sandbox.elements.joints import (
    Actuator,
    Gear,
    Joint,
    Pin,
    Rack,
    Rod,
    Roll,
    Rope,
    Slot,
    Weld,
)
from sandbox.elements.kinds import JOINTS, SPRINGS
from sandbox.elements.springs import LinearSpring, RotarySpring, Spring
from sandbox.model.fluids import compile_lines, compile_valves
from sandbox.model.loads import compile_loads
from sandbox.model.model import (
    NONE,
    Bodies,
    Drives,
    Joints,
    Model,
    Names,
    Springs,
    Tendons,
)
from sandbox.model.spring_laws import SpringLaw, law_of
from sandbox.model.ties import compile_ties
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import (
    Vec,
    anchors,
    joint_angle_sign,
    mass_properties,
    pose_of,
    to_body,
    to_world,
)
from sandbox.scene.mechanism import Mechanism

Pair = tuple[float, float]
NAN = math.nan
NO_POINT: Vec = (NAN, NAN)


class _HasName(Protocol):
    @property
    def name(self) -> str: ...


def compile_mechanism(mechanism: Mechanism) -> Model:
    """The model of a mechanism whose references are right.

    Raises:
        KeyError: a name that leads nowhere.
    """
    names = Names(*(_numbers(kind) for kind in (
        mechanism.bodies, mechanism.joints, mechanism.springs, mechanism.tendons,
        mechanism.lines, mechanism.valves, mechanism.drives)))
    joints, drives = _joints(mechanism, names), _drives(mechanism, names)
    bodies = _bodies(mechanism)
    parts = (bodies, joints, _springs(mechanism, names, joints),
             _tendons(mechanism, names), compile_lines(mechanism, names, joints, drives),
             compile_valves(mechanism, names, drives), compile_loads(mechanism, bodies), drives,
             compile_ties(mechanism))
    for part in parts:
        for field in fields(part):
            if isinstance(array := getattr(part, field.name), np.ndarray):
                array.setflags(write=False)
    return Model(mechanism, names, *parts)


def _numbers(elements: Sequence[_HasName]) -> dict[str, int]:
    return {element.name: i for i, element in enumerate(elements)}


def _names(elements: Sequence[_HasName]) -> tuple[str, ...]:
    return tuple(element.name for element in elements)


def _floats(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.float64).reshape(-1, *shape)


def _ints(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.int64).reshape(-1, *shape)


def _flags(rows: Iterable[bool]) -> Any:
    return np.array(list(rows), dtype=np.bool_)


def _bodies(mechanism: Mechanism) -> Bodies:
    bodies = mechanism.bodies
    weights = [mass_properties(body) if body.motion == "dynamic" else None for body in bodies]
    return Bodies(
        name=_names(bodies),
        free=_flags(body.motion == "dynamic" for body in bodies),
        fixed=_flags(body.motion == "fixed" for body in bodies),
        pose=_floats((pose_of(body) for body in bodies), 3),
        centre=_floats((w.centre if w else (0.0, 0.0) for w in weights), 2),
        mass=_floats(w.mass if w else math.inf for w in weights),
        inertia=_floats(w.inertia if w else math.inf for w in weights))


@dataclass(frozen=True)
class _JointFacts:
    """What a spec of a joint says; the defaults stand for what its kind does not have."""

    turns: bool = True
    sense: float = NAN
    zero: float = NAN
    stops: Pair = NO_POINT
    damping: float = 0.0
    groove: tuple[Vec, Vec] = (NO_POINT, NO_POINT)
    reach: Pair = NO_POINT
    radii: Pair = NO_POINT
    inside: bool = False
    pressure: float = NAN
    play: float = 0.0
    stiffness: float = NAN
    along: Vec = NO_POINT
    friction: float = 0.0
    rubbing: float = 0.0
    static: float = 1.0


def _joint(joint: Joint, distance: float) -> _JointFacts:
    """A joint whose two points are ``distance`` apart at t = 0."""
    match joint:
        case Pin():
            return _JointFacts(sense=joint_angle_sign(joint), zero=joint.zero,
                          stops=joint.limits or NO_POINT, damping=joint.damping,
                          friction=joint.friction, static=joint.static,
                          rubbing=joint.friction_coefficient * (joint.pin_radius or 0.0))
        case Slot():
            return _JointFacts(turns=joint.turns, groove=(joint.start, joint.end),
                               friction=joint.friction, static=joint.static,
                               rubbing=joint.friction_coefficient)
        case Weld():
            return _JointFacts(turns=False)
        case Rod():
            length = distance if joint.length is None else joint.length
            return _JointFacts(reach=(length, length))
        case Rope():
            return _JointFacts(reach=(joint.shortest, joint.longest))
        case Actuator():
            return _JointFacts(reach=(joint.shortest, joint.longest or math.inf))
        case Gear():
            return _JointFacts(radii=(joint.radius_a, joint.radius_b), inside=joint.inside,
                               pressure=joint.pressure_angle, play=joint.backlash,
                               stiffness=joint.stiffness)
        case Rack():
            return _JointFacts(radii=(joint.radius, NAN), pressure=joint.pressure_angle,
                               play=joint.backlash, stiffness=joint.stiffness,
                               along=joint.along)
        case Roll():
            return _JointFacts(radii=(joint.radius_a, joint.radius_b), inside=joint.inside)


def _joints(mechanism: Mechanism, names: Names) -> Joints:
    joints = mechanism.joints
    numbers = [(names.body[joint.a], names.body[joint.b]) for joint in joints]
    ends = [(mechanism.bodies[a], mechanism.bodies[b]) for a, b in numbers]
    held = [anchors(joint, *pair) for joint, pair in zip(joints, ends, strict=True)]
    rows = [_joint(joint, _apart(pair, points))
            for joint, pair, points in zip(joints, ends, held, strict=True)]
    sense, zero = _floats(row.sense for row in rows), _floats(row.zero for row in rows)
    return Joints(
        name=_names(joints), kind=tuple(JOINTS[joint.type] for joint in joints),
        bodies=_ints(numbers, 2), anchor=_floats(held, 2, 2),
        turns=_flags(row.turns for row in rows),
        angle=_flags(JOINTS[joint.type].angle for joint in joints), sense=sense, zero=zero,
        stops=_floats((row.stops for row in rows), 2),
        damping=_floats(row.damping for row in rows),
        start=sense * _floats(b.angle - a.angle for a, b in ends) - zero,
        groove=_floats((row.groove for row in rows), 2, 2),
        reach=_floats((row.reach for row in rows), 2),
        radii=_floats((row.radii for row in rows), 2),
        inside=_flags(row.inside for row in rows),
        pressure=_floats(row.pressure for row in rows),
        play=_floats(row.play for row in rows),
        stiffness=_floats(row.stiffness for row in rows),
        along=_floats((_pitch_line(row.along, *pair, *points)
                       for row, pair, points in zip(rows, ends, held, strict=True)), 2),
        friction=_floats(row.friction for row in rows),
        rubbing=_floats(row.rubbing for row in rows),
        static=_floats(row.static for row in rows),
        collide=_flags(joint.collide for joint in joints))


def _pitch_line(along: Vec, a: Body, b: Body, on_a: Vec, on_b: Vec) -> Vec:
    """A rack's direction in its frame, of length 1, so that its gear lies to the left."""
    (x, y), centre = along, to_body(pose_of(b), to_world(pose_of(a), on_a))
    left = x * (centre[1] - on_b[1]) - y * (centre[0] - on_b[0])
    length = math.copysign(math.hypot(x, y), left)
    return x / length, y / length


def _apart(bodies: tuple[Body, Body], points: tuple[Vec, Vec]) -> float:
    """Distance at t = 0 [m] of points of two bodies."""
    return math.dist(*(to_world(pose_of(body), point)
                       for body, point in zip(bodies, points, strict=True)))


@dataclass(frozen=True)
class _Spring:
    bodies: tuple[int, int]
    start: float
    rest: float
    anchor: tuple[Vec, Vec] = (NO_POINT, NO_POINT)
    joint: int = NONE


def _spring(spring: Spring, mechanism: Mechanism, names: Names, joints: Joints) -> _Spring:
    match spring:
        case LinearSpring():
            numbers = names.body[spring.a], names.body[spring.b]
            a, b = (mechanism.bodies[number] for number in numbers)
            p, q = to_world(pose_of(a), spring.on_a), to_world(pose_of(b), spring.on_b)
            start = float(np.hypot(q[0] - p[0], q[1] - p[1]))
            rest = start if spring.rest_length is None else spring.rest_length
            return _Spring(numbers, start, rest, (spring.on_a, spring.on_b))
        case RotarySpring():
            joint = names.joint[spring.joint]
            a_number, b_number = joints.bodies[joint].tolist()
            return _Spring((a_number, b_number), float(joints.start[joint]), spring.rest_angle,
                           joint=joint)


def _springs(mechanism: Mechanism, names: Names, joints: Joints) -> Springs:
    springs = mechanism.springs
    rows = [_spring(spring, mechanism, names, joints) for spring in springs]
    setters = {drive.spring: i for i, drive in enumerate(mechanism.drives)
               if isinstance(drive, StiffnessDrive)}
    kinds = tuple(SPRINGS[spring.type] for spring in springs)
    laws = tuple(law_of(spring, tuple(mechanism.tables), mechanism.functions)
                 for spring in springs)
    return Springs(
        name=_names(springs), kind=kinds, straight=_flags(kind.straight for kind in kinds),
        bodies=_ints((row.bodies for row in rows), 2),
        anchor=_floats((row.anchor for row in rows), 2, 2),
        joint=_ints(row.joint for row in rows),
        stiffness=_floats(_slope(law, row) if spring.stiffness is None else spring.stiffness
                          for spring, law, row in zip(springs, laws, rows, strict=True)),
        damping=_floats(0.0 if law else spring.damping
                        for spring, law in zip(springs, laws, strict=True)),
        rest=_floats(row.rest for row in rows), start=_floats(row.start for row in rows),
        drive=_ints(setters.get(spring.name, NONE) for spring in springs), law=laws)


def _slope(law: SpringLaw | None, row: _Spring) -> float:
    """How stiff a spring with a law is at t = 0."""
    assert law is not None  # what has no stiffness has one
    stretch, near = row.start - row.rest, 1e-6 * max(abs(row.start), abs(row.rest), 1e-3)
    slope = float(law.slopes(np.array([stretch - near, stretch + near]))[0])
    return max(slope, 0.0) if math.isfinite(slope) else 0.0


def _tendons(mechanism: Mechanism, names: Names) -> Tendons:
    tendons = mechanism.tendons
    guides = [guide for tendon in tendons for guide in tendon.path]
    first = np.cumsum([0, *(len(tendon.path) for tendon in tendons)], dtype=np.int64)
    pulls = {drive.tendon: i for i, drive in enumerate(mechanism.drives)
             if isinstance(drive, PullDrive)}
    setters = {drive.tendon: i for i, drive in enumerate(mechanism.drives)
               if isinstance(drive, StiffnessDrive)}
    return Tendons(
        name=_names(tendons),
        first=first,
        guide_body=_ints(names.body[guide.body] for guide in guides),
        guide_at=_floats((guide.at for guide in guides), 2),
        guide_radius=_floats((-1.0 if guide.side == "left" else 1.0) * guide.radius
                             for guide in guides),
        guide_turns=_ints(
            guide.turns if tendon.closed or 0 < k < len(tendon.path) - 1 else 0
            for tendon in tendons for k, guide in enumerate(tendon.path)),
        closed=_flags(tendon.closed for tendon in tendons),
        grips=_ints(start + k for start, tendon in zip(first.tolist(), tendons, strict=False)
                    for k in tendon.gripping),
        friction=_floats(tendon.guides[k].friction for tendon in tendons for k in tendon.gripping),
        wheels=_ints(start + k for start, tendon in zip(first.tolist(), tendons, strict=False)
                     for k in tendon.lifting),
        pretension=_floats(NAN if tendon.pretension is None else tendon.pretension
                           for tendon in tendons),
        stiffness=_floats(tendon.stiffness for tendon in tendons),
        damping=_floats(tendon.damping for tendon in tendons),
        rest=_floats(NAN if tendon.rest_length is None else tendon.rest_length
                     for tendon in tendons),
        slack=_floats(tendon.slack for tendon in tendons),
        drive=_ints(pulls.get(tendon.name, NONE) for tendon in tendons),
        stiffener=_ints(setters.get(tendon.name, NONE) for tendon in tendons))


@dataclass(frozen=True)
class _Drive:
    """What a spec of a drive says; the defaults stand for what its kind does not have."""

    target: int
    shape: int = NONE
    at: Vec = NO_POINT
    direction: Vec = NO_POINT
    turning: bool = False
    most: float = NAN
    slope: float = NAN
    stiffness: float = NAN
    damping: float = 0.0
    fastest: float = math.inf
    resistance: float = NAN
    sense: float = NAN


def _drive(drive: Drive, names: Names, ties: Mapping[str, int]) -> _Drive:
    match drive:
        case ForceDrive():
            size = np.hypot(*drive.direction)
            direction = float(drive.direction[0] / size), float(drive.direction[1] / size)
            return _Drive(names.body[drive.body], at=drive.at, direction=direction,
                          turning=drive.frame == "body")
        case TorqueDrive() | BrakeDrive():
            return _Drive(names.joint[drive.joint])
        case PushDrive():
            return _Drive(names.joint[drive.joint])
        case MotorDrive():
            return _Drive(names.joint[drive.joint],
                          most=math.inf if drive.torque is None else drive.torque,
                          slope=drive.stall / drive.no_load
                          if drive.stall is not None and drive.no_load is not None else NAN)
        case ExtendDrive():
            return _Drive(names.joint[drive.joint], most=drive.force)
        case ServoDrive() | LengthDrive():
            return _Drive(
                names.joint[drive.joint],
                most=drive.torque if isinstance(drive, ServoDrive) else drive.force,
                stiffness=NAN if drive.stiffness is None else drive.stiffness,
                damping=drive.damping, fastest=math.inf if drive.speed is None else drive.speed)
        case PullDrive():
            return _Drive(names.tendon[drive.tendon])
        case RadiusDrive():
            return _Drive(names.body[drive.body], shape=drive.shape)
        case StiffnessDrive():
            return _Drive(names.tendon[drive.tendon] if drive.tendon is not None
                          else names.spring[drive.spring or ""])
        case FlowDrive():
            return _Drive(names.line[drive.line])
        case PressureDrive():
            return _Drive(names.line[drive.line], resistance=drive.resistance)
        case OpeningDrive():
            return _Drive(names.valve[drive.valve])
        case HoldDrive():
            return _Drive(ties[drive.element])
        case SurfaceDrive():
            return _Drive(names.body[drive.body],
                          sense=1.0 if drive.positive == "counterclockwise" else -1.0)


def _drives(mechanism: Mechanism, names: Names) -> Drives:
    drives = mechanism.drives
    ties = {name: number for number, name in enumerate(mechanism.releasable)}
    rows = [_drive(drive, names, ties) for drive in drives]
    kinds = tuple(kind_of(drive) for drive in drives)
    return Drives(
        name=_names(drives), kind=kinds, target=_ints(row.target for row in rows),
        floor=_floats(kind.floor for kind in kinds), shape=_ints(row.shape for row in rows),
        at=_floats((row.at for row in rows), 2),
        direction=_floats((row.direction for row in rows), 2),
        turning=_flags(row.turning for row in rows), most=_floats(row.most for row in rows),
        slope=_floats(row.slope for row in rows),
        sense=_floats(row.sense for row in rows),
        stiffness=_floats(row.stiffness for row in rows),
        damping=_floats(row.damping for row in rows),
        fastest=_floats(row.fastest for row in rows),
        resistance=_floats(row.resistance for row in rows))
