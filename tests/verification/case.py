"""Verification cases: a decorator that makes a pytest function of one, and what a case checks.

A case is a generator function of :class:`Check`; a benchmark is a published problem that runs at
several steps. ``docs/make_validation.py`` writes the page "Validation" from :data:`CASES`.

An error of order p is at most scale (rate h)^p: ``rate`` is the fastest rate in the mechanism,
``scale`` the range of what is compared. Both follow from the problem, so that no tolerance is
fitted to results.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import ArrayLike

from sandbox.convergence.certificate import at_instants
from sandbox.engine.simulate import simulate
from sandbox.errors import SimulationDiverged
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from tests.support.mechanisms import Json

STEPS = (1e-3, 5e-4, 2.5e-4)
"""Steps of most studies of accuracy [s]."""
EXACT = math.inf
"""Order of a result that has rounding errors only."""
MARGIN = 0.3
"""Allowed shortfall of an order between two steps: the next term of the error, C' h^(p+1)."""


@dataclass(frozen=True)
class Check:
    """Measured values against reference values, elementwise."""

    what: str
    unit: str
    expected: ArrayLike
    found: ArrayLike
    allowed: ArrayLike
    """Largest error that passes, in the unit."""
    why: str
    """Derivation of ``allowed``."""

    @property
    def ok(self) -> bool:
        """Whether all errors are within the tolerance; False for NaN."""
        return bool(np.all(np.abs(np.subtract(self.found, self.expected)) <= self.allowed))

    @property
    def worst(self) -> tuple[float, float, float]:
        """Reference, measured value and tolerance where the error is largest by its tolerance."""
        e, f, a = (np.ravel(each) for each in np.broadcast_arrays(
            self.expected, self.found, np.asarray(self.allowed, dtype=float)))
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(f == e, 0.0, np.abs(f - e) / a)
        i = int(np.argmax(np.nan_to_num(share, nan=math.inf, posinf=math.inf)))
        return float(e[i]), float(f[i]), float(a[i])

    def __str__(self) -> str:
        e, f, a = self.worst
        return f"{self.what}: {f:.9g} instead of {e:.9g} {self.unit}, tolerance {a:.2g}: {self.why}"


@dataclass(frozen=True)
class Case:
    """A verification case as the page "Validation" shows it."""

    name: str
    title: str
    equation: str
    scene: str
    source: str
    run: Callable[[], Iterator[Check]]
    module: str


CASES: dict[str, Case] = {}
"""All cases of the imported test modules by name."""


def case(title: str, equation: str, scene: str) -> Callable[[Callable[[], Iterator[Check]]],
                                                            Callable[[], None]]:
    """Register a generator of checks as a case; pytest gets a function that runs it."""
    def register(run: Callable[[], Iterator[Check]]) -> Callable[[], None]:
        name = run.__name__.removeprefix("test_")
        CASES[name] = Case(name, title, equation, scene, "", run, run.__module__)

        def test() -> None:
            assert_all(run())

        test.__name__, test.__doc__ = run.__name__, run.__doc__
        return test

    return register


def assert_all(checks: Iterator[Check]) -> None:
    """Fail with all checks that do not hold."""
    found = list(checks)
    assert found
    assert [str(check) for check in found if not check.ok] == []


class Digit(NamedTuple):
    """A published or exact number, and how to read it from a recording."""

    expected: float
    found: Callable[[Recording], float]


def at(quantity: str, instant: float, expected: float) -> Digit:
    """A recorded quantity at an instant [s], by the cubic of the four nearest samples."""
    return Digit(expected, lambda run: float(
        at_instants(run.time, run[quantity], np.array([instant]))[0]))


@dataclass(frozen=True)
class Criterion:
    """Digits of one kind with a common tolerance scale (rate h)^order + floor."""

    what: str
    unit: str
    digits: Sequence[Digit]
    why: str
    """Derivation of scale and rate, or of the floor."""
    scale: float = 1.0
    rate: float = 1.0
    order: float = 2.0
    floor: float = 0.0
    """Rounding errors and missing digits of the reference, in the unit."""
    falls: bool = True
    """Whether errors fall evenly with the step."""

    def checks(self, steps: Sequence[float], found: Sequence[Sequence[float]]) -> Iterator[Check]:
        """Errors at every step, and the order from each step to the next."""
        expected = [digit.expected for digit in self.digits]
        for step, values in zip(steps, found, strict=True):
            power = 0.0 if self.order == EXACT else self.scale * (self.rate * step)**self.order
            yield Check(f"{self.what}, h = {1e3 * step:g} ms", self.unit, expected, values,
                        power + self.floor, self.why)
        if self.falls and self.order != EXACT:
            errors = [np.abs(np.subtract(values, expected)).max() for values in found]
            for (h, k), (a, b) in zip(pairwise(steps), pairwise(errors), strict=True):
                if b > self.floor:
                    yield order_check(self.what, self.order, h, k, a, b)


def event(what: str, unit: str, digits: Sequence[Digit], rate: float, why: str, *,
          scale: float = 1.0, floor: float = 0.0) -> Criterion:
    """Criterion of events within a step: first order, errors that do not fall evenly."""
    return Criterion(what, unit, digits, why, scale, rate, 1.0, floor, falls=False)


def exact(what: str, unit: str, digits: Sequence[Digit], floor: float, why: str) -> Criterion:
    """Criterion of results that do not depend on the step."""
    return Criterion(what, unit, digits, why, order=EXACT, floor=floor)


def order_check(what: str, theory: float, h: float, k: float, a: float, b: float) -> Check:
    """Order log(a/b) / log(h/k) of errors ``a`` at step ``h`` and ``b`` at step ``k`` [s]."""
    with np.errstate(divide="ignore", invalid="ignore"):
        order = float(np.log(a / b) / np.log(h / k))
    return Check(f"order of accuracy of {what}, {1e3 * h:g} to {1e3 * k:g} ms", "1", theory, order,
                 MARGIN if order < theory else 4.0,
                 "the next term of the error may lower it; a higher order is no fault")


Problem = tuple[Callable[[float], Json], Sequence[Criterion]]
"""The scene at a step [s], and what is compared."""


def benchmark(
    title: str, problem: str, source: str, *, steps: Sequence[float], fault: Mapping[str, float],
    quick: Sequence[float] = (),
) -> Callable[[Callable[[], Problem]], Callable[[str], None]]:
    """Register a published problem as a case.

    Args:
        title: of the problem.
        problem: statement of it.
        source: publication, origin of the digits, and how the scene differs.
        steps: three [s], run nightly; the first two run by day.
        fault: overrides of the scene, by path, that the criteria must notice.
        quick: two other steps to run by day [s].
    """
    def register(define: Callable[[], Problem]) -> Callable[[str], None]:
        def run(at_steps: Sequence[float], overrides: Mapping[str, Any] | None = None,
                ) -> Iterator[Check]:
            scene, criteria = define()
            found = [_results(scene(step), criteria, overrides) for step in at_steps]
            for criterion, values in zip(criteria, zip(*found, strict=True), strict=True):
                yield from criterion.checks(at_steps, values)

        by_day = quick or steps[:2]
        name = define.__name__.removeprefix("test_")
        CASES[name] = Case(name, title, "", problem, source, lambda: run(by_day), define.__module__)

        @pytest.mark.parametrize("what", ["steps", *(
            pytest.param(each, marks=pytest.mark.nightly) for each in ("fine steps", "fault"))])
        def test(what: str) -> None:
            if what == "fault":
                assert not all(check.ok for check in run(by_day[-1:], fault))
            else:
                assert_all(run(steps if what == "fine steps" else by_day))

        test.__name__ = define.__name__
        return test

    return register


def _results(scene: Json, criteria: Sequence[Criterion], overrides: Mapping[str, Any] | None,
             ) -> list[list[float]]:
    try:
        run = simulate(load_scene(scene, overrides=overrides))
    except SimulationDiverged:
        return [[math.inf] * len(criterion.digits) for criterion in criteria]
    return [[digit.found(run) for digit in criterion.digits] for criterion in criteria]


def lag(amplitude: float, rate: float, duration: float) -> float:
    """Scale of a vibration whose phase is (rate h)^2 / 24 of its angle off after ``duration`` [s].

    The step keeps cos(ω' h) = 1 - (ω h)^2 / 2, so ω' = ω (1 + (ω h)^2 / 24).
    """
    return amplitude * rate * duration / 24


def spelled(until: float, step: float, *, sample_rate: float | None = None, **more: Any) -> Json:
    """Scene that runs four steps beyond ``until`` [s] and samples every step by default."""
    return {"run": {"duration": until + 4 * step, "step": step,
                    "sample_rate": sample_rate or 1 / step}, **more}


def point(z: complex) -> list[float]:
    """Complex number as [x, y]."""
    return [complex(z).real, complex(z).imag]


def body(name: str, at: complex, angle: float, centre: complex, kilograms: float, inertia: float,
         **more: Any) -> Json:
    """Body with its frame at ``at``, turned by ``angle``, and its centre of mass in that frame."""
    return {"name": name, "at": point(at), "angle": float(angle), "centre": point(centre),
            "mass": kilograms, "inertia": inertia, **more}


def hinge(a: str, b: str, on_b: complex = 0.0) -> Json:
    """Pin named after both bodies."""
    return {"type": "pin", "name": f"{a}_{b}", "a": a, "b": b, "on_b": point(on_b)}


GROUND: Json = {"name": "ground", "motion": "fixed"}
