"""The mechanism as flat tables for the compiled forces: one row an element, bodies by number."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.engine.forces import ACTION, DAMPER, SPRING, damper_blocks
from sandbox.engine.network import (
    ELASTIC,
    NODE,
    PULL,
    SOFT,
    SPAN,
    TENDON,
    elimination,
    measure,
)
from sandbox.scene.elements.drives import (
    BrakeDrive,
    ForceDrive,
    MotorDrive,
    PullDrive,
    StiffnessDrive,
    TorqueDrive,
)
from sandbox.scene.elements.joints import Pin
from sandbox.scene.elements.springs import LinearSpring, RotarySpring
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.geometry import MassProperties, joint_angle_sign, pose_of, to_world
from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]
Records = NDArray[Any]


@dataclass
class Tables:
    """Arguments of :func:`sandbox.engine.forces.apply_forces`, and where each element went.

    Body numbers count in ``order`` (as pymunk lists them); all points are
    relative to centres of mass.
    """

    inverse_mass: Array
    """1 / mass and 1 / inertia, shape [nb, 2]; 0 for bodies that do not move freely."""
    actions: Records
    springs: Records
    dampers: Records
    blocks: Array
    spans: Records
    nodes: Records
    rows: NDArray[np.int64]
    pairs: NDArray[np.int64]
    starts: NDArray[np.int64]
    columns: NDArray[np.int64]
    work: Array
    held: Array
    linear: list[int] = field(default_factory=list)
    """Mechanism numbers of the springs in ``springs``."""

    def arguments(self) -> tuple[Any, ...]:
        """What follows ``drive`` in the call of ``apply_forces``."""
        return (
            self.inverse_mass, self.held, self.actions, self.springs, self.dampers, self.blocks,
            self.spans, self.nodes, self.rows, self.pairs, self.starts, self.columns, self.work,
        )


@dataclass
class _Places:
    """Where bodies are: number in pymunk's order, centre of mass, pose at t = 0."""

    mechanism: Mechanism
    number: dict[str, int]
    centre: dict[str, tuple[float, float]]

    def local(self, body: str, point: tuple[float, float]) -> tuple[float, float]:
        centre = self.centre[body]
        return point[0] - centre[0], point[1] - centre[1]


def make_tables(
    mechanism: Mechanism, h: float, number: dict[str, int], mass: dict[str, MassProperties],
    motors: Mapping[str, int],
) -> Tables:
    """Tables for all drives, linear springs, damped hinges and tendons of ``mechanism``.

    ``motors`` are the addresses of the impulses of motor and brake drives, by name.
    """
    count = len(number)
    inverse_mass = np.zeros((count, 2))
    for name, properties in mass.items():
        inverse_mass[number[name]] = 1 / properties.mass, 1 / properties.inertia
    centre = {name: mass[name].centre if name in mass else (0.0, 0.0) for name in number}
    places = _Places(mechanism, number, centre)
    dampers, blocks = _damper_table(places, h, inverse_mass[:, 1])
    spans, nodes = _tendon_table(places, h, inverse_mass)
    rows, pairs, starts, columns = _factor_plan(spans, nodes, inverse_mass)
    springs, linear = _spring_table(places)
    return Tables(
        inverse_mass, _action_table(places, motors), springs, dampers, blocks, spans, nodes,
        rows, pairs, starts, columns, np.zeros((4, max(len(columns), len(rows), 1))),
        np.zeros((count, 3)), linear,
    )


def _action_table(places: _Places, motors: Mapping[str, int]) -> Records:
    rows: list[dict[str, Any]] = []
    number = places.number
    pins = {joint.name: joint for joint in places.mechanism.joints}
    rotary = {spring.name: (k, spring) for k, spring in enumerate(places.mechanism.springs)
              if isinstance(spring, RotarySpring)}
    for i, drive in enumerate(places.mechanism.drives):
        if isinstance(drive, ForceDrive):
            x, y = places.local(drive.body, drive.at)
            dx, dy = np.array(drive.direction) / np.hypot(*drive.direction)
            rows.append({"drive": i, "a": number[drive.body], "b": -1, "x": x, "y": y,
                         "dx": dx, "dy": dy, "turns": drive.frame == "body", "spring": -1})
            continue
        row: dict[str, Any] = {"drive": i, "spring": -1}
        if isinstance(drive, TorqueDrive | MotorDrive | BrakeDrive):
            pin = pins[drive.joint]
            row["motor"] = motors.get(drive.name, 0)
        elif isinstance(drive, StiffnessDrive) and drive.spring in rotary:
            row["spring"], spring = rotary[drive.spring]
            pin = pins[spring.joint]
        else:
            continue
        assert isinstance(pin, Pin)  # references are checked when a scene is read
        row |= {"a": number[pin.a], "b": number[pin.b], "sign": joint_angle_sign(pin)}
        if row["spring"] >= 0:
            row["rest"] = row["sign"] * (spring.rest_angle + pin.zero)
        rows.append(row)
    table = np.zeros(len(rows), dtype=ACTION)
    for record, values in zip(table, rows, strict=True):
        for key, value in values.items():
            record[key] = value
    return table


def _spring_table(places: _Places) -> tuple[Records, list[int]]:
    springs = [(i, s) for i, s in enumerate(places.mechanism.springs)
               if isinstance(s, LinearSpring)]
    damped = [name for _, s in springs if s.damping for name in (s.a, s.b)]
    table = np.zeros(len(springs), dtype=SPRING)
    setters = {drive.spring: i for i, drive in enumerate(places.mechanism.drives)
               if isinstance(drive, StiffnessDrive)}
    bodies = {body.name: body for body in places.mechanism.bodies}
    for row, (_, spring) in zip(table, springs, strict=True):
        ends = [to_world(pose_of(bodies[name]), point)
                for name, point in ((spring.a, spring.on_a), (spring.b, spring.on_b))]
        length = float(np.hypot(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1]))
        row["a"], row["b"] = places.number[spring.a], places.number[spring.b]
        row["ax"], row["ay"] = places.local(spring.a, spring.on_a)
        row["bx"], row["by"] = places.local(spring.b, spring.on_b)
        row["k"], row["c"] = spring.stiffness, spring.damping
        row["drive"] = setters.get(spring.name, -1)
        row["rest"] = length if spring.rest_length is None else spring.rest_length
        row["length"] = length
        # dampers that share a body answer together: as many as meet on the busier one
        row["share"] = max(1, damped.count(spring.a), damped.count(spring.b))
    return table, [i for i, _ in springs]


def _damper_table(places: _Places, h: float, inverse_inertia: Array) -> tuple[Records, Array]:
    pins = {joint.name: joint for joint in places.mechanism.joints if isinstance(joint, Pin)}
    strength = {name: joint.damping for name, joint in pins.items()}
    for spring in places.mechanism.springs:
        if isinstance(spring, RotarySpring):
            strength[spring.joint] += spring.damping
    joints = [joint.name for joint in places.mechanism.joints]
    damped = [
        (places.number[pins[name].a], places.number[pins[name].b], c, joints.index(name))
        for name, c in strength.items() if c > 0
    ]
    clusters = _clusters([{body for body in m[:2] if inverse_inertia[body]} for m in damped])
    table = np.zeros(len(damped), dtype=DAMPER)
    blocks: list[Array] = [np.zeros(0)]
    first = offset = 0
    for cluster in clusters:
        members = [damped[i] for i in cluster]
        block = damper_blocks(h, [m[:2] for m in members], [m[2] for m in members],
                              inverse_inertia)
        for i, (a, b, c, joint) in enumerate(members):
            row = table[first + i]
            row["a"], row["b"], row["c"], row["joint"] = a, b, c, joint
            row["block"], row["first"], row["size"] = offset + i * len(members), first, len(members)
        first += len(members)
        offset += len(block)
        blocks.append(block)
    return table, np.concatenate(blocks)


def _clusters(sets: list[set[int]]) -> list[list[int]]:
    """Indices of sets, gathered where they share members directly or through others."""
    clusters: list[tuple[set[int], list[int]]] = []
    for i, members in enumerate(sets):
        union, indices = set(members), [i]
        rest = []
        for other, others in clusters:
            if other & union:
                union |= other
                indices = others + indices
            else:
                rest.append((other, others))
        clusters = [*rest, (union, sorted(indices))]
    return [indices for _, indices in clusters]


def _tendon_table(places: _Places, h: float, inverse_mass: Array) -> tuple[Records, Records]:
    mechanism = places.mechanism
    pulls: dict[str, int] = {
        drive.tendon: i for i, drive in enumerate(mechanism.drives) if isinstance(drive, PullDrive)
    }
    nodes: list[tuple[Any, ...]] = []
    spans = np.zeros(len(mechanism.tendons), dtype=SPAN)
    for row, tendon in zip(spans, mechanism.tendons, strict=True):
        row["first"] = len(nodes)
        for guide in tendon.guides:
            sign = -1.0 if guide.side == "left" else 1.0
            nodes.append((places.number[guide.body], *places.local(guide.body, guide.at),
                          sign * guide.radius, 0, 0, 0, 0, 0))
        row["last"] = len(nodes)
        row["kind"] = PULL if tendon.name in pulls else TENDON
        row["drive"] = pulls.get(tendon.name, -1)
        row["k"], row["c"], row["active"], row["row"] = tendon.stiffness, tendon.damping, 1, -1
    table = np.array(nodes, dtype=NODE)
    pose = np.zeros((len(places.number), 3))
    for body in mechanism.bodies:
        pose[places.number[body.name]] = (
            *to_world(pose_of(body), places.centre[body.name]), body.angle)
    for row, tendon in zip(spans, mechanism.tendons, strict=True):
        row["length"] = measure.py_func(row, table, pose, True)
        rest = row["length"] if tendon.rest_length is None else tendon.rest_length
        row["rest"] = rest + tendon.slack
        row["free"] = _largest_response(row, table, inverse_mass)
        soft = row["k"] < RIGID and h * h * row["k"] * row["free"] <= SOFT
        if row["kind"] == TENDON and soft:
            row["kind"] = ELASTIC
    return spans, table


def _largest_response(span: Any, nodes: Records, inverse_mass: Array) -> float:
    """A bound of J M^-1 J^T [1/kg] over all poses: each guide feels at most two pulls."""
    force: dict[int, float] = {}
    moment: dict[int, float] = {}
    for n in range(span["first"], span["last"]):
        pulls = 1.0 if n in (span["first"], span["last"] - 1) else 2.0
        body = int(nodes[n]["body"])
        lever = float(np.hypot(nodes[n]["x"], nodes[n]["y"])) + abs(float(nodes[n]["radius"]))
        force[body] = force.get(body, 0.0) + pulls
        moment[body] = moment.get(body, 0.0) + pulls * lever
    return float(sum(
        inverse_mass[b, 0] * force[b] ** 2 + inverse_mass[b, 1] * moment[b] ** 2 for b in force))


def _factor_plan(
    spans: Records, nodes: Records, inverse_mass: Array,
) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.int64], NDArray[np.int64]]:
    """Order, fill and entry list of the network's matrix (see :func:`network.solve`)."""
    tendons = [e for e, span in enumerate(spans) if span["kind"] == TENDON]
    guides = [
        [n for n in range(spans[e]["first"], spans[e]["last"])
         if inverse_mass[nodes[n]["body"]].any()]
        for e in tendons
    ]
    meets: dict[int, set[int]] = {}
    for i, own in enumerate(guides):
        for n in own:
            meets.setdefault(int(nodes[n]["body"]), set()).add(i)
    groups = [set().union(*(meets[int(nodes[n]["body"])] for n in own)) for own in guides]
    order, columns = elimination(groups)
    starts: list[int] = [0]
    flat: list[int] = []
    pairs: list[tuple[int, int, int]] = []
    for i, row in enumerate(columns):
        for j in [*row, i]:
            slot = len(flat)
            flat.append(j)
            pairs += [(slot, n, m) for n in guides[order[i]] for m in guides[order[j]]
                      if nodes[n]["body"] == nodes[m]["body"]]
        starts.append(len(flat))
    rows = np.array([tendons[i] for i in order], dtype=np.int64)
    return (
        rows, np.array(pairs, dtype=np.int64).reshape(-1, 3),
        np.array(starts, dtype=np.int64), np.array(flat, dtype=np.int64),
    )
