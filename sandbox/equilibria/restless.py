"""What never rests, and what is left out where a scene's equilibrium is looked for."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.equilibria.search import Search
from sandbox.errors import Problem, SceneError
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import quoted

LATE = 0.01
"""Share of the run before its end in which drives that change are told."""


def refuse(mechanism: Mechanism) -> None:
    """Refuse what has no equilibrium of its own.

    Raises:
        SceneError: controllers; events that act at a time.
    """
    found = [Problem("no-rest",
                     f"the controller {quoted(each.name)} acts as the run goes on, and rest has no "
                     "time", f"$.controllers[{i}]",
                     allowed="drives that hold the values it leads to: take the controller out and "
                             "set these")
             for i, each in enumerate(mechanism.controllers)]
    found += [Problem("no-rest",
                      f"the event {quoted(each.name)} acts at t = {each.at:g} s, and rest has no "
                      "time", f"$.events[{i}]", allowed="a scene in which it has happened")
              for i, each in enumerate(mechanism.events)
              if each.at is not None and each.at <= mechanism.run.duration
              and (each.set or each.release or each.take_up)]
    if found:
        raise SceneError(found)


def remarks(mechanism: Mechanism, search: Search, at: float | None) -> Iterator[str]:
    """What is to be known of how a scene was read: drives that still change, events left out."""
    for event in mechanism.events:
        if event.when is not None and (event.set or event.release or event.take_up):
            yield f"the event {quoted(event.name)} is left out: it acts on the way"
    if search.lost:
        yield search.lost
    if at is not None or not search.time:
        return
    before, places = search.still.driven((1 - LATE) * search.time)
    changes = np.flatnonzero(before != search.drive)
    for i in changes.tolist():
        yield (f"the drive {quoted(mechanism.drives[i].name)} still changes at the end: it is held "
               f"at its value at t = {search.time:g} s")
    for body in search.still.scheduled[np.any(places != search.places, axis=1)].tolist():
        yield (f"{quoted(mechanism.bodies[body].name)} still moves at the end: it is held where it "
               f"is at t = {search.time:g} s")
