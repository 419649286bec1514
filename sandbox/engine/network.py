"""The tendon network: all tendons solved together, semi-implicitly.

A tendon is a path of guides with one tension T >= 0. At the predicted pose let
L be the lengths, J = dL/dq, M the masses of the free bodies, v the velocities
that all other forces would lead to at the end of the step. The tension at the
end of the step shall agree with the length and the rate there:

    T = k (L - L0) + (c + h k) J v+,   v+ = v - h M^-1 J^T T
    [ 1 / (h (c + h k)) + J M^-1 J^T ] T = ( k (L - L0) + (c + h k) J v ) / (h (c + h k))

The matrix is symmetric, positive and sparse (tendons that share no body do not
meet in it). It is factored as L D L^T in an order fixed at the start, so the
cost grows with the number of tendons, not with its square. Slack tendons are
found by an active set kept from the step before.

The price is a damping of h k along the cord: welcome in one that stands for a
cord without stretch, which shall not ring, but first order in h for an elastic
one. A tendon below :data:`sandbox.scene.elements.tendons.RIGID` that needs no such help
(h^2 k J M^-1 J^T at most :data:`SOFT` in any pose) is a spring that only pulls:
its tension follows from the pose alone, and the order is second.

A guide is a circle of radius 0 or more. Walking along direction u with left
normal n, a circle whose centre lies right of the path has sign s = +1, left
s = -1; the cord touches it at p = c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2
for a stretch between two circles. Every stretch pulls its two bodies at these
points, which also gives a wound-on end its torque s r T.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Records = NDArray[Any]

TENDON, PULL, ELASTIC = 0, 1, 2
"""Solved with the others; of given tension; soft enough to be taken as it is."""
GRAZE = 1e-9
"""An angle of wrap [rad] below which a cord touches its wheel in one point."""

# One guide: its body (space order), its place relative to the centre of mass [m], signed radius
# s r [m]; then what the last step left: row of J, angle of the tangent point and its first value.
NODE = np.dtype([
    ("body", np.int64), ("x", float), ("y", float), ("radius", float),
    ("jx", float), ("jy", float), ("jt", float), ("turn", float), ("turn0", float),
])
SOFT = 1.0
"""A leapfrog breaks down at 4."""

# One tendon: its guides [first, last), what it is, its law; then length, tension, whether it pulls.
SPAN = np.dtype([
    ("first", np.int64), ("last", np.int64), ("kind", np.int64), ("drive", np.int64),
    ("row", np.int64), ("k", float), ("c", float), ("rest", float),
    ("length", float), ("tension", float), ("active", np.int64),
    ("damping", float), ("free", float), ("work", float), ("gain", float),
])


@njit(cache=True)
def _near(angle: float, last: float) -> float:
    """``angle`` plus the whole turns that bring it closest to ``last``."""
    return float(angle + 2 * math.pi * np.round((last - angle) / (2 * math.pi)))


@njit(cache=True)
def measure(span: Any, nodes: Records, pose: Array, start: bool) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3] (centres of mass); fills its rows of J.

    ``start`` fixes how often the cord goes round its wheels.
    """
    length = 0.0
    first, last = span["first"], span["last"]
    for i in range(first, last):
        nodes[i]["jx"] = nodes[i]["jy"] = nodes[i]["jt"] = 0.0
    angle_in = 0.0
    for i in range(first, last - 1):
        a, b = nodes[i], nodes[i + 1]
        qa, qb = pose[a["body"]], pose[b["body"]]
        ca, sa, cb, sb = math.cos(qa[2]), math.sin(qa[2]), math.cos(qb[2]), math.sin(qb[2])
        ax, ay = ca * a["x"] - sa * a["y"], sa * a["x"] + ca * a["y"]
        bx, by = cb * b["x"] - sb * b["y"], sb * b["x"] + cb * b["y"]
        dx, dy = qb[0] + bx - qa[0] - ax, qb[1] + by - qa[1] - ay
        ra, rb = a["radius"], b["radius"]
        offset = ra - rb
        distance = math.hypot(dx, dy)
        straight = math.sqrt(max(distance * distance - offset * offset, 1e-24))
        square = straight * straight + offset * offset
        ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
        nx, ny = -uy, ux
        length += straight
        a["jx"] -= ux
        a["jy"] -= uy
        a["jt"] -= (ax + ra * nx) * uy - (ay + ra * ny) * ux
        b["jx"] += ux
        b["jy"] += uy
        b["jt"] += (bx + rb * nx) * uy - (by + rb * ny) * ux
        angle = math.atan2(ny, nx)
        if ra != 0.0:
            if i == first:  # wound on: counted from where it left the wheel at the start
                psi = angle - qa[2]
                psi = psi if start else _near(psi, a["turn"])
                if start:
                    a["turn0"] = psi
                a["turn"] = psi
                length -= ra * (psi - a["turn0"])
            else:
                side = 1.0 if ra > 0 else -1.0
                wrap = side * (angle_in - angle)
                # a cord that just touches its wheel must not go once round it by rounding
                wrap = (wrap + GRAZE) % (2 * math.pi) - GRAZE if start else _near(wrap, a["turn"])
                a["turn"] = wrap
                length += abs(ra) * wrap
        if rb != 0.0 and i == last - 2:
            psi = angle - qb[2]
            psi = psi if start else _near(psi, b["turn"])
            if start:
                b["turn0"] = psi
            b["turn"] = psi
            length += rb * (psi - b["turn0"])
        angle_in = angle
    return length


@njit(cache=True)
def add_force(span: Any, nodes: Records, tension: float, force: Array) -> None:
    """Add the pull -J^T T of a tendon to ``force`` [nb, 3]."""
    for i in range(span["first"], span["last"]):
        node = nodes[i]
        body = node["body"]
        force[body, 0] -= node["jx"] * tension
        force[body, 1] -= node["jy"] * tension
        force[body, 2] -= node["jt"] * tension


@njit(cache=True)
def elastic_tension(
    h: float, span: Any, nodes: Records, velocity: Array, earlier: Array,
) -> float:
    """Tension of a soft tendon [N]; its damper as in :mod:`sandbox.engine.forces`.

    ``velocity`` [nb, 6] (the last three columns) and ``earlier`` [nb, 3] are one step apart.
    """
    now = then = 0.0
    if span["c"] > 0.0:
        for n in range(span["first"], span["last"]):
            node = nodes[n]
            v, u = velocity[node["body"]], earlier[node["body"]]
            now += node["jx"] * v[3] + node["jy"] * v[4] + node["jt"] * v[5]
            then += node["jx"] * u[0] + node["jy"] * u[1] + node["jt"] * u[2]
        change = span["c"] * (1.5 * now - 0.5 * then) - span["damping"]
        span["damping"] += change / (1.0 + 0.5 * h * span["c"] * span["free"])
    stretch = span["length"] - span["rest"]
    if stretch <= 0.0:
        return 0.0
    return float(max(span["k"] * stretch + span["damping"], 0.0))


@njit(cache=True)
def solve(
    h: float, spans: Records, nodes: Records, rows: NDArray[np.int64], pairs: NDArray[np.int64],
    starts: NDArray[np.int64], columns: NDArray[np.int64], inverse_mass: Array,
    velocity: Array, work: Array,
) -> None:
    """Tensions of all tendons but the pulled ones, written into ``spans``.

    ``rows`` [m] names the tendon of each row; ``pairs`` [p, 3] lists (slot, node, node)
    that add up to the entries of J M^-1 J^T; row i of the factor has its entries at slots
    ``starts[i]`` … ``starts[i + 1]`` with ``columns``, the diagonal last; ``velocity`` [nb, 3].
    """
    m = len(rows)
    matrix, factor, rhs, y = work[0], work[1], work[2], work[3]
    matrix[: starts[m]] = 0.0
    for p in range(len(pairs)):
        a, b = nodes[pairs[p, 1]], nodes[pairs[p, 2]]
        w = inverse_mass[a["body"]]
        matrix[pairs[p, 0]] += (
            w[0] * (a["jx"] * b["jx"] + a["jy"] * b["jy"]) + w[1] * a["jt"] * b["jt"]
        )
    for i in range(m):
        span = spans[rows[i]]
        rate = 0.0
        for n in range(span["first"], span["last"]):
            node = nodes[n]
            v = velocity[node["body"]]
            rate += node["jx"] * v[0] + node["jy"] * v[1] + node["jt"] * v[2]
        lead = span["c"] + h * span["k"]
        matrix[starts[i + 1] - 1] += 1.0 / (h * lead)
        rhs[i] = (span["k"] * (span["length"] - span["rest"]) + lead * rate) / (h * lead)
    for _ in range(12):
        _factor_and_solve(spans, rows, starts, columns, matrix, factor, rhs, y)
        if not _swap_slack(spans, rows, starts, columns, matrix, rhs, y):
            break
    for i in range(m):
        spans[rows[i]]["tension"] = max(y[i], 0.0)


@njit(cache=True)
def _factor_and_solve(
    spans: Records, rows: NDArray[np.int64], starts: NDArray[np.int64],
    columns: NDArray[np.int64], matrix: Array, factor: Array, rhs: Array, y: Array,
) -> None:
    """L D L^T y = rhs over the tendons that pull; y = 0 for the slack ones."""
    m = len(rows)
    for i in range(m):
        first, diagonal = starts[i], starts[i + 1] - 1
        if not spans[rows[i]]["active"]:
            factor[first:diagonal] = 0.0
            factor[diagonal] = 1.0
            y[i] = 0.0
            continue
        d = matrix[diagonal]
        total = rhs[i]
        for p in range(first, diagonal):
            j = columns[p]
            value = matrix[p] if spans[rows[j]]["active"] else 0.0
            q = starts[j]
            for r in range(first, p):  # both rows list their columns in order
                while q < starts[j + 1] - 1 and columns[q] < columns[r]:
                    q += 1
                if q < starts[j + 1] - 1 and columns[q] == columns[r]:
                    value -= factor[q] * factor[r] * factor[starts[columns[r] + 1] - 1]
            pivot = factor[starts[j + 1] - 1]
            factor[p] = value / pivot
            d -= factor[p] * value
            total -= factor[p] * y[j]
        factor[diagonal] = d
        y[i] = total
    for i in range(m):
        y[i] /= factor[starts[i + 1] - 1]
    for i in range(m - 1, -1, -1):
        for p in range(starts[i], starts[i + 1] - 1):
            y[columns[p]] -= factor[p] * y[i]


@njit(cache=True)
def _swap_slack(
    spans: Records, rows: NDArray[np.int64], starts: NDArray[np.int64],
    columns: NDArray[np.int64], matrix: Array, rhs: Array, y: Array,
) -> bool:
    """Let go of tendons that would push, take up slack ones that would pull; True if any."""
    m = len(rows)
    changed = False
    for i in range(m):
        if spans[rows[i]]["active"] and y[i] < 0.0:
            spans[rows[i]]["active"] = 0
            changed = True
    if changed:
        return True
    for i in range(m):
        if spans[rows[i]]["active"]:
            continue
        left = rhs[i]
        for p in range(starts[i], starts[i + 1] - 1):
            left -= matrix[p] * y[columns[p]]
        for j in range(i + 1, m):
            for p in range(starts[j], starts[j + 1] - 1):
                if columns[p] == i:
                    left -= matrix[p] * y[j]
        if left > 0.0:
            spans[rows[i]]["active"] = 1
            changed = True
    return changed


def elimination(groups: list[set[int]]) -> tuple[list[int], list[list[int]]]:
    """An order of the rows with little fill, and for each row its columns in that order.

    ``groups[i]`` holds the rows that row i meets. Minimum degree: the row that
    meets the fewest others goes first; those it met then meet each other.
    """
    graph = {i: set(group) - {i} for i, group in enumerate(groups)}
    order: list[int] = []
    met: dict[int, set[int]] = {}
    while graph:
        i = min(graph, key=lambda row: (len(graph[row]), row))
        others = graph.pop(i)
        order.append(i)
        met[i] = others
        for j in others:
            graph[j] |= others - {j}
            graph[j].discard(i)
    place = {row: n for n, row in enumerate(order)}
    columns: list[list[int]] = [[] for _ in order]
    for i in order:
        for j in met[i]:
            columns[place[j]].append(place[i])
    return order, [sorted(row) for row in columns]
