"""What tendons, rods and ropes carry, on one scale of colours."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import link_tensions
from sandbox.numeric import Array, Integers
from sandbox.picture.palette import PUSH, TENSION, Colour
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import round_up, rounding
from sandbox.samples.cords import piece_tensions

SAME = 1e-9
"""Pins of a body that are no farther apart are one [m]."""
UNLOADED = 1e-3
"""Of the scale's top: a link that carries no more is drawn as one that carries nothing."""
USUAL, SPIKE = 0.75, 2.0
"""The share of the samples that carry anything, above which they are rare; how many times as large
as the others the scale's top may be for the sake of these."""
SLACK_FRACTION, UNSEEN = 1e-6, 1e-5
"""Tensions below the first fraction of the scale count as slack; the second has no colour yet."""


class PinnedBar(NamedTuple):
    """A body with pins in two places."""

    body: int
    ends: list[tuple[float, float]]
    """In its frame [m], two."""
    joints: list[list[int]]
    """Those at either end."""


def bars_of(run: RunData, bodies: Sequence[int]) -> list[PinnedBar]:
    """Those of ``bodies`` that move and that pins hold in exactly two places."""
    joints, found = run.model.joints, dict[int, PinnedBar]()
    for k, kind in enumerate(joints.kind):
        for body, (x, y) in zip(joints.bodies[k].tolist(), joints.anchor[k].tolist(),
                                strict=True) if kind.keeps == "point" else ():
            bar = found.setdefault(body, PinnedBar(body, [], []))
            near = next((own for at, own in zip(bar.ends, bar.joints, strict=True)
                         if abs(at[0] - x) + abs(at[1] - y) <= SAME), None)
            if near is None:
                bar.ends.append((x, y))
                bar.joints.append([k])
            else:
                near.append(k)
    return [bar for body, bar in sorted(found.items()) if len(bar.ends) == 2
            and body in bodies and not run.model.bodies.fixed[body]]


def bar_tensions(run: RunData, bars: Sequence[PinnedBar]) -> Array:
    """The pull that each bar carries from pin to pin [N], negative where it pushes, [n, k].

    With the forces F of the pins on the bar and u from one to the other it is (F2 - F1) . u / 2:
    the tension where nothing else loads the bar, else the mean of that at either end.
    """
    force, angle = run.arrays["joint_force"], run.arrays["body_pose"][..., 2]
    tension = np.zeros((len(angle), len(bars)))
    for k, bar in enumerate(bars):
        (x0, y0), (x1, y1) = bar.ends
        way = angle[:, bar.body] + np.arctan2(y1 - y0, x1 - x0)
        sides = [np.where(run.model.joints.bodies[own, 1] == bar.body, 1.0, -1.0)
                 for own in bar.joints]
        start, end = (np.einsum("nki,k->ni", force[:, own], side)
                      for own, side in zip(bar.joints, sides, strict=True))
        carried = end - start
        tension[:, k] = (carried[:, 0] * np.cos(way) + carried[:, 1] * np.sin(way)) / 2
    return np.nan_to_num(tension)


class Tensions(NamedTuple):
    """Tensions of a run, negative where a link pushes, and the scale that shows them."""

    pieces: Array
    """Of all straight pieces of tendons [N], [n, m]."""
    links: Array
    """Of all joints along a line [N], [n, nj]; 0 of others."""
    bars: Array
    """Of bodies between two pins that are shown as bars [N], [n, k]."""
    largest: float
    """Top of the scale [N]; 0 if nothing carries anything."""
    pushing: frozenset[str]
    """The layers, ``tensions`` of links and ``bars``, in which something pushes visibly."""

    @property
    def colours(self) -> tuple[Colour, ...]:
        """All that may occur."""
        return TENSION + PUSH if self.pushing else TENSION

    @property
    def loaded(self) -> Integers:
        """The joints whose links carry something at some time."""
        sizes = np.abs(self.links).max(axis=0, initial=0.0)
        return np.flatnonzero(sizes > UNLOADED * self.largest)

    def beside(self, others: Iterable[Tensions]) -> Tensions:
        """The same on the scale that has room for those of other runs too."""
        every = (self, *others)
        return self._replace(largest=max(each.largest for each in every),
                             pushing=self.pushing.union(*(each.pushing for each in every)))

    def hidden(self) -> Tensions:
        """The same where no colours are shown: tendons are grey, slack ones dashed.

        Bars, which are nothing else, keep theirs.
        """
        loaded = self.pieces > SLACK_FRACTION * self.largest
        return self._replace(pieces=np.where(loaded, UNSEEN * self.largest, 0.0),
                             links=np.zeros_like(self.links))


def tensions_of(run: RunData, bars: Sequence[PinnedBar] = ()) -> Tensions:
    """Those of a run; the ``bars`` are measured by the same scale as tendons, rods and ropes."""
    pieces = piece_tensions(run.model, run.arrays).T
    links = np.zeros(run.arrays["joint_reaction"].shape)
    lines = [k for k, joint in enumerate(run.mechanism.joints)
             if "tension" in joint.facts.records]
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
    """The top of the scale [N] of tensions [n, m]: a round number above nearly all of the run.

    The sharpest 0.5 % of samples may lie above it, and more where they are so large that what
    tendons carry else would have no colour.
    """
    if not tension.size:
        return 0.0
    each = tension.max(axis=1)
    peak = float(np.quantile(each, 0.995))
    loaded = each[each > UNLOADED * peak]
    if not peak > 0 or not loaded.size:
        return 0.0
    usual = SPIKE * float(np.quantile(loaded, USUAL))
    return round_up(max(min(peak, usual), float(each[-1])))
