"""Rows of springs with laws of their own: F = F(s, ds/dt), whatever its shape.

The step takes such a force linearised in the rate r at its end, F0 + l r, so its row is that of a
damper l with a force:

    D v + p / (h l) = F0 / l

What is taken of the law is decided step by step by its slope k = dF/ds at the pose and where the
step leads:

    soft, h^2 k s below 1    F(s, (r_before + r) / 2)    l = (dF/dr) / 2          (second order)
    stiff                    F(s + h r, r)               l = h k + dF/dr          (the step's end)

(:mod:`sandbox.engine.stiffness`). Once the step is solved the law is asked for its force with the
rate that came of it; where that is another, the step is solved again with the tangent there
(Newton). A falling law has no l of its own sign: its slope counts as 0.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.formulas import formula
from sandbox.engine.kernel import kernel
from sandbox.engine.records import SOFT
from sandbox.engine.rows import LEAST, NOTHING, spring_rate
from sandbox.engine.ties import action_holds, holds
from sandbox.numeric import Array

SAME = 1e-10
"""Two forces that differ by this share are one."""


@kernel
def law_at(table: int, s: Any, stretch: float, rate: float, drive: Array) -> Any:
    """Force of an element's law with its slopes by stretch and rate, [1 + slopes]."""
    read = at.read_names(table)
    for i in range(3):
        for j in range(read.shape[1]):
            read[i, j] = 0.0
    read[0, 0], read[0, 1] = stretch, 1.0
    read[1, 0], read[1, 2] = rate, 1.0
    read[2, 0] = s["k"] if s["drive"] < 0 else drive[s["drive"]]
    return formula(table, s["code"], s["code_end"], read)


@entry_point("laws")
def spring_law(table: int, i: int, stretch: float, drive: Array) -> float:
    """Force of a straight spring's law."""
    return float(law_at(table, at.springs(table)[i], stretch, 0.0, drive)[0])


@entry_point("laws")
def action_law(table: int, i: int, twist: float, drive: Array) -> float:
    """Torque of a rotary spring's law."""
    return float(law_at(table, at.actions(table)[i], twist, 0.0, drive)[0])


@kernel
def _at_pose(
    table: int, s: Any, out: Any, stretch: float, rate: float, h: float, drive: Array,
) -> tuple[float, float]:
    """The law's force for the rate before the step, and its slope l; how it is to be taken."""
    law = law_at(table, s, stretch, rate, drive)
    force, lead = law[0], 0.5 * max(law[2], 0.0)
    out["stiff"] = 1 if h * h * s["response"] * law[1] > SOFT else 0
    law = law_at(table, s, stretch + h * rate, rate, drive)
    if h * h * s["response"] * law[1] > SOFT:
        out["stiff"] = 1
    if out["stiff"] == 1:
        return law[0], h * max(law[1], 0.0) + max(law[2], 0.0)
    return force, lead


@kernel
def _tangent(
    table: int, s: Any, out: Any, stretch: float, before: float, rate: float, h: float,
    given: float, drive: Array,
) -> tuple[bool, float, float]:
    """Whether ``given`` is not the law's force for the rate at the step's end; that, its slope."""
    law = law_at(table, s, stretch + h * rate, rate, drive)
    slope = max(law[1], 0.0)
    if h * h * s["response"] * slope > SOFT:
        out["stiff"] = 1
    if out["stiff"] == 0:
        if not s["of_rate"]:
            return False, 0.0, 0.0
        law = law_at(table, s, stretch, 0.5 * (before + rate), drive)
        force, lead = law[0], 0.5 * max(law[2], 0.0)
    else:
        force, lead = law[0], h * slope + max(law[2], 0.0)
    off = abs(force - given) > SAME * (abs(force) + abs(given)) + NOTHING * slope
    return bool(off), force, lead


@kernel
def _ask(
    table: int, s: Any, sense: float, force: float, lead: float, rate: float, h: float,
) -> None:
    """Let the row ask for a force that is ``force`` at a rate, and ``lead`` more for each more."""
    rhs, compliance = at.unknowns(table)[0], at.unknowns(table)[1]
    lead = max(lead, LEAST)
    rhs[s["row"]] = sense * (force - lead * rate) / lead
    compliance[s["row"]] = 1.0 / (h * lead)


@entry_point("laws")
def law_rows(table: int, h: float, drive: Array) -> None:
    """Those of all springs with laws, at the rates before the step."""
    before, body, J = at.before(table), at.body(table), at.entries(table)[0]
    springs, results = at.springs(table), at.spring_results(table)
    states = at.spring_states(table)
    for i in range(len(springs)):
        s, out = springs[i], results[i]
        if s["code"] < 0 or s["row"] < 0:
            continue
        e = s["entry"]
        J[e, 0], J[e, 1], J[e, 2] = out["ux"], out["uy"], out["ta"]
        J[e + 1, 0], J[e + 1, 1], J[e + 1, 2] = -out["ux"], -out["uy"], -out["tb"]
        rate = spring_rate(s, out, before)
        force, lead = _at_pose(table, s, out, out["length"] - states[i]["rest"], rate, h, drive)
        _ask(table, s, 1.0, force, lead, rate, h)
    actions, action_results = at.actions(table), at.action_results(table)
    for i in range(len(actions)):
        s, out = actions[i], action_results[i]
        if s["code"] < 0 or s["row"] < 0:
            continue
        e, a, b = s["entry"], s["a"], s["b"]
        J[e, 0], J[e, 1], J[e, 2] = 0.0, 0.0, -1.0
        J[e + 1, 0], J[e + 1, 1], J[e + 1, 2] = 0.0, 0.0, 1.0
        rate = s["sense"] * (before[b, 2] - before[a, 2])
        twist = s["sense"] * (body[b, 2] - body[a, 2] - s["rest"])
        force, lead = _at_pose(table, s, out, twist, rate, h, drive)
        _ask(table, s, -s["sense"], force, lead, rate, h)


@entry_point("laws")
def change_laws(table: int, h: float, drive: Array) -> bool:
    """Take the tangents of laws where the step has led; whether any force was another."""
    before, body, velocity = at.before(table), at.body(table), at.velocity(table)
    given, changed = at.unknowns(table)[3], False
    springs, results = at.springs(table), at.spring_results(table)
    states = at.spring_states(table)
    for i in range(len(springs)):
        s, out = springs[i], results[i]
        if s["code"] < 0 or s["row"] < 0 or not holds(table, s["tie"]):
            continue
        rate = spring_rate(s, out, velocity)
        off, force, lead = _tangent(
            table, s, out, out["length"] - states[i]["rest"], spring_rate(s, out, before),
            rate, h, given[s["row"]] / h, drive)
        if off:
            _ask(table, s, 1.0, force, lead, rate, h)
            changed = True
    actions, action_results = at.actions(table), at.action_results(table)
    for i in range(len(actions)):
        s, out = actions[i], action_results[i]
        if s["code"] < 0 or s["row"] < 0 or not action_holds(table, s):
            continue
        a, b, sense = s["a"], s["b"], s["sense"]
        rate = sense * (velocity[b, 2] - velocity[a, 2])
        off, force, lead = _tangent(
            table, s, out, sense * (body[b, 2] - body[a, 2] - s["rest"]),
            sense * (before[b, 2] - before[a, 2]), rate, h, -sense * given[s["row"]] / h, drive)
        if off:
            _ask(table, s, -sense, force, lead, rate, h)
            changed = True
    return changed
