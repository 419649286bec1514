"""Drives: block arrows with values beside them, marks about hinges.

:data:`DRIVES` says what is drawn of each kind. A radius that is set shows in its circle
(bodies.py), an actuator in its cylinder (joints.py), a stiffness in the line of its spring or cord
(springs.py, tendons.py), pumps and valves beside their lines (fluids.py).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Label, Moment, Spots
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.forces import arrow_label, cut_bars
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, DRIVE
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import LONGEST, ForceScale, number, typical
from sandbox.draw.film.shapes import Area
from sandbox.draw.film.turning import TURN, brake_mark, motor_mark, servo_mark, turn_arrow
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


HINGE_MARKS: Mapping[str, HingeMark] = {
    "brake": brake_drive, "motor": motor_drive, "servo": servo_drive,
}
"""By their names, which the script of a page has too."""


@dataclass(frozen=True)
class DriveDrawing:
    """What is drawn of every drive of a kind."""

    arrow: Callable[[Model, int, PointPool], Arrow] | None = None
    """Its arrow, whose points it pools; for the drive's number."""
    mark: str = ""
    """About its hinge, of :data:`HINGE_MARKS`."""
    legend: tuple[str, ...] = ()
    """Its lines there, of :data:`sandbox.draw.film.symbols.SYMBOLS`."""


DRIVES: Mapping[str, DriveDrawing] = {
    "force": DriveDrawing(_force),
    "torque": DriveDrawing(_torque),
    "pull": DriveDrawing(_pull),
    "push": DriveDrawing(_push),
    "extend": DriveDrawing(), "length": DriveDrawing(),
    "radius": DriveDrawing(),
    "flow": DriveDrawing(), "pressure": DriveDrawing(), "opening": DriveDrawing(),
    "hold": DriveDrawing(),
    "stiffness": DriveDrawing(legend=("stiffer",)),
    "brake": DriveDrawing(mark="brake", legend=("braked", "unbraked")),
    "motor": DriveDrawing(mark="motor", legend=("motor",)),
    "surface": DriveDrawing(legend=("belt",)),
    "servo": DriveDrawing(mark="servo", legend=("servo",)),
}
"""By the tag of a drive; a new kind is a row."""


def signs_of(model: Model) -> set[str]:
    """What the legend says of drives and of dry friction, of hinges and of guides that hold."""
    cords = set(np.flatnonzero([kind.gives == "stiffness" and kind.target.among == "tendons"
                                  for kind in model.drives.kind]).tolist())
    there = {drive.type for i, drive in enumerate(model.mechanism.drives) if i not in cords}
    rubs = model.joints.rubbed.size or model.tendons.grips.size
    return {name for tag in there for name in DRIVES[tag].legend} | (
        {"wider"} if cords else set()) | ({"rubs", "slides"} if rubs else set())


def _tangent(way: Array, radius: float) -> Array:
    """From the centre of a wheel to a point, the way that a cord leaves it for that point [m]."""
    if not radius or not math.hypot(*way) > abs(radius):
        return way
    turned = complex(*way) / complex(math.sqrt(way @ way - radius**2), radius)
    return np.array([turned.real, turned.imag])


def _round_about(canvas: Canvas, at: XY) -> Spots:
    """Where the words of a torque may stand: below its arrow, above it, farther off."""
    x, y, unit = at[0] / canvas.enlarged, at[1] / canvas.enlarged, canvas.unit / canvas.enlarged
    return lambda _, half: [(x, y + sign * (off * unit + half))
                            for off in (17, 33) for sign in (1, -1)]


def _beside_mark(canvas: Canvas, ends: tuple[XY, XY], *, hinge: bool) -> Spots:
    """Where the words of a mark about a hinge may stand, or of what lies between two points."""
    (ax, ay), (bx, by) = ends
    k = canvas.enlarged
    x, y, unit = (ax + bx) / 2 / k, (ay + by) / 2 / k, canvas.unit / k

    def spots(half_x: float, half_y: float) -> list[XY]:
        aside, off = half_x + 16 * unit, half_y + 12 * unit
        near = [(x, y + off), (x, y - off)] if hinge else []
        return [*near, (x + aside, y), (x - aside, y), (x, y + off + 14 * unit)]

    return spots


def _square(canvas: Canvas, at: XY, half: float) -> Area:
    """So many points about a place, in pixels of the finished picture."""
    side = round(half * canvas.unit / canvas.enlarged)
    return (clip.near(at[0] / canvas.enlarged) - side, clip.near(at[1] / canvas.enlarged) - side,
            2 * side, 2 * side)


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


def _usual(run: Filmed, name: str) -> float:
    """The typical size of a drive in a run; 0 of one that it does not have."""
    if (k := run.model.names.drive.get(name)) is None:
        return 0.0
    return typical(np.abs(run.arrays["drive_value"][:, k]), run.time)


def reaches(arrow: Arrow, usual: float, scale: ForceScale) -> bool:
    """Whether an arrow of such a force is drawn to the scale of the contact forces."""
    return arrow.to_scale and scale.metres > 0 and usual >= COMPARABLE * scale.reference


def drive_arrow(canvas: Canvas, tail: XY, tip: XY, *, scaled: bool) -> None:
    """A straight one with a white rim: slim where it is to scale, else a block."""
    canvas.touch_path((tail, tip), 12)
    for colour, (w, h) in zip((BACKGROUND, DRIVE), SLIM if scaled else BLOCK, strict=True):
        clip.polygon(canvas.surface, colour, arrow(tail, tip, w * canvas.unit, h * canvas.unit))


def arrow_sign(bent: int, scaled: bool) -> str:
    """What the legend says of a drive's arrow, of :data:`sandbox.draw.film.symbols.SYMBOLS`."""
    return "torque" if bent else "scaled" if scaled else "driven"


class DriveDrawer:
    """Draws forces, pulls and torques from outside with their values, and the marks of others.

    Forces are drawn to the scale of the contact forces where there are any, so
    that the two can be compared; pulls, often far larger, each to its own.
    """

    def __init__(self, run: Filmed, pool: PointPool, length: float, scale: ForceScale,
                 beside: Sequence[Filmed] = ()) -> None:
        """``length`` of an arrow with a scale of its own [m], which runs ``beside`` share."""
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
                    float(sizes.max(initial=0.0)),
                    max(_usual(each, drive.name) for each in (run, *beside)),
                    drive_tie(model, k)))
            if row.mark:
                self._marks.append((HINGE_MARKS[row.mark], k, _hinge(model, k, pool),
                                    _sense(model, k)))
        self._torque, self._told = run.arrays["drive_torque"], told_drives(run, pool)
        self._values = run.arrays["drive_value"]

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

    @property
    def signs(self) -> set[str]:
        """What the legend says of its arrows."""
        return {arrow_sign(driven.arrow.bent, self._to_scale(driven))
                for driven in self._driven if driven.largest > 0}

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

    def cuts(self, samples: Sequence[int]) -> bool:
        """Whether any arrow would be longer in some of the samples."""
        largest = np.fmax.reduce(np.abs(self._values[samples]), axis=0, initial=0.0)
        return any(not driven.arrow.bent and self._cut(driven, float(largest[driven.number]))
                   for driven in self._driven)

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
            a, b = (moment.points[end] for end in told.ends)
            canvas.labels.append(Label(
                self.words(told, moment.sample), _beside_mark(canvas, (a, b), hinge=a == b), DRIVE,
                at=((a[0] + b[0]) / 2 / canvas.enlarged, (a[1] + b[1]) / 2 / canvas.enlarged),
                alone=True))

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
                drive_arrow(canvas, tail_px, tip_px, scaled=self._to_scale(driven))
                if self._cut(driven, abs(value)):
                    cut_bars(canvas, tail_px, tip_px, 7.0)
            shown = f"{value:.3g}" if bent else number(abs(value), driven.reference)
            text = f"{driven.name} {shown} {driven.unit}"
            if not bent:
                canvas.labels.append(arrow_label(canvas, tuple(tail_px), tuple(tip_px), text, "",
                                                 DRIVE, alone=True, required=True))
                continue
            canvas.labels.append(Label(
                text, _round_about(canvas, tuple(tail_px)), DRIVE, required=True, alone=True,
                at=(tail_px[0] / canvas.enlarged, tail_px[1] / canvas.enlarged)))
