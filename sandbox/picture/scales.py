"""How long arrows are: one rule for forces, loads, drives, velocities; round numbers and units.

A film shows each instant as long as any other, so sizes are weighed by time: an arrow's scale is
that of the largest arrow of nearly every picture, not of the largest number of the run. A blow
lasts a sample or a few; measured by it, all that lasts would have no length.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers
from sandbox.picture.run_data import RunData
from sandbox.scene.settings import View

OFTEN = 0.95
"""Share of the time in which anything acts that no arrow is larger than the reference: what is
larger is seen in one picture of twenty, and cut only beyond :data:`LONGEST` times it."""
ENDING = 0.1
"""Share of the run, its end, of which what acts for half of it counts too: an end is looked at
longest, and a grasp may come as late."""
REFERENCE, LONGEST = 0.085, 1.5
"""Length of the reference force's arrow as a fraction of the picture's width; arrows are cut at so
many times the reference and marked with two bars."""
ROUNDING = 1e-6
"""Acceleration [m/s^2] of all that moves: forces that are no larger than that takes are nothing."""
MOST_DECIMALS = 9
NOTHING = 1e-6
"""What is below this fraction of the largest size of a run is what rounding leaves."""
PRESSURES = ((1e6, "MPa"), (1e5, "bar"), (1e3, "kPa"), (1.0, "Pa"))


@dataclass(frozen=True)
class ForceScale:
    """How long an arrow is, of a force or of anything else that has a size."""

    metres: float
    """Length of an arrow of size 1 [m]; 0 where there is nothing to show."""
    reference: float
    """A size that is typical of the large ones of the run [N, or the unit of what is shown]."""

    @property
    def longest(self) -> float:
        """Arrows of larger sizes are cut."""
        return self.reference * LONGEST


NO_SCALE = ForceScale(0.0, 0.0)


def scale_of(reference: float, length: float) -> ForceScale:
    """The scale by which an arrow of the reference size has this length [m]."""
    return ForceScale(length / reference, reference) if reference > 0 else NO_SCALE


def typical(largest: Array, time: Array) -> float:
    """The size by which arrows are measured; 0 if there are none.

    The time-weighted quantile :data:`OFTEN` of the largest arrow of each sample, over the time in
    which anything acts; or the median of the run's last :data:`ENDING`, if that is larger. Of
    blows alone it is a large one of these.

    Args:
        largest: size of the largest arrow of each sample, 0 where there is none, [n].
        time: of the samples [n] s.
    """
    size = np.nan_to_num(np.asarray(largest, dtype=float), posinf=0.0)
    top = float(size.max(initial=0.0))
    if not top > 0:
        return 0.0
    weight = np.gradient(time) if len(time) > 1 else np.ones(1)
    acts = size > NOTHING * top
    end = time >= time[-1] - ENDING * (time[-1] - time[0])
    return max(quantile(size[acts], weight[acts], OFTEN), quantile(size[end], weight[end], 0.5))


def quantile(values: Array, weights: Array, share: float) -> float:
    """The least of ``values`` [k] that ``share`` of all ``weights`` [k] lies at or below."""
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weights[order])
    # a share that a sum of weights reaches is reached in spite of rounding
    place = int(np.searchsorted(below, share * below[-1] * (1 - 1e-12)))
    return float(values[order][min(place, len(values) - 1)])


def rounding(run: RunData) -> float:
    """The force [N] that rounding may leave where nothing acts."""
    mass = run.model.bodies.mass
    return float(ROUNDING * mass[np.isfinite(mass)].sum())


def largest_of(samples: Integers, sizes: Array, count: int) -> Array:
    """The largest of the ``sizes`` [m] of each of ``count`` samples, 0 of those without any."""
    found = np.zeros(count)
    np.maximum.at(found, samples, sizes)
    return found


def force_scale(run: RunData, width: float, view: View | None = None) -> ForceScale:
    """The scale of contact forces on a picture ``width`` [m] wide, or the one the view asks for."""
    given, arrays = (view or run.mechanism.view).force_scale, run.arrays
    sizes = np.hypot(*arrays["contact_force"].T)
    reference = typical(largest_of(arrays["contact_sample"], sizes, len(run.time)), run.time)
    if reference <= rounding(run):
        return NO_SCALE
    return ForceScale(given, reference) if given > 0 else scale_of(reference, REFERENCE * width)


def shared(scales: Iterable[ForceScale]) -> ForceScale:
    """The scale of arrows that several pictures share: that of the largest sizes."""
    return max(scales, key=lambda scale: scale.reference)


def decimals(reference: float) -> int:
    """Decimals of values on a scale: two, fewer from 10 on; below 0.1 two digits at least."""
    if 0 < reference < 0.1:
        return min(1 - math.floor(math.log10(reference)), MOST_DECIMALS)
    return 2 if reference < 10 else 1 if reference < 100 else 0


def pressure_unit(largest: float) -> tuple[float, str]:
    """The unit of pressures up to ``largest`` [Pa]: its size [Pa] and its name."""
    return next(((f, u) for f, u in PRESSURES if largest >= 0.9995 * f), PRESSURES[-1])


def prefixed(reference: float, unit: str) -> tuple[float, str, int]:
    """How values up to about ``reference`` are written: a factor, the unit and decimals.

    >>> prefixed(0.0016, "N m")
    (1000.0, 'mN m', 2)
    """
    size = abs(reference)
    factor, prefix = 1.0, ""
    if unit == "Pa":
        pascals, unit = pressure_unit(size)
        return 1 / pascals, unit, decimals(size / pascals)
    if unit == "m^3/s":
        factor, unit = 1e6, "ml/s"
    elif 0 < size < 1e-4:
        factor, prefix = 1e6, "µ"
    elif 0 < size < (1.0 if unit == "N m" else 0.1):
        factor, prefix = 1e3, "m"
    elif size >= 1e5:
        factor, prefix = 1e-3, "k"
    return factor, prefix + unit, decimals(factor * size)


def written(value: float, factor: float, places: int) -> str:
    """A value times a factor with decimals, without a negative 0."""
    text = f"{factor * value:.{places}f}"
    return text if float(text) else text.removeprefix("-")


def round_length(largest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``largest``, which is > 0."""
    power = 10.0 ** np.floor(np.log10(largest))
    step = max(s for s in (1.0, 2.0, 5.0) if s * power <= largest * (1 + 1e-9) or s == 1.0)
    return float(step * power)


def round_up(value: float) -> float:
    """The smallest of 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten not below ``value``.

    1 for nothing, and for numbers so small that no power of ten is.
    """
    if not value > 1e-300:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    steps = (1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0)
    return float(power * next(s for s in steps if s * power >= value * (1 - 1e-9)))
