"""Loads of bodies: forces by laws of a body's own motion, F = F(x, v, a, t).

The step takes the sum F of a body's loads linearised in its velocities v at the step's end:

    F(v) = F(u) + L (v - u),     L = dF/dv,    u where it was linearised

With M the body's mass and inertia, the symmetric part of -M^-1/2 L M^-1/2 has the axes q and the
rates l along them, and each is a row J = M^1/2 q

    J v + p / (h l) = J u

beside F(u), which is among the known forces. Where l is below 0 the load drives; h l > -1 keeps the
pivots of the matrix. The rest of L, which does no work, is found by iteration: where F differs at
the velocities after the step, it is solved again with u there. The largest rate l at the step's
end, slopes by position included, decides how a law is integrated:

    h l below 1    F(x, (v_before + v) / 2, (v - v_before) / h)     (second order)
    above          F(x + h v, v, (v - v_before) / h)                (the step's end)

Buoyancy needs the area of an outline below a level and its moment, by Green's theorem. With d the
height over the level, along the part of the outline below it (d = 0 along the level itself),

    A = - ∮ d dx          ∬ x dA = - ∮ x d dx
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.formulas import formula
from sandbox.engine.kernel import kernel
from sandbox.engine.records import AXES, GIVEN, SCRATCH, SLOPES, SOFT, SUM, YIELDS
from sandbox.engine.rows import NOTHING
from sandbox.engine.springs import SAME
from sandbox.numeric import Array, Matrix

(X, Y, ANGLE, VX, VY, OMEGA, SPEED, AX, AY, ALPHA, TIME, MASS, INERTIA) = range(13)
"""See elements.loads.MOTION."""
WEAK = 1e-14  # minimum rate of a row, times h
DRIVING = -0.9  # minimum h l of a row: loads that drive more are found by repetition
SWEEPS = 12  # of Jacobi's rotations: each squares the off-diagonal entries


@kernel
def _set(read: Array, k: int, value: float, by_x: float, by_y: float, by_turn: float) -> None:
    read[k, 0], read[k, 1], read[k, 2], read[k, 3] = value, by_x, by_y, by_turn


@kernel
def _motion(table: int, load: Any, h: float, after: Array, end: bool, lag: float) -> Any:
    """Set the arguments of a law and their slopes; cosine, sine of the angle, arm of the force."""
    body, before, read = at.body(table), at.before(table), at.read_names(table)
    b = load["body"]
    ahead, share = (h, 1.0) if end else (0.0, 0.5)
    u = before[b, 0] + share * (after[b, 0] - before[b, 0])
    v = before[b, 1] + share * (after[b, 1] - before[b, 1])
    w = before[b, 2] + share * (after[b, 2] - before[b, 2])
    angle = body[b, 2] + ahead * after[b, 2]
    c, s = math.cos(angle), math.sin(angle)
    rx, ry = c * load["x"] - s * load["y"], s * load["x"] + c * load["y"]
    _set(read, X, body[b, 0] + ahead * after[b, 0] + rx, ahead, 0.0, -ry * ahead)
    _set(read, Y, body[b, 1] + ahead * after[b, 1] + ry, 0.0, ahead, rx * ahead)
    _set(read, ANGLE, angle, 0.0, 0.0, ahead)
    _set(read, VX, u - w * ry, share, 0.0, -ry * share - w * rx * ahead)
    _set(read, VY, v + w * rx, 0.0, share, rx * share - w * ry * ahead)
    _set(read, OMEGA, w, 0.0, 0.0, share)
    al = (after[b, 2] - before[b, 2]) / h
    turned = al * rx - w * w * ry, al * ry + w * w * rx  # its change by the turning arm
    _set(read, AX, (after[b, 0] - before[b, 0]) / h - al * ry - w * w * rx, lag, 0.0,
         -lag * ry - 2.0 * w * rx * share - turned[0] * ahead)
    _set(read, AY, (after[b, 1] - before[b, 1]) / h + al * rx - w * w * ry, 0.0, lag,
         lag * rx - 2.0 * w * ry * share - turned[1] * ahead)
    _set(read, ALPHA, al, 0.0, 0.0, lag)
    _set(read, TIME, (at.made(table)[0] - 0.5) * h, 0.0, 0.0, 0.0)
    _set(read, MASS, load["mass"], 0.0, 0.0, 0.0)
    _set(read, INERTIA, load["inertia"], 0.0, 0.0, 0.0)
    if load["turning"]:
        _turn(read, VX, c, -s, -ahead)
        _turn(read, AX, c, -s, -ahead)
    speed = math.hypot(read[VX, 0], read[VY, 0])
    read[SPEED, 0] = speed
    for j in range(1, 4):
        along = read[VX, 0] * read[VX, j] + read[VY, 0] * read[VY, j]
        read[SPEED, j] = along / speed if speed > 0.0 else 0.0
    return c, s, rx, ry


@kernel
def _turn(pairs: Array, k: int, c: float, s: float, ahead: float) -> None:
    """Turn the vector of rows ``k`` and ``k + 1`` with its slopes; ``ahead`` by the turning."""
    for j in range(4):
        x, y = pairs[k, j], pairs[k + 1, j]
        pairs[k, j], pairs[k + 1, j] = c * x - s * y, s * x + c * y
    pairs[k, 3] -= ahead * pairs[k + 1, 0]
    pairs[k + 1, 3] += ahead * pairs[k, 0]


@kernel
def _sum(table: int, k: int, h: float, after: Array, end: bool, lag: float) -> None:
    """The sum of a body's loads and its slopes; each load's own is kept."""
    loaded, numbers, into = at.loaded(table)[k], at.pressing(table)[k], at.load_terms(table)
    body, turn, ahead = at.body(table), at.turn(table), h if end else 0.0
    numbers[SUM:SLOPES + 3] = 0.0
    for i in range(loaded["first"], loaded["last"]):
        load = at.loads(table)[i]
        into[:] = 0.0  # force, torque about the centre of mass, and their slopes
        if load["last"] > load["first"]:
            b = load["body"]
            area, moment = submerged_area(
                at.sides(table), load["first"], load["last"], turn[b, 0], turn[b, 1], body[b, 2],
                body[b, 1] - load["level"])
            into[1, 0], into[2, 0] = load["lift"] * area, load["lift"] * moment
        else:
            c, s, rx, ry = _motion(table, load, h, after, end, lag)
            codes = load["x_code"], load["y_code"], load["t_code"]
            code_ends = load["x_end"], load["y_end"], load["t_end"]
            for m in range(3):
                if codes[m] >= 0:
                    formula(table, codes[m], code_ends[m], at.read_names(table))
                    for j in range(4):
                        into[m, j] = (load["scale"] if m < 2 else 1.0) * at.stack(table)[0, j]
            if load["turning"]:
                _turn(into, 0, c, s, ahead)
            for j in range(4):
                into[2, j] += rx * into[1, j] - ry * into[0, j]
            into[2, 3] -= ahead * (ry * into[1, 0] + rx * into[0, 0])
        for m in range(3):
            numbers[SUM, m] += into[m, 0]
            for j in range(3):
                numbers[SLOPES + m, j] += into[m, 1 + j]
        load["fx"], load["fy"], load["torque"] = into[0, 0], into[1, 0], into[2, 0]


@kernel
def _rates(numbers: Array, w: float, wt: float) -> None:
    """Rates and axes of the symmetric part of the slopes, by Jacobi's rotations."""
    root = (math.sqrt(w), math.sqrt(w), math.sqrt(wt))
    A, Q = numbers[SCRATCH:SCRATCH + 3], numbers[AXES:AXES + 3]
    for i in range(3):
        for j in range(3):
            A[i, j] = -0.5 * root[i] * root[j] * (numbers[SLOPES + i, j] + numbers[SLOPES + j, i])
            Q[i, j] = 1.0 if i == j else 0.0
    for _ in range(SWEEPS):
        if A[0, 1] == 0.0 and A[0, 2] == 0.0 and A[1, 2] == 0.0:
            break
        for i in range(2):
            for j in range(i + 1, 3):
                if A[i, j] == 0.0 or not math.isfinite(A[i, j]):
                    continue
                turn = (A[j, j] - A[i, i]) / (2.0 * A[i, j])
                t = math.copysign(1.0, turn) / (abs(turn) + math.sqrt(1.0 + turn * turn))
                c = 1.0 / math.sqrt(1.0 + t * t)
                s = t * c
                for n in range(3):
                    x, y = A[n, i], A[n, j]
                    A[n, i], A[n, j] = c * x - s * y, s * x + c * y
                for n in range(3):
                    x, y = A[i, n], A[j, n]
                    A[i, n], A[j, n] = c * x - s * y, s * x + c * y
                    x, y = Q[i, n], Q[j, n]
                    Q[i, n], Q[j, n] = c * x - s * y, s * x + c * y
                A[i, j] = A[j, i] = 0.0
    for i in range(3):
        numbers[YIELDS, i] = A[i, i]
        for j in range(3):
            Q[i, j] /= root[j]


@kernel
def _weigh(table: int, k: int, h: float, after: Array) -> None:
    """Find the sum of a body's loads for the velocities after a step, and its integration."""
    loaded, numbers = at.loaded(table)[k], at.pressing(table)[k]
    w = at.inverse_mass(table)[loaded["body"]]
    if loaded["row"] >= 0:
        if loaded["stiff"] == 0:
            _sum(table, k, h, after, True, 0.0)
            _rates(numbers, w[0], w[1])
            if h * max(numbers[YIELDS, 0], numbers[YIELDS, 1], numbers[YIELDS, 2]) > SOFT:
                loaded["stiff"] = 1
        _sum(table, k, h, after, loaded["stiff"] == 1, 1.0 / h)
        _rates(numbers, w[0], w[1])
    else:
        _sum(table, k, h, after, False, 0.0)


@entry_point("loads")
def press(table: int, h: float) -> None:
    """Forces of all loads for the velocities before the step."""
    loaded, force = at.loaded(table), at.force(table)
    before, numbers = at.before(table), at.pressing(table)
    for k in range(len(loaded)):
        loaded[k]["stiff"] = 0
        _weigh(table, k, h, before)
        for j in range(3):
            numbers[k, GIVEN, j] = numbers[k, SUM, j]
            force[loaded[k]["body"], j] += numbers[k, SUM, j]


@kernel
def _set_rows(table: int, k: int, h: float, after: Array) -> None:
    """Set the rows of a body for the linearisation of its loads at the velocities ``after``."""
    rhs, compliance = at.unknowns(table)[0], at.unknowns(table)[1]
    loaded, numbers, J = at.loaded(table)[k], at.pressing(table)[k], at.entries(table)[0]
    b, rows = loaded["body"], (loaded["row"], loaded["row_y"], loaded["row_turn"])
    for m in range(3):
        e, r, rate = loaded["entry"] + m, rows[m], max(numbers[YIELDS, m], DRIVING / h)
        rhs[r], compliance[r] = 0.0, 1.0
        J[e] = 0.0
        if h * abs(rate) > WEAK:
            compliance[r] = 1.0 / (h * rate)
            for j in range(3):
                J[e, j] = numbers[AXES + m, j]
                rhs[r] += J[e, j] * after[b, j]


@entry_point("loads")
def load_rows(table: int, h: float) -> None:
    """Those of all bodies with loads that depend on their motion."""
    loaded = at.loaded(table)
    for k in range(len(loaded)):
        if loaded[k]["row"] >= 0:
            _set_rows(table, k, h, at.before(table))


@entry_point("loads")
def change_loads(table: int, h: float) -> bool:
    """Linearise loads at the new velocities; whether any force changed."""
    loaded, pressing, J = at.loaded(table), at.pressing(table), at.entries(table)[0]
    given, free, inverse = at.unknowns(table)[3], at.free(table), at.inverse_mass(table)
    changed = False
    for k in range(len(loaded)):
        if loaded[k]["row"] < 0:
            continue
        numbers, b, e = pressing[k], loaded[k]["body"], loaded[k]["entry"]
        rows = (loaded[k]["row"], loaded[k]["row_y"], loaded[k]["row_turn"])
        acted = numbers[SCRATCH + 3]
        for j in range(3):
            acted[j] = numbers[GIVEN, j]
            for m in range(3):
                acted[j] += J[e + m, j] * given[rows[m]] / h
        _weigh(table, k, h, at.velocity(table))
        if _same(numbers, acted, inverse[b, 0], inverse[b, 1]):
            continue
        changed = True
        for j in range(3):
            w = inverse[b, 1] if j == 2 else inverse[b, 0]
            free[b, j] += h * w * (numbers[SUM, j] - numbers[GIVEN, j])
            numbers[GIVEN, j] = numbers[SUM, j]
        _set_rows(table, k, h, at.velocity(table))
    return changed


@kernel
def _same(numbers: Array, acted: Array, w: float, wt: float) -> bool:
    """Whether loads equal those that acted, to rounding, as accelerations of the body."""
    off, size, slope = 0.0, 0.0, 0.0
    for j in range(3):
        weight = wt if j == 2 else w
        off += weight * (numbers[SUM, j] - acted[j]) ** 2
        size += weight * (numbers[SUM, j] ** 2 + acted[j] ** 2)
        slope += abs(numbers[YIELDS, j])
    # written so that NaN is another
    return bool(math.sqrt(off) <= SAME * math.sqrt(size) + NOTHING * (1.0 + slope) / math.sqrt(w))


@entry_point("loads")
def timed(table: int) -> bool:
    """Whether any load depends on time: then rest may end."""
    found = False
    for i in range(len(at.loads(table))):
        found |= at.loads(table)[i]["timed"] != 0
    return found


@entry_point("loads")
def add_load_work(table: int, h: float, v: Matrix) -> None:
    """Work of the step just made; ``v`` [nb, 3] are the mean velocities of before and after it."""
    loads = at.loads(table)
    for i in range(len(loads)):
        load, b = loads[i], loads[i]["body"]
        load["step_work"] = h * (load["fx"] * v[b, 0] + load["fy"] * v[b, 1]
                                 + load["torque"] * v[b, 2])
        load["work"] += load["step_work"]


@kernel
def submerged_area(
    sides: Array, first: int, last: int, c: float, s: float, angle: float, height: float,
) -> tuple[float, float]:
    """Area below a level [m^2], and its moment about the upright line through the centre [m^3]."""
    area, moment = 0.0, 0.0
    for k in range(first, last):
        px, py, radius = sides[k, 0], sides[k, 1], sides[k, 4]
        x, d = c * px - s * py, s * px + c * py + height
        if radius > 0.0:
            one, two = _arc(x, d, radius, sides[k, 2] + angle, sides[k, 3] - sides[k, 2])
        else:
            qx, qy = sides[k, 2], sides[k, 3]
            one, two = _straight(x, d, c * qx - s * qy, s * qx + c * qy + height)
        area -= one
        moment -= two
    return area, moment


@kernel
def _straight(x1: float, d1: float, x2: float, d2: float) -> tuple[float, float]:
    """∫ d dx and ∫ x d dx along what of a side is below d = 0."""
    if d1 >= 0.0 and d2 >= 0.0:
        return 0.0, 0.0
    if d1 > 0.0:
        x1, d1 = x1 + d1 / (d1 - d2) * (x2 - x1), 0.0
    elif d2 > 0.0:
        x2, d2 = x1 + d1 / (d1 - d2) * (x2 - x1), 0.0
    return ((d1 + d2) / 2 * (x2 - x1),
            (x2 - x1) / 6 * (2 * x1 * d1 + x1 * d2 + x2 * d1 + 2 * x2 * d2))


@kernel
def _arc(x: float, d: float, r: float, start: float, span: float) -> tuple[float, float]:
    """The same along an arc about (x, d) that goes counter-clockwise by ``span``."""
    if d - r >= 0.0:
        return 0.0, 0.0
    half = math.asin(min(max(-d / r, -1.0), 1.0))
    begin = start - math.floor(start / math.tau) * math.tau
    one, two = 0.0, 0.0
    for n in range(3):  # below is from pi - half to 2 pi + half
        turn = (n - 1) * math.tau
        low = max(begin, math.pi - half + turn)
        high = min(begin + span, math.tau + half + turn)
        if high > low:
            (a, b), (before, before_x) = _up_to(d, r, high), _up_to(d, r, low)
            one += a - before
            two += x * (a - before) + (b - before_x)
    return one, two


@kernel
def _up_to(d: float, r: float, phi: float) -> tuple[float, float]:
    """Of an arc up to an angle ∫ d dx and ∫ x d dx, x from its centre."""
    s, c = math.sin(phi), math.cos(phi)
    return -r * (r * (phi - s * c) / 2 - d * c), -r * r * (d * s**2 / 2 + r * s**3 / 3)
