"""Fluid: cylinders and vanes filled in the colour of their pressure, hoses, valves and pumps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.model.model import NONE
from sandbox.picture.camera import round_up
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Between, Number, Point, short
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import decimals, number
from sandbox.picture.subject import Subject

TUBE, TUBE_SHARE = (4.5, 9.0), 0.13
"""Least and largest half width of a cylinder [points], and half its width as a share of its tube's
length."""
HOSE, VANE = 1.6, 10.0
"""Width of a hose and radius of a chamber on a hinge [points]."""
PUMP, TANK, BESIDE = (-24.0, 26.0), (40.0, 14.0), (-78.0, 12.0)
"""From a line's first chamber to its pump, to the tank of a valve, and to a line without chambers
at the other end of a valve [points, y up]."""
SPARE = 0.04
"""Room before and behind a piston, as a share of the cylinder's largest length."""
LEAST_TUBE, MOST_TUBE = 0.55, 0.95
"""Least and largest length of a tube, as shares of the cylinder's least length."""
UNITS = ((1e6, "MPa"), (1e5, "bar"), (1e3, "kPa"), (1.0, "Pa"))


def pressure_unit(largest: float) -> tuple[float, str]:
    """The unit of pressures up to ``largest`` [Pa]: its size [Pa] and its name."""
    return next(((f, u) for f, u in UNITS if largest >= 0.9995 * f), UNITS[-1])


def pressure_text(pascals: float, *, of: float | None = None) -> str:
    """``2e5`` as ``2 bar``; in the unit and with the decimals of the scale ``of`` [Pa]."""
    largest = pascals if of is None else of
    factor, unit = pressure_unit(largest)
    shown = f"{pascals / factor:.4g}" if of is None else number(pascals / factor, of / factor)
    return f"{shown} {unit}"


def largest_pressure(run: RunData) -> float:
    """The top of the pressure scale [Pa]: a round number above nearly all of the run."""
    pressure = np.abs(run.arrays["line_pressure"])
    if not pressure.size or np.isnan(pressure).all():
        return 0.0
    peak = float(np.nanquantile(pressure.max(axis=1), 0.995))
    return round_up(max(peak, float(pressure[-1].max()))) if peak > 0 else 0.0


@dataclass(frozen=True)
class Tube:
    """A cylinder between two points; lengths in m."""

    line: int
    a: Point
    b: Point
    tube: float
    longest: float
    """Length of the cylinder where its piston is at ``end`` of the tube."""
    end: float
    slope: float
    """Way of the piston, as painted, for 1 m that the cylinder grows."""
    pulls: bool


def tubes_of(s: Subject) -> list[Tube | None]:
    """The cylinder of each chamber, as long as its run allows; None of a chamber on a hinge."""
    lines = s.run.model.lines
    found: list[Tube | None] = []
    for n, joint in enumerate(lines.joint.tolist()):
        if joint != NONE:
            found.append(None)
            continue
        a, b = (s.point_on(int(lines.bodies[n, end]), lines.anchor[n, end]) for end in (0, 1))
        length = np.hypot(*(s.out.place(b) - s.out.place(a)).T)
        least, most = float(length.min()), float(length.max())
        spare = SPARE * most
        tube = min(max(most - least + 2 * spare, LEAST_TUBE * least), MOST_TUBE * least)
        stroke = min(most - least, max(tube - 2 * spare, 0.0))
        slope = stroke / (most - least) if most > least else 1.0
        found.append(Tube(int(lines.of[n]), a, b, tube, most, tube - spare, slope,
                          bool(lines.gain[n] < 0)))
    return found


def add_fluids(s: Subject) -> None:
    """Hoses, chambers, valves and pumps."""
    _Fluids(s).add()


class _Fluids:
    """Adds the items of all lines of fluid."""

    def __init__(self, s: Subject) -> None:
        self.s, self.largest = s, max(map(largest_pressure, (s.run, *s.beside)))
        self.lines, self.tubes = s.run.model.lines, tubes_of(s)
        self.pressure = s.run.arrays["line_pressure"]
        self.plane = s.plane(*self.lines.bodies.ravel().tolist())
        self.ports: list[list[Point]] = [[] for _ in self.lines.name]

    def level(self, line: int) -> Number:
        """A line's pressure on the scale of colours."""
        return self.s.share(np.abs(self.pressure[:, line]), self.largest)

    def put(self, kind: str, name: str = "", rank: float = 0, **fields: Any) -> None:
        self.s.add("fluids", kind, name, plane=self.plane, rank=rank, **fields)

    def line(self, points: list[Point], token: str, width: float, **fields: Any) -> None:
        self.put("line", p=points, s=self.s.style("", token, width), **fields)

    def add(self) -> None:
        for n, tube in enumerate(self.tubes):
            line = int(self.lines.of[n])
            if tube is not None:
                self.ports[line].append(self.tube(tube, told=not self.ports[line]))
                continue
            joint, at = int(self.lines.joint[n]), self.s.run.model.joints.anchor
            place = self.s.point_on(int(self.lines.bodies[n, 1]), at[joint, 1])
            half = short(VANE * self.s.point)
            x, y = place[1:]
            self.put("path", rank=1, f=place[0], d=[{"c": [x, y, x, y, half]}],
                     s=self.s.style("@load", "pin_ring", 1.2), by=self.level(line))
            self.ports[line].append(place)
        for line, ports in enumerate(self.ports):
            if len(ports) > 1:
                self.line(ports, "@load", HOSE, by=self.level(line))
        if self.lines.name and "tendons" in self.s.layers and self.largest > 0:
            self.s.signs.add("pressure")
        self.valves()
        self.pumps()

    def tube(self, tube: Tube, *, told: bool) -> Point:
        """A cylinder with its piston; returns where its hose begins."""
        s = self.s
        way = s.out.between(tube.a, tube.b)
        foot = way.at(0.0)[0]
        head = way.at(tube.end - tube.slope * (tube.longest - way.length))[0]
        half = min(max(TUBE_SHARE * tube.tube, TUBE[0] * s.point), TUBE[1] * s.point)
        whole, level = tube.tube, self.level(tube.line)
        box = [short(v) for v in (0, -half, whole, -half, whole, half, 0, half)]
        name = self.lines.name[tube.line]
        self.put("path", name, 1, f=foot, d=[box], s=s.style("paper"))
        inner = half / s.point * 2
        fluid: list[Point] = [[head, 0, 0], [foot, whole, 0]]
        if not tube.pulls:
            fluid = [[foot, 0, 0], [head, 0, 0]]
        self.line(fluid, "@load", inner, by=level, rank=1)
        self.line([[head, 0, 0], tube.b], "spring", 3.2, rank=1)
        self.line([[head, 0, -half], [head, 0, half]], "pin_ring", 2.4, rank=1)
        self.put("path", name, 1, f=foot, d=[box], s=s.style("", "spring", 1.2))
        for end in (tube.a, tube.b):
            self.put("mark", rank=2, at=end, g=glyph(s.out, "end"))
        if told and self.largest > 0:
            self.number(tube, foot)
        inset = 3 * s.point
        return [foot, short(whole - inset if tube.pulls else inset), 0]

    def number(self, tube: Tube, foot: int) -> None:
        """The pressure beside a cylinder."""
        size, unit = pressure_unit(self.largest)
        s = self.s
        self.put("text", at=[foot, short(0.35 * tube.tube), 0], words="", factor=1 / size,
                 value=s.out.column(self.pressure[:, tube.line], steady=True), unit=unit,
                 decimals=decimals(self.largest / size), s=s.style("", "spring"), rank=3,
                 clear=10.0)

    def port(self, line: int) -> Point | None:
        """Where a valve or pump meets a line; one without chambers is beside its neighbour."""
        if self.ports[line]:
            return self.ports[line][0]
        for a, b in self.s.run.model.valves.lines.tolist():
            other = b if a == line else a if b == line else NONE
            if other != NONE and self.ports[other]:
                return [*self.ports[other][0][:3], *BESIDE]
        return None

    def valves(self) -> None:
        """Two wings along a hose: full while something flows through."""
        s, flow = self.s, self.s.run.arrays["valve_flow"]
        for valve, pair in enumerate(s.run.model.valves.lines.tolist()):
            ends = [self.port(line) if line != NONE else None for line in pair]
            known = ends[0] or ends[1]
            if known is None:
                continue
            tank = [*known[:3], *(_offset(known, TANK))]
            if None in ends:
                self.put("mark", rank=2, at=tank, g=glyph(s.out, "tank"))
            one, two = (tank if end is None else end for end in ends)
            self.line([one, two], "spring", 1.2, rank=2)
            middle, turn = self.between(one, two)
            self.put("mark", s.run.model.valves.name[valve], 2, at=middle, turn=turn,
                     g=[glyph(s.out, "shut"), glyph(s.out, "open")],
                     state=s.out.varying(flow[:, valve] != 0.0, steady=True))
            if "tendons" in s.layers:
                s.signs |= {"open", "shut"}

    def between(self, one: Point, two: Point) -> tuple[Point, Number]:
        """The middle of two points, and the direction from one to the other [rad]."""
        s = self.s
        a, b = (s.out.place(end) + s.point * np.array(_offset(end, (0.0, 0.0)))
                for end in (one, two))
        way = Between(s.out, a, b)
        return way.at(way.length / 2), s.out.varying(way.angle)

    def pumps(self) -> None:
        """Sources of flow or pressure beside their lines, with their values."""
        s, drives = self.s, self.s.run.model.drives
        beside: dict[int, int] = {}
        for k in drives.giving("flow", "pressure").tolist():
            line = int(drives.target[k])
            port = self.port(line)
            if port is None:
                continue
            beside[line] = beside.get(line, -1) + 1
            away = (PUMP[0] * (1 + 1.6 * beside[line]), PUMP[1])
            at = [*port[:3], *_offset(port, away)]
            self.line([port, at], "spring", 1.2, rank=2)
            self.put("mark", drives.name[k], 2, at=at, g=glyph(s.out, "pump"))
            value = s.run.arrays["drive_value"][:, k]
            size = float(np.abs(value).max(initial=0.0))
            scale, unit = (pressure_unit(size) if drives.kind[k].unit == "Pa"
                           else (1e-6, "ml/s"))
            self.put("text", drives.name[k], at=at, words=drives.name[k], clear=8.0,
                     value=s.out.column(value), factor=1 / scale, unit=unit,
                     decimals=decimals(size / scale), s=s.style("", "drive"), rank=0)


def _offset(point: Point, more: tuple[float, float]) -> list[float]:
    """A point's offset with another one added [points]."""
    x, y = point[3:] if len(point) > 3 else (0.0, 0.0)
    return [x + more[0], y + more[1]]
