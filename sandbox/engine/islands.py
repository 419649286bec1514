"""Compliant contacts: piles of many bodies, and soft skin.

Two free bodies are in one island if they are near enough to touch, or if a joint, a spring or a
tendon acts on both. An island is a pile if its contacts have neither restitution nor static
friction above sliding friction, and if all such islands together have more than :data:`MANY` rows,
or that many that carry a force if there are joints. Some elements keep their bodies out:
:func:`sandbox.engine.pile_rows.pile_tables`.
:mod:`sandbox.engine.piles` solves piles; their contacts are compliant, with a stiffness k and a
damping c that follow from the masses and the step. At the end of a step

    f = k d + c d',    d the depth, h^2 k G = STIFFNESS,   c = 2 DAMPING sqrt(k / G)

with G the response of the contact to a unit impulse. Tangentially a sticking contact has the
stiffness TANGENTIAL k; a sliding one obeys Coulomb's law. Depths are a few g h^2 / STIFFNESS for
each body that lies above.

Bodies without joints that carry each other sleep after they have been still for
:data:`SLEEP_STEPS` steps: their velocities are 0 and their impulses stay. A body that presses on
one, a change of the forces on it, a moving support or a running surface wakes them all.

Soft skin: contacts of materials that give way, with a stiffness and a damping.

With d the depth of a contact, k the stiffness and c the damping, the normal force is k d + c d' and
never pulls. Along the surface a spring of TANGENTIAL k with a damper in the same ratio holds a
contact that sticks; its stretch is kept from step to step and follows the force where it slides.

A row y + want + s p = 0 has one of two rules, y_0 its rate before the step, e and s per row:

- even, for h^2 k G <= 1: f = k d - h k / 4 (y - y_0) - c (y + y_0) / 2. Second order; keeps energy.
- end: f = k (d - h y) - c y. First order, stable for any k.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.blocks import connect, find_slot, minimum_degree
from sandbox.engine.bonds import holds, joint_holds
from sandbox.engine.bounded import rate
from sandbox.engine.bounded_rows import RETURN, limit_row, normal_row, piled, tangent_row
from sandbox.engine.entry_points import entry_point
from sandbox.engine.joint_friction import friction_rows, report_friction
from sandbox.engine.kernel import kernel
from sandbox.engine.motors import motor_row
from sandbox.engine.pile_rows import set_blocks
from sandbox.engine.report import add_limit
from sandbox.engine.state import DRIVEN, IN_PILE, JOINT_FRICTION, LIMITED, NORMAL, TANGENT

MANY, FEW = 60, 30
"""Islands become piles with more rows than the first, and remain piles with more than the second.
Of islands with joints only the rows that carry count."""
STIFFNESS, DAMPING, TANGENTIAL = 40.0, 0.3, 2.0 / 3.0
"""Of contacts in piles: h^2 k G, the damping ratio, tangential over normal stiffness (Mindlin, of
an incompressible material)."""
SLEEP_STEPS, SLOW, SLOW_TURNING = 22, 1e-10, 1e-8  # steps until it sleeps; speeds [m/s, rad/s]
ABSOLUTE, RELATIVE = 1e-11, 1e-10  # tolerances [m/s]; as a share of the largest free rate


@kernel
def _root(table: int, i: int) -> int:
    bodies = at.pile_bodies(table)
    while bodies[i]["island"] != i:
        bodies[i]["island"] = bodies[bodies[i]["island"]]["island"]
        i = bodies[i]["island"]
    return i


@kernel
def _join_islands(table: int, carry: bool) -> None:
    """Join bodies that rows connect and those near enough to touch, or whose contacts ``carry``."""
    touches, loose, bodies = at.touches(table), at.loose(table), at.pile_bodies(table)
    for i in range(len(bodies)):
        one = bodies[i]
        one["island"], one["rows"], one["awake"], one["carried"] = i, 0, 0, 0
        one["linked"] = 1 if one["cluster"] >= 0 else 0
        if one["linked"]:
            one["island"] = one["cluster"]
    for i in range(at.touching(table)[0]):
        a, b = loose[touches[i]["a"]], loose[touches[i]["b"]]
        if a >= 0 and b >= 0 and (touches[i]["normal"] > 0.0 or not carry):
            a, b = _root(table, a), _root(table, b)
            bodies[max(a, b)]["island"] = min(a, b)
            bodies[min(a, b)]["linked"] |= bodies[max(a, b)]["linked"]


@entry_point("piles")
def list_piles(table: int) -> None:
    """Find the islands, and mark the contacts of piles, which no other row is made for."""
    touches, loose, bodies = at.touches(table), at.loose(table), at.pile_bodies(table)
    _join_islands(table, False)
    _choose_piles(table)
    _join_islands(table, True)
    _wake(table)
    for i in range(at.touching(table)[0]):
        t = touches[i]
        q = max(loose[t["a"]], loose[t["b"]])
        if q >= 0 and bodies[q]["piled"]:
            if t["listed"] != IN_PILE and t["normal"] > 0.0 and t["soft"] == 0.0:
                t["stretch"] = math.nan  # it follows from the impulse
            t["listed"] = IN_PILE
        elif t["listed"] == IN_PILE:
            t["listed"] = 1 if t["normal"] > 0.0 else 0


@kernel
def _choose_piles(table: int) -> None:
    """Decide which islands of bodies that are near each other are piles."""
    touches, loose, bodies = at.touches(table), at.loose(table), at.pile_bodies(table)
    inverse_mass = at.inverse_mass(table)
    for i in range(at.touching(table)[0]):
        t = touches[i]
        a, b = loose[t["a"]], loose[t["b"]]
        if a < 0 and b < 0:
            continue
        root = bodies[_root(table, max(a, b))]
        count = 2 if t["friction"] > 0.0 else 1
        root["rows"] += count
        root["carried"] += count if t["normal"] > 0.0 else 0
        other = t["b"] if a >= 0 else t["a"]
        if (t["restitution"] > 0.0 or t["static"] > 1.0
                or (min(a, b) < 0 and inverse_mass[other, 0] > 0.0)):
            root["rows"] = -(1 << 40)  # no pile
    rows = carried = before_single = before_linked = 0
    for i in range(len(bodies)):
        if bodies[_root(table, i)]["linked"]:
            before_linked += bodies[i]["piled"]
            carried += bodies[i]["carried"] if bodies[i]["rows"] > 0 else 0
        else:
            before_single += bodies[i]["piled"]
            rows += max(bodies[i]["rows"], 0)
    many = rows > (FEW if before_single > 0 else MANY)
    many_linked = carried > (FEW if before_linked > 0 else MANY)
    at.pile_counts(table)[0] = 0
    for i in range(len(bodies)):
        root = bodies[_root(table, i)]
        bodies[i]["piled"] = (
            1 if root["rows"] > 0 and (many_linked if root["linked"] else many) else 0)
        if root["linked"]:
            at.pile_counts(table)[0] |= bodies[i]["piled"]


@kernel
def _wake(table: int) -> None:
    """Decide which islands of bodies that carry each other are awake."""
    touches, loose, bodies = at.touches(table), at.loose(table), at.pile_bodies(table)
    free, before = at.free(table), at.before(table)
    for i in range(at.touching(table)[0]):
        t = touches[i]
        a, b = loose[t["a"]], loose[t["b"]]
        other = t["b"] if a >= 0 else t["a"]
        if t["belt"] != 0.0 or (min(a, b) < 0 and (
                free[other, 0] != 0.0 or free[other, 1] != 0.0 or free[other, 2] != 0.0)):
            for q in (a, b):
                if q >= 0:
                    bodies[_root(table, q)]["awake"] = 1
    for i in range(len(bodies)):
        body, b = bodies[i], bodies[i]["number"]
        vx, vy, w = free[b, 0] - before[b, 0], free[b, 1] - before[b, 1], free[b, 2] - before[b, 2]
        if body["still"] >= SLEEP_STEPS and (vx != body["x"] or vy != body["y"] or w != body["t"]):
            body["still"] = 0  # the force on it has changed
        body["x"], body["y"], body["t"] = vx, vy, w
        if body["still"] < SLEEP_STEPS or body["linked"]:
            bodies[_root(table, i)]["awake"] = 1
    for i in range(len(bodies)):
        bodies[i]["awake"] = bodies[_root(table, i)]["awake"]
        if bodies[i]["awake"]:
            bodies[i]["still"] = min(bodies[i]["still"], SLEEP_STEPS - 1)


@kernel
def wake_touched(table: int, n: int) -> bool:
    """Wake islands that others press on; whether there are any."""
    c, touches, bodies, found = at.piled(table), at.touches(table), at.pile_bodies(table), False
    for k in range(n):
        if c[k]["source"] == NORMAL and c[k]["pn"] > 0.0:
            t = touches[c[k]["index"]]
            for q in (at.loose(table)[t["a"]], at.loose(table)[t["b"]]):
                if q >= 0 and not bodies[q]["awake"]:
                    found, root = True, _root(table, q)
                    for i in range(len(bodies)):
                        if _root(table, i) == root:
                            bodies[i]["awake"], bodies[i]["still"] = 1, 0
    return found


@kernel
def gather_piles(table: int, h: float) -> int:
    """List the contacts and limits of piles that are awake; how many there are."""
    touches, loose, bodies = at.touches(table), at.loose(table), at.pile_bodies(table)
    c, limits, free = at.piled(table), at.limits(table), len(at.rows(table)) - 1
    motors, frictions = at.motors(table), at.dry_friction(table)
    for i in range(len(bodies)):
        bodies[i]["fastest"] = 0.0
    begin_piles(table)
    set_blocks(table)
    n = 0
    for i in range(at.touching(table)[0]):
        a, b = loose[touches[i]["a"]], loose[touches[i]["b"]]
        if touches[i]["listed"] == IN_PILE and (
                (a >= 0 and bodies[a]["awake"]) or (b >= 0 and bodies[b]["awake"])):
            _gather(table, h, i, n)
            root = bodies[_root(table, max(c[n]["a"], c[n]["b"]))]
            root["fastest"] = max(root["fastest"], c[n]["tolerance"])
            n += 1
    for k in range(n):
        root = bodies[_root(table, max(c[k]["a"], c[k]["b"]))]
        c[k]["tolerance"] = ABSOLUTE + RELATIVE * root["fastest"]
    if at.pile_counts(table)[0]:
        for i in range(len(motors)):
            if piled(table, motors[i]["joint"]) and holds(table, motors[i]["bond"]):
                motor_row(table, h, at.last_drive(table), i, free)
                n = _gather_row(table, n)
        for i in range(len(frictions)):
            joint = frictions[i]["joint"]
            if piled(table, joint) and joint_holds(table, joint):
                friction_rows(table, h, i, free)
                n = _gather_row(table, n)
        for i in range(len(limits)):
            joint = limits[i]["joint"]
            if limits[i]["impulse"] > 0.0 and piled(table, joint) and joint_holds(table, joint):
                limit_row(table, h, i, at.rows(table)[free])
                n = _gather_row(table, n)
    _find_order(table, n)
    return n


@kernel
def begin_piles(table: int) -> None:
    """Take the velocities without contacts and limits of piles."""
    bodies, vectors = at.pile_bodies(table), at.pile_vectors(table)
    inverse_mass = at.inverse_mass(table)
    for i in range(len(bodies)):
        b = bodies[i]["number"]
        for r in range(3):
            vectors[2, i, r] = at.velocity(table)[b, r] if bodies[i]["awake"] else 0.0
            vectors[3, i, r] = inverse_mass[b, 0] if r < 2 else inverse_mass[b, 1]


@kernel
def broken_limits(table: int, h: float, n: int) -> int:
    """Add limits of piles that the velocities break to the ``n`` rows; how many there are then."""
    limits, c, row = at.limits(table), at.piled(table), at.rows(table)[len(at.rows(table)) - 1]
    first = n
    for i in range(len(limits)):
        joint = limits[i]["joint"]
        if not (piled(table, joint) and joint_holds(table, joint)):
            continue
        limit_row(table, h, i, row)
        new = rate(row, at.velocity(table)) + row["bias"] < -ABSOLUTE
        for k in range(first - 1, -1, -1):
            if not new or c[k]["source"] != LIMITED:
                break
            new = c[k]["index"] != i
        if new:
            n = _gather_row(table, n)
    if n > first:
        _find_order(table, n)
    return n


@kernel
def _find_order(table: int, n: int) -> None:
    """Find the blocks of all contacts and limits, in a new order if they do not fit the last."""
    if n == 0 or _find_slots(table, n):
        return
    c, adjacent, blocks = at.piled(table), at.pile_adjacent(table), at.pile_blocks(table)
    place, count, slots = at.pile_place(table), len(at.pile_bodies(table)), at.pile_slots(table)
    for i in range(len(adjacent)):
        for q in range(adjacent.shape[1]):
            adjacent[i, q] = 0
    for k in range(n):
        if c[k]["a"] >= 0 and c[k]["b"] >= 0:
            connect(adjacent, c[k]["a"], c[k]["b"])
    for k in range(len(blocks)):
        connect(adjacent, count + blocks[k, 0], blocks[k, 1])
    starts, below = at.pile_starts(table), at.pile_below(table)
    minimum_degree(adjacent, count, blocks, place, starts, below, at.pile_work(table))
    for k in range(len(blocks)):
        slots[k] = find_slot(starts, below, place[blocks[k, 1]], place[count + blocks[k, 0]])
    _find_slots(table, n)


@kernel
def _gather_row(table: int, k: int) -> int:
    """Make the last of the bounded rows the ``k``-th to solve; the number of rows then.

    A limit is a contact without friction. Motors and friction are the tangential part of a contact
    whose normal impulse is 1 and acts on nothing, with their bound as coefficient of friction.
    """
    row = at.rows(table)[len(at.rows(table)) - 1]
    one, J, velocity = at.piled(table)[k], at.pile_jacobian(table)[k], at.velocity(table)
    a, b, limit = row["a"], row["b"], row["source"] == LIMITED
    one["source"], one["index"], one["factored"] = row["source"], row["index"], -1
    one["a"], one["b"] = at.loose(table)[a], at.loose(table)[b]
    want = row["bias"]
    if one["a"] < 0:
        want += row["ax"] * velocity[a, 0] + row["ay"] * velocity[a, 1] + row["at"] * velocity[a, 2]
    if one["b"] < 0:
        want += row["bx"] * velocity[b, 0] + row["by"] * velocity[b, 1] + row["bt"] * velocity[b, 2]
    part = 0 if limit else 2
    for r in range(3):
        J[0, r] = J[1, r] = J[2, r] = J[3, r] = 0.0
    J[part, 0], J[part, 1], J[part, 2] = row["ax"], row["ay"], row["at"]
    J[part + 1, 0], J[part + 1, 1], J[part + 1, 2] = row["bx"], row["by"], row["bt"]
    one["soft_n"] = one["bias_n"] = one["along"] = one["bend"] = 0.0
    one["tolerance"] = ABSOLUTE + RELATIVE * abs(rate(row, velocity))
    base = response(table, row)
    if limit:
        one["n_last"], one["base_n"], one["bias_n"] = row["last"], base, want
        one["friction"] = one["t_last"] = one["soft_t"] = one["bias_t"] = 0.0
        one["base_t"] = 1.0
    else:
        one["n_last"] = one["base_n"] = 1.0
        one["friction"], one["t_last"], one["base_t"] = row["high"], row["last"], base
        one["soft_t"], one["bias_t"] = row["soft"], want
    return k + 1


@kernel
def _gather(table: int, h: float, i: int, k: int) -> None:
    t, one, J = at.touches(table)[i], at.piled(table)[k], at.pile_jacobian(table)[k]
    loose, rows, free = at.loose(table), at.rows(table), at.velocity(table)
    normal, tangent = rows[len(rows) - 1], rows[len(rows) - 2]
    normal_row(h, at.touches(table), i, normal)
    tangent_row(h, at.body(table), at.touches(table), i, 0, tangent)
    one["factored"] = -1
    one["source"], one["index"] = NORMAL, i
    one["a"], one["b"] = loose[t["a"]], loose[t["b"]]
    one["friction"], one["n_last"], one["t_last"] = t["friction"], t["normal"], t["tangent"]
    J[0, 0], J[0, 1], J[0, 2] = normal["ax"], normal["ay"], normal["at"]
    J[1, 0], J[1, 1], J[1, 2] = normal["bx"], normal["by"], normal["bt"]
    J[2, 0], J[2, 1], J[2, 2] = tangent["ax"], tangent["ay"], tangent["at"]
    J[3, 0], J[3, 1], J[3, 2] = tangent["bx"], tangent["by"], tangent["bt"]
    one["base_n"], one["base_t"] = response(table, normal), response(table, tangent)
    _pile_compliance(table, h, t, one)
    one["bend"] = tangent["bias"] - t["bias_along"]
    if k > 0:  # points of one face slide at one rate
        last = at.touches(table)[at.piled(table)[k - 1]["index"]]
        if last["shape_a"] == t["shape_a"] and last["shape_b"] == t["shape_b"]:
            one["bend"] = at.piled(table)[k - 1]["bend"]
    one["bias_t"] = one["bend"] + one["along"]
    for body, key in ((t["a"], one["a"]), (t["b"], one["b"])):
        if key < 0:  # it may be scheduled
            side = 0 if body == t["a"] else 1
            for r in range(3):
                one["bias_n"] += J[side, r] * free[body, r]
                one["bias_t"] += J[2 + side, r] * free[body, r]
    one["tolerance"] = max(abs(rate(normal, free)), abs(rate(tangent, free) + t["belt"]))
    if one["a"] >= 0 and not at.pile_bodies(table)[one["a"]]["awake"]:
        one["a"] = -1
    if one["b"] >= 0 and not at.pile_bodies(table)[one["b"]]["awake"]:
        one["b"] = -1


@kernel
def _pile_compliance(table: int, h: float, t: Any, one: Any) -> None:
    """Give a contact its compliance: that of its skin, or the one of rigid surfaces in piles."""
    if t["soft"] > 0.0:
        one["bias_n"], one["soft_n"] = t["bias"], t["soft"]
        one["along"], one["soft_t"] = t["bias_along"], t["soft_along"]
        one["stiffness"] = TANGENTIAL * at.skin(table)[0, t["a"], t["b"]]
        return
    k = STIFFNESS / (h * h * one["base_n"])
    c = 2.0 * DAMPING * math.sqrt(k / one["base_n"])
    gap = t["gap"] + 0.5 * h * h * t["acceleration"]
    one["soft_n"] = 1.0 / (h * (h * k + c))
    one["bias_n"] = gap / h
    if gap <= 0.0:  # an overlap that no load holds is undone slowly
        one["bias_n"] = max(k * gap / (h * k + c), -RETURN - one["soft_n"] * t["normal"])
    one["stiffness"], one["soft_t"] = TANGENTIAL * k, one["soft_n"] / TANGENTIAL
    if t["stretch"] != t["stretch"]:
        t["stretch"] = -t["tangent"] / (h * one["stiffness"])
    one["along"] = k * t["stretch"] / (h * k + c)


@kernel
def response(table: int, row: Any) -> float:
    """The rate of a row for an impulse of 1."""
    w, a, b = at.inverse_mass(table), row["a"], row["b"]
    return float(w[a, 0] * (row["ax"] ** 2 + row["ay"] ** 2) + w[a, 1] * row["at"] ** 2
                 + w[b, 0] * (row["bx"] ** 2 + row["by"] ** 2) + w[b, 1] * row["bt"] ** 2)


@kernel
def _find_slots(table: int, n: int) -> bool:
    """Find the blocks of all contacts in the pattern; False if one is not there."""
    c, place = at.piled(table), at.pile_place(table)
    starts, below = at.pile_starts(table), at.pile_below(table)
    if place[0] < 0:
        return False
    for k in range(n):
        a, b = c[k]["a"], c[k]["b"]
        if a >= 0 and b >= 0:
            i, j = place[a], place[b]
            c[k]["slot"] = find_slot(starts, below, min(i, j), max(i, j))
            if c[k]["slot"] < 0:
                return False
    return True


@kernel
def finish_piles(table: int, h: float, n: int) -> None:
    """Note impulses, and which bodies are still."""
    touches, bodies, c = at.touches(table), at.pile_bodies(table), at.piled(table)
    rows, v = at.rows(table), at.pile_vectors(table)[0]
    for i in range(len(bodies)):
        body = bodies[i]
        if not body["piled"]:
            body["still"] = 0
            continue
        x, y, t = v[i, 0], v[i, 1], v[i, 2]
        if body["awake"]:
            slow = abs(x) < SLOW and abs(y) < SLOW and abs(t) < SLOW_TURNING
            body["still"] = body["still"] + 1 if slow else 0
    for k in range(n):
        one, i = c[k], c[k]["index"]
        limit, p = one["friction"] * one["pn"], one["pt"]
        slides = 0 if abs(p) < limit * (1.0 - 1e-12) else 1 if p > 0.0 else -1
        if one["source"] == LIMITED:
            at.limits(table)[i]["impulse"] = max(one["pn"], 0.0)
            limit_row(table, h, i, rows[len(rows) - 1])
            rows[len(rows) - 1]["p"] = one["pn"]
            add_limit(table, h, len(rows) - 1)
        elif one["source"] == DRIVEN:
            motor = at.motors(table)[i]
            motor["impulse"], motor["mode"], motor["target"] = p, slides, motor["aim"]
        elif one["source"] == JOINT_FRICTION:
            report_friction(table, h, i, p, slides, math.nan)
        if one["source"] != NORMAL:
            continue
        touch = touches[i]
        touch["normal"], touch["tangent"] = one["pn"], p
        touch["mode"] = slides if one["pn"] > 0.0 else 0
        if one["pn"] <= 0.0:
            touch["stretch"] = 0.0
        elif slides:
            touch["stretch"] = -p / (h * one["stiffness"])
        else:
            touch["stretch"] += h * (one["yt"] - one["along"])


@kernel
def spring_row(
    h: float, k: float, c: float, way: float, before: float, response: float,
) -> tuple[float, float]:
    """``want`` and ``soft`` of a spring and damper, f = - k way - c y."""
    if h * h * k * response <= 1.0:
        e = h * k / 4.0 + c / 2.0
        return (k * way - (h * k / 4.0 - c / 2.0) * before) / e, 1.0 / (h * e)
    e = h * k + c
    return k * way / e, 1.0 / (h * e)


@entry_point("skin")
def skin_compliance(table: int, h: float) -> None:
    """Give the contacts of soft skin the terms of their rows."""
    touches, skin, before = at.touches(table), at.skin(table), at.before(table)
    rows = at.rows(table)
    normal, tangent = rows[len(rows) - 1], rows[len(rows) - 2]
    for i in range(at.touching(table)[0] if skin.shape[1] else 0):
        t = touches[i]
        k, c = skin[0, t["a"], t["b"]], skin[1, t["a"], t["b"]]
        if k == 0.0:
            continue
        normal_row(h, touches, i, normal)
        tangent_row(h, at.body(table), touches, i, 0, tangent)
        gap = t["gap"] + 0.5 * h * h * t["acceleration"]
        if gap > 0.0:
            t["bias"], t["soft"] = gap / h, 1.0 / (h * (h * k + c))
        else:
            t["bias"], t["soft"] = spring_row(
                h, k, c, gap, rate(normal, before), response(table, normal))
        sliding = rate(tangent, before) + tangent["bias"]
        t["bias_along"], t["soft_along"] = spring_row(
            h, TANGENTIAL * k, TANGENTIAL * c, t["stretch"], sliding, response(table, tangent))


@entry_point("skin")
def stretch_skin(table: int, h: float, n: int) -> None:
    """Note how far the springs along soft contacts are stretched after the step."""
    rows, touches, skin = at.rows(table), at.touches(table), at.skin(table)
    if skin.shape[1] == 0:
        return
    for i in range(at.touching(table)[0]):
        if touches[i]["listed"] != IN_PILE and touches[i]["normal"] == 0.0:
            touches[i]["stretch"] = 0.0
    for k in range(n):
        row = rows[k]
        if row["source"] == TANGENT and row["soft"] > 0.0:
            t = touches[row["index"]]
            if t["normal"] > 0.0 and row["mode"] != 0:  # it follows the force of a sliding contact
                stiffness = TANGENTIAL * skin[0, t["a"], t["b"]]
                t["stretch"] = -row["p"] / (h * stiffness)
            elif t["normal"] > 0.0:
                t["stretch"] += h * (rate(row, at.velocity(table)) + row["bias"] - t["bias_along"])
