"""What the controllers of a run lead to what: targets of quantities, drives under control.

A quantity's target over a run comes from the first of these that there is:

1. one that is given by hand;
2. the target of a controller that reads the quantity by its plain name, with
   what events made of it; one that acts from the start before one that does not;
3. a meter named ``<quantity>.target``, such as ``finger.mcp.angle.target``: how a
   scene says where a quantity should go that no controller leads.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.elements.registry import Controller
from sandbox.numeric import Array
from sandbox.samples.response import Response, respond
from sandbox.samples.samples import Samples
from sandbox.values.signals import values

SUFFIX = ".target"
"""Of a meter that holds the target of the quantity before it."""


class Track(NamedTuple):
    """A quantity over a run, from t = 0 where its value there is known."""

    time: Array
    """[s], shape [n] or [n + 1]."""
    value: Array
    """The same shape, SI."""
    target: Array | None
    """The same shape; None without one."""


def track(run: Samples, name: str, goal: Array | None = None) -> Track:
    """A quantity and its target, with the value at t = 0 put before the samples if it is known.

    The first sample belongs to an instant after 0; where a run begins with a
    jolt it has gone some way by then, and a step is counted from its beginning.

    Args:
        run: the recording.
        name: of the quantity.
        goal: its target, shape [n], SI.

    Raises:
        UnknownQuantityError: not in the catalogue.
    """
    begins = start(run, name)
    if begins is None or not len(run) or run.time[0] <= 0:
        return Track(run.time, run[name], goal)
    return Track(np.append(0.0, run.time), np.append(begins, run[name]),
                 None if goal is None else np.append(goal[0], goal))


def start(run: Samples, name: str) -> float | None:
    """The value of a quantity at t = 0 as the scene gives it, SI; None where it does not.

    Known are rotations of hinges, places and angles of bodies, shortenings of
    tendons and values of drives.

    Raises:
        UnknownQuantityError: not in the catalogue.
    """
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
    """Quantity to its target over time, shape [n], SI.

    Args:
        run: the recording.
        given: targets by hand, SI; what the run does not have is left out.
    """
    found: dict[str, Array] = {name: np.full(len(run), value)
                               for name, value in (given or {}).items() if name in run.catalogue}
    for name, target in [*_led(run), *_metered(run)]:
        found.setdefault(name, target)
    return found


def responses(run: Samples, goals: Mapping[str, Array]) -> dict[str, Response]:
    """How each quantity answers to its target, from t = 0 on.

    Args:
        run: the recording.
        goals: quantity to target, shape [n] with n > 1, SI.

    Raises:
        UnknownQuantityError: not in the catalogue.
    """
    found = {}
    for name, goal in goals.items():
        time, value, target = track(run, name, goal)
        if target is not None:
            found[name] = respond(time, value, target)
    return found


def led(run: Samples) -> list[str]:
    """The quantities that controllers lead to targets, in the scene's order."""
    by_controllers = {name for name, _ in _led(run)}
    in_order = [name for c in run.mechanism.controllers for name in _plain_readings(c)]
    return [name for name in dict.fromkeys(in_order) if name in by_controllers]


def controlled(run: Samples) -> list[str]:
    """The drives that controllers set, in the mechanism's order."""
    written = {name for c in run.mechanism.controllers for name in c.written}
    return [drive.name for drive in run.mechanism.drives if drive.name in written]


def initial(run: Samples, drive: str) -> float:
    """What a drive has at t = 0, before anything acts; SI.

    Raises:
        KeyError: no such drive.
    """
    spec = run.mechanism.drives[run.model.names.drive[drive]]
    try:
        return float(values(
            spec.signal(run.mechanism), np.zeros(1), run.mechanism.functions)[0])
    except ValueError:  # such as log(t): what it had first
        return float(run[f"{drive}.value"][0])


def _plain_readings(controller: Controller) -> list[str]:
    """What a controller reads, without the ``=`` before a lone name."""
    return [text.removeprefix("=").strip() for text in controller.readings]


def _led(run: Samples) -> list[tuple[str, Array]]:
    found = []
    for controller in sorted(run.mechanism.controllers, key=lambda c: not c.active):
        pairs = zip(_plain_readings(controller), controller.signals, strict=False)
        for i, (name, signal) in enumerate(pairs):
            if name not in run:
                continue  # an expression of several quantities
            target = values(signal, run.time, run.mechanism.functions)
            # events know one target a controller: its first
            found.append((name, _changed(run, controller.name, target) if i == 0 else target))
    return found


def _changed(run: Samples, controller: str, target: Array) -> Array:
    """A target with what events of the run set it to, and for how long."""
    key = f"{controller}{SUFFIX}"
    events = {event.name: event for event in run.mechanism.events}
    target = target.copy()
    for happened in run.info.events:
        event = events.get(happened.event)
        if event is None or key not in event.set:
            continue
        since = run.time > happened.time
        if event.lasts is not None:
            since &= run.time <= happened.time + event.lasts
        target[since] = event.set[key]
    return target


def _metered(run: Samples) -> list[tuple[str, Array]]:
    return [(meter.name.removesuffix(SUFFIX), run[meter.name]) for meter in run.mechanism.meters
            if meter.name.endswith(SUFFIX) and meter.name.removesuffix(SUFFIX) in run]
