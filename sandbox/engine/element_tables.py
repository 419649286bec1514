"""Tables of elements for the compiled step: one record for each element, bodies in pymunk's order.

Bilateral rows of elements are added to :class:`Rows` on the way; they are numbered as they come.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.elements.element import ATMOSPHERE
from sandbox.elements.joint import Keeps
from sandbox.engine import records
from sandbox.engine.stiffness import line_responses, responses, stiff_servos, too_stiff
from sandbox.engine.world import span_table
from sandbox.model.joints import (
    flank_of,
    place_in_slot,
    sliding,
    slip_of,
    slot_length,
    turning,
)
from sandbox.model.laws import MOVED
from sandbox.model.model import Model
from sandbox.model.programs import Program, curve_tables, stack_for, step_table
from sandbox.numeric import Array, Integers, Records
from sandbox.scene.geometry import to_world

KEEPS: dict[Keeps, int] = {
    "point": records.POINT, "groove": records.GROOVE, "distance": records.DISTANCE,
    "range": records.RANGE, "gear": records.GEAR, "rack": records.RACK, "roll": records.ROLL}
"""How compiled code tells apart what joints keep."""
JOINT_ROWS = ("row", "row_y", "row_turn")
SLOPES = 3
"""By how many variables a law has slopes."""

Row = dict[str, Any]
Code = tuple[int, int]
"""First step of a program and where it ends, -1 without one."""


@dataclass
class Rows:
    """The bilateral rows, as they come: of each the bodies of its entries."""

    bodies: list[list[int]] = field(default_factory=list)
    entries: int = 0

    def add(self, *bodies: int) -> tuple[int, int]:
        """A row; its number, and that of its first entry."""
        self.bodies.append(list(bodies))
        self.entries += len(bodies)
        return len(self.bodies) - 1, self.entries - len(bodies)


@dataclass(frozen=True)
class PlacedBodies:
    """Where bodies are: their numbers in pymunk's order, inverse masses, poses at t = 0."""

    model: Model
    number: Integers  # by the model's numbers, [nb]
    inverse_mass: Array  # in pymunk's order, [nb, 2]
    pose: Array  # Of the centres of mass, in pymunk's order, [nb, 3]

    def local(self, body: int, point: Array) -> Array:
        """A point of a body's frame seen from its centre of mass [m]."""
        local: Array = point - self.model.bodies.centre[body]
        return local

    def ends(self, bodies: Integers, *points: Array) -> Row:
        """Bodies ``a`` and ``b`` of an element, and its points on them."""
        row: Row = {}
        for end, body in zip("ab", bodies.tolist(), strict=True):
            row[end] = int(self.number[body])
        for end, body, point in zip("ab", bodies.tolist(), points, strict=False):
            row[f"{end}x"], row[f"{end}y"] = self.local(body, point)
        return row

    def moves(self, row: Row) -> bool:
        """Whether one of the two bodies moves freely."""
        return bool(self.inverse_mass[[row["a"], row["b"]]].any())


def place_bodies(model: Model, order: Integers) -> PlacedBodies:
    """Bodies as pymunk lists them; ``order`` are the model's numbers of these."""
    bodies = model.bodies
    inverse = np.stack([1 / bodies.mass[order], 1 / bodies.inertia[order]], axis=1)
    pose: Array = np.array([
        (*to_world(tuple(bodies.pose[i]), tuple(bodies.centre[i])), bodies.pose[i, 2])
        for i in order]).reshape(-1, 3)
    return PlacedBodies(model, np.argsort(order), inverse, pose)


def records_of(rows: Sequence[Row], record: np.dtype[Any]) -> Records:
    """A table of rows that are given as mappings; fields left out are 0."""
    table = np.zeros(len(rows), dtype=record)
    for row, values in zip(table, rows, strict=True):
        for key, value in values.items():
            row[key] = value
    return table


def drive_tables(places: PlacedBodies, h: float) -> tuple[Records, Records]:
    """MOTOR, of motors, servos and brakes; ACTION, of all drives that act on bodies."""
    model = places.model
    drives, joints, bonds = model.drives, model.joints, model.bonds
    stiff = stiff_servos(model, h)
    motors: list[Row] = []
    actions: list[Row] = []
    for i in drives.giving("force", "torque", "push", "surface").tolist():
        kind, target = drives.kind[i], int(drives.target[i])
        action: Row = {"drive": i, "motor": -1, "bond": -1, "joint": -1, "b": -1}
        actions.append(action)
        if kind.gives == "surface":
            action |= {"a": places.number[target], "runs": 1, "sense": drives.sense[i]}
            continue
        if kind.gives == "force":
            x, y = places.local(target, drives.at[i])
            dx, dy = drives.direction[i]
            action |= {"a": places.number[target], "x": x, "y": y, "dx": dx, "dy": dy,
                       "turning": drives.turning[i]}
            continue
        line = kind.gives == "push"
        shared = places.ends(joints.bodies[target]) | {
            "drive": i, "joint": target, "line": line, "bond": bonds.joint[target],
            "sense": 1.0 if line else joints.sense[target]}
        action |= shared
        if kind.limited:
            action["motor"] = len(motors)
            placed = records.PLACED if np.isnan(drives.stiffness[i]) else records.SPRUNG
            motors.append(shared | {
                "most": drives.most[i], "slope": drives.slope[i],
                "law": placed if kind.places else records.PACED, "k": drives.stiffness[i],
                "c": drives.damping[i], "stiff": stiff[i], "fastest": drives.fastest[i],
                "zero": 0.0 if line else joints.zero[target]})
    return records_of(motors, records.MOTOR), records_of(actions, records.ACTION)


def joint_table(places: PlacedBodies, rows: Rows) -> Records:
    """All joints; their rows are added."""
    model = places.model
    joints, poses = model.joints, model.bodies.pose
    table: list[Row] = []
    for i, kind in enumerate(joints.kind):
        bodies, path, start = joints.bodies[i], joints.path[i], joints.anchor[i, 0]
        if kind.keeps == "groove":
            start = joints.groove[i, 0] if path is None else path.nodes[0, :2]
        row = places.ends(bodies, start, joints.anchor[i, 1]) | {
            "keeps": KEEPS[kind.keeps], "row": -1, "row_y": -1, "row_turn": -1,
            "turn": poses[bodies[1], 2] - poses[bodies[0], 2], "hinge": joints.angle[i],
            "stopped": np.isfinite(joints.stops[i]).all(), "sense": joints.sense[i],
            "zero": joints.zero[i], "bond": model.bonds.joint[i], "span": -1, "flank": 1.0,
            "line": kind.line or path is not None}
        if path is not None:
            row["reach"] = 1.0 / max(float(np.abs(path.nodes[:, 3]).max()), 1.0 / path.length)
        elif kind.keeps == "groove":
            along = joints.groove[i, 1] - joints.groove[i, 0]
            row["gx"], row["gy"] = along / math.hypot(*along)
            row["reach"] = math.hypot(*along)
        if kind.keeps == "distance":
            row["reach"] = joints.reach[i, 0]
        row |= _wheel_fields(model, i)
        if places.moves(row):
            a, b, row["entry"] = row["a"], row["b"], rows.entries
            if kind.keeps != "range" and not joints.play[i] > 0:
                row["row"], _ = rows.add(a, b)
            if kind.keeps in ("point", "roll"):
                row["row_y"], _ = rows.add(a, b)
            if not joints.turns[i]:
                row["row_turn"], _ = rows.add(a, b)
            row["entries"] = rows.entries - row["entry"]
        table.append(row)
    return records_of(table, records.JOINT)


def _wheel_fields(model: Model, i: int) -> Row:
    """Fields of JOINT that joint ``i`` has besides, if it is one of wheels."""
    joints, pose = model.joints, model.bodies.pose
    keeps, (ra, rb), sign = joints.kind[i].keeps, joints.radii[i], -1.0 if joints.inside[i] else 1.0
    c, s = math.cos(joints.pressure[i]), math.sin(joints.pressure[i])
    if keeps == "roll":
        return {"ra": ra, "rb": sign * rb, "reach": abs(ra + sign * rb),
                "start": slip_of(model, i, pose)[0]}
    if not joints.kind[i].teeth:
        return {}
    push = sign if keeps == "gear" else 1.0
    row = {"ra": ra * c, "push": push, "k": joints.stiffness[i],
           "start": push * flank_of(model, i, pose, 1).gap,
           "start_back": push * flank_of(model, i, pose, -1).gap}
    if keeps == "gear":
        return row | {"rb": -sign * rb * c, "reach": abs(ra + sign * rb) * s}
    gx, gy = joints.along[i]
    return row | {"tilt_c": c, "tilt_s": s, "gx": gx, "gy": gy, "reach": ra}


def limit_table(places: PlacedBodies) -> Records:
    """Stops of hinges, limits of lengths and of grooves, play of teeth."""
    joints = places.model.joints
    rows: list[Row] = []

    def add(joint: int, what: int, low: float, high: float) -> None:
        rows.extend(
            {"joint": joint, "what": what, "side": side, "bound": bound}
            for side, bound in ((1.0, low), (-1.0, high)) if math.isfinite(bound)
            and not (what == records.LINE and side > 0 and bound <= 0.0 and high == math.inf))

    for i, kind in enumerate(joints.kind):
        if not places.moves(places.ends(joints.bodies[i])):
            continue
        if np.isfinite(joints.stops[i]).all():
            low, high = sorted(joints.sense[i] * (joints.stops[i] + joints.zero[i]))
            add(i, records.STOP, low, high)
        if kind.keeps == "range":
            add(i, records.LINE, *joints.reach[i])
        if kind.keeps == "groove":
            add(i, records.LINE, 0.0, slot_length(places.model, i))
        if joints.play[i] > 0:
            play = joints.play[i] * math.cos(joints.pressure[i]) / 2
            add(i, records.FLANK, -play, -play)
    return records_of(rows, records.LIMIT)


def dry_friction_table(
    joints: Records, model: Model, first: int,
) -> tuple[Records, list[tuple[int, int]]]:
    """Dry friction of joints, and pairs of rows whose load bounds it."""
    held = [j for j in model.joints.frictional.tolist() if joints[j]["row"] >= 0]
    table = np.zeros(len(held), records.DRY_FRICTION)
    table["ux"], table["bound"] = 1.0, np.nan
    sums: list[tuple[int, int]] = []
    for dry, j in zip(table, held, strict=True):
        dry["joint"], dry["sum"] = j, -1
        dry["most"], dry["share"] = model.joints.friction[j], model.joints.coefficient[j]
        dry["static"] = model.joints.static[j]
        if dry["share"] > 0:
            dry["sum"] = first + len(sums)
            one, two = int(joints[j]["row"]), int(joints[j]["row_y"])
            sums.append((one, two if two >= 0 else one))
        slides = model.joints.kind[j].keeps == "groove"
        dry["mode"] = -np.sign(sliding(model, j) if slides else turning(model, j))
    return table, sums


def spring_table(
    places: PlacedBodies, h: float, laws: dict[int, Code], rows: Rows,
) -> Records:
    """Rotary springs, straight springs, damping of hinges."""
    model = places.model
    springs, joints, bonds = model.springs, model.joints, model.bonds
    stiff, response = too_stiff(model, h), responses(model)
    table: list[Row] = []
    for i in np.argsort(springs.straight, kind="stable").tolist():
        law = springs.law[i]
        row: Row = {
            "number": i, "joint": -1, "drive": springs.drive[i], "k": springs.stiffness[i],
            "sense": 1.0, "row": -1, "bond": bonds.spring[i], "hinge_bond": -1,
            "of_rate": law is not None and law.of_rate, "response": response[i]}
        row["code"], row["code_end"] = laws[id(law.program)] if law else (-1, -1)
        if springs.straight[i]:
            row |= places.ends(springs.bodies[i], *springs.anchor[i])
            row["c"], row["rest"] = springs.damping[i], springs.rest[i]
            row["way"] = springs.start[i]  # it is read before the first step
        else:  # its damper is that of the hinge
            joint = int(springs.joint[i])
            row |= places.ends(joints.bodies[joint]) | {
                "joint": joint, "turning": 1, "sense": joints.sense[joint], "c": 0.0,
                "hinge_bond": bonds.joint[joint]}
            row["rest"] = joints.sense[joint] * (springs.rest[i] + joints.zero[joint])
        row["kind"] = (records.STIFF if stiff[i] else records.DAMPED if row["c"] > 0
                       else records.ELASTIC)
        if (row["kind"] != records.ELASTIC or law) and places.moves(row):
            row["row"], row["entry"] = rows.add(row["a"], row["b"])
        table.append(row)
    for joint in joints.hinges.tolist():
        row = places.ends(joints.bodies[joint]) | {
            "number": -1, "joint": joint, "turning": 1, "kind": records.DAMPED, "drive": -1,
            "c": model.hinge_damping[joint], "sense": 1.0, "code": -1, "bond": -1,
            "hinge_bond": bonds.joint[joint]}
        if row["c"] > 0 and places.moves(row):
            row["row"], row["entry"] = rows.add(row["a"], row["b"])
            table.append(row)
    return records_of(table, records.SPRING)


def law_tables(model: Model) -> tuple[dict[str, Any], Array, dict[int, Code]]:
    """Programs of all laws and the scene's tables; a stack for them; places of programs by id."""
    programs: list[Program] = [law.program for law in model.springs.law if law is not None]
    programs += [part for law in model.loads.law if law is not None
                 for part in law.programs if part is not None]
    steps, ends = step_table(programs)
    curves, knots = curve_tables(list(model.mechanism.functions.values()))
    codes = {id(program): code
             for program, code in zip(programs, pairwise(ends.tolist()), strict=True)}
    return ({"steps": steps, "curves": curves, "knots": knots},
            stack_for(programs, SLOPES), codes)


def load_tables(
    places: PlacedBodies, laws: dict[int, Code], rows: Rows,
) -> tuple[Records, Records, Array]:
    """LOAD, LOADED and outlines in liquids; three rows for a body whose loads depend on motion."""
    model, given = places.model, places.model.loads
    order = np.argsort(places.number[given.body], kind="stable")
    loads: list[Row] = []
    for i in order.tolist():
        body, law = int(given.body[i]), given.law[i]
        x, y = places.local(body, given.at[i])
        mass = model.bodies.mass[body]
        loads.append({
            "number": i, "body": places.number[body], "x": x, "y": y, "turning": given.turning[i],
            "scale": mass if given.per_mass[i] else 1.0, "mass": mass,
            "inertia": model.bodies.inertia[body],
            "timed": law is not None and "t" in law.names, "first": given.first[i],
            "last": given.first[i + 1], "level": given.level[i], "lift": given.lift[i]})
        for axis, part in zip("xyt", law.programs if law else 3 * [None], strict=True):
            code = (-1, -1) if part is None else laws[id(part)]
            loads[-1][f"{axis}_code"], loads[-1][f"{axis}_end"] = code
    table = records_of(loads, records.LOAD)
    bodies, first = np.unique(table["body"], return_index=True)
    loaded = np.zeros(len(bodies), records.LOADED)
    loaded["body"], loaded["first"] = bodies, first
    loaded["last"] = [*first[1:], len(order)]
    for name in JOINT_ROWS:
        loaded[name] = -1
    for row in loaded:
        own = [given.law[i] for i in table["number"][row["first"]:row["last"]]]
        if any(law is not None and law.names & MOVED for law in own):
            row["row"], row["entry"] = rows.add(int(row["body"]))
            row["row_y"], _ = rows.add(int(row["body"]))
            row["row_turn"], _ = rows.add(int(row["body"]))
    sides, centres = given.sides.copy(), model.bodies.centre[given.body]
    centre = np.repeat(centres, np.diff(given.first), axis=0)
    sides[:, :2] -= centre
    straight = sides[:, 4] == 0.0
    sides[straight, 2:4] -= centre[straight]
    return table, loaded, sides


def fluid_tables(
    places: PlacedBodies, h: float, rows: Rows,
) -> tuple[dict[str, Records], list[tuple[int, int]]]:
    """Lines, chambers, valves and pumps; rows of lines that meet at valves."""
    model, drives = places.model, places.model.drives
    lines, joints = model.lines, model.joints
    chambers: list[Row] = []
    for n, joint in enumerate(lines.joint.tolist()):
        if joint >= 0:
            sense = joints.sense[joint]
            chambers.append(places.ends(lines.bodies[n]) | {
                "turns": 1, "gain": sense * lines.gain[n],
                "start": sense * (lines.start[n] + joints.zero[joint])})
        else:
            chambers.append(places.ends(lines.bodies[n], *lines.anchor[n]) | {
                "gain": lines.gain[n], "start": lines.start[n]})
    fluids = np.zeros(len(lines.name), records.FLUID)
    fluids["first"], fluids["last"] = lines.first[:-1], lines.first[1:]
    fluids["drive"], fluids["volume"], fluids["c"] = lines.drive, lines.volume, lines.compliance
    fluids["gas"] = np.nan_to_num(lines.gas)
    fluids["start"] = fluids["pressure"] = lines.pressure
    fluids["least"], fluids["most"] = lines.least, lines.most
    fluids["response"] = line_responses(model)
    with np.errstate(divide="ignore"):
        of_gas = fluids["volume"] * (fluids["start"] / ATMOSPHERE + 1.0) ** (1.0 / fluids["gas"])
    fluids["content"] = np.where(fluids["gas"] > 0, of_gas, fluids["c"] * fluids["start"])
    stiff = h * h * fluids["response"] > records.SOFT * lines.compliance
    meet = [(a, b) for a, b in model.valves.lines.tolist() if a >= 0 and b >= 0]
    beside = stiff.copy()  # lines that are stiff, and those that valves join to them
    for a, b in len(meet) * meet:
        beside[a] = beside[b] = beside[a] or beside[b]
    fluids["least_ahead"], fluids["ratio"] = stiff, np.where(beside, 1.5, 2.0)
    for fluid in fluids:
        own = chambers[fluid["first"]:fluid["last"]]
        bodies = sorted({chamber[end] for chamber in own for end in "ab"})
        fluid["row"], entry = rows.add(*bodies)
        for chamber in own:
            for end in "ab":
                chamber[f"entry_{end}"] = entry + bodies.index(chamber[end])
    valves = np.zeros(len(model.valves.name), records.VALVE)
    valves["a"], valves["b"] = model.valves.lines.T
    valves["r"], valves["k"] = model.valves.resistance, model.valves.orifice
    valves["one_way"], valves["drive"] = model.valves.one_way, model.valves.drive
    valves["slot"] = -1
    which = drives.giving("flow", "pressure")
    pumps = np.zeros(len(which), records.PUMP)
    pumps["drive"], pumps["line"] = which, drives.target[which]
    pumps["source"] = np.isfinite(drives.resistance[which])
    pumps["r"] = np.nan_to_num(drives.resistance[which])
    own_rows = fluids["row"].tolist()
    return ({"fluids": fluids, "chambers": records_of(chambers, records.CHAMBER),
             "valves": valves, "pumps": pumps}, [(own_rows[a], own_rows[b]) for a, b in meet])


def bond_table(model: Model, springs: Records, cables: Records) -> Records:
    """BOND, [nr]; spans of tendons get the number of theirs."""
    bonds = model.bonds
    table = np.zeros(len(bonds.name), records.BOND)
    table["breaks_at"], table["over"] = bonds.breaks_at, bonds.over
    table["as_is"], table["drive"] = bonds.as_is, bonds.drive
    table["held"] = table["driven"] = bonds.held
    table["last_load"], table["age"], table["wish"] = np.nan, records.SETTLED, records.NONE
    for row in np.flatnonzero(springs["bond"] >= 0):
        own = table[springs["bond"][row]]
        own["what"], own["index"] = records.SPRINGY, row
    for what, numbers in ((records.JOINED, bonds.joint), (records.PULLING, bonds.tendon)):
        own = np.flatnonzero(numbers >= 0)
        table["what"][numbers[own]], table["index"][numbers[own]] = what, own
    whole = len(model.tendons.name)
    cables["bond"][:whole] = bonds.tendon
    cables["bond"][whole:] = bonds.tendon[cables["whole"][whole:]]
    return table


def add_paths(joints: Records, model: Model, spans: Records) -> Records:
    """Put the paths of slots into JOINT; the SPANs with theirs added."""
    tables = [spans]
    for j, path in enumerate(model.joints.path):
        if path is None:
            continue
        first = sum(map(len, tables))
        x, y = model.bodies.centre[model.joints.bodies[j, 0]].tolist()
        table = span_table(path.nodes, (x, y), first, closed=path.closed)
        table["start"] = path.starts[:-1]
        tables.append(table)
        place = float(place_in_slot(model, j, model.bodies.pose).along)
        joints[j]["span"], joints[j]["span_end"] = first, first + len(table)
        joints[j]["around"] = path.length if path.closed else 0.0
        joints[j]["place"] = place
        joints[j]["on"] = first + np.searchsorted(path.starts[1:-1], place, side="right")
    return np.concatenate(tables)
