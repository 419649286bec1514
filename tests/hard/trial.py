"""What a trial is: a mechanism at any step, numbers measured of its run, what is wanted of them."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.expand import expand
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.load import load_scene


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
        return f"{self.measure} at {milliseconds(self.step)}"

    @property
    def steps(self) -> tuple[float, ...]:
        return (self.step,)

    @property
    def wanted(self) -> str:
        return f"at most {self.most:g}"

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
        return f"order of {self.measure} down to {milliseconds(self.steps[1])}"

    @property
    def wanted(self) -> str:
        return f"at least {self.least:g}"

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

    def measure(self, name: str) -> Measure:
        return next(one for one in self.measures if one.name == name)


@dataclass(frozen=True)
class Run:
    """What a run of a trial came to."""

    values: dict[str, float]
    """Of every measure; infinite where the run diverged."""
    seconds: float
    """Wall time of the run itself."""
    note: str = ""
    """How it ended, if not as planned."""


@cache
def carry_out(trial: Trial, step: float) -> Run:
    """The trial at a step [s], once in a process."""
    machine = trial.machine(step)
    began = time.perf_counter()
    try:
        run = simulate(machine)
    except SimulationDiverged as error:
        return Run(dict.fromkeys((one.name for one in trial.measures), math.inf),
                   time.perf_counter() - began, str(error))
    seconds = time.perf_counter() - began
    return Run({one.name: one.of(run) for one in trial.measures}, seconds)


def reached(trial: Trial, target: Target) -> float:
    """What a target's measure comes to."""
    return target.value([carry_out(trial, step).values[target.measure] for step in target.steps])


def full_name(trial: Trial, target: Target) -> str:
    """Such as ``chain_20: tip error at 0.5 ms``."""
    return f"{trial.name}: {target.name}"


def milliseconds(step: float) -> str:
    """0.0005 as ``0.5 ms``."""
    return f"{1e3 * step:g} ms"


def built(scene: dict[str, Any], *, sample_rate: float | None = None) -> Mechanism:
    """A benchmark's scene as a mechanism, with its own or another rate of samples [Hz]."""
    overrides = {"run.sample_rate": sample_rate} if sample_rate else None
    return expand(load_scene(scene, overrides=overrides))


def spell(duration: float, step: float, *, sample_rate: float | None = None,
          **elements: Any) -> Mechanism:
    """A mechanism with the defaults of a run; every step is sampled unless told."""
    run = {"duration": duration, "step": step, "sample_rate": sample_rate or 1 / step}
    return Mechanism.model_validate({"run": run, **elements})
