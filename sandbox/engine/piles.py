"""Contacts of many free bodies, solved by a proximal Newton method on the bodies' velocities.

The unknowns are the velocities v of the bodies of all piles (:mod:`sandbox.engine.islands`). With
M the masses, v_f the velocities without contacts, C the contact rows and s their compliances,

    y = C v + want + s p,    0 <= p_n,  y_n >= 0,  p_n y_n = 0,    |p_t| <= mu p_n,
    y_t = 0 where it sticks; p_t = -mu p_n sign(y_t) where it slides         (exact Coulomb law)
    F(v) = M (v - v_f) - C^T p(v) = 0

The law is regularised by a share e of each row's own response G, R = 1 / (e G + s):

    p_n = max(0, R (e G p_n0 - C_n v - want)),  p_t = clip(R (e G p_t0 - C_t v - want), +-mu p_n)

and solved again with p0 = p until the residual of the law without e is below the tolerance. The
derivative of F is M plus 3 x 3 blocks of bodies that touch; it is factored sparsely
(:mod:`sandbox.engine.blocks`), with the rows of joints, springs and tendons as further unknowns
(:mod:`sandbox.engine.pile_rows`). Limits of joints are contacts without friction; motors and dry
friction of joints are tangential rows with a constant bound. Where Newton's
method does not converge, Gauss-Seidel sweeps find a better start and e grows. Momentum is exact in
any case: v follows from the impulses.

Method: proximal point algorithm with semismooth Newton steps on the primal velocities.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import islands
from sandbox.engine import memory as at
from sandbox.engine.blocks import factor_blocks, solve_blocks
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.pile_rows import add_rows, answer_of_rows, set_blocks
from sandbox.engine.plan import put
from sandbox.numeric import Matrix, Records, Stack

FIRST_SHARE, MAX_SHARE, MIN_SHARE = 1e-5, 1e-2, 1e-9  # initial, largest and smallest share e
MAX_LINKED, ENOUGH = 0.1, 0.01
"""Where joints connect bodies: the largest share; the residual, over its tolerance, with which the
impulses of the last step are kept. Rates fall below those at which a mechanism rests."""
PROXIMAL_ROUNDS, NEWTON_STEPS, TRIALS, SWEEPS = 100, 8, 2, 50
"""Proximal rounds, Newton steps in each, lengths of a step, sweeps after a failed round."""
FAR_OFF, FIRST_SWEEPS = 1e6, 10
"""Where the residual of the last impulses, over its tolerance, is larger, sweeps come first."""
CYCLE = 16  # rounds after which e changes by smaller factors: they may repeat in a cycle
LAST = -1  # as the number of a solve: the one at the end of a step
LIMIT_ROUNDS = 10  # maximum number of times that limits which the velocities violate are added
FASTEST = 1e6  # a change of rate [m/s] that only a singular matrix gives
BOUNDARY = 1e-9  # nearer to its friction limit than this share, a contact is first taken to slide
OPEN, STICKS, SLIDES_UP, SLIDES_DOWN = 0, 1, 2, 3  # p_t 0, within its limits, at +limit, -limit


@entry_point("piles")
def solve_piles(table: int, h: float, number: int, again: bool) -> float:
    """Find impulses and velocities of all piles that are awake; the largest residual [m/s].

    Where rows connect bodies of piles they are found for each solve of the other rows in a step,
    ``number`` counted from 0, otherwise for the :data:`LAST` only, when the results are noted.
    ``again``: only velocities changed since the last call.
    """
    counts, residual = at.pile_counts(table), 0.0
    if (number == LAST) != (counts[0] == 1):
        residual = _solve_all(table, h, number, again)
    if number == LAST:
        islands.finish_piles(table, h, counts[1])
        at.accuracy(table)[3] += 1.0 if counts[1] else 0.0
    return residual


@kernel
def _solve_all(table: int, h: float, number: int, again: bool) -> float:
    counts, c, bodies = at.pile_counts(table), at.piled(table), at.pile_bodies(table)
    velocity, v, residual = at.velocity(table), at.pile_vectors(table)[0], 0.0
    if number > 0:
        islands.begin_piles(table)
        changed = not again and set_blocks(table)
        for k in range(counts[1]):
            if changed:
                c[k]["factored"] = -1
            c[k]["n_last"], c[k]["t_last"] = c[k]["pn"], c[k]["pt"]
    else:
        counts[1] = islands.gather_piles(table, h)
    for _ in range(LIMIT_ROUNDS):
        while counts[1]:
            residual = solve_contacts(table, counts[1], again)
            again = False
            if not islands.wake_touched(table, counts[1]):
                break
            counts[1] = islands.gather_piles(table, h)
        for i in range(len(bodies)):
            if bodies[i]["piled"]:
                for r in range(3):
                    velocity[bodies[i]["number"], r] = v[i, r] if bodies[i]["awake"] else 0.0
        n = islands.broken_limits(table, h, counts[1]) if counts[0] else counts[1]
        if n == counts[1]:
            break
        counts[1] = n
    solution = at.unknowns(table)[3]
    for r in range(len(solution) if counts[0] and counts[1] else 0):
        solution[r] += at.pile_answer(table)[0, r]
    return residual


@kernel
def solve_contacts(table: int, n: int, again: bool) -> float:
    """Solve ``n`` contacts, with the velocities in the first vectors; largest residual [m/s].

    ``again``: the impulses of the last step are those that it found in the last call.
    """
    c, J, vectors = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)
    v, trial = vectors[0], vectors[1]
    linked = at.pile_counts(table)[0] == 1
    enough, max_share = (ENOUGH, MAX_LINKED) if linked else (1.0, MAX_SHARE)
    for k in range(n):  # start from the impulses of the last step
        c[k]["n0"] = c[k]["pn"] = c[k]["n_last"]
        c[k]["t0"] = c[k]["pt"] = c[k]["t_last"]
    if again:
        _add_free(table, v)
    else:
        _momentum(table, n, v)
    _rates(c, J, n, v, True)
    found = best = _residual(c, n)
    _keep(c, n)
    share, before, first, at_best = FIRST_SHARE, math.inf, True, True
    if best > FAR_OFF and not linked:
        found, first = _sweep(table, n, v, FIRST_SWEEPS), False
        if found < best:
            best = found
            _keep(c, n)
    for round in range(PROXIMAL_ROUNDS):
        if best <= (enough if round == 0 else 1.0):
            break
        start, power = found, 1.0 / (1.0 + round // CYCLE)
        _regularise(c, n, share)
        converged = False
        for _ in range(NEWTON_STEPS):
            at_best = False
            if not _newton_step(table, n, first):
                break
            first = False
            _momentum(table, n, trial)
            found, off = _residual_at(c, J, n, trial)
            if found < best:
                best = found
                _keep(c, n)
            if best <= 1.0 or (off <= 0.05 * found and found <= 4.0 * start):
                converged = True
                put(v, trial)
                at_best = found == best
                break
        first = False
        if best <= 1.0:
            break
        if converged:
            if found > 0.3 * before:  # what sticks cannot: let it slip sooner
                share = max(0.1 ** power * share, MIN_SHARE)
            before = found
            for k in range(n):
                c[k]["n0"], c[k]["t0"] = c[k]["pn"], c[k]["pt"]
        else:
            found = _restart(table, n, v, round)
            if found < best:
                best = found
                _keep(c, n)
            at_best = found == best
            share, before = min(max_share, max(1e-4, 10.0 ** power * share)), math.inf
        _rates(c, J, n, v, True)
    for k in range(n):
        c[k]["pn"], c[k]["pt"] = c[k]["n_best"], c[k]["t_best"]
    if not at_best:
        _momentum(table, n, v)
    _rates(c, J, n, v, True)
    worst = 0.0
    for k in range(n):
        worst = max(worst, _row_residual(c[k]))
    return worst


@kernel
def _regularise(c: Records, n: int, share: float) -> None:
    """Set R and the impulses at rates of 0 for a share e."""
    for k in range(n):
        one = c[k]
        hold_n, hold_t = share * one["base_n"], share * one["base_t"]
        one["Rn"], one["Rt"] = 1.0 / (hold_n + one["soft_n"]), 1.0 / (hold_t + one["soft_t"])
        one["n_shift"], one["t_shift"] = (
            one["n0"] * hold_n * one["Rn"], one["t0"] * hold_t * one["Rt"])


@kernel
def _restart(table: int, n: int, v: Matrix, round: int) -> float:
    """Find another start after a round that did not converge; its residual."""
    c = at.piled(table)
    if round % 2 == 0:
        for k in range(n):
            c[k]["n0"] = c[k]["n_last"] if round == 0 else c[k]["n_best"]
            c[k]["t0"] = c[k]["t_last"] if round == 0 else c[k]["t_best"]
        if at.pile_counts(table)[0]:  # sweeps leave rows of joints out
            return _sweep(table, n, v, 0)
    return _sweep(table, n, v, SWEEPS)


@kernel
def _keep(c: Records, n: int) -> None:
    for k in range(n):
        c[k]["n_best"], c[k]["t_best"] = c[k]["pn"], c[k]["pt"]


@kernel
def _rates(c: Records, J: Stack, n: int, v: Matrix, wanted: bool) -> None:
    """Rates of all rows, with ``want`` or without, into yn and yt or dyn and dyt."""
    for k in range(n):
        one = c[k]
        a, b = one["a"], one["b"]
        yn = yt = 0.0
        if a >= 0:
            yn += J[k, 0, 0] * v[a, 0] + J[k, 0, 1] * v[a, 1] + J[k, 0, 2] * v[a, 2]
            yt += J[k, 2, 0] * v[a, 0] + J[k, 2, 1] * v[a, 1] + J[k, 2, 2] * v[a, 2]
        if b >= 0:
            yn += J[k, 1, 0] * v[b, 0] + J[k, 1, 1] * v[b, 1] + J[k, 1, 2] * v[b, 2]
            yt += J[k, 3, 0] * v[b, 0] + J[k, 3, 1] * v[b, 1] + J[k, 3, 2] * v[b, 2]
        if wanted:
            one["yn"], one["yt"] = yn + one["bias_n"], yt + one["bias_t"]
        else:
            one["dyn"], one["dyt"] = yn, yt


@kernel
def _row_residual(one: Any) -> float:
    """By what rate [m/s] a contact violates the law; inf if a number is not finite."""
    n, t = one["pn"], one["pt"]
    yn, yt = one["yn"] + one["soft_n"] * n, one["yt"] + one["soft_t"] * t
    if not abs(yn) + abs(yt) + abs(n) + abs(t) < 1e12:  # a NaN would vanish in max()
        return math.inf
    limit = one["friction"] * n
    slid = min(max(t - yt / (one["base_t"] + one["soft_t"]), -limit), limit)
    return float(max(abs(min(yn, one["base_n"] * n)), abs(t - slid) * one["base_t"]))


@kernel
def _residual(c: Records, n: int) -> float:
    """The largest residual in units of its tolerance, at the rates and impulses in the rows."""
    worst = 0.0
    for k in range(n):
        worst = max(worst, _row_residual(c[k]) / c[k]["tolerance"])
    return worst


@kernel
def _residual_at(c: Records, J: Stack, n: int, v: Matrix) -> tuple[float, float]:
    """Residual at the ``v`` of the impulses, and Newton's error, in units of the tolerance."""
    for k in range(n):
        c[k]["dyn"], c[k]["dyt"] = c[k]["yn"], c[k]["yt"]
    _rates(c, J, n, v, True)
    found, off = _residual(c, n), 0.0
    for k in range(n):
        one = c[k]
        change = max(abs(one["dyn"] - one["yn"]), abs(one["dyt"] - one["yt"]))
        off = max(off, change / one["tolerance"])
        one["yn"], one["yt"] = one["dyn"], one["dyt"]
    return found, off


@kernel
def _add_impulses(c: Records, J: Stack, n: int, sign: float, v: Matrix) -> None:
    for k in range(n):
        a, b, pn, pt = c[k]["a"], c[k]["b"], sign * c[k]["pn"], sign * c[k]["pt"]
        if pn == 0.0 and pt == 0.0:
            continue
        for r in range(3):
            if a >= 0:
                v[a, r] += J[k, 0, r] * pn + J[k, 2, r] * pt
            if b >= 0:
                v[b, r] += J[k, 1, r] * pn + J[k, 3, r] * pt


@kernel
def _momentum(table: int, n: int, v: Matrix) -> None:
    c, J, free = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)[2]
    weights, answer = at.pile_vectors(table)[3], at.pile_vectors(table)[7]
    for i in range(len(answer)):
        answer[i, 0] = answer[i, 1] = answer[i, 2] = 0.0
    _add_impulses(c, J, n, 1.0, answer)
    if at.pile_counts(table)[0]:
        answer_of_rows(table, answer)
        _add_free(table, v)
        return
    for i in range(len(v)):
        for r in range(3):
            v[i, r] = free[i, r] + weights[i, r] * answer[i, r]


@kernel
def _add_free(table: int, v: Matrix) -> None:
    """Set ``v`` to the velocities without contacts plus the last answer to the impulses."""
    free, answer = at.pile_vectors(table)[2], at.pile_vectors(table)[7]
    put(v, answer)
    for i in range(len(at.pile_bodies(table))):
        for r in range(3):
            v[i, r] += free[i, r]


@kernel
def _law(c: Records, n: int) -> None:
    """Impulses and modes at the rates in the rows."""
    for k in range(n):
        one = c[k]
        pn = one["n_shift"] - one["Rn"] * one["yn"]
        if pn <= 0.0:
            one["pn"] = one["pt"] = 0.0
            one["mode"] = OPEN
            continue
        most, pt = one["friction"] * pn, one["t_shift"] - one["Rt"] * one["yt"]
        one["mode"] = STICKS
        if pt > most:
            pt, one["mode"] = most, SLIDES_UP
        elif pt < -most:
            pt, one["mode"] = -most, SLIDES_DOWN
        one["pn"], one["pt"] = pn, pt


@kernel
def _law_as_before(c: Records, n: int) -> None:
    """Modes of the last step, and the impulses that these give at the rates in the rows."""
    for k in range(n):
        one = c[k]
        last, most = one["n_last"], one["friction"] * one["n_last"]
        one["mode"] = STICKS if last > 0.0 or one["yn"] < 0.0 else OPEN
        if last > 0.0 and most > 0.0 and abs(one["t_last"]) >= most * (1.0 - BOUNDARY):
            one["mode"] = SLIDES_UP if one["t_last"] > 0.0 else SLIDES_DOWN
        one["pn"] = one["pt"] = 0.0
        if one["mode"] != OPEN:
            one["pn"] = one["n_shift"] - one["Rn"] * one["yn"]
            one["pt"] = one["t_shift"] - one["Rt"] * one["yt"]
            if one["mode"] != STICKS:
                sign = 1.0 if one["mode"] == SLIDES_UP else -1.0
                one["pt"] = sign * one["friction"] * one["pn"]


@kernel
def _force(table: int, n: int, v: Matrix) -> float:
    """F at ``v`` into vector 4; the square of its norm in the metric of the inverse masses."""
    c, J, vectors = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)
    free, weights, F = vectors[2], vectors[3], vectors[4]
    bodies = len(at.pile_bodies(table))
    for i in range(bodies, len(F)):
        F[i, 0] = F[i, 1] = F[i, 2] = 0.0
    for i in range(bodies):
        for r in range(3):
            F[i, r] = (v[i, r] - free[i, r]) / weights[i, r]
    _add_impulses(c, J, n, -1.0, F)
    blocks, B = at.pile_blocks(table), at.pile_coefficients(table)
    for k in range(len(blocks) if at.pile_counts(table)[0] else 0):  # B^T times impulses of rows
        j, i = bodies + blocks[k, 0], blocks[k, 1]
        for r in range(3):
            F[i, r] += B[k, 0, r] * v[j, 0] + B[k, 1, r] * v[j, 1] + B[k, 2, r] * v[j, 2]
    s = 0.0
    for i in range(bodies):
        for r in range(3):
            s += weights[i, r] * F[i, r] * F[i, r]
    return s


@kernel
def _newton_step(table: int, n: int, first: bool) -> bool:
    """A step of Newton's method with backtracking, first with the last modes; whether it helps."""
    c, J, vectors = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)
    v, trial, F, x, change = vectors[0], vectors[1], vectors[4], vectors[5], vectors[6]
    place = at.pile_place(table)
    if first:
        _law_as_before(c, n)
    else:
        _law(c, n)
    before = _force(table, n, v)
    same = True
    for k in range(n):
        same &= c[k]["mode"] == c[k]["factored"] and c[k]["Rn"] == c[k]["R_factored"]
        c[k]["factored"], c[k]["R_factored"] = c[k]["mode"], c[k]["Rn"]
    if not same:
        _assemble(table, n)
        factor_blocks(table)
    for i in range(len(F)):
        for r in range(3):
            x[place[i], r] = -F[i, r]
    solve_blocks(table, x)
    for i in range(len(F)):
        for r in range(3):
            change[i, r] = x[place[i], r]
    _rates(c, J, n, change, False)
    largest, least = 0.0, 0.0
    for k in range(n):
        size = max(abs(c[k]["dyn"]), abs(c[k]["dyt"]))
        largest, least = max(largest, size), max(least, size / c[k]["tolerance"])
    if not largest < FASTEST:
        return False
    share = 1.0
    for _ in range(TRIALS):
        for i in range(len(v)):
            for r in range(3):
                trial[i, r] = v[i, r] + share * change[i, r]
        _rates(c, J, n, trial, True)
        _law(c, n)
        if (first or least <= 0.1
                or _force(table, n, trial) < (1.0 - 0.1 * share) ** 2 * before):
            put(v, trial)
            return True
        share *= 0.5
    return False


@kernel
def _assemble(table: int, n: int) -> None:
    """M + C^T P C with P the derivative of the law at the modes in the rows."""
    c, J, weights = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)[3]
    place, starts = at.pile_place(table), at.pile_starts(table)
    D, L, U = at.pile_diagonal(table), at.pile_lower(table), at.pile_upper(table)
    for i in range(len(at.pile_bodies(table))):
        X = D[place[i]]
        for r in range(3):
            for s in range(3):
                X[r, s] = 0.0
            X[r, r] = 1.0 / weights[i, r]
    for p in range(starts[len(starts) - 1]):
        for r in range(3):
            for s in range(3):
                L[p, r, s] = U[p, r, s] = 0.0
    add_rows(table)
    for k in range(n):
        one = c[k]
        if one["mode"] == OPEN:
            continue
        Rn, Rt, slides = one["Rn"], 0.0, 0.0
        if one["mode"] == STICKS:
            Rt = one["Rt"]
        else:
            slides = one["friction"] if one["mode"] == SLIDES_UP else -one["friction"]
        a, b, slot = one["a"], one["b"], one["slot"]
        if a >= 0:
            _add_block(D[place[a]], J[k], 0, 0, Rn, Rt, slides)
        if b >= 0:
            _add_block(D[place[b]], J[k], 1, 1, Rn, Rt, slides)
        if a >= 0 and b >= 0:
            later = place[a] > place[b]
            _add_block(L[slot] if later else U[slot], J[k], 0, 1, Rn, Rt, slides)
            _add_block(U[slot] if later else L[slot], J[k], 1, 0, Rn, Rt, slides)


@kernel
def _add_block(X: Matrix, J: Matrix, i: int, j: int, Rn: float, Rt: float, slides: float) -> None:
    """Add the block of a contact between its bodies ``i`` and ``j``, 0 or 1."""
    for r in range(3):
        g = (J[i, r] + slides * J[2 + i, r]) * Rn
        t = Rt * J[2 + i, r]
        for s in range(3):
            X[r, s] += g * J[j, s] + t * J[2 + j, s]


@kernel
def _sweep(table: int, n: int, v: Matrix, sweeps: int) -> float:
    """Projected Gauss-Seidel sweeps from n0, t0, which they change; the residual after them."""
    c, J, weights = at.piled(table), at.pile_jacobian(table), at.pile_vectors(table)[3]
    for k in range(n):
        c[k]["pn"], c[k]["pt"] = c[k]["n0"], c[k]["t0"]
    _momentum(table, n, v)
    for _ in range(sweeps):
        for k in range(n):
            one = c[k]
            a, b = one["a"], one["b"]
            for axis in range(2):
                i = 2 * axis
                y = one["bias_t"] if axis else one["bias_n"]
                for r in range(3):
                    if a >= 0:
                        y += J[k, i, r] * v[a, r]
                    if b >= 0:
                        y += J[k, i + 1, r] * v[b, r]
                if axis:
                    if one["pn"] == 0.0 and one["pt"] == 0.0:
                        break
                    most, last = one["friction"] * one["pn"], one["pt"]
                    p = last - (y + one["soft_t"] * last) / (one["base_t"] + one["soft_t"])
                    one["pt"] = p = min(max(p, -most), most)
                else:
                    last = one["pn"]
                    p = last - (y + one["soft_n"] * last) / (one["base_n"] + one["soft_n"])
                    one["pn"] = p = max(p, 0.0)
                if p != last:
                    for r in range(3):
                        if a >= 0:
                            v[a, r] += (p - last) * weights[a, r] * J[k, i, r]
                        if b >= 0:
                            v[b, r] += (p - last) * weights[b, r] * J[k, i + 1, r]
    for k in range(n):
        c[k]["n0"], c[k]["t0"] = c[k]["pn"], c[k]["pt"]
    _momentum(table, n, v)
    _rates(c, J, n, v, True)
    return _residual(c, n)
