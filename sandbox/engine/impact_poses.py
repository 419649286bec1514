"""Joints at the instant of an impact, and the pose that an impact displaces.

Joints answer an impact with their directions where it happens, s after the pose x of the step. The
step itself is solved with those of x. Its joints are closed where it leads, which is

    x - s Δv + h v

for a change Δv of the velocities. At x - s Δv they are open by some s²; a step asks for no change
of that, so that its velocities are right, and the pose is then displaced further to close them.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bonds import release_rows
from sandbox.engine.bounded import choose, eliminate, free_rate, make_system, push
from sandbox.engine.coordinates import ends
from sandbox.engine.entry_points import entry_point
from sandbox.engine.instants import mean
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add, backward, clear, forward, put
from sandbox.engine.records import GEAR, GROOVE, ROLL
from sandbox.engine.rows import (
    answer,
    apply_impulses,
    closed,
    joint_gaps,
    joint_rows,
    note_turns,
    right_side,
)
from sandbox.engine.state import NORMAL, TANGENT
from sandbox.numeric import Array

CLOSINGS = 3
"""Most times that joints are closed where an impact leads."""


@entry_point("bounces")
def add_shift(table: int, h: float) -> None:
    """Let ``velocity`` lead from the displaced pose, until :func:`remove_shift`."""
    shift, velocity = at.shift(table), at.velocity(table)
    put(at.placed(table), velocity)
    for b in range(len(shift)):
        for j in range(3):
            velocity[b, j] += shift[b, j] / h


@entry_point("bounces")
def remove_shift(table: int) -> None:
    """Undo :func:`add_shift`."""
    put(at.velocity(table), at.placed(table))


@kernel
def displaced_gaps(table: int, h: float) -> float:
    """:func:`joint_gaps` where the velocities lead from the displaced pose."""
    clear(at.unknowns(table)[4])
    add_shift(table, h)
    gap = joint_gaps(table, h)
    remove_shift(table)
    return gap


@kernel
def place_joints(table: int, h: float, now: float) -> None:
    """Coefficients of the joints where the step leads at an instant."""
    body, turn, kept = at.body(table), at.turn(table), at.placed(table)
    for b in range(len(body)):
        for j in range(3):
            kept[b, j] = body[b, j]
            body[b, j] += now * mean(table, h, now, b, j)
    note_turns(body, turn)
    joint_rows(table, h)
    release_rows(table, h)
    put(body, kept)
    note_turns(body, turn)


@kernel
def answer_of_joints(table: int, velocity: Array) -> None:
    """Impulses with which bilateral rows answer a change of velocities, into ``unknowns``."""
    clear(at.unknowns(table)[4])
    answer(table, velocity, at.unknowns(table)[4], at.unknowns(table)[5])


@kernel
def add_joints(table: int, velocity: Array, times: float) -> None:
    """Add what these impulses of joints alone do to velocities."""
    joints, impulses, entry_row = at.joints(table), at.unknowns(table)[5], at.entry_row(table)
    entry_body, WJ = at.entry_body(table), at.entries(table)[1]
    for k in range(len(joints)):
        for e in range(joints[k]["entry"], joints[k]["entry"] + joints[k]["entries"]):
            for j in range(3):
                velocity[entry_body[e], j] += times * WJ[e, j] * impulses[entry_row[e]]


@kernel
def note_joints(table: int, times: float) -> None:
    """Add these impulses to what joints carry besides the impulses of their rows."""
    joints, impulses = at.joints(table), at.unknowns(table)[5]
    J, entry_row = at.entries(table)[0], at.entry_row(table)
    for k in range(len(joints)):
        joint, first = joints[k], joints[k]["entry"]
        for e in range(first, first + joint["entries"], 2):
            p = times * impulses[entry_row[e]]
            joint["kick_x"] += p * J[e + 1, 0]
            joint["kick_y"] += p * J[e + 1, 1]
            joint["twist_a"] += p * J[e, 2]
            joint["twist_b"] += p * J[e + 1, 2]


@entry_point("bounces")
def take_impacts(table: int, h: float, struck: bool) -> None:
    """Add impacts to the free velocities, with joints at the pose of the step again.

    The rows of joints still answer there, so only what their answer in the pose of the impact
    differs by is added. Rows then ask for gaps no smaller than where impacts displace the pose.
    """
    shift, delayed, velocity, unknowns = (
        at.shift(table), at.delayed(table), at.velocity(table), at.unknowns(table))
    if struck and len(at.joints(table)) > 0:
        add_joints(table, at.kick(table), -1.0)
        note_joints(table, -1.0)
        body, turn = at.body(table), at.turn(table)
        for k in range(len(at.joints(table))):  # twists keep what forces at the points do not do
            joint = at.joints(table)[k]
            ax, ay, bx, by, px, py = ends(joint, body, turn)
            share = 0.0  # of the way to the point of b, to where a slot or wheels act on a
            if joint["keeps"] == GROOVE:
                share = 1.0
            elif joint["keeps"] == GEAR or joint["keeps"] == ROLL:
                share = joint["ra"] / (joint["ra"] + joint["rb"])
                bx, by = bx - (1.0 - share) * px, by - (1.0 - share) * py
            ax, ay = ax + share * px, ay + share * py
            joint["twist_a"] -= ay * joint["kick_x"] - ax * joint["kick_y"]
            joint["twist_b"] -= bx * joint["kick_y"] - by * joint["kick_x"]
        clear(unknowns[4])
        clear(unknowns[5])
        for b in range(len(shift)):
            for j in range(3):
                shift[b, j] = -delayed[b, j]
                velocity[b, j] = shift[b, j] / h
        joint_gaps(table, h)
        for r in range(unknowns.shape[1]):
            unknowns[5, r] = -h * unknowns[4, r]
    add(at.free(table), at.kick(table), 1.0)


@entry_point("bounces")
def lead_back(table: int, h: float, n: int) -> None:
    """Displace the pose by what impacts after it change, times their instants; joints answer."""
    rows, unknowns, shift, delayed = (
        at.rows(table), at.unknowns(table), at.shift(table), at.delayed(table))
    Y, reached, A, chosen = at.columns(table), at.reached(table), at.system(table), at.chosen(table)
    for b in range(len(shift)):
        for j in range(3):
            shift[b, j] = -delayed[b, j]
    clear(unknowns[4])
    right_side(table, shift, unknowns[4], unknowns[2])
    forward(at.starts(table), at.below(table), at.values(table), unknowns[2])
    m = 0
    for q in range(choose(rows, n, chosen)):
        if _holds(table, rows[chosen[q]]):
            chosen[m] = chosen[q]
            m += 1
    make_system(rows, n, at.delassus(table), A, chosen, m)
    for q in range(m):
        k = chosen[q]
        A[q, m] = 0.0 if rows[k]["out"] else -free_rate(
            table, rows[k], Y[k], reached[k], shift, 0.0)
    eliminate(A, m)
    for r in range(unknowns.shape[1]):
        unknowns[4, r] = unknowns[2, r]
    for q in range(m):
        k = chosen[q]
        _answer(table, k, A[q, m])
        if k + 1 < n and rows[k + 1]["normal"] == k and rows[k + 1]["mode"] != 0:
            _answer(table, k + 1, rows[k + 1]["mode"] * rows[k + 1]["friction"] * A[q, m])
    backward(at.starts(table), at.below(table), at.values(table), unknowns[4])
    apply_impulses(table, unknowns[4], shift)
    _close(table, h)


@kernel
def _close(table: int, h: float) -> None:
    """Displace the pose further, so that joints are closed where the velocities lead from there."""
    unknowns = at.unknowns(table)
    clear(unknowns[5])
    for _ in range(CLOSINGS):
        if displaced_gaps(table, h) < closed(h):
            break
        forward(at.starts(table), at.below(table), at.values(table), unknowns[4])
        backward(at.starts(table), at.below(table), at.values(table), unknowns[4])
        for r in range(unknowns.shape[1]):
            unknowns[4, r] *= h
        apply_impulses(table, unknowns[4], at.shift(table))


@kernel
def _holds(table: int, row: Any) -> bool:
    """Whether a row held already before the impacts; a contact that closes in the step did not."""
    if row["source"] == NORMAL or row["source"] == TANGENT:
        return bool(at.found(table)[row["index"]]["listed"] == 1)
    return not row["measure"]


@kernel
def _answer(table: int, k: int, p: float) -> None:
    """Add what bounded row ``k`` answers to the displacement, and to what bilateral rows do."""
    row, answer, y, reached = (
        at.rows(table)[k], at.unknowns(table)[4], at.columns(table)[k], at.reached(table)[k])
    for q in range(row["branch"]):
        answer[reached[q]] -= y[reached[q]] * p
    push(at.inverse_mass(table), row, p, at.shift(table))
