"""The model as flat tables for the compiled step: one row an element, bodies in pymunk's order."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.contact_rules import Filters
from sandbox.engine.cord_tables import CordTables, cord_tables
from sandbox.engine.fluid_tables import Circuits, make_circuits
from sandbox.engine.law_tables import LawTables, law_tables
from sandbox.engine.lemke import MOST
from sandbox.engine.load_tables import ROWS, LoadTables, load_tables
from sandbox.engine.placed import PlacedBodies, Rows, place_bodies
from sandbox.engine.plan import Pattern, make_pattern
from sandbox.engine.records import (
    ACTION,
    ACTION_RESULT,
    ACTION_STATE,
    DAMPED,
    DISTANCE,
    ELASTIC,
    FLANK,
    GEAR,
    GROOVE,
    JOINT,
    JOINT_RESULT,
    JOINT_STATE,
    LIMIT,
    LIMIT_STATE,
    LINE,
    MOTOR,
    MOTOR_STATE,
    PACED,
    PLACED,
    POINT,
    RACK,
    RANGE,
    ROLL,
    RUB_RESULT,
    SLIP_RESULT,
    SLIP_STATE,
    SPRING,
    SPRING_RESULT,
    SPRING_STATE,
    SPRUNG,
    STIFF,
    STOP,
    TIE_RESULT,
)
from sandbox.engine.rub_tables import rub_state, rub_table
from sandbox.engine.state import BODY, BOUND, IMPACT, TOUCH, Constants, Result, State
from sandbox.engine.stiffness import stiff_servos, too_stiff
from sandbox.engine.tie_tables import room_for_breaks, tie_state, tie_table
from sandbox.engine.wheel_fields import wheel_fields
from sandbox.kinds.elements import Keeps
from sandbox.model.model import Model
from sandbox.numeric import Array, Flags, Integers, Records

KEEPS: dict[Keeps, int] = {
    "point": POINT, "groove": GROOVE, "distance": DISTANCE, "range": RANGE, "gear": GEAR,
    "rack": RACK, "roll": ROLL}
"""How compiled code tells apart what joints keep."""
WORKSPACE = ("found", "order", "rows", "columns", "reached", "delassus", "system", "chosen",
             "tableau", "basis")
"""Fields of a :class:`Result` that have the room's size, and that nothing is left in by a step."""


class Tables(NamedTuple):
    """All arrays of a run but those of samples."""

    constants: Constants
    state: State
    result: Result


class ShapeTables(NamedTuple):
    """What contacts follow."""

    shapes: Records
    """SHAPE, [nz], in the order of their collision types."""
    faces: Records
    """FACE, of shapes that are pieces of an outline."""
    vertices: Array
    """Corners of the shapes' cores, from the centres of mass [m], [n, 2]."""
    spans: Records
    """SPAN, of shapes that are curves."""


class Room(NamedTuple):
    """How much there is room for in one step."""

    contacts: int
    """Points in which shapes are near one another."""
    rows: int
    """Bounded rows that carry something."""


def make_tables(
    model: Model, h: float, order: Integers, body: Array, velocity: Array, filters: Filters,
    shapes: ShapeTables, room: Room,
) -> Tables:
    """Tables for all elements of ``model``.

    Args:
        model: the mechanism.
        h: the step [s].
        order: the model's numbers of the bodies in pymunk's order, [nb].
        body: the memory that pymunk fills with poses and velocities, [nb, 6].
        velocity: the memory that it takes velocities from, [nb, 3].
        filters: which bodies may touch, and how.
        shapes: those of the contacts.
        room: for contacts and rows.
    """
    places = place_bodies(model, order)
    rows = Rows()
    motors, motor_of = _motor_table(places, h)
    joints = _joint_table(places, rows)
    rigid, stiff = len(rows.bodies), too_stiff(model, h)
    laws = law_tables(model)
    actions = _action_table(places, motor_of)
    springs, rests = _spring_table(places, stiff, laws, rows)
    cords = cord_tables(places, h, rows)
    limits = _limit_table(places)
    rubs, sums = rub_table(joints, model, len(places.inverse_mass) + 2 * len(cords.slips))
    circuits = make_circuits(model, h, places.number)
    joined = circuits.add_rows(rows.add)
    loads = load_tables(places, laws, rows)
    pattern = make_pattern(rows.bodies, places.inverse_mass, rigid, slips=len(cords.slips),
                           sums=[*cords.sums, *sums], joined=joined)
    cords.slips["row"] = pattern.hubs[cords.slips["slide"], 0]
    circuits.valves["slot"][circuits.between] = pattern.joined
    _place_rows(pattern, (joints, ROWS), (springs, ("row",)),
                (cords.constants, ("row",)), (circuits.fluids, ("row",)), (loads.loaded, ROWS))
    constants = Constants(
        h, np.array(model.mechanism.gravity, dtype=float), places.inverse_mass,
        _body_table(model, order), np.flatnonzero(model.bodies.scheduled[order]), actions, springs,
        cords.constants, cords.guides, cords.slips, model.tendons.wheels, joints, limits,
        motors, rubs, *circuits[:4], *loads, tie_table(model, springs, cords.constants),
        *shapes, laws.steps, laws.curves, laws.knots,
        *pair_tables(filters, order), pattern.starts, pattern.below, pattern.updates,
        pattern.entry_row, pattern.entry_body,
        pattern.pairs, pattern.direct, pattern.body_starts, pattern.body_entries,
        pattern.branch_starts, pattern.branches, pattern.hubs)
    state = State(
        body, np.zeros(len(actions), ACTION_STATE), _spring_state(rests), cords.state,
        cords.guide_state, np.zeros(len(cords.slips), SLIP_STATE), _joint_state(joints),
        np.zeros(len(limits), LIMIT_STATE), _motor_state(motors), rub_state(rubs, model),
        *circuits.states(), loads.states(), np.zeros(4, dtype=np.int64), tie_state(model),
        room_for_breaks(model), np.zeros(_impacts(room), IMPACT), np.zeros(room.contacts, TOUCH),
        np.zeros(2, dtype=np.int64),
        np.full(len(model.drives.name), np.nan), np.zeros(6, dtype=np.int64))
    result = _results(places, constants, pattern, cords, circuits, laws, loads, velocity, room)
    return Tables(constants, state, result)


def _place_rows(pattern: Pattern, *tables: tuple[Records, tuple[str, ...]]) -> None:
    """Put for the numbers of rows, in some fields of tables, those of their unknowns."""
    for table, names in tables:
        for name in names:
            table[name] = np.where(table[name] < 0, -1, pattern.place[table[name]]
                                   if len(pattern.place) else -1)


def enlarged(tables: Tables, room: Room) -> Tables:
    """The same with more room; what is known of the last step's contacts is kept."""
    state, result = tables.state, tables.result
    touches = np.zeros(room.contacts, TOUCH)
    touches[:len(state.touches)] = state.touches
    return tables._replace(
        state=state._replace(touches=touches, impacts=np.zeros(_impacts(room), IMPACT)),
        result=result._replace(**_workspace(room, result.unknowns.shape[1])))


def _impacts(room: Room) -> int:
    """For how many impacts there is room, those of a step at least."""
    return max(1024, 2 * room.contacts)


def _workspace(room: Room, unknowns: int) -> dict[str, Any]:
    """The fields :data:`WORKSPACE` of a :class:`Result`."""
    pivoted = min(room.rows, MOST)
    return {
        "found": np.zeros(room.contacts, TOUCH), "order": np.zeros(room.contacts, dtype=np.int64),
        "rows": np.zeros(room.rows, BOUND), "columns": np.zeros((room.rows, unknowns)),
        "reached": np.zeros((room.rows, max(unknowns, 1)), dtype=np.int64),
        "delassus": np.zeros((room.rows, room.rows)),
        "system": np.zeros((room.rows, room.rows + 1)),
        "chosen": np.zeros(room.rows, dtype=np.int64),
        "tableau": np.zeros((2 * pivoted, 2 * pivoted + 2)),
        "basis": np.zeros((3, 2 * pivoted + 2), dtype=np.int64)}


def _body_table(model: Model, order: Integers) -> Records:
    table = np.zeros(len(order), BODY)
    table["number"] = order
    table["x"], table["y"] = model.bodies.centre[order].T
    return table


def _results(
    places: PlacedBodies, constants: Constants, pattern: Pattern, cords: CordTables,
    circuits: Circuits, laws: LawTables, loads: LoadTables, velocity: Array, room: Room,
) -> Result:
    count, unknowns = len(constants.inverse_mass), len(pattern.starts) - 1
    result = Result(
        velocity, velocity.copy(), np.zeros((count, 3)), np.zeros((count, 3)),
        np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 3)), np.zeros((count, 2)),
        np.zeros(len(constants.actions), ACTION_RESULT),
        _spring_results(constants.springs, places), cords.result,
        cords.guide_result, np.zeros(len(constants.slips), SLIP_RESULT),
        np.zeros(len(constants.joints), JOINT_RESULT), np.zeros(len(constants.rubs), RUB_RESULT),
        *circuits.results(), *loads.results(), np.zeros((3, 4)),
        np.zeros(len(constants.ties), TIE_RESULT), np.zeros(count), laws.stack, laws.read,
        np.zeros((2, len(pattern.entry_row), 3)), np.zeros(len(pattern.below) + unknowns),
        np.zeros((5, unknowns)), **_workspace(room, unknowns))
    for body in np.flatnonzero(pattern.hubs[:count, 0] >= 0):  # they stand in the matrix with -M
        mass, inertia = 1 / constants.inverse_mass[body]
        result.unknowns[1][pattern.hubs[body]] = -mass, -mass, -inertia
    result.unknowns[1][constants.slips["row"]] = -cords.drag
    return result


def pair_tables(filters: Filters, order: Integers) -> tuple[Array, Array, Array]:
    """Friction, static and restitution of all pairs of bodies in pymunk's order, [nb, nb] each.

    Friction is negative where two bodies may not touch.
    """
    pairs = np.ix_(order, order)
    return (np.where(filters.allowed, filters.friction, -1.0)[pairs].copy(),
            filters.static[pairs].copy(), filters.restitution[pairs].copy())


def _table(rows: list[dict[str, Any]], record: np.dtype[Any]) -> Records:
    table = np.zeros(len(rows), dtype=record)
    for row, values in zip(table, rows, strict=True):
        for key, value in values.items():
            row[key] = value
    return table


def _motor_table(places: PlacedBodies, h: float) -> tuple[Records, dict[int, int]]:
    """Motors and brakes, and the row of each by the drive's number."""
    drives, joints = places.model.drives, places.model.joints
    stiff = stiff_servos(places.model, h)
    rows: list[dict[str, Any]] = []
    found: dict[int, int] = {}
    for i, kind in enumerate(drives.kind):
        if kind.limited:
            joint = int(drives.target[i])
            a, b = places.number[joints.bodies[joint]]
            found[i] = len(rows)
            line = kind.gives == "push"
            law = PACED if not kind.places else PLACED if np.isnan(drives.stiffness[i]) else SPRUNG
            rows.append({
                "drive": i, "a": a, "b": b, "sense": 1.0 if line else joints.sense[joint],
                "most": drives.most[i], "slope": drives.slope[i],
                "tie": places.model.ties.joint[joint], "law": law, "line": joint if line else -1,
                "k": drives.stiffness[i], "c": drives.damping[i], "stiff": stiff[i],
                "fastest": drives.fastest[i], "zero": 0.0 if line else joints.zero[joint]})
    return _table(rows, MOTOR), found


def _motor_state(motors: Records) -> Records:
    state = np.zeros(len(motors), MOTOR_STATE)
    state["target"] = math.nan
    return state


def _action_table(places: PlacedBodies, motors: dict[int, int]) -> Records:
    model, number = places.model, places.number
    drives, joints = model.drives, model.joints
    rows: list[dict[str, Any]] = []
    for i in drives.giving("force", "torque", "push", "surface").tolist():
        target = int(drives.target[i])
        row: dict[str, Any] = {"drive": i, "motor": motors.get(i, -1), "tie": -1, "line": -1}
        if drives.kind[i].gives == "surface":
            rows.append(row | {"a": number[target], "b": -1, "runs": 1, "sense": drives.sense[i]})
            continue
        if drives.kind[i].gives == "force":
            x, y = places.local(target, drives.at[i])
            dx, dy = drives.direction[i]
            rows.append(row | {"a": number[target], "b": -1, "x": x, "y": y, "dx": dx, "dy": dy,
                               "turning": drives.turning[i]})
            continue
        a, b = number[joints.bodies[target]]
        line = drives.kind[i].gives == "push"
        rows.append(row | {"a": a, "b": b, "line": target if line else -1,
                           "sense": 1.0 if line else joints.sense[target],
                           "tie": model.ties.joint[target]})
    return _table(rows, ACTION)


def _joint_table(places: PlacedBodies, rows: Rows) -> Records:
    model, number = places.model, places.number
    joints, poses = model.joints, model.bodies.pose
    table: list[dict[str, Any]] = []
    for i, kind in enumerate(joints.kind):
        bodies = joints.bodies[i].tolist()
        a, b = number[bodies].tolist()
        start = joints.groove[i, 0] if kind.keeps == "groove" else joints.anchor[i, 0]
        (ax, ay), (bx, by) = (places.local(bodies[0], start),
                              places.local(bodies[1], joints.anchor[i, 1]))
        row: dict[str, Any] = {
            "keeps": KEEPS[kind.keeps], "a": a, "ax": ax, "ay": ay, "b": b, "bx": bx, "by": by,
            "row": -1, "row_y": -1, "row_turn": -1,
            "turn": poses[bodies[1], 2] - poses[bodies[0], 2], "hinge": joints.angle[i],
            "stopped": np.isfinite(joints.stops[i]).all(), "sense": joints.sense[i],
            "zero": joints.zero[i], "tie": model.ties.joint[i], "line": kind.line}
        if kind.keeps == "groove":
            along = joints.groove[i, 1] - joints.groove[i, 0]
            row["gx"], row["gy"] = along / math.hypot(*along)
            row["reach"] = math.hypot(*along)
        if kind.keeps == "distance":
            row["reach"] = joints.reach[i, 0]
        row |= wheel_fields(model, i)
        if places.inverse_mass[[a, b]].any():
            row["entry"] = rows.entries
            if kind.keeps != "range" and not joints.play[i] > 0:
                row["row"], _ = rows.add(a, b)
            if kind.keeps in ("point", "roll"):
                row["row_y"], _ = rows.add(a, b)
            if not joints.turns[i]:
                row["row_turn"], _ = rows.add(a, b)
        table.append(row)
    return _table(table, JOINT)


def _joint_state(joints: Records) -> Records:
    state = np.zeros(len(joints), JOINT_STATE)
    state["flank"] = 1.0
    return state


def _limit_table(places: PlacedBodies) -> Records:
    joints = places.model.joints
    rows: list[dict[str, Any]] = []
    for i, kind in enumerate(joints.kind):
        if not places.inverse_mass[places.number[joints.bodies[i]]].any():
            continue
        if np.isfinite(joints.stops[i]).all():
            low, high = sorted(joints.sense[i] * (joints.stops[i] + joints.zero[i]))
            rows += _both(i, STOP, low, high)
        if kind.keeps == "range":
            rows += _both(i, LINE, *joints.reach[i])
        if kind.keeps == "groove":
            rows += _both(i, LINE, 0.0, math.hypot(*(joints.groove[i, 1] - joints.groove[i, 0])))
        if joints.play[i] > 0:
            play = joints.play[i] * math.cos(joints.pressure[i]) / 2
            rows += [{"joint": i, "what": FLANK, "side": side, "bound": -play}
                     for side in (1.0, -1.0)]
    return _table(rows, LIMIT)


def _both(joint: int, what: int, low: float, high: float) -> list[dict[str, Any]]:
    return [{"joint": joint, "what": what, "side": side, "bound": bound}
            for side, bound in ((1.0, low), (-1.0, high)) if math.isfinite(bound)
            and not (what == LINE and side > 0 and bound <= 0.0 and high == math.inf)]


def _spring_table(
    places: PlacedBodies, stiff: Flags, laws: LawTables, rows: Rows,
) -> tuple[Records, list[float]]:
    """Rotary springs, straight springs, damping of hinges; their coordinates at rest."""
    model, number, inverse = places.model, places.number, places.inverse_mass
    springs, joints, ties = model.springs, model.joints, model.ties
    table: list[dict[str, Any]] = []
    rests: list[float] = []
    for i in np.argsort(springs.straight, kind="stable").tolist():
        row: dict[str, Any] = {
            "number": i, "joint": -1, "drive": springs.drive[i], "k": springs.stiffness[i],
            "sense": 1.0, "row": -1, "tie": ties.spring[i], "hinge_tie": -1, **laws.of(i)}
        if springs.straight[i]:
            bodies, rest, c = springs.bodies[i].tolist(), springs.rest[i], springs.damping[i]
            (ax, ay), (bx, by) = (
                places.local(body, springs.anchor[i, n]) for n, body in enumerate(bodies))
            row |= {"ax": ax, "ay": ay, "bx": bx, "by": by, "c": c}
        else:  # its damper is that of the hinge
            joint = int(springs.joint[i])
            bodies, sense, c = joints.bodies[joint].tolist(), joints.sense[joint], 0.0
            rest = sense * (springs.rest[i] + joints.zero[joint])
            row |= {"joint": joint, "turning": 1, "sense": sense, "hinge_tie": ties.joint[joint]}
        row["a"], row["b"] = a, b = number[bodies].tolist()
        row["kind"] = STIFF if stiff[i] else DAMPED if c > 0 else ELASTIC
        if (row["kind"] != ELASTIC or springs.law[i]) and inverse[[a, b]].any():
            row["row"], row["entry"] = rows.add(a, b)
        table.append(row)
        rests.append(rest)
    for joint in joints.hinges.tolist():
        a, b = number[joints.bodies[joint]].tolist()
        if model.hinge_damping[joint] > 0 and inverse[[a, b]].any():
            first, entry = rows.add(a, b)
            table.append({"number": -1, "joint": joint, "turning": 1, "kind": DAMPED, "drive": -1,
                          "a": a, "b": b, "c": model.hinge_damping[joint], "sense": 1.0,
                          "row": first, "entry": entry, "code": -1, "tie": -1,
                          "hinge_tie": ties.joint[joint]})
            rests.append(0.0)
    return _table(table, SPRING), rests


def _spring_state(rests: list[float]) -> Records:
    state = np.zeros(len(rests), SPRING_STATE)
    state["rest"] = rests
    return state


def _spring_results(springs: Records, places: PlacedBodies) -> Records:
    """Lengths of straight springs at t = 0, which are read before the first step."""
    results = np.zeros(len(springs), SPRING_RESULT)
    straight = springs["turning"] == 0
    results["way"][straight] = places.model.springs.start[springs["number"][straight]]
    return results
