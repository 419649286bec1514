"""What a step's pressures were: flows, what is in the lines afterwards, work, samples."""

from __future__ import annotations

import math
from typing import Any

from sandbox.elements.element import ATMOSPHERE
from sandbox.engine import memory as at
from sandbox.engine.entry_points import entry_point
from sandbox.engine.fluids import SMALLEST, growing, growth, pressures, through
from sandbox.engine.kernel import kernel
from sandbox.numeric import Array, Matrix

FULL = 1e15
"""Pressures and contents are sound below this [Pa, m^3]."""
STILL = 1e-11
"""Flow per volume [1/s] that counts as none."""


@entry_point("fluids")
def report_lines(table: int, h: float, drive: Array) -> None:
    """Pressures and flows of the step, and what is in the lines after it."""
    fluids = at.fluids(table)
    if len(fluids) == 0:
        return
    pressures(table, h, drive)
    _gather(table, drive)
    for i in range(len(fluids)):
        fluid = fluids[i]
        new = fluid["content"] + h * fluid["flow"]
        if fluid["drive"] >= 0 or fluid["mode"] > 0:
            fluid["ahead"] = 0.5  # its content is that of the step's end
            holds = _holds(fluid, growing(table, h, i))
            if fluid["drive"] < 0:
                fluid["spilled"] += new - holds
            else:  # what is lacking comes from the source
                _give(table, i, (holds - new) / h)
            new = holds
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


@kernel
def _give(table: int, line: int, flow: float) -> None:
    """Let a line's source without resistance give so much more."""
    pumps = at.pumps(table)
    for i in range(len(pumps)):
        if pumps[i]["line"] == line and pumps[i]["source"]:
            pumps[i]["flow"] += flow
            at.fluids(table)[line]["flow"] += flow


@kernel
def _holds(fluid: Any, growing: float) -> float:
    """What is in a line at its pressure [m^3]."""
    if fluid["gas"] == 0.0:
        return float(fluid["grown"] + growing + fluid["c"] * fluid["pressure"])
    volume = max(fluid["volume"] + fluid["grown"] + growing, SMALLEST * fluid["volume"])
    return float(volume * (fluid["pressure"] / ATMOSPHERE + 1.0) ** (1.0 / fluid["gas"]))


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
    for i in range(len(fluids)):
        if abs(fluids[i]["flow"]) > STILL * fluids[i]["volume"]:
            return True
    valves = at.valves(table)
    for i in range(len(valves)):
        line = valves[i]["a"] if valves[i]["a"] >= 0 else valves[i]["b"]
        if abs(valves[i]["flow"]) > STILL * fluids[line]["volume"]:
            return True
    for i in range(len(pumps)):
        if abs(pumps[i]["flow"]) > STILL * fluids[pumps[i]["line"]]["volume"]:
            return True
    return False


@kernel
def _head(fluid: Any, pressure: float) -> float:
    """Work that brings fluid from 0 Pa to a pressure, per content [J/m^3].

    Of a gas that of an ideal compressor.
    """
    n, ratio = fluid["gas"], pressure / ATMOSPHERE + 1.0
    if n == 0.0:
        return pressure
    if ratio <= 0.0:
        return 0.0
    if n < 1.0 + 1e-9:
        return ATMOSPHERE * math.log(ratio)
    return float(ATMOSPHERE * n / (n - 1.0) * (ratio ** ((n - 1.0) / n) - 1.0))


@entry_point("fluids")
def add_fluid_work(table: int, h: float, v: Matrix) -> None:
    """Work of lines on bodies, of pumps on fluid, and what valves take, of the step just made.

    ``v`` [nb, 3] are the means of the velocities before and after it.
    """
    fluids = at.fluids(table)
    for i in range(len(fluids)):
        fluids[i]["step_work"] = h * fluids[i]["pressure"] * growth(table, i, v)
        fluids[i]["work"] += fluids[i]["step_work"]
    valves = at.valves(table)
    for i in range(len(valves)):
        head = 0.0
        for end in range(2):
            line, sign = (valves[i]["a"], 1.0) if end == 0 else (valves[i]["b"], -1.0)
            if line >= 0:
                head += sign * _head(fluids[line], fluids[line]["pressure"])
        valves[i]["step_loss"] = h * valves[i]["flow"] * head
        valves[i]["loss"] += valves[i]["step_loss"]
    pumps = at.pumps(table)
    for i in range(len(pumps)):
        line = pumps[i]["line"]
        head = _head(fluids[line], fluids[line]["pressure"])
        pumps[i]["step_work"] = h * pumps[i]["flow"] * head
        pumps[i]["work"] += pumps[i]["step_work"]
