"""Joints: pins, grooves, rods, ropes and welds, ground symbols, and stops that act.

:data:`JOINTS` says what is drawn of each kind. A groove is drawn of whatever has one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sandbox.draw.film import clip
from sandbox.draw.film.canvas import Canvas, Label, Moment
from sandbox.draw.film.filmed import Filmed
from sandbox.draw.film.grounds import fixed_rail, ground_symbol, roller
from sandbox.draw.film.links import (
    Reach,
    actuator_link,
    bar_busy,
    bar_spots,
    rod_link,
    rope_link,
)
from sandbox.draw.film.palette import (
    BACKGROUND,
    DRIVE,
    FAINT_INK,
    LEVELS,
    PIN_FILL,
    PIN_RING,
    STOP,
    Colour,
    tension_colour,
)
from sandbox.draw.film.points import PointPool
from sandbox.draw.film.scales import number
from sandbox.draw.film.stalks import beside, far_feet
from sandbox.draw.film.tensions import Tensions
from sandbox.elements.arrays import largest_size
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array

PIN = 3.6
"""Radius of a pin in points."""
TELLING, SHORT = 12, 36.0
"""Of no more than so many rods and ropes that carry anything their tension is written; of none that
are shorter in the picture [points]."""
COLLAR = 6.4
"""That of the collar round one with dry friction."""
XY = tuple[float, float]


def hinge_mark(canvas: Canvas, _a: XY, b: XY) -> None:
    """A ring where ``b`` is held."""
    canvas.ring(PIN_FILL, PIN_RING, b, PIN, 1.4)


def rub_mark(canvas: Canvas, at: XY, *, holds: bool) -> None:
    """A collar round a pin with dry friction: full while that holds, hollow while it slips."""
    canvas.touch(at, COLLAR + 1)
    canvas.ring(FAINT_INK if holds else BACKGROUND, FAINT_INK, at, COLLAR, 1.1)


def weld_mark(canvas: Canvas, a: XY, _b: XY) -> None:
    """A square."""
    half = 2.6 * canvas.unit
    clip.rect(canvas.surface, PIN_RING, (a[0] - half, a[1] - half, 2 * half, 2 * half))


def end_marks(canvas: Canvas, a: XY, b: XY) -> None:
    """A small ring at either end."""
    for end in (a, b):
        canvas.ring(PIN_FILL, PIN_RING, end, PIN * 0.75, 1.2)


MARKS: Mapping[str, Callable[[Canvas, XY, XY], None]] = {
    "pin": hinge_mark, "weld": weld_mark, "ends": end_marks,
}
"""By their names, which the script of a page has too; for the pixels of the points on ``a`` and
``b``."""
LINKS: Mapping[str, Callable[[Canvas, XY, XY, Reach, Colour | None], None]] = {
    "rod": rod_link, "rope": rope_link, "actuator": actuator_link,
}
"""The same of what lies between these points, in the colour of what it carries, if it carries
anything; its reach is that of the model [m]."""


@dataclass(frozen=True)
class JointDrawing:
    """What is drawn of every joint of a kind."""

    mark: str = ""
    """On top of the bodies, of :data:`MARKS`."""
    link: str = ""
    """Below them, from point to point, of :data:`LINKS`."""


JOINTS: Mapping[str, JointDrawing] = {
    "pin": JointDrawing("pin"),
    "slot": JointDrawing("pin"),
    "weld": JointDrawing("weld"),
    "rod": JointDrawing("ends", "rod"),
    "rope": JointDrawing("ends", "rope"),
    "actuator": JointDrawing("ends", "actuator"),
    "gear": JointDrawing(), "rack": JointDrawing(), "roll": JointDrawing(),
}
"""By the tag of a joint; a new kind is a row. Wheels are drawn with their bodies."""


@dataclass(frozen=True)
class _Placed:
    """A joint with where its points are pooled."""

    drawing: JointDrawing
    number: int
    a: int
    b: int
    far_a: int
    far_b: int
    """A second point of each body, which shows which way it lies."""
    groove: slice | None
    rail: bool
    """Whether the groove lies beside its body's shapes, or there are none."""
    ground: bool
    """Whether it is fixed, besides."""
    turns: bool
    """Whether the joint lets its bodies turn."""
    reach: Reach
    tie: int = NONE
    """Which of what may be let go."""


def joined_points(model: Model, *, held: bool = False) -> dict[int, list[XY]]:
    """Where joints, springs, cylinders and tendon guides act on each body, in its own frame [m].

    ``held`` leaves out what holds nothing in place: grooves, and the ends that an actuator pulls.
    """
    joints, springs, tendons = model.joints, model.springs, model.tendons
    found: dict[int, list[XY]] = {}

    def attach(body: int, points: Array) -> None:
        found.setdefault(body, []).extend((x, y) for x, y in points.tolist())

    grooved = set(joints.grooved.tolist())
    for k, (a, b) in enumerate(joints.bodies.tolist()):
        if k not in grooved:
            attach(a, joints.anchor[k, :1])
        elif not held:
            attach(a, joints.groove[k])
        attach(b, joints.anchor[k, 1:])
    for bodies, points in zip(springs.bodies[springs.straight].tolist(),
                              springs.anchor[springs.straight], strict=True):
        for end in range(2):
            attach(bodies[end], points[end:end + 1])
    lines = model.lines
    between = lines.joint == NONE
    for bodies, points in zip(lines.bodies[between].tolist(), lines.anchor[between], strict=True):
        for end in range(2):
            attach(bodies[end], points[end:end + 1])
    for tendon, drive in enumerate(tendons.drive):
        guides = tendons.guides(tendon)
        for i in range(guides.start, guides.stop - (drive != NONE and held)):
            attach(int(tendons.guide_body[i]), tendons.guide_at[i:i + 1])
    return found


def reach_of(run: Filmed, joint: int) -> Reach:
    """Least and largest distance of a joint's points; of an actuator those that it came to."""
    low, high = run.model.joints.reach[joint].tolist()
    if not run.model.joints.kind[joint].line:
        return low, high
    length = run.arrays["joint_length"][:, joint]
    shortest, longest = float(length.min(initial=math.inf)), float(length.max(initial=0.0))
    return (low or shortest), (high if math.isfinite(high) else longest)


def is_rail(model: Model, joint: int) -> bool:
    """Whether nothing of its body is where a joint's groove begins, ends and has its middle."""
    body, groove = int(model.joints.bodies[joint, 0]), model.joints.groove[joint]
    return not model.mechanism.bodies[body].shapes or all(
        beside(model, body, (float(x), float(y))) for x, y in (*groove, groove.mean(axis=0)))


class JointDrawer:
    """Draws all joints; lines below the bodies' pins, pins on top."""

    def __init__(self, run: Filmed, tensions: Tensions, pool: PointPool) -> None:
        self._joints = joints = run.model.joints
        centre = run.arrays["body_centre"]
        grooved = set(joints.grooved.tolist())
        self._placed = []
        for k, joint in enumerate(run.mechanism.joints):
            (i, j), (on_a, on_b) = joints.bodies[k].tolist(), joints.anchor[k]
            groove = pool.add(i, joints.groove[k]) if k in grooved else None
            rail = groove is not None and is_rail(run.model, k)
            self._placed.append(_Placed(
                JOINTS[joint.type], k, pool.add(i, on_a).start, pool.add(j, on_b).start,
                pool.add(i, centre[i]).start, pool.add(j, centre[j]).start,
                groove, rail, rail and bool(run.model.bodies.fixed[i]),
                bool(joints.turns[k]), reach_of(run, k), int(run.model.ties.joint[k])))
        drives = run.model.drives
        driven = {int(drives.target[i]) for i in drives.giving("push")}
        self._lines = {k: k in driven for k, kind in enumerate(joints.kind) if kind.line}
        """Actuators, and whether drives act on them."""
        self._held = run.arrays["held"]
        self._carried = tensions
        self._stop = run.arrays["joint_stop"]
        self._least = 1e-4 * largest_size(self._stop)
        loaded = tensions.loaded.tolist()
        self._told: list[int] = loaded if len(loaded) <= TELLING else []
        """Rods and ropes whose tensions are written."""
        self._rubbed, self._sticks = joints.rubbed, run.arrays["joint_sticks"]

    def _stopping(self, sample: int) -> Array:
        """Torques of the stops that act in a sample, 0 of others, [nj]."""
        torque, result = self._stop[sample], np.zeros(self._stop.shape[1])
        stopped = self._joints.stopped
        result[stopped] = torque[stopped]
        return np.where(np.abs(result) > self._least, result, 0.0)

    def stopped(self, samples: Sequence[int]) -> bool:
        """Whether any stop acts in any of the samples."""
        return any(self._stopping(sample).any() for sample in samples)

    def key(self, moment: Moment) -> bytes:
        """Equal for moments at which the same stops act and coloured links pull alike."""
        signs: NDArray[np.int8] = np.sign(self._stopping(moment.sample)).astype(np.int8)
        share = self._carried.links[moment.sample] / (self._carried.largest or 1.0)
        levels: NDArray[np.int16] = np.round(share * LEVELS).astype(np.int16)
        sticks: Array = self._sticks[moment.sample, self._rubbed]
        return b"".join((signs.tobytes(), levels.tobytes(), sticks.tobytes(),
                         self._held[moment.sample].tobytes(),
                         "".join(self._words(moment).values()).encode()))

    def _there(self, moment: Moment) -> list[_Placed]:
        """The joints that hold, and are drawn."""
        held = self._held[moment.sample]
        return [one for one in self._placed if one.tie == NONE or held[one.tie] != 0.0]

    def draw_grooves(self, canvas: Canvas, moment: Moment, *, rails: bool) -> None:
        """Grooves cut into bodies, or the ``rails`` of bodies without shapes."""
        for placed in self._there(moment):
            if placed.groove is not None and placed.rail == rails:
                ends = moment.points[placed.groove]
                if placed.ground:
                    fixed_rail(canvas, ends[0], ends[1])
                    continue
                for colour, width in ((PIN_RING, 5.2), (BACKGROUND, 3.0)):
                    canvas.polyline(colour, ends, width)
                    for end in ends:
                        canvas.disc(colour, end, width / 2)

    def draw_links(self, canvas: Canvas, moment: Moment) -> None:
        """Rods and ropes, coloured by what they carry; rollers in the ground above them."""
        there = self._there(moment)
        for placed in there:
            if not placed.drawing.link:
                continue
            level = self._carried.level(float(self._carried.links[moment.sample, placed.number]))
            colour = tension_colour(level) if level else None
            if placed.number in self._lines:
                colour = DRIVE if self._lines[placed.number] else PIN_RING
            LINKS[placed.drawing.link](canvas, moment.points[placed.a], moment.points[placed.b],
                                       placed.reach, colour)
        for placed in there:
            if placed.groove is not None and placed.ground:
                start, end = moment.points[placed.groove]
                roller(canvas, start, end, moment.points[placed.b], turns=placed.turns)

    def _words(self, moment: Moment) -> dict[int, str]:
        """What is written beside rods and ropes: tensions, negative where they push."""
        tension, largest = self._carried.links[moment.sample], self._carried.largest
        held = self._held[moment.sample]
        return {k: f"{number(float(tension[k]), largest)} N" for k in self._told
                if self._carried.level(float(tension[k]))
                and (self._placed[k].tie == NONE or held[self._placed[k].tie] != 0.0)}

    def tell(self, canvas: Canvas, moment: Moment) -> None:
        """Tensions beside rods and ropes, where there are few of them and where there is room."""
        words = self._words(moment)
        ends = {k: (moment.points[self._placed[k].a], moment.points[self._placed[k].b])
                for k in words}
        for a, b in ends.values():
            bar_busy(canvas, a, b)
        for k, text in words.items():
            a, b = ends[k]
            if math.dist(a, b) > SHORT * canvas.unit:
                canvas.labels.append(Label(text, bar_spots(canvas, a, b)))

    def draw_stops(self, canvas: Canvas, moment: Moment) -> None:
        """A wedge at every hinge whose stop acts at this sample, on the side it pushes."""
        torque = self._stopping(moment.sample)
        for k in np.flatnonzero(torque):
            placed = self._placed[k]
            hinge, a, b = (moment.points[i] for i in (placed.b, placed.far_a, placed.far_b))
            sense = int(self._joints.sense[k] * np.sign(torque[k]))
            stop_wedge(canvas, hinge, wedge_direction(hinge, a, b, sense))

    def draw_pins(self, canvas: Canvas, moment: Moment) -> None:
        """Pins of hinges, grooves and rods, collars where they rub; a square for a weld."""
        there = self._there(moment)
        rubbed = set(self._rubbed.tolist())
        for placed in there:
            if placed.number in rubbed:
                rub_mark(canvas, moment.points[placed.b],
                         holds=bool(self._sticks[moment.sample, placed.number] == 1.0))
        for placed in there:
            if placed.drawing.mark:
                MARKS[placed.drawing.mark](canvas, moment.points[placed.a], moment.points[placed.b])


def wedge_direction(hinge: XY, a: XY, b: XY, sense: int) -> float:
    """Pixel angle [rad] of the side on which a stop pushes ``b`` away from ``a``.

    ``sense`` is +1 where the stop turns ``b`` counter-clockwise as seen. It then
    sits in the sector swept from ``a`` to ``b`` in that sense.
    """
    to_a = math.atan2(-(a[1] - hinge[1]), a[0] - hinge[0])
    to_b = math.atan2(-(b[1] - hinge[1]), b[0] - hinge[0])
    sweep = (sense * (to_b - to_a)) % math.tau
    return -(to_a + sense * sweep / 2)


def stop_wedge(canvas: Canvas, at: XY, direction: float, size: float = 13.0) -> None:
    """A filled sector at a hinge, its opening towards ``direction`` (pixel angle)."""
    radius, half = size * canvas.unit, 0.5
    canvas.touch(at, size + 1)
    rim = [direction + half * (k / 4 - 1) for k in range(9)]
    corners = [at, *((at[0] + radius * math.cos(q), at[1] + radius * math.sin(q)) for q in rim)]
    clip.polygon(canvas.surface, STOP, corners)


def draw_ground(canvas: Canvas, moment: Moment, spots: list[int]) -> None:
    """The ground symbol under every pin on a fixed body without shapes."""
    for spot in spots:
        ground_symbol(canvas, moment.points[spot])


def ground_spots(model: Model, pool: PointPool, least: float) -> list[int]:
    """Pool the anchors on fixed bodies that have nothing else to show for themselves.

    Of those with shapes these are what lies more than ``least`` [m] beside them.
    """
    found = far_feet(model, least)
    found |= {i: points for i, points in joined_points(model, held=True).items()
              if model.bodies.fixed[i] and not model.mechanism.bodies[i].shapes}
    kept = [pool.add(i, points) for i, points in found.items()]
    return [spot for where in kept for spot in range(where.start, where.stop)]
