"""Scales of arrows and tension colours; round numbers and units.

Sizes are weighted by time: a scale fits the largest arrow of nearly every picture, not the maximum
of the run. An impact lasts a sample or a few; on its scale, all other arrows would have no length.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.figure.style import pressure_unit
from sandbox.model.joints import link_tensions
from sandbox.numeric import Array, Flags, Integers
from sandbox.picture.listing import RunData
from sandbox.samples.cables import piece_tensions
from sandbox.scene.settings import View

OFTEN = 0.9  # share of the active time in which no arrow exceeds the reference
ENDING = 0.1  # last share of the run whose median counts, too: the end is looked at longest
REFERENCE, LONGEST = 0.085, 1.5
"""Reference arrow [picture widths]; longer arrows are cut at this multiple."""
IMPACT = 5.0  # minimum ratio of an impact to the forces of its pair a sample before and after
UNLOADED = 1e-3  # links below this are unloaded [tops of the scale]
SLACK_FRACTION, UNSEEN = 1e-6, 1e-5  # slack, and without colour [tops of the scale]


class ForceScale(NamedTuple):
    """Length of arrows, of forces or of other quantities."""

    metres: float = 0.0  # length of an arrow of size 1 [m]; 0 where there is nothing to show
    reference: float = 0.0  # a typical large size of the run [N, or the unit of the quantity]

    @property
    def longest(self) -> float:
        """Arrows of larger sizes are cut."""
        return self.reference * LONGEST


def scale_of(reference: float, length: float) -> ForceScale:
    """The scale of arrows whose reference size has this length [m]."""
    return ForceScale(length / reference, reference) if reference > 0 else ForceScale()


def typical(largest: Array, time: Array) -> float:
    """Time-weighted quantile of the largest arrows [n], or the final median if larger, else 0."""
    size = np.nan_to_num(np.asarray(largest, dtype=float), posinf=0.0)
    top = float(size.max(initial=0.0))
    if not top > 0:
        return 0.0
    weight = np.gradient(time) if len(time) > 1 else np.ones(1)

    def quantile(some: Flags, share: float) -> float:
        order = np.argsort(size[some], kind="stable")
        below = np.cumsum(weight[some][order])
        # a share that a sum of weights reaches is reached in spite of rounding
        place = int(np.searchsorted(below, share * below[-1] * (1 - 1e-12)))
        return float(size[some][order[min(place, len(order) - 1)]])

    end = time >= time[-1] - ENDING * (time[-1] - time[0])
    return max(quantile(size > 1e-6 * top, OFTEN), quantile(end, 0.5))


def rounding(run: RunData) -> float:
    """The force [N] that rounding may leave where nothing acts."""
    mass = run.model.bodies.mass
    return float(1e-6 * mass[np.isfinite(mass)].sum())


def largest_of(samples: Integers, sizes: Array, count: int) -> Array:
    """The largest of the ``sizes`` [m] of each of ``count`` samples; 0 without any."""
    found = np.zeros(count)
    np.maximum.at(found, samples, sizes)
    return found


def lasting(run: RunData, sizes: Array) -> Flags:
    """Which contact forces of these sizes are no impacts: the same pair has a similar one next."""
    arrays, count = run.arrays, len(run.time) + 1
    one, other = (arrays[f"contact_{key}"].astype(np.int64) for key in ("body", "other"))
    place = (one * len(run.mechanism.bodies) + other) * count + arrays["contact_sample"]
    known, which = np.unique(place, return_inverse=True)
    largest, beside = largest_of(which, sizes, len(known)), np.zeros(len(sizes))
    for following in (place - 1, place + 1):
        at = np.minimum(np.searchsorted(known, following), len(known) - 1)
        beside = np.maximum(beside, np.where(known[at] == following, largest[at], 0.0))
    return np.asarray(sizes <= IMPACT * beside)


def force_scale(run: RunData, width: float, view: View | None = None) -> ForceScale:
    """The scale of contact forces on a picture ``width`` [m] wide, or that of the view."""
    given, arrays = (view or run.mechanism.view).force_scale, run.arrays
    sizes = np.hypot(*arrays["contact_force"].T)
    every, lasts = (typical(largest_of(arrays["contact_sample"], some, len(run.time)), run.time)
                    for some in (sizes, np.where(lasting(run, sizes), sizes, 0.0)))
    # of impacts so frequent that other arrows would be short
    reference = lasts if rounding(run) < lasts < every / LONGEST else every
    if reference <= rounding(run):
        return ForceScale()
    return ForceScale(given, reference) if given > 0 else scale_of(reference, REFERENCE * width)


def shared(scales: Iterable[ForceScale]) -> ForceScale:
    """The scale for several pictures: that of the largest sizes."""
    return max(scales, key=lambda scale: scale.reference)


def prefixed(reference: float, unit: str) -> tuple[float, str, int]:
    """Factor, unit and decimals to write values up to about ``reference``.

    Two decimals, fewer from 10 on; below 0.1 two digits at least.

    >>> prefixed(0.0016, "N m")
    (1000.0, 'mN m', 2)
    """
    size = abs(reference)
    factor, prefix = 1.0, ""
    if unit == "Pa":
        pascals, unit = pressure_unit(size)
        factor, size = 1 / pascals, size / pascals
    elif unit == "m^3/s":
        factor, unit, size = 1e6, "ml/s", 1e6 * size
    else:
        if 0 < size < 1e-4:
            factor, prefix = 1e6, "µ"
        elif 0 < size < (1.0 if unit == "N m" else 0.1):
            factor, prefix = 1e3, "m"
        elif size >= 1e5:
            factor, prefix = 1e-3, "k"
        size *= factor
    decimals = 2 if size < 10 else 1 if size < 100 else 0
    if 0 < size < 0.1:
        decimals = min(1 - math.floor(math.log10(size)), 9)
    return factor, prefix + unit, decimals


def round_length(largest: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above ``largest``, which is > 0."""
    power = 10.0 ** np.floor(np.log10(largest))
    step = max(s for s in (1.0, 2.0, 5.0) if s * power <= largest * (1 + 1e-9) or s == 1.0)
    return float(step * power)


def round_up(value: float, steps: Sequence[float] = (1, 1.5, 2, 3, 4, 5, 6, 8)) -> float:
    """The smallest of ``steps`` times a power of ten from ``value`` on; 1 for 0.

    >>> round_up(1.2), round_up(0.07, (1, 2, 5))
    (1.5, 0.1)
    """
    if not value > 1e-300:
        return 1.0
    power = 10.0 ** np.floor(np.log10(value))
    return float(power * next(s for s in (*steps, 10.0) if s * power >= value * (1 - 1e-9)))


class PinnedBar(NamedTuple):
    """A body with pins in two places."""

    body: int
    ends: list[tuple[float, float]]  # in its frame [m], two
    joints: list[list[int]]  # those at either end


def bars_of(run: RunData, bodies: Sequence[int]) -> list[PinnedBar]:
    """Those of ``bodies`` that move and that pins hold in exactly two places."""
    joints, found = run.model.joints, dict[int, dict[tuple[float, float], list[int]]]()
    for k, kind in enumerate(joints.kind):
        for body, (x, y) in zip(joints.bodies[k].tolist(), joints.anchor[k].tolist(),
                                strict=True) if kind.keeps == "point" else ():
            ends = found.setdefault(body, {})
            near = next((at for at in ends if abs(at[0] - x) + abs(at[1] - y) <= 1e-9), (x, y))
            ends.setdefault(near, []).append(k)
    return [PinnedBar(body, [*ends], [*ends.values()]) for body, ends in sorted(found.items())
            if len(ends) == 2 and body in bodies and not run.model.bodies.fixed[body]]


def bar_tensions(run: RunData, bars: Sequence[PinnedBar]) -> Array:
    """The tension of each bar [N], negative where it pushes, [n, k].

    With the forces F of the pins on the bar and u from one to the other it is (F2 - F1) . u / 2,
    the mean of both ends.
    """
    force, angle = run.arrays["joint_force"], run.arrays["body_pose"][..., 2]
    tension = np.zeros((len(angle), len(bars)))
    for k, bar in enumerate(bars):
        (x0, y0), (x1, y1) = bar.ends
        way = angle[:, bar.body] + np.arctan2(y1 - y0, x1 - x0)
        start, end = (np.einsum("nki,k->ni", force[:, own], np.where(
            run.model.joints.bodies[own, 1] == bar.body, 1.0, -1.0)) for own in bar.joints)
        x, y = (end - start).T
        tension[:, k] = (x * np.cos(way) + y * np.sin(way)) / 2
    return np.nan_to_num(tension)


class Tensions(NamedTuple):
    """Tensions of a run, negative where a link pushes, and the scale that shows them."""

    pieces: Array  # of all straight pieces of tendons [N], [n, m]
    links: Array  # of all joints along a line [N], [n, nj]; 0 of others
    bars: Array  # of bodies between two pins that are shown as bars [N], [n, k]
    largest: float  # top of the scale [N]; 0 if nothing carries anything
    pushing: frozenset[str]
    """The layers, ``tensions`` of links and ``bars``, in which something pushes visibly."""

    def beside(self, others: Iterable[Tensions]) -> Tensions:
        """The same on the scale that has room for those of other runs too."""
        every = (self, *others)
        return self._replace(largest=max(each.largest for each in every),
                             pushing=self.pushing.union(*(each.pushing for each in every)))

    def hidden(self) -> Tensions:
        """Without colours, except of bars: tendons are grey, slack ones dashed."""
        loaded = self.pieces > SLACK_FRACTION * self.largest
        return self._replace(pieces=np.where(loaded, UNSEEN * self.largest, 0.0),
                             links=np.zeros_like(self.links))


def tensions_of(run: RunData, bars: Sequence[PinnedBar] = ()) -> Tensions:
    """Tensions of a run; ``bars`` share the scale of tendons, rods and ropes."""
    pieces = piece_tensions(run.model, run.arrays).T
    links = np.zeros(run.arrays["joint_reaction"].shape)
    lines = [k for k, joint in enumerate(run.mechanism.joints) if "tension" in joint.facts.records]
    links[:, lines] = np.nan_to_num(link_tensions(run.model, run.arrays, np.array(lines, np.intp)))
    carried = bar_tensions(run, bars)
    for each in (pieces, links, carried):
        if np.abs(each).max(initial=0.0) <= rounding(run):
            each[:] = 0.0
    largest = largest_tension(np.abs(np.column_stack([pieces, links, carried])))
    pushing = frozenset(layer for layer, each in (("tensions", links), ("bars", carried))
                        if (each < -UNLOADED * largest).any())
    return Tensions(pieces, links, carried, largest, pushing)


def largest_tension(tension: Array) -> float:
    """The top of the scale [N] of tensions [n, m]: a round number above nearly all samples."""
    if not tension.size:
        return 0.0
    each = tension.max(axis=1)
    peak = float(np.quantile(each, 0.995))
    loaded = each[each > UNLOADED * peak]
    if not peak > 0 or not loaded.size:
        return 0.0
    usual = 2.0 * float(np.quantile(loaded, 0.75))
    return round_up(max(min(peak, usual), float(each[-1])))
