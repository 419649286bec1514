"""What a benchmark is: a published problem as a scene, digits to be met, and how far off is right.

An error of order p is at most scale (rate h)^p: ``rate`` the fastest rate in the mechanism,
``scale`` how far what is compared has gone, both from the problem's own numbers, so that no
tolerance is fitted to what the engine does. What is exact has no error but its floor.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.convergence.runs import at_instants
from sandbox.engine.simulate import simulate
from sandbox.engine.simulation import Simulation
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.document import Scene
from sandbox.scene.read.load import load_scene
from sandbox.study.orders import EXACT
from sandbox.verification.cases.case import Check

Json = dict[str, Any]
MARGIN = 0.3
"""Of an order between two steps: the next term of the error, C' h^(p+1), at these steps."""
TIMED, LONG = 5, 1.0
"""Runs of which the shortest counts, unless so many seconds have gone before."""


@dataclass(frozen=True)
class Digit:
    """One number that is published or known in closed form."""

    what: str
    expected: float
    found: Callable[[Recording], float]
    """The same of a run."""


def at(quantity: str, instant: float, expected: float, what: str = "") -> Digit:
    """A recorded quantity at an instant [s], by the cubic of the four nearest samples."""

    def found(run: Recording) -> float:
        return float(at_instants(run.time, run[quantity], np.array([instant]))[0])

    return Digit(what or f"{quantity} at {instant:g} s", expected, found)


def lag(amplitude: float, rate: float, duration: float) -> float:
    """Scale of a vibration: after ``duration`` [s] its phase is (rate h)^2 / 24 of its angle off.

    The step that the engine makes keeps cos(ω' h) = 1 - (ω h)^2 / 2, so ω' = ω (1 + (ω h)^2 / 24).
    """
    return amplitude * rate * duration / 24


@dataclass(frozen=True)
class Criterion:
    """Digits of one kind, whose largest error counts."""

    what: str
    unit: str
    digits: Sequence[Digit]
    scale: float
    """How far it goes, in the unit."""
    rate: float
    """The fastest rate in the mechanism [1/s], of which a step is to be small."""
    why: str
    """Where scale and rate come from; for what is exact, the floor."""
    order: float | None = 2.0
    """Looked for; ``EXACT`` if only the floor may be left, None if errors have none."""
    floor: float = 0.0
    """Error of rounding and of the digits given, in the unit."""
    steady: bool = True
    """Whether errors fall evenly; not if they hang on where in its step something happens."""

    def allowed(self, step: float) -> float:
        """Largest error that is right at a step [s], in the unit."""
        if self.order == EXACT:
            return self.floor
        power: float = (self.rate * step)**(self.order or 1.0)
        return self.scale * power + self.floor

    def found(self, run: Recording) -> list[float]:
        """All digits as a run has them."""
        return [digit.found(run) for digit in self.digits]

    def error(self, found: Sequence[float]) -> float:
        """Largest error of what was found; nan if anything is no number."""
        expected = [digit.expected for digit in self.digits]
        return float(np.abs(np.array(found) - np.array(expected)).max())


@dataclass(frozen=True)
class Benchmark:
    """A published problem."""

    name: str
    title: str
    problem: str
    """What it is, in a sentence or two."""
    source: str
    """Where it is from, and where its digits are."""
    differs: str
    """What is not as in the source, and why."""
    scene: Callable[[float], Json]
    """The scene at a step [s], as its file would hold it; :func:`spelled` does most."""
    steps: Sequence[float]
    """Three, for the page [s]."""
    criteria: Sequence[Criterion]
    fault: Mapping[str, float]
    """A fault that must be noticed: values of the scene, by path, that are not the problem's."""
    quick: Sequence[float] = field(default=())
    """Two, for the tests [s]; by default the first two of ``steps``."""
    drawn: str = ""
    """Its first criterion's name in the picture of smooth motion; empty if it is not there."""

    @property
    def tested(self) -> Sequence[float]:
        """Steps of the tests [s]."""
        return self.quick or self.steps[:2]


@dataclass(frozen=True)
class BenchmarkRuns:
    """What came of a benchmark."""

    benchmark: Benchmark
    steps: Sequence[float]
    errors: Sequence[Sequence[float]]
    """Of each criterion, at each step."""
    found: Sequence[Sequence[float]]
    """Each criterion's digits as they came out at the finest step."""
    seconds: Sequence[float] = ()
    """CPU time of the steps alone, at each step [s]; empty if not measured."""

    @property
    def ok(self) -> bool:
        """Whether every check holds."""
        return all(check.ok for check in self.checks)

    @property
    def checks(self) -> list[Check]:
        """Every error against what is allowed, and every order."""
        return [check for i in range(len(self.errors))
                for check in (*self._sizes(i), *self._falls(i))]

    def orders(self, criterion: int) -> list[float]:
        """From each step to the next, log(e1/e2) / log(h1/h2); nan where there is none."""
        one, errors = self.benchmark.criteria[criterion], self.errors[criterion]
        if one.order in (EXACT, None) or not one.steady:
            return [np.nan] * (len(errors) - 1)
        with np.errstate(divide="ignore", invalid="ignore"):
            return [float(np.log(a / b) / np.log(h / k))
                    for (h, k), (a, b) in zip(pairwise(self.steps), pairwise(errors), strict=True)]

    def _sizes(self, i: int) -> list[Check]:
        one = self.benchmark.criteria[i]
        return [Check(f"largest error of {one.what} at h = {spoken(step)}", one.unit, 0.0,
                      error, one.allowed(step), one.why)
                for step, error in zip(self.steps, self.errors[i], strict=True)]

    def _falls(self, i: int) -> list[Check]:
        one = self.benchmark.criteria[i]
        if one.order in (EXACT, None) or not one.steady:
            return []
        return [Check(f"order of {one.what} from h = {spoken(h)} to {spoken(k)}", "1",
                      one.order, order, MARGIN if order < one.order else 4.0,
                      "the next term of the error may make it less; more is no fault")
                for (h, k), order in zip(pairwise(self.steps), self.orders(i), strict=True)
                if self.errors[i][self.steps.index(k)] > one.floor]


def spelled(until: float, step: float, *, sample_rate: float | None = None, **more: Any) -> Json:
    """A scene that runs four steps beyond ``until`` [s], so that digits there can be read.

    Every step is sampled unless told.
    """
    return {"run": {"duration": until + 4 * step, "step": step,
                    "sample_rate": sample_rate or 1 / step}, **more}


def carry_out(benchmark: Benchmark, steps: Sequence[float] = (), *, timed: bool = False,
              overrides: Mapping[str, float] | None = None) -> BenchmarkRuns:
    """Run a benchmark at ``steps`` [s], by default those of its page.

    Args:
        benchmark: the problem.
        steps: coarsest first.
        timed: measure the time of the steps, too.
        overrides: values of the scene that are not the problem's, by path.
    """
    steps, errors, found, seconds = steps or benchmark.steps, [], [[0.0]], []
    for step in steps:
        scene = load_scene(benchmark.scene(step), overrides=overrides)
        found = _found(benchmark, scene)
        errors.append([one.error(values) for one, values in zip(
            benchmark.criteria, found, strict=True)])
        if timed:
            seconds.append(_cpu(scene) if math.isfinite(found[0][0]) else math.nan)
    return BenchmarkRuns(benchmark, steps, list(zip(*errors, strict=True)), found, seconds)


def _found(benchmark: Benchmark, scene: Scene) -> list[list[float]]:
    """Every criterion's digits of a run; infinite if it diverges."""
    try:
        run = simulate(scene)
    except SimulationDiverged:
        return [[math.inf] * len(one.digits) for one in benchmark.criteria]
    return [one.found(run) for one in benchmark.criteria]


def _cpu(scene: Scene) -> float:
    """Least CPU time of the scene's steps [s], with a sample at the end only."""
    run = scene.run.model_copy(update={"sample_rate": 1 / scene.run.duration})
    bare, spent = scene.model_copy(update={"run": run}), [float("inf")]
    began = time.perf_counter()
    while len(spent) <= TIMED and (len(spent) == 1 or time.perf_counter() - began < LONG):
        simulation = Simulation(bare)
        start = time.process_time()
        simulation.run()
        spent.append(time.process_time() - start)
    return min(spent)


def spoken(seconds: float) -> str:
    """Three digits in s, ms or µs: 0.0005 as ``0.5 ms``."""
    factor, unit = next((one for one in ((1.0, "s"), (1e3, "ms")) if seconds * one[0] > 0.0999),
                        (1e6, "µs"))
    return f"{float(f'{factor * seconds:.3g}'):g} {unit}"
