"""From a mechanism to its :class:`sandbox.model.model.Model`: names become numbers, here only."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Protocol

import numpy as np

from sandbox.elements.element import NAMED, NO_POINT, RELEASABLES, Vec
from sandbox.elements.joint import Anchors
from sandbox.model.laws import SpringLaw, law_of
from sandbox.model.loads import compile_loads
from sandbox.model.model import (
    NONE,
    Bodies,
    Drives,
    Joints,
    Lines,
    Model,
    Names,
    Springs,
    Tendons,
    Valves,
    columns_of,
)
from sandbox.model.ties import compile_ties
from sandbox.scene.geometry import anchors, mass_properties, pose_of, to_body, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import path_through

NAN = math.nan
JOINT_COLUMNS: Mapping[str, Any] = {
    "turns": True, "sense": NAN, "zero": NAN, "stops": NO_POINT, "damping": 0.0,
    "groove": (NO_POINT, NO_POINT), "reach": NO_POINT, "radii": NO_POINT, "inside": False,
    "pressure": NAN, "play": 0.0, "stiffness": NAN, "along": NO_POINT, "friction": 0.0,
    "rubbing": 0.0, "static": 1.0}
"""Columns of joints that their kind fills in; the values stand for kinds without them."""
SPRING_COLUMNS: Mapping[str, Any] = {
    "bodies": (NONE, NONE), "anchor": (NO_POINT, NO_POINT), "joint": NONE, "rest": NAN,
    "start": NAN}
CHAMBER_COLUMNS: Mapping[str, Any] = {
    "bodies": (NONE, NONE), "anchor": (NO_POINT, NO_POINT), "joint": NONE, "gain": NAN,
    "start": NAN}
DRIVE_COLUMNS: Mapping[str, Any] = {
    "shape": NONE, "at": NO_POINT, "direction": NO_POINT, "turning": False, "most": NAN,
    "slope": NAN, "stiffness": NAN, "damping": 0.0, "fastest": math.inf, "resistance": NAN,
    "sense": NAN}


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
    bodies, joints = _bodies(mechanism), _joints(mechanism, names)
    scope = Scope(mechanism, names, joints)
    drives = _drives(scope)
    parts = (bodies, joints, _springs(scope), _tendons(scope),
             compile_lines(scope, drives), compile_valves(scope, drives),
             compile_loads(mechanism, bodies), drives, compile_ties(mechanism))
    for part in parts:
        for field in fields(part):
            if isinstance(array := getattr(part, field.name), np.ndarray):
                array.setflags(write=False)
    return Model(mechanism, names, *parts)


@dataclass(frozen=True)
class Scope:
    """What an element is compiled with: names of the others, joints, poses at t = 0."""

    mechanism: Mechanism
    names: Names
    joints: Joints

    def number(self, among: str, name: str) -> int:
        """The number of an element in a list, or among those that can be released."""
        if among == RELEASABLES:
            return self.mechanism.releasable.index(name)
        found: int = getattr(self.names, NAMED[among].one)[name]
        return found

    def world(self, body: str, point: Vec) -> Vec:
        """A point of a body's frame [m] in the world at t = 0."""
        return to_world(pose_of(self.mechanism.bodies[self.names.body[body]]), point)


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


def _joints(mechanism: Mechanism, names: Names) -> Joints:
    joints = mechanism.joints
    numbers = [(names.body[joint.a], names.body[joint.b]) for joint in joints]
    ends = [(mechanism.bodies[a], mechanism.bodies[b]) for a, b in numbers]
    held = [anchors(joint, *pair) for joint, pair in zip(joints, ends, strict=True)]
    rows = []
    for joint, (a, b), (on_a, on_b) in zip(joints, ends, held, strict=True):
        at_a = to_world(pose_of(a), on_a)
        distance = math.dist(at_a, to_world(pose_of(b), on_b))
        rows.append(joint.columns(Anchors(on_a, on_b, to_body(pose_of(b), at_a), distance)))
    columns = columns_of(rows, JOINT_COLUMNS)
    kinds = tuple(joint.facts for joint in joints)
    return Joints(
        name=_names(joints), kind=kinds, bodies=_ints(numbers, 2), anchor=_floats(held, 2, 2),
        angle=_flags(kind.angle for kind in kinds),
        start=columns["sense"] * _floats(b.angle - a.angle for a, b in ends) - columns["zero"],
        path=tuple(None if points is None else path_through(points, closed=closed)
                   for points, closed in (joint.path_points() for joint in joints)),
        collide=_flags(joint.collide for joint in joints), **columns)


def _springs(scope: Scope) -> Springs:
    mechanism, springs = scope.mechanism, scope.mechanism.springs
    rows = [spring.columns(scope) for spring in springs]
    kinds = tuple(spring.facts for spring in springs)
    laws = tuple(law_of(spring, tuple(mechanism.tables), mechanism.functions)
                 for spring in springs)
    setters = _setters(mechanism, "springs", "stiffness")
    return Springs(
        name=_names(springs), kind=kinds, straight=_flags(kind.straight for kind in kinds),
        stiffness=_floats(_slope(law, row) if spring.stiffness is None else spring.stiffness
                          for spring, law, row in zip(springs, laws, rows, strict=True)),
        damping=_floats(0.0 if law else spring.damping
                        for spring, law in zip(springs, laws, strict=True)),
        drive=_ints(setters.get(spring.name, NONE) for spring in springs), law=laws,
        **columns_of(rows, SPRING_COLUMNS))


def _setters(mechanism: Mechanism, among: str, gives: str) -> dict[str, int]:
    """Numbers of the drives that set something of elements of a list, by their names."""
    return {drive.target[1]: i for i, drive in enumerate(mechanism.drives)
            if drive.kind.gives == gives and drive.kind.target.among == among}


def _slope(law: SpringLaw | None, row: Mapping[str, float]) -> float:
    """How stiff a spring with a law is at t = 0."""
    assert law is not None  # what has no stiffness has one
    start, rest = row["start"], row["rest"]
    stretch, near = start - rest, 1e-6 * max(abs(start), abs(rest), 1e-3)
    slope = float(law.slopes(np.array([stretch - near, stretch + near]))[0])
    return max(slope, 0.0) if math.isfinite(slope) else 0.0


def _tendons(scope: Scope) -> Tendons:
    mechanism, names, tendons = scope.mechanism, scope.names, scope.mechanism.tendons
    guides = [guide for tendon in tendons for guide in tendon.path]
    first = np.cumsum([0, *(len(tendon.path) for tendon in tendons)], dtype=np.int64)
    pulls, setters = (_setters(mechanism, "tendons", gives) for gives in ("tension", "stiffness"))
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


def _drives(scope: Scope) -> Drives:
    drives = scope.mechanism.drives
    kinds = tuple(drive.kind for drive in drives)
    targets = [drive.target for drive in drives]
    return Drives(
        name=_names(drives), kind=kinds, floor=_floats(kind.floor for kind in kinds),
        target=_ints(scope.number(reference.among, name) for reference, name in targets),
        **columns_of([drive.columns() for drive in drives], DRIVE_COLUMNS))


def compile_lines(scope: Scope, drives: Drives) -> Lines:
    """The lines of a mechanism whose references are right."""
    lines = scope.mechanism.lines
    chambers = [chamber.columns(scope) for line in lines for chamber in line.chambers]
    volume = _floats(line.volume_at(scope.world) for line in lines)
    given = {int(drives.target[i]): i for i in drives.giving("pressure").tolist()
             if drives.resistance[i] == 0.0}

    return Lines(
        name=_names(lines),
        first=np.cumsum([0, *(len(line.chambers) for line in lines)], dtype=np.int64),
        **columns_of(chambers, CHAMBER_COLUMNS), volume=volume,
        compliance=_floats(line.compliance(v) for line, v in zip(lines, volume, strict=True)),
        gas=_floats(NAN if line.gas is None else line.gas for line in lines),
        pressure=_floats(line.pressure for line in lines),
        least=_floats(line.least for line in lines),
        most=_floats(math.inf if line.relief is None else line.relief for line in lines),
        drive=_ints(given.get(i, NONE) for i in range(len(lines))))


def compile_valves(scope: Scope, drives: Drives) -> Valves:
    """The valves of a mechanism whose references are right."""
    valves, names = scope.mechanism.valves, scope.names
    setters = {int(drives.target[i]): i for i in drives.giving("opening").tolist()}
    return Valves(
        name=_names(valves),
        lines=_ints(([NONE if line is None else names.line[line] for line in (valve.a, valve.b)]
                     for valve in valves), 2),
        resistance=_floats(valve.resistance for valve in valves),
        orifice=_floats(valve.orifice for valve in valves),
        one_way=_flags(valve.one_way for valve in valves),
        drive=_ints(setters.get(i, NONE) for i in range(len(valves))))
