"""Tendons: cords through eyes and over wheels, coloured by tension; dashed where slack."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.model.model import NONE
from sandbox.model.ties import held_of
from sandbox.numeric import Array, Flags
from sandbox.picture.elements.links import made_stiffer, thickened
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Point, short
from sandbox.picture.subject import Subject
from sandbox.picture.tensions import SLACK_FRACTION
from sandbox.samples.cords import off_wheels

CORD = 2.4
"""Width of a cord [points]."""
WOUND = 1.5
"""Length of cord that is shown on the wheel on which it ends [rad]."""
CREEP, LEAST_SLIP = 1e-3, 1e-6
"""A cord that slides less from sample to sample than this share of its largest slide, or than this
length [m], does not slip."""
NEAR_TURN = 0.02
"""Arcs that are so close to a whole turn are arcs of the other sign [rad]."""


def slipping(slip: Array) -> Flags:
    """In which samples a cord slides over each guide with friction, [n, nf].

    Args:
        slip: length of cord that has slid over it since t = 0 [m], [n, nf].
    """
    slid = np.abs(np.diff(slip, axis=0, prepend=slip[:1]))
    least = CREEP * np.maximum(slid.max(axis=0, initial=0.0), LEAST_SLIP)
    return np.asarray(slid > least, dtype=bool)


def arcs(places: Sequence[Array], radii: Sequence[float], senses: Sequence[int], on: Flags, *,
         closed: bool) -> tuple[Array, Array]:
    """The angles at which a cord meets and leaves each guide [n, g] rad; NaN where it is off it.

    Args:
        places: centres of the guides, each [n, 2] m.
        radii: of the wheels [m]; 0 for an eye.
        senses: 1 where the centre lies right of the cord, else -1.
        on: whether the cord lies on each guide, [n, g].
        closed: whether the last guide is the first again.
    """
    meets, leaves = (np.full(on.shape, np.nan) for _ in range(2))
    for pattern in on[:1] if on.all() else np.unique(on, axis=0):
        rows = (on == pattern).all(axis=1)
        guides = np.flatnonzero(pattern).tolist()
        for i, j in pairwise(guides):
            way = places[j][rows] - places[i][rows]
            length = np.maximum(np.hypot(*way.T), 1e-12)
            m = np.clip((senses[i] * radii[i] - senses[j] * radii[j]) / length, -1, 1)
            e, k = way / length[:, None], np.sqrt(1 - m * m)
            normal = np.arctan2(m * e[:, 1] + k * e[:, 0], m * e[:, 0] - k * e[:, 1])
            leaves[rows, i] = normal if senses[i] > 0 else normal + np.pi
            meets[rows, j] = normal if senses[j] > 0 else normal + np.pi
        first, last = guides[0], guides[-1]
        if closed:
            meets[rows, first], leaves[rows, last] = meets[rows, last], leaves[rows, first]
        else:
            meets[rows, first] = leaves[rows, first] + senses[first] * WOUND
            leaves[rows, last] = meets[rows, last] - senses[last] * WOUND
    for g, sense in enumerate(senses):
        there = np.isfinite(meets[:, g])
        start = np.unwrap(meets[there, g])
        sweep = (sense * (meets[there, g] - leaves[there, g])) % math.tau
        sweep = np.where(sweep > math.tau - NEAR_TURN, sweep - math.tau, sweep)
        meets[there, g], leaves[there, g] = start, start - sense * sweep
    return meets, leaves


def add_cords(s: Subject) -> None:
    """Every tendon with its eyes."""
    off = off_wheels(s.run.arrays)
    hold = held_of(s.run.model.ties.tendon, s.run.arrays["held"]).T
    slips = slipping(s.run.arrays["guide_slip"])
    for k in range(len(s.run.mechanism.tendons)):
        _Cord(s, k, off[:, s.run.model.tendons.loose(k)], hold[:, k]).add(slips)


class _Cord:
    """Adds the items of one tendon."""

    def __init__(self, s: Subject, k: int, off: Flags, hold: Flags) -> None:
        self.s, self.k = s, k
        tendons, spec = s.run.model.tendons, s.run.mechanism.tendons[k]
        where = tendons.guides(k)
        self.spec, self.name = spec, tendons.name[k]
        self.bodies = tendons.guide_body[where].tolist()
        self.radii = [short(guide.radius) for guide in spec.path]
        self.senses = [1 if guide.side == "right" else -1 for guide in spec.path]
        self.points = [s.point_on(body, at) for body, at in zip(
            self.bodies, tendons.guide_at[where], strict=True)]
        self.turns = tendons.guide_turns[where]
        self.plane = s.plane(*self.bodies)
        own = np.flatnonzero(tendons.stretch_tendon == k)
        self.gripped = tendons.gripped(k).tolist()
        self.stretches = own if self.gripped else own[-1:]
        self.shown: dict[str, Any] = {} if hold.all() else {
            "shown": s.out.varying(hold, steady=True)}
        self.hold = hold
        self.on = np.ones((len(s.run.time), len(self.points)), dtype=bool)
        for guide, is_off in zip(spec.lifting, off.T, strict=True):
            self.on[:, guide] = ~is_off
        self.wide: dict[str, Any] = {}
        stiffener = int(tendons.stiffener[k])
        if stiffener != NONE:
            value = s.run.arrays["drive_value"][:, stiffener]
            self.wide = {"wide": s.out.varying(thickened(made_stiffer(
                value / float(tendons.stiffness[k]))))}

    def add(self, slips: Flags) -> None:
        """The cord, collars where guides have friction, and its eyes."""
        s = self.s
        places: list[Array] = []
        meets = leaves = np.zeros(self.on.shape)
        if self.gripped or any(self.radii) or not self.on.all():
            places = [s.out.place(point) for point in self.points]
            meets, leaves = arcs(places, self.radii, self.senses, self.on,
                                 closed=self.spec.closed)
            leaves = leaves - np.array(self.senses) * math.tau * (self.turns > 0)
        last = len(self.points) - self.spec.closed
        if not self.gripped:
            self.line([self.guide(g, meets[:, g], leaves[:, g]) for g in range(last)],
                      s.carried.pieces[:, self.stretches[0]], 1 if self.spec.closed else None)
        else:
            self.pieces(places, meets, leaves)
            for guide, grip in zip(self.spec.gripping, self.gripped, strict=True):
                self.collar(guide, places[guide], (meets[:, guide] + leaves[:, guide]) / 2,
                            slips[:, grip])
        for g in range(last):
            if not self.radii[g]:
                s.add("cords", "mark", plane=self.plane, rank=2, at=self.points[g],
                      g=glyph(s.out, "eye"), **self.shown)

    def guide(self, g: int, meets: Array, leaves: Array) -> list[Any]:
        """A guide as a taut item has it."""
        base = [*self.points[g], self.radii[g], self.senses[g]]
        if not self.radii[g] and self.on[:, g].all():
            return base
        return [*base, self.s.out.varying(meets), self.s.out.varying(leaves)]

    def line(self, guides: list[Any], tension: Array, closed: int | None = None,
             there: Flags | None = None) -> None:
        """One cord of one tension."""
        s = self.s
        share = tension / (s.carried.largest or 1.0)
        slack = share <= SLACK_FRACTION
        shown = dict(self.shown)
        if there is not None and not there.all():
            shown = {"shown": s.out.varying(there & self.hold, steady=True)}
        s.add("cords", "taut", self.name, plane=self.plane, rank=float(np.mean(share)) - 1,
              p=guides, c=closed, s=[s.style("", "@load", CORD), s.style("", "slack", 1.8, 5)],
              state=s.out.varying(slack, steady=True),
              by=s.out.varying(np.where(slack, 0.0, share), steady=True), **self.wide, **shown)

    def pieces(self, places: list[Array], meets: Array, leaves: Array) -> None:
        """Each straight piece with half of the arcs at its ends, in the colour of its tension."""
        count = len(self.points)
        middle = (meets + leaves) / 2
        for g in range(count - 1):
            there = self.on[:, g]
            following = np.array([next(h for h in range(g + 1, count) if row[h])
                                  for row in self.on])
            h = g + 1
            start = self.guide(g, leaves[:, g] if g == 0 and not self.spec.closed
                               else middle[:, g], leaves[:, g])
            if g == 0 and self.radii[0] and not self.spec.closed:
                start = self.guide(0, meets[:, 0], leaves[:, 0])
            end_at = leaves[:, h] if h == count - 1 and not self.spec.closed else middle[:, h]
            if (following == h).all():
                end = self.guide(h, meets[:, h], end_at)
            else:
                end = self._moved_end(places, following, meets, middle)
            self.line([start, end], self.s.carried.pieces[:, self.stretches[g]], there=there)

    def _moved_end(self, places: list[Array], following: Array, meets: Array,
                   middle: Array) -> list[Any]:
        """The end of a piece that skips guides which the cord has left."""
        rows = np.arange(len(following))
        centre = np.stack(places, axis=1)[rows, following]
        h = int(following[0])
        return [*self.s.out.spot(centre), self.radii[h], self.senses[h],
                self.s.out.varying(meets[rows, following]),
                self.s.out.varying(middle[rows, following])]

    def collar(self, guide: int, centre: Array, angle: Array, slips: Flags) -> None:
        """A ring at a guide with friction: full while that holds."""
        s, radius = self.s, self.radii[guide]
        at: Point = self.points[guide]
        if radius:
            place = centre + radius * np.column_stack((np.cos(angle), np.sin(angle)))
            at = s.out.spot(place)
        there = self.on[:, guide] & self.hold
        s.add("cords", "mark", plane=self.plane, rank=1, at=at, state=s.out.varying(
            ~slips, steady=True), g=[glyph(s.out, "slides"), glyph(s.out, "rubs")],
            shown=None if there.all() else s.out.varying(there, steady=True))
