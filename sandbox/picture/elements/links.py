"""What lies between two points: rods, ropes, actuators, springs, loaded bars and their numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.model.model import NONE
from sandbox.numeric import Array
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Point
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import prefixed
from sandbox.picture.subject import Subject
from sandbox.picture.tensions import UNLOADED, bars_of

Reach = tuple[float, float]
TELLING, SHORT = 12, 36.0
"""Numbers beside rods and ropes: of at most so many, and of none shorter than this [points]."""
BESIDE = 6.0
"""Distance of such a number from its rod [points]."""
TUBE, TUBE_WIDTH = 0.85, 13.0
"""Length of an actuator's cylinder as a share of the actuator's least length; width [points]."""
STROKE, LONGEST_TUBE = 0.88, 0.96
"""Shares of an actuator's least length: the longest stroke of one rod, the longest cylinder."""
TAUT = 0.998
"""A rope shorter than this fraction of its length is slack."""
COIL, COIL_WIDTH, COIL_SHARE = 1.1, (3.2, 8.0), 0.09
"""Springs: width of the line, least and largest half width of a coil [points], and half the width
of a coil as a share of its length."""
THICK = (0.5, 6.0)
"""Fractions of its own stiffness between which the line of a driven spring changes."""
BAND = 5.4
"""Width of a loaded bar's band [points]."""
ZIGZAG = [0, 0, 0.16, 0, *(v for k in range(10) for v in (
    round(0.16 + 0.68 * (k + 0.5) / 10, 4), 1 - 2 * (k % 2))), 0.84, 0, 1, 0]
"""A coil as the pattern of a span, with straight ends."""


def reach_of(run: RunData, joint: int) -> Reach:
    """Least and largest distance of a joint's points [m]; of an actuator those of the run."""
    low, high = run.model.joints.reach[joint].tolist()
    if not run.model.joints.kind[joint].line:
        return low, high
    length = run.arrays["joint_length"][:, joint]
    shortest, longest = float(length.min(initial=math.inf)), float(length.max(initial=0.0))
    return (low or shortest), (high if math.isfinite(high) else longest)


def add_links(s: Subject) -> None:
    """Rods, ropes and actuators, coloured by what they carry, with numbers if they are few."""
    model, carried = s.run.model, s.carried
    driven = {int(model.drives.target[i]) for i in model.drives.giving("push")}
    loaded = carried.loaded.tolist()
    for k, kind in enumerate(model.joints.kind):
        if not kind.along_line:
            continue
        bodies = model.joints.bodies[k].tolist()
        ends = [s.point_on(body, at) for body, at in zip(bodies, model.joints.anchor[k],
                                                         strict=True)]
        made = _Link(s, model.joints.name[k], ends, s.plane(*bodies),
                     s.held(int(model.ties.joint[k])))
        level = carried.links[:, k] / (carried.largest or 1.0)
        level[np.abs(level) <= UNLOADED] = 0.0
        if kind.keeps == "distance":
            made.tube(ends[0], ends[1], level)
        elif kind.line:
            made.actuator(reach_of(s.run, k), "drive" if k in driven else "pin_ring")
        else:
            made.rope(reach_of(s.run, k), level)
        if k in loaded and len(loaded) <= TELLING:
            made.number(carried.links[:, k], carried.largest, level != 0)


class _Link:
    """Adds the items of one link."""

    def __init__(self, s: Subject, name: str, ends: list[Point], plane: float,
                 shown: list[int] | None) -> None:
        self.s, self.name, self.ends, self.plane = s, name, ends, plane
        self.shown: dict[str, Any] = {} if shown is None else {"shown": shown}
        self.way = s.out.between(*ends)
        self.length = self.way.length

    def add(self, kind: str, **fields: Any) -> None:
        self.s.add("links", kind, self.name, plane=self.plane, **{**self.shown, **fields})

    def line(self, points: list[Point], token: str, width: float, **fields: Any) -> None:
        self.add("line", p=points, s=self.s.style("", token, width), **fields)

    def tube(self, start: Point, end: Point, level: Array) -> None:
        """A tube filled with the colour of what it carries."""
        s = self.s
        self.line([start, end], "pin_ring", 4.4)
        both = [s.style("", "paper", 2.6), s.style("", "@load", 2.6)]
        self.add("line", p=[start, end], s=both, state=s.out.varying(level != 0, steady=True),
                 by=s.out.varying(level, steady=True))

    def rope(self, reach: Reach, level: Array) -> None:
        """A taut rope with strands, a slack one dashed; with a least length a telescope."""
        s, (shortest, longest) = self.s, reach
        if shortest > 0:
            middle = self.way.at(self.length / 2)
            self.tube(self.ends[0], middle, level)
            self.line([middle, self.ends[1]], "pin_ring", 1.6)
            return
        taut = self.length > TAUT * longest
        if "shown" in self.shown:
            taut = taut & (s.out.columns[self.shown["shown"][0]] != 0)
        if taut.any():
            shown: dict[str, Any] = {"shown": s.out.varying(taut, steady=True)}
            both = [s.style("", "rope", 4.6), s.style("", "@load", 4.6)]
            self.add("line", p=self.ends, s=both, state=s.out.varying(level != 0, steady=True),
                     by=s.out.varying(level, steady=True), **shown)
            self.add("span", a=self.ends[0], b=self.ends[1], every=6.5, t=[-2.9, -2.9, 2.9, 2.9],
                     s=s.style("", "paper", 1.3), **shown)
        slack = self.length <= TAUT * longest
        if slack.any():
            held = s.out.columns[self.shown["shown"][0]] != 0 if "shown" in self.shown else True
            depth = np.sqrt(np.maximum(longest - self.length, 0.0) * self.length * 3 / 8)
            self.add("sag", a=self.ends[0], b=self.ends[1], s=s.style("", "rope", 1.3, 5),
                     depth=s.out.varying(np.minimum(depth, longest / 2)),
                     shown=s.out.varying(slack & held, steady=True))

    def actuator(self, reach: Reach, token: str) -> None:
        """A cylinder with its piston in a colour, and a rod of constant length."""
        point = self.s.point
        tube, piston = cylinder(self.length, *reach, 12 * point)
        inset, half = 1.4 * point, 3.0 * point
        middle = np.clip(piston, inset + half, np.maximum(tube - inset - half, inset + half))
        foot, cap, head, block = (self.way.at(far)[0] for far in (0.0, tube, piston, middle))
        self.line([[head, 0, 0], self.ends[1]], "pin_ring", 4.4)
        self.line([[foot, 0, 0], [cap, 0, 0]], "pin_ring", TUBE_WIDTH)
        self.line([[foot, inset, 0], [cap, -inset, 0]], "paper", TUBE_WIDTH - 2.6)
        self.line([[head, 0, 0], [cap, 0, 0]], "pin_ring", 4.4)
        self.line([[block, -half, 0], [block, half, 0]], token, TUBE_WIDTH - 2.6)

    def number(self, tension: Array, largest: float, there: Array) -> None:
        """What it carries [N], beside its middle."""
        s = self.s
        if float(self.length.max()) <= SHORT * s.point:
            return
        factor, unit, decimals = prefixed(largest, "N")
        there = there & (self.length > SHORT * s.point)
        if "shown" in self.shown:
            there = there & (s.out.columns[self.shown["shown"][0]] != 0)
        s.add("told", "text", self.name, at=self.way.at(self.length / 2), words="",
              value=s.out.column(tension, steady=True), factor=factor, unit=unit,
              decimals=decimals, s=s.style("", "ink"), rank=4, clear=BESIDE,
              shown=s.out.varying(there, steady=True))


def cylinder(length: Array, low: float, high: float, least: float) -> tuple[Array, Array]:
    """The length of a cylinder and the place of its piston [n], for an actuator's length [n].

    The cylinder is ``least`` long or more, if there is room; ``low`` and ``high`` are the least and
    largest length of the actuator. All in one unit.
    """
    stroke = high - low
    if stroke <= STROKE * low and TUBE * low >= least:
        tube = min(max(TUBE * low, stroke / STROKE * LONGEST_TUBE), LONGEST_TUBE * low)
        return np.full_like(length, tube), (tube - stroke) / 2 + length - low
    tubes = np.minimum(max(TUBE * low, 0.2 * high, least), 0.9 * length)
    share = (length - low) / stroke if stroke > 0 else np.full_like(length, 0.5)
    return tubes, tubes * (0.14 + 0.72 * np.clip(share, 0.0, 1.0))


def made_stiffer(fraction: Array) -> Array:
    """From -1 to 1, 0 at the element's own stiffness: how a driven stiffness shows."""
    low, high = THICK
    share = np.clip(fraction, low, high)
    return np.asarray(np.where(share > 1, np.log(share) / math.log(high),
                               -np.log(share) / math.log(low)))


def thickened(level: Array) -> Array:
    """The factor of a line's width for a level of :func:`made_stiffer`."""
    return np.asarray(1 + np.where(level > 0, 1.2, 0.3) * level)


def add_springs(s: Subject) -> None:
    """Coils between two points, spirals about hinges."""
    model, pose = s.run.model, s.run.arrays["body_pose"]
    springs, joints = model.springs, model.joints
    for k, name in enumerate(springs.name):
        a, b = springs.bodies[k].tolist()
        joint = int(springs.joint[k])
        hold = s.held(int(model.ties.spring[k]),
                      int(model.ties.joint[joint]) if joint >= 0 else NONE)
        shown: dict[str, Any] = {"plane": s.plane(a, b), "shown": hold}
        law, rest = springs.law[k], float(springs.rest[k])
        side = 0 if law is None else law.side
        if springs.straight[k]:
            ends = [s.point_on(body, at) for body, at in zip((a, b), springs.anchor[k],
                                                             strict=True)]
            apart = None
            if side:
                start, end = map(s.out.place, ends)
                size = np.maximum(np.hypot(*(end - start).T), 1e-12)
                apart = side * (size - rest) <= 0
            if side < 0 and (size > rest).any():  # it does not follow what leaves it
                tip = start + (end - start) * np.minimum(1.0, rest / size)[:, None]
                ends[1] = s.out.spot(tip)
            look = _spring_look(s, k, apart)
            s.add("springs", "span", name, a=ends[0], b=ends[1], t=ZIGZAG,
                  w=[COIL_SHARE, *COIL_WIDTH], **look, **shown)
            for at in ends:
                s.add("springs", "mark", at=at, g=glyph(s.out, "dot"), **shown)
        else:
            sense, wind = int(joints.sense[joint]), pose[:, b, 2] - pose[:, a, 2]
            now = sense * wind - joints.zero[joint]
            look = _spring_look(s, k, side * (now - rest) <= 0 if side else None)
            s.add("springs", "spiral", name, at=s.point_on(b, joints.anchor[joint, 1]), r=[5, 11],
                  start=s.out.varying(pose[:, a, 2]),
                  sweep=s.out.varying(sense * 1.5 * math.tau + wind), **look, **shown)


def _spring_look(s: Subject, k: int, apart: Array | None) -> dict[str, Any]:
    """Style of a spring: driven ones by their stiffness, grey where a one-sided one is apart."""
    springs = s.run.model.springs
    drive, own = int(springs.drive[k]), float(springs.stiffness[k])
    look: dict[str, Any] = {"s": s.style("", "spring", COIL)}
    if drive != NONE and own:
        level = made_stiffer(s.run.arrays["drive_value"][:, drive] / own)
        look = {"s": s.style("", "@stiffness", COIL), "by": s.out.varying(level),
                "wide": s.out.varying(thickened(level))}
    if apart is not None and apart.any():
        look |= {"s": [look["s"], s.style("", "slack", COIL)],
                 "state": s.out.varying(apart, steady=True)}
    return look


def add_bars(s: Subject) -> None:
    """Bands from pin to pin of bodies, in the colour of what they carry; numbers of a few."""
    bars, carried = bars_of(s.run, s.layers.of("bars")), s.carried
    for k, bar in enumerate(bars):
        ends = [s.point_on(bar.body, at) for at in bar.ends]
        level = carried.bars[:, k] / (carried.largest or 1.0)
        level[np.abs(level) <= UNLOADED] = 0.0
        plane = s.plane(bar.body)
        s.add("bars", "line", plane=plane, p=ends, s=s.style("", "pin_ring", BAND))
        s.add("bars", "line", s.run.mechanism.bodies[bar.body].name, plane=plane, p=ends,
              s=s.style("", "@load", BAND - 1.8), by=s.out.varying(level, steady=True))
        if len(bars) <= TELLING and carried.largest > 0 and (
                math.dist(*bar.ends) > SHORT * s.point):
            factor, unit, decimals = prefixed(carried.largest, "N")
            middle = s.point_on(bar.body, np.mean(bar.ends, axis=0))
            s.add("bars", "text", at=middle, words="", factor=factor, unit=unit,
                  decimals=decimals, value=s.out.column(carried.bars[:, k], steady=True),
                  s=s.style("", "ink"), rank=4, clear=BESIDE)
