"""The Model: a mechanism as arrays that never change, with names replaced by numbers.

Numbers follow the mechanism's order; what a spec leaves open (an anchor, a rest length) is filled
in. :func:`sandbox.model.compile.compile_mechanism` makes it once.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np

from sandbox.elements.drives import DriveKind, Gives
from sandbox.elements.element import NAMED, NO_POINT, RELEASABLE
from sandbox.elements.joints import JointKind, Keeps
from sandbox.elements.springs import SpringKind
from sandbox.model.programs import LoadLaw, SpringLaw
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import Vec, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import Path

NONE = -1  # stands for no element where the number of one is expected
NAN = math.nan


class Column(NamedTuple):
    """Marks a column that is filled from an attribute of each element."""

    default: Any  # of elements without a value; gives the array's type and shape; None: a tuple
    attributes: tuple[str, ...] = ()  # where they have another name than the column


Texts = Annotated[tuple[str, ...], Column(None)]
Number = Annotated[Array, Column(NAN)]  # nan of elements that have none
OrZero = Annotated[Array, Column(0.0)]
Flag = Annotated[Flags, Column(False)]
Point = Annotated[Array, Column(NO_POINT)]
Points = Annotated[Array, Column((NO_POINT, NO_POINT))]


@dataclass(frozen=True)
class Names:
    """From an element's name to its number, kind by kind."""

    body: Mapping[str, int]
    joint: Mapping[str, int]
    spring: Mapping[str, int]
    tendon: Mapping[str, int]
    line: Mapping[str, int]
    valve: Mapping[str, int]
    drive: Mapping[str, int]


@dataclass(frozen=True)
class Bodies:
    """nb bodies; a point of a body is given in the body's own frame."""

    name: Texts
    free: Flags  # [nb] which move as forces have it; the others are fixed or scheduled
    fixed: Flags  # [nb]
    pose: Array  # [nb, 3] x, y [m], angle [rad] of the frame at t = 0
    velocity: Array  # [nb, 3] of the centre of mass, and about it, at t = 0; 0 unless free
    centre: Array  # [nb, 2] centre of mass in the body's frame [m]; 0 unless free
    mass: Array  # [nb] [kg]; infinite unless free
    inertia: Array  # [nb] about the centre of mass [kg m^2]; infinite unless free
    scheduled: Flags  # [nb] which are neither free nor fixed


@dataclass(frozen=True)
class Joints:
    """nj joints between a body ``a`` and a body ``b``; nan where a kind has no such number."""

    name: Texts
    kind: Annotated[tuple[JointKind, ...], Column(None, ("facts",))]
    bodies: Integers  # [nj, 2] a and b
    anchor: Array  # [nj, 2, 2] the points of a and b that it holds, in their frames [m]
    turns: Annotated[Flags, Column(True)]  # [nj] whether b may rotate against a
    angle: Flags  # [nj] whether it has an angle (a hinge)
    sense: Number  # [nj] of a hinge: from counter-clockwise to its positive sense, +1 or -1
    zero: Number  # [nj] of a hinge: taken from the angle between the two frames [rad]
    stops: Annotated[Array, Column(NO_POINT, ("limits",))]  # [nj, 2] lowest, highest angle [rad]
    damping: OrZero  # [nj] of the joint itself [N m s/rad]
    start: Array  # [nj] angle of a hinge at t = 0 [rad]
    groove: Points  # [nj, 2, 2] ends of a straight groove, in the frame of a [m]
    path: tuple[Path | None, ...]  # [nj] of a curved slot, in the frame of a
    reach: Point  # [nj, 2] minimum and maximum distance [m]; equal of a rod
    radii: Point  # [nj, 2] of the wheels of a and b [m]
    inside: Flag  # [nj] whether one wheel runs inside the other
    pressure: Annotated[Array, Column(NAN, ("pressure_angle",))]  # [nj] of its teeth [rad]
    play: Annotated[Array, Column(0.0, ("backlash",))]  # [nj] of its teeth along the pitch line [m]
    stiffness: Number  # [nj] of its teeth [N/m]
    along: Point  # [nj, 2] pitch line of a rack in the frame of b, unit, the gear on its left
    friction: OrZero  # [nj] constant dry friction [N m of a pin, N of a slot]
    # [nj] dry friction per reaction [m of a pin, 1 of a slot]
    coefficient: Annotated[Array, Column(0.0, ("coefficient", "friction_coefficient"))]
    static: Annotated[Array, Column(1.0)]  # [nj] static over sliding friction
    collide: Flag  # [nj] whether the two bodies may touch
    hinges: Integers  # numbers of those with an angle
    stopped: Integers  # of those with stops
    frictional: Integers  # of those with dry friction
    unknowns: Integers  # [nj] number of unknown components of force and couple

    def keeping(self, *what: Keeps) -> Integers:
        """Numbers of the joints that keep a ``point``, a ``groove``, a ``distance``, ..."""
        return np.array([j for j, kind in enumerate(self.kind) if kind.keeps in what],
                        dtype=np.int64)


@dataclass(frozen=True)
class Springs:
    """ns springs; a rotary one acts on the bodies of its hinge, with N m for N and rad for m."""

    name: Texts
    kind: Annotated[tuple[SpringKind, ...], Column(None, ("facts",))]
    straight: Flags  # [ns] from point to point; otherwise rotary
    bodies: Integers  # [ns, 2] a and b
    joint: Integers  # [ns] the hinge of a rotary one, or -1
    anchor: Array  # [ns, 2, 2] its ends in the frames of a and b [m]; nan of a rotary one
    start: Array  # [ns] length at t = 0 [m]
    stiffness: Array  # [ns] [N/m]; by a law that of t = 0, 0 at least
    damping: Array  # [ns] [N s/m]; 0 where a law includes it
    rest: Annotated[Array, Column(NAN, ("rest_length", "rest_angle"))]  # [ns] rest length [m]
    drive: Integers  # [ns] the drive that sets its stiffness, or -1
    law: tuple[SpringLaw | None, ...]  # [ns] damper included; None of a linear one


@dataclass(frozen=True)
class Tendons:
    """nt tendons over ng guides, those of a tendon side by side; of a loop the first one twice."""

    name: Texts
    first: Integers  # [nt + 1] where the guides of each begin, and the last one's end
    guide_body: Integers  # [ng]
    guide_at: Array  # [ng, 2] in the body's frame [m]
    guide_radius: Array  # [ng] of the wheel [m], positive if its centre is right of the path; or 0
    guide_turns: Integers  # [ng] additional whole turns around the wheel at t = 0
    closed: Flag  # [nt] which are loops
    grips: Integers  # [nf] guides that hold a tendon by friction; of a loop its first, not its last
    friction: Array  # [nf] coefficients of these
    wheels: Integers  # [nw] guides that a tendon can lift off
    pretension: Number  # [nt] tension at t = 0 [N]; nan where the rest length gives it
    stiffness: Number  # [nt] [N/m]
    damping: OrZero  # [nt] [N s/m]
    rest: Annotated[Array, Column(NAN, ("rest_length",))]  # [nt] without slack [m], or nan
    slack: OrZero  # [nt] added to the rest length [m]
    drive: Integers  # [nt] the drive that pulls it, or -1
    stiffener: Integers  # [nt] the drive that sets its stiffness, or -1
    stretch_first: Integers  # [ng - nt] guide where each straight piece begins
    stretch_tendon: Integers  # [ng - nt] tendon of each straight piece

    def guides(self, tendon: int) -> slice:
        """Where the guides of a tendon stand among all."""
        return slice(int(self.first[tendon]), int(self.first[tendon + 1]))

    def gripped(self, tendon: int) -> Integers:
        """Which of ``grips`` are of a tendon, in its order."""
        return self._of(tendon, self.grips)

    def loose(self, tendon: int) -> Integers:
        """Which of ``wheels`` are of a tendon, in its order."""
        return self._of(tendon, self.wheels)

    def _of(self, tendon: int, guides: Integers) -> Integers:
        first, end = self.first[tendon:tendon + 2]
        return np.flatnonzero((guides >= first) & (guides < end))


@dataclass(frozen=True)
class Lines:
    """nl lines of fluid with nc chambers, those of one line side by side."""

    name: Texts
    first: Integers  # [nl + 1] where the chambers of each begin, and the last one's end
    volume: Array  # [nl] at t = 0 [m^3]
    compliance: Array  # [nl] volume per pressure [m^3/Pa]; of a gas that at t = 0
    gas: Number  # [nl] the exponent of a gas; nan of a liquid
    pressure: OrZero  # [nl] at t = 0 [Pa]
    least: Number  # [nl] minimum [Pa]
    most: Annotated[Array, Column(math.inf, ("relief",))]  # [nl] maximum [Pa]
    drive: Integers  # [nl] the drive that sets its pressure, without resistance, or -1
    of: Integers  # [nc] line of each chamber
    bodies: Integers  # [nc, 2] a and b of a chamber; of one on a hinge those of the hinge
    joint: Integers  # [nc] the hinge that it is on, or -1
    anchor: Array  # [nc, 2, 2] its two points, in the frames of a and b [m]; nan on a hinge
    start: Array  # [nc] distance of its points [m], or angle [rad], at t = 0
    gain: Array  # [nc] volume per such distance [m^2], or per angle

    def chambers(self, line: int) -> slice:
        """Where the chambers of a line stand among all."""
        return slice(int(self.first[line]), int(self.first[line + 1]))


@dataclass(frozen=True)
class Valves:
    """nv valves."""

    name: Texts
    lines: Integers  # [nv, 2] a and b; -1 for the tank
    resistance: OrZero  # [nv] [Pa s/m^3]
    orifice: OrZero  # [nv] pressure per square of the flow [Pa s^2/m^6]; 0 without an orifice
    one_way: Flag  # [nv] which let fluid only from a to b
    drive: Integers  # [nv] the drive that opens it, or -1


@dataclass(frozen=True)
class BodyLoads:
    """nk loads, one for every body that a load acts on; nan of other kinds of load."""

    name: tuple[str, ...]  # of the load and the body
    load: Integers  # [nk] number of the load
    body: Integers  # [nk]
    at: Array  # [nk, 2] point of the force in the body's frame [m]; of buoyancy the centre of mass
    turning: Flag  # [nk] whether its components are along the body's axes
    per_mass: Flag  # [nk] whether they are those of an acceleration
    law: tuple[LoadLaw | None, ...]  # [nk] None of buoyancy
    level: Number  # [nk] of a liquid [m]
    lift: Array  # [nk] of a liquid, force per area below the level [N/m^2]
    sides: Array  # [k, 5] outlines of lifted bodies in their frames, see sandbox.model.loads.Arc
    first: Integers  # [nk + 1] where the sides of each begin, and the last one's end

    def outline(self, number: int) -> Array:
        """The sides of one, [k, 5]."""
        return self.sides[self.first[number]:self.first[number + 1]]


@dataclass(frozen=True)
class Drives:
    """nd drives; nan or -1 where a kind has no such number."""

    name: Texts
    kind: Annotated[tuple[DriveKind, ...], Column(None)]
    target: Integers  # [nd] number of the element that it acts on
    floor: Array  # [nd] minimum value, in the drive's unit, or -inf
    shape: Annotated[Integers, Column(NONE)]  # [nd] the shape of its body whose radius it sets
    at: Point  # [nd, 2] where a force acts, in its body's frame [m]
    direction: Annotated[Array, Column(NO_POINT, ("along",))]  # [nd, 2] unit vector of a force
    turning: Flag  # [nd] whether a force's direction turns with its body
    most: Annotated[Array, Column(NAN, ("torque", "force"))]  # [nd] of a limited one [N m, N]
    slope: Number  # [nd] of a motor with a line: torque per missing speed [N m s/rad]
    sense: Number  # [nd] of a conveyor surface: +1 if counter-clockwise is positive, else -1
    stiffness: Number  # [nd] of an elastic servo or length [N m/rad, N/m]
    damping: OrZero  # [nd] of the same [N m s/rad, N s/m]
    fastest: Annotated[Array, Column(math.inf, ("speed",))]  # [nd] of a rigid one [rad/s, m/s]
    resistance: Number  # [nd] between a source of pressure and its line [Pa s/m^3]

    @cached_property
    def late(self) -> Array:
        """Delay of the value that counts after a step's pose, in steps, [nd].

        Set speeds count at the end of a step, rigid positions in the next one, others at its pose.
        """
        ends = np.array([kind.timely == "end" for kind in self.kind], dtype=bool)
        places = np.array([kind.places for kind in self.kind], dtype=bool)
        return np.where(ends & np.isnan(self.slope), 0.5,
                        np.where(places & np.isnan(self.stiffness), 1.0, 0.0))

    def giving(self, *what: Gives) -> Integers:
        """Numbers of the drives that give a ``force``, a ``torque``, a ``tension``, ..."""
        return np.array([i for i, kind in enumerate(self.kind) if kind.gives in what],
                        dtype=np.int64)


@dataclass(frozen=True)
class Bonds:
    """nr joints, springs and tendons that can be released, in this order."""

    name: tuple[str, ...]
    joint: Integers  # [nj] number of every joint among these, or -1
    spring: Integers  # [ns]
    tendon: Integers  # [nt]
    breaks_at: Annotated[Array, Column(math.inf)]  # [nr] breaking load [N, of a rotary spring N m]
    held: Flags  # [nr] which are engaged at t = 0
    as_is: Flags  # [nr] which are engaged with the length that they have then
    drive: Integers  # [nr] the drive that holds each, or -1
    over: Annotated[Array, Column(0.0, ("takes_up_in",))]  # [nr] time of closing a joint's gap [s]

    def of(self, kind: str) -> Integers:
        """Of every ``joint``, ``spring`` or ``tendon`` its number among these, or -1."""
        found: Integers = getattr(self, kind)
        return found

    def element(self, number: int) -> tuple[str, int]:
        """The list of :data:`RELEASABLE` of an element with this number, and its place there."""
        kind = next(kind for kind in RELEASABLE if number in self.of(NAMED[kind].one))
        return kind, self.of(NAMED[kind].one).tolist().index(number)

    def begins(self, number: int) -> bool:
        """Whether the element with this number, or -1, is engaged at t = 0."""
        return bool(number < 0 or self.held[number])


def held_of(bonds: int | Integers, held: Array | Integers) -> Flags:
    """Whether elements, by their numbers in Bonds or -1, are engaged in samples, [..., n].

    ``held`` is as recorded, [n, nr]; an element that was not recorded is engaged.
    """
    found: Flags = np.vstack([held.T != 0.0, np.ones(len(held), dtype=bool)])[bonds]
    return found


@dataclass(frozen=True)
class Model:
    """A mechanism that is ready to be run, checked or drawn; all arrays are read-only."""

    mechanism: Mechanism
    names: Names
    bodies: Bodies
    joints: Joints
    springs: Springs
    tendons: Tendons
    lines: Lines
    valves: Valves
    loads: BodyLoads
    drives: Drives
    bonds: Bonds

    def at_start(self, body: int, point: Array) -> Vec:
        """A point of a body's frame [m] in the world at t = 0."""
        x, y, angle = self.bodies.pose[body].tolist()
        return to_world((x, y, angle), (float(point[0]), float(point[1])))

    def ends(self, joint: int) -> tuple[Vec, Vec]:
        """The anchors of a joint on ``a`` and ``b`` in the world at t = 0 [m]."""
        one, other = (self.at_start(body, point) for body, point in zip(
            self.joints.bodies[joint], self.joints.anchor[joint], strict=True))
        return one, other

    @cached_property
    def hinge_damping(self) -> Array:
        """Of all dampers about a joint, its own and rotary springs' [N m s/rad], [nj]."""
        damping, rotary = self.joints.damping.copy(), np.flatnonzero(~self.springs.straight)
        np.add.at(damping, self.springs.joint[rotary], self.springs.damping[rotary])
        return damping


@cache
def _columns(part: type) -> dict[str, Column]:
    """The columns that a part of the model itself declares."""
    hints = get_type_hints(part, include_extras=True)
    return {name: mark for name in vars(part)["__annotations__"]
            for mark in getattr(hints[name], "__metadata__", ())}


def columns_of(part: type, elements: Sequence[Any], rows: Sequence[Any] = ()) -> dict[str, Any]:
    """The columns of a part that are marked by :class:`Column`; ``rows`` replace attributes."""
    columns = {}
    for name, (default, attributes) in _columns(part).items():
        found = [row[name] if name in row else next(
            (value for each in attributes or (name,)
             if (value := getattr(element, each, None)) is not None), None)
            for element, row in zip(elements, rows or [{}] * len(elements), strict=True)]
        columns[name] = tuple(found) if default is None else np.array(
            [default if value is None else value for value in found],
            dtype=np.array(default).dtype).reshape(-1, *np.shape(default))
    return columns
