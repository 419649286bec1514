"""What a run would take, by a mechanism's size alone: seconds, and bytes of its recording.

Nothing is timed, so that the same scene is estimated, and refused, alike on every machine. The
cost of a step is a sum over what is solved in it. The proportions of its terms were fitted to
runs of 1000 steps of 38 mechanisms: shipped scenes, chains of 5 to 200 links, free and resting
discs, stacks of boxes, hands of up to 32 fingers; their size to the shipped scenes, of which
simulation and files take 0.4 to 1.5 times as much on a core of a server. What it cannot know is
how much touches when, and how: 200 boxes that fall on one another took 10 times as long. Another
machine is another factor. Pictures and the audit are left out.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from sandbox.elements.arrays import CONTACT as CONTACT_ROW
from sandbox.elements.arrays import MEAN, MEAN_CONTACT, PER_SAMPLE, row_bytes
from sandbox.elements.controllers.controller import every
from sandbox.engine.clock import Clock, make_clock
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.numeric import Flags
from sandbox.scene.read.limits import Limits, over

STEP = 3e-6
"""A step of nothing [s]."""
BODY, ROW, GUIDE, SPRING, DRIVE = 0.12e-6, 0.25e-6, 0.12e-6, 0.6e-6, 0.35e-6
"""For each body, row of a joint, guide of a cord or chamber, spring, line,
valve or load, drive [s]."""
CONTACT, CONTACTS = 0.25e-6, 2e-9
"""For each contact, and for each pair of contacts, which may hang on one another [s]."""
ACT = 12e-6
"""A controller acts, or a condition is looked at [s]."""
NUMBER = 0.25e-6
"""Eight bytes are recorded, and written into two files [s]."""
ROWS = {"point": 2, "groove": 1, "distance": 1, "range": 1, "gear": 1, "rack": 1, "roll": 2}
"""Of joints, by what they keep."""


@dataclass(frozen=True)
class Estimate:
    """What a run would take."""

    steps: int
    samples: int
    contacts: int
    """In every sample, as assumed: one for each free body with shapes, or as many pairs as are
    near each other at t = 0 if that is more; no more than pairs that may touch."""
    seconds: float
    recorded_bytes: int
    """Contacts included."""

    def __str__(self) -> str:
        return (f"would take about {_time(self.seconds)} and {_size(self.recorded_bytes)} "
                f"({_count(self.steps)}, {_count(self.samples, 'sample')})")

    @property
    def data(self) -> dict[str, float]:
        """The same as JSON data."""
        return {"steps": self.steps, "samples": self.samples, "contacts": self.contacts,
                "seconds": float(f"{self.seconds:.2g}"),
                "recorded_bytes": self.recorded_bytes}

    def beyond(self, limits: Limits) -> Iterator[Problem]:
        """Time and room that are more than the limits allow."""
        yield from over(limits, "seconds", self.seconds, "$.run", "the run would take about "
                        f"{_time(self.seconds)}, {{count}} s")
        yield from over(
            limits, "recorded_bytes", self.recorded_bytes, "$.run.sample_rate", "the recording "
            f"would take about {{count}} bytes with {self.contacts} contacts in each sample")


def estimate(model: Model, allowed: Flags, *, near: int) -> Estimate:
    """What a run of a mechanism would take.

    Args:
        model: the mechanism.
        allowed: pairs of bodies that may touch, [nb, nb].
        near: pairs of bodies that may touch and are together at t = 0.
    """
    run = model.mechanism.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    shaped = np.array([bool(body.shapes) for body in model.mechanism.bodies], dtype=bool)
    may = allowed & shaped & shaped[:, None]
    touching = int(np.count_nonzero(may.any(axis=1) & model.bodies.free))
    contacts = min(max(touching, near), int(np.count_nonzero(may)) // 2)
    sample, contact = list(PER_SAMPLE), list(CONTACT_ROW)
    if clock.every > 1:
        sample, contact = [*sample, *MEAN], [*contact, *MEAN_CONTACT]
    size = clock.samples * (row_bytes(model.mechanism, sample)
                            + contacts * row_bytes(model.mechanism, contact))
    seconds = (clock.steps * _step(model, contacts) + ACT * _acts(model, clock)
               + NUMBER * size / 8)
    return Estimate(clock.steps, clock.samples, contacts, seconds, size)


def _step(model: Model, contacts: int) -> float:
    """Seconds of a step."""
    rows = sum(ROWS[kind.keeps] for kind in model.joints.kind)
    return (STEP + BODY * len(model.bodies.name) + ROW * rows
            + GUIDE * (len(model.tendons.guide_body) + len(model.lines.gain))
            + SPRING * (len(model.springs.name) + len(model.lines.name) + len(model.valves.name)
                        + len(model.loads.name))
            + DRIVE * len(model.drives.name) + CONTACT * contacts + CONTACTS * contacts**2)


def _acts(model: Model, clock: Clock) -> float:
    """How often controllers act and conditions are looked at."""
    rates = [law.rate for law in model.mechanism.controllers]
    rates += [event.rate for event in model.mechanism.events if event.when is not None]
    return sum(clock.steps / every(rate, clock.step) for rate in rates)


def _time(seconds: float) -> str:
    for most, size, name in ((100, 1, "s"), (6000, 60, "min"), (360_000, 3600, "h")):
        if seconds < most:
            return f"{max(seconds / size, 0.01):.2g} {name}"
    return f"{seconds / 86400:.2g} days"


def _size(size: float) -> str:
    for unit in ("kB", "MB"):
        size /= 1000
        if size < 999.5:
            return f"{max(size, 1):.3g} {unit}"
    return f"{size / 1000:.3g} GB"


def _count(number: int, what: str = "step") -> str:
    return f"{number:,} {what}{'' if number == 1 else 's'}".replace(",", " ")
