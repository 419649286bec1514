"""Drives and events that do nothing, or ask for what cannot be."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_words import NEGLIGIBLE, deg, look, mm
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.values.signals import values

INSTANTS = 257
"""Of a run, at which a length or an angle that is asked for is looked at."""


def idle_problems(model: Model) -> Iterator[Problem]:
    """All of them."""
    yield from _taken_up(model)
    yield from _let_go(model)
    for i, kind in enumerate(model.drives.kind):
        target = int(model.drives.target[i])
        if kind.gives == "surface" and not model.mechanism.bodies[target].shapes:
            yield look("no-effect", f"$.drives[{i}].body", model.drives.name[i],
                       f"{model.bodies.name[target]} has no shapes, so it has no surface to drive",
                       "a shape of that body")
        if kind.gives == "push" and kind.places:
            yield from _stroke(model, i)
        if kind.gives == "torque" and kind.places:
            yield from _turn(model, i)


def _taken_up(model: Model) -> Iterator[Problem]:
    """What an event takes up though nothing lets it go."""
    ties, events = model.ties, model.mechanism.events
    loose = {ties.name[tie] for tie in np.flatnonzero(
        ~ties.held | np.isfinite(ties.breaks_at) | (ties.drive >= 0))}
    loose |= {name for event in events for name in event.release}
    for i, event in enumerate(events):
        for j, name in enumerate(event.take_up):
            if name not in loose:
                yield look("no-effect", f"$.events[{i}].take_up[{j}]", event.name,
                           f"takes up {name}, which no event releases",
                           "an event or drive that releases it, 'breaks_at' or 'released'")


def _let_go(model: Model) -> Iterator[Problem]:
    """Drives of joints that are let go all the time."""
    ties, drives = model.ties, model.drives
    taken = {name for event in model.mechanism.events
             for name in (*event.take_up, *(event.release if event.lasts is not None else ()))}
    for i, kind in enumerate(drives.kind):
        if kind.target.among != "joints":
            continue
        tie = int(ties.joint[drives.target[i]])
        if not ties.begins(tie) and ties.drive[tie] < 0 and ties.name[tie] not in taken:
            yield look("no-effect", f"$.drives[{i}]", drives.name[i],
                       f"acts on {ties.name[tie]}, which is released from the start and never "
                       "taken up", "an event or a drive that takes it up")


def _stroke(model: Model, i: int) -> Iterator[Problem]:
    """A length that is asked for beyond the ends of stroke."""
    joint, asked = int(model.drives.target[i]), _asked(model, i)
    name, (shortest, longest) = model.joints.name[joint], model.joints.reach[joint].tolist()
    for length, bound, beyond, end in ((asked.max(), longest, 1.0, "most"),
                                       (asked.min(), shortest, -1.0, "least")):
        if beyond * (length - bound) > NEGLIGIBLE:
            yield look("outside-limits", f"$.drives[{i}].value", model.drives.name[i],
                       f"sets {name} to {mm(length)}, but it is {mm(bound)} long at {end}",
                       "a length within its stroke")


def _turn(model: Model, i: int) -> Iterator[Problem]:
    """An angle that is asked for beyond the limits of its hinge."""
    joint, asked = int(model.drives.target[i]), _asked(model, i)
    low, high = model.joints.stops[joint].tolist()
    for angle, over in ((asked.max(), asked.max() - high), (asked.min(), low - asked.min())):
        if over > NEGLIGIBLE:
            unit = (f"; a number by itself is in rad: for degrees write \"{angle:.4g} deg\""
                    if abs(angle) > math.tau else "")
            yield look("outside-limits", f"$.drives[{i}].value", model.drives.name[i],
                       f"sets {model.joints.name[joint]} to {deg(angle)}, but its limits are "
                       f"[{deg(low)}, {deg(high)}]", f"an angle within them{unit}")


def _asked(model: Model, i: int) -> Array:
    """What a drive asks for at some instants of the run, in the unit of its value."""
    mechanism = model.mechanism
    return values(mechanism.drives[i].signal(mechanism),
                  np.linspace(0.0, mechanism.run.duration, INSTANTS), mechanism.functions)
