"""From a mechanism to its :class:`sandbox.model.model.Model`: names become numbers, here only."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import fields
from typing import Any

import numpy as np

from sandbox.elements.element import HELD_ABOVE, NAMED, NO_POINT, RELEASABLE, RELEASABLES
from sandbox.model import model
from sandbox.model.loads import compile_loads
from sandbox.model.model import NONE, Joints, Names, columns_of
from sandbox.model.programs import SpringLaw, law_of
from sandbox.numeric import Integers
from sandbox.scene.geometry import anchors, mass_properties, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.outlines.curves import path_through
from sandbox.values.signals import values


def compile_mechanism(mechanism: Mechanism) -> model.Model:
    """The model of a mechanism whose references are right."""
    names = Names(*({element.name: i for i, element in enumerate(kind)} for kind in (
        mechanism.bodies, mechanism.joints, mechanism.springs, mechanism.tendons,
        mechanism.lines, mechanism.valves, mechanism.drives)))
    bodies, joints = _bodies(mechanism), _joints(mechanism, names)
    drives = _drives(mechanism, names)
    parts = (bodies, joints, _springs(mechanism, names, joints), _tendons(mechanism, names),
             _lines(mechanism, names, joints, drives), _valves(mechanism, names),
             compile_loads(mechanism, bodies), drives, _bonds(mechanism))
    for part in parts:
        for field in fields(part):
            if isinstance(array := getattr(part, field.name), np.ndarray):
                array.setflags(write=False)
    return model.Model(mechanism, names, *parts)


def _floats(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.float64).reshape(-1, *shape)


def _ints(rows: Iterable[Any], *shape: int) -> Any:
    return np.array(list(rows), dtype=np.int64).reshape(-1, *shape)


def _flags(rows: Iterable[bool]) -> Any:
    return np.array(list(rows), dtype=np.bool_)


def _first(counts: Iterable[int]) -> Integers:
    """Where parts of elements begin that stand side by side, and the end of the last one's."""
    return np.cumsum([0, *counts], dtype=np.int64)


def _setters(mechanism: Mechanism, among: str, gives: str) -> Integers:
    """Of each element of a list the drive that gives it something, or -1."""
    drives = {drive.target[1]: i for i, drive in enumerate(mechanism.drives)
              if drive.kind.gives == gives and drive.kind.target.among == among}
    found: Integers = _ints(drives.get(each.name, NONE) for each in getattr(mechanism, among))
    return found


def _bodies(mechanism: Mechanism) -> model.Bodies:
    bodies = mechanism.bodies
    weights = [mass_properties(body) if body.motion == "dynamic" else None for body in bodies]
    motions = [body.motion for body in bodies]
    return model.Bodies(
        free=_flags(motion == "dynamic" for motion in motions),
        fixed=_flags(motion == "fixed" for motion in motions),
        scheduled=_flags(motion not in ("dynamic", "fixed") for motion in motions),
        **columns_of(model.Bodies, bodies), pose=_floats((pose_of(body) for body in bodies), 3),
        velocity=_floats(((*body.velocity, body.angular_velocity) if w else (0.0, 0.0, 0.0)
                          for body, w in zip(bodies, weights, strict=True)), 3),
        centre=_floats((w.centre if w else (0.0, 0.0) for w in weights), 2),
        mass=_floats(w.mass if w else math.inf for w in weights),
        inertia=_floats(w.inertia if w else math.inf for w in weights))


def _joints(mechanism: Mechanism, names: Names) -> Joints:
    joints = mechanism.joints
    numbers = [(names.body[joint.a], names.body[joint.b]) for joint in joints]
    ends = [(mechanism.bodies[a], mechanism.bodies[b]) for a, b in numbers]
    columns = columns_of(Joints, joints, [joint.columns(mechanism) for joint in joints])
    paths = [(getattr(joint, "path", None), getattr(joint, "closed", False)) for joint in joints]
    angle = _flags(joint.facts.angle for joint in joints)
    return Joints(
        bodies=_ints(numbers, 2),
        anchor=_floats((anchors(joint, *pair) for joint, pair in zip(joints, ends, strict=True)),
                       2, 2),
        angle=angle, hinges=np.flatnonzero(angle),
        stopped=np.flatnonzero(np.isfinite(columns["stops"]).all(axis=1)),
        frictional=np.flatnonzero((columns["friction"] > 0) | (columns["coefficient"] > 0)),
        unknowns=_ints(joint.facts.forces for joint in joints) + ~columns["turns"],
        start=columns["sense"] * _floats(b.angle - a.angle for a, b in ends) - columns["zero"],
        path=tuple(points and path_through(points, closed=closed) for points, closed in paths),
        **columns)


def _between(mechanism: Mechanism, names: Names, joints: Joints, elements: Any) -> dict[str, Any]:
    """Columns of elements that act between two points, or about a hinge."""
    rows: list[Any] = []
    for each in elements:
        if hasattr(each, "joint"):
            j = names.joint[each.joint]
            rows.append((j, joints.bodies[j], (NO_POINT, NO_POINT), joints.start[j]))
            continue
        ends = [(names.body[each.a], each.on_a), (names.body[each.b], each.on_b)]
        places = [to_world(pose_of(mechanism.bodies[body]), point) for body, point in ends]
        rows.append((NONE, *zip(*ends, strict=True), math.dist(*places)))
    joint, bodies, anchor, start = zip(*rows, strict=True) if rows else [()] * 4
    return {"joint": _ints(joint), "bodies": _ints(bodies, 2), "anchor": _floats(anchor, 2, 2),
            "start": _floats(start)}


def _springs(mechanism: Mechanism, names: Names, joints: Joints) -> model.Springs:
    springs = mechanism.springs
    between = _between(mechanism, names, joints, springs)
    columns = columns_of(model.Springs, springs)
    columns["rest"] = np.where(np.isnan(columns["rest"]), between["start"], columns["rest"])
    laws = tuple(law_of(spring, tuple(mechanism.tables), mechanism.functions) for spring in springs)
    return model.Springs(
        straight=_flags(spring.facts.straight for spring in springs),
        stiffness=_floats(
            _slope(law, start, rest) if spring.stiffness is None else spring.stiffness
            for spring, law, start, rest in zip(
                springs, laws, between["start"].tolist(), columns["rest"].tolist(), strict=True)),
        damping=_floats(0.0 if law else spring.damping
                        for spring, law in zip(springs, laws, strict=True)),
        drive=_setters(mechanism, "springs", "stiffness"), law=laws, **between, **columns)


def _slope(law: SpringLaw | None, start: float, rest: float) -> float:
    """Stiffness of a spring with a law at t = 0."""
    assert law is not None  # what has no stiffness has one
    stretch, near = start - rest, 1e-6 * max(abs(start), abs(rest), 1e-3)
    slope = float(law.slopes(np.array([stretch - near, stretch + near]))[0])
    return max(slope, 0.0) if math.isfinite(slope) else 0.0


def _tendons(mechanism: Mechanism, names: Names) -> model.Tendons:
    tendons = mechanism.tendons
    guides = [guide for tendon in tendons for guide in tendon.path]
    first = _first(len(tendon.path) for tendon in tendons)
    pieces = np.delete(np.arange(len(guides)), first[1:] - 1)
    each = list(zip(first.tolist(), tendons, strict=False))
    return model.Tendons(
        first=first, guide_body=_ints(names.body[guide.body] for guide in guides),
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
        stiffener=_setters(mechanism, "tendons", "stiffness"), stretch_first=pieces,
        stretch_tendon=np.repeat(np.arange(len(tendons)), np.diff(first) - 1),
        **columns_of(model.Tendons, tendons))


def _drives(mechanism: Mechanism, names: Names) -> model.Drives:
    drives = mechanism.drives
    targets = [(reference.among, name) for reference, name in (drive.target for drive in drives)]
    columns = columns_of(model.Drives, drives)
    columns["most"][np.isnan(columns["most"]) & ~np.isnan(columns["slope"])] = math.inf
    return model.Drives(
        floor=_floats(drive.kind.floor for drive in drives),
        target=_ints(mechanism.releasable.index(name) if among == RELEASABLES
                     else getattr(names, NAMED[among].one)[name] for among, name in targets),
        **columns)


def _lines(mechanism: Mechanism, names: Names, joints: Joints, drives: model.Drives) -> model.Lines:
    lines = mechanism.lines
    chambers = [chamber for line in lines for chamber in line.chambers]
    volume = _floats(line.volume_at(mechanism.world) for line in lines)
    given = {int(drives.target[i]): i for i in drives.giving("pressure").tolist()
             if drives.resistance[i] == 0.0}
    counts = [len(line.chambers) for line in lines]
    return model.Lines(
        first=_first(counts), volume=volume,
        of=np.repeat(np.arange(len(lines)), np.array(counts, dtype=np.int64)),
        compliance=_floats(line.compliance(v) for line, v in zip(lines, volume, strict=True)),
        drive=_ints(given.get(i, NONE) for i in range(len(lines))),
        gain=_floats(chamber.gain for chamber in chambers),
        **columns_of(model.Lines, lines), **_between(mechanism, names, joints, chambers))


def _valves(mechanism: Mechanism, names: Names) -> model.Valves:
    valves = mechanism.valves
    return model.Valves(
        lines=_ints(([NONE if line is None else names.line[line] for line in (valve.a, valve.b)]
                     for valve in valves), 2),
        drive=_setters(mechanism, "valves", "opening"), **columns_of(model.Valves, valves))


def _bonds(mechanism: Mechanism) -> model.Bonds:
    place = {name: number for number, name in enumerate(mechanism.releasable)}
    specs = [each for each in mechanism.holding if each.name in place]
    drives = {drive.target[1]: (i, drive) for i, drive in enumerate(mechanism.drives)
              if drive.kind.gives == "hold"}
    off = {name for name, (_, drive) in drives.items() if values(
        drive.value, np.zeros(1), mechanism.functions)[0] <= HELD_ABOVE}
    joint, spring, tendon = (
        _ints(place.get(each.name, NONE) for each in getattr(mechanism, kind))
        for kind in RELEASABLE)
    return model.Bonds(
        name=tuple(place), joint=joint, spring=spring, tendon=tendon,
        held=_flags(not each.released and each.name not in off for each in specs),
        as_is=_flags(getattr(each, "taken_up", "") == "as_is" for each in specs),
        drive=_ints(drives[each.name][0] if each.name in drives else NONE for each in specs),
        **columns_of(model.Bonds, specs))
