"""The model as flat tables for the compiled step: one row an element, bodies in pymunk's order."""

from __future__ import annotations

import math
from typing import Any, NamedTuple, get_args, get_type_hints

import numpy as np

from sandbox.engine.cables import CordTables, cord_tables
from sandbox.engine.fluid_tables import make_circuits
from sandbox.engine.joint_tables import (
    action_table,
    begin_friction,
    dry_friction_table,
    joint_table,
    limit_table,
    motor_table,
    spring_table,
)
from sandbox.engine.law_tables import ROWS, LawTables, law_tables, load_tables
from sandbox.engine.lemke import MOST
from sandbox.engine.paths import add_paths
from sandbox.engine.pile_tables import loose_bodies, pile_bodies, pile_tables
from sandbox.engine.plan import Pattern, Rows, make_pattern, place_bodies
from sandbox.engine.records import NUMBERS
from sandbox.engine.state import BODY, BOUND, IMPACT, PILED, TOUCH, Constants, Result, State
from sandbox.engine.stiffness import too_stiff
from sandbox.engine.ties import room_for_breaks, tie_state, tie_table
from sandbox.engine.world import Filters, Room, ShapeTables
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers, Records

WORKSPACE = ("found", "order", "rows", "columns", "reached", "delassus", "system", "chosen",
             "tableau", "basis", "pile_adjacent", "pile_work", "pile_vectors", "pile_diagonal",
             "pile_lower", "pile_upper", "piled", "pile_jacobian")
"""Fields of a :class:`Result` that have the room's size, and that nothing is left in by a step."""


class Tables(NamedTuple):
    """All arrays of a run but those of samples."""

    constants: Constants
    state: State
    result: Result


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
    motors, motor_of = motor_table(places, h)
    joints = joint_table(places, rows)
    spans, joint_states = add_paths(joints, model, shapes.spans)
    rigid, stiff = len(rows.bodies), too_stiff(model, h)
    laws = law_tables(model)
    actions = action_table(places, motor_of)
    springs, rests = spring_table(places, stiff, laws, rows)
    cords = cord_tables(places, h, rows)
    limits = limit_table(places)
    rubs, sums = dry_friction_table(joints, model, len(places.inverse_mass) + 2 * len(cords.slips))
    circuits = make_circuits(model, h, places.number)
    joined = circuits.add_rows(rows.add)
    loads = load_tables(places, laws, rows)
    pattern = make_pattern(rows.bodies, places.inverse_mass, rigid, slips=len(cords.slips),
                           sums=[*cords.sums, *sums], joined=joined)
    cords.slips["row"] = pattern.hubs[cords.slips["slide"], 0]
    circuits.valves["slot"][circuits.between] = pattern.joined
    _place_rows(pattern, (joints, ROWS), (springs, ("row",)),
                (cords.constants, ("row",)), (circuits.fluids, ("row",)), (loads.loaded, ROWS))
    tables: dict[str, Any] = {}
    for part in (shapes, pattern, circuits, loads):
        tables |= {name: value for name, value in part._asdict().items()
                   if name in Constants._fields}
    tables["spans"] = spans
    pairs = np.ix_(order, order)
    constants = Constants(
        h=h, gravity=np.array(model.mechanism.gravity, dtype=float),
        inverse_mass=places.inverse_mass, bodies=_body_table(model, order),
        scheduled=np.flatnonzero(model.bodies.scheduled[order]), actions=actions, springs=springs,
        cords=cords.constants, guides=cords.guides, slips=cords.slips, wheels=model.tendons.wheels,
        joints=joints, limits=limits, motors=motors, dry_friction=rubs,
        ties=tie_table(model, springs, cords.constants),
        steps=laws.steps, curves=laws.curves, knots=laws.knots,
        friction=np.where(filters.allowed, filters.friction, -1.0)[pairs].copy(),
        static=filters.static[pairs].copy(), restitution=filters.restitution[pairs].copy(),
        loose=loose_bodies(pattern, places.inverse_mass, joints, shapes.shapes),
        skin=filters.skin[:, order][:, :, order].copy() if filters.skin.size else filters.skin,
        **tables)
    state = _first_state(constants, model, body, cords, joint_states, room)
    state.springs["rest"] = rests
    state.fluids["content"] = circuits.content()
    result = _result(constants, pattern, cords, laws, velocity, room)
    straight = springs["turning"] == 0  # lengths are read before the first step
    result.springs["way"][straight] = model.springs.start[springs["number"][straight]]
    result.fluids["pressure"] = circuits.fluids["start"]
    return Tables(constants, state, result)


def _first_state(
    constants: Constants, model: Model, body: Array, cords: CordTables, joints: Records,
    room: Room,
) -> State:
    """The state at t = 0, without rest lengths of springs and contents of lines."""
    state: State = _filled(
        State, constants, body=body, joints=joints, cords=cords.state, guides=cords.guide_state,
        made=np.zeros(4, dtype=np.int64), ties=tie_state(model), broken=room_for_breaks(model),
        impacts=np.zeros(_impacts(room), IMPACT), touches=np.zeros(room.contacts, TOUCH),
        touching=np.zeros(2, dtype=np.int64),
        last_drive=np.full(len(model.drives.name), np.nan), standing=np.zeros(6, dtype=np.int64),
        pile_bodies=pile_bodies(constants.loose), accuracy=np.zeros(5))
    state.joints["flank"], state.motors["target"] = 1.0, math.nan
    begin_friction(state.dry_friction, constants.dry_friction, model)
    return state


def _filled(part: Any, constants: Constants, **given: Any) -> Any:
    """A :class:`State` or :class:`Result`: rows of zeros for all elements that are not given."""
    notes = get_type_hints(part, include_extras=True)
    return part(**given, **{
        name: np.zeros(len(getattr(constants, name)), get_args(notes[name])[1])
        for name in part._fields if name not in given})


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
        "basis": np.zeros((3, 2 * pivoted + 2), dtype=np.int64),
        "piled": np.zeros(room.contacts, PILED), "pile_jacobian": np.zeros((room.contacts, 4, 3))}


def _body_table(model: Model, order: Integers) -> Records:
    table = np.zeros(len(order), BODY)
    table["number"] = order
    table["x"], table["y"] = model.bodies.centre[order].T
    return table


def _result(
    constants: Constants, pattern: Pattern, cords: CordTables, laws: LawTables, velocity: Array,
    room: Room,
) -> Result:
    count, unknowns = len(constants.inverse_mass), len(pattern.starts) - 1
    result: Result = _filled(
        Result, constants, velocity=velocity, before=velocity.copy(),
        **{name: np.zeros((count, 3)) for name in ("force", "free", "kick", "delayed", "shift")},
        turn=np.zeros((count, 2)), cords=cords.result, guides=cords.guide_result,
        pressing=np.zeros((len(constants.loaded), NUMBERS, 3)), felt=np.zeros((3, 4)),
        belts=np.zeros(count), stack=laws.stack, read_names=laws.read,
        entries=np.zeros((2, len(pattern.entry_row), 3)),
        values=np.zeros(len(pattern.below) + unknowns), unknowns=np.zeros((6, unknowns)),
        **_workspace(room, unknowns), **pile_tables(len(np.flatnonzero(constants.loose >= 0))))
    for body in np.flatnonzero(pattern.hubs[:count, 0] >= 0):  # they stand in the matrix with -M
        mass, inertia = 1 / constants.inverse_mass[body]
        result.unknowns[1][pattern.hubs[body]] = -mass, -mass, -inertia
    result.unknowns[1][constants.slips["row"]] = -cords.drag
    return result
