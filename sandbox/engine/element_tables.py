"""Tables of elements for the compiled step: one record for each element, bodies in pymunk's order.

The bilateral rows of elements are added to a :class:`Builder` in this order.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from sandbox.elements.element import ATMOSPHERE
from sandbox.elements.joints import Keeps
from sandbox.engine import records
from sandbox.engine import stiffness as stiffnesses
from sandbox.engine.coordinates import measure_angle, measure_distance, note_rate
from sandbox.engine.rows import note_turns
from sandbox.engine.tendons import measure
from sandbox.engine.world import span_table
from sandbox.model import joints as of_joint
from sandbox.model.model import Model
from sandbox.model.programs import MOVED, Program, stack_for, step_table
from sandbox.numeric import Array, Flags, Integers, Records
from sandbox.samples.cables import CableSpan, lifted_at_start, spans_of
from sandbox.scene.geometry import to_world

KEEPS: dict[Keeps, int] = {
    "point": records.POINT, "groove": records.GROOVE, "distance": records.DISTANCE,
    "range": records.RANGE, "gear": records.GEAR, "rack": records.RACK, "roll": records.ROLL}
JOINT_ROWS = ("row", "row_y", "row_turn")
MIN_INSIDE = 1e-3  # minimum length of tendon in a span, as a share of that at t = 0
DRAG = 1e-7  # of a loop, as a share of the effect of its stiffness in a step
BESIDE = -math.pi / 2  # initial angle of a tendon that begins off its wheel [rad]

Row = dict[str, Any]
Code = tuple[int, int]  # first step of a program and where it ends, -1 without one


class Builder:
    """What all tables of elements need, and the bilateral rows that they add."""

    def __init__(self, model: Model, order: Integers, h: float) -> None:
        bodies = model.bodies
        self.model, self.h = model, h
        self.number: Integers = np.argsort(order)  # pymunk's numbers by the model's, [nb]
        self.inverse_mass: Array = np.stack(
            [1 / bodies.mass[order], 1 / bodies.inertia[order]], axis=1)
        self.pose: Array = np.array([
            (*to_world(tuple(bodies.pose[i]), tuple(bodies.centre[i])), bodies.pose[i, 2])
            for i in order]).reshape(-1, 3)  # of the centres of mass, in pymunk's order, [nb, 3]
        self.rows: list[tuple[int, ...]] = []  # of each bilateral row the bodies of its entries
        self.entries = 0
        programs: list[Program] = [law.program for law in model.springs.law if law is not None]
        programs += [part for law in model.loads.law if law is not None
                     for part in law.programs if part is not None]
        self.steps, ends = step_table(programs)  # of the programs of all laws
        self.stack = stack_for(programs, 3)
        self.codes: dict[int, Code] = {id(program): code for program, code in zip(
            programs, pairwise(ends.tolist()), strict=True)}

    def add(self, *bodies: int) -> tuple[int, int]:
        """A row; its number, and that of its first entry."""
        self.rows.append(bodies)
        self.entries += len(bodies)
        return len(self.rows) - 1, self.entries - len(bodies)

    def local(self, body: int, point: Array) -> Array:
        """A point of a body's frame seen from its centre of mass [m]."""
        return np.asarray(point - self.model.bodies.centre[body])

    def ends(self, bodies: Integers, *points: Array) -> Row:
        """Bodies ``a`` and ``b`` of an element, and its points on them."""
        row: Row = dict(zip("ab", self.number[bodies].tolist(), strict=True))
        for end, body, point in zip("ab", bodies.tolist(), points, strict=False):
            row[f"{end}x"], row[f"{end}y"] = self.local(body, point)
        return row

    def moves(self, row: Row) -> bool:
        """Whether one of the two bodies moves freely."""
        return bool(self.inverse_mass[[row["a"], row["b"]]].any())


def fill(record: np.dtype[Any], count: int, **columns: Any) -> Records:
    """A table with some columns; the others are 0."""
    table = np.zeros(count, record)
    for name, values in columns.items():
        table[name] = values
    return table


def records_of(rows: Sequence[Row], record: np.dtype[Any]) -> Records:
    """A table of rows; fields left out are 0."""
    return np.array([tuple(row.get(name, 0) for name in record.names or ()) for row in rows],
                    record)


def drive_tables(build: Builder) -> tuple[Records, Records]:
    """MOTOR, of motors, servos and brakes; ACTION, of all drives that act on bodies."""
    model = build.model
    drives, joints, bonds = model.drives, model.joints, model.bonds
    stiff = stiffnesses.stiff_servos(model, build.h)
    motors: list[Row] = []
    actions: list[Row] = []
    for i in drives.giving("force", "torque", "push", "surface").tolist():
        kind, target = drives.kind[i], int(drives.target[i])
        action: Row = {"drive": i, "motor": -1, "bond": -1, "joint": -1, "b": -1}
        actions.append(action)
        if kind.gives in ("surface", "force"):
            (x, y), (dx, dy) = build.local(target, drives.at[i]), drives.direction[i]
            action |= {"a": build.number[target]} | (
                {"runs": 1, "sense": drives.sense[i]} if kind.gives == "surface" else
                {"x": x, "y": y, "dx": dx, "dy": dy, "turning": drives.turning[i]})
            continue
        line = kind.gives == "push"
        shared = build.ends(joints.bodies[target]) | {
            "drive": i, "joint": target, "line": line, "bond": bonds.joint[target],
            "sense": 1.0 if line else joints.sense[target]}
        action |= shared
        if kind.limited:
            action["motor"] = len(motors)
            placed = records.PLACED if np.isnan(drives.stiffness[i]) else records.SPRUNG
            motors.append(shared | {
                "maximum": drives.most[i], "slope": drives.slope[i],
                "law": placed if kind.places else records.PACED, "k": drives.stiffness[i],
                "c": drives.damping[i], "stiff": stiff[i], "fastest": drives.fastest[i],
                "zero": 0.0 if line else joints.zero[target]})
    return records_of(motors, records.MOTOR), records_of(actions, records.ACTION)


def joint_table(build: Builder) -> Records:
    """All joints; their rows are added."""
    model = build.model
    joints, poses = model.joints, model.bodies.pose
    table: list[Row] = []
    for i, kind in enumerate(joints.kind):
        bodies, path, start = joints.bodies[i], joints.path[i], joints.anchor[i, 0]
        if kind.keeps == "groove":
            start = joints.groove[i, 0] if path is None else path.nodes[0, :2]
        row = build.ends(bodies, start, joints.anchor[i, 1]) | {
            "keeps": KEEPS[kind.keeps], "row": -1, "row_y": -1, "row_turn": -1,
            "turn": poses[bodies[1], 2] - poses[bodies[0], 2], "hinge": joints.angle[i],
            "stopped": np.isfinite(joints.stops[i]).all(), "sense": joints.sense[i],
            "zero": joints.zero[i], "bond": model.bonds.joint[i], "span": -1, "flank": 1.0,
            "line": kind.line or path is not None}
        if path is not None:
            row["reach"] = 1.0 / max(float(np.abs(path.nodes[:, 3]).max()), 1.0 / path.length)
        elif kind.keeps == "groove":
            along = joints.groove[i, 1] - joints.groove[i, 0]
            row["reach"] = math.hypot(*along)
            row["gx"], row["gy"] = along / row["reach"]
        elif kind.keeps == "distance":
            row["reach"] = joints.reach[i, 0]
        if kind.keeps == "roll" or kind.teeth:
            row |= _wheel_fields(model, i)
        if build.moves(row):
            a, b, row["entry"] = row["a"], row["b"], build.entries
            for name, needed in (("row", kind.keeps != "range" and not joints.play[i] > 0),
                                 ("row_y", kind.keeps in ("point", "roll")),
                                 ("row_turn", not joints.turns[i])):
                if needed:
                    row[name], _ = build.add(a, b)
            row["entries"] = build.entries - row["entry"]
        table.append(row)
    return records_of(table, records.JOINT)


def _wheel_fields(model: Model, i: int) -> Row:
    joints, pose = model.joints, model.bodies.pose
    keeps, (ra, rb), sign = joints.kind[i].keeps, joints.radii[i], -1.0 if joints.inside[i] else 1.0
    c, s = math.cos(joints.pressure[i]), math.sin(joints.pressure[i])
    if keeps == "roll":
        return {"ra": ra, "rb": sign * rb, "reach": abs(ra + sign * rb),
                "start": of_joint.slip_of(model, i, pose)[0]}
    push = sign if keeps == "gear" else 1.0
    row = {"ra": ra * c, "push": push, "k": joints.stiffness[i],
           "start": push * of_joint.flank_of(model, i, pose, 1).gap,
           "start_back": push * of_joint.flank_of(model, i, pose, -1).gap}
    if keeps == "gear":
        return row | {"rb": -sign * rb * c, "reach": abs(ra + sign * rb) * s}
    gx, gy = joints.along[i]
    return row | {"tilt_c": c, "tilt_s": s, "gx": gx, "gy": gy, "reach": ra}


def limit_table(build: Builder) -> Records:
    """Stops of hinges, limits of lengths and of grooves, play of teeth."""
    joints = build.model.joints
    rows: list[Row] = []

    def add(joint: int, what: int, low: float, high: float) -> None:
        rows.extend(
            {"joint": joint, "what": what, "side": side, "bound": bound}
            for side, bound in ((1.0, low), (-1.0, high)) if math.isfinite(bound)
            and not (what == records.LINE and side > 0 and bound <= 0.0 and high == math.inf))

    for i, kind in enumerate(joints.kind):
        if not build.moves(build.ends(joints.bodies[i])):
            continue
        if np.isfinite(joints.stops[i]).all():
            low, high = sorted(joints.sense[i] * (joints.stops[i] + joints.zero[i]))
            add(i, records.STOP, low, high)
        if kind.keeps == "range":
            add(i, records.LINE, *joints.reach[i])
        if kind.keeps == "groove":
            add(i, records.LINE, 0.0, of_joint.slot_length(build.model, i))
        if joints.play[i] > 0:
            play = joints.play[i] * math.cos(joints.pressure[i]) / 2
            add(i, records.FLANK, -play, -play)
    return records_of(rows, records.LIMIT)


def dry_friction_table(joints: Records, model: Model, first: int) -> Records:
    """Dry friction of joints; sums of the rows whose load bounds it are counted from ``first``."""
    friction = model.joints
    held = friction.frictional[joints["row"][friction.frictional] >= 0]
    table = fill(records.DRY_FRICTION, len(held), ux=1.0, bound=np.nan, joint=held, sum=-1,
                 maximum=friction.friction[held], share=friction.coefficient[held],
                 static=friction.static[held])
    table["mode"] = [-np.sign(of_joint.sliding(model, j) if friction.kind[j].keeps == "groove"
                              else of_joint.turning(model, j)) for j in held]
    loaded = table["share"] > 0
    table["sum"][loaded] = first + np.arange(np.count_nonzero(loaded))
    return table


def spring_table(build: Builder) -> Records:
    """Rotary springs, straight springs, damping of hinges."""
    model = build.model
    springs, joints, bonds = model.springs, model.joints, model.bonds
    kinds, response = stiffnesses.spring_kinds(model, build.h), stiffnesses.responses(model)
    table: list[Row] = []
    for i in np.argsort(springs.straight, kind="stable").tolist():
        law = springs.law[i]
        row: Row = {
            "number": i, "joint": -1, "drive": springs.drive[i], "k": springs.stiffness[i],
            "sense": 1.0, "row": -1, "bond": bonds.spring[i], "hinge_bond": -1,
            "of_rate": law is not None and law.of_rate, "response": response[i]}
        row["code"], row["code_end"] = build.codes[id(law.program)] if law else (-1, -1)
        if springs.straight[i]:
            row |= build.ends(springs.bodies[i], *springs.anchor[i])
            row["c"], row["rest"] = springs.damping[i], springs.rest[i]
            row["way"] = springs.start[i]  # it is read before the first step
        else:  # its damper is that of the hinge
            joint = int(springs.joint[i])
            row |= build.ends(joints.bodies[joint]) | {
                "joint": joint, "turning": 1, "sense": joints.sense[joint], "c": 0.0,
                "hinge_bond": bonds.joint[joint]}
            row["rest"] = joints.sense[joint] * (springs.rest[i] + joints.zero[joint])
        row["kind"] = (records.DAMPED if kinds[i] == records.ELASTIC and row["c"] > 0
                       else kinds[i])
        if (row["kind"] != records.ELASTIC or law) and build.moves(row):
            row["row"], row["entry"] = build.add(row["a"], row["b"])
        table.append(row)
    for joint in joints.hinges.tolist():
        row = build.ends(joints.bodies[joint]) | {
            "number": -1, "joint": joint, "turning": 1, "kind": records.DAMPED, "drive": -1,
            "c": model.hinge_damping[joint], "sense": 1.0, "code": -1, "bond": -1,
            "hinge_bond": bonds.joint[joint]}
        if row["c"] > 0 and build.moves(row):
            row["row"], row["entry"] = build.add(row["a"], row["b"])
            table.append(row)
    return records_of(table, records.SPRING)


def load_tables(build: Builder) -> tuple[Records, Records, Array]:
    """LOAD, LOADED and outlines in liquids; three rows for a body whose loads depend on motion."""
    model, given = build.model, build.model.loads
    order = np.argsort(build.number[given.body], kind="stable")
    loads: list[Row] = []
    for i in order.tolist():
        body, law = int(given.body[i]), given.law[i]
        x, y = build.local(body, given.at[i])
        mass = model.bodies.mass[body]
        loads.append({
            "number": i, "body": build.number[body], "x": x, "y": y, "turning": given.turning[i],
            "scale": mass if given.per_mass[i] else 1.0, "mass": mass,
            "inertia": model.bodies.inertia[body],
            "timed": law is not None and "t" in law.names, "first": given.first[i],
            "last": given.first[i + 1], "level": given.level[i], "lift": given.lift[i]})
        for axis, part in zip("xyt", law.programs if law else 3 * [None], strict=True):
            code = (-1, -1) if part is None else build.codes[id(part)]
            loads[-1][f"{axis}_code"], loads[-1][f"{axis}_end"] = code
    table = records_of(loads, records.LOAD)
    bodies, first = np.unique(table["body"], return_index=True)
    loaded = fill(records.LOADED, len(bodies), body=bodies, first=first,
                  last=[*first[1:], len(order)], row=-1, row_y=-1, row_turn=-1)
    for row in loaded:
        own = [given.law[i] for i in table["number"][row["first"]:row["last"]]]
        if any(law and law.names & MOVED for law in own):
            row["entry"] = build.entries
            for name in JOINT_ROWS:
                row[name], _ = build.add(int(row["body"]))
    sides, centres = given.sides.copy(), model.bodies.centre[given.body]
    centre = np.repeat(centres, np.diff(given.first), axis=0)
    sides[:, :2] -= centre
    straight = sides[:, 4] == 0.0
    sides[straight, 2:4] -= centre[straight]
    return table, loaded, sides


def fluid_tables(build: Builder) -> tuple[dict[str, Records], list[tuple[int, int]]]:
    """Lines, chambers, valves and pumps; rows of lines that meet at valves."""
    model, drives = build.model, build.model.drives
    lines, joints = model.lines, model.joints
    chambers: list[Row] = []
    for n, joint in enumerate(lines.joint.tolist()):
        sense, zero = (joints.sense[joint], joints.zero[joint]) if joint >= 0 else (1.0, 0.0)
        ends = build.ends(lines.bodies[n], *(() if joint >= 0 else lines.anchor[n]))
        chambers.append(ends | {"turns": joint >= 0, "gain": sense * lines.gain[n],
                                "start": sense * (lines.start[n] + zero)})
    fluids = fill(
        records.FLUID, len(lines.name), first=lines.first[:-1], last=lines.first[1:],
        drive=lines.drive, volume=lines.volume, c=lines.compliance, gas=np.nan_to_num(lines.gas),
        start=lines.pressure, pressure=lines.pressure, minimum=lines.least,
        maximum=lines.most,
        response=stiffnesses.line_responses(model))
    with np.errstate(divide="ignore"):
        of_gas = fluids["volume"] * (fluids["start"] / ATMOSPHERE + 1.0) ** (1.0 / fluids["gas"])
    of_liquid = fluids["c"] * fluids["start"]
    fluids["content"] = np.where(fluids["gas"] > 0, of_gas, of_liquid)
    stiff = build.h * build.h * fluids["response"] > records.SOFT * lines.compliance
    meet = [(a, b) for a, b in model.valves.lines.tolist() if a >= 0 and b >= 0]
    beside = stiff.copy()  # stiff lines, and those that valves join to them
    for a, b in len(meet) * meet:
        beside[a] = beside[b] = beside[a] or beside[b]
    fluids["ahead_min"], fluids["ratio"] = stiff, np.where(beside, 1.5, 2.0)
    for fluid in fluids:
        own = chambers[fluid["first"]:fluid["last"]]
        bodies = sorted({chamber[end] for chamber in own for end in "ab"})
        fluid["row"], entry = build.add(*bodies)
        for chamber in own:
            for end in "ab":
                chamber[f"entry_{end}"] = entry + bodies.index(chamber[end])
    valves = fill(
        records.VALVE, len(model.valves.name), a=model.valves.lines[:, 0],
        b=model.valves.lines[:, 1], r=model.valves.resistance, k=model.valves.orifice,
        one_way=model.valves.one_way, drive=model.valves.drive, slot=-1)
    which = drives.giving("flow", "pressure")
    pumps = fill(records.PUMP, len(which), drive=which, line=drives.target[which],
                 source=np.isfinite(drives.resistance[which]),
                 r=np.nan_to_num(drives.resistance[which]))
    own_rows = fluids["row"].tolist()
    return ({"fluids": fluids, "chambers": records_of(chambers, records.CHAMBER),
             "valves": valves, "pumps": pumps}, [(own_rows[a], own_rows[b]) for a, b in meet])


def bond_table(model: Model, springs: Records, cables: Records) -> Records:
    """BOND, [nr]; spans of tendons get the number of their tendon's."""
    bonds = model.bonds
    table = fill(
        records.BOND, len(bonds.name), breaks_at=bonds.breaks_at, over=bonds.over,
        as_is=bonds.as_is, drive=bonds.drive, held=bonds.held, driven=bonds.held,
        last_load=np.nan, age=records.SETTLED, request=records.NONE)
    for what, numbers in ((records.SPRINGY, springs["bond"]), (records.JOINED, bonds.joint),
                          (records.PULLING, bonds.tendon)):
        own = np.flatnonzero(numbers >= 0)
        table["what"][numbers[own]], table["index"][numbers[own]] = what, own
    numbers = np.where(cables["whole"] < 0, np.arange(len(cables)), cables["whole"])
    cables["bond"] = bonds.tendon[numbers]
    return table


def add_paths(joints: Records, model: Model, spans: Records) -> Records:
    """Put the paths of slots into JOINT; returns ``spans`` with theirs added."""
    tables = [spans]
    for j, path in enumerate(model.joints.path):
        if path is None:
            continue
        first = sum(map(len, tables))
        x, y = model.bodies.centre[model.joints.bodies[j, 0]].tolist()
        table = span_table(path.nodes, (x, y), first, closed=path.closed)
        table["start"] = path.starts[:-1]
        tables.append(table)
        place = float(of_joint.place_in_slot(model, j, model.bodies.pose).along)
        joints[j]["span"], joints[j]["span_end"] = first, first + len(table)
        joints[j]["around"] = path.length if path.closed else 0.0
        joints[j]["place"] = place
        joints[j]["on"] = first + np.searchsorted(path.starts[1:-1], place, side="right")
    return np.concatenate(tables)


def measure_joints(joints: Records, body: Array) -> None:
    """Measure hinges and actuators: they are read before the first step."""
    turn = np.zeros((len(body), 2))
    note_turns(body, turn)
    for joint in joints:
        if joint["hinge"]:
            measure_angle(joint, body)
        elif joint["span"] >= 0:
            joint["way"] = joint["place"]
        elif joint["line"]:
            measure_distance(joint, body, turn)
        note_rate(joint, body, body[:, 3:])


class CableTables(NamedTuple):
    """CABLE and GUIDE, spans after whole tendons; SLIP."""

    cables: Records
    guides: Records
    slips: Records
    drag: Array  # of the slips of loops [N s^2/m], 0 of others


def cable_tables(build: Builder) -> CableTables:
    """Tables of all tendons; their rows are added."""
    model, tendons = build.model, build.model.tendons
    whole = len(tendons.name)
    spans = [span for cable in range(whole) for span in spans_of(tendons, cable)]
    path = np.array([*range(len(tendons.guide_body)), *(g for span in spans for g in span.guides)],
                    dtype=np.int64)
    body, off = tendons.guide_body[path], lifted_at_start(model)[path]
    x, y = (tendons.guide_at[path] - model.bodies.centre[body]).T
    guides = fill(
        records.GUIDE, len(path), body=build.number[body], x=x, y=y,
        radius=tendons.guide_radius[path], turns=tendons.guide_turns[path],
        lifts=np.isin(path, tendons.wheels), lifted=off, wrap=np.where(off, BESIDE, 0.0))
    ends = np.cumsum([*np.diff(tendons.first), *(len(span.guides) for span in spans)])
    cables = fill(
        records.CABLE, whole + len(spans), active=1, row=-1, drive=-1, stiffener=-1, whole=-1,
        into=-1, out_of=-1, first=[0, *ends[:-1]][:len(ends)], last=ends)
    for name, values in (("closed", tendons.closed), ("drive", tendons.drive),
                         ("stiffener", tendons.stiffener), ("k", tendons.stiffness),
                         ("c", tendons.damping), ("response", stiffnesses.cable_responses(model))):
        cables[name][:whole] = values
    found = CableTables(cables, guides, np.zeros(len(tendons.grips), records.SLIP),
                        np.zeros(len(tendons.grips)))
    stiff, turn = stiffnesses.stiff_cables(model, build.h), np.zeros((len(build.pose), 2))
    note_turns(build.pose, turn)
    for e, cable in enumerate(cables):
        cable["lifts"] = guides["lifts"][cable["first"]:cable["last"]].any()
        cable["length"] = measure(cable, guides, build.pose, turn, True)
        if e >= whole:
            continue
        length = float(cable["length"])
        rest = length if np.isnan(tendons.rest[e]) else tendons.rest[e]
        if not np.isnan(tendons.pretension[e]):
            rest = length - tendons.pretension[e] / tendons.stiffness[e]
        cable["rest"] = rest + tendons.slack[e]
        if len(tendons.gripped(e)):
            cable["kind"] = records.GRIPPED
            continue
        cable["kind"] = (records.PULL if cable["drive"] >= 0 else records.STIFF if stiff[e]
                         else records.DAMPED if cable["c"] > 0 else records.ELASTIC)
        if cable["kind"] in (records.STIFF, records.DAMPED) and cable["response"] > 0:
            _add_row(build, found, e)
    _add_spans(build, found, spans, stiff)
    return found


def _add_row(build: Builder, found: CableTables, e: int, *slides: int) -> None:
    """The row of a tendon: entries of its bodies, then of the slips into it and out of it."""
    cable = found.cables[e]
    own = found.guides[cable["first"]:cable["last"]]
    bodies, place = np.unique(own["body"], return_inverse=True)
    cable["row"], cable["entry"] = build.add(*bodies.tolist(), *slides)
    cable["entries"], own["entry"] = len(bodies), cable["entry"] + place


def _add_spans(build: Builder, found: CableTables, spans: list[CableSpan], stiff: Flags) -> None:
    """The spans after the whole tendons, and the slips between them."""
    tendons, bodies, cables = build.model.tendons, len(build.inverse_mass), found.cables
    whole, count = len(tendons.name), len(tendons.grips)
    for e, span in enumerate(spans, start=whole):
        cable, own = cables[e], cables[span.tendon]
        cable["whole"] = span.tendon
        if own["spans_end"] == 0:
            own["spans"] = e
        own["spans_end"] = e + 1
        cable["k"], cable["c"] = own["k"] * own["rest"], own["c"] * own["rest"]
        if span.out_of < 0 and own["drive"] >= 0:
            cable["kind"], cable["drive"] = records.PULL, own["drive"]
            continue
        ends = [(name, k) for name, k in (("into", span.into), ("out_of", span.out_of)) if k >= 0]
        _add_row(build, found, e, *(bodies + k for _, k in ends))
        for entry, (name, _) in enumerate(ends, start=cable["entry"] + cable["entries"]):
            cable[name] = entry
    for e in np.flatnonzero(cables["kind"] == records.GRIPPED).tolist():
        own, length, rest = cables[e], float(cables[e]["length"]), float(cables[e]["rest"])
        part = cables[int(own["spans"]):int(own["spans_end"])]
        # the tendon in a span at t = 0 is stretched like the whole, or has its share of the slack;
        # the tendon on wheels that hold it is stretched, too, but does not hang
        inside = part["length"] * (
            rest / length if rest <= length else 1 + (rest - length) / part["length"].sum())
        part["rest"] = part["inside"] = inside
        part["minimum"] = MIN_INSIDE * inside
        # all spans are solved alike: at the step's end if one of them is too stiff
        largest = (part["k"] / inside).max()
        quick = stiff[e] or build.h**2 * largest * own["response"] > records.SOFT
        part["kind"][part["row"] >= 0] = records.STIFF if quick else records.EVEN
        if own["closed"]:
            found.drag[tendons.gripped(e)] = DRAG * build.h**2 * largest
    before = {span.out_of: e for e, span in enumerate(spans, start=whole)}
    after = {span.into: e for e, span in enumerate(spans, start=whole)}
    for k, slip in enumerate(found.slips):
        slip["before"], slip["after"] = before[k], after[k]
        slip["cable"] = cable = cables[before[k]]["whole"]
        slip["guide"], slip["friction"] = tendons.grips[k], tendons.friction[k]
        path = tendons.guides(int(cable))
        first = tendons.closed[cable] and slip["guide"] == path.start
        slip["twin"] = path.stop - 1 if first else -1
        slip["slide"], slip["sum"] = bodies + k, bodies + count + k
