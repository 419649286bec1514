"""From a mechanism to its :class:`sandbox.model.model.Model`: names become numbers, here only."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from sandbox.elements.element import NAMED, RELEASABLES, Vec
from sandbox.elements.joint import Anchors
from sandbox.model.bonds import compile_bonds
from sandbox.model.laws import SpringLaw, law_of
from sandbox.model.loads import compile_loads
from sandbox.model.model import (
    NONE,
    Bodies,
    Chambers,
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
from sandbox.numeric import Integers
from sandbox.scene.geometry import anchors, mass_properties, pose_of, to_body, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import path_through


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
             _lines(scope, drives), _valves(scope),
             compile_loads(mechanism, bodies), drives, compile_bonds(mechanism))
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


def _numbers(elements: Sequence[Any]) -> dict[str, int]:
    return {element.name: i for i, element in enumerate(elements)}


def _names(elements: Sequence[Any]) -> tuple[str, ...]:
    return tuple(element.name for element in elements)


def _floats(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.float64).reshape(-1, *shape)


def _ints(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.int64).reshape(-1, *shape)


def _flags(rows: Iterable[bool]) -> Any:
    return np.array(list(rows), dtype=np.bool_)


def _first(counts: Iterable[int]) -> Integers:
    """Where parts of elements begin that stand side by side, and the end of the last one's."""
    return np.cumsum([0, *counts], dtype=np.int64)


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
    columns = columns_of(Joints, joints, rows)
    kinds = tuple(joint.facts for joint in joints)
    return Joints(
        name=_names(joints), kind=kinds, bodies=_ints(numbers, 2), anchor=_floats(held, 2, 2),
        angle=_flags(kind.angle for kind in kinds),
        start=columns["sense"] * _floats(b.angle - a.angle for a, b in ends) - columns["zero"],
        path=tuple(None if points is None else path_through(points, closed=closed)
                   for points, closed in (joint.path_points() for joint in joints)), **columns)


def _springs(scope: Scope) -> Springs:
    mechanism, springs = scope.mechanism, scope.mechanism.springs
    rows = [spring.columns(scope) for spring in springs]
    kinds = tuple(spring.facts for spring in springs)
    laws = tuple(law_of(spring, tuple(mechanism.tables), mechanism.functions)
                 for spring in springs)
    return Springs(
        name=_names(springs), kind=kinds, straight=_flags(kind.straight for kind in kinds),
        stiffness=_floats(_slope(law, row) if spring.stiffness is None else spring.stiffness
                          for spring, law, row in zip(springs, laws, rows, strict=True)),
        damping=_floats(0.0 if law else spring.damping
                        for spring, law in zip(springs, laws, strict=True)),
        drive=_setters(mechanism, "springs", "stiffness"), law=laws,
        **columns_of(Springs, springs, rows))


def _setters(mechanism: Mechanism, among: str, gives: str) -> Integers:
    """Of each element of a list the drive that gives it something, or -1."""
    drives = {drive.target[1]: i for i, drive in enumerate(mechanism.drives)
              if drive.kind.gives == gives and drive.kind.target.among == among}
    found: Integers = _ints(drives.get(each.name, NONE) for each in getattr(mechanism, among))
    return found


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
    first = _first(len(tendon.path) for tendon in tendons)
    each = list(zip(first.tolist(), tendons, strict=False))
    return Tendons(
        name=_names(tendons), first=first,
        guide_body=_ints(names.body[guide.body] for guide in guides),
        guide_at=_floats((guide.at for guide in guides), 2),
        guide_radius=_floats((-1.0 if guide.side == "left" else 1.0) * guide.radius
                             for guide in guides),
        guide_turns=_ints(
            guide.turns if tendon.closed or 0 < k < len(tendon.path) - 1 else 0
            for tendon in tendons for k, guide in enumerate(tendon.path)),
        grips=_ints(start + k for start, tendon in each for k in tendon.gripping),
        friction=_floats(tendon.guides[k].friction for tendon in tendons for k in tendon.gripping),
        wheels=_ints(start + k for start, tendon in each for k in tendon.lifting),
        drive=_setters(mechanism, "tendons", "tension"),
        stiffener=_setters(mechanism, "tendons", "stiffness"),
        **columns_of(Tendons, tendons))


def _drives(scope: Scope) -> Drives:
    drives = scope.mechanism.drives
    kinds = tuple(drive.kind for drive in drives)
    return Drives(
        name=_names(drives), kind=kinds, floor=_floats(kind.floor for kind in kinds),
        target=_ints(scope.number(reference.among, name)
                     for reference, name in (drive.target for drive in drives)),
        **columns_of(Drives, drives))


def _lines(scope: Scope, drives: Drives) -> Lines:
    lines = scope.mechanism.lines
    chambers = [chamber for line in lines for chamber in line.chambers]
    volume = _floats(line.volume_at(scope.world) for line in lines)
    given = {int(drives.target[i]): i for i in drives.giving("pressure").tolist()
             if drives.resistance[i] == 0.0}
    return Lines(
        name=_names(lines), first=_first(len(line.chambers) for line in lines), volume=volume,
        compliance=_floats(line.compliance(v) for line, v in zip(lines, volume, strict=True)),
        drive=_ints(given.get(i, NONE) for i in range(len(lines))),
        **columns_of(Lines, lines),
        **columns_of(Chambers, chambers, [chamber.columns(scope) for chamber in chambers]))


def _valves(scope: Scope) -> Valves:
    valves, names = scope.mechanism.valves, scope.names
    return Valves(
        name=_names(valves),
        lines=_ints(([NONE if line is None else names.line[line] for line in (valve.a, valve.b)]
                     for valve in valves), 2),
        drive=_setters(scope.mechanism, "valves", "opening"), **columns_of(Valves, valves))
