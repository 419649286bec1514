"""Drives: block arrows with values beside them, marks about hinges, and words for the legend.

:data:`DRIVES` says what is drawn of each kind. A radius that is set shows in its circle
(bodies.py), an actuator in its cylinder (joints.py), a stiffness in the line of its spring or cord
(springs.py, tendons.py), pumps and valves beside their lines (fluids.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
import pygame

from sandbox.draw.film import clip
from sandbox.draw.film.belts import belt_symbol
from sandbox.draw.film.canvas import Canvas, Label, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import cut_bars, label_spots
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.joints import hinge_mark, rub_mark
from sandbox.draw.film.palette import BACKGROUND, DRIVE
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import LONGEST, ForceScale, number, typical
from sandbox.draw.film.springs import stiffened_symbol
from sandbox.draw.film.tendons import stiffened_cord_symbol
from sandbox.draw.film.turning import TURN, brake_mark, motor_mark, servo_mark, turn_arrow
from sandbox.kinds.elements import ON_TENDON
from sandbox.model.model import Model
from sandbox.numeric import Array

XY = tuple[float, float]
HingeMark = Callable[[Canvas, XY, float, int], None]
"""Draws a mark about a hinge, for the value in force and the hinge's sense."""

DRIVE_LENGTH = 0.07
"""Length of a drive's arrow at its typical large value as a fraction of the picture's width."""
SLIM, BLOCK = ((5.4, 12), (3.4, 11)), ((9.0, 20), (7.0, 17))
"""Shaft's and head's width of a drive's arrow, its rim's and its own [units of the canvas]."""
COMPARABLE = 0.2
"""Share of the contact forces' reference from which a force is drawn to their scale: an arrow of a
smaller one would be too short to see."""
TELLING = 6
"""Of no more than so many motors, brakes, servos and actuators what they give is written."""
WIDER = 6.0
"""By how much the arrow of a second torque about a place is larger, in points."""
LETTER = 7.5
"""Width of a letter of a label in points, more or less."""
SHORTEST_DRIVE = 0.5
"""Length of the arrow of a drive near 0, as a fraction of that: an arrow still needs its head."""


@dataclass(frozen=True)
class Arrow:
    """Where a drive's arrow begins and which way it points while the drive's value is positive."""

    at: int
    """The pooled point at its tail, or that a bent one goes round."""
    line: tuple[int, int]
    """Two pooled points: the arrow points from the first to the second."""
    direction: XY = (0.0, 0.0)
    """Where it points if no body turns it."""
    bent: int = 0
    """About a hinge: +1 where it is counter-clockwise as seen, else -1; 0 of a straight one."""
    radius: float = 0.0
    """Of the wheel that the line begins on [m], positive where it lies right of the way."""
    to_scale: bool = False
    """Whether it is drawn to the scale of the contact forces, where there are any."""


def _force(model: Model, drive: int, pool: PointPool) -> Arrow:
    drives = model.drives
    body, at, direction = int(drives.target[drive]), drives.at[drive], drives.direction[drive]
    if drives.turning[drive]:
        tail = pool.add(body, np.array([at, at + 1e-3 * direction])).start
        return Arrow(tail, (tail, tail + 1), to_scale=True)
    tail = pool.add(body, at).start
    return Arrow(tail, (tail, tail), (float(direction[0]), float(direction[1])), to_scale=True)


def _pull(model: Model, drive: int, pool: PointPool) -> Arrow:
    """On from the tendon's last guide."""
    tendons = model.tendons
    last = tendons.guides(int(model.drives.target[drive])).stop - 1
    at, before = (pool.add(int(tendons.guide_body[i]), tendons.guide_at[i]).start
                  for i in (last, last - 1))
    return Arrow(at, (before, at), radius=float(tendons.guide_radius[last - 1]))


def _push(model: Model, drive: int, pool: PointPool) -> Arrow:
    """On its body ``b``, away from ``a``."""
    joints, joint = model.joints, int(model.drives.target[drive])
    a, b = (pool.add(int(joints.bodies[joint, k]), joints.anchor[joint, k]).start for k in (0, 1))
    return Arrow(b, (a, b), to_scale=True)


def _torque(model: Model, drive: int, pool: PointPool) -> Arrow:
    at = _hinge(model, drive, pool)
    return Arrow(at, (at, at), bent=_sense(model, drive))


def _hinge(model: Model, drive: int, pool: PointPool) -> int:
    """The pooled point of the hinge that a drive acts on."""
    joints, joint = model.joints, model.drives.target[drive]
    where = pool.add(int(joints.bodies[joint, 1]), joints.anchor[joint, 1])
    return int(where.start)


def _sense(model: Model, drive: int) -> int:
    """+1 where a positive value of a drive on a hinge turns it counter-clockwise, else -1."""
    return int(model.joints.sense[model.drives.target[drive]])


def brake_drive(canvas: Canvas, at: XY, value: float, _sense: int) -> None:
    """That of a brake."""
    brake_mark(canvas, at, holds=value > 0)


def motor_drive(canvas: Canvas, at: XY, value: float, sense: int) -> None:
    """That of a motor."""
    motor_mark(canvas, at, int(math.copysign(1, sense * value)) if value else 0)


def servo_drive(canvas: Canvas, at: XY, _value: float, _sense: int) -> None:
    """That of a servo."""
    servo_mark(canvas, at)


@dataclass(frozen=True)
class Entry:
    """Words for the legend with a symbol of some width [points]."""

    words: str
    width: float
    symbol: Callable[[Canvas, float, float, float], None]
    """For canvas, left, middle height and width in pixels of the enlarged picture."""


def _marked(words: str, width: float, mark: Callable[[Canvas, XY], None]) -> Entry:
    """An entry whose symbol is a mark about a hinge."""
    def symbol(canvas: Canvas, x: float, y: float, width: float) -> None:
        middle = (x + width / 2, y)
        mark(canvas, middle)
        hinge_mark(canvas, middle, middle)
    return Entry(words, width, symbol)


@dataclass(frozen=True)
class DriveDrawing:
    """What is drawn of every drive of a kind."""

    arrow: Callable[[Model, int, PointPool], Arrow] | None = None
    """Its arrow, whose points it pools; for the drive's number."""
    mark: HingeMark | None = None
    legend: tuple[Entry, ...] = ()


DRIVES: Mapping[str, DriveDrawing] = {
    "force": DriveDrawing(_force),
    "torque": DriveDrawing(_torque),
    "pull": DriveDrawing(_pull),
    "push": DriveDrawing(_push),
    "extend": DriveDrawing(), "length": DriveDrawing(),
    "radius": DriveDrawing(),
    "flow": DriveDrawing(), "pressure": DriveDrawing(), "opening": DriveDrawing(),
    "hold": DriveDrawing(),
    "stiffness": DriveDrawing(legend=(Entry("made stiffer", 36, stiffened_symbol),)),
    "brake": DriveDrawing(mark=brake_drive, legend=(
        _marked("brake holds", 12, lambda canvas, at: brake_mark(canvas, at, holds=True)),
        _marked("free", 12, lambda canvas, at: brake_mark(canvas, at, holds=False)))),
    "motor": DriveDrawing(mark=motor_drive, legend=(
        _marked("motor", 20, lambda canvas, at: motor_mark(canvas, at, 1)),)),
    "surface": DriveDrawing(legend=(Entry("surface runs", 16, belt_symbol),)),
    "servo": DriveDrawing(mark=servo_drive, legend=(_marked("servo", 30, servo_mark),)),
}
"""By the tag of a drive; a new kind is a row. The legend keeps this order."""
FRICTION = (
    _marked("friction holds", 14, lambda canvas, at: rub_mark(canvas, at, holds=True)),
    _marked("slips", 14, lambda canvas, at: rub_mark(canvas, at, holds=False)))
"""What follows where joints have dry friction, or guides hold cords."""
STIFFENED_CORD = Entry("wider: made stiffer", 22, stiffened_cord_symbol)
"""What follows where drives set the stiffness of cords."""


def legend_entries(model: Model) -> list[Entry]:
    """What the legend says of marks about hinges: of the kinds of drives, and dry friction."""
    cords = set(np.flatnonzero([kind in ON_TENDON.values() for kind in model.drives.kind]).tolist())
    there = {drive.type for i, drive in enumerate(model.mechanism.drives) if i not in cords}
    return [*(entry for tag, row in DRIVES.items() if tag in there for entry in row.legend),
            *((STIFFENED_CORD,) if cords else ()),
            *(FRICTION if model.joints.rubbed.size or model.tendons.grips.size else ())]


def _tangent(way: Array, radius: float) -> Array:
    """From the centre of a wheel to a point, the way that a cord leaves it for that point [m]."""
    if not radius or not math.hypot(*way) > abs(radius):
        return way
    turned = complex(*way) / complex(math.sqrt(way @ way - radius**2), radius)
    return np.array([turned.real, turned.imag])


def _round_about(canvas: Canvas, at: XY) -> list[XY]:
    """Where the words of a torque may stand: below its arrow, above it, farther off."""
    x, y = at[0] / canvas.enlarged, at[1] / canvas.enlarged
    return [(x, y + way * canvas.unit / canvas.enlarged) for way in (25, -25, 41, -41)]


def _square(canvas: Canvas, at: XY, half: float) -> pygame.Rect:
    """So many points about a place, in pixels of the finished picture."""
    side = round(half * canvas.unit / canvas.enlarged)
    return pygame.Rect(clip.near(at[0] / canvas.enlarged) - side,
                       clip.near(at[1] / canvas.enlarged) - side, 2 * side, 2 * side)


@dataclass(frozen=True)
class _Told:
    """A drive whose torque or force the solve works out, which is written beside it."""

    number: int
    name: str
    unit: str
    ends: tuple[int, int]
    """Pooled points: of an actuator its two, of a hinge one twice."""
    decimals: int
    """Of the value: three digits of the largest of the run."""


@dataclass(frozen=True)
class _Driven:
    number: int
    name: str
    unit: str
    arrow: Arrow
    largest: float
    """Of its values over the run."""
    reference: float
    """A size that is typical of its large ones: by it an arrow with a scale of its own is drawn."""
    tie: int
    """Which of what may be let go it acts on, or -1."""


def drive_tie(model: Model, drive: int) -> int:
    """The number, among what may be let go, of the joint or cord that a drive acts on, or -1."""
    numbers = {"joints": model.ties.joint, "tendons": model.ties.tendon}
    own = numbers.get(model.drives.kind[drive].target.among)
    return -1 if own is None else int(own[model.drives.target[drive]])


def told_drives(run: Filmed, pool: PointPool) -> list[_Told]:
    """Of a few such drives, those that give anything in the run."""
    model, found = run.model, []
    joints = model.joints
    limited = [k for k, kind in enumerate(model.drives.kind) if kind.limited]
    for k in limited if len(limited) <= TELLING else ():
        largest = float(np.nanmax(np.abs(run.arrays["drive_torque"][:, k]), initial=0.0))
        if not largest > 0:
            continue
        joint, line = int(model.drives.target[k]), model.drives.kind[k].target.line
        a, b = (pool.add(int(joints.bodies[joint, i]), joints.anchor[joint, i]).start
                for i in (0, 1))
        decimals = min(max(2 - math.floor(math.log10(largest)), 0), 6)
        found.append(_Told(k, model.drives.name[k], "N" if line else "N m",
                           (a, b) if line else (b, b), decimals))
    return found


def reaches(arrow: Arrow, usual: float, scale: ForceScale) -> bool:
    """Whether an arrow of such a force is drawn to the scale of the contact forces."""
    return arrow.to_scale and scale.metres > 0 and usual >= COMPARABLE * scale.reference


class DriveDrawer:
    """Draws forces, pulls and torques from outside with their values, and the marks of others.

    Forces are drawn to the scale of the contact forces where there are any, so
    that the two can be compared; pulls, often far larger, each to its own.
    """

    def __init__(self, run: Filmed, pool: PointPool, length: float, scale: ForceScale) -> None:
        """``length`` of an arrow with a scale of its own [m]."""
        self._length = length
        self._scale = scale
        self._driven: list[_Driven] = []
        self._marks: list[tuple[HingeMark, int, int, int]] = []
        """HingeMark, drive, pooled point of its hinge and the hinge's sense."""
        model, self._held = run.model, run.arrays["held"]
        for k, drive in enumerate(run.mechanism.drives):
            row = DRIVES[drive.type]
            if row.arrow is not None:
                sizes = np.abs(run.arrays["drive_value"][:, k])
                self._driven.append(_Driven(
                    k, drive.name, model.drives.kind[k].unit, row.arrow(model, k, pool),
                    float(sizes.max(initial=0.0)), typical(sizes, run.time), drive_tie(model, k)))
            if row.mark is not None:
                self._marks.append((row.mark, k, _hinge(model, k, pool), _sense(model, k)))
        self._torque, self._told = run.arrays["drive_torque"], told_drives(run, pool)

    def ends(self, world: Array, values: Array) -> list[tuple[_Driven, XY, XY]]:
        """Every arrow's tail and tip [m] for pooled points and drive values; one if it is bent."""
        found = []
        for driven in self._driven:
            value, (start, end) = float(values[driven.number]), driven.arrow.line
            at = world[driven.arrow.at]
            d = np.array(driven.arrow.direction) + _tangent(
                world[end] - world[start], driven.arrow.radius)
            d = d / max(float(np.hypot(*d)), 1e-12) * self._reach(driven, abs(value))
            tip = at + (d if value >= 0 else -d)
            found.append((driven, (float(at[0]), float(at[1])), (float(tip[0]), float(tip[1]))))
        return found

    def _to_scale(self, driven: _Driven) -> bool:
        return reaches(driven.arrow, driven.reference, self._scale)

    def _reach(self, driven: _Driven, value: float) -> float:
        """Length of an arrow [m]."""
        if self._to_scale(driven):
            return min(value, self._scale.longest) * self._scale.metres
        fraction = min(value / driven.reference, LONGEST) if driven.reference > 0 else 0.0
        return self._length * (SHORTEST_DRIVE + (1 - SHORTEST_DRIVE) * fraction)

    def _cut(self, driven: _Driven, value: float) -> bool:
        """Whether an arrow would be longer."""
        own = self._scale.reference if self._to_scale(driven) else driven.reference
        return value > LONGEST * own

    def key(self, moment: Moment) -> bytes:
        """Equal for moments at which the same is written beside motors, brakes and so on."""
        return "".join(self.words(told, moment.sample) for told in self._told).encode()

    def words(self, told: _Told, sample: int) -> str:
        """Name, value and unit of what such a drive gives in a sample."""
        value = float(self._torque[sample, told.number])
        shown = f"{value:.{told.decimals}f}"
        if not float(shown):
            shown = shown.removeprefix("-")
        return f"{told.name} {shown} {told.unit}"

    def draw_marks(self, canvas: Canvas, moment: Moment) -> None:
        """All marks; the pins come on top."""
        for mark, drive, at, sense in self._marks:
            mark(canvas, moment.points[at], float(moment.drives[drive]), sense)

    def _tell(self, canvas: Canvas, moment: Moment) -> None:
        """What motors, brakes, servos and actuators give, where there is room."""
        for told in self._told:
            (ax, ay), (bx, by) = (moment.points[i] for i in told.ends)
            text, k = self.words(told, moment.sample), canvas.enlarged
            x, y, unit = (ax + bx) / 2 / k, (ay + by) / 2 / k, canvas.unit / k
            aside = LETTER * len(text) * unit / 2 + 16 * unit
            spots = [(x, y + 20 * unit), (x, y - 20 * unit)] if told.ends[0] == told.ends[1] else []
            spots += [(x + aside, y), (x - aside, y), (x, y + 34 * unit)]
            canvas.labels.append(Label(text, spots, DRIVE))

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows with their names and values."""
        self._tell(canvas, moment)
        about: list[XY] = []
        for driven, at, tip in self.ends(moment.world, moment.drives):
            value, bent = float(moment.drives[driven.number]), driven.arrow.bent
            gone = driven.tie >= 0 and self._held[moment.sample, driven.tie] == 0.0
            if gone or abs(value) <= 5e-3 * driven.reference:
                continue
            tail_px, tip_px = canvas.camera.to_pixels(np.array([at, tip])).tolist()
            if bent:
                radius = TURN + WIDER * sum(
                    math.dist(tail_px, other) < WIDER * canvas.unit for other in about)
                about.append((tail_px[0], tail_px[1]))
                turn_arrow(canvas, tail_px, bent if value > 0 else -bent, radius)
                canvas.busy.append(_square(canvas, tuple(tail_px), 0.8 * radius))
            else:
                canvas.touch_path((tail_px, tip_px), 12)
                shapes = (arrow(tail_px, tip_px, w * canvas.unit, h * canvas.unit)
                          for w, h in (SLIM if self._to_scale(driven) else BLOCK))
                clip.polygon(canvas.surface, BACKGROUND, next(shapes))
                clip.polygon(canvas.surface, DRIVE, next(shapes))
                if self._cut(driven, abs(value)):
                    cut_bars(canvas, tail_px, tip_px, 7.0)
            shown = f"{value:.3g}" if bent else number(abs(value), driven.reference)
            text = f"{driven.name} {shown} {driven.unit}"
            spots = _round_about(canvas, tuple(tail_px)) if bent else label_spots(
                canvas, tuple(tail_px), tuple(tip_px), text)
            canvas.labels.append(Label(text, spots, DRIVE, required=True))
