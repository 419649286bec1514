"""The bilateral rows: their pattern, made once, and the factorisation in each step.

Each bilateral row r (a joint's, a damper's, a stiff tendon's) has entries: a body and three
coefficients J. With W the inverse masses, S = sum J W J' over the free bodies is sparse, and has
next to no fill in order of least degree. A body with very many rows, which would couple all of
them, is a hub: its three velocities stay in the system, as does the slip of a tendon over a guide,
one unknown without mass:

    [ S + c   J_h ] [ p   ]   [ r       ]
    [ J_h'   -M_h ] [ v_h ] = [ -M_h v_f ]

The matrix is quasi-definite, but a rigid row has a pivot only while other bodies have a freedom
left for it: one that acts on hubs alone, or on a link that other rows hold, follows its hubs.

The factorisation is L D L^T in this fixed order. ``values`` holds the columns of L below the
diagonal, then the diagonal: the matrix before the factorisation, L and 1 / D after it.
"""

from __future__ import annotations

import heapq
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from sandbox.engine.kernel import kernel
from sandbox.errors import SandboxError
from sandbox.numeric import Array, Integers

MAX_PRODUCTS = 5_000_000  # of a factorisation: some hundredths of a second
HUB = 12  # a free body with more entries than this is a hub


class Pattern(NamedTuple):
    """The pattern of L in L D L^T, and what is added up to the matrix; m unknowns, ne entries."""

    unknown: Integers  # of each row, in the order of elimination, [rows]
    hubs: Annotated[Integers, "hubs 3"]
    """The three unknowns of each body that is a hub, or -1; then of each slip its one, thrice; then
    of each sum its two rows and the first of these."""
    starts: Integers  # where the slots below the diagonal begin, column by column, [m + 1]
    below: Integers  # the unknown of each slot's row, [slots]
    updates: Integers  # slots that products of two slots of a column are subtracted from, in turn
    entry_row: Integers  # the unknown of each entry, [ne]
    entry_body: Integers  # the body of each entry, [ne]
    pairs: Annotated[Integers, "pairs 3"]  # (slot, entry, entry) of S; a diagonal follows the slots
    joined: Integers  # the slots of rows that are joined besides
    direct: Annotated[Integers, "direct 3"]  # (slot, entry, axis) of the entries on hubs, [q, 3]
    body_starts: Integers  # where the entries of each free body that is no hub begin, [nb + 1]
    body_entries: Integers  # these entries, body by body
    branch_starts: Integers  # where the branch of each body, slip and sum begins
    branches: Integers  # unknowns that a force on a body reaches in a forward substitution


def make_pattern(
    rows: Sequence[Sequence[int]], inverse_mass: Array, rigid: int, slips: int,
    sums: Sequence[tuple[int, int]], joined: Sequence[tuple[int, int]],
) -> Pattern:
    """The pattern for bilateral rows, each given by the bodies of its entries, then slips.

    The first ``rigid`` rows have no compliance; ``sums`` are pairs of rows whose unknowns are added
    up; ``joined`` rows meet besides, as lines at a valve.
    """
    bodies, count = len(inverse_mass), len(inverse_mass) + slips
    free = np.concatenate([inverse_mass[:, 0] > 0.0, np.ones(slips, dtype=bool)])
    entries = [(row, body) for row, acted_on in enumerate(rows) for body in acted_on]
    on: list[list[int]] = [[] for _ in free]  # of every body or slip that moves, its entries
    for entry, (_, body) in enumerate(entries):
        if free[body]:
            on[body].append(entry)
    hubs = [body for body in range(count) if body >= bodies or len(on[body]) > HUB]
    axes = [3 if body < bodies else 1 for body in hubs]
    first = np.cumsum([len(rows), *axes]).tolist()
    groups = _meetings(entries, on, hubs, first, joined)
    before: list[set[int]] = [set() for _ in groups]
    for row in _left_over(rows[:rigid], on, hubs) if hubs else []:
        before[row] = {i for i in groups[row] if i >= len(rows)}
    for i in first[len(hubs) - slips:-1]:  # what has no mass has no pivot of its own
        before[i] = set(groups[i])
    order, met = elimination(groups, before)
    place = np.empty(len(order), dtype=np.int64)
    place[order] = np.arange(len(order))
    columns = [sorted(int(place[j]) for j in met[i]) for i in order]
    starts = _starts(columns)
    slot = {(i, j): int(starts[j]) + n for j, column in enumerate(columns)
            for n, i in enumerate(column)}
    updates = [slot[column[a], column[b]] for column in columns
               for a in range(len(column)) for b in range(a)]

    def where(i: int, j: int) -> int:
        a, b = int(place[i]), int(place[j])
        return len(slot) + a if a == b else slot[max(a, b), min(a, b)]

    unknown = np.full((count + len(sums), 3), -1, dtype=np.int64)
    for k, body in enumerate(hubs):
        unknown[body] = place[first[k]:first[k + 1]]
    for k, (one, two) in enumerate(sums):
        unknown[count + k] = place[[one, two, one]]
    inner = [[] if body in hubs else on[body] for body in range(count)] + [[] for _ in sums]
    pairs = [(where(entries[a][0], entries[b][0]), a, b) for own in inner for a in own for b in own
             if place[entries[a][0]] >= place[entries[b][0]]]
    direct = [(where(entries[entry][0], first[k] + axis), entry, axis)
              for k, body in enumerate(hubs) for entry in on[body] for axis in range(axes[k])]
    reached = [{int(place[entries[entry][0]]) for entry in own} for own in inner]
    for body in [*hubs, *range(count, len(unknown))]:
        reached[body] = {int(i) for i in unknown[body]}
    branches = []
    for own in reached:
        waiting = list(own)
        for i in waiting:  # grows to the root of the elimination tree
            if columns[i] and columns[i][0] not in own:
                own.add(columns[i][0])
                waiting.append(columns[i][0])
        branches.append(sorted(own))
    return Pattern(
        place[:len(rows)], unknown, starts, _flat(columns), np.array(updates, dtype=np.int64),
        place[np.array([row for row, _ in entries], dtype=np.int64)],
        np.array([body for _, body in entries], dtype=np.int64),
        np.array(sorted(pairs), dtype=np.int64).reshape(-1, 3),
        _flat([[where(i, j) for i, j in joined]]), np.array(direct, dtype=np.int64).reshape(-1, 3),
        _starts(inner), _flat(inner), _starts(branches), _flat(branches))


def _meetings(
    entries: list[tuple[int, int]], on: list[list[int]], hubs: list[int], first: list[int],
    joined: Sequence[tuple[int, int]],
) -> list[set[int]]:
    groups: list[set[int]] = [set() for _ in range(first[-1])]
    for i, j in joined:
        groups[i].add(j)
        groups[j].add(i)
    for body, own in enumerate(on):
        met = own_rows = {entries[entry][0] for entry in own}
        if body in hubs:
            k = hubs.index(body)
            met = set(range(first[k], first[k + 1]))
        for row in own_rows:
            groups[row] |= met
        for i in met:
            groups[i] |= own_rows
    return groups


def _left_over(rows: Sequence[Sequence[int]], on: list[list[int]], hubs: list[int]) -> list[int]:
    """Rows without one of the three freedoms of a body that is no hub (by augmenting paths)."""
    taken: dict[int, list[int]] = {
        body: [] for body, own in enumerate(on) if own and body not in hubs}
    own = [[body for body in bodies if body in taken] for bodies in rows]
    where: dict[int, int] = {}
    left = []
    # rows that no hub could carry choose first
    for row in sorted(range(len(rows)), key=lambda row: len(rows[row]) - len(own[row])):
        claims, queue, found = dict.fromkeys(own[row], row), list(own[row]), -1
        for body in queue:  # grows as it goes
            if len(taken[body]) < 3:
                found = body
                break
            for other in taken[body]:
                for next_body in own[other]:
                    if next_body not in claims:
                        claims[next_body] = other
                        queue.append(next_body)
        if found < 0:
            left.append(row)
        while found >= 0:
            moved = claims[found]
            last = where.get(moved, -1)
            where[moved] = found
            taken[found].append(moved)
            if last >= 0:
                taken[last].remove(moved)
            found = last
    return left


def elimination(
    groups: list[set[int]], waits: list[set[int]],
) -> tuple[list[int], dict[int, set[int]]]:
    """An order of least degree after those waited for; unknowns that each meets in its turn."""
    graph = [set(group) - {i} for i, group in enumerate(groups)]
    heap = [(len(graph[i]), i) for i in range(len(graph)) if not waits[i]]
    heapq.heapify(heap)
    order: list[int] = []
    met: dict[int, set[int]] = {}
    products = 0
    while heap:
        degree, i = heapq.heappop(heap)
        if i in met or degree != len(graph[i]):
            continue
        order.append(i)
        met[i] = others = graph[i]
        products += degree * (degree - 1) // 2
        if products > MAX_PRODUCTS:
            raise SandboxError("joints and tendons form too many loops to be solved: more than "
                               f"{MAX_PRODUCTS} products in each step; use fewer joints between "
                               "the same bodies", code="too-complex")
        for j in others:
            graph[j] |= others
            graph[j] -= {i, j}
            waits[j].discard(i)
            if not waits[j]:
                heapq.heappush(heap, (len(graph[j]), j))
    return order, met


def _starts(lists: list[list[int]]) -> Integers:
    return np.concatenate([[0], np.cumsum([len(each) for each in lists])]).astype(np.int64)


def _flat(lists: list[list[int]]) -> Integers:
    return np.array([i for each in lists for i in each], dtype=np.int64)


@kernel
def clear(x: Array) -> None:
    """Set all of a vector to 0."""
    for i in range(len(x)):
        x[i] = 0.0


@kernel
def put(x: Array, y: Array) -> None:
    """Copy ``y`` [n, 3] into ``x``."""
    for i in range(len(x)):
        for j in range(3):
            x[i, j] = y[i, j]


@kernel
def add(x: Array, y: Array, times: float) -> None:
    """Add ``y`` [n, 3] to ``x``, so many times."""
    for i in range(len(x)):
        for j in range(3):
            x[i, j] += times * y[i, j]


@kernel
def add_to(x: Array, i: int, one: float, two: float, three: float) -> None:
    """Add three numbers to row ``i`` of ``x`` [n, 3], such as a force and a torque to a body's."""
    x[i, 0] += one
    x[i, 1] += two
    x[i, 2] += three
