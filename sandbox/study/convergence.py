"""The verdict on one expected quantity, from its values at h, h/2, h/4 and with more iterations."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sandbox.samples.expectations import Verdict

ROUNDING = 1e-9
"""Differences below this fraction of the quantity's size say nothing of the step."""
WELL_INSIDE = 0.1
"""Fraction of a range's width that what is left of the error may take."""
LEAST_ORDER = 0.5
"""Below this order differences do not shrink: no limit can be given."""


class Kind(StrEnum):
    """What can be said of a quantity."""

    EXACT = "exact to rounding"
    CONVERGED = "converged"
    WITHIN = "within its range"
    """It does not settle on one number, but at every step it lies in its range, and the last
    halving changed it by less than its distance from the range's ends."""
    STEP = "depends on the step"
    ITERATIONS = "depends on the iterations"
    FAILS = "fails"
    """Its expectation does not hold to begin with."""


@dataclass(frozen=True)
class Trust:
    """An expected quantity at three steps, and how far it can be trusted."""

    quantity: str
    statistic: str
    unit: str
    low: float
    """Least value that passes; minus infinity where open."""
    high: float
    values: tuple[float, float, float]
    """At h, h/2, h/4."""
    harder: float
    """At h with twice the iterations."""
    order: float
    """Observed order of convergence; nan where the differences are rounding or do not shrink."""
    error: float
    """What is left of the error at h: by Richardson where it converges, else twice the spread."""
    kind: Kind
    reason: str = ""

    @property
    def iteration_change(self) -> float:
        """Change of the value at h by twice the iterations."""
        return self.harder - self.values[0]

    @property
    def settled(self) -> bool:
        """Whether the quantity is one number, whatever the step."""
        return self.kind in (Kind.EXACT, Kind.CONVERGED)

    @property
    def certified(self) -> bool:
        """Whether its expectation can be relied on."""
        return self.settled or self.kind is Kind.WITHIN


def judge(
    verdict: Verdict, values: tuple[float, float, float], harder: float, scale: float,
) -> Trust:
    """What the values of four runs say of an expectation.

    Args:
        verdict: on the run at h.
        values: at h, h/2, h/4.
        harder: at h with twice the iterations.
        scale: size of the quantity over the window, against which rounding is measured.
    """
    q = np.array(values)
    coarse, fine = abs(q[0] - q[1]), abs(q[1] - q[2])
    spread = float(np.ptp([*values, harder])) if np.isfinite([*values, harder]).all() else np.nan
    noise = max(ROUNDING * scale, np.finfo(float).tiny)
    order, error = np.nan, 2 * spread
    if coarse > noise and fine > noise:
        observed = float(np.log2(coarse / fine))
        if observed >= LEAST_ORDER:
            order = observed
            # beyond order 4 the differences shrink by chance, not by the scheme
            error = max(coarse / (1 - 2.0**-min(order, 4.0)), abs(harder - q[0]))
    trust = Trust(verdict.quantity, verdict.statistic, verdict.unit, verdict.low, verdict.high,
                  values, harder, order, float(error), Kind.FAILS, verdict.reason)
    return replace(trust, kind=_kind(trust, verdict.ok, spread, noise))


def _kind(trust: Trust, met: bool, spread: float, noise: float) -> Kind:
    four = np.array([*trust.values, trust.harder])
    if not met or not np.isfinite(four).all():
        return Kind.FAILS
    margin = float(np.minimum(four - trust.low, trust.high - four).min())
    culprit = (Kind.ITERATIONS if abs(trust.iteration_change) > np.ptp(trust.values)
               else Kind.STEP)
    if margin < -noise:
        return culprit
    if spread <= noise:
        return Kind.EXACT
    room = trust.high - trust.low if np.isfinite([trust.low, trust.high]).all() else margin
    if trust.error <= WELL_INSIDE * room:
        return Kind.CONVERGED
    finest, ahead = trust.values[2], abs(trust.values[1] - trust.values[2])
    room_ahead = min(finest - trust.low, trust.high - finest) + noise
    return Kind.WITHIN if room_ahead >= ahead else culprit
