"""Figures of fluid: volumes, what flows in and stays, pressures, and where the work goes.

What is in a line is what came in; it fills the volume at the line's pressure. A step relates the
pressure to volume and content at the instant that is recorded with it (docs/engine.md), and a line
has to keep one of two weights of velocities throughout. Where it is not full, at its least
pressure, there may be less in it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import (
    EXACT,
    NOT_EVERY_STEP,
    ROUNDING,
    STILL,
    Figure,
    Worst,
    judged,
    missing,
    whole,
)
from sandbox.elements.element import ATMOSPHERE
from sandbox.model.model import NONE
from sandbox.numeric import Array

OLDER = "the recording is of an older version, without the times of fluid contents"
NEWTON = 1e-8
"""Share of a flow by which an orifice's law may be off where attempts to find it end."""


def fluid_figures(evidence: Evidence) -> Iterator[Figure]:
    """Volumes, flows, contents, pressures and work of the lines."""
    yield _volumes(evidence)
    yield _flows(evidence)
    yield _pressures(evidence)
    yield _valves(evidence)
    yield _energy(evidence)


def _growth(evidence: Evidence, velocity: Array) -> Array:
    """Rates at which lines grow as bodies move with ``velocity`` [3, nb, n]; [nl, n]."""
    loads = evidence.loads
    return -loads.lengthening(loads.line_pushes, len(evidence.model.lines.name), velocity)


def grown(evidence: Evidence) -> Array:
    """By what lines have grown since t = 0, from the poses [m^3], [nl, n]."""
    lines, frames = evidence.model.lines, evidence.loads.frames
    found = np.zeros((len(lines.name), frames.samples))
    for n, line in enumerate(lines.of.tolist()):
        if lines.joint[n] != NONE:
            found[line] += lines.gain[n] * (evidence.angles[lines.joint[n]] - lines.start[n])
            continue
        one, two = (frames.places(lines.bodies[n, k:k + 1], lines.anchor[n, k]) for k in (0, 1))
        found[line] += lines.gain[n] * (np.hypot(two.x - one.x, two.y - one.y)[0] - lines.start[n])
    return found


def _gains(evidence: Evidence) -> Array:
    """Sum of areas and displacements of each line, [nl]."""
    lines = evidence.model.lines
    return np.bincount(lines.of, np.abs(lines.gain), len(lines.name)).astype(float)


def _volumes(evidence: Evidence) -> Figure:
    lines, worst = evidence.model.lines, Worst()
    found, recorded = grown(evidence), evidence.run.arrays["line_volume"].T
    gains = _gains(evidence)
    for i, name in enumerate(lines.name):
        error = np.abs(lines.volume[i] + found[i] - recorded[i])
        worst.add(name, error, ROUNDING * (gains[i] + lines.volume[i]))
    return worst.figure(
        "line.volume", "m^3", source="V = V0 + Σ A (L - L0)", none="there is no line",
        why="volumes of {count:line} from the recorded poses, worst: {where}")


def _flows(evidence: Evidence) -> Figure:
    """What flows into a line is what valves and drives let in, and what came in is there."""
    model, a, worst, h = evidence.model, evidence.run.arrays, Worst(), evidence.h
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
    return worst.figure(
        "line.flow", "", source="dM/dt = Σ Q", none="there is no line",
        why="flow into each line against valves and drives, and content against total inflow, "
            "relative to it, {count:comparison}, worst: {where}")


def _pressures(evidence: Evidence) -> Figure:
    lines, a, h, worst = evidence.model.lines, evidence.run.arrays, evidence.h, Worst()
    source = "M = V + C p"
    if np.isnan(a["line_ahead"]).any():
        return missing("line.law", why=OLDER, source=source)
    ahead = a["line_ahead"].T / h
    inflow = ahead + 0.5
    if lines.name:
        volume, gains = grown(evidence), _gains(evidence)
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
    return worst.figure(
        "line.law", "m^3", source=source, none="there is no line",
        why="content of {count:line} against volume and pressure, worst: {where}; for gas, the "
            "linearisation error of a step is allowed")


def _holds(
    evidence: Evidence, line: int, volume: Array, p: Array, came: Array,
) -> tuple[Array, Array]:
    """What fills a line that has grown by ``volume`` at ``p`` [m^3], [n]; what of it bends.

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


def _valves(evidence: Evidence) -> Figure:
    """Pressure across valves from their flows; of those that a drive opens by its values."""
    model, a, worst = evidence.model, evidence.run.arrays, Worst()
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
    return worst.figure(
        "valve.law", "", source="Δp = R Q + ρ/2 (Q / Cd A)²", none="there is no valve",
        why="pressure drops of {count:valve} against their flows, relative to the largest of each, "
            "worst: {where}; below 0.001 Pa an orifice counts as a long passage")


def _energy(evidence: Evidence) -> Figure:
    """What pumps put in is in the bodies, pressed into fluid, throttled or let out."""
    name, source, model = "line.energy", "W = Σ (p V work + C p²/2 + throttled)", evidence.model
    a, lines, h = evidence.run.arrays, model.lines, evidence.h
    if not lines.name:
        return missing(name, why="there is no line", source=source)
    if np.isfinite(lines.gas).any():
        return missing(name, why="a gas exchanges heat with its surroundings",
                       source=source)
    if not evidence.every_step:
        return missing(name, source=source, why=NOT_EVERY_STEP)
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
    # works are those up to the middle of a step, pressures may be those at its end
    half = (lines.compliance * np.abs(p * change)).sum(axis=1)
    step = step + half + half[:2].max(initial=0.0)
    scale = max(float((np.abs(pumps) + np.abs(work) + stored + np.abs(lost)).max(initial=0.0)),
                1e-15)
    error = np.abs(left - left[0])
    worst = int(np.argmax(error - step))
    return judged(
        name, float(error[worst]) / scale, "", EXACT + float(step[worst]) / scale, source=source,
        why="work of pumps minus the work on bodies, the energy stored in fluid and the losses of "
            "valves and reliefs, relative to the total; pressure change in a step times flow is "
            "allowed")
