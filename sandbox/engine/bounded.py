"""Rows with bounds, solved exactly on what the bilateral rows leave of the mechanism.

Contacts, stops, ropes, ends of grooves, motors and brakes each have a rate y and an impulse p:

    low <= p <= high,   y = 0 in between,   y >= 0 at low,   y <= 0 at high,    y = f + G p

a contact's tangential row with the bounds -mu p_n and mu p_n, and that of a guide that holds its
tendon likewise, by the sum of the tensions on either side; that sum is a row of its own, which acts
on nothing: y = p - sum, without bounds; the load of a joint, which bounds its friction, is
another. G is the response of the rows to one another through the mechanism, f their state without
them. A row's *mode* says which of the three holds; modes given, p follows from one linear system.
Where that breaks a bound or leaves a rate of the wrong sign the mode changes, and so on until
nothing does:

- a row goes from one bound to the other by way of y = 0 only;
- a sticking contact that would pull slides first, and opens only if it pulls sliding;
- after a few rounds only the worst rows change; if that does not end, single rows in random order,
  and if that does not end, relaxation from the last impulses takes its place.

Where rows outnumber the freedoms left, their share in the load is not determined. A small
multiple of the change of p is therefore added to y: the share stays as it was, so that rest is
rest. Of a row that itself has a rate (what comes to touch, a motor) the last p fades before.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import clear
from sandbox.numeric import Array, Integers, Records

HOLD, HOLD_TANGENT = 1e-10, 1e-7
"""How strongly normal and tangential impulses are held to the last, as a share of y for 1 N s."""
FADE, MOVING = 0.01, 1e-3
"""Share of its last impulse that a row loses in a step; rate [m/s, rad/s] below which less."""
UNBOUNDED = 1e300  # as the bound of an impulse that has none [N s, N m s]
LEVER = 0.1
"""Where joints leave less than this share of what an impulse does to the bodies alone, overlaps are
undone the more slowly: by a short lever they would throw them."""
FIRST, MODE_ROUNDS, SWEEPS = 4, 40, 60  # rounds in which all rows change; all; of relaxation
SEARCHED, TRIES = 100, 6  # rows up to which modes are searched in random order; attempts
LARGE, MIN_ROUNDS = 600, 8  # rows beyond which there are fewer rounds; minimum of these
UNFACTORED = 2  # as the mode in which a row was factored: none
SHARE, ALONE = 0.3, 3
"""Later rows change from this share of the largest violation on; every so many rounds it alone."""


@kernel
def begin_row(out: Any, source: int, index: int, a: int, b: int, last: float, mode: int) -> None:
    """Make ``out`` a row on two bodies without coefficients, bounds, friction or compliance."""
    out["source"], out["index"], out["a"], out["b"] = source, index, a, b
    out["ax"] = out["ay"] = out["at"] = out["bx"] = out["by"] = out["bt"] = 0.0
    out["bias"] = out["low"] = out["high"] = out["friction"] = out["soft"] = out["tight"] = 0.0
    out["last"], out["mode"], out["normal"], out["branch"] = last, mode, -1, 0
    out["measure"] = out["gentle"] = out["passive"] = 0
    out["hold"], out["static"] = HOLD, 1.0


@kernel
def put_coordinate(out: Any, coordinate: Any, side: float) -> None:
    """Give a row the coefficients of a coordinate, times ``side``."""
    out["ax"], out["ay"] = -side * coordinate["dx"], -side * coordinate["dy"]
    out["bx"], out["by"] = side * coordinate["dx"], side * coordinate["dy"]
    out["at"], out["bt"] = side * coordinate["ta"], side * coordinate["tb"]


@entry_point()
def columns(table: int, begin: int, first: int, count: int) -> None:
    """Y = L^-1 R W C^T of the rows from ``first`` on, counted from ``begin``; 0 elsewhere."""
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    hubs, entry_row, WJ = at.hubs(table), at.entry_row(table), at.entries(table)[1]
    body_starts, body_entries = at.body_starts(table), at.body_entries(table)
    branch_starts, branches = at.branch_starts(table), at.branches(table)
    starts, below, values = at.starts(table), at.below(table), at.values(table)
    for k in range(first, count):
        row, y, n = rows[k], Y[k], 0
        a, b = row["a"], row["b"]
        i, last_i = branch_starts[a], branch_starts[a + 1]
        j, last_j = branch_starts[b], branch_starts[b + 1]
        while i < last_i or j < last_j:  # both lists are in order
            left = branches[i] if i < last_i else len(y)
            right = branches[j] if j < last_j else len(y)
            reached[k, n] = min(left, right)
            if left <= right:
                i += 1
            if right <= left:
                j += 1
            n += 1
        row["branch"] = n
        for side in range(2):
            body = a if side == 0 else b
            x = row["ax"] if side == 0 else row["bx"]
            z = row["ay"] if side == 0 else row["by"]
            t = row["at"] if side == 0 else row["bt"]
            if hubs[body, 0] >= 0:
                y[hubs[body, 0]] += x
                y[hubs[body, 1]] += z
                y[hubs[body, 2]] += t
                continue
            for q in range(body_starts[body], body_starts[body + 1]):
                e = body_entries[q]
                y[entry_row[e]] += WJ[e, 0] * x + WJ[e, 1] * z + WJ[e, 2] * t
        for q in range(n):
            r = reached[k, q]
            x = y[r]
            if x != 0.0:
                for p in range(starts[r], starts[r + 1]):
                    y[below[p]] -= values[p] * x


@kernel
def wipe(table: int, begin: int, count: int) -> None:
    """Make the columns of so many rows from ``begin`` on 0 again."""
    rows, Y, reached = at.rows(table), at.columns(table), at.reached(table)
    for k in range(begin, begin + count):
        for q in range(rows[k]["branch"]):
            Y[k, reached[k, q]] = 0.0
        rows[k]["branch"] = 0


@entry_point()
def couple(table: int, begin: int, first: int, count: int) -> None:
    """G, and y without bounded impulses, for the rows from ``first`` on, counted from ``begin``."""
    rows, Y, reached = (
        at.rows(table)[begin:], at.columns(table)[begin:], at.reached(table)[begin:])
    hubs, inverse_mass, free = at.hubs(table), at.inverse_mass(table), at.free(table)
    values, G = at.values(table), at.delassus(table)
    diagonal = len(values) - at.unknowns(table).shape[1]
    scaled = at.unknowns(table)[4]  # D^-1 y of the row
    clear(scaled)
    for k in range(first, count):
        row, y = rows[k], Y[k]
        a, b, n = row["a"], row["b"], row["branch"]
        for q in range(n):
            r = reached[k, q]
            scaled[r] = y[r] * values[diagonal + r]
        row["free"] = free_rate(table, row, y, reached[k], free, row["bias"])
        row["base"] = 0.0
        if a < len(inverse_mass):
            row["base"] = (
                inverse_mass[a, 0] * (row["ax"] ** 2 + row["ay"] ** 2)
                + inverse_mass[b, 0] * (row["bx"] ** 2 + row["by"] ** 2)
                + inverse_mass[a, 1] * row["at"] ** 2 + inverse_mass[b, 1] * row["bt"] ** 2)
        ax = ay = ta = bx = by = tb = 0.0
        if hubs[a, 0] < 0:
            w, wt = inverse_mass[a, 0], inverse_mass[a, 1]
            ax, ay, ta = w * row["ax"], w * row["ay"], wt * row["at"]
        if hubs[b, 0] < 0:
            w, wt = inverse_mass[b, 0], inverse_mass[b, 1]
            bx, by, tb = w * row["bx"], w * row["by"], wt * row["bt"]
        for m in range(k + 1):
            other, z = rows[m], Y[m]
            x = 0.0
            if other["a"] == a:
                x += ax * other["ax"] + ay * other["ay"] + ta * other["at"]
            if other["b"] == a:
                x += ax * other["bx"] + ay * other["by"] + ta * other["bt"]
            if other["a"] == b:
                x += bx * other["ax"] + by * other["ay"] + tb * other["at"]
            if other["b"] == b:
                x += bx * other["bx"] + by * other["by"] + tb * other["bt"]
            short = m if other["branch"] < n else k
            for q in range(min(n, other["branch"])):
                r = reached[short, q]
                if scaled[r] != 0.0:
                    x -= scaled[r] * z[r]
            G[k, m] = 0.0 if other["measure"] else x
            G[m, k] = 0.0 if row["measure"] else x
        for q in range(n):
            scaled[reached[k, q]] = 0.0
        G[k, k] = 1.0 if row["measure"] else G[k, k] + row["soft"]
        row["back"] = 0.0
        if row["bias"] < 0.0 and row["gentle"]:  # undone so slowly that it throws no body
            row["back"] = row["bias"] * min(1.0, G[k, k] / (LEVER * row["base"]))
            row["free"] += row["back"] - row["bias"]
        row["out"] = G[k, k] < HOLD * row["base"]
        if row["out"]:
            row["free"] = row["back"] = row["last"] = 0.0
            for q in range(n):
                y[reached[k, q]] = 0.0
        for m in range(k + 1):
            if row["out"] or rows[m]["out"]:
                G[k, m] = G[m, k] = 0.0


@kernel
def free_rate(table: int, row: Any, y: Array, reached: Integers, free: Array, f: float) -> float:
    """``f`` and what a row makes of free velocities and of what bilateral rows add to them."""
    hubs, values, solved = at.hubs(table), at.values(table), at.unknowns(table)[2]
    a, b, diagonal = row["a"], row["b"], len(values) - len(solved)
    if hubs[a, 0] < 0:
        f += row["ax"] * free[a, 0] + row["ay"] * free[a, 1] + row["at"] * free[a, 2]
    if hubs[b, 0] < 0:
        f += row["bx"] * free[b, 0] + row["by"] * free[b, 1] + row["bt"] * free[b, 2]
    for q in range(row["branch"]):
        f += y[reached[q]] * values[diagonal + reached[q]] * solved[reached[q]]
    return float(f)


@kernel
def rate(row: Any, velocity: Array) -> float:
    """What a row makes of velocities [nb, 3] of the bodies."""
    a, b = row["a"], row["b"]
    return float(row["ax"] * velocity[a, 0] + row["ay"] * velocity[a, 1]
                 + row["at"] * velocity[a, 2] + row["bx"] * velocity[b, 0]
                 + row["by"] * velocity[b, 1] + row["bt"] * velocity[b, 2])


@kernel
def solve_modes(
    rows: Records, n: int, G: Array, A: Array, chosen: Integers, slack: float, again: bool,
) -> int:
    """Find the modes and the impulses ``p``; how many systems it took, negative if it gave up.

    It begins with the modes of the rows; ``slack`` is a rate that counts as none, ``A`` and
    ``chosen`` are scratch. ``again``: only rates changed since the last call.
    """
    if n > 0 and not again:
        rows[0]["factored"] = UNFACTORED
    rounds = MODE_ROUNDS if n <= LARGE else max(MIN_ROUNDS, int(MODE_ROUNDS * (LARGE / n) ** 3))
    for round in range(1, rounds + 1):
        _impulses(rows, n, G, A, chosen)
        worst, which = slack, -1
        for k in range(n):
            bad, _ = _violation(rows, n, G, k, slack)
            rows[k]["violation"] = bad
            if bad > worst:
                worst, which = bad, k
        if which < 0:
            return round
        share = 0.0 if round <= FIRST else SHARE if round % ALONE else 1.0
        for k in range(n):
            if rows[k]["violation"] > slack and rows[k]["violation"] >= share * worst:
                _, to = _violation(rows, n, G, k, slack)
                _change(rows, n, k, to)
    return -rounds


@kernel
def search_modes(rows: Records, n: int, G: Array, A: Array, chosen: Integers, slack: float) -> bool:
    """Change the row with the largest violation times a random number, until none is left."""
    random = 1
    for _ in range(TRIES):
        for k in range(n):
            free = rows[k]["normal"] >= 0 or rows[k]["low"] == -UNBOUNDED
            rows[k]["mode"] = 0 if free else -1
        for _ in range(2 * n + MODE_ROUNDS):
            _impulses(rows, n, G, A, chosen)
            most, which, mode = 0.0, -1, 0
            for k in range(n):
                bad, to = _violation(rows, n, G, k, slack)
                random = (1103515245 * random + 12345) % 2147483648
                if bad > slack and bad * random > most:
                    most, which, mode = bad * random, k, to
            if which < 0:
                return True
            _change(rows, n, which, mode)
    return False


@kernel
def choose(rows: Records, n: int, chosen: Integers) -> int:
    """The rows with y = 0."""
    m = 0
    for k in range(n):
        t = rows[k]["normal"]
        if rows[k]["mode"] == 0 and (t < 0 or rows[t]["mode"] == 0):
            chosen[m] = k
            m += 1
    return m


@kernel
def make_system(rows: Records, n: int, G: Array, A: Array, chosen: Integers, m: int) -> None:
    """Their equations without right sides."""
    for r in range(m):
        i = chosen[r]
        row = rows[i]
        for c in range(m):
            k = chosen[c]
            x = G[i, k]
            if k + 1 < n and rows[k + 1]["normal"] == k and rows[k + 1]["mode"] != 0:
                x += rows[k + 1]["mode"] * rows[k + 1]["friction"] * G[i, k + 1]
            A[r, c] = x
        A[r, r] += held(row)


@kernel
def factor_system(A: Array, m: int, swaps: Integers) -> None:
    """Factor in place; ``swaps`` are the rows that are exchanged with each column's."""
    for c in range(m):
        pivot, best = c, abs(A[c, c])
        for r in range(c + 1, m):
            if abs(A[r, c]) > 8.0 * best:
                best, pivot = abs(A[r, c]), r
        swaps[c] = pivot
        if pivot != c:
            for q in range(c, m):
                A[c, q], A[pivot, q] = A[pivot, q], A[c, q]
        inverse = 1.0 / A[c, c]
        for r in range(c + 1, m):
            x = A[r, c] * inverse
            A[r, c] = x
            if x != 0.0:
                for q in range(c + 1, m):
                    A[r, q] -= x * A[c, q]


@kernel
def solve_system(A: Array, m: int, swaps: Integers) -> None:
    """Solve for the last column in place."""
    for c in range(m):
        x = A[swaps[c], m]
        A[swaps[c], m], A[c, m] = A[c, m], x
        if x != 0.0:
            for r in range(c + 1, m):
                A[r, m] -= A[r, c] * x
    for r in range(m - 1, -1, -1):
        x = A[r, m]
        for q in range(r + 1, m):
            x -= A[r, q] * A[q, m]
        A[r, m] = x / A[r, r]


@kernel
def _impulses(rows: Records, n: int, G: Array, A: Array, chosen: Integers) -> None:
    m, swaps, same, pressed = choose(rows, n, chosen), chosen[n:], True, False
    for k in range(n):
        row = rows[k]
        same &= row["factored"] == row["mode"]
        row["factored"], row["p"] = row["mode"], 0.0
        if row["normal"] < 0 and row["mode"] != 0:
            row["p"] = row["low"] if row["mode"] < 0 else row["high"]
            pressed |= row["p"] != 0.0
    if not same:
        make_system(rows, n, G, A, chosen, m)
        factor_system(A, m, swaps)
    for r in range(m):
        i = chosen[r]
        f = rows[i]["free"]
        for k in range(n if pressed else 0):  # only those at a bound have one so far
            if rows[k]["p"] != 0.0:
                f += G[i, k] * rows[k]["p"]
        A[r, m] = held(rows[i]) * rows[i]["last"] - f
    solve_system(A, m, swaps)
    for r in range(m):
        rows[chosen[r]]["p"] = A[r, m]
    for k in range(n):
        row = rows[k]
        if row["normal"] >= 0 and row["mode"] != 0 and rows[row["normal"]]["mode"] == 0:
            row["p"] = row["mode"] * row["friction"] * rows[row["normal"]]["p"]


@kernel
def held(row: Any) -> float:
    """What is added to y for a change of the row's impulse by 1 N s."""
    return float(row["hold"] * row["base"])


@kernel
def y_of(rows: Records, n: int, G: Array, k: int) -> float:
    """Y of row ``k`` as the impulses of all n have it, f + G p."""
    y = rows[k]["free"]
    for q in range(n):
        y += G[k, q] * rows[q]["p"]
    return float(y)


@kernel
def _violation(rows: Records, n: int, G: Array, k: int, slack: float) -> tuple[float, int]:
    """By how much a row breaks its mode, as a rate, and the mode that it should have."""
    row = rows[k]
    t, mode, p = row["normal"], row["mode"], row["p"]
    if t >= 0 and rows[t]["mode"] != 0:
        return 0.0, 0
    if mode != 0:
        if row["passive"] and t >= 0 and rows[t]["p"] < 0.0:
            return float(-row["friction"] * rows[t]["p"] * G[k, k]), 0  # it would drive
        if row["low"] == row["high"] and t < 0:
            return 0.0, mode
        y = y_of(rows, n, G, k) + held(row) * (p - row["last"])
        return float(y * mode), 0
    low, high = row["low"], row["high"]
    if t >= 0:
        high = max(row["friction"] * rows[t]["p"], 0.0)
        low = -high
    beyond = max(low - p, p - high)
    if beyond <= 0.0:
        return 0.0, 0
    bad = float(beyond * G[k, k])
    if row["tight"] > 0.0 and beyond > row["tight"] * abs(rows[t]["p"]):
        bad = max(bad, 2.0 * slack)
    return bad, -1 if p < low else 1


@kernel
def _change(rows: Records, n: int, k: int, to: int) -> None:
    """Give a row another mode; a contact's two rows go together."""
    paired = rows[k]["normal"] < 0 and k + 1 < n and rows[k + 1]["normal"] == k
    if paired and to == -1 and rows[k + 1]["mode"] == 0 and rows[k + 1]["p"] != 0.0:
        rows[k + 1]["mode"] = 1 if rows[k + 1]["p"] > 0.0 else -1
        return
    rows[k]["mode"] = to
    if paired and to == 0:
        rows[k + 1]["mode"] = 0


@kernel
def relax(rows: Records, n: int, G: Array) -> None:
    """Relaxation from the last impulses, and the modes that it leads to."""
    for k in range(n):
        rows[k]["p"] = rows[k]["last"]
    for _ in range(SWEEPS):
        for k in range(n):
            row, y = rows[k], y_of(rows, n, G, k)
            low, high = _bounds(rows, k)
            row["p"] = min(max(row["p"] - y / (G[k, k] + 1e-12 * row["base"]), low), high)
    for k in range(n):
        low, high = _bounds(rows, k)
        p = rows[k]["p"]
        rows[k]["mode"] = -1 if p <= low else 1 if p >= high else 0


@kernel
def residual(rows: Records, n: int, G: Array, k: int) -> float:
    """By what rate row ``k`` violates its law; a row that joints hold has none."""
    row, (low, high) = rows[k], _bounds(rows, k)
    if row["out"]:
        return 0.0
    p = min(max(row["p"] - y_of(rows, n, G, k) / G[k, k], low), high)
    return float(abs(row["p"] - p) * G[k, k])


@kernel
def _bounds(rows: Records, k: int) -> tuple[float, float]:
    t = rows[k]["normal"]
    if t < 0:
        return rows[k]["low"], rows[k]["high"]
    most = rows[k]["friction"] * rows[t]["p"]
    return -most, most


@kernel
def push(inverse_mass: Array, row: Any, p: float, velocity: Array) -> None:
    """Add what an impulse of a bounded row does to the velocities of its bodies."""
    a, b = row["a"], row["b"]
    if a >= len(velocity):  # what is bounded is the slip of a tendon
        return
    wa, wb = inverse_mass[a, 0] * p, inverse_mass[b, 0] * p
    velocity[a, 0] += wa * row["ax"]
    velocity[a, 1] += wa * row["ay"]
    velocity[a, 2] += inverse_mass[a, 1] * p * row["at"]
    velocity[b, 0] += wb * row["bx"]
    velocity[b, 1] += wb * row["by"]
    velocity[b, 2] += inverse_mass[b, 1] * p * row["bt"]
