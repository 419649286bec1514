"""The verdict on one expected quantity, from its values at h, h/2 and h/4.

If a quantity depends on the step as q(h) = q_0 + C h^p, three runs give its order p and its limit
q_0, and with them the error at h (Richardson extrapolation; P. J. Roache, *Verification and
Validation in Computational Science and Engineering*, 1998, chapter 5):

    p = log2( (q(h) - q(h/2)) / (q(h/2) - q(h/4)) )
    q_0 = q(h/4) - (q(h/2) - q(h/4)) / (2^p - 1)

Differences of unlike sign, or that hardly fall, give neither. An error counts as small if it is
a tenth of what the expectation allows (:func:`tolerance`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from sandbox.samples.expectations import Verdict

ROUNDING = 1e-9  # differences below this share of the quantity's size are rounding
SHARE = 0.1  # of a tolerance, that an error may take
WIDE = 0.1  # a range wider than this share of the quantity is no tolerance
SLIGHT = 1e-3  # smaller than this share of the largest quantity of its unit: no size of its own
LEAST_ORDER = 0.5  # differences that fall more slowly show no limit
SCHEME_ORDER = 2.0  # of the engine; differences that fall faster do so by chance
MAX_HALVINGS = 7  # no step finer than h/128 is suggested


class Kind(StrEnum):
    """The verdict on a quantity."""

    EXACT = "exact to rounding"
    CONVERGED = "converged"
    WITHIN = "within its range"
    """Not converged, but every run is in the range, and the last halving changes the value by less
    than its distance from the ends of the range."""
    STEP = "depends on the step"
    """It converges to a value outside its range: another step gives another verdict."""
    OPEN = "not converged"
    """Halving the step changes it by more than is allowed."""
    DIVERGES = "diverges"
    """The changes grow as the step is halved."""
    FAILS = "fails"
    """The expectation does not hold, or the quantity has no value."""


@dataclass(frozen=True)
class Sizes:
    """How large a quantity is, in its own unit."""

    peak: float
    """Largest absolute value over the window; rounding is relative to it."""
    own: float
    """Mean absolute value over the window."""
    scene: float
    """Mean absolute value of the largest quantity of its unit in the scene, at least ``own``."""


@dataclass(frozen=True)
class Trust:
    """An expected quantity at three steps, and the verdict on it."""

    quantity: str
    statistic: str
    unit: str
    low: float
    """Lowest value that passes; minus infinity if there is none."""
    high: float
    values: tuple[float, float, float]
    """At h, h/2, h/4; nan if the run ended before."""
    allowed: float
    """Largest error of a quantity that has converged."""
    order: float
    """Observed order of convergence; nan if the differences show none."""
    limit: float
    """Extrapolated value for a step of zero; nan if the differences show none."""
    error: float
    """Estimated error at h: the distance from the limit, or else twice the spread."""
    kind: Kind
    reason: str = ""
    """Numbers that explain the verdict."""
    finer: int = 0
    """h divided by this would be fine enough; 0 if unknown or not needed."""

    @property
    def differences(self) -> tuple[float, float]:
        """Changes by the first and the second halving of the step."""
        return abs(self.values[1] - self.values[0]), abs(self.values[2] - self.values[1])

    @property
    def settled(self) -> bool:
        """Whether the value does not depend on the step."""
        return self.kind in (Kind.EXACT, Kind.CONVERGED)

    @property
    def certified(self) -> bool:
        """Whether the expectation can be relied on."""
        return self.settled or self.kind is Kind.WITHIN


def judge(
    verdict: Verdict, values: tuple[float, float, float], sizes: Sizes, *, given: bool = False,
) -> Trust:
    """The verdict on an expectation from the values of three runs.

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
    text = "" if verdict.reason and kind is Kind.FAILS else _reason(trust)
    return replace(trust, reason="; ".join(filter(None, (verdict.reason, text))))


def tolerance(verdict: Verdict, value: float, sizes: Sizes, *, given: bool) -> float:
    """Largest deviation that an expectation allows.

    A given tolerance (``is`` with ``within``) counts up to a tenth of the largest quantity of its
    unit in the scene. Two bounds allow half their distance, one bound the value's distance from
    it, but not more than a tenth of the quantity itself: wide bounds only catch nonsense.
    """
    half = (verdict.high - verdict.low) / 2
    if given:
        return min(half, WIDE * sizes.scene)
    if math.isinf(half):
        half = min(abs(value - verdict.low), abs(verdict.high - value))
    return min(half, WIDE * max(sizes.own, SLIGHT * sizes.scene))


def _richardson(values: tuple[float, float, float], noise: float) -> tuple[float, float]:
    """Order and limit; nan if the differences show none."""
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
    """Smallest distance of the values from an end of the range, negative outside."""
    return float(np.minimum(values - trust.low, trust.high - values).min())


def _finer(trust: Trust, noise: float) -> int:
    """Power of two by which h has to be divided to converge; 0 if the limit is out of range."""
    if not math.isfinite(trust.limit) or not trust.low <= trust.limit <= trust.high:
        return 0
    order = min(trust.order, SCHEME_ORDER) if math.isfinite(trust.order) else SCHEME_ORDER
    left = max(abs(trust.values[2] - trust.limit), noise)  # of the error at h/4
    if trust.allowed <= 0:
        return 0
    halvings = max(1, 2 + math.ceil(math.log2(left / trust.allowed) / order))
    return 2**halvings if halvings <= MAX_HALVINGS else 0


def _reason(trust: Trust) -> str:
    """Numbers that explain a verdict; empty if the table has them all."""
    def text(value: float) -> str:
        return f"{value:.2g}{'' if trust.unit in ('', '1') else f' {trust.unit}'}"

    coarse, fine = (text(each) for each in trust.differences)
    halved = f"halving the step changes it by {coarse}, then by {fine}"
    allowed = f"{text(trust.allowed)} is allowed"
    match trust.kind:
        case Kind.WITHIN:
            return (f"{halved}, inside its range; to have converged at most {text(trust.allowed)} "
                    "may be left")
        case Kind.STEP if _distance(trust, np.array(trust.values)) >= 0:
            return f"it tends to {trust.limit:.6g}, outside its range"
        case Kind.STEP:
            return f"at h/4 it is {trust.values[2]:.6g}, outside its range"
        case Kind.OPEN if math.isfinite(trust.order):
            return (f"{text(trust.error)} is left of its error and falls with order "
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
