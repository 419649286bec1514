"""Checks of an audit: a value, a tolerance and a verdict each, and the distance to a law."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from sandbox.numeric import Array, Flags
from sandbox.wording import Count

if TYPE_CHECKING:
    from sandbox.audit.evidence import Evidence

ROUNDING = 1e-12  # Rounding error [m, rad] after a few dozen operations on lengths below 1 m
DIGITS = 1e-15  # Relative error of a number that is rounded a few times
NOT_EVERY_STEP = "not every step was recorded; run.sample_rate = 1 / run.step records them all"
"""Why checks that sum over steps are not computed."""
SMALLEST_SCALE = 1e-12  # Least value [N, N m, J, rad/s] that relative errors refer to
EXACT = 1e-9
"""Relative to the largest force: rounding error of sums of some ten forces, with a margin."""
STILL = 1e-11, 1e-10  # The engine stops bodies that are slower [m/s, rad/s]
HELD = 1e-10  # Regularisation of impulses towards the last ones (docs/engine.md)
STOPPED = 1e-8  # Allowed overrun of a hinge [rad]: a gap of 1e-10 m at an arm of 10 mm


def peak(values: Array) -> float:
    """The largest magnitude among values of any shape; 0 if there are none."""
    return float(np.abs(values).max(initial=0.0))


def whole(values: Array) -> float:
    """The scale of relative errors: the largest magnitude, or :data:`SMALLEST_SCALE`."""
    return max(peak(values), SMALLEST_SCALE)


def lost_rate(rates: Array, *, turning: bool) -> float:
    """Error of rates by :data:`STILL` and rounding [m/s or rad/s]."""
    return STILL[turning] + DIGITS * peak(rates)


@dataclass(frozen=True)
class Figure:
    """The result of one check."""

    name: str
    value: float  # nan where it was not computed
    unit: str
    threshold: float  # Largest value that passes; nan where nothing was computed
    verdict: Literal["pass", "look", "not computed"]
    why: str  # The comparison, or the reason why it was not computed
    source: str  # The equation


def figure_data(figure: Figure) -> dict[str, Any]:
    """A figure as JSON data; nan becomes null."""
    return {key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in vars(figure).items()}


class NotComputed(Exception):
    """A check without a value, with the reason."""


@dataclass
class Worst:
    """The comparison that comes closest to its tolerance, or exceeds it most."""

    value: float = math.nan
    tolerance: float = math.nan
    where: str = ""
    ratio: float = -1.0
    count: int = 0
    left_out: list[str] = field(default_factory=list)
    """Elements that are not compared, with the reason."""

    def add(
        self, where: str, error: Array, tolerance: Array | float, among: Flags | None = None,
    ) -> None:
        """Add errors [n] of one element and their tolerances; nan is the worst."""
        error, tolerance = np.broadcast_arrays(error, tolerance)
        if among is not None:
            error, tolerance = error[among], tolerance[among]
        if not len(error):
            return
        self.count += 1
        ratio = np.nan_to_num(error / tolerance, nan=np.inf)
        at = int(ratio.argmax())
        if ratio[at] > self.ratio:
            self.ratio, self.where = float(ratio[at]), where
            self.value, self.tolerance = float(error[at]), float(tolerance[at])

    def add_nearest(
        self, where: str, laws: Sequence[tuple[Array, Array | float]],
        among: Flags | None = None, *, throughout: bool = True,
    ) -> None:
        """Add the nearest of several laws (error, tolerance), one ``throughout`` or per sample."""
        error, tolerance = np.array([np.broadcast_arrays(*law) for law in laws]).swapaxes(0, 1)
        ratio = np.nan_to_num(error / tolerance, nan=np.inf)
        if throughout:
            counted = ratio if among is None else ratio[:, among]
            k = int(counted.max(axis=1, initial=0.0).argmin())
            self.add(where, error[k], tolerance[k], among)
        else:
            k, n = ratio.argmin(axis=0), np.arange(error.shape[1])
            self.add(where, error[k, n], tolerance[k, n], among)

    def add_law(
        self, where: str, force: Array, rate: Array, limit: Array,
        floors: tuple[Array | float, float], tolerance: Array | float, among: Flags | None = None,
    ) -> None:
        """Add the distance of forces and rates [n] from a law of friction or of a limited drive.

        The law is f = limit and y <= 0, |f| <= limit and y = 0, or f = -limit and y >= 0. Errors of
        force and rate count relative to their ``floors``; the distance 1 is the ``tolerance``.
        """
        y, over = rate / floors[1], np.maximum(np.abs(force) - limit, 0.0) / floors[0]
        below, above = np.abs(force + limit) / floors[0], np.abs(force - limit) / floors[0]
        distance = np.minimum.reduce([
            np.maximum(np.abs(y), over), np.maximum(below, -y), np.maximum(above, y)])
        self.add(where, distance * tolerance, tolerance, among)

    def judge(self, value: float, tolerance: float) -> None:
        """Set the one value of a check."""
        self.value, self.tolerance, self.count = float(value), float(tolerance), 1


class Check(NamedTuple):
    """One check of an audit."""

    name: str
    unit: str
    source: str  # The equation
    asks: str  # The question that it answers; yes means pass
    compared: str  # The comparison in words, with ``{where}``, ``{count:noun}`` and ``{note}``
    none: str  # Why it is not computed where nothing is compared
    compare: Callable[[Evidence, Worst], str | None]
    """Adds the comparisons; returns a note, or raises :class:`NotComputed`."""

    def figure(self, evidence: Evidence) -> Figure:
        """The figure of a recording; numbers that cannot be used make it "not computed"."""
        worst = Worst()
        try:
            note = self.compare(evidence, worst) or ""
        except NotComputed as reason:
            return self.missing(str(reason))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError) as error:
            return self.missing(f"the numbers cannot be used: {error}")
        if not worst.count:
            return self.missing("; ".join(worst.left_out[:4]) or self.none)
        if math.isnan(worst.value) and evidence.model.mechanism.run.solver == "pymunk":
            return self.missing("pymunk does not give its numbers")
        passes = math.isfinite(worst.value) and math.isfinite(worst.tolerance) and (
            worst.value <= worst.tolerance)
        why = self.compared.format(where=worst.where, count=Count(worst.count), note=note)
        if worst.left_out:
            why += f"; left out: {'; '.join(worst.left_out[:4])}"
        return Figure(self.name, worst.value, self.unit, worst.tolerance,
                      "pass" if passes else "look", why, self.source)

    def missing(self, why: str) -> Figure:
        """The figure where it is not computed."""
        return Figure(self.name, math.nan, "", math.nan, "not computed", why, self.source)


def check(
    name: str, unit: str = "", source: str = "", *, asks: str, compared: str = "{note}",
    none: str = "",
) -> Callable[[Callable[[Evidence, Worst], str | None]], Check]:
    """Make a check of a function; ``none`` says by default that there is no element to count."""
    none = none or f"there is no {compared.partition('{count:')[2].partition('}')[0]}"
    return lambda compare: Check(name, unit, source, asks, compared, none, compare)
