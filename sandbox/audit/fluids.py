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
    peak,
    whole,
)
from sandbox.elements.element import ATMOSPHERE
from sandbox.model.model import NONE
from sandbox.numeric import Array

NEWTON = 1e-8  # Relative error of the flow of an orifice at which iterations stop


def _growth(evidence: Evidence, velocity: Array) -> Array:
    """Growth rates of lines as bodies move with ``velocity`` [3, nb, n]; [nl, n]."""
    return evidence.loads.line_efforts.rates(len(evidence.model.lines.name), velocity)


def _grown(evidence: Evidence) -> tuple[Array, Array]:
    """Growth of lines since t = 0, from the poses [m^3], [nl, n], and sums of areas, [nl]."""
    lines, turns = evidence.model.lines, (evidence.model.lines.joint != NONE)[:, None]
    place = evidence.loads.distances(lines.bodies, np.nan_to_num(lines.anchor))
    if turns.any():
        place = np.where(turns, evidence.angles[lines.joint], place)
    found = np.zeros((len(lines.name), place.shape[1]))
    np.add.at(found, lines.of, lines.gain[:, None] * (place - lines.start[:, None]))
    return found, np.bincount(lines.of, np.abs(lines.gain), len(lines.name)).astype(float)


@check("line.volume", "m^3", "V = V0 + Σ A (L - L0)",
       asks="is the volume of each fluid line the sum of its chambers?",
       compared="volumes of {count:line} from the recorded poses, worst: {where}")
def _volumes(evidence: Evidence, worst: Worst) -> None:
    lines = evidence.model.lines
    (grown, gains), recorded = _grown(evidence), evidence.arrays["line_volume"].T
    for i, name in enumerate(lines.name):
        error = np.abs(lines.volume[i] + grown[i] - recorded[i])
        worst.add(name, error, ROUNDING * (gains[i] + lines.volume[i]))


@check("line.flow", source="dM/dt = Σ Q", asks="does the fluid in each line equal the net inflow?",
       compared="flow into each line against valves and drives, and content against total inflow, "
                "relative to it, {count:comparison}, worst: {where}",
       none="there is no line")
def _flows(evidence: Evidence, worst: Worst) -> None:
    model, a, h = evidence.model, evidence.arrays, evidence.h
    pumps = model.drives.giving("flow", "pressure")
    for i, name in enumerate(model.lines.name):
        share = (model.valves.lines[:, 1] == i) - 1.0 * (model.valves.lines[:, 0] == i)
        into = np.concatenate([a["valve_flow"] * share, a["drive_flow"][
            :, pumps[model.drives.target[pumps] == i]]], axis=1)
        flow, most = a["line_flow"][:, i], max(peak(into), 1e-24)
        worst.add(name, np.abs(flow - into.sum(axis=1)) / most, EXACT)
        if evidence.every_step:
            came = h * (np.cumsum(flow) - flow[0])
            held = a["line_content"][:, i] + a["line_spilled"][:, i]
            turned = max(h * float(np.abs(flow).sum()), model.lines.compliance[i])
            worst.add(name, np.abs(held - held[0] - came) / turned,
                      EXACT + ROUNDING * peak(held) / turned)


@check("line.law", "m^3", "M = V + C p", asks="does each line's pressure match its content?",
       compared="content of {count:line} against volume and pressure, worst: {where}; for gas, "
                "the linearisation error of a step is allowed")
def _pressures(evidence: Evidence, worst: Worst) -> None:
    lines, a, h = evidence.model.lines, evidence.arrays, evidence.h
    if not lines.name:
        return
    (volume, gains), ahead = _grown(evidence), a["line_ahead"].T / h
    rate = h * _growth(evidence, evidence.velocity_after)
    change = h * h * _growth(evidence, evidence.frames.acceleration)
    for i, name in enumerate(lines.name):
        p, came = a["line_pressure"][:, i], h * a["line_flow"][:, i]
        content = a["line_content"][:, i] + (ahead[i] - 0.5) * came
        void = p <= lines.least[i] + EXACT * ATMOSPHERE
        slack = gains[i] * (ROUNDING + h * max(STILL)) + EXACT * (
            lines.compliance[i] * (peak(p) + 1.0)) + ROUNDING * np.abs(content)
        laws = []
        for ratio in (1.5, 2.0):
            more = ahead[i] * rate[i] + ((ahead[i] + 0.5) / ratio - ahead[i]) * change[i]
            holds, straight = _holds(evidence, i, volume[i] + more, p, (ahead[i] + 0.5) * came)
            off = np.where(void & (content < holds), 0.0, np.abs(content - holds))
            laws.append((off, slack + straight))
        worst.add_nearest(name, laws)


def _holds(
    evidence: Evidence, line: int, volume: Array, p: Array, came: Array,
) -> tuple[Array, Array | float]:
    """Content of a line at ``p`` [m^3], [n], and error of linearisation; ``came`` flowed in."""
    lines, n = evidence.model.lines, float(evidence.model.lines.gas[line])
    if np.isnan(n):
        return volume + lines.compliance[line] * p, 0.0
    before, whole_volume = evidence.arrays["line_volume"][:, line], lines.volume[line] + volume
    content = whole_volume * np.maximum(p / ATMOSPHERE + 1.0, 0.0) ** (1.0 / n)
    change = np.abs(whole_volume - before) / whole_volume + np.abs(came) / content
    return content - lines.volume[line], content * n * change**2


@check("valve.law", source="Δp = R Q + ρ/2 (Q / Cd A)²",
       asks="does the pressure drop of each valve match its flow?",
       compared="pressure drops of {count:valve} against their flows, relative to the largest of "
                "each, worst: {where}; below 0.001 Pa an orifice counts as a long passage")
def _valves(evidence: Evidence, worst: Worst) -> None:
    """A valve that is shut has no flow; one that opens one way has none against a pressure drop."""
    valves, a = evidence.model.valves, evidence.arrays
    pressure = np.column_stack([a["line_pressure"], np.zeros(len(evidence.run))])  # NONE is last
    for v, name in enumerate(valves.name):
        flow, (one, two) = a["valve_flow"][:, v], valves.lines[v].tolist()
        across = pressure[:, one] - pressure[:, two]
        opening = np.minimum(a["drive_value"][:, valves.drive[v]], 1.0) if (
            valves.drive[v] != NONE) else np.ones(len(flow))
        shut = opening <= 1e-9
        through = flow / np.where(shut, 1.0, opening)
        off = np.abs(valves.resistance[v] * through
                     + valves.orifice[v] * np.abs(through) * through - across)
        if valves.one_way[v]:
            off = np.where(flow == 0.0, np.maximum(across, 0.0), np.maximum(off, -flow))
        most = max(whole(across), 1.0)
        worst.add(name, np.where(shut, np.abs(flow), off) / most, EXACT + 2 * NEWTON + 3e-3 / most)


@check("line.energy", source="W = Σ (p V work + C p²/2 + throttled)",
       asks="does the work of pumps go to bodies, fluid and valves?",
       compared="work of pumps minus the work on bodies, the energy stored in fluid and the losses "
                "of valves and reliefs, relative to the total; pressure change in a step times "
                "flow is allowed")
def _energy(evidence: Evidence, worst: Worst) -> None:
    model, a, lines, h = evidence.model, evidence.arrays, evidence.model.lines, evidence.h
    if not lines.name:
        raise NotComputed("there is no line")
    if np.isfinite(lines.gas).any():
        raise NotComputed("a gas exchanges heat with its surroundings")
    if not evidence.every_step:
        raise NotComputed(NOT_EVERY_STEP)
    p, work = a["line_pressure"], a["line_work"].sum(axis=1)
    pumps = a["drive_work"][:, model.drives.giving("flow", "pressure")].sum(axis=1)
    spilled = np.diff(a["line_spilled"], axis=0, prepend=a["line_spilled"][:1]) * p
    lost = a["valve_loss"].sum(axis=1) + (np.cumsum(spilled, axis=0) - spilled / 2).sum(axis=1)
    stored = (lines.compliance * p**2 / 2).sum(axis=1)
    left = pumps - lost - stored - work
    change = np.abs(np.diff(p, axis=0, prepend=p[:1]))
    growth, bend = (np.abs(_growth(evidence, v)).T for v in (
        evidence.velocity, evidence.frames.acceleration))
    step = np.cumsum((lines.compliance * change**2 + h * h * bend * (np.abs(p) + change)
                      + change * h * (growth + np.abs(a["line_flow"]))).sum(axis=1))
    # works are up to the middle of a step, pressures may be at its end
    half = (lines.compliance * np.abs(p) * change).sum(axis=1)
    step = step + half + half[:2].max(initial=0.0)
    scale = max(peak(np.abs(pumps) + np.abs(work) + stored + np.abs(lost)), 1e-15)
    error = np.abs(left - left[0])
    k = int(np.argmax(error - step))
    worst.judge(error[k] / scale, EXACT + step[k] / scale)
