"""Modes of rows with bounds by Lemke's method, where changing modes row by row does not end.

With p = low + z, or of friction the difference of two z, one for either way, what bounded rows ask
for is a linear complementarity problem: w = q + M z, w >= 0, z >= 0, w z = 0. A row with an upper
bound has one more variable, the rate at which it slides there, whose w is what is left to that
bound (Stewart and Trinkle, 1996). Rows without bounds are pivoted out first. So written M is
copositive, and the path of pivots along which one artificial variable falls to 0 ends with a
solution but for rounding (Cottle, Pang and Stone, The Linear Complementarity Problem, 4.4). Of it
only the modes are taken; impulses follow from them as ever (:mod:`sandbox.engine.bounded`), to
rounding, which also tells whether they are right.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine.bounded import held
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Integers, Records

MOST = 100
"""Rows that it is tried for, at most: so much room there is for it."""
PIVOTS = 10
"""Pivots for each variable, after which it is given up; it takes one or two."""
SMALL = 1e-11
"""Of scaled numbers, what counts as none."""
ENDLESS = 1e299
"""A bound from here on is none."""


@kernel
def lemke_modes(rows: Records, n: int, G: Array, T: Array, names: Integers) -> bool:
    """Set the modes of ``rows`` to those of a solution; whether one was found.

    Args:
        rows: BOUND.
        n: how many, not above :data:`MOST`.
        G: [n, n].
        T: scratch, [2 MOST, 2 MOST + 2].
        names: scratch, [3, 2 MOST + 2]: what is in the basis, what is not, and of each row its
            second variable.
    """
    m = _tableau(rows, n, G, T, names)
    basis, out = names[0], names[1]
    for i in range(n):
        if _free(rows[i]):
            if abs(T[i, i]) < SMALL:
                return False
            _pivot(T, m, i, i)
            basis[i], out[i] = -1, -1
    worst, r = -SMALL, -1
    for i in range(m):
        if basis[i] >= 0 and T[i, m + 1] < worst:
            worst, r = T[i, m + 1], i
    if r >= 0 and not _path(T, m, basis, out, r):
        return False
    _read(rows, n, m, basis, names[2])
    return True


@kernel
def _free(row: Any) -> bool:
    """Whether a row has no bounds."""
    return bool(row["normal"] < 0 and row["low"] < -ENDLESS and row["high"] > ENDLESS)


@kernel
def _tableau(rows: Records, n: int, G: Array, T: Array, names: Integers) -> int:
    """The problem in rows of ``T``, scaled: columns z, the artificial variable, q; its size."""
    m = n
    for k in range(n):
        row = rows[k]
        names[2, k] = -1
        if row["normal"] >= 0 or (row["high"] < ENDLESS and not _free(row)):
            names[2, k] = m
            m += 2 if row["normal"] >= 0 else 1
    for i in range(m):
        for j in range(m + 2):
            T[i, j] = 0.0
        T[i, m] = 1.0
        names[0, i], names[1, i] = i, m + i
    names[1, m] = 2 * m
    for k in range(n):
        row, own = rows[k], G[k, k] + held(rows[k])
        if own <= 0.0:  # joints hold it
            T[k, k] = 1.0
        else:
            q = row["free"] - held(row) * row["last"]
            for j in range(n):
                x = G[k, j] + (held(row) if j == k else 0.0)
                T[k, j] = x
                if rows[j]["normal"] >= 0:
                    T[k, names[2, j] + 1] = -x
                elif rows[j]["low"] > -ENDLESS:
                    q += x * rows[j]["low"]
            T[k, m + 1] = q
        second = names[2, k]
        if second < 0:
            continue
        if row["normal"] >= 0:
            back = second + 1
            for j in range(m + 2):
                T[back, j] = -T[k, j] if j != m else 1.0
            T[back, second], T[second, back] = 1.0, -1.0
            T[second, row["normal"]] = row["friction"]
        else:
            T[second, m + 1] = row["high"] - row["low"]
        T[k, second], T[second, k] = 1.0, -1.0
    for k in range(n):
        own = G[k, k] + held(rows[k])
        d = 1.0 / math.sqrt(own) if own > 0.0 else 1.0
        _scale(T, m, k, d)
        if names[2, k] >= 0:
            _scale(T, m, names[2, k], 1.0 / d)
            if rows[k]["normal"] >= 0:
                _scale(T, m, names[2, k] + 1, d)
    most = 0.0
    for i in range(m):
        most = max(most, abs(T[i, m + 1]))
    for i in range(m):
        T[i, m + 1] /= most if most > 0.0 else 1.0
    return m


@kernel
def _scale(T: Array, m: int, k: int, d: float) -> None:
    """A row and its variable in other units: impulses in those in which a row's own G is 1."""
    for j in range(m + 2):
        if j != m:
            T[k, j] *= d
    for i in range(m):
        T[i, k] *= d


@kernel
def _pivot(T: Array, m: int, r: int, c: int) -> None:
    """Row ``r`` of the dictionary solved for column ``c``, and put into the others."""
    inverse = 1.0 / T[r, c]
    for j in range(m + 2):
        T[r, j] *= -inverse
    T[r, c] = inverse
    for i in range(m):
        x = T[i, c]
        if i != r and x != 0.0:
            T[i, c] = 0.0
            for j in range(m + 2):
                T[i, j] += x * T[r, j]


@kernel
def _path(T: Array, m: int, basis: Integers, out: Integers, r: int) -> bool:
    """Lemke's path: from the row ``r`` that is furthest below 0 to no artificial variable."""
    c = m
    for _ in range(PIVOTS * m):
        _pivot(T, m, r, c)
        left = basis[r]
        basis[r], out[c] = out[c], left
        if left == 2 * m:
            return True
        enters = left + m if left < m else left - m
        c = 0
        while out[c] != enters:
            c += 1
        r, least = -1, math.inf
        for i in range(m):
            if basis[i] < 0 or T[i, c] > -SMALL:
                continue
            ratio = max(T[i, m + 1], 0.0) / -T[i, c]
            tied = abs(ratio - least) <= SMALL * (1.0 + ratio)
            if (ratio < least and not tied) or (tied and basis[r] != 2 * m and (
                    basis[i] == 2 * m or T[i, c] < T[r, c])):
                r, least = i, min(ratio, least)
        if r < 0:
            return _gone(T, m, basis)
    return False


@kernel
def _gone(T: Array, m: int, basis: Integers) -> bool:
    """Whether the artificial variable is 0 in the basis, where no pivot leads on by rounding."""
    for i in range(m):
        if basis[i] == 2 * m:
            return bool(T[i, m + 1] < SMALL)
    return True


@kernel
def _read(rows: Records, n: int, m: int, basis: Integers, second: Integers) -> None:
    """The modes: in between where nothing slides; of friction, and of other rows above 0."""
    for k in range(n):
        rows[k]["mode"] = 0 if _free(rows[k]) or rows[k]["normal"] >= 0 else -1
    for i in range(m):
        name = basis[i] - m
        if 0 <= name < n and rows[name]["normal"] < 0:
            rows[name]["mode"] = 0
    for k in range(n):
        slides = back = False
        for i in range(m):
            slides |= second[k] >= 0 and basis[i] == m + second[k]
            back |= second[k] >= 0 and basis[i] == m + second[k] + 1
        if slides:
            rows[k]["mode"] = -1 if back and rows[k]["normal"] >= 0 else 1
    for k in range(n):
        t = rows[k]["normal"]
        if t >= 0 and rows[t]["mode"] != 0:
            rows[k]["mode"] = 0
