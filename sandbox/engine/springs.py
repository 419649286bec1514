"""Springs and dampers: straight ones, rotary ones, and the damping of hinges.

A spring acts along a coordinate q (:mod:`sandbox.engine.coordinates`). Its effort is -F, with F its
force for the stretch s = q - q_rest and the rate r = q'. At the pose x, with the velocities before
the step, it is taken in one of these ways:

    elastic     F = k s at the pose, a known force                                    (explicit)
    damped      D v + 2 p / (h c)       = - 2 k s / c - D v_before                    (mid-step)
    even        D v + p / (h b)         = - (k s + (c - b) D v_before) / b            (mid-step)
    stiff       D v + p / (h (c + h k)) = - k s / (c + h k)                           (step's end)

D v is the rate at the step's end, p / h the effort, and b = c / 2 + h k / 4. The damping of a hinge
has k = 0.

A law F(s, r) of any shape is linearised in the rate at the step's end, F0 + l r, so that its row is
that of a damper l with a force. The slope k = dF/ds decides in each step:

    soft, h^2 k S below 1    F(s, m)                         l = (dF/dr) / 2
    even, below 4            F(s + h (r - r_before) / 4, m)  l = h k / 4 + (dF/dr) / 2
    stiff                    F(s + h r, r)                   l = h k + dF/dr

with m = (r_before + r) / 2 and S the response of the bodies (:mod:`sandbox.engine.stiffness`).
After the solve the law gives the force for the rate that resulted. Where that force differs, the
step is solved again with the tangent there (Newton's method). Negative slopes count as 0 in l.
"""

from __future__ import annotations

from typing import Any

from sandbox.engine import memory as at
from sandbox.engine.bonds import acts, spring_holds
from sandbox.engine.coordinates import add_effort, measure_angle, measure_distance, put_row, rate
from sandbox.engine.entry_points import entry_point
from sandbox.engine.formulas import formula
from sandbox.engine.kernel import kernel
from sandbox.engine.records import DAMPED, EVEN, RESOLVED, SOFT
from sandbox.engine.rows import MIN_LEAD, NOTHING
from sandbox.numeric import Array, Matrix

SAME = 1e-10  # relative difference of two forces that count as equal


@entry_point("springs")
def stretch(table: int, drive: Array) -> None:
    """Measure all springs; add the forces of those that have no row."""
    springs = at.springs(table)
    for i in range(len(springs)):
        s = springs[i]
        if s["turning"]:
            measure_angle(s, at.body(table))
        else:
            measure_distance(s, at.body(table), at.turn(table))
        if s["row"] >= 0:
            continue
        if not spring_holds(table, s):
            s["effort"] = 0.0
            continue
        extent = s["way"] - s["rest"]
        s["effort"] = -(s["k"] if s["drive"] < 0 else drive[s["drive"]]) * extent
        if s["code"] >= 0:  # between two bodies that do not move freely
            s["effort"] = -s["sense"] * spring_law(table, i, s["sense"] * extent, drive)
        add_effort(s, s["effort"], at.force(table))


@entry_point("springs")
def spring_rows(table: int, h: float, drive: Array) -> None:
    """Rows of springs that have a damper, a law, or are too stiff for the step."""
    springs = at.springs(table)
    J, rhs, compliance = at.entries(table)[0], at.unknowns(table)[0], at.unknowns(table)[1]
    for i in range(len(springs)):
        s, r = springs[i], springs[i]["row"]
        if r < 0:
            continue
        put_row(J, s["entry"], s)
        if s["code"] >= 0:
            continue
        k = s["k"] if s["drive"] < 0 else drive[s["drive"]]
        extent = s["way"] - s["rest"]
        if s["kind"] == DAMPED:
            compliance[r] = 2.0 / (h * s["c"])
            rhs[r] = 0.0 - 2.0 * k * extent / s["c"] - rate(s, at.before(table))
        elif s["kind"] == EVEN:
            lead = max(s["c"] / 2 + h * k / 4, MIN_LEAD)
            compliance[r] = 1.0 / (h * lead)
            rhs[r] = -(k * extent + (s["c"] - lead) * rate(s, at.before(table))) / lead
        else:
            lead = max(s["c"] + h * k, MIN_LEAD)
            compliance[r] = 1.0 / (h * lead)
            rhs[r] = -(k * extent / lead)


@kernel
def _law(table: int, s: Any, extent: float, speed: float, drive: Array) -> None:
    read = at.read_names(table)
    read[:3] = 0.0
    read[0, 0], read[0, 1] = extent, 1.0
    read[1, 0], read[1, 2] = speed, 1.0
    read[2, 0] = s["k"] if s["drive"] < 0 else drive[s["drive"]]
    formula(table, s["code"], s["code_end"], read)


@entry_point("laws")
def spring_law(table: int, i: int, extent: float, drive: Array) -> float:
    """Force of a spring's law at rest."""
    _law(table, at.springs(table)[i], extent, 0.0, drive)
    return float(at.stack(table)[0, 0])


@kernel
def law_rate(s: Any, velocity: Array) -> float:
    """Rate of a spring's coordinate; its terms are summed in the order of laws and work."""
    a, b = s["a"], s["b"]
    return float(s["dx"] * (velocity[b, 0] - velocity[a, 0])
                 + s["dy"] * (velocity[b, 1] - velocity[a, 1])
                 + s["tb"] * velocity[b, 2] + s["ta"] * velocity[a, 2])


@kernel
def _set_row(table: int, s: Any, force: float, lead: float, speed: float, h: float) -> None:
    """Set the row of a law whose force is ``force`` at the rate ``speed``, with slope ``lead``."""
    lead = max(lead, MIN_LEAD)
    at.unknowns(table)[0][s["row"]] = -s["sense"] * (force - lead * speed) / lead
    at.unknowns(table)[1][s["row"]] = 1.0 / (h * lead)


@kernel
def _level(h: float, s: Any, slope: float) -> int:
    """0 soft, 1 even about the pose, 2 at the step's end."""
    squared = h * h * s["response"] * slope
    return 2 if squared > RESOLVED else 1 if squared > SOFT else 0


@entry_point("laws")
def law_rows(table: int, h: float, drive: Array) -> None:
    """Rows of all springs with laws, for the rates before the step; decides how laws are taken."""
    springs, law = at.springs(table), at.stack(table)[0]
    for i in range(len(springs)):
        s, sense = springs[i], springs[i]["sense"]
        if s["code"] < 0 or s["row"] < 0:
            continue
        speed = sense * law_rate(s, at.before(table))
        extent = sense * (s["way"] - s["rest"])
        _law(table, s, extent, speed, drive)
        force, slope, lead = law[0], max(law[1], 0.0), 0.5 * max(law[2], 0.0)
        _law(table, s, extent + h * speed, speed, drive)
        s["stiff"] = _level(h, s, max(slope, law[1]))
        if s["stiff"] == 1:
            lead += 0.25 * h * slope
        elif s["stiff"] == 2:
            force, lead = law[0], h * max(law[1], 0.0) + max(law[2], 0.0)
        _set_row(table, s, force, lead, speed, h)


@entry_point("laws")
def change_laws(table: int, h: float, drive: Array) -> bool:
    """Linearise laws at the rates that the solve gave; whether any force differs."""
    springs = at.springs(table)
    given, law, changed = at.unknowns(table)[3], at.stack(table)[0], False
    for i in range(len(springs)):
        s, sense = springs[i], springs[i]["sense"]
        if s["code"] < 0 or s["row"] < 0 or not spring_holds(table, s):
            continue
        speed = sense * law_rate(s, at.velocity(table))
        extent = sense * (s["way"] - s["rest"])
        _law(table, s, extent + h * speed, speed, drive)
        slope = max(law[1], 0.0)
        s["stiff"] = max(s["stiff"], _level(h, s, slope))
        force, lead = law[0], h * slope + max(law[2], 0.0)
        if s["stiff"] < 2:
            if s["stiff"] == 0 and not s["of_rate"]:
                continue
            before = sense * law_rate(s, at.before(table))
            even = 0.25 * h * s["stiff"]
            _law(table, s, extent + even * (speed - before), 0.5 * (before + speed), drive)
            force, lead = law[0], even * max(law[1], 0.0) + 0.5 * max(law[2], 0.0)
        acted = -sense * given[s["row"]] / h
        if abs(force - acted) > SAME * (abs(force) + abs(acted)) + NOTHING * slope:
            _set_row(table, s, force, lead, speed, h)
            changed = True
    return changed


@entry_point("springs")
def report_springs(table: int, h: float) -> None:
    """Efforts of springs that have rows, from the impulses of the step."""
    springs, unknown = at.springs(table), at.unknowns(table)[3]
    for i in range(len(springs)):
        s = springs[i]
        if s["row"] >= 0 and acts(table, s["bond"]) and acts(table, s["hinge_bond"]):
            effort = unknown[s["row"]] / h
            # the row of a released spring has a negligible impulse
            s["effort"] = effort if abs(effort) > MIN_LEAD else 0.0


@entry_point("springs")
def add_spring_work(table: int, h: float, v: Matrix) -> None:
    """Work of the step; ``v`` [nb, 3] are the mean velocities of before and after it."""
    springs = at.springs(table)
    for i in range(len(springs)):
        s, speed = springs[i], law_rate(springs[i], v)
        # the order of the factors decides the last digit
        s["step_work"] = (h * (s["effort"] * speed) if s["turning"] and s["number"] >= 0
                          else h * s["effort"] * speed)
        s["work"] += s["step_work"]
