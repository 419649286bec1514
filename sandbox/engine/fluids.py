"""Lines of fluid: one pressure in several chambers, and what flows through valves and from pumps.

At the pose x of the step a line has the volume V(x), and grows by D v as the bodies move. Its
content M, that of the step's beginning, gives the pressure p_rigid that it would have if nothing
moved or flowed, and its compliance C = dV/dp there. With the flows Q into it the row of the solve
for the impulse h p is

    a D v + C p / h = C p_rigid / h + s sum Q + b D v_before,    s = 1/2 + k,  a = s / r,  b = a - k

Volume and content are then those of one instant, k steps after the pose, to second order:

    k = 0      the instant of the pose: the trapezoid rule (r = 2), which keeps an oscillation
    k <= 1/2   so far ahead that 1 - s <= C / (2 h dQ/dp): a line that fills within a step does not
               overshoot
    k = 1      a line whose bodies are too light for the step: BDF2 (r = 3/2), which damps

Lines that valves join have one r, so that the matrix is symmetric. A valve's flow is linearised in
the pressures of its two lines until flows stay (Newton's method). Pressures at their minimum or
maximum, or set by a drive, are those of a line with a very large compliance. Afterwards M grows by
the inflow. The volume follows from the pose in every step, so that errors do not accumulate.
"""

from __future__ import annotations

import math
from typing import Any

from sandbox.elements.element import ATMOSPHERE
from sandbox.engine import memory as at
from sandbox.engine.coordinates import ends, rate
from sandbox.engine.entry_points import entry_point
from sandbox.engine.kernel import kernel
from sandbox.engine.plan import add_to
from sandbox.numeric import Array, Matrix, Records

GIVEN = 1e12  # compliance of a line with a given pressure, over its own
LAMINAR = 1e-3  # pressure [Pa] up to which the flow of an orifice is proportional to it
SHUT = 1e-9  # opening below which a valve is shut
EVEN = 1e-9  # relative tolerance of pressures and flows
SMALLEST = 1e-6  # minimum volume and content of a gas, as a share of those at t = 0
FULL = 1e15  # pressures and contents are valid below this [Pa, m^3]
STILL = 1e-11  # flow per volume [1/s] that counts as zero
ALL = 3  # attempts in which all violated lines and valves change; later the worst


@entry_point("fluids")
def measure_volumes(table: int, drive: Array) -> None:
    """Volumes of lines at the poses of the step, forces of 1 Pa, pressures without flow."""
    fluids = at.fluids(table)
    chambers, body, turn = at.chambers(table), at.body(table), at.turn(table)
    for i in range(len(fluids)):
        grown = 0.0
        for n in range(fluids[i]["first"], fluids[i]["last"]):
            chamber, gain = chambers[n], chambers[n]["gain"]
            if chamber["turns"]:
                chamber["dx"] = chamber["dy"] = 0.0
                chamber["ta"], chamber["tb"] = -gain, gain
                way = body[chamber["b"], 2] - body[chamber["a"], 2]
            else:
                ax, ay, bx, by, dx, dy = ends(chamber, body, turn)
                way = math.hypot(dx, dy)
                x, y = (gain * dx / way, gain * dy / way) if way > 0.0 else (0.0, 0.0)
                chamber["dx"], chamber["dy"] = x, y
                chamber["ta"], chamber["tb"] = ay * x - ax * y, bx * y - by * x
            grown += gain * (way - chamber["start"])
        fluid = fluids[i]
        fluid["grown"], fluid["ahead"] = grown, fluid["ahead_min"]
        if fluid["gas"] == 0.0:
            fluid["rigid"] = (fluid["content"] - grown) / fluid["c"]
            fluid["yields"], fluid["swells"] = fluid["c"], 1.0
        else:
            volume = max(fluid["volume"] + grown, SMALLEST * fluid["volume"])
            pressure = ATMOSPHERE * (fluid["content"] / volume) ** fluid["gas"]
            fluid["rigid"] = pressure - ATMOSPHERE
            fluid["yields"] = volume / (fluid["gas"] * pressure)
            fluid["swells"] = volume / fluid["content"]
    valves = at.valves(table)
    for i in range(len(valves)):
        valves[i]["about"] = valves[i]["flow"]
        if valves[i]["r"] == 0.0 and abs(valves[i]["flow"]) ** 2 * valves[i]["k"] < LAMINAR:
            across = (_rigid(fluids, drive, valves[i]["a"]) - _rigid(fluids, drive, valves[i]["b"]))
            valves[i]["about"] = math.copysign(math.sqrt(abs(across) / valves[i]["k"]), across)


@kernel
def _rigid(fluids: Records, drive: Array, line: int) -> float:
    """The pressure that a line begins the step with; of the tank 0."""
    if line < 0:
        return 0.0
    if fluids[line]["drive"] >= 0:
        return float(drive[fluids[line]["drive"]])
    return float(min(max(fluids[line]["rigid"], fluids[line]["minimum"]), fluids[line]["maximum"]))


@kernel
def _weights(fluid: Any) -> tuple[float, float, float]:
    """The weights a, b and s of a line's law."""
    inflow = 0.5 + fluid["ahead"]
    after = inflow / fluid["ratio"]
    return after, after - fluid["ahead"], inflow


@kernel
def _linearise_valves(table: int, drive: Array) -> None:
    """Flows of valves and pumps, linearised in the pressures."""
    fluids, valves = at.fluids(table), at.valves(table)
    for i in range(len(fluids)):
        fluids[i]["conductance"] = fluids[i]["supply"] = 0.0
    for i in range(len(valves)):
        v = valves[i]
        opening = min(drive[v["drive"]], 1.0) if v["drive"] >= 0 else 1.0
        v["conductance"] = v["supply"] = 0.0
        if opening <= SHUT or v["shut"]:
            v["about"] = 0.0
            continue
        r, k = v["r"] / opening, v["k"] / (opening * opening)
        smallest = math.sqrt(LAMINAR / k) if v["r"] == 0.0 else 0.0
        slope = r + 2.0 * k * max(abs(v["about"]), smallest)
        v["conductance"], v["supply"] = 1.0 / slope, k * abs(v["about"]) * v["about"] / slope
        both = _swells(fluids, v)
        for end in range(2):
            joined, sign = (v["a"], -1.0) if end == 0 else (v["b"], 1.0)
            if joined >= 0:
                rest = fluids[joined]["swells"] - both
                fluids[joined]["conductance"] += both * v["conductance"]
                fluids[joined]["supply"] += sign * (both * v["supply"] + rest * v["about"])
    pumps = at.pumps(table)
    for i in range(len(pumps)):
        pump, line = pumps[i], fluids[pumps[i]["line"]]
        value = drive[pump["drive"]]
        if not pump["source"]:
            line["supply"] += line["swells"] * value
        elif fluids[pump["line"]]["drive"] < 0:
            line["conductance"] += line["swells"] / pump["r"]
            line["supply"] += line["swells"] * value / pump["r"]


@kernel
def _swells(fluids: Records, valve: Any) -> float:
    """How much volume a valve's flow is in the lines that it joins: between those of both."""
    a, b = valve["a"], valve["b"]
    if a < 0:
        return float(fluids[b]["swells"])
    if b < 0:
        return float(fluids[a]["swells"])
    return math.sqrt(fluids[a]["swells"] * fluids[b]["swells"])


@entry_point("fluids")
def fluid_rows(table: int, h: float, drive: Array) -> None:
    """The rows of all lines."""
    fluids = at.fluids(table)
    if len(fluids) == 0:
        return
    _linearise_valves(table, drive)
    chambers, J = at.chambers(table), at.entries(table)[0]
    rhs, compliance = at.unknowns(table)[0], at.unknowns(table)[1]
    for n in range(len(chambers)):
        J[chambers[n]["entry_a"]] = J[chambers[n]["entry_b"]] = 0.0
    for n in range(len(chambers)):
        p = chambers[n]
        add_to(J, p["entry_a"], -p["dx"], -p["dy"], p["ta"])
        add_to(J, p["entry_b"], p["dx"], p["dy"], p["tb"])
    for i in range(len(fluids)):
        fluid, r = fluids[i], fluids[i]["row"]
        if fluid["conductance"] > 0.0:  # only ahead within a step, so that attempts end
            fluid["ahead"] = max(
                fluid["ahead"], 0.5 - fluid["yields"] / (2.0 * h * fluid["conductance"]))
        after, before, inflow = _weights(fluid)
        compliance[r] = (fluid["yields"] / h + inflow * fluid["conductance"]) / (after * h)
        rhs[r] = (fluid["yields"] * fluid["rigid"] / h + inflow * fluid["supply"]
                  + before * growth(table, i, at.before(table))) / after
        if fluid["drive"] >= 0 or fluid["mode"] != 0:
            compliance[r] = GIVEN * (compliance[r] + fluid["response"])
            rhs[r] = compliance[r] * h * _given(fluid, drive)


@kernel
def _given(fluid: Any, drive: Array) -> float:
    if fluid["drive"] >= 0:
        return float(min(max(drive[fluid["drive"]], fluid["minimum"]), fluid["maximum"]))
    return float(fluid["minimum"] if fluid["mode"] < 0 else fluid["maximum"])


@entry_point("fluids")
def join_lines(table: int, h: float) -> None:
    """Put into the matrix where two lines meet at a valve."""
    valves, values, fluids = at.valves(table), at.values(table), at.fluids(table)
    for i in range(len(valves)):
        if valves[i]["slot"] >= 0:
            v = valves[i]
            values[v["slot"]] -= (
                fluids[v["a"]]["ratio"] * _swells(fluids, v) * v["conductance"] / h)


@kernel
def growth(table: int, line: int, velocity: Array) -> float:
    """The rate at which a line grows as bodies move with ``velocity`` [nb, 3] [m^3/s]."""
    fluid, chambers, total = at.fluids(table)[line], at.chambers(table), 0.0
    for n in range(fluid["first"], fluid["last"]):
        total += rate(chambers[n], velocity)
    return total


@kernel
def growing(table: int, h: float, line: int) -> float:
    """The volume beyond that of the pose that a line's law takes [m^3]."""
    after, before, _ = _weights(at.fluids(table)[line])
    return h * (after * growth(table, line, at.velocity(table))
                - before * growth(table, line, at.before(table)))


@kernel
def pressures(table: int, h: float, drive: Array) -> None:
    """Pressures of lines and flows of valves as the solution has them."""
    fluids, unknown = at.fluids(table), at.unknowns(table)[3]
    for i in range(len(fluids)):
        fluids[i]["pressure"] = unknown[fluids[i]["row"]] / h
        if fluids[i]["drive"] >= 0 or fluids[i]["mode"] != 0:
            fluids[i]["pressure"] = _given(fluids[i], drive)


@kernel
def _across(table: int, valve: int) -> float:
    v = at.valves(table)[valve]
    return _pressure(table, v["a"]) - _pressure(table, v["b"])


@kernel
def _pressure(table: int, line: int) -> float:
    """The pressure of a line, of the tank 0."""
    return float(at.fluids(table)[line]["pressure"]) if line >= 0 else 0.0


@kernel
def through(table: int, valve: int) -> float:
    """A valve's flow [m^3/s]."""
    v = at.valves(table)[valve]
    return float(v["supply"] + v["conductance"] * _across(table, valve))


@entry_point("fluids")
def change_lines(table: int, h: float, drive: Array, attempt: int) -> bool:
    """Change lines and valves outside their bounds, all at first, later the worst; whether any."""
    fluids = at.fluids(table)
    if len(fluids) == 0:
        return False
    pressures(table, h, drive)
    changed, worst, which = _flows(table), 0.0, -1
    for i in range(len(fluids)):
        off, mode = _violation(table, h, i)
        if off > 0.0 and attempt < ALL:
            fluids[i]["mode"], changed = mode, True
        elif off > worst:
            worst, which = off, i
    valves = at.valves(table)
    for i in range(len(valves)):
        if valves[i]["one_way"]:
            v, across = valves[i], _across(table, i)
            size = EVEN * (1.0 + abs(_pressure(table, v["a"])) + abs(_pressure(table, v["b"])))
            # the linearised flow has the right sign before the pressure has it
            off = across if v["shut"] else -across if through(table, i) < 0.0 else 0.0
            if off > size and attempt < ALL:
                _turn(table, i)
                changed = True
            elif off > max(size, worst):
                worst, which = off, len(fluids) + i
    if worst > 0.0:
        changed = True
        if which < len(fluids):
            fluids[which]["mode"] = _violation(table, h, which)[1]
        else:
            _turn(table, which - len(fluids))
    return changed


@kernel
def _turn(table: int, valve: int) -> None:
    """Open or shut a check valve; an orifice opens to the flow that the pressure now has."""
    v = at.valves(table)[valve]
    v["shut"] = 1 - v["shut"]
    if not v["shut"] and v["k"] > 0.0:
        v["about"] = math.sqrt(max(_across(table, valve), 0.0) / v["k"])


@kernel
def _flows(table: int) -> bool:
    """Linearise the laws of valves about the last flows; whether these changed."""
    valves, fluids = at.valves(table), at.fluids(table)
    changed = False
    for i in range(len(valves)):
        v, last = valves[i], valves[i]["about"]
        if v["conductance"] == 0.0:
            continue
        flow = through(table, i)
        v["about"] = flow
        uneven = v["a"] >= 0 and v["b"] >= 0 and (
            fluids[v["a"]]["swells"] != fluids[v["b"]]["swells"])
        if v["k"] > 0.0 or uneven:
            smallest = math.sqrt(LAMINAR * EVEN / v["k"]) if v["k"] > 0.0 else 0.0
            changed |= abs(flow - last) > EVEN * max(abs(flow), abs(last)) + smallest
    return changed


@kernel
def _violation(table: int, h: float, line: int) -> tuple[float, int]:
    """Pressure by which a line contradicts its mode, and the consistent mode."""
    fluids, valves = at.fluids(table), at.valves(table)
    fluid, mode = fluids[line], fluids[line]["mode"]
    if fluid["drive"] >= 0:
        return 0.0, 0
    p, low, high = fluid["pressure"], fluid["minimum"], fluid["maximum"]
    if mode == 0:
        if p < low - EVEN * (abs(low) + 1.0):
            return float(low - p), -1
        if p > high + EVEN * (abs(high) + 1.0):
            return float(p - high), 1
        return 0.0, 0
    after, _, inflow = _weights(fluid)
    flow = fluid["supply"] - fluid["conductance"] * p  # volume into the line, as in the rows
    for i in range(len(valves)):
        a, b = valves[i]["a"], valves[i]["b"]
        if (a == line and b >= 0) or (b == line and a >= 0):
            flow += (_swells(fluids, valves[i]) * valves[i]["conductance"]
                     * fluids[b if a == line else a]["pressure"])
    excess = (fluid["yields"] * (fluid["rigid"] - p) + h * inflow * flow
             - growing(table, h, line)) / (fluid["yields"] + h * h * after * fluid["response"])
    off = excess if mode < 0 else -excess
    return float(off if off > EVEN * (abs(p) + 1.0) else 0.0), 0


@entry_point("fluids")
def report_lines(table: int, h: float, drive: Array) -> None:
    """Pressures and flows of the step, and the contents of lines after it."""
    fluids, pumps = at.fluids(table), at.pumps(table)
    if len(fluids) == 0:
        return
    pressures(table, h, drive)
    _gather(table, drive)
    for i in range(len(fluids)):
        fluid = fluids[i]
        new = fluid["content"] + h * fluid["flow"]
        if fluid["drive"] >= 0 or fluid["mode"] > 0:
            fluid["ahead"] = 0.5  # its content is that of the step's end
            more = growing(table, h, i)
            content = fluid["grown"] + more + fluid["c"] * fluid["pressure"]
            if fluid["gas"] > 0.0:
                volume = max(fluid["volume"] + fluid["grown"] + more, SMALLEST * fluid["volume"])
                content = volume * (fluid["pressure"] / ATMOSPHERE + 1.0) ** (1.0 / fluid["gas"])
            if fluid["drive"] < 0:
                fluid["spilled"] += new - content
            for n in range(len(pumps)):  # a source without resistance supplies the rest
                if fluid["drive"] >= 0 and pumps[n]["line"] == i and pumps[n]["source"]:
                    pumps[n]["flow"] += (content - new) / h
                    fluid["flow"] += (content - new) / h
            new = content
        if fluid["gas"] > 0.0:
            new = max(new, SMALLEST * fluid["volume"])
        fluid["content"] = new


@kernel
def _gather(table: int, drive: Array) -> None:
    """Flows of valves and pumps, and their sums in the lines."""
    fluids, valves = at.fluids(table), at.valves(table)
    for i in range(len(fluids)):
        fluids[i]["flow"] = 0.0
    for i in range(len(valves)):
        flow = valves[i]["flow"] = through(table, i)
        if valves[i]["a"] >= 0:
            fluids[valves[i]["a"]]["flow"] -= flow
        if valves[i]["b"] >= 0:
            fluids[valves[i]["b"]]["flow"] += flow
    pumps = at.pumps(table)
    for i in range(len(pumps)):
        pump, value = pumps[i], drive[pumps[i]["drive"]]
        line = fluids[pump["line"]]
        pump["flow"] = 0.0 if pump["source"] else value
        if pump["r"] > 0.0:
            pump["flow"] = (value - line["pressure"]) / pump["r"]
        line["flow"] += pump["flow"]


@entry_point("fluids", default=1)
def contained(table: int) -> bool:
    """Whether all pressures and contents are finite and below :data:`FULL`."""
    fluids = at.fluids(table)
    for i in range(len(fluids)):  # written so that NaN is not sound
        if not (abs(fluids[i]["pressure"]) < FULL and abs(fluids[i]["content"]) < FULL):
            return False
    return True


@entry_point("fluids")
def flowing(table: int) -> bool:
    """Whether anything flows: what stands still for that is not at rest."""
    fluids, pumps = at.fluids(table), at.pumps(table)
    valves, moving = at.valves(table), False
    for i in range(len(fluids)):
        moving |= abs(fluids[i]["flow"]) > STILL * fluids[i]["volume"]
    for i in range(len(valves)):
        line = valves[i]["a"] if valves[i]["a"] >= 0 else valves[i]["b"]
        moving |= abs(valves[i]["flow"]) > STILL * fluids[line]["volume"]
    for i in range(len(pumps)):
        moving |= abs(pumps[i]["flow"]) > STILL * fluids[pumps[i]["line"]]["volume"]
    return moving


@kernel
def _head(fluids: Records, line: int) -> float:
    """Work that brings fluid from 0 Pa into a line, per content [J/m^3]; a gas ideally."""
    if line < 0:
        return 0.0
    pressure = fluids[line]["pressure"]
    n, ratio = fluids[line]["gas"], pressure / ATMOSPHERE + 1.0
    if n == 0.0:
        return float(pressure)
    if ratio <= 0.0:
        return 0.0
    if n < 1.0 + 1e-9:
        return ATMOSPHERE * math.log(ratio)
    return float(ATMOSPHERE * n / (n - 1.0) * (ratio ** ((n - 1.0) / n) - 1.0))


@entry_point("fluids")
def add_fluid_work(table: int, h: float, v: Matrix) -> None:
    """Work of lines, pumps and valves in the step, for the mean velocities ``v`` [nb, 3]."""
    fluids = at.fluids(table)
    for i in range(len(fluids)):
        fluids[i]["step_work"] = h * fluids[i]["pressure"] * growth(table, i, v)
        fluids[i]["work"] += fluids[i]["step_work"]
    valves = at.valves(table)
    for i in range(len(valves)):
        head = _head(fluids, valves[i]["a"]) - _head(fluids, valves[i]["b"])
        valves[i]["step_loss"] = h * valves[i]["flow"] * head
        valves[i]["loss"] += valves[i]["step_loss"]
    pumps = at.pumps(table)
    for i in range(len(pumps)):
        pumps[i]["step_work"] = h * pumps[i]["flow"] * _head(fluids, pumps[i]["line"])
        pumps[i]["work"] += pumps[i]["step_work"]
