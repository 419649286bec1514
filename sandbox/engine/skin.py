"""Soft skin: contacts of materials that give way, with a stiffness and a damping.

With d the depth of a contact, k the stiffness and c the damping, the normal force is k d + c d' and
never pulls. Along the surface a spring of TANGENTIAL k with a damper in the same ratio holds a
contact that sticks; its stretch is kept from step to step and follows the force where it slides.

A row y + want + s p = 0 has one of two rules, y_0 its rate before the step, e and s per row:

- even, for h^2 k G <= 1: f = k d - h k / 4 (y - y_0) - c (y + y_0) / 2. Second order; keeps energy.
- end: f = k (d - h y) - c y. First order, stable for any k.
"""

from __future__ import annotations

from sandbox.engine import memory as at
from sandbox.engine.bounded import rate
from sandbox.engine.candidates import normal_row, tangent_row
from sandbox.engine.entry_points import entry_point
from sandbox.engine.islands import PILED, TANGENTIAL, response
from sandbox.engine.kernel import kernel
from sandbox.engine.state import TANGENT


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
def soften(table: int, h: float) -> None:
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
            t["want"], t["soft"] = gap / h, 1.0 / (h * (h * k + c))
        else:
            t["want"], t["soft"] = spring_row(
                h, k, c, gap, rate(normal, before), response(table, normal))
        sliding = rate(tangent, before) + tangent["want"]
        t["want_along"], t["soft_along"] = spring_row(
            h, TANGENTIAL * k, TANGENTIAL * c, t["stretch"], sliding, response(table, tangent))


@entry_point("skin")
def stretch_skin(table: int, h: float, n: int) -> None:
    """Note how far the springs along soft contacts are stretched after the step."""
    rows, touches, skin = at.rows(table), at.touches(table), at.skin(table)
    if skin.shape[1] == 0:
        return
    for i in range(at.touching(table)[0]):
        if touches[i]["listed"] != PILED and touches[i]["normal"] == 0.0:
            touches[i]["stretch"] = 0.0
    for k in range(n):
        row = rows[k]
        if row["source"] == TANGENT and row["soft"] > 0.0:
            t = touches[row["index"]]
            if t["normal"] > 0.0 and row["mode"] != 0:  # it follows the force of a sliding contact
                stiffness = TANGENTIAL * skin[0, t["a"], t["b"]]
                t["stretch"] = -row["p"] / (h * stiffness)
            elif t["normal"] > 0.0:
                t["stretch"] += h * (rate(row, at.velocity(table)) + row["want"] - t["want_along"])
