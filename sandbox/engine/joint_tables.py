"""Tables of joints with their limits, dry friction, motors and springs."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.elements.joint import Keeps
from sandbox.engine import records
from sandbox.engine.law_tables import LawTables
from sandbox.engine.plan import PlacedBodies, Rows
from sandbox.engine.stiffness import stiff_servos
from sandbox.model.joints import flank_of, sliding, slip_of, slot_length, turning
from sandbox.model.model import Model
from sandbox.numeric import Flags, Records

KEEPS: dict[Keeps, int] = {
    "point": records.POINT, "groove": records.GROOVE, "distance": records.DISTANCE,
    "range": records.RANGE, "gear": records.GEAR, "rack": records.RACK, "roll": records.ROLL}
"""How compiled code tells apart what joints keep."""


def records_of(rows: list[dict[str, Any]], record: np.dtype[Any]) -> Records:
    """A table of rows that are given as mappings; fields left out are 0."""
    table = np.zeros(len(rows), dtype=record)
    for row, values in zip(table, rows, strict=True):
        for key, value in values.items():
            row[key] = value
    return table


def motor_table(places: PlacedBodies, h: float) -> tuple[Records, dict[int, int]]:
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
            placed = records.PLACED if np.isnan(drives.stiffness[i]) else records.SPRUNG
            law = placed if kind.places else records.PACED
            rows.append({
                "drive": i, "a": a, "b": b, "sense": 1.0 if line else joints.sense[joint],
                "most": drives.most[i], "slope": drives.slope[i],
                "tie": places.model.ties.joint[joint], "law": law, "joint": joint, "line": line,
                "k": drives.stiffness[i], "c": drives.damping[i], "stiff": stiff[i],
                "fastest": drives.fastest[i], "zero": 0.0 if line else joints.zero[joint]})
    return records_of(rows, records.MOTOR), found


def action_table(places: PlacedBodies, motors: dict[int, int]) -> Records:
    """Drives that act on bodies; ``motors`` are the rows of motors by the drive's number."""
    model, number = places.model, places.number
    drives, joints = model.drives, model.joints
    rows: list[dict[str, Any]] = []
    for i in drives.giving("force", "torque", "push", "surface").tolist():
        target = int(drives.target[i])
        row: dict[str, Any] = {"drive": i, "motor": motors.get(i, -1), "tie": -1, "joint": -1}
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
        rows.append(row | {"a": a, "b": b, "joint": target, "line": line,
                           "sense": 1.0 if line else joints.sense[target],
                           "tie": model.ties.joint[target]})
    return records_of(rows, records.ACTION)


def joint_table(places: PlacedBodies, rows: Rows) -> Records:
    """All joints; their rows are added."""
    model, number = places.model, places.number
    joints, poses = model.joints, model.bodies.pose
    table: list[dict[str, Any]] = []
    for i, kind in enumerate(joints.kind):
        bodies = joints.bodies[i].tolist()
        a, b = number[bodies].tolist()
        path, start = joints.path[i], joints.anchor[i, 0]
        if kind.keeps == "groove":
            start = joints.groove[i, 0] if path is None else path.nodes[0, :2]
        (ax, ay), (bx, by) = (places.local(bodies[0], start),
                              places.local(bodies[1], joints.anchor[i, 1]))
        row: dict[str, Any] = {
            "keeps": KEEPS[kind.keeps], "a": a, "ax": ax, "ay": ay, "b": b, "bx": bx, "by": by,
            "row": -1, "row_y": -1, "row_turn": -1,
            "turn": poses[bodies[1], 2] - poses[bodies[0], 2], "hinge": joints.angle[i],
            "stopped": np.isfinite(joints.stops[i]).all(), "sense": joints.sense[i],
            "zero": joints.zero[i], "tie": model.ties.joint[i], "span": -1,
            "line": kind.line or path is not None}
        if path is not None:
            row["reach"] = 1.0 / max(float(np.abs(path.nodes[:, 3]).max()), 1.0 / path.length)
        elif kind.keeps == "groove":
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
    return records_of(table, records.JOINT)


def limit_table(places: PlacedBodies) -> Records:
    """Stops of hinges, limits of lengths and of grooves, play of teeth."""
    joints = places.model.joints
    rows: list[dict[str, Any]] = []
    for i, kind in enumerate(joints.kind):
        if not places.inverse_mass[places.number[joints.bodies[i]]].any():
            continue
        if np.isfinite(joints.stops[i]).all():
            low, high = sorted(joints.sense[i] * (joints.stops[i] + joints.zero[i]))
            rows += _both(i, records.STOP, low, high)
        if kind.keeps == "range":
            rows += _both(i, records.LINE, *joints.reach[i])
        if kind.keeps == "groove":
            rows += _both(i, records.LINE, 0.0, slot_length(places.model, i))
        if joints.play[i] > 0:
            play = joints.play[i] * math.cos(joints.pressure[i]) / 2
            rows += [{"joint": i, "what": records.FLANK, "side": side, "bound": -play}
                     for side in (1.0, -1.0)]
    return records_of(rows, records.LIMIT)


def _both(joint: int, what: int, low: float, high: float) -> list[dict[str, Any]]:
    return [{"joint": joint, "what": what, "side": side, "bound": bound}
            for side, bound in ((1.0, low), (-1.0, high)) if math.isfinite(bound)
            and not (what == records.LINE and side > 0 and bound <= 0.0 and high == math.inf)]


def spring_table(
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
        row["kind"] = records.STIFF if stiff[i] else records.DAMPED if c > 0 else records.ELASTIC
        if (row["kind"] != records.ELASTIC or springs.law[i]) and inverse[[a, b]].any():
            row["row"], row["entry"] = rows.add(a, b)
        table.append(row)
        rests.append(rest)
    for joint in joints.hinges.tolist():
        a, b = number[joints.bodies[joint]].tolist()
        if model.hinge_damping[joint] > 0 and inverse[[a, b]].any():
            first, entry = rows.add(a, b)
            table.append({"number": -1, "joint": joint, "turning": 1, "kind": records.DAMPED,
                          "drive": -1, "a": a, "b": b, "c": model.hinge_damping[joint],
                          "sense": 1.0, "row": first, "entry": entry, "code": -1, "tie": -1,
                          "hinge_tie": ties.joint[joint]})
            rests.append(0.0)
    return records_of(table, records.SPRING), rests


def dry_friction_table(
    joints: Records, model: Model, first: int,
) -> tuple[Records, list[tuple[int, int]]]:
    """Dry friction of joints on free bodies; pairs of rows whose load bounds it.

    Args:
        joints: JOINT, with the numbers of their rows.
        model: the mechanism.
        first: the number of the first sum of rows.
    """
    held = [j for j in model.joints.rubbed.tolist() if joints[j]["row"] >= 0]
    table = np.zeros(len(held), records.DRY_FRICTION)
    sums: list[tuple[int, int]] = []
    for rub, j in zip(table, held, strict=True):
        rub["joint"], rub["sum"] = j, -1
        rub["most"], rub["share"] = model.joints.friction[j], model.joints.rubbing[j]
        rub["static"] = model.joints.static[j]
        if rub["share"] > 0:
            rub["sum"] = first + len(sums)
            one, two = int(joints[j]["row"]), int(joints[j]["row_y"])
            sums.append((one, two if two >= 0 else one))
    return table, sums


def begin_friction(state: Records, rubs: Records, model: Model) -> None:
    """Set DRY_FRICTION_STATE at t = 0: joints that move slip, those at rest hold."""
    state["ux"], state["bound"] = 1.0, np.nan
    for own, j in zip(state, rubs["joint"].tolist(), strict=True):
        slides = model.joints.kind[j].keeps == "groove"
        own["mode"] = -np.sign(sliding(model, j) if slides else turning(model, j))


def wheel_fields(model: Model, i: int) -> dict[str, Any]:
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
