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

from sandbox.engine.state import Constants, Result, State
from sandbox.kinds.elements import GRAZE
from sandbox.numeric import Array, Integers, Records

SOFT = 1.0
"""A leapfrog breaks down at 4."""


@njit(cache=True)
def _near(angle: float, last: float) -> float:
    """``angle`` plus the whole turns that bring it closest to ``last``."""
    return float(angle + 2 * math.pi * np.round((last - angle) / (2 * math.pi)))


@njit(cache=True, inline="always")
def measure(
    cord: Any, guides: Records, memory: Records, results: Records, pose: Array, start: bool,
) -> float:
    """Length of a tendon [m] at ``pose`` [nb, 3] (centres of mass); fills its rows of J.

    ``guides``, ``memory`` and ``results`` are GUIDE, GUIDE_STATE and GUIDE_RESULT of all
    guides; ``start`` fixes how often the cord goes round its wheels.
    """
    length = 0.0
    first, last = cord["first"], cord["last"]
    for i in range(first, last):
        results[i]["jx"] = results[i]["jy"] = results[i]["jt"] = 0.0
    angle_in = 0.0
    for i in range(first, last - 1):
        a, b, on_a, on_b = guides[i], guides[i + 1], results[i], results[i + 1]
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
        on_a["jx"] -= ux
        on_a["jy"] -= uy
        on_a["jt"] -= (ax + ra * nx) * uy - (ay + ra * ny) * ux
        on_b["jx"] += ux
        on_b["jy"] += uy
        on_b["jt"] += (bx + rb * nx) * uy - (by + rb * ny) * ux
        angle = math.atan2(ny, nx)
        if ra != 0.0:
            if i == first:  # wound on: counted from where it left the wheel at the start
                length -= ra * _unwound(angle - qa[2], memory[i], start)
            else:
                side = 1.0 if ra > 0 else -1.0
                wrap = side * (angle_in - angle)
                # a cord that just touches its wheel must not go once round it by rounding
                wrap = ((wrap + GRAZE) % (2 * math.pi) - GRAZE if start
                        else _near(wrap, memory[i]["wrap"]))
                memory[i]["wrap"] = wrap
                length += abs(ra) * wrap
        if rb != 0.0 and i == last - 2:
            length += rb * _unwound(angle - qb[2], memory[i + 1], start)
        angle_in = angle
    return length


@njit(cache=True)
def _unwound(angle: float, memory: Any, start: bool) -> float:
    """How far the point where a wound cord leaves its wheel has gone since t = 0 [rad]."""
    psi = angle if start else _near(angle, memory["wrap"])
    if start:
        memory["wrap0"] = psi
    memory["wrap"] = psi
    return float(psi - memory["wrap0"])


@njit(cache=True)
def add_force(constants: Constants, result: Result, tendon: int, force: Array) -> None:
    """Add the pull -J^T T of a tendon to ``force`` [nb, 3]."""
    cord, tension = constants.cords[tendon], result.cords[tendon]["tension"]
    for i in range(cord["first"], cord["last"]):
        guide = result.guides[i]
        body = constants.guides[i]["body"]
        force[body, 0] -= guide["jx"] * tension
        force[body, 1] -= guide["jy"] * tension
        force[body, 2] -= guide["jt"] * tension


@njit(cache=True)
def elastic_tension(constants: Constants, state: State, result: Result, tendon: int) -> float:
    """Tension of a soft tendon [N]; its damper as in :mod:`sandbox.engine.forces`."""
    cord, memory = constants.cords[tendon], state.cords[tendon]
    now = then = 0.0
    if cord["c"] > 0.0:
        for n in range(cord["first"], cord["last"]):
            guide, body = result.guides[n], constants.guides[n]["body"]
            v, u = state.body[body], state.before[body]
            now += guide["jx"] * v[3] + guide["jy"] * v[4] + guide["jt"] * v[5]
            then += guide["jx"] * u[0] + guide["jy"] * u[1] + guide["jt"] * u[2]
        change = cord["c"] * (1.5 * now - 0.5 * then) - memory["damping"]
        memory["damping"] += change / (1.0 + 0.5 * constants.h * cord["c"] * cord["response"])
    stretch = result.cords[tendon]["length"] - cord["rest"]
    if stretch <= 0.0:
        return 0.0
    return float(max(cord["k"] * stretch + memory["damping"], 0.0))


@njit(cache=True)
def solve(constants: Constants, state: State, result: Result, velocity: Array) -> None:
    """Tensions of all tendons but the pulled ones, written into ``result.cords``.

    ``velocity`` [nb, 3] is what all other forces lead to.
    """
    h, rows, pairs, starts = constants.h, constants.rows, constants.pairs, constants.starts
    guides, J, columns = constants.guides, result.guides, constants.columns
    m = len(rows)
    matrix, factor, rhs, y = (
        result.scratch[0], result.scratch[1], result.scratch[2], result.scratch[3])
    matrix[: starts[m]] = 0.0
    for p in range(len(pairs)):
        a, b = J[pairs[p, 1]], J[pairs[p, 2]]
        w = constants.inverse_mass[guides[pairs[p, 1]]["body"]]
        matrix[pairs[p, 0]] += (
            w[0] * (a["jx"] * b["jx"] + a["jy"] * b["jy"]) + w[1] * a["jt"] * b["jt"]
        )
    for i in range(m):
        cord = constants.cords[rows[i]]
        rate = 0.0
        for n in range(cord["first"], cord["last"]):
            v = velocity[guides[n]["body"]]
            rate += J[n]["jx"] * v[0] + J[n]["jy"] * v[1] + J[n]["jt"] * v[2]
        lead = cord["c"] + h * cord["k"]
        stretch = result.cords[rows[i]]["length"] - cord["rest"]
        matrix[starts[i + 1] - 1] += 1.0 / (h * lead)
        rhs[i] = (cord["k"] * stretch + lead * rate) / (h * lead)
    for _ in range(12):
        _factor_and_solve(state.cords, rows, starts, columns, matrix, factor, rhs, y)
        if not _swap_slack(state.cords, rows, starts, columns, matrix, rhs, y):
            break
    for i in range(m):
        result.cords[rows[i]]["tension"] = max(y[i], 0.0)


@njit(cache=True)
def _factor_and_solve(
    cords: Records, rows: Integers, starts: Integers, columns: Integers,
    matrix: Array, factor: Array, rhs: Array, y: Array,
) -> None:
    """L D L^T y = rhs over the tendons that pull; y = 0 for the slack ones."""
    m = len(rows)
    for i in range(m):
        first, diagonal = starts[i], starts[i + 1] - 1
        if not cords[rows[i]]["active"]:
            factor[first:diagonal] = 0.0
            factor[diagonal] = 1.0
            y[i] = 0.0
            continue
        d = matrix[diagonal]
        total = rhs[i]
        for p in range(first, diagonal):
            j = columns[p]
            value = matrix[p] if cords[rows[j]]["active"] else 0.0
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
    cords: Records, rows: Integers, starts: Integers, columns: Integers,
    matrix: Array, rhs: Array, y: Array,
) -> bool:
    """Let go of tendons that would push, take up slack ones that would pull; True if any."""
    m = len(rows)
    changed = False
    for i in range(m):
        if cords[rows[i]]["active"] and y[i] < 0.0:
            cords[rows[i]]["active"] = 0
            changed = True
    if changed:
        return True
    for i in range(m):
        if cords[rows[i]]["active"]:
            continue
        left = rhs[i]
        for p in range(starts[i], starts[i + 1] - 1):
            left -= matrix[p] * y[columns[p]]
        for j in range(i + 1, m):
            for p in range(starts[j], starts[j + 1] - 1):
                if columns[p] == i:
                    left -= matrix[p] * y[j]
        if left > 0.0:
            cords[rows[i]]["active"] = 1
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
