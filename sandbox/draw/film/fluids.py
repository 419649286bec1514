"""Fluid: cylinders and vanes filled in the colour of their pressure, hoses, valves and pumps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.camera import round_up
from sandbox.draw.film.canvas import Canvas, Label, Moment, Spots
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.palette import (
    BACKGROUND,
    DRIVE,
    LEVELS,
    PIN_RING,
    SPRING,
    Colour,
    lighter,
    tension_colour,
)
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import number
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array

XY = tuple[float, float]
TUBE = (4.5, 9.0)
"""Least and largest half width of a cylinder in points."""
TUBE_FRACTION = 0.13
"""Half width of a cylinder as a fraction of its tube's length."""
HOSE = 1.6
PUMP, TANK, BESIDE = (-24.0, -26.0), (40.0, -14.0), (-78.0, -12.0)
"""Where from a line's first chamber its pump stands, the tank of a valve, and the line at the other
end of a valve if that has no chambers [points to the right, down]."""
VANE = 10.0
"""Radius of a chamber on a hinge [points]."""
SPARE = 0.04
"""Of a cylinder's largest length: room left before and behind its piston."""
LEAST_TUBE, MOST_TUBE = 0.55, 0.95
"""Of a cylinder's least length: the least and largest length of its tube. Where its stroke has no
room in that it is drawn shorter than it is."""
UNITS = ((1e6, "MPa"), (1e5, "bar"), (1e3, "kPa"), (1.0, "Pa"))


def pressure_unit(largest: float) -> tuple[float, str]:
    """That in which pressures up to ``largest`` [Pa] are written: its size [Pa], its name."""
    return next(((f, u) for f, u in UNITS if largest >= 0.9995 * f), UNITS[-1])


def pressure_text(pascals: float, *, of: float | None = None) -> str:
    """``2e5`` as ``2 bar``; with as many decimals, and in the unit, that the scale ``of`` has."""
    largest = pascals if of is None else of
    factor, unit = pressure_unit(largest)
    shown = f"{pascals / factor:.4g}" if of is None else number(pascals / factor, of / factor)
    return f"{shown} {unit}"


def largest_pressure(run: Filmed) -> float:
    """The top of the pressure scale [Pa]: a round number above nearly all of the run."""
    pressure = np.abs(run.arrays["line_pressure"])
    if not pressure.size or np.isnan(pressure).all():
        return 0.0
    peak = float(np.nanquantile(pressure.max(axis=1), 0.995))
    return round_up(max(peak, float(pressure[-1].max()))) if peak > 0 else 0.0


def valve_mark(canvas: Canvas, at: XY, along: XY, *, flows: bool) -> None:
    """Two wings along a hose, tip to tip: full while something flows through, hollow otherwise."""
    (x, y), ux, uy = at, 7 * canvas.unit * along[0], 7 * canvas.unit * along[1]
    for sign in (1, -1):
        wing = [(x, y), (x + sign * ux - 0.6 * uy, y + sign * uy + 0.6 * ux),
                (x + sign * ux + 0.6 * uy, y + sign * uy - 0.6 * ux)]
        clip.polygon(canvas.surface, DRIVE if flows else BACKGROUND, wing)
        clip.lines(canvas.surface, DRIVE, [*wing, wing[0]], canvas.width(1.2))
    canvas.touch(at, 12)


@dataclass(frozen=True)
class Tube:
    """A cylinder: pooled points of its two ends; lengths [m]."""

    line: int
    a: int
    b: int
    tube: float
    longest: float
    """Of the cylinder, where its piston is at ``end`` of the tube."""
    end: float
    slope: float
    """How far the piston moves, as drawn, for 1 m that the cylinder grows."""
    pulls: bool


@dataclass(frozen=True)
class _Pump:
    drive: int
    line: int
    name: str
    unit: str
    largest: float


class FluidDrawer:
    """Draws all lines, valves and pumps."""

    def __init__(self, run: Filmed, pool: PointPool, beside: Sequence[Filmed] = ()) -> None:
        """Runs ``beside`` have one scale of pressures."""
        model = run.model
        self.largest = max(map(largest_pressure, (run, *beside)))
        self._pressure, self._flow = run.arrays["line_pressure"], run.arrays["valve_flow"]
        self._tubes = tubes_of(run, pool)
        lines, joints = model.lines, model.joints
        self._vanes = [(int(lines.of[n]), pool.add(
            int(lines.bodies[n, 1]), joints.anchor[lines.joint[n], 1]).start)
            for n in np.flatnonzero(lines.joint != NONE).tolist()]
        self._ports = ports_of(model, self._tubes, self._vanes)
        self._valves = model.valves.lines.tolist()
        self._pumps = [
            _Pump(d, int(model.drives.target[d]), model.drives.name[d], model.drives.kind[d].unit,
                  float(np.abs(run.arrays["drive_value"][:, d]).max(initial=0.0)))
            for d in model.drives.giving("flow", "pressure").tolist()]

    def key(self, moment: Moment) -> bytes:
        """Equal for moments whose lines have the same colours, and whose valves flow alike."""
        lines = range(self._pressure.shape[1])
        levels = [self._level(moment, line) for line in lines]
        told = [pressure_text(float(self._pressure[moment.sample, line]), of=self.largest)
                for line in lines]
        return np.array([*levels, *(self._flow[moment.sample] != 0.0)],
                        dtype=np.int16).tobytes() + "".join(told).encode()

    def _level(self, moment: Moment, line: int) -> int:
        fraction = abs(float(self._pressure[moment.sample, line])) / (self.largest or 1.0)
        return int(min(fraction, 1.0) * (LEVELS - 1) + 0.5)

    def _colour(self, moment: Moment, line: int) -> Colour:
        return tension_colour(self._level(moment, line) / (LEVELS - 1))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """Hoses, then chambers, then valves and pumps."""
        for line, ports in enumerate(self._ports):
            places = [self._place(canvas, moment, tube, vane) for tube, vane in ports]
            canvas.polyline(self._colour(moment, line), places, HOSE)
        for tube in self._tubes:
            self._draw_tube(canvas, moment, tube)
        for line, at in self._vanes:
            canvas.touch(moment.points[at], VANE + 2)
            canvas.ring(self._colour(moment, line), PIN_RING, moment.points[at], VANE, 1.2)
        for valve, (a, b) in enumerate(self._valves):
            self._draw_valve(canvas, moment, valve, a, b)
        self._tell(canvas, moment)
        beside: dict[int, int] = {}
        for pump in self._pumps:
            beside[pump.line] = beside.get(pump.line, -1) + 1
            self._draw_pump(canvas, moment, pump, beside[pump.line])

    def _tell(self, canvas: Canvas, moment: Moment) -> None:
        """The pressure beside the first cylinder of each line, where there is room.

        None where there never is any, as in a picture of a scene before it runs.
        """
        for line, ports in enumerate(self._ports if self.largest > 0 else ()):
            tube = next((tube for tube, _ in ports if tube is not None), None)
            if tube is not None:
                (x, y), (ux, uy), length = _along(moment, tube)
                text = pressure_text(float(self._pressure[moment.sample, line]), of=self.largest)
                at = (x + 0.35 * length * ux, y + 0.35 * length * uy)
                canvas.labels.append(Label(
                    text, _beside_tube(canvas, at, upright=abs(uy) > abs(ux)), SPRING))

    def _place(self, canvas: Canvas, moment: Moment, tube: Tube | None, vane: int) -> XY:
        """Where a hose meets a chamber."""
        if tube is None:
            return moment.points[vane]
        (x, y), (ux, uy), length = _along(moment, tube)
        share = (min(tube.tube * canvas.camera.scale, length) - 3 * canvas.unit
                 if tube.pulls else 3 * canvas.unit)
        return x + share * ux, y + share * uy

    def _port(self, canvas: Canvas, moment: Moment, line: int) -> XY | None:
        """Where a line is met by a valve or a pump; one without chambers beside its neighbour."""
        if self._ports[line]:
            return self._place(canvas, moment, *self._ports[line][0])
        for a, b in self._valves:
            other = b if a == line else a if b == line else NONE
            if other != NONE and self._ports[other]:
                return _beside(canvas, self._place(canvas, moment, *self._ports[other][0]), BESIDE)
        return None

    def _draw_tube(self, canvas: Canvas, moment: Moment, tube: Tube) -> None:
        scale = canvas.camera.scale
        (x, y), (ux, uy), length = _along(moment, tube)
        whole = tube.tube * scale
        piston = tube.end * scale - tube.slope * (tube.longest * scale - length)
        low, high = TUBE
        half = min(max(TUBE_FRACTION * whole, low * canvas.unit), high * canvas.unit)

        def box(start: float, end: float, wide: float) -> list[XY]:
            return [(x + s * ux - side * wide * uy, y + s * uy + side * wide * ux)
                    for s, side in ((start, 1), (end, 1), (end, -1), (start, -1))]

        colour = self._colour(moment, tube.line)
        clip.polygon(canvas.surface, SPRING, box(0.0, whole, half + 1.2 * canvas.unit))
        clip.polygon(canvas.surface, BACKGROUND, box(0.0, whole, half))
        filled = box(piston, whole, half) if tube.pulls else box(0.0, piston, half)
        clip.polygon(canvas.surface, lighter(colour, 0.15), filled)
        clip.polygon(canvas.surface, SPRING, box(piston, length, 1.6 * canvas.unit))
        clip.polygon(canvas.surface, PIN_RING, box(piston - 1.8 * canvas.unit, piston, half))
        ends = [(x, y), (x + length * ux, y + length * uy)]
        canvas.touch_path(ends, high + 2)
        for at in ends:
            canvas.ring(BACKGROUND, PIN_RING, at, 2.2, 0.9)

    def _draw_valve(self, canvas: Canvas, moment: Moment, valve: int, a: int, b: int) -> None:
        ends = [self._port(canvas, moment, line) if line != NONE else None for line in (a, b)]
        unit = canvas.unit
        if ends[0] is None and ends[1] is None:
            return
        for i in (0, 1):
            if ends[i] is None:
                ends[i] = x, y = _beside(canvas, ends[1 - i] or (0.0, 0.0), TANK)
                tray = [(x + 6 * p * unit, y + q * unit) for p, q in
                        ((-1, 0), (-1, 6), (1, 6), (1, 0))]
                canvas.polyline(SPRING, tray, 1.2)
        (x0, y0), (x1, y1) = (end or (0.0, 0.0) for end in ends)
        canvas.polyline(SPRING, [(x0, y0), (x1, y1)], 1.2)
        length = max(float(np.hypot(x1 - x0, y1 - y0)), 1e-9)
        along = ((x1 - x0) / length, (y1 - y0) / length)
        valve_mark(canvas, ((x0 + x1) / 2, (y0 + y1) / 2), along,
                   flows=self._flow[moment.sample, valve] != 0.0)

    def _draw_pump(self, canvas: Canvas, moment: Moment, pump: _Pump, beside: int) -> None:
        port = self._port(canvas, moment, pump.line)
        if port is None:
            return
        unit = canvas.unit
        x, y = _beside(canvas, port, (PUMP[0] * (1 + 1.6 * beside), PUMP[1]))
        canvas.polyline(SPRING, [port, (x, y)], 1.2)
        canvas.touch((x, y), 12)
        canvas.ring(BACKGROUND, DRIVE, (x, y), 7.5, 1.2)
        clip.polygon(canvas.surface, DRIVE, [(x - 4 * unit, y - 2 * unit),
                                             (x + 4 * unit, y - 2 * unit), (x, y + 6 * unit)])
        value, units = float(moment.drives[pump.drive]), pump.unit
        if units == "Pa":
            shown = pressure_text(value, of=pump.largest)
        else:
            shown = f"{number(value * 1e6, pump.largest * 1e6)} ml/s"
        k = canvas.enlarged
        canvas.labels.append(Label(
            f"{pump.name} {shown}", lambda _, half: [(x / k, (y - 8 * unit) / k - half)], DRIVE,
            required=True))


def _beside_tube(canvas: Canvas, at: XY, *, upright: bool) -> Spots:
    """Where the pressure of a chamber may stand: on either side of it."""
    x, y, unit = at[0] / canvas.enlarged, at[1] / canvas.enlarged, canvas.unit / canvas.enlarged

    def spots(half_x: float, half_y: float) -> list[XY]:
        if upright:
            return [(x + sign * (half_x + 14 * unit), y) for sign in (1, -1)]
        return [(x, y + sign * (half_y + 12 * unit)) for sign in (1, -1)]

    return spots


def _along(moment: Moment, tube: Tube) -> tuple[XY, XY, float]:
    """Where a cylinder begins, which way it points, and how long it is [pixels]."""
    (x0, y0), (x1, y1) = moment.points[tube.a], moment.points[tube.b]
    length = max(float(np.hypot(x1 - x0, y1 - y0)), 1e-9)
    return (x0, y0), ((x1 - x0) / length, (y1 - y0) / length), length


def _beside(canvas: Canvas, at: XY, away: XY) -> XY:
    """A place so many points to the right of ``at`` and below it."""
    return at[0] + away[0] * canvas.unit, at[1] + away[1] * canvas.unit


def tubes_of(run: Filmed, pool: PointPool) -> list[Tube]:
    """Cylinders, their tubes as long as the run lets them be."""
    lines, found = run.model.lines, []
    own = PointPool()
    which = np.flatnonzero(lines.joint == NONE).tolist()
    for n in which:
        for end in (0, 1):
            own.add(int(lines.bodies[n, end]), lines.anchor[n, end])
    own.close()
    world: Array = own.world(run.arrays["body_pose"])
    for k, n in enumerate(which):
        lengths = np.hypot(*(world[:, 2 * k + 1] - world[:, 2 * k]).T)
        least, most = float(lengths.min()), float(lengths.max())
        spare = SPARE * most
        tube = min(max(most - least + 2 * spare, LEAST_TUBE * least), MOST_TUBE * least)
        stroke = min(most - least, max(tube - 2 * spare, 0.0))
        slope = stroke / (most - least) if most > least else 1.0
        a, b = (pool.add(int(lines.bodies[n, end]), lines.anchor[n, end]).start for end in (0, 1))
        found.append(Tube(int(lines.of[n]), a, b, tube, most, tube - spare, slope,
                           bool(lines.gain[n] < 0)))
    return found


def ports_of(
    model: Model, tubes: list[Tube], vanes: list[tuple[int, int]],
) -> list[list[tuple[Tube | None, int]]]:
    """Of every line its chambers, in their order: a cylinder, or the pooled point of a vane."""
    lines = model.lines
    ports: list[list[tuple[Tube | None, int]]] = [[] for _ in lines.name]
    cylinders, hinges = iter(tubes), iter(vanes)
    for line, joint in zip(lines.of.tolist(), lines.joint.tolist(), strict=True):
        ports[line].append((next(cylinders), NONE) if joint == NONE
                           else (None, next(hinges)[1]))
    return ports
