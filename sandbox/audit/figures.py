"""What an audit says: figures, each with a threshold and a verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from sandbox.numeric import Array, Flags
from sandbox.wording import Count

ROUNDING = 1e-12
"""What is left of sixteen digits [m, rad] after a few dozen operations on lengths below 1 m."""
DIGITS = 1e-15
"""Share of a number that is lost where it is rounded a few times."""
NOT_EVERY_STEP = "not every step was recorded; run.sample_rate = 1 / run.step records them all"
"""Why figures that add up steps are not computed."""
SMALLEST_SCALE = 1e-12
"""Shares of what is nowhere more than this [N, N m, J, rad/s] are taken of this."""
EXACT = 1e-9
"""Fraction of the largest force: sums of some ten forces to sixteen digits, and some to spare."""
STILL = 1e-11, 1e-10
"""Where nothing moves faster [m/s, rad/s] the engine lets all stand: so much may go in a step."""
STOPPED = 1e-8
"""So far [rad] a hinge may be beyond its stop: what 1e-10 m of a gap makes at an arm of 10 mm."""


def peak(values: Array) -> float:
    """The largest size among values of any shape; 0 of none."""
    return float(np.abs(values).max(initial=0.0))


def whole(values: Array) -> float:
    """What errors of values are shares of: their largest size, or :data:`SMALLEST_SCALE`."""
    return max(peak(values), SMALLEST_SCALE)


def lost_rate(rates: Array, *, turning: bool) -> float:
    """By how much rates may be off: what :data:`STILL` lets go, and rounding [m/s or rad/s]."""
    return STILL[turning] + DIGITS * peak(rates)


@dataclass(frozen=True, repr=False)
class Figure:
    """One figure of an audit."""

    name: str
    value: float
    """nan where it was not computed."""
    unit: str
    threshold: float
    """Largest value that passes; nan where nothing was computed."""
    verdict: Literal["pass", "look", "not computed"]
    why: str
    """What was compared, or why nothing could be."""
    source: str
    """The equation."""

    def __repr__(self) -> str:
        if self.verdict == "not computed":
            return f"<Figure: {self.name} not computed: {self.why}>"
        unit = f" {self.unit}" if self.unit else ""
        return (f"<Figure: {self.name} {self.value:.2g}{unit}, at most {self.threshold:.2g}; "
                f"{self.verdict}>")


def judged(
    name: str, value: float, unit: str, threshold: float, *, why: str, source: str,
) -> Figure:
    """A figure that passes if its value is a number up to the threshold."""
    passes = math.isfinite(value) and math.isfinite(threshold) and value <= threshold
    return Figure(name, float(value), unit, float(threshold), "pass" if passes else "look", why,
                  source)


def missing(name: str, *, why: str, source: str) -> Figure:
    """A figure that was not computed."""
    return Figure(name, math.nan, "", math.nan, "not computed", why, source)


def figure_data(figure: Figure) -> dict[str, Any]:
    """A figure as JSON data; what has no value is null."""
    return {key: None if isinstance(value, float) and not math.isfinite(value) else value
            for key, value in vars(figure).items()}


@dataclass
class Worst:
    """The comparison that comes closest to its tolerance, or exceeds it most."""

    value: float = math.nan
    tolerance: float = math.nan
    where: str = ""
    ratio: float = -1.0
    count: int = 0

    def add(
        self, where: str, error: Array, tolerance: Array | float,
        among: Flags | None = None,
    ) -> None:
        """Errors of one element over samples [n] against their tolerances, ``among`` some of them.

        An error that is no number is the worst of all.
        """
        if among is not None:
            error = error[among]
            tolerance = tolerance[among] if isinstance(tolerance, np.ndarray) else tolerance
        if not len(error):
            return
        self.count += 1
        ratio = error / tolerance
        at = int(ratio.argmax())  # the first nan, if there is one
        if np.isnan(ratio[at]):
            ratio = np.where(np.isnan(ratio), np.inf, ratio)
        if ratio[at] > self.ratio:
            self.ratio, self.where = float(ratio[at]), where
            self.value = float(error[at])
            self.tolerance = float(
                tolerance[at] if isinstance(tolerance, np.ndarray) else tolerance)

    def add_nearest(
        self, where: str, laws: Sequence[tuple[Array, Array | float]],
        among: Flags | None = None, *, throughout: bool = True,
    ) -> None:
        """Compare with the nearest of several laws, each an error [n] and its tolerance.

        An element keeps one of them throughout, or in each sample any.
        """
        error, tolerance = np.array([np.broadcast_arrays(*law) for law in laws]).swapaxes(0, 1)
        ratio = np.nan_to_num(error / tolerance, nan=np.inf)
        if throughout:
            counted = ratio if among is None else ratio[:, among]
            k = int(counted.max(axis=1, initial=0.0).argmin())
            self.add(where, error[k], tolerance[k], among)
        else:
            k, n = ratio.argmin(axis=0), np.arange(error.shape[1])
            self.add(where, error[k, n], tolerance[k, n], among)

    def figure(self, name: str, unit: str, *, why: str, source: str, none: str) -> Figure:
        """The figure; not computed, for the reason ``none``, where nothing was compared."""
        if not self.count:
            return missing(name, why=none, source=source)
        return judged(name, self.value, unit, self.tolerance,
                      why=why.format(where=self.where, count=Count(self.count)), source=source)
