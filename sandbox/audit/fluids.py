"""Fluid lines: volumes, flows, pressures and energy.

The content of a line is the inflow; it fills the volume at the line's pressure. A step relates the
pressure to volume and content at the recorded instant (docs/engine.md), with one of two weights of
velocities throughout the run. At its least pressure a line may not be full.
"""

from __future__ import annotations

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    EXACT,
    NOT_EVERY_STEP,
    ROUNDING,
    STILL,
    NotComputed,
    Worst,
    check,
    whole,
)
from sandbox.elements.element import ATMOSPHERE
from sandbox.model.model import NONE
from sandbox.numeric import Array

OLDER = "the recording is of an older version, without the times of fluid contents"
OLDER = "the recording is of an older version, without the times of fluid contents"
NEWTON = 1e-8
"""Relative error of the flow of an orifice at which iterations stop."""


def _growth(evidence: Evidence, velocity: Array) -> Array:
    """Growth rates of lines as bodies move with ``velocity`` [3, nb, n]; [nl, n]."""
    return evidence.loads.line_efforts.rates(len(evidence.model.lines.name), velocity)


def _grown(evidence: Evidence) -> Array:
    """Growth of lines since t = 0, from the poses [m^3], [nl, n]."""
    lines, turns = evidence.model.lines, (evidence.model.lines.joint != NONE)[:, None]
    place = evidence.loads.distances(lines.bodies, np.nan_to_num(lines.anchor))
    if turns.any():
        place = np.where(turns, evidence.angles[lines.joint], place)
    found = np.zeros((len(lines.name), place.shape[1]))
    np.add.at(found, lines.of, lines.gain[:, None] * (place - lines.start[:, None]))
    return found


def _gains(evidence: Evidence) -> Array:
    """Sum of areas and displacements of each line, [nl]."""
    lines = evidence.model.lines
    return np.bincount(lines.of, np.abs(lines.gain), len(lines.name)).astype(float)


@check("line.volume", "m^3", "V = V0 + Σ A (L - L0)",
       asks="is the volume of each fluid line the sum of its chambers?",
       compared="volumes of {count:line} from the recorded poses, worst: {where}",
       none="there is no line")
def _volumes(evidence: Evidence, worst: Worst) -> None:
    lines = evidence.model.lines
    found, recorded = _grown(evidence), evidence.run.arrays["line_volume"].T
    gains = _gains(evidence)
    for i, name in enumerate(lines.name):
        error = np.abs(lines.volume[i] + found[i] - recorded[i])
        worst.add(name, error, ROUNDING * (gains[i] + lines.volume[i]))


@check("line.flow", source="dM/dt = Σ Q", asks="does the fluid in each line equal the net inflow?",
       compared="flow into each line against valves and drives, and content against total inflow, "
                "relative to it, {count:comparison}, worst: {where}",
       none="there is no line")
def _flows(evidence: Evidence, worst: Worst) -> None:
    model, a, h = evidence.model, evidence.run.arrays, evidence.h
    for i, name in enumerate(model.lines.name):
        into = np.zeros(len(evidence.run))
        size = np.zeros(len(evidence.run))
        for v, (one, two) in enumerate(model.valves.lines.tolist()):
            flow = a["valve_flow"][:, v]
            into += flow * ((two == i) - float(one == i))
            size = np.maximum(size, np.abs(flow))
        for d in model.drives.giving("flow", "pressure").tolist():
            if model.drives.target[d] == i:
                into += a["drive_flow"][:, d]
                size = np.maximum(size, np.abs(a["drive_flow"][:, d]))
        flow, most = a["line_flow"][:, i], max(float(size.max(initial=0.0)), 1e-24)
        worst.add(name, np.abs(flow - into) / most, EXACT)
        if evidence.every_step:
            came = h * (np.cumsum(flow) - flow[0])
            held = a["line_content"][:, i] + a["line_spilled"][:, i]
            turned = max(h * float(np.abs(flow).sum()), model.lines.compliance[i])
            least = ROUNDING * float(np.abs(held).max(initial=0.0)) / turned
            worst.add(name, np.abs(held - held[0] - came) / turned, EXACT + least)


@check("line.law", "m^3", "M = V + C p", asks="does each line's pressure match its content?",
       compared="content of {count:line} against volume and pressure, worst: {where}; for gas, "
                "the linearisation error of a step is allowed",
       none="there is no line")
def _pressures(evidence: Evidence, worst: Worst) -> None:
    lines, a, h = evidence.model.lines, evidence.run.arrays, evidence.h
    if np.isnan(a["line_ahead"]).any():
        raise NotComputed(OLDER)
    ahead = a["line_ahead"].T / h
    inflow = ahead + 0.5
    if lines.name:
        volume, gains = _grown(evidence), _gains(evidence)
        rate = h * _growth(evidence, evidence.velocity_after)
        change = h * h * _growth(evidence, evidence.loads.frames.acceleration)
    for i, name in enumerate(lines.name):
        p, came = a["line_pressure"][:, i], h * a["line_flow"][:, i]
        content = a["line_content"][:, i] + (ahead[i] - 0.5) * came
        void = p <= lines.least[i] + EXACT * ATMOSPHERE
        slack = gains[i] * (ROUNDING + h * max(STILL)) + EXACT * (
            lines.compliance[i] * (np.abs(p).max(initial=0.0) + 1.0)) + ROUNDING * np.abs(content)
        laws = []
        for ratio in (1.5, 2.0):
            more = ahead[i] * rate[i] + (inflow[i] / ratio - ahead[i]) * change[i]
            holds, straight = _holds(evidence, i, volume[i] + more, p, inflow[i] * came)
            off = np.abs(content - holds)
            off = np.where(void & (content < holds), 0.0, off)
            laws.append((off, slack + straight))
        worst.add_nearest(name, laws)


def _holds(
    evidence: Evidence, line: int, volume: Array, p: Array, came: Array,
) -> tuple[Array, Array]:
    """Content of a line that has grown by ``volume`` at ``p`` [m^3], [n]; error of linearisation.

    ``came`` flowed in meanwhile [m^3], [n].
    """
    lines, a = evidence.model.lines, evidence.run.arrays
    n = float(lines.gas[line])
    if np.isnan(n):
        return volume + lines.compliance[line] * p, np.zeros(len(p))
    whole_volume = lines.volume[line] + volume
    content = whole_volume * np.maximum(p / ATMOSPHERE + 1.0, 0.0) ** (1.0 / n)
    change = (np.abs(volume - (a["line_volume"][:, line] - lines.volume[line])) / whole_volume
              + np.abs(came) / content)
    return content - lines.volume[line], content * n * change**2


@check("valve.law", source="Δp = R Q + ρ/2 (Q / Cd A)²",
       asks="does the pressure drop of each valve match its flow?",
       compared="pressure drops of {count:valve} against their flows, relative to the largest of "
                "each, worst: {where}; below 0.001 Pa an orifice counts as a long passage",
       none="there is no valve")
def _valves(evidence: Evidence, worst: Worst) -> None:
    model, a = evidence.model, evidence.run.arrays
    valves = model.valves
    for v, name in enumerate(valves.name):
        flow = a["valve_flow"][:, v]
        across = sum(sign * a["line_pressure"][:, line] for sign, line in
                     zip((1.0, -1.0), valves.lines[v].tolist(), strict=True) if line != NONE)
        opening = np.minimum(a["drive_value"][:, valves.drive[v]], 1.0) if (
            valves.drive[v] != NONE) else np.ones(len(flow))
        shut = opening <= 1e-9
        through = flow / np.where(shut, 1.0, opening)
        law = valves.resistance[v] * through + valves.orifice[v] * np.abs(through) * through
        off = np.where(shut, np.abs(flow), np.abs(law - across))
        if valves.one_way[v]:
            off = np.where(flow == 0.0, np.maximum(across, 0.0), np.maximum(off, -flow))
            off = np.where(shut, np.abs(flow), off)
        most = max(whole(np.asarray(across)), 1.0)
        worst.add(name, off / most, EXACT + 2 * NEWTON + 3e-3 / most)


@check("line.energy", source="W = Σ (p V work + C p²/2 + throttled)",
       asks="does the work of pumps go to bodies, fluid and valves?",
       compared="work of pumps minus the work on bodies, the energy stored in fluid and the losses "
                "of valves and reliefs, relative to the total; pressure change in a step times "
                "flow is allowed")
def _energy(evidence: Evidence, worst: Worst) -> None:
    model, a, lines, h = evidence.model, evidence.run.arrays, evidence.model.lines, evidence.h
    if not lines.name:
        raise NotComputed("there is no line")
    if np.isfinite(lines.gas).any():
        raise NotComputed("a gas exchanges heat with its surroundings")
    if not evidence.every_step:
        raise NotComputed(NOT_EVERY_STEP)
    pumps = a["drive_work"][:, model.drives.giving("flow", "pressure")].sum(axis=1)
    p = a["line_pressure"]
    spilled = np.diff(a["line_spilled"], axis=0, prepend=a["line_spilled"][:1]) * p
    lost = a["valve_loss"].sum(axis=1) + (np.cumsum(spilled, axis=0) - spilled / 2).sum(axis=1)
    stored = (lines.compliance * p**2 / 2).sum(axis=1)
    work = a["line_work"].sum(axis=1)
    left = pumps - lost - stored - work
    change = np.diff(p, axis=0, prepend=p[:1])
    bend = np.abs(_growth(evidence, evidence.loads.frames.acceleration)).T * h * h
    step = np.cumsum((lines.compliance * change**2 + bend * (np.abs(p) + np.abs(change))
                      + np.abs(change) * h * np.abs(_growth(evidence, evidence.velocity)).T
                      + np.abs(change) * h * np.abs(a["line_flow"])).sum(axis=1))
    # works are up to the middle of a step, pressures may be at its end
    half = (lines.compliance * np.abs(p * change)).sum(axis=1)
    step = step + half + half[:2].max(initial=0.0)
    scale = max(float((np.abs(pumps) + np.abs(work) + stored + np.abs(lost)).max(initial=0.0)),
                1e-15)
    error = np.abs(left - left[0])
    k = int(np.argmax(error - step))
    worst.judge(error[k] / scale, EXACT + step[k] / scale)
