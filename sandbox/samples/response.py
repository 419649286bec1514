"""Step responses and control effort: overshoot, settling time, steady error, IAE.

Pure functions of arrays [n] over rising instants [s]. The definitions are those of control
textbooks (Franklin, Powell and Emami-Naeini, *Feedback Control of Dynamic Systems*, section 3.4):

* overshoot: the distance of the peak beyond the last target, as a fraction of the step
  from the first value to the last target;
* settling time: the last time outside a band of +-2 % of the target about it,
  counted from t = 0;
* steady error: the mean of value - target over the last 5 % of the run;
* IAE: the integral of |value - target| over time.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array

BAND = 0.02
"""Half the width of the band that counts as settled, as a fraction of the target."""
LAST = 0.05
"""The fraction of a run that counts as its end."""


@dataclass(frozen=True)
class Response:
    """The response of a quantity to its target; SI."""

    start: float
    """The first value: where the step to the target begins."""
    final: float
    """The mean of the end of the run."""
    target: float
    """The last one."""
    overshoot: float
    """[%] of the step; nan where there was no step to make."""
    settling: float
    """[s]; inf where it never settles."""
    steady_error: float
    iae: float
    """In the quantity's unit times seconds."""


@dataclass(frozen=True)
class Effort:
    """The control effort of a drive, in its unit."""

    variation: float
    """The sum of all changes, up and down."""
    peak: float
    """Largest magnitude."""
    rate: float
    """Largest change from one sample to the next, per second: a jump counts by the sampling."""


def respond(time: Array, value: Array, target: Array) -> Response:
    """All figures of one response to a target, which may move.

    Raises:
        ValueError: fewer than two samples, or shapes that differ.
    """
    _check(time, value, target)
    end = ending(time)
    return Response(
        start=float(value[0]), final=float(np.mean(value[end])), target=float(target[-1]),
        overshoot=overshoot(value, target), settling=settling_time(time, value, target),
        steady_error=float(np.mean(value[end] - target[end])),
        iae=float(np.trapezoid(np.abs(value - target), time)))


def overshoot(value: Array, target: Array) -> float:
    """Overshoot of the step from the first value to the last target [%]; nan if they are equal."""
    goal = float(target[-1])
    step = goal - float(value[0])
    if step == 0:
        return math.nan
    return float(100 * max(0.0, np.max((value - goal) / step)))


def settling_time(time: Array, value: Array, target: Array) -> float:
    """The last time outside the band about the target [s]; 0 if it never was outside.

    Between the last sample outside and the next one the crossing is interpolated, so that the error
    is of second order in the spacing. Without the last 5 % of the run in the band it is inf. A
    sample without a value counts as outside. The band refers to the last target, or to the step if
    that target is 0.

    Raises:
        ValueError: fewer than two samples, or shapes that differ.
    """
    _check(time, value, target)
    error, band = value - target, BAND * abs(float(target[-1]) or float(value[0]))
    outside = np.flatnonzero(~(np.abs(error) <= band))
    if not len(outside):
        return 0.0
    last = int(outside[-1])
    if last >= ending(time).start:
        return math.inf
    before, after = float(error[last]), float(error[last + 1])
    if not math.isfinite(before):
        return float(time[last])
    part = (abs(before) - band) / abs(before - after)
    return float(time[last] + part * (time[last + 1] - time[last]))


def effort(time: Array, value: Array, before: float) -> Effort:
    """The control effort of a drive over a run.

    ``before`` is its value before the first sample; a jump from there counts as one within the time
    between two samples.

    Raises:
        ValueError: fewer than two samples, or shapes that differ.
    """
    _check(time, value, value)
    changes = np.abs(np.diff(value, prepend=before))
    spacing = np.diff(time, prepend=2 * time[0] - time[1])
    return Effort(variation=float(changes.sum()), peak=float(np.max(np.abs(value))),
                  rate=float(np.max(changes / spacing)))


def ending(time: Array) -> slice:
    """The samples of the last 5 % of a run, at least one."""
    since = time[-1] - LAST * (time[-1] - time[0])
    return slice(int(np.searchsorted(time, since)), len(time))


def _check(time: Array, value: Array, target: Array) -> None:
    if not time.shape == value.shape == target.shape or time.ndim != 1:
        raise ValueError("time, value and target must have the same length, got shapes "
                         f"{time.shape}, {value.shape} and {target.shape}")
    if len(time) < 2:
        raise ValueError(f"a response needs at least 2 samples, got {len(time)}")
