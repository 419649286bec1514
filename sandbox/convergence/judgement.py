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
from typing import NamedTuple

import numpy as np

from sandbox.samples.expectations import Verdict

ROUNDING = 1e-9  # differences below this share of the quantity's size are rounding
SHARE = 0.1  # of a tolerance, that an error may take
WIDE = 0.1  # a range wider than this share of the quantity is no tolerance
SLIGHT = 1e-3  # smaller than this share of the largest quantity of its unit: no size of its own
MIN_ORDER = 0.5  # differences that fall more slowly show no limit
SCHEME_ORDER = 2.0  # of the engine; differences that fall faster do so by chance
MAX_HALVINGS = 7  # no step finer than h/128 is suggested


class Kind(StrEnum):
    """The verdict on a quantity."""

    EXACT = "exact to rounding"
    CONVERGED = "converged"
    WITHIN = "within its range"  # all runs are, and the last halving changes it by less than that
    STEP = "depends on the step"  # its limit is outside its range
    OPEN = "not converged"  # halving the step changes it by more than is allowed
    DIVERGES = "diverges"  # the changes grow as the step is halved
    FAILS = "fails"  # the expectation does not hold, or the quantity has no value


class Sizes(NamedTuple):
    """How large a quantity is, in its own unit."""

    peak: float  # largest absolute value over the window; rounding is relative to it
    own: float  # mean absolute value over the window
    scene: float  # that of the largest quantity of its unit in the scene, at least ``own``


@dataclass(frozen=True)
class Trust:
    """An expected quantity at three steps, and the verdict on it."""

    quantity: str
    statistic: str
    unit: str
    low: float  # lowest value that passes; minus infinity if there is none
    high: float
    values: tuple[float, float, float]  # at h, h/2, h/4; nan if the run ended before
    allowed: float = math.nan  # largest error of a quantity that has converged
    order: float = math.nan  # observed order of convergence; nan if the differences show none
    limit: float = math.nan  # extrapolated to a step of zero; nan if the differences show none
    error: float = math.nan  # estimated at h: the distance from the limit, or twice the spread
    kind: Kind = Kind.FAILS
    reason: str = ""  # numbers that explain the verdict
    finer: int = 0  # h divided by this would be fine enough; 0 if unknown or not needed

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

    def margin(self, *values: float) -> float:
        """Smallest distance of values from an end of the range, negative outside."""
        return min(min(value - self.low, self.high - value) for value in values)


def judge(
    verdict: Verdict, values: tuple[float, float, float], sizes: Sizes, *, given: bool = False,
) -> Trust:
    """The verdict on an expectation, of which ``verdict`` is that at h, from three runs.

    ``given``: the range is a tolerance (``is`` … ``within``), not two bounds.
    """
    trust = Trust(verdict.quantity, verdict.statistic, verdict.unit, verdict.low, verdict.high,
                  values, reason=verdict.reason)
    if not np.isfinite(values).all():
        return trust
    noise = max(ROUNDING * sizes.peak, np.finfo(float).tiny)
    order, limit = _richardson(values, noise)
    error = (max(abs(values[0] - limit), abs(values[0] - values[1]))
             if math.isfinite(limit) else 2 * float(np.ptp(values)))
    trust = replace(trust, order=order, limit=limit, error=error,
                    allowed=SHARE * tolerance(verdict, values[2], sizes, given=given))
    kind = _kind(trust, verdict.ok, sizes, noise)
    trust = replace(trust, kind=kind,
                    finer=_finer(trust, noise) if kind in (Kind.OPEN, Kind.FAILS) else 0)
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
    if order < MIN_ORDER:
        return math.nan, math.nan
    return order, values[2] - fine / (2 ** min(order, SCHEME_ORDER) - 1)


def _kind(trust: Trust, met: bool, sizes: Sizes, noise: float) -> Kind:
    spread = float(np.ptp(trust.values))
    limit = trust.limit if math.isfinite(trust.limit) else trust.values[2]
    inside = trust.margin(*trust.values, limit) >= -noise
    if spread <= noise:
        return Kind.EXACT if met and inside else Kind.FAILS
    if trust.error <= trust.allowed:
        return Kind.FAILS if not met else Kind.CONVERGED if inside else Kind.STEP
    coarse, fine = trust.differences
    ahead = trust.margin(trust.values[2])
    narrow = ahead <= sizes.own or spread <= SHARE * WIDE * sizes.scene
    if met and inside and fine <= ahead + noise and narrow:
        return Kind.WITHIN
    if fine > 2**MIN_ORDER * coarse:
        return Kind.DIVERGES
    return Kind.OPEN if met else Kind.FAILS


def _finer(trust: Trust, noise: float) -> int:
    """Power of two by which h has to be divided to converge; 0 if the limit is out of range."""
    if not trust.low <= trust.limit <= trust.high or trust.allowed <= 0:
        return 0
    order = min(trust.order, SCHEME_ORDER) if math.isfinite(trust.order) else SCHEME_ORDER
    left = max(abs(trust.values[2] - trust.limit), noise)  # of the error at h/4
    halvings = max(1, 2 + math.ceil(math.log2(left / trust.allowed) / order))
    return 2**halvings if halvings <= MAX_HALVINGS else 0


def _reason(trust: Trust) -> str:
    """Numbers that explain a verdict; empty if the table has them all."""
    def text(value: float) -> str:
        return f"{value:.2g}{'' if trust.unit in ('', '1') else f' {trust.unit}'}"

    halved = "halving the step changes it by {}, then by {}".format(*map(text, trust.differences))
    allowed = f"{text(trust.allowed)} is allowed"
    low, high = f"{trust.low:.6g}", f"{trust.high:.6g}"
    range_ = (f"at most {high}" if math.isinf(trust.low) else
              f"at least {low}" if math.isinf(trust.high) else f"{low} to {high}")
    match trust.kind:
        case Kind.WITHIN:
            return f"{halved}, inside its range, but not by less than {text(trust.allowed)}"
        case Kind.STEP if trust.margin(*trust.values) < 0:
            return f"at h/4 it is {trust.values[2]:.6g}, outside its range"
        case Kind.STEP:
            return f"it tends to {trust.limit:.6g}, outside its range"
        case Kind.OPEN if math.isfinite(trust.order):
            return (f"{text(trust.error)} is left of its error and falls with order "
                    f"{trust.order:.1f}; {allowed}")
        case Kind.OPEN:
            return f"{halved}; {allowed}"
        case Kind.DIVERGES:
            return f"{halved}: the finer the step, the more; {allowed}"
        case Kind.FAILS if trust.margin(trust.values[2]) >= 0:
            return "it is outside its range at h, but not at h/4"
        case Kind.FAILS:
            tends = f"it tends to {trust.limit:.6g}, " if math.isfinite(trust.limit) else "it is "
            return f"{tends}outside {range_}"
    return ""
