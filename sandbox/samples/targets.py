"""Targets of quantities, drives under control, and step responses (docs/plots.md).

The target of a quantity over a run is the first of these that there is: one given by hand; that of
a controller that reads the quantity by its plain name, as events changed it, active controllers
first; a meter named ``<quantity>.target``, such as ``finger.mcp.angle.target``.

Definitions of responses are those of Franklin, Powell and Emami-Naeini, *Feedback Control of
Dynamic Systems*, section 3.4.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sandbox.elements.registry import Controller
from sandbox.numeric import Array
from sandbox.samples.samples import Samples
from sandbox.values.signals import values

SUFFIX = ".target"  # Of a meter that holds the target of the quantity before it


def track(run: Samples, name: str, goal: Array | None = None) -> tuple[Array, Array, Array | None]:
    """Instants [s], a quantity and its target, from t = 0 where the value there is known."""
    begins = start(run, name)
    if begins is None or run.time[0] <= 0:
        return run.time, run[name], goal
    return (np.append(0.0, run.time), np.append(begins, run[name]),
            None if goal is None else np.append(goal[0], goal))


def start(run: Samples, name: str) -> float | None:
    """The value of a quantity at t = 0 as the scene gives it, SI; None where it does not."""
    bodies, joints, source = run.model.bodies, run.model.joints, run.catalogue.find(name)
    match source.kind, source.quantity:
        case "tendon", "shortening":
            return 0.0
        case "drive", "value":
            return initial(run, run.model.drives.name[source.index])
        case "body", "x" | "y" | "angle" if not bodies.scheduled[source.index]:
            return float(bodies.pose[source.index, ("x", "y", "angle").index(source.quantity)])
        case "joint", "angle" if not bodies.scheduled[joints.bodies[source.index]].any():
            return float(joints.start[source.index])
    return None


def targets(run: Samples, given: Mapping[str, float] | None = None) -> dict[str, Array]:
    """Quantity to its target over time [n], SI; ``given`` are targets by hand."""
    found = {name: np.full(len(run), value)
             for name, value in (given or {}).items() if name in run.catalogue}
    for controller in sorted(run.mechanism.controllers, key=lambda each: not each.active):
        for name, target in _tracked(run, controller):
            found.setdefault(name, target)
    for meter in run.mechanism.meters:
        name = meter.name.removesuffix(SUFFIX)
        if name != meter.name and name in run:
            found.setdefault(name, run[meter.name])
    return found


def response(run: Samples, name: str, goal: Array) -> Response:
    """The response of a quantity to its target [n], n > 1, from t = 0 on."""
    time, value, target = track(run, name, goal)
    assert target is not None
    return respond(time, value, target)


def tracked(run: Samples) -> list[str]:
    """The quantities for which controllers have targets, in the scene's order."""
    return list(dict.fromkeys(name for controller in run.mechanism.controllers
                              for name, _ in _tracked(run, controller)))


def controlled(run: Samples) -> list[str]:
    """The drives that controllers set, in the mechanism's order."""
    written = {name for c in run.mechanism.controllers for name in c.written}
    return [drive.name for drive in run.mechanism.drives if drive.name in written]


def initial(run: Samples, drive: str) -> float:
    """The value of a drive at t = 0, before anything acts; SI."""
    spec = run.mechanism.drives[run.model.names.drive[drive]]
    try:
        return float(values(spec.signal(run.mechanism), np.zeros(1), run.mechanism.functions)[0])
    except ValueError:  # such as log(t): what it had first
        return float(run[f"{drive}.value"][0])


def _tracked(run: Samples, controller: Controller) -> Iterator[tuple[str, Array]]:
    """The quantities that a controller reads by their plain names, and their targets."""
    for i, (text, signal) in enumerate(zip(controller.readings, controller.signals, strict=False)):
        name = text.removeprefix("=").strip()
        if name in run:  # else an expression of several quantities
            target = values(signal, run.time, run.mechanism.functions).copy()
            key = f"{controller.name}{SUFFIX}"  # events set the first target of a controller
            events = {event.name: event for event in run.mechanism.events
                      if i == 0 and key in event.set}
            for happened in run.info.events:
                if event := events.get(happened.event):
                    lasts = math.inf if event.lasts is None else event.lasts
                    target[(run.time > happened.time)
                           & (run.time <= happened.time + lasts)] = event.set[key]
            yield name, target


BAND = 0.02  # Half the width of the band that counts as settled, as a fraction of the target
LAST = 0.05  # The fraction of a run that counts as its end


@dataclass(frozen=True)
class Response:
    """The response of a quantity to its target; SI."""

    start: float  # The first value: where the step to the target begins
    final: float  # The mean of the end of the run
    target: float  # The last one
    overshoot: float  # [%] of the step; nan where there was no step to make
    settling: float  # [s]; inf where it never settles
    steady_error: float
    iae: float  # In the quantity's unit times seconds


@dataclass(frozen=True)
class Effort:
    """The control effort of a drive, in its unit."""

    variation: float  # The sum of all changes, up and down
    peak: float  # Largest magnitude
    rate: float  # Largest change from one sample to the next, per second: jumps count by sampling


def respond(time: Array, value: Array, target: Array) -> Response:
    """All figures of one response to a target, which may move."""
    end, first, goal = ending(time), float(value[0]), float(target[-1])
    overshoot = math.nan if goal == first else float(
        100 * max(0.0, np.max((value - goal) / (goal - first))))
    return Response(
        start=first, final=float(np.mean(value[end])), target=goal, overshoot=overshoot,
        settling=settling_time(time, value, target),
        steady_error=float(np.mean(value[end] - target[end])),
        iae=float(np.trapezoid(np.abs(value - target), time)))


def settling_time(time: Array, value: Array, target: Array) -> float:
    """The last time outside the band about the target [s], interpolated between two samples.

    0 if it never was outside, inf if it was in the last 5 % of the run; no value counts as outside.
    """
    error, band = value - target, BAND * abs(float(target[-1]) or float(value[0]))
    outside = np.flatnonzero(~(np.abs(error) <= band))
    if not len(outside):
        return 0.0
    last = int(outside[-1])
    if last >= ending(time).start:
        return math.inf
    before, after = float(error[last]), float(error[last + 1])
    if not math.isfinite(before):
        return float(time[last])
    part = (abs(before) - band) / abs(before - after)
    return float(time[last] + part * (time[last + 1] - time[last]))


def effort(time: Array, value: Array, before: float) -> Effort:
    """The control effort of a drive over a run; ``before`` is its value before the first sample."""
    changes = np.abs(np.diff(value, prepend=before))
    spacing = np.diff(time, prepend=2 * time[0] - time[1])
    return Effort(variation=float(changes.sum()), peak=float(np.max(np.abs(value))),
                  rate=float(np.max(changes / spacing)))


def ending(time: Array) -> slice:
    """The samples of the last 5 % of a run, at least one."""
    since = time[-1] - LAST * (time[-1] - time[0])
    return slice(int(np.searchsorted(time, since)), len(time))
