"""Sparse matrices of 3 x 3 blocks: elimination order and LU factors.

The block columns are eliminated in minimum-degree order. L is stored by columns, U by rows, both
with the same pattern: slot p of column j belongs to row ``below[p]``, which is later than j.
``starts`` [n + 1] says where the slots of a column begin; rows are in ascending order.
"""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.kernel import kernel
from sandbox.numeric import Integers, Matrix

BITS = 62  # bits used of a word of an adjacency set; more would need an unsigned type


@kernel
def _count(word: int) -> int:
    n = 0
    while word:
        word &= word - 1
        n += 1
    return n


@kernel
def connect(adjacent: Integers, i: int, j: int) -> None:
    """Add the edge i, j to adjacency sets [n, words]."""
    adjacent[i, j // BITS] |= 1 << (j % BITS)
    adjacent[j, i // BITS] |= 1 << (i % BITS)


@kernel
def minimum_degree(
    adjacent: Integers, first: int, after: Integers, place: Integers, starts: Integers,
    below: Integers, work: Integers,
) -> None:
    """Find ``place``, the position of each node in the order, and the pattern of the factors.

    ``after`` [m, 2] are pairs i, j: node ``first + i`` comes after node j.
    """
    n, words = adjacent.shape
    degree, order, waits = work[0], work[1], work[2]
    for i in range(n):
        degree[i] = waits[i] = 0
        for q in range(words):
            degree[i] += _count(adjacent[i, q])
    for k in range(len(after)):
        waits[first + after[k, 0]] += 1
    starts[0] = end = 0
    for i in range(n):
        place[i] = -1
    for s in range(n):
        node = -1
        for i in range(n):  # equal values go to the lowest number
            if place[i] < 0 and waits[i] == 0 and (node < 0 or degree[i] < degree[node]):
                node = i
        place[node], order[s] = s, node
        for k in range(len(after)):
            if after[k, 1] == node:
                waits[first + after[k, 0]] -= 1
        for q in range(words):
            word, bit = adjacent[node, q], 0
            while word:
                if word & 1:
                    below[end] = q * BITS + bit
                    end += 1
                word >>= 1
                bit += 1
        starts[s + 1] = end
        for p in range(starts[s], end):
            j = below[p]
            for q in range(words):
                adjacent[j, q] |= adjacent[node, q]
            adjacent[j, node // BITS] &= ~(1 << (node % BITS))
            adjacent[j, j // BITS] &= ~(1 << (j % BITS))
            degree[j] = 0
            for q in range(words):
                degree[j] += _count(adjacent[j, q])
    for s in range(n):
        for p in range(starts[s], starts[s + 1]):
            row, q = place[below[p]], p
            while q > starts[s] and below[q - 1] > row:
                below[q] = below[q - 1]
                q -= 1
            below[q] = row


@kernel
def find_slot(starts: Integers, below: Integers, column: int, row: int) -> int:
    """The slot of a block below the diagonal, -1 if it is not in the pattern."""
    low, high = starts[column], starts[column + 1]
    while low < high:
        middle = (low + high) // 2
        if below[middle] < row:
            low = middle + 1
        else:
            high = middle
    return low if low < starts[column + 1] and below[low] == row else -1


@kernel
def _invert(A: Matrix) -> None:
    a, b, c = A[0, 0], A[0, 1], A[0, 2]
    d, e, f = A[1, 0], A[1, 1], A[1, 2]
    g, h, i = A[2, 0], A[2, 1], A[2, 2]
    u, v, w = e * i - f * h, f * g - d * i, d * h - e * g
    r = 1.0 / (a * u + b * v + c * w)
    A[0, 0], A[0, 1], A[0, 2] = u * r, (c * h - b * i) * r, (b * f - c * e) * r
    A[1, 0], A[1, 1], A[1, 2] = v * r, (a * i - c * g) * r, (c * d - a * f) * r
    A[2, 0], A[2, 1], A[2, 2] = w * r, (b * g - a * h) * r, (a * e - b * d) * r


@kernel
def factor_blocks(table: int) -> None:
    """Factor the matrix of the piles in place.

    Its diagonal [n, 3, 3] becomes the inverse pivots, which scale the blocks below it.
    """
    starts, below = at.pile_starts(table), at.pile_below(table)
    D, L, U = at.pile_diagonal(table), at.pile_lower(table), at.pile_upper(table)
    for j in range(len(starts) - 1):
        _invert(D[j])
        first, last = starts[j], starts[j + 1]
        for p in range(first, last):
            for r in range(3):
                x, y, z = L[p, r, 0], L[p, r, 1], L[p, r, 2]
                for c in range(3):
                    L[p, r, c] = x * D[j, 0, c] + y * D[j, 1, c] + z * D[j, 2, c]
        for q in range(first, last):
            size = 0.0
            for r in range(3):
                for c in range(3):
                    size += abs(L[q, r, c]) + abs(U[q, r, c])
            if size == 0.0:  # of bodies that are near each other but do not touch
                continue
            slot, i = starts[below[q]], below[q]
            for p in range(q + 1, last):
                while below[slot] != below[p]:
                    slot += 1
                for r in range(3):
                    x, y, z = L[p, r, 0], L[p, r, 1], L[p, r, 2]
                    a, b, d = L[q, r, 0], L[q, r, 1], L[q, r, 2]
                    for c in range(3):
                        L[slot, r, c] -= x * U[q, 0, c] + y * U[q, 1, c] + z * U[q, 2, c]
                        U[slot, r, c] -= a * U[p, 0, c] + b * U[p, 1, c] + d * U[p, 2, c]
            for r in range(3):
                x, y, z = L[q, r, 0], L[q, r, 1], L[q, r, 2]
                for c in range(3):
                    D[i, r, c] -= x * U[q, 0, c] + y * U[q, 1, c] + z * U[q, 2, c]


@kernel
def solve_blocks(table: int, x: Matrix) -> None:
    """Solve with the factors in place; x [n, 3] is in the order of elimination."""
    starts, below = at.pile_starts(table), at.pile_below(table)
    D, L, U = at.pile_diagonal(table), at.pile_lower(table), at.pile_upper(table)
    n = len(starts) - 1
    for j in range(n):
        a, b, c = x[j, 0], x[j, 1], x[j, 2]
        for p in range(starts[j], starts[j + 1]):
            i = below[p]
            for r in range(3):
                x[i, r] -= L[p, r, 0] * a + L[p, r, 1] * b + L[p, r, 2] * c
    for j in range(n - 1, -1, -1):
        a, b, c = x[j, 0], x[j, 1], x[j, 2]
        for p in range(starts[j], starts[j + 1]):
            i = below[p]
            a -= U[p, 0, 0] * x[i, 0] + U[p, 0, 1] * x[i, 1] + U[p, 0, 2] * x[i, 2]
            b -= U[p, 1, 0] * x[i, 0] + U[p, 1, 1] * x[i, 1] + U[p, 1, 2] * x[i, 2]
            c -= U[p, 2, 0] * x[i, 0] + U[p, 2, 1] * x[i, 1] + U[p, 2, 2] * x[i, 2]
        for r in range(3):
            x[j, r] = D[j, r, 0] * a + D[j, r, 1] * b + D[j, r, 2] * c
