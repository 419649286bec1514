"""What a trial is: a mechanism at any step, numbers measured of its run, what is wanted of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism


@dataclass(frozen=True)
class Measure:
    """A number worked out of a run; 0 is perfect where its name says error."""

    name: str
    unit: str
    of: Callable[[Recording], float]


@dataclass(frozen=True)
class AtMost:
    """A measure may be no larger than this at one step [s]."""

    measure: str
    step: float
    most: float
    why: str

    @property
    def name(self) -> str:
        return f"{self.measure} at {1e3 * self.step:g} ms"

    @property
    def steps(self) -> tuple[float, ...]:
        return (self.step,)

    def value(self, found: Sequence[float]) -> float:
        return found[0]

    def holds(self, value: float) -> bool:
        return math.isfinite(value) and value <= self.most


@dataclass(frozen=True)
class Order:
    """A measure must fall with this power of the step, from the first of two to the second."""

    measure: str
    steps: tuple[float, float]
    least: float
    why: str

    @property
    def name(self) -> str:
        return f"order of {self.measure} down to {1e3 * self.steps[1]:g} ms"

    def value(self, found: Sequence[float]) -> float:
        """log of the errors' ratio over log of the steps'; nan if a run diverged."""
        if not all(math.isfinite(error) and error > 0 for error in found):
            return math.nan
        return math.log(found[0] / found[1]) / math.log(self.steps[0] / self.steps[1])

    def holds(self, value: float) -> bool:
        return math.isfinite(value) and value >= self.least


Target = AtMost | Order


@dataclass(frozen=True, eq=False)
class Trial:
    """A mechanism, what is measured of it, and what that must come to."""

    name: str
    what: str
    machine: Callable[[float], Mechanism]
    """The mechanism at a step [s]."""
    measures: tuple[Measure, ...]
    targets: tuple[Target, ...]


@cache
def measure(trial: Trial, step: float) -> dict[str, float]:
    """Every measure of the trial at a step [s]; infinite if the simulation diverges."""
    try:
        run = simulate(trial.machine(step))
    except SimulationDiverged:
        return dict.fromkeys((one.name for one in trial.measures), math.inf)
    return {one.name: one.of(run) for one in trial.measures}


def full_name(trial: Trial, target: Target) -> str:
    """Such as ``chain_20: tip error at 0.5 ms``."""
    return f"{trial.name}: {target.name}"


def spell(duration: float, step: float, *, sample_rate: float | None = None,
          **elements: Any) -> Mechanism:
    """A mechanism with the defaults of a run; every step is sampled unless told."""
    run = {"duration": duration, "step": step, "sample_rate": sample_rate or 1 / step}
    return Mechanism.model_validate({"run": run, **elements})
