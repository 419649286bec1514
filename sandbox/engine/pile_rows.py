"""Bilateral rows in piles: bodies that joints, springs, tendons, fluids or loads act on.

The matrix of a pile (:mod:`sandbox.engine.piles`) then has a node for up to three rows that act on
the same bodies, besides one for each body. With H the block of the bodies, B the rows, c their
compliances, du and dp the changes of velocities and impulses, Newton's method solves

    [ H   B^T ] [  du ]   [ -F ]
    [ B   -c  ] [ -dp ] = [  0 ]

A row is eliminated after its own bodies, so that it has a pivot. Impulses of contacts are answered
by the factor of the bilateral rows alone (:mod:`sandbox.engine.plan`), which has all kinds of rows.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from sandbox.engine import memory as at
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import Pattern, clear
from sandbox.engine.records import PLACED
from sandbox.engine.rows import apply_impulses, backward, forward, right_side
from sandbox.engine.state import Elements
from sandbox.numeric import Array, Flags, Integers, Matrix, Records

MIN_SINGLE, MIN_LINKED = 12, 40
"""Minimum number of free bodies of piles, and of all bodies of piles with bilateral rows; with
fewer the direct solver is as fast."""
MAX_NODES = 2000  # of bodies and rows, for the memory that they take
RIGID_COMPLIANCE = 1e-12  # of rigid rows, as a share of the response of their bodies


class PileTables(NamedTuple):
    """Bodies and rows that may be in piles."""

    loose: Integers  # the number of each body among those that may be in a pile, or -1
    cluster: Integers
    """Of each such body the first one of those that rows connect, -1 if none do."""
    nodes: Integers  # the unknowns of the rows of each node, or -1, [n, 3]
    blocks: Integers  # (node, loose body) of each block of B, [m, 2]
    entries: Integers  # (entry, block, row in it) of the entries of the rows


def pile_tables(
    pattern: Pattern, inverse_mass: Array, elements: Elements, shapes: Records,
) -> PileTables:
    """Find the bodies that may be in piles, and the rows between them."""
    count, joints = len(inverse_mass), elements.joints
    free, shaped = inverse_mass[:, 0] > 0.0, np.isin(np.arange(count), shapes["body"])
    rows: dict[int, list[tuple[int, int]]] = {}
    for entry, (row, body) in enumerate(zip(
            pattern.entry_row.tolist(), pattern.entry_body.tolist(), strict=True)):
        rows.setdefault(row, []).append((body, entry))
    groups = [[body for body, _ in own] for own in rows.values()]
    groups += [[joint["a"], joint["b"]] for joint in joints]
    held = np.zeros(count, dtype=bool)
    held[[body for group in groups for body in group if body < count]] = True
    single = free & shaped & ~held
    if np.count_nonzero(single) < MIN_SINGLE:
        single[:] = False
    lowest = _clusters(count, [[body for body in group if body < count and free[body]]
                               for group in groups])
    linked = _linked(elements, rows, lowest, free & held)
    nodes: dict[tuple[int, ...], list[list[int]]] = {}
    for row, own in rows.items():
        bodies = sorted({body for body, _ in own if body < count and linked[body]})
        if bodies:
            of_bodies = nodes.setdefault(tuple(bodies), [[]])
            if len(of_bodies[-1]) == 3:
                of_bodies.append([])
            of_bodies[-1].append(row)
    if (np.count_nonzero(single | linked) < MIN_LINKED
            or np.count_nonzero(single | linked) + sum(map(len, nodes.values())) > MAX_NODES):
        linked[:] = False
        nodes = {}
    loose = np.where(single | linked, np.cumsum(single | linked) - 1, -1)
    found = [(bodies, own) for bodies, lists in nodes.items() for own in lists]
    blocks = [(node, int(loose[body])) for node, (bodies, _) in enumerate(found) for body in bodies]
    numbers = {block: number for number, block in enumerate(blocks)}
    entries = [(entry, numbers[node, int(loose[body])], place)
               for node, (bodies, own) in enumerate(found) for place, row in enumerate(own)
               for body, entry in rows[row] if body in bodies]
    return PileTables(
        loose.astype(np.int64), np.where(linked, loose[lowest], -1)[single | linked],
        np.array([own + [-1] * (3 - len(own)) for _, own in found], np.int64).reshape(-1, 3),
        np.array(blocks, np.int64).reshape(-1, 2), np.array(entries, np.int64).reshape(-1, 3))


def _linked(
    elements: Elements, rows: dict[int, list[tuple[int, int]]], lowest: Integers, held: Flags,
) -> Flags:
    """Which of the bodies that rows act on may be in a pile, [nb].

    None of a cluster with a bound that depends on other impulses, coupled lines, or bounded rows
    that can be released.
    """
    joints, motors, frictions = elements.joints, elements.motors, elements.dry_friction
    bounded = np.concatenate([elements.limits["joint"], motors["joint"], frictions["joint"]])
    placed = motors["joint"][motors["law"] == PLACED]
    released = bounded[joints["bond"][bounded] >= 0]
    varied = frictions["joint"][(frictions["share"] > 0.0) | (frictions["static"] > 1.0)]
    direct = joints[np.concatenate([placed, released, varied])]
    between = elements.valves[elements.valves["slot"] >= 0]  # their lines share a coefficient
    coupled = set(elements.fluids["row"][[*between["a"], *between["b"]]].tolist())
    bodies = {body for row, own in rows.items()
              if row in coupled or any(body >= len(held) for body, _ in own) for body, _ in own}
    out = np.isin(np.arange(len(held)), [*direct["a"], *direct["b"], *bodies]) & held
    return np.asarray(held & ~np.isin(lowest, lowest[out]))


def _clusters(count: int, groups: list[list[int]]) -> Integers:
    """The lowest body of those that each body is connected with, by groups."""
    lowest, pairs = np.arange(count), np.array(
        [(group[0], body) for group in groups for body in group[1:]], np.int64).reshape(-1, 2)
    while True:
        before, low = lowest.copy(), lowest[pairs].min(axis=1)
        for column in pairs.T:
            np.minimum.at(lowest, column, low)
        lowest = lowest[lowest]
        if (lowest == before).all():
            return lowest


@kernel
def set_blocks(table: int) -> bool:
    """Gather the coefficients and compliances of the rows; whether any has changed."""
    entries, B, J = at.pile_entries(table), at.pile_coefficients(table), at.entries(table)
    nodes, blocks, c = at.pile_nodes(table), at.pile_blocks(table), at.pile_compliance(table)
    changed, held = False, at.pile_held(table)
    for j in range(len(nodes)):
        for r in range(3):
            soft = at.unknowns(table)[1, nodes[j, r]] if nodes[j, r] >= 0 else 1.0
            changed |= soft != held[j, r]
            held[j, r] = c[j, r] = soft
    for q in range(len(entries)):
        e, k, r = entries[q, 0], entries[q, 1], entries[q, 2]
        for s in range(3):
            changed |= B[k, r, s] != J[0, e, s]
            B[k, r, s] = J[0, e, s]
            c[blocks[k, 0], r] += RIGID_COMPLIANCE * J[0, e, s] * J[1, e, s]
    return changed


@kernel
def answer_of_rows(table: int, v: Matrix) -> None:
    """Replace impulses on bodies by changes of velocities, and of impulses of rows times -1."""
    bodies, nodes, velocity = at.pile_bodies(table), at.pile_nodes(table), at.force(table)
    dp, zero = at.pile_answer(table)[0], at.pile_answer(table)[1]
    inverse_mass = at.inverse_mass(table)
    for b in range(len(velocity)):
        clear(velocity[b])
    for i in range(len(bodies)):
        b = bodies[i]["number"]
        velocity[b, 0], velocity[b, 1] = inverse_mass[b, 0] * v[i, 0], inverse_mass[b, 0] * v[i, 1]
        velocity[b, 2] = inverse_mass[b, 1] * v[i, 2]
    right_side(table, velocity, zero, dp)
    forward(table, dp)
    backward(table, dp)
    apply_impulses(table, dp, velocity)
    for i in range(len(bodies)):
        for r in range(3):
            v[i, r] = velocity[bodies[i]["number"], r]
    for j in range(len(nodes)):
        for r in range(3):
            v[len(bodies) + j, r] = -dp[nodes[j, r]] if nodes[j, r] >= 0 else 0.0


@kernel
def add_rows(table: int) -> None:
    """Put B, its transpose and -c into the blocks of the matrix."""
    blocks, B, c = at.pile_blocks(table), at.pile_coefficients(table), at.pile_compliance(table)
    place, slots, first = at.pile_place(table), at.pile_slots(table), len(at.pile_bodies(table))
    D, L, U = at.pile_diagonal(table), at.pile_lower(table), at.pile_upper(table)
    for j in range(len(c)):
        X = D[place[first + j]]
        for r in range(3):
            X[r, 0] = X[r, 1] = X[r, 2] = 0.0
            X[r, r] = -c[j, r]
    for k in range(len(blocks)):
        lower, upper = L[slots[k]], U[slots[k]]
        for r in range(3):
            for s in range(3):
                lower[r, s], upper[s, r] = B[k, r, s], B[k, r, s]
