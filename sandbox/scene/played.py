"""Recorded actions of an interactive run, and a scene that repeats them bit by bit.

Settings become events, pushes become force drives with tables of their forces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count

from sandbox.elements.drives import ForceDrive
from sandbox.elements.element import NAMED
from sandbox.elements.registry import Drive
from sandbox.scene.check.control import check_control
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.settings import Event
from sandbox.values.paths import parse_path

HAND = "hand"  # begins the names of force drives, before a number, x and y
PLAYED = "played"  # begins the names of events, before a number


@dataclass(frozen=True)
class Setting:
    """A new value of a drive, or of a controller's target or switch."""

    step: int  # number of steps before it
    name: str  # as in the set of an event
    value: float  # in SI


@dataclass(frozen=True)
class Nudge:
    """A force at a point of a body from a step on, until the next one."""

    step: int  # number of steps before it
    body: str  # its name
    at: tuple[float, float]  # the point in the body's frame [m]
    force: tuple[float, float]  # in the world [N]


Input = Setting | Nudge


def played(scene: Mechanism, inputs: Sequence[Input], steps: int) -> Mechanism:
    """A scene with actions as events and force drives, for a number of steps.

    It has no expectations, and no events of ``scene`` that cannot happen any more.
    """
    run = scene.run.model_copy(update={"duration": steps * scene.run.step})
    inputs = [each for each in inputs if each.step < steps]
    names = _free_names(scene, PLAYED)
    settings = [Event(name=next(names), at=each.step * run.step, set={each.name: each.value})
                for each in inputs if isinstance(each, Setting)]
    made = scene.model_copy(update={
        "name": f"{scene.name}_{PLAYED}" if scene.name else PLAYED, "run": run, "expect": (),
        "events": (*scene.events, *settings),
        "drives": (*scene.drives, *pushing_drives(scene, [
            each for each in inputs if isinstance(each, Nudge)]))})
    late = {parse_path(problem.path)[1] for problem in check_control(made, lambda name: False)}
    return made.model_copy(update={"events": tuple(
        event for i, event in enumerate(made.events) if i not in late)})


def pushing_drives(scene: Mechanism, pushes: Sequence[Nudge]) -> list[Drive]:
    """Two force drives for each pushed point."""
    h, names = scene.run.step, _free_names(scene, HAND)
    forces: dict[tuple[str, tuple[float, float]], dict[int, tuple[float, float]]] = {}
    before: tuple[str, tuple[float, float]] | None = None
    for each in pushes:
        point = each.body, each.at
        if before is not None and before != point:
            forces[before][each.step] = 0.0, 0.0
        forces.setdefault(point, {0: (0.0, 0.0)})[each.step] = each.force
        before = point
    drives: list[Drive] = []
    for (body, at), over in forces.items():
        name = next(names)
        for axis, direction in enumerate(((1.0, 0.0), (0.0, 1.0))):
            table = [[step * h, force[axis]] for step, force in over.items()]
            table = [row for i, row in enumerate(table) if not i or row[1] != table[i - 1][1]]
            drives.append(ForceDrive.model_validate({
                "type": "force", "name": f"{name}.{'xy'[axis]}", "body": body, "at": at,
                "direction": direction, "value": {"table": table, "between": "step"}}))
    return drives


def _free_names(scene: Mechanism, stem: str) -> Iterator[str]:
    """Names of a stem and a number that no element has or begins with."""
    taken = {each.name.partition(".")[0] for kind in NAMED for each in getattr(scene, kind)}
    return (name for number in count(1) if (name := f"{stem}{number}") not in taken)


