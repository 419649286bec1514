"""The verdict on one expected quantity, from its values at h, h/2, h/4.

A quantity q that follows from the step h as q(h) = q_0 + C h^p shows by three runs its order p
and its limit q_0, and so what is left of its error at h (Richardson; P. J. Roache,
*Verification and Validation in Computational Science and Engineering*, 1998, chapter 5):

    p = log2( (q(h) - q(h/2)) / (q(h/2) - q(h/4)) )
    q_0 = q(h/4) - (q(h/2) - q(h/4)) / (2^p - 1)

Differences of unlike sign, or that hardly fall, show neither. Whether an error is small is asked of
the scene: it is held against what the expectation allows (:func:`tolerance`), never against
the width of a range that says nothing.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sandbox.samples.expectations import Verdict

ROUNDING = 1e-9
"""Differences below this fraction of the quantity's size say nothing of the step."""
SHARE = 0.1
"""Of a tolerance, that an error may take: as with measuring instruments, one part in ten."""
WIDE = 0.1
"""A range wider than this fraction of the quantity is no tolerance; so much of it is taken."""
SLIGHT = 1e-3
"""What is smaller than this fraction of the largest quantity of its unit has no size of its own."""
LEAST_ORDER = 0.5
"""Differences that fall more slowly show no limit, those that grow faster that there is none."""
SCHEME_ORDER = 2.0
"""The engine's order: differences that fall faster do so by chance, not by the scheme."""
MOST_HALVINGS = 7
"""A step finer than h/128 is not named as one that would do: so far no order can be trusted."""


class Kind(StrEnum):
    """What can be said of a quantity."""

    EXACT = "exact to rounding"
    CONVERGED = "converged"
    WITHIN = "within its range"
    """It has not settled on one number, but every run has it in its range, and the last halving
    changed it by less than its distance from the range's ends."""
    STEP = "depends on the step"
    """It settles on a number, but at the end of its range: another step, another verdict."""
    OPEN = "not converged"
    """Halving the step changes it by more than the scene allows."""
    DIVERGES = "diverges"
    """Halving the step changes it the more, the finer the step is."""
    FAILS = "fails"
    """Its expectation does not hold to begin with, or it has no value."""


@dataclass(frozen=True)
class Sizes:
    """How large a quantity is, in its own unit; see :mod:`sandbox.study.sizes`."""

    peak: float
    """Its largest value over the window, against which rounding is measured."""
    own: float
    """Its usual size over the window."""
    scene: float
    """Usual size of the largest quantity of its unit in the scene, at least ``own``."""


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
    """At h, h/2, h/4; nan where the run did not get so far."""
    allowed: float
    """What may be left of the error for it to have converged: a share of the tolerance."""
    order: float
    """Observed order of convergence; nan where the differences are rounding or show none."""
    limit: float
    """What it tends to as the step goes to nothing; nan where that cannot be told."""
    error: float
    """What is left of the error at h: to the limit where it has one, else twice the spread."""
    kind: Kind
    reason: str = ""
    """What the kind rests on, in numbers."""
    finer: int = 0
    """h through this would do; 0 where no step can be named, or none is needed."""

    @property
    def differences(self) -> tuple[float, float]:
        """By how much the first and the second halving of the step changed it."""
        return abs(self.values[1] - self.values[0]), abs(self.values[2] - self.values[1])

    @property
    def settled(self) -> bool:
        """Whether the quantity is one number, whatever the step."""
        return self.kind in (Kind.EXACT, Kind.CONVERGED)

    @property
    def certified(self) -> bool:
        """Whether its expectation can be relied on."""
        return self.settled or self.kind is Kind.WITHIN


def judge(
    verdict: Verdict, values: tuple[float, float, float], sizes: Sizes, *, given: bool = False,
) -> Trust:
    """What the values of three runs say of an expectation.

    Args:
        verdict: on the run at h.
        values: at h, h/2, h/4.
        sizes: of the quantity.
        given: whether the range is a tolerance (``is`` … ``within``), not two bounds.
    """
    blank = Trust(verdict.quantity, verdict.statistic, verdict.unit, verdict.low, verdict.high,
                  values, math.nan, math.nan, math.nan, math.nan, Kind.FAILS,
                  verdict.reason)
    if not np.isfinite(values).all():
        return blank
    noise = max(ROUNDING * sizes.peak, np.finfo(float).tiny)
    order, limit = _richardson(values, noise)
    error = (max(abs(values[0] - limit), abs(values[0] - values[1]))
             if math.isfinite(limit) else 2 * float(np.ptp(values)))
    trust = replace(blank, order=order, limit=limit, error=error,
                    allowed=SHARE * tolerance(verdict, values[2], sizes, given=given))
    kind = _kind(trust, verdict.ok, sizes, noise)
    finer = _finer(trust, noise) if kind in (Kind.OPEN, Kind.FAILS) else 0
    trust = replace(trust, kind=kind, finer=finer)
    told = "" if verdict.reason and kind is Kind.FAILS else _reason(trust)
    return replace(trust, reason="; ".join(filter(None, (verdict.reason, told))))


def tolerance(verdict: Verdict, value: float, sizes: Sizes, *, given: bool) -> float:
    """How far a value may be off by what its expectation says.

    A tolerance that is given (``is`` … ``within``) is taken, unless it is wider than a tenth of
    anything of that unit in the scene. Two bounds allow half their distance, one bound the value's
    distance from it. A wide range is mostly there to catch nonsense, and what explodes stays within
    it, too: of bounds no more than a tenth of the quantity itself counts.
    """
    half = (verdict.high - verdict.low) / 2
    if given:
        return min(half, WIDE * sizes.scene)
    if math.isinf(half):
        half = min(abs(value - verdict.low), abs(verdict.high - value))
    return min(half, WIDE * max(sizes.own, SLIGHT * sizes.scene))


def _richardson(values: tuple[float, float, float], noise: float) -> tuple[float, float]:
    """Order and limit, nan where they cannot be told."""
    coarse, fine = values[0] - values[1], values[1] - values[2]
    if abs(fine) <= noise:
        return math.nan, values[2]
    if abs(coarse) <= noise or coarse * fine < 0:
        return math.nan, math.nan
    order = math.log2(coarse / fine)
    if order < LEAST_ORDER:
        return math.nan, math.nan
    return order, values[2] - fine / (2 ** min(order, SCHEME_ORDER) - 1)


def _kind(trust: Trust, met: bool, sizes: Sizes, noise: float) -> Kind:
    spread = float(np.ptp(trust.values))
    limit = trust.limit if math.isfinite(trust.limit) else trust.values[2]
    inside = _distance(trust, np.array([*trust.values, limit])) >= -noise
    if spread <= noise:
        return Kind.EXACT if met and inside else Kind.FAILS
    if trust.error <= trust.allowed:
        return Kind.FAILS if not met else Kind.CONVERGED if inside else Kind.STEP
    coarse, fine = trust.differences
    if met and inside:
        ahead = _distance(trust, np.array([trust.values[2]]))
        narrow = ahead <= sizes.own or spread <= SHARE * WIDE * sizes.scene
        if fine <= ahead + noise and narrow:
            return Kind.WITHIN
    if fine > 2**LEAST_ORDER * coarse:
        return Kind.DIVERGES
    return Kind.OPEN if met else Kind.FAILS


def _distance(trust: Trust, values: np.ndarray) -> float:
    """Of the nearest of the values from the nearest end of the range, negative outside it."""
    return float(np.minimum(values - trust.low, trust.high - values).min())


def _finer(trust: Trust, noise: float) -> int:
    """Through which power of two h has to go to have converged, if its limit lies in its range."""
    if not math.isfinite(trust.limit) or not trust.low <= trust.limit <= trust.high:
        return 0
    order = min(trust.order, SCHEME_ORDER) if math.isfinite(trust.order) else SCHEME_ORDER
    left = max(abs(trust.values[2] - trust.limit), noise)  # of the error at h/4
    if trust.allowed <= 0:
        return 0
    halvings = max(1, 2 + math.ceil(math.log2(left / trust.allowed) / order))
    return 2**halvings if halvings <= MOST_HALVINGS else 0


def _reason(trust: Trust) -> str:
    """What a verdict rests on, in numbers; nothing where the table says it all."""
    def told(value: float) -> str:
        return f"{value:.2g}{'' if trust.unit in ('', '1') else f' {trust.unit}'}"

    coarse, fine = (told(each) for each in trust.differences)
    halved = f"halving the step changes it by {coarse}, then by {fine}"
    allowed = f"{told(trust.allowed)} is allowed"
    match trust.kind:
        case Kind.WITHIN:
            return (f"{halved}, inside its range; to have converged at most {told(trust.allowed)} "
                    "may be left")
        case Kind.STEP if _distance(trust, np.array(trust.values)) >= 0:
            return f"it tends to {trust.limit:.6g}, outside its range"
        case Kind.STEP:
            return f"at h/4 it is {trust.values[2]:.6g}, outside its range"
        case Kind.OPEN if math.isfinite(trust.order):
            return (f"{told(trust.error)} is left of its error and falls with order "
                    f"{trust.order:.1f}; {allowed}")
        case Kind.OPEN:
            return f"{halved}; {allowed}"
        case Kind.DIVERGES:
            return f"{halved}: the finer the step, the more; {allowed}"
        case Kind.FAILS if _distance(trust, np.array(trust.values[2:])) >= 0:
            return "it is outside its range at h, but not at h/4"
        case Kind.FAILS if math.isfinite(trust.limit):
            return f"it tends to {trust.limit:.6g}, outside {_range(trust)}"
        case Kind.FAILS:
            return f"it is outside {_range(trust)}"
    return ""


def _range(trust: Trust) -> str:
    if math.isinf(trust.low):
        return f"at most {trust.high:.6g}"
    if math.isinf(trust.high):
        return f"at least {trust.low:.6g}"
    return f"{trust.low:.6g} to {trust.high:.6g}"
