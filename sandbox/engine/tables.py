"""The model as flat tables for the compiled step: one row an element, bodies in pymunk's order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.forces import damper_blocks
from sandbox.engine.network import SOFT, elimination, measure
from sandbox.engine.state import (
    ACTION,
    ACTION_RESULT,
    ACTION_STATE,
    CORD,
    CORD_RESULT,
    CORD_STATE,
    DAMPER,
    DAMPER_RESULT,
    DAMPER_STATE,
    ELASTIC,
    GUIDE,
    GUIDE_RESULT,
    GUIDE_STATE,
    PULL,
    SPRING,
    SPRING_RESULT,
    SPRING_STATE,
    TENDON,
    Constants,
    Result,
    State,
)
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers, Records
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.geometry import to_world


class Tables(NamedTuple):
    """A run's numbers, and which elements of the model the straight springs are."""

    constants: Constants
    state: State
    result: Result
    straight: Integers
    """Numbers, in the model, of the springs in ``constants.springs``."""


@dataclass(frozen=True)
class _PlacedBodies:
    """Where bodies are: their numbers in pymunk's order, what they weigh, poses at t = 0."""

    model: Model
    number: Integers
    """By the model's numbers, [nb]."""
    inverse_mass: Array
    """In pymunk's order, [nb, 2]."""
    pose: Array
    """Of the centres of mass, in pymunk's order, [nb, 3]."""

    def local(self, body: int, point: Array) -> Array:
        """A point of a body's frame seen from its centre of mass [m]."""
        local: Array = point - self.model.bodies.centre[body]
        return local


def _places(model: Model, order: Integers) -> _PlacedBodies:
    bodies = model.bodies
    number = np.argsort(order)
    inverse = np.stack([1 / bodies.mass[order], 1 / bodies.inertia[order]], axis=1)
    pose: Array = np.array([
        (*to_world(tuple(bodies.pose[i]), tuple(bodies.centre[i])), bodies.pose[i, 2])
        for i in order]).reshape(-1, 3)
    return _PlacedBodies(model, number, inverse, pose)


def make_tables(
    model: Model, h: float, order: Integers, motors: Mapping[int, int], body: Array, force: Array,
) -> Tables:
    """Tables for all drives, straight springs, damped hinges and tendons of ``model``.

    Args:
        model: the mechanism.
        h: the step [s].
        order: the model's numbers of the bodies in pymunk's order, [nb].
        motors: addresses of the impulses of motors and brakes, by the drives' numbers.
        body: the memory that pymunk fills with poses and velocities, [nb, 6].
        force: the memory that it takes forces from, [nb, 3].
    """
    places = _places(model, order)
    actions = _action_table(places, motors)
    springs = _spring_table(places)
    dampers, inverse = _damper_table(places, h)
    cords = _cord_table(places, h)
    plan = _factor_plan(cords.constants, cords.guides, places.inverse_mass)
    count = len(order)
    return Tables(
        Constants(h, places.inverse_mass, actions, springs, dampers, inverse, cords.constants,
                  cords.guides, *plan),
        State(body, body[:, 3:].copy(), force, np.zeros((count, 3)),
              np.zeros(len(actions), ACTION_STATE), np.zeros(len(springs), SPRING_STATE),
              np.zeros(len(dampers), DAMPER_STATE), cords.state, cords.guide_state),
        Result(np.zeros((count, 3)), np.zeros(len(actions), ACTION_RESULT),
               _spring_results(places), np.zeros(len(dampers), DAMPER_RESULT), cords.result,
               cords.guide_result, np.zeros((4, max(len(plan.columns), len(plan.rows), 1)))),
        np.flatnonzero(model.springs.straight))


def _table(rows: list[dict[str, Any]], record: np.dtype[Any]) -> Records:
    table = np.zeros(len(rows), dtype=record)
    for row, values in zip(table, rows, strict=True):
        for key, value in values.items():
            row[key] = value
    return table


def _action_table(places: _PlacedBodies, motors: Mapping[int, int]) -> Records:
    model, number = places.model, places.number
    drives, joints, springs = model.drives, model.joints, model.springs
    rows: list[dict[str, Any]] = []
    for i in drives.giving("force", "torque", "stiffness").tolist():
        target = int(drives.target[i])
        row: dict[str, Any] = {"drive": i, "spring": -1}
        match drives.kind[i].gives:
            case "force":
                x, y = places.local(target, drives.at[i])
                dx, dy = drives.direction[i]
                row |= {"a": number[target], "b": -1, "x": x, "y": y, "dx": dx, "dy": dy,
                        "turning": drives.turning[i]}
                rows.append(row)
                continue
            case "torque":
                joint, row["motor"] = target, motors.get(i, 0)
            case _ if springs.straight[target]:
                continue  # a straight spring asks for its stiffness itself
            case _:
                joint, row["spring"] = int(springs.joint[target]), target
        a, b = number[joints.bodies[joint]]
        row |= {"a": a, "b": b, "sense": joints.sense[joint]}
        if row["spring"] >= 0:
            row["rest"] = joints.sense[joint] * (springs.rest[target] + joints.zero[joint])
        rows.append(row)
    return _table(rows, ACTION)


def _spring_table(places: _PlacedBodies) -> Records:
    springs = places.model.springs
    straight = np.flatnonzero(springs.straight)
    damped = [body for i in straight if springs.damping[i] for body in springs.bodies[i].tolist()]
    rows = []
    for i in straight:
        a, b = springs.bodies[i].tolist()
        ax, ay = places.local(a, springs.anchor[i, 0])
        bx, by = places.local(b, springs.anchor[i, 1])
        rows.append({
            "drive": springs.drive[i], "a": places.number[a], "ax": ax, "ay": ay,
            "b": places.number[b], "bx": bx, "by": by, "k": springs.stiffness[i],
            "c": springs.damping[i], "rest": springs.rest[i],
            # dampers that share a body answer together: as many as meet on the busier one
            "sharing": max(1, damped.count(a), damped.count(b))})
    return _table(rows, SPRING)


def _spring_results(places: _PlacedBodies) -> Records:
    """What straight springs have before the first step: their lengths at t = 0."""
    springs = places.model.springs
    results = np.zeros(int(springs.straight.sum()), SPRING_RESULT)
    results["length"] = springs.start[springs.straight]
    return results


def _damper_table(places: _PlacedBodies, h: float) -> tuple[Records, Array]:
    model = places.model
    strength = model.joints.damping.copy()
    rotary = np.flatnonzero(~model.springs.straight)
    np.add.at(strength, model.springs.joint[rotary], model.springs.damping[rotary])
    inverse_inertia = places.inverse_mass[:, 1]
    damped = [(*places.number[model.joints.bodies[joint]].tolist(), float(strength[joint]), joint)
              for joint in model.joints.hinges.tolist() if strength[joint] > 0]
    rows: list[dict[str, Any]] = []
    blocks: list[Array] = [np.zeros(0)]
    first = offset = 0
    for cluster in _clusters([{body for body in m[:2] if inverse_inertia[body]} for m in damped]):
        members = [damped[i] for i in cluster]
        size = len(members)
        block = damper_blocks(h, [(a, b) for a, b, _, _ in members], [m[2] for m in members],
                              inverse_inertia)
        rows += [{"a": a, "b": b, "c": c, "joint": joint, "block": offset + i * size,
                  "first": first, "size": size} for i, (a, b, c, joint) in enumerate(members)]
        first += size
        offset += len(block)
        blocks.append(block)
    return _table(rows, DAMPER), np.concatenate(blocks)


def _clusters(sets: list[set[int]]) -> list[list[int]]:
    """Indices of sets, gathered where they share members directly or through others."""
    clusters: list[tuple[set[int], list[int]]] = []
    for i, members in enumerate(sets):
        union, indices = set(members), [i]
        apart = []
        for other, others in clusters:
            if other & union:
                union |= other
                indices = others + indices
            else:
                apart.append((other, others))
        clusters = [*apart, (union, sorted(indices))]
    return [indices for _, indices in clusters]


class _Cords(NamedTuple):
    constants: Records
    state: Records
    result: Records
    guides: Records
    guide_state: Records
    guide_result: Records


def _cord_table(places: _PlacedBodies, h: float) -> _Cords:
    tendons, count = places.model.tendons, len(places.model.tendons.name)
    size = len(tendons.guide_body)
    guides = np.zeros(size, GUIDE)
    guides["body"] = places.number[tendons.guide_body]
    local = tendons.guide_at - places.model.bodies.centre[tendons.guide_body]
    guides["x"], guides["y"], guides["radius"] = local[:, 0], local[:, 1], tendons.guide_radius
    found = _Cords(np.zeros(count, CORD), np.zeros(count, CORD_STATE), np.zeros(count, CORD_RESULT),
                   guides, np.zeros(size, GUIDE_STATE), np.zeros(size, GUIDE_RESULT))
    found.state["active"] = 1
    for e, (cord, cord_result) in enumerate(zip(found.constants, found.result, strict=True)):
        cord["first"], cord["last"] = tendons.first[e], tendons.first[e + 1]
        cord["drive"], cord["k"], cord["c"] = (
            tendons.drive[e], tendons.stiffness[e], tendons.damping[e])
        cord_result["length"] = measure.py_func(
            cord, guides, found.guide_state, found.guide_result, places.pose, True)
        rest = cord_result["length"] if np.isnan(tendons.rest[e]) else tendons.rest[e]
        cord["rest"] = rest + tendons.slack[e]
        cord["response"] = _largest_response(cord, guides, places.inverse_mass)
        soft = cord["k"] < RIGID and h * h * cord["k"] * cord["response"] <= SOFT
        cord["kind"] = PULL if cord["drive"] >= 0 else ELASTIC if soft else TENDON
    return found


def _largest_response(cord: Any, guides: Records, inverse_mass: Array) -> float:
    """A bound of J M^-1 J^T [1/kg] over all poses: each guide feels at most two pulls."""
    force: dict[int, float] = {}
    moment: dict[int, float] = {}
    for n in range(cord["first"], cord["last"]):
        pulls = 1.0 if n in (cord["first"], cord["last"] - 1) else 2.0
        body = int(guides[n]["body"])
        lever = float(np.hypot(guides[n]["x"], guides[n]["y"])) + abs(float(guides[n]["radius"]))
        force[body] = force.get(body, 0.0) + pulls
        moment[body] = moment.get(body, 0.0) + pulls * lever
    return float(sum(
        inverse_mass[b, 0] * force[b] ** 2 + inverse_mass[b, 1] * moment[b] ** 2 for b in force))


class _Plan(NamedTuple):
    """Order, fill and entry list of the network's matrix, as in :class:`Constants`."""

    rows: Integers
    pairs: Integers
    starts: Integers
    columns: Integers


def _factor_plan(cords: Records, guides: Records, inverse_mass: Array) -> _Plan:
    tendons = [e for e, cord in enumerate(cords) if cord["kind"] == TENDON]
    moved = [
        [n for n in range(cords[e]["first"], cords[e]["last"])
         if inverse_mass[guides[n]["body"]].any()]
        for e in tendons
    ]
    meets: dict[int, set[int]] = {}
    for i, own in enumerate(moved):
        for n in own:
            meets.setdefault(int(guides[n]["body"]), set()).add(i)
    groups = [set().union(*(meets[int(guides[n]["body"])] for n in own)) for own in moved]
    order, columns = elimination(groups)
    starts: list[int] = [0]
    flat: list[int] = []
    pairs: list[tuple[int, int, int]] = []
    for i, row in enumerate(columns):
        for j in [*row, i]:
            slot = len(flat)
            flat.append(j)
            pairs += [(slot, n, m) for n in moved[order[i]] for m in moved[order[j]]
                      if guides[n]["body"] == guides[m]["body"]]
        starts.append(len(flat))
    return _Plan(
        np.array([tendons[i] for i in order], dtype=np.int64),
        np.array(pairs, dtype=np.int64).reshape(-1, 3),
        np.array(starts, dtype=np.int64), np.array(flat, dtype=np.int64))
