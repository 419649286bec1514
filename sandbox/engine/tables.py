"""All arrays of a run, made from the model."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from sandbox.engine import element_tables as et
from sandbox.engine import state as st
from sandbox.engine.blocks import BITS
from sandbox.engine.pile_rows import pile_tables
from sandbox.engine.plan import Pattern, make_pattern
from sandbox.engine.records import BROKEN, NUMBERS
from sandbox.engine.world import Room, World
from sandbox.model.programs import curve_tables
from sandbox.numeric import Array, Integers

WORKSPACE = st.Result._fields[st.Result._fields.index("found"):]  # scratch
MAX_NAMES = 16  # that a law reads
BREAKS_EACH, MIN_BREAKS = 8, 1024  # room for breaks in a call of the loop, per element and total


class Tables(NamedTuple):
    """All arrays of a run but those of samples."""

    constants: st.Constants
    elements: st.Elements
    state: st.State
    result: st.Result
    pattern: Pattern

    def saved(self) -> list[tuple[Any, Any]]:
        """The bytes of all arrays that a run changes but scratch ones, and copies of them.

        Arrays are in one piece, as :func:`sandbox.engine.memory.make_memory` checks.
        """
        found = [array.reshape(-1).view(np.uint8)  # records would be copied field by field
                 for part in self[:4] for name, array in part._asdict().items()
                 if isinstance(array, np.ndarray) and array.flags.writeable
                 and name not in WORKSPACE]
        return [(array, array.copy()) for array in found]

    def place(self, pose: Array, velocity: Array) -> None:
        """Put all bodies to poses [nb, 3] at velocities [nb, 3]; pymunk's follow in the step."""
        self.state.body[:, :3], self.state.body[:, 3:] = pose, velocity
        self.state.placed[:], self.result.velocity[:] = pose, velocity
        self.state.touching[2] = 1


def make_tables(world: World) -> Tables:
    """Tables for all elements of the world's model."""
    model, order, shapes = world.model, world.order, world.shape_tables
    build, count = et.Builder(model, order, world.h), len(order)
    motors, actions = et.drive_tables(build)
    joints = et.joint_table(build)
    spans = et.add_paths(joints, model, shapes.spans)
    et.measure_joints(joints, world.body)
    rigid = len(build.rows)
    springs, cables = et.spring_table(build), et.cable_tables(build)
    slips = cables.slips
    frictions = et.dry_friction_table(joints, model, count + 2 * len(slips))
    by_load = joints[frictions["joint"][frictions["sum"] >= 0]]
    spans_of_slips = (cables.cables["row"][slips[name]].tolist() for name in ("before", "after"))
    sums = [(one, two if two >= 0 else one) for one, two in [  # rows whose impulses bound friction
        *zip(*spans_of_slips, strict=True), *by_load[["row", "row_y"]].tolist()]]
    fluids, meet = et.fluid_tables(build)
    loads, loaded, sides = et.load_tables(build)
    pattern = make_pattern(build.rows, build.inverse_mass, rigid, slips=len(slips), sums=sums,
                           joined=meet)
    slips["row"] = pattern.hubs[slips["slide"], 0]
    valves = fluids["valves"]
    valves["slot"][(valves["a"] >= 0) & (valves["b"] >= 0)] = pattern.joined
    for table, names in ((joints, et.JOINT_ROWS), (springs, ("row",)), (cables.cables, ("row",)),
                         (fluids["fluids"], ("row",)), (loaded, et.JOINT_ROWS)):
        for name in names if len(pattern.unknown) else ():  # rows become their unknowns
            rows: Integers = table[name]
            table[name] = np.where(rows < 0, -1, pattern.unknown[rows])
    x, y = model.bodies.centre[order].T
    bodies = et.fill(st.BODY, count, number=order, x=x, y=y)
    bonds = et.bond_table(model, springs, cables.cables)
    motors["target"] = math.nan
    elements = st.Elements(
        actions=actions, springs=springs, cables=cables.cables, guides=cables.guides,
        slips=slips, joints=joints, limits=et.limit_table(build), motors=motors,
        dry_friction=frictions, loads=loads, loaded=loaded, bonds=bonds, **fluids)
    shaped = np.bincount(shapes.shapes["body"], minlength=count) > 0
    piled = pile_tables(pattern, build.inverse_mass, elements, shapes.shapes)
    curves, knots = curve_tables(list(model.mechanism.functions.values()))
    pairs, filters = np.ix_(order, order), world.filters
    constants = st.Constants(
        h=world.h, gravity=np.array(model.mechanism.gravity, dtype=float),
        inverse_mass=build.inverse_mass, bodies=bodies,
        scheduled=np.flatnonzero(model.bodies.scheduled[order]), wheels=model.tendons.wheels,
        sides=sides, shapes=shapes.shapes, faces=shapes.faces, vertices=shapes.vertices,
        spans=spans,
        friction=np.where(filters.allowed, filters.friction, -1.0)[pairs].copy(),
        static=filters.static[pairs].copy(), restitution=filters.restitution[pairs].copy(),
        neighbors=np.argwhere(
            np.triu(filters.allowed[pairs] & shaped & shaped[:, None])).copy(),
        loose=piled.loose, pile_nodes=piled.nodes, pile_blocks=piled.blocks,
        pile_entries=piled.entries,
        skin=filters.skin[:, order][:, :, order].copy() if filters.skin.size else filters.skin,
        steps=build.steps, curves=curves, knots=knots)
    piles, unknowns = len(piled.cluster), len(pattern.starts) - 1
    nodes = piles + len(piled.nodes)
    sizes = {name: len(array) for name, array in constants._asdict().items() if name != "h"}
    sizes |= _lengths(world.room) | {
        "loaded": len(loaded), "drives": len(model.drives.name), "numbers": NUMBERS,
        "names": MAX_NAMES,
        "entries": len(pattern.entry_row), "unknowns": unknowns,
        "values": len(pattern.below) + unknowns, "piles": piles, "nodes": nodes,
        "words": nodes // BITS + 1,
        # room for all pairs: only memory in use is allocated by the system
        "slots": nodes * (nodes - 1) // 2}
    breaking = int(np.isfinite(model.bonds.breaks_at).sum())
    state: st.State = st.allocate(
        st.State, sizes, body=world.body, placed=world.placed, pile_bodies=et.fill(
            st.PILE_BODY, piles, number=np.flatnonzero(constants.loose >= 0),
            cluster=piled.cluster),
        pile_place=np.full(nodes, -1),
        broken=np.zeros(max(BREAKS_EACH * breaking, MIN_BREAKS if breaking else 0), BROKEN))
    state.last_drive[:] = math.nan
    result: st.Result = st.allocate(
        st.Result, sizes, velocity=world.velocity, before=world.velocity.copy(), stack=build.stack)
    for body in np.flatnonzero(pattern.hubs[:count, 0] >= 0):  # they are in the matrix with -M
        mass, inertia = 1 / constants.inverse_mass[body]
        result.unknowns[1][pattern.hubs[body]] = -mass, -mass, -inertia
    result.unknowns[1][slips["row"]] = -cables.drag
    result.ahead[:] = math.nan
    return Tables(constants, elements, state, result, pattern)


def _lengths(room: Room) -> dict[str, int]:
    return room._asdict() | {"impacts": max(1024, 2 * room.contacts)}


def enlarged(tables: Tables, room: Room) -> Tables:
    """The same tables with more room; the contacts of the last step are kept."""
    sizes = _lengths(room)
    more: list[dict[str, Any]] = [
        {name: st.zeros(part, name, sizes | {"unknowns": tables.result.unknowns.shape[1]})
         for name, (_, shape) in st.declared(part).items() if set(sizes).intersection(shape)}
        for part in (st.State, st.Result)]
    more[0]["touches"][:len(tables.state.touches)] = tables.state.touches
    return tables._replace(state=tables.state._replace(**more[0]),
                           result=tables.result._replace(**more[1]))
