"""Release and engagement of joints, springs and tendons.

A released element keeps its rows, without coefficients and right side and with a compliance of 1:
their impulses are 0. Breaks: :mod:`sandbox.engine.report`.

A joint that engages across a gap f closes it as

    f(t) = (f0 + (f0' + f0 / T) t) exp(-t / T)

with t the time since then: a body of mass m needs a force of m f0 / T^2 at most, where the whole
gap at once would take m f0 / h^2.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from sandbox.elements.element import HELD_ABOVE
from sandbox.engine import memory as at
from sandbox.engine import records
from sandbox.engine.coordinates import ends, gaps, path_gap, toothed
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array
from sandbox.samples.outcome import Happened

if TYPE_CHECKING:
    from sandbox.engine.tables import Tables

CLOSED_AFTER = 40.0  # times `over`, after which a joint is closed: e^-40 of its gap is left


@kernel
def holds(table: int, bond: int) -> bool:
    """Whether what has this number, or none, holds."""
    return bool(bond < 0 or at.bonds(table)[bond]["held"] == 1)


@kernel
def joint_holds(table: int, joint: int) -> bool:
    """Whether a joint holds."""
    return holds(table, at.joints(table)[joint]["bond"])


@kernel
def spring_holds(table: int, spring: Any) -> bool:
    """Whether a spring acts: neither it nor its hinge is released."""
    return holds(table, spring["bond"]) and holds(table, spring["hinge_bond"])


@kernel
def acts(table: int, bond: int) -> bool:
    """Whether a bond holds, or did not break in this step, in which its force is stored already."""
    return bool(bond < 0 or (at.bonds(table)[bond]["held"] == 1
                            or at.bonds(table)[bond]["broke"] == 0))


@entry_point("bonds")
def release_and_engage(table: int, drive: Array) -> None:
    """Release and engage elements as events and changed drives [nd] request."""
    bonds = at.bonds(table)
    for i in range(len(bonds)):
        request, bonds[i]["request"] = bonds[i]["request"], records.NONE
        if bonds[i]["drive"] >= 0:
            driven = 1 if drive[bonds[i]["drive"]] > HELD_ABOVE else 0
            if driven != bonds[i]["driven"]:
                request = bonds[i]["driven"] = driven
        if request == records.NONE or request == bonds[i]["held"]:
            continue
        bonds[i]["held"], what, index = request, bonds[i]["what"], bonds[i]["index"]
        if request == 1 and what == records.JOINED:
            bonds[i]["age"] = records.TAKEN
        elif request == 1 and bonds[i]["as_is"]:  # its length now is the one at rest
            if what == records.SPRINGY and not at.springs(table)[index]["turning"]:
                at.springs(table)[index]["rest"] = at.springs(table)[index]["way"]
            for k in range(len(at.cables(table)) if what == records.PULLING else 0):
                if at.cables(table)[k]["bond"] == i:
                    at.cables(table)[k]["rest"] = at.cables(table)[k]["length"]


@kernel
def empty_rows(table: int, entry: int, count: int) -> None:
    """Let the rows of so many entries act on nothing and carry nothing."""
    J, entry_row, unknowns = at.entries(table)[0], at.entry_row(table), at.unknowns(table)
    for e in range(entry, entry + count):
        J[e, 0] = J[e, 1] = J[e, 2] = 0.0
        unknowns[0, entry_row[e]], unknowns[1, entry_row[e]] = 0.0, 1.0


@entry_point("bonds")
def release_rows(table: int, h: float) -> None:
    """Empty the rows of released elements; let engaging joints close their gaps gradually."""
    if len(at.bonds(table)) == 0:
        return
    for i in range(len(at.bonds(table))):
        at.bonds(table)[i]["broke"] = 0
    joints, springs, rhs = at.joints(table), at.springs(table), at.unknowns(table)[0]
    for k in range(len(joints)):
        joint = joints[k]
        if not holds(table, joint["bond"]):
            empty_rows(table, joint["entry"], joint["entries"])
            continue
        if joint["bond"] < 0:
            continue
        state, teeth = at.bonds(table)[joint["bond"]], toothed(joint)
        for row in (joint["row"], joint["row_y"], joint["row_turn"]):
            if row >= 0 and not teeth:
                at.unknowns(table)[1][row] = 0.0
        if state["age"] == records.TAKEN:
            _look(table, k)
        x, y, t = remaining_gap(table, joint["bond"], h)
        if joint["row"] >= 0 and not teeth:
            rhs[joint["row"]] += x / h
        if joint["keeps"] == records.POINT and joint["row_y"] >= 0:
            rhs[joint["row_y"]] += y / h
        if joint["row_turn"] >= 0:
            rhs[joint["row_turn"]] += state["turns"] / h
            rhs[joint["row_turn"]] += t / h
    for k in range(len(springs)):
        if springs[k]["row"] >= 0 and not spring_holds(table, springs[k]):
            empty_rows(table, springs[k]["entry"], 2)


@kernel
def remaining_gap(table: int, bond: int, ahead: float) -> tuple[float, float, float]:
    """The gaps [m, m, rad] that a joint may have ``ahead`` [s] of now."""
    if bond < 0:
        return 0.0, 0.0, 0.0
    state, over = at.bonds(table)[bond], at.bonds(table)[bond]["over"]
    if state["age"] < 0.0:
        return 0.0, 0.0, 0.0
    t = state["age"] + ahead
    fades = math.exp(-t / over)
    return (float((state["x"] + (state["vx"] + state["x"] / over) * t) * fades),
            float((state["y"] + (state["vy"] + state["y"] / over) * t) * fades),
            float((state["t"] + (state["vt"] + state["t"] / over) * t) * fades))


@kernel
def _look(table: int, k: int) -> None:
    joint, body, before, turn = (
        at.joints(table)[k], at.body(table), at.before(table), at.turn(table))
    state = at.bonds(table)[joint["bond"]]
    a, b = joint["a"], joint["b"]
    ax, ay, bx, by, px, py = ends(joint, body, turn)
    wa, wb = before[a, 2], before[b, 2]
    vx = before[b, 0] - wb * by - before[a, 0] + wa * ay
    vy = before[b, 1] + wb * bx - before[a, 1] - wa * ax
    (x, y), (rx, ry) = gaps(joint, px, py, turn[a, 0], turn[a, 1]), (vx, vy)
    if joint["keeps"] == records.GROOVE:
        dx, dy = joint["dx"], joint["dy"]
        rx, ry = dx * vy - dy * vx - wa * (dx * px + dy * py), 0.0
        if joint["span"] >= 0:
            x = path_gap(table, 0.0, k)
    elif joint["keeps"] != records.POINT:
        way = math.hypot(px, py)
        rx, ry = (px * vx + py * vy) / way if way > 0.0 else 0.0, 0.0
    if joint["keeps"] == records.RANGE:
        x = rx = 0.0
    askew = body[b, 2] - body[a, 2] - joint["turn"]
    state["turns"] = 2 * math.pi * math.floor(askew / (2 * math.pi) + 0.5)
    state["x"], state["y"], state["t"] = x, y, askew - state["turns"]
    state["vx"], state["vy"], state["vt"] = rx, ry, wb - wa
    state["age"] = 0.0


@entry_point("bonds")
def report_bonds(table: int, h: float) -> None:
    """Store loads and ages for the next step."""
    bonds = at.bonds(table)
    for i in range(len(bonds)):
        bonds[i]["last_load"] = bonds[i]["load"] if bonds[i]["held"] == 1 else math.nan
        if bonds[i]["age"] >= 0.0:
            bonds[i]["age"] += h
            if bonds[i]["age"] > CLOSED_AFTER * bonds[i]["over"]:
                bonds[i]["age"] = records.SETTLED


def taken_breaks(tables: Tables, names: Sequence[str], before: int, h: float) -> list[Happened]:
    """The breaks since the last call, after ``before`` steps."""
    made, broken = tables.state.made, tables.state.broken
    found: list[Happened] = []
    for one in broken[:made[2]]:
        time = (before + float(one["row"]) - 0.5 + float(one["when"])) * h
        # what breaks by what another leaves to it does so no earlier
        found.append(Happened(names[one["bond"]], max(time, found[-1].time if found else time)))
    made[2] = 0
    return found


def hold(tables: Tables, bond: int, *, held: bool) -> None:
    """Release or engage an element with the next step."""
    tables.elements.bonds[bond]["request"], tables.state.standing[1] = held, 0
