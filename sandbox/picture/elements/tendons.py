"""Tendons through eyes and over wheels, dashed where slack; chambers, hoses, valves and pumps."""

from __future__ import annotations

import math
from functools import partial
from typing import Any

import numpy as np

from sandbox.model.model import NONE, held_of
from sandbox.numeric import Array, Flags, Integers
from sandbox.picture.elements.joints import cylinder, made_stiffer
from sandbox.picture.listing import Between, Number, Point, RunData, flat, short
from sandbox.picture.scales import SLACK_FRACTION, round_up
from sandbox.picture.subject import Subject
from sandbox.samples.cables import Frames

WOUND = 1.5  # length of a tendon that is shown on the wheel on which it ends [rad]
CREEP, MIN_SLIP = 1e-3, 1e-6  # minimum slip: per sample [largest one], of that [m]
TUBE, TUBE_SHARE = (4.5, 9.0), 0.13  # half width of a cylinder: limits [points], [lengths]
HOSE, VANE = 1.6, 10.0  # width of a hose and radius of a chamber on a hinge [points]
PUMP, TANK, BESIDE = (-24.0, 26.0), (40.0, 14.0), (-78.0, 12.0)
"""Offsets of pump, tank, line [points]."""


def arcs(normal: Array, senses: Integers, on: Flags, *, closed: bool) -> tuple[Array, Array]:
    """The angles [n, g] rad at which a tendon meets and leaves guides; NaN off the guide.

    ``normal`` are the angles left of its straight pieces, [n, g - 1] rad.
    """
    meets, leaves = np.where(on, 0.0, np.nan), np.zeros(on.shape)
    opposite = np.where(senses > 0, 0.0, np.pi)
    meets[:, 1:] += normal + opposite[1:]
    leaves[:, :-1] = normal + opposite[:-1]
    meets[:, 0] += meets[:, -1] if closed else leaves[:, 0] + senses[0] * WOUND
    leaves[:, -1] = leaves[:, 0] if closed else meets[:, -1] - senses[-1] * WOUND
    sweep = (senses * (meets - leaves) + 0.02) % math.tau - 0.02
    for column, there in zip(meets.T, on.T, strict=True):
        column[there] = np.unwrap(column[there])
    return meets, meets - senses * sweep


def add_cables(s: Subject) -> None:
    """Every tendon with its eyes, and collars where guides have friction."""
    off, slip = s.run.arrays["guide_lifted"] > 0, s.run.arrays["guide_slip"]
    slid = np.abs(np.diff(slip, axis=0, prepend=slip[:1]))
    slips = slid > CREEP * np.maximum(slid.max(axis=0, initial=0.0), MIN_SLIP)
    cables = Frames(s.run.model, s.run.arrays).cables
    normals: Array = np.arctan2(cables.x, -cables.y).T.round(9)  # equal ones stay equal
    for k, spec in enumerate(s.run.mechanism.tendons):
        own = np.flatnonzero(s.run.model.tendons.stretch_tendon == k)
        cable = _Cable(s, k, off[:, s.run.model.tendons.loose(k)], normals[:, own])
        gripped = s.run.model.tendons.gripped(k).tolist()
        last = len(cable.points) - spec.closed
        if not gripped:
            cable.line([cable.guide(g, cable.meets[:, g], cable.leaves[:, g]) for g in range(last)],
                      own[-1], 1 if spec.closed else None)
        else:
            cable.pieces(own)
            for guide, grip in zip(spec.gripping, gripped, strict=True):
                cable.collar(guide, slips[:, grip])
        for g in range(last):
            if not cable.radii[g]:
                cable.add("mark", rank=2, at=cable.points[g], g="eye",
                          shown=s.during(cable.hold))


class _Cable:
    """Adds the items of one tendon."""

    def __init__(self, s: Subject, k: int, off: Flags, normal: Array) -> None:
        tendons, spec = s.run.model.tendons, s.run.mechanism.tendons[k]
        where, path = tendons.guides(k), spec.path
        self.s, self.closed, self.name = s, spec.closed, tendons.name[k]
        bodies = tendons.guide_body[where].tolist()
        self.radii = [short(guide.radius) for guide in path]
        self.senses = np.array([1 if guide.side == "right" else -1 for guide in path])
        self.points = [s.on(*at) for at in zip(bodies, tendons.guide_at[where], strict=True)]
        self.add = partial(s.add, "cables", plane=s.plane(*bodies))
        self.hold = held_of(int(s.run.model.bonds.tendon[k]), s.run.arrays["held"])
        self.on = np.ones((len(s.run.time), len(path)), dtype=bool)
        self.on[:, list(spec.lifting)] = ~off
        drive = int(tendons.stiffener[k])
        self.wide = None if drive == NONE else s.out.varying(
            made_stiffer(s, drive, float(tendons.stiffness[k]))[1])
        self.places = [s.out.place(point) for point in self.points]
        self.meets, leaves = arcs(normal, self.senses, self.on, closed=self.closed)
        self.leaves = leaves - self.senses * math.tau * (tendons.guide_turns[where] > 0)
        self.middle = (self.meets + self.leaves) / 2

    def guide(self, g: int, meets: Array, leaves: Array, at: Point | None = None) -> list[Any]:
        """A guide as a taut item has it."""
        base = [*(at or self.points[g]), self.radii[g], int(self.senses[g])]
        if at is None and not self.radii[g] and self.on[:, g].all():
            return base
        return [*base, self.s.out.varying(meets), self.s.out.varying(leaves)]

    def line(self, guides: list[Any], stretch: int, closed: int | None = None,
             there: Flags | bool = True) -> None:
        s = self.s
        share = s.carried.pieces[:, stretch] / (s.carried.largest or 1.0)
        slack = share <= SLACK_FRACTION
        self.add("taut", self.name, rank=float(np.mean(share)) - 1, p=guides, c=closed,
                 s=[("", "@load", 2.4), ("", "slack", 1.8, 5)], state=s.steady(slack),
                 by=s.steady(np.where(slack, 0.0, share)), wide=self.wide,
                 shown=s.during(self.hold & there))

    def pieces(self, stretches: Integers) -> None:
        """Each straight piece with half of the arcs at its ends, in the colour of its tension."""
        rows, middle = np.arange(len(self.on)), self.middle.copy()
        if not self.closed:
            middle[:, 0] = (self.meets if self.radii[0] else self.leaves)[:, 0]
            middle[:, -1] = self.leaves[:, -1]
        for g in range(len(self.points) - 1):
            following = g + 1 + np.argmax(self.on[:, g + 1:], axis=1)
            start = self.guide(g, middle[:, g], self.leaves[:, g])
            if (following == g + 1).all():
                end = self.guide(g + 1, self.meets[:, g + 1], middle[:, g + 1])
            else:  # it skips guides that the tendon has left
                centre = np.stack(self.places, axis=1)[rows, following]
                end = self.guide(int(following[0]), self.meets[rows, following],
                                 self.middle[rows, following], self.s.out.spot(centre))
            self.line([start, end], stretches[g], there=self.on[:, g])

    def collar(self, guide: int, slips: Flags) -> None:
        s, at = self.s, self.points[guide]
        if radius := self.radii[guide]:
            angle = self.middle[:, guide]
            at = s.out.spot(self.places[guide] + radius * np.column_stack(
                (np.cos(angle), np.sin(angle))))
        self.add("mark", rank=1, at=at, state=s.steady(~slips), g=["slides", "rubs"],
                 shown=s.during(self.on[:, guide] & self.hold))


def largest_pressure(run: RunData) -> float:
    """The top of the pressure scale [Pa]: a round number above nearly all of the run."""
    pressure = np.abs(run.arrays["line_pressure"])
    if not pressure.size or np.isnan(pressure).all():
        return 0.0
    peak = float(np.nanquantile(pressure.max(axis=1), 0.995))
    return round_up(max(peak, float(pressure[-1].max()))) if peak > 0 else 0.0


def add_fluids(s: Subject) -> None:
    """Hoses, chambers, valves and pumps."""
    fluids = _Fluids(s)
    for chamber in range(len(fluids.lines.of)):
        fluids.chamber(chamber)
    for line, ports in enumerate(fluids.ports):
        if len(ports) > 1:
            fluids.line(ports, "@load", HOSE, by=fluids.level(line))
    if fluids.lines.name and fluids.largest > 0:
        s.signs.add("pressure")
    fluids.valves()
    fluids.pumps()


class _Fluids:
    """Adds the items of all lines of fluid."""

    def __init__(self, s: Subject) -> None:
        self.s, self.largest = s, max(map(largest_pressure, (s.run, *s.beside)))
        self.lines, self.pressure = s.run.model.lines, s.run.arrays["line_pressure"]
        self.put = partial(s.add, "fluids", plane=s.plane(*self.lines.bodies.ravel().tolist()))
        self.ports: list[list[Point]] = [[] for _ in self.lines.name]

    def level(self, line: int) -> Number:
        """A line's pressure on the scale of colours."""
        return self.s.steady(np.abs(self.pressure[:, line]) / (self.largest or 1.0))

    def line(self, points: list[Point], token: str, width: float, **fields: Any) -> None:
        self.put("line", p=points, s=("", token, width), **fields)

    def chamber(self, n: int) -> None:
        """A vane about a hinge, or a cylinder with its piston, as long as the run allows."""
        s, lines = self.s, self.lines
        line, joint, bodies = int(lines.of[n]), int(lines.joint[n]), lines.bodies[n].tolist()
        if joint != NONE:
            at = s.on(bodies[1], s.run.model.joints.anchor[joint, 1])
            self.put("path", rank=1, f=at[0], s=("@load", "pin_ring", 1.2),
                     d=[{"c": [*at[1:], *at[1:], short(VANE * s.point)]}], by=self.level(line))
            self.ports[line].append(at)
            return
        name, pulls, ends = lines.name[line], bool(lines.gain[n] < 0), [
            s.on(*end) for end in zip(bodies, lines.anchor[n], strict=True)]
        way = Between(s.out, *map(s.out.place, ends))
        tubes, piston = cylinder(way.length, float(way.length.min()), float(way.length.max()), 0.0)
        tube = float(tubes.min())
        foot, head = (way.at(far)[0] for far in (0.0, np.minimum(piston, tube)))
        half = min(max(TUBE_SHARE * tube, TUBE[0] * s.point), TUBE[1] * s.point)
        level, box = self.level(line), [flat((0, -half), (tube, -half), (tube, half), (0, half))]
        self.put("path", name, rank=1, f=foot, d=box, s=("paper",))
        fluid = [[head, 0, 0], [foot, tube, 0]] if pulls else [[foot, 0, 0], [head, 0, 0]]
        self.line(fluid, "@load", half / s.point * 2, by=level, rank=1)
        self.line([[head, 0, 0], ends[1]], "spring", 3.2, rank=1)
        self.line([[head, 0, -half], [head, 0, half]], "pin_ring", 2.4, rank=1)
        self.put("path", name, rank=1, f=foot, d=box, s=("", "spring", 1.2))
        for end in ends:
            self.put("mark", rank=2, at=end, g="end")
        if not self.ports[line] and self.largest > 0:
            s.number("fluids", "", [foot, short(0.35 * tube), 0], self.pressure[:, line],
                     self.largest, "Pa", steady=True, token="spring", rank=3, clear=10.0)
        inset = 3 * s.point
        self.ports[line].append([foot, short(tube - inset if pulls else inset), 0])

    def port(self, line: int) -> Point | None:
        """Where a valve or pump meets a line; one without chambers is beside its neighbour."""
        if line == NONE or self.ports[line]:
            return None if line == NONE else self.ports[line][0]
        for pair in self.s.run.model.valves.lines.tolist():
            other = sum(pair) - line if line in pair else NONE
            if other != NONE and self.ports[other]:
                return [*self.ports[other][0][:3], *BESIDE]
        return None

    def valves(self) -> None:
        """Two wings along a hose: full while something flows through."""
        s, flow, valves = self.s, self.s.run.arrays["valve_flow"], self.s.run.model.valves
        for valve, pair in enumerate(valves.lines.tolist()):
            ends = [self.port(line) for line in pair]
            known = ends[0] or ends[1]
            if known is None:
                continue
            tank = _moved(known, TANK)
            if None in ends:
                self.put("mark", rank=2, at=tank, g="tank")
            one, two = (end or tank for end in ends)
            self.line([one, two], "spring", 1.2, rank=2)
            way = Between(s.out, *(s.out.place(end) + s.point * np.array(
                end[3:] or (0.0, 0.0)) for end in (one, two)))
            self.put("mark", valves.name[valve], rank=2, at=way.at(way.length / 2),
                     turn=s.out.varying(way.angle), g=["shut", "open"],
                     state=s.steady(flow[:, valve] != 0.0))

    def pumps(self) -> None:
        """Sources of flow or pressure beside their lines, with their values."""
        s, drives, beside = self.s, self.s.run.model.drives, dict[int, int]()
        for k in drives.giving("flow", "pressure").tolist():
            line, name, value = (int(drives.target[k]), drives.name[k],
                                 s.run.arrays["drive_value"][:, k])
            if (port := self.port(line)) is None:
                continue
            beside[line] = beside.get(line, -1) + 1
            at = _moved(port, (PUMP[0] * (1 + 1.6 * beside[line]), PUMP[1]))
            self.line([port, at], "spring", 1.2, rank=2)
            self.put("mark", name, rank=2, at=at, g="pump")
            s.number("fluids", name, at, value, float(np.abs(value).max(initial=0.0)),
                     drives.kind[k].unit, words=name, clear=8.0)


def _moved(point: Point, more: tuple[float, float]) -> Point:
    """A point with an offset [points] added to its own."""
    x, y = point[3:] or (0.0, 0.0)
    return [*point[:3], x + more[0], y + more[1]]
