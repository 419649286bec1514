"""All arrays of a run, made from the model."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.engine.blocks import BITS
from sandbox.engine.cables import cable_tables
from sandbox.engine.element_tables import (
    JOINT_ROWS,
    Rows,
    add_paths,
    bond_table,
    drive_tables,
    dry_friction_table,
    fluid_tables,
    joint_table,
    law_tables,
    limit_table,
    load_tables,
    place_bodies,
    spring_table,
)
from sandbox.engine.pile_rows import pile_tables
from sandbox.engine.plan import Pattern, make_pattern
from sandbox.engine.records import BROKEN, NUMBERS
from sandbox.engine.state import (
    BODY,
    PILE_BODY,
    Constants,
    Elements,
    Result,
    State,
    allocate,
    declared,
    zeros,
)
from sandbox.engine.world import Room, World

WORKSPACE = ("found", "order", "rows", "columns", "reached", "delassus", "system", "chosen",
             "pile_adjacent", "pile_work", "pile_vectors", "pile_diagonal", "pile_lower",
             "pile_upper", "piled", "pile_jacobian", "pile_coefficients", "pile_compliance")
"""Fields of a :class:`Result` in which a step leaves nothing that is needed."""
NAMES = 16
"""Most that a law reads."""
AGAIN, LEAST_BREAKS = 8, 1024
"""So often one thing may break in the steps made in one go; breaks that there is room for."""


class Tables(NamedTuple):
    """All arrays of a run but those of samples."""

    constants: Constants
    elements: Elements
    state: State
    result: Result
    pattern: Pattern


def make_tables(world: World) -> Tables:
    """Tables for all elements of the world's model."""
    model, h, order, shapes = world.model, world.h, world.order, world.shape_tables
    places, rows = place_bodies(model, order), Rows()
    count = len(order)
    motors, actions = drive_tables(places, h)
    joints = joint_table(places, rows)
    spans = add_paths(joints, model, shapes.spans)
    rigid = len(rows.bodies)
    programs, stack, codes = law_tables(model)
    springs = spring_table(places, h, codes, rows)
    cables = cable_tables(places, h, rows)
    frictions, sums = dry_friction_table(joints, model, count + 2 * len(cables.slips))
    fluids, meet = fluid_tables(places, h, rows)
    loads, loaded, sides = load_tables(places, codes, rows)
    pattern = make_pattern(rows.bodies, places.inverse_mass, rigid, slips=len(cables.slips),
                           sums=[*cables.sums, *sums], joined=meet)
    cables.slips["row"] = pattern.hubs[cables.slips["slide"], 0]
    valves = fluids["valves"]
    valves["slot"][(valves["a"] >= 0) & (valves["b"] >= 0)] = pattern.joined
    for table, names in ((joints, JOINT_ROWS), (springs, ("row",)), (cables.cables, ("row",)),
                         (fluids["fluids"], ("row",)), (loaded, JOINT_ROWS)):
        for name in names:  # the numbers of rows become those of their unknowns
            if len(pattern.unknown):
                table[name] = np.where(table[name] < 0, -1, pattern.unknown[table[name]])
    bodies = np.zeros(count, BODY)
    bodies["number"] = order
    bodies["x"], bodies["y"] = model.bodies.centre[order].T
    bonds = bond_table(model, springs, cables.cables)
    motors["target"] = math.nan
    elements = Elements(
        actions=actions, springs=springs, cables=cables.cables, guides=cables.guides,
        slips=cables.slips, joints=joints, limits=limit_table(places), motors=motors,
        dry_friction=frictions, loads=loads, loaded=loaded, bonds=bonds, **fluids)
    piled = pile_tables(pattern, places.inverse_mass, elements, shapes.shapes)
    pairs, filters = np.ix_(order, order), world.filters
    constants = Constants(
        h=h, gravity=np.array(model.mechanism.gravity, dtype=float),
        inverse_mass=places.inverse_mass, bodies=bodies,
        scheduled=np.flatnonzero(model.bodies.scheduled[order]), wheels=model.tendons.wheels,
        sides=sides, shapes=shapes.shapes, faces=shapes.faces, vertices=shapes.vertices,
        spans=spans,
        friction=np.where(filters.allowed, filters.friction, -1.0)[pairs].copy(),
        static=filters.static[pairs].copy(), restitution=filters.restitution[pairs].copy(),
        loose=piled.loose, pile_nodes=piled.nodes, pile_blocks=piled.blocks,
        pile_entries=piled.entries,
        skin=filters.skin[:, order][:, :, order].copy() if filters.skin.size else filters.skin,
        **programs)
    piles, unknowns = len(piled.cluster), len(pattern.starts) - 1
    nodes = piles + len(piled.nodes)
    sizes = {name: len(array) for name, array in constants._asdict().items() if name != "h"}
    sizes |= _sizes_of_room(world.room) | {
        "loaded": len(loaded), "drives": len(model.drives.name), "numbers": NUMBERS, "names": NAMES,
        "entries": len(pattern.entry_row), "unknowns": unknowns,
        "values": len(pattern.below) + unknowns, "piles": piles, "nodes": nodes,
        "words": nodes // BITS + 1,
        # room for all pairs: the system gives memory only to what is used of it
        "slots": nodes * (nodes - 1) // 2}
    breaking = int(np.isfinite(model.bonds.breaks_at).sum())
    pile_bodies = np.zeros(piles, PILE_BODY)
    pile_bodies["number"], pile_bodies["cluster"] = (
        np.flatnonzero(constants.loose >= 0), piled.cluster)
    state: State = allocate(
        State, sizes, body=world.body, pile_bodies=pile_bodies, pile_place=np.full(nodes, -1),
        broken=np.zeros(max(AGAIN * breaking, LEAST_BREAKS if breaking else 0), BROKEN))
    state.last_drive[:] = math.nan
    result: Result = allocate(
        Result, sizes, velocity=world.velocity, before=world.velocity.copy(), stack=stack)
    for body in np.flatnonzero(pattern.hubs[:count, 0] >= 0):  # they stand in the matrix with -M
        mass, inertia = 1 / constants.inverse_mass[body]
        result.unknowns[1][pattern.hubs[body]] = -mass, -mass, -inertia
    result.unknowns[1][cables.slips["row"]] = -cables.drag
    return Tables(constants, elements, state, result, pattern)


def _sizes_of_room(room: Room) -> dict[str, int]:
    return room._asdict() | {"impacts": max(1024, 2 * room.contacts)}


def enlarged(tables: Tables, room: Room) -> Tables:
    """The same with more room; what is known of the last step's contacts is kept."""
    sizes = _sizes_of_room(room)
    more: list[dict[str, Any]] = [
        {name: zeros(part, name, sizes | {"unknowns": tables.result.unknowns.shape[1]})
         for name, (_, shape) in declared(part).items() if set(sizes).intersection(shape)}
        for part in (State, Result)]
    more[0]["touches"][:len(tables.state.touches)] = tables.state.touches
    return tables._replace(state=tables.state._replace(**more[0]),
                           result=tables.result._replace(**more[1]))
