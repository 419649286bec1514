"""The Model: a mechanism with every name worked out, as arrays that never change.

A mechanism speaks of elements by name; here they are numbers, in the mechanism's
order, and what a spec leaves open (an anchor, a length at rest) is filled in. It is
made once, by :func:`compile_mechanism`, and every room that runs, records, checks or draws
reads it: none looks a name up again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Any, NamedTuple, get_type_hints

import numpy as np

from sandbox.elements.drive import DriveKind, Gives
from sandbox.elements.element import NO_POINT
from sandbox.elements.joint import JointKind, Keeps
from sandbox.elements.springs import SpringKind
from sandbox.model.bonds import Bonds
from sandbox.model.laws import LoadLaw, SpringLaw
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import Vec, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import Path

NONE = -1
"""Stands for no element where the number of one is expected."""
NAN = math.nan
PAIR = (NO_POINT, NO_POINT)


class Column(NamedTuple):
    """Marks a column that is filled from an attribute of each element."""

    default: Any
    """Of elements without a value; it gives the column's type and shape."""
    attribute: str = ""
    """Where it has another name than the column."""


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

    name: tuple[str, ...]
    free: Flags
    """Which move as forces have it, [nb]; the others are fixed or scheduled."""
    fixed: Flags
    """Which never move, [nb]."""
    pose: Array
    """x, y [m], angle [rad] of the frame at t = 0, [nb, 3]."""
    centre: Array
    """Centre of mass in the body's frame [m], [nb, 2]; 0 unless free."""
    mass: Array
    """[kg], [nb]; infinite unless free."""
    inertia: Array
    """About the centre of mass [kg m^2], [nb]; infinite unless free."""

    @cached_property
    def scheduled(self) -> Flags:
        """Which move as the scene says, [nb]."""
        return ~self.free & ~self.fixed


@dataclass(frozen=True)
class Joints:
    """nj joints between a body ``a`` and a body ``b``."""

    name: tuple[str, ...]
    kind: tuple[JointKind, ...]
    bodies: Integers
    """``a`` and ``b``, [nj, 2]."""
    anchor: Array
    """The points of ``a`` and ``b`` that the joint holds, in their frames [m], [nj, 2, 2]."""
    turns: Annotated[Flags, Column(True)]
    """Whether ``b`` may turn against ``a``, [nj]."""
    angle: Flags
    """Whether it has an angle (a hinge), [nj]."""
    sense: Annotated[Array, Column(NAN)]
    """From a counter-clockwise turn to the positive one: +1 or -1, [nj]; nan unless a hinge."""
    zero: Annotated[Array, Column(NAN)]
    """Taken from the angle between the two frames [rad], [nj]; nan unless a hinge."""
    stops: Annotated[Array, Column(NO_POINT, "limits")]
    """Lowest and highest angle [rad], [nj, 2]; nan where there are none."""
    damping: Annotated[Array, Column(0.0)]
    """Of the joint itself [N m s/rad], [nj]."""
    start: Array
    """Angle at t = 0 [rad], [nj]; nan unless a hinge."""
    groove: Annotated[Array, Column(PAIR)]
    """Start and end of a straight groove, in the frame of ``a`` [m], [nj, 2, 2]; nan of others."""
    path: tuple[Path | None, ...]
    """Path of a curved slot in the frame of ``a``, [nj]; None of others."""
    reach: Annotated[Array, Column(NO_POINT)]
    """Least and largest distance that it allows [m], [nj, 2]; equal of a rod; nan of others."""
    radii: Annotated[Array, Column(NO_POINT)]
    """Of the wheels of ``a`` and ``b`` [m], [nj, 2]; nan of what has none."""
    inside: Annotated[Flags, Column(False)]
    """Whether one wheel runs inside the other, [nj]."""
    pressure: Annotated[Array, Column(NAN, "pressure_angle")]
    """Pressure angle of its teeth [rad], [nj]; nan where there are none."""
    play: Annotated[Array, Column(0.0, "backlash")]
    """Of its teeth along the pitch circles [m], [nj]."""
    stiffness: Annotated[Array, Column(NAN)]
    """Of its teeth [N/m], [nj]; nan where there are none."""
    along: Annotated[Array, Column(NO_POINT)]
    """A rack's pitch line in the frame of ``b``, a unit vector, the gear to its left, [nj, 2];
    nan of others."""
    friction: Annotated[Array, Column(0.0)]
    """Dry friction that does not depend on the load, [N m] of a pin, [N] of a slot, [nj]; or 0."""
    coefficient: Annotated[Array, Column(0.0)]
    """Dry friction by what the joint carries, [N m/N] of a pin, 1 of a slot, [nj]; 0 without."""
    static: Annotated[Array, Column(1.0)]
    """How many times as much friction holds as slides, [nj]."""
    collide: Annotated[Flags, Column(False)]
    """Whether the two bodies may touch, [nj]."""

    @cached_property
    def hinges(self) -> Integers:
        """Numbers of the joints with an angle."""
        return np.flatnonzero(self.angle)

    @cached_property
    def pivots(self) -> Integers:
        """Numbers of the hinges that turn about one point of both bodies."""
        return np.intersect1d(self.hinges, self.keeping("point"))

    @cached_property
    def grooved(self) -> Integers:
        """Numbers of the slots."""
        return self.keeping("groove")

    @cached_property
    def stopped(self) -> Integers:
        """Numbers of the joints with stops."""
        return np.flatnonzero(np.isfinite(self.stops).all(axis=1))

    @cached_property
    def frictional(self) -> Integers:
        """Numbers of the joints with dry friction."""
        return np.flatnonzero((self.friction > 0) | (self.coefficient > 0))

    def keeping(self, *what: Keeps) -> Integers:
        """Numbers of the joints that keep a ``point``, a ``groove``, a ``distance``, ..."""
        return np.array([j for j, kind in enumerate(self.kind) if kind.keeps in what],
                        dtype=np.int64)

    @cached_property
    def unknowns(self) -> Integers:
        """Number of unknown components of force and couple of a joint, [nj]."""
        forces = [kind.forces for kind in self.kind]
        return np.array(forces, dtype=np.int64) + ~self.turns


@dataclass(frozen=True)
class Springs:
    """ns springs; a rotary one acts on the bodies of its hinge."""

    name: tuple[str, ...]
    kind: tuple[SpringKind, ...]
    straight: Flags
    """From point to point, [ns]; otherwise rotary."""
    bodies: Annotated[Integers, Column((NONE, NONE))]
    """``a`` and ``b``, [ns, 2]."""
    anchor: Annotated[Array, Column(PAIR)]
    """Its ends, in the frames of ``a`` and ``b`` [m], [ns, 2, 2]; nan of a rotary one."""
    joint: Annotated[Integers, Column(NONE)]
    """The hinge that it acts on, [ns]; -1 of a straight one."""
    stiffness: Array
    """[N/m], of a rotary one [N m/rad], [ns]; by a law that of t = 0, 0 at least."""
    damping: Array
    """[N s/m], of a rotary one [N m s/rad], [ns]; 0 where a law includes it."""
    rest: Annotated[Array, Column(NAN)]
    """Length at rest [m], of a rotary one angle at rest [rad], [ns]."""
    start: Annotated[Array, Column(NAN)]
    """Length [m], of a rotary one angle [rad] at t = 0, [ns]."""
    drive: Integers
    """The drive that sets its stiffness, [ns]; -1 where none does."""
    law: tuple[SpringLaw | None, ...]
    """Its force by a law of its own, damper included; None of a linear one."""


@dataclass(frozen=True)
class Tendons:
    """nt tendons over ng guides, the guides of one tendon side by side.

    Of a closed one the first guide comes last again.
    """

    name: tuple[str, ...]
    first: Integers
    """Where the guides of each begin, and the end of the last one's, [nt + 1]."""
    guide_body: Integers
    """[ng]"""
    guide_at: Array
    """In the body's frame [m], [ng, 2]."""
    guide_radius: Array
    """Of the wheel, positive where its centre lies right of the path [m], [ng]; 0 of an eye."""
    guide_turns: Integers
    """Whole turns round the wheel at t = 0, besides, [ng]; 0 where a tendon is tied."""
    closed: Annotated[Flags, Column(False)]
    """Which are loops, [nt]."""
    grips: Integers
    """Guides that hold a tendon by friction, [nf]; of a loop its first, not its last."""
    friction: Array
    """Coefficients of these, [nf]."""
    wheels: Integers
    """The guides, of all, that a tendon can lift off, [nw]."""
    pretension: Annotated[Array, Column(NAN)]
    """Tension at t = 0 [N], [nt]; nan where the length at rest says it."""
    stiffness: Annotated[Array, Column(NAN)]
    """[N/m], [nt]"""
    damping: Annotated[Array, Column(0.0)]
    """[N s/m], [nt]"""
    rest: Annotated[Array, Column(NAN, "rest_length")]
    """Length at rest as the scene gives it, slack left out [m], [nt]; nan for that at t = 0."""
    slack: Annotated[Array, Column(0.0)]
    """Added to the length at rest [m], [nt]."""
    drive: Integers
    """The drive that pulls it, [nt]; -1 where none does."""
    stiffener: Integers
    """The drive that sets its stiffness, [nt]; -1 where none does."""

    def guides(self, tendon: int) -> slice:
        """Where the guides of a tendon stand among all."""
        return slice(int(self.first[tendon]), int(self.first[tendon + 1]))

    def gripped(self, tendon: int) -> Integers:
        """Which of ``grips`` are of a tendon, in its order."""
        guides = self.guides(tendon)
        return np.flatnonzero((self.grips >= guides.start) & (self.grips < guides.stop))

    def loose(self, tendon: int) -> Integers:
        """Which of ``wheels`` are of a tendon, in its order."""
        guides = self.guides(tendon)
        return np.flatnonzero((self.wheels >= guides.start) & (self.wheels < guides.stop))

    @cached_property
    def stretch_first(self) -> Integers:
        """Of every straight piece the guide where it begins, [ng - nt]; it ends at the next one."""
        return np.delete(np.arange(len(self.guide_body)), self.first[1:] - 1)

    @cached_property
    def stretch_tendon(self) -> Integers:
        """Of every straight piece the tendon that it is of, [ng - nt]."""
        return np.repeat(np.arange(len(self.name)), np.diff(self.first) - 1)


@dataclass(frozen=True, kw_only=True)
class Chambers:
    """nc chambers of lines."""

    bodies: Annotated[Integers, Column((NONE, NONE))]
    """``a`` and ``b`` of a chamber; of one on a hinge those of the hinge, [nc, 2]."""
    anchor: Annotated[Array, Column(PAIR)]
    """Its two points, in the frames of ``a`` and ``b`` [m], [nc, 2, 2]; nan on a hinge."""
    joint: Annotated[Integers, Column(NONE)]
    """The hinge that it is on, [nc]; -1 between two points."""
    gain: Annotated[Array, Column(NAN)]
    """Volume per distance of its points [m^2], or per angle of its hinge, [nc]."""
    start: Annotated[Array, Column(NAN)]
    """That distance [m], or angle [rad], at t = 0, [nc]."""


@dataclass(frozen=True, kw_only=True)
class Lines(Chambers):
    """nl lines of fluid with nc chambers, those of one line side by side."""

    name: tuple[str, ...]
    first: Integers
    """Where the chambers of each begin, and the end of the last one's, [nl + 1]."""
    volume: Array
    """At t = 0 [m^3], [nl]."""
    compliance: Array
    """Of a liquid, volume per pressure [m^3/Pa], [nl]; of a gas that at t = 0."""
    gas: Annotated[Array, Column(NAN)]
    """The exponent of a gas, [nl]; nan of a liquid."""
    pressure: Annotated[Array, Column(0.0)]
    """At t = 0 [Pa], [nl]."""
    least: Annotated[Array, Column(NAN)]
    """[Pa], [nl]"""
    most: Annotated[Array, Column(math.inf, "relief")]
    """[Pa], [nl]; infinite without relief."""
    drive: Integers
    """The drive that sets its pressure, without resistance, [nl]; -1 where none does."""

    def chambers(self, line: int) -> slice:
        """Where the chambers of a line stand among all."""
        return slice(int(self.first[line]), int(self.first[line + 1]))

    @cached_property
    def of(self) -> Integers:
        """Of every chamber its line, [nc]."""
        return np.repeat(np.arange(len(self.name)), np.diff(self.first))


@dataclass(frozen=True)
class Valves:
    """nv valves."""

    name: tuple[str, ...]
    lines: Integers
    """``a`` and ``b``, [nv, 2]; -1 for the tank."""
    resistance: Annotated[Array, Column(0.0)]
    """[Pa s/m^3], [nv]"""
    orifice: Annotated[Array, Column(0.0)]
    """Pressure per square of the flow [Pa s^2/m^6], [nv]; 0 of what is no orifice."""
    one_way: Annotated[Flags, Column(False)]
    """Which let fluid only from ``a`` to ``b``, [nv]."""
    drive: Integers
    """The drive that opens it, [nv]; -1 where none does."""


@dataclass(frozen=True)
class BodyLoads:
    """nk loads, each as often as it has bodies."""

    name: tuple[str, ...]
    """Of the load and the body."""
    load: Integers
    """Number of the load, [nk]."""
    body: Integers
    """[nk]"""
    at: Array
    """Where the force acts, in the body's frame [m], [nk, 2]; of buoyancy the centre of mass."""
    turning: Annotated[Flags, Column(False)]
    """Whether its components are along the body's axes, [nk]."""
    per_mass: Annotated[Flags, Column(False)]
    """Whether they are those of an acceleration, [nk]."""
    law: tuple[LoadLaw | None, ...]
    """None of buoyancy."""
    level: Annotated[Array, Column(NAN)]
    """Of a liquid [m], [nk]; nan of other loads."""
    lift: Array
    """Of a liquid the force per area below the level [N/m^2], [nk]; nan of other loads."""
    sides: Array
    """Outlines of what it lifts, those of one body side by side, in the body's frame [m], [k, 5]:
    two ends and 0, or centre, first and last angle and radius of an arc."""
    first: Integers
    """Where those of each begin, and the end of the last one's, [nk + 1]."""

    def outline(self, number: int) -> Array:
        """The sides of one, [k, 5]."""
        return self.sides[self.first[number]:self.first[number + 1]]


@dataclass(frozen=True)
class Drives:
    """nd drives."""

    name: tuple[str, ...]
    kind: tuple[DriveKind, ...]
    target: Integers
    """Number of the body, joint, tendon, spring, line or valve that it acts on, [nd]."""
    floor: Array
    """The least value in force, in the drive's unit, [nd]; -inf where there is none."""
    shape: Annotated[Integers, Column(NONE)]
    """Which shape of its body a radius is set of, [nd]; -1 of other drives."""
    at: Annotated[Array, Column(NO_POINT)]
    """Where a force acts, in its body's frame [m], [nd, 2]; nan of other drives."""
    direction: Annotated[Array, Column(NO_POINT, "along")]
    """Unit vector of a force, [nd, 2]; nan of other drives."""
    turning: Annotated[Flags, Column(False)]
    """Whether a force's direction turns with its body, [nd]."""
    most: Annotated[Array, Column(NAN)]
    """The most that a motor, servo or drive of an actuator may give [N m, N], infinite without a
    bound, [nd]; nan of others."""
    slope: Annotated[Array, Column(NAN)]
    """Of a motor with a line: torque per speed that lacks [N m s/rad], [nd]; nan of others."""
    sense: Annotated[Array, Column(NAN)]
    """Of a surface that runs: from counter-clockwise round its body to its positive way, +1 or -1,
    [nd]; nan of other drives."""
    stiffness: Annotated[Array, Column(NAN)]
    """With which it goes to a place [N m/rad, N/m], [nd]; nan of rigid ones and other drives."""
    damping: Annotated[Array, Column(0.0)]
    """That goes with it [N m s/rad, N s/m], [nd]."""
    fastest: Annotated[Array, Column(math.inf, "speed")]
    """The most that a rigid one moves at [rad/s, m/s], [nd]; infinite without a limit."""
    resistance: Annotated[Array, Column(NAN)]
    """Between a source of pressure and its line [Pa s/m^3], [nd]; nan of other drives."""

    @cached_property
    def late(self) -> Array:
        """How long after a step's pose its value counts, in steps, [nd].

        A motor with a set speed uses the value at the end of the step, a motor with a torque-speed
        line that at its pose; a rigid position drive uses the position in the next step.
        """
        return np.array([
            0.5 if kind.timely == "end" and np.isnan(slope)
            else 1.0 if kind.places and np.isnan(stiffness) else 0.0
            for kind, stiffness, slope in zip(self.kind, self.stiffness, self.slope, strict=True)
        ], dtype=float)

    def giving(self, *what: Gives) -> Integers:
        """Numbers of the drives that give a ``force``, a ``torque``, a ``tension``, ..."""
        return np.array([i for i, kind in enumerate(self.kind) if kind.gives in what],
                        dtype=np.int64)


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
    def neighbours(self) -> tuple[tuple[tuple[int, int], ...], ...]:
        """Of every body: its joints, each with the body at its other end."""
        found: list[list[tuple[int, int]]] = [[] for _ in self.bodies.name]
        for joint, (a, b) in enumerate(self.joints.bodies.tolist()):
            found[a].append((joint, b))
            found[b].append((joint, a))
        return tuple(tuple(each) for each in found)

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


def columns_of(
    part: type, elements: Sequence[Any], rows: Sequence[Mapping[str, Any]] = (),
) -> dict[str, Any]:
    """The columns of a part of the model that are marked by :class:`Column`.

    Args:
        part: its class.
        elements: a row each.
        rows: by element, what takes the place of its attributes.
    """
    columns = {}
    for name, (default, attribute) in _columns(part).items():
        found = [row[name] if name in row else getattr(element, attribute or name, None)
                 for element, row in zip(elements, rows or [{}] * len(elements), strict=True)]
        columns[name] = np.array([default if value is None else value for value in found],
                                 dtype=np.array(default).dtype).reshape(-1, *np.shape(default))
    return columns
