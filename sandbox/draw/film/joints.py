"""Joints: pins, grooves, rods, ropes and welds, ground symbols, and stops that act."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film.bodies import hatch
from sandbox.draw.film.canvas import Canvas, Moment, Run
from sandbox.draw.film.geometry import dashes, sagging
from sandbox.draw.film.palette import (
    BACKGROUND,
    FAINT_INK,
    INK,
    PIN_FILL,
    PIN_RING,
    ROLES,
    ROPE,
    STOP,
    Colour,
    tension_colour,
)
from sandbox.draw.film.points import PointPool, anchors, index_of_bodies, is_fixed
from sandbox.scene.elements.drives import PullDrive
from sandbox.scene.elements.joints import Pin, Rod, Rope, Slot, Weld
from sandbox.scene.elements.springs import LinearSpring
from sandbox.scene.mechanism import Mechanism

PIN = 3.6
"""Radius of a pin in points."""
CORD = 2.4
"""Width of a taut rope in points."""
SLACK_SHARE = 0.998
"""A rope shorter than this share of its length hangs."""

XY = tuple[float, float]


@dataclass(frozen=True)
class _Placed:
    """A joint with where its points are pooled."""

    joint: Pin | Slot | Weld | Rod | Rope
    number: int
    a: int
    b: int
    far_a: int
    far_b: int
    """A second point of each body, which tells which way it lies."""
    groove: slice | None
    a_body: int


def joined_points(mechanism: Mechanism, *, pulled: bool = True) -> dict[int, list[XY]]:
    """Where joints, springs and tendon guides hold each body, in its own frame [m].

    ``pulled`` False leaves out the ends that an actuator pulls.
    """
    actuated = {d.tendon for d in mechanism.drives if isinstance(d, PullDrive)}
    index = index_of_bodies(mechanism)
    found: dict[int, list[XY]] = {}
    for joint in mechanism.joints:
        on_a, on_b = anchors(mechanism, joint)
        ends = [joint.start, joint.end] if isinstance(joint, Slot) else [on_a]
        found.setdefault(index[joint.a], []).extend(ends)
        found.setdefault(index[joint.b], []).append(on_b)
    for spring in mechanism.springs:
        if isinstance(spring, LinearSpring):
            found.setdefault(index[spring.a], []).append(spring.on_a)
            found.setdefault(index[spring.b], []).append(spring.on_b)
    for tendon in mechanism.tendons:
        last = len(tendon.guides) - (tendon.name in actuated and not pulled)
        for guide in tendon.guides[:last]:
            found.setdefault(index[guide.body], []).append(guide.at)
    return found


class JointDrawer:
    """Draws all joints; lines below the bodies' pins, pins on top."""

    def __init__(self, run: Run, pool: PointPool) -> None:
        mechanism = run.mechanism
        index = index_of_bodies(mechanism)
        centre = run.arrays["body_centre"]
        self._placed = []
        for k, joint in enumerate(mechanism.joints):
            on_a, on_b = anchors(mechanism, joint)
            i, j = index[joint.a], index[joint.b]
            groove = pool.add(i, [joint.start, joint.end]) if isinstance(joint, Slot) else None
            self._placed.append(_Placed(
                joint, k, pool.add(i, [on_a]).start, pool.add(j, [on_b]).start,
                pool.add(i, [tuple(centre[i])]).start, pool.add(j, [tuple(centre[j])]).start,
                groove, i))
        self._ropes = np.array([p.number for p in self._placed
                                if isinstance(p.joint, Rope)], np.intp)
        self._rail = [not body.shapes for body in mechanism.bodies]
        self._reaction = run.arrays["joint_reaction"]
        stop = np.nan_to_num(run.arrays["joint_stop"])
        largest = float(np.abs(stop).max(initial=0.0))
        self._stop = np.where(np.abs(stop) > 1e-4 * largest, stop, 0.0)

    @property
    def stops(self) -> bool:
        """Whether any stop ever acts."""
        return bool(self._stop.any())

    def key(self, moment: Moment) -> bytes:
        """Equal for moments at which the same stops act and ropes pull alike."""
        signs: NDArray[np.int8] = np.sign(self._stop[moment.sample]).astype(np.int8)
        ropes: NDArray[np.float64] = np.round(self._reaction[moment.sample, self._ropes], 2)
        return signs.tobytes() + ropes.tobytes()

    def draw_grooves(self, canvas: Canvas, moment: Moment, *, rails: bool) -> None:
        """Grooves cut into bodies, or the ``rails`` of bodies without shapes."""
        for placed in self._placed:
            if placed.groove is not None and self._rail[placed.a_body] == rails:
                ends = moment.points[placed.groove]
                for colour, width in ((PIN_RING, 5.2), (BACKGROUND, 3.0)):
                    canvas.polyline(colour, ends, width)
                    for end in ends:
                        canvas.disc(colour, end, width / 2)

    def draw_links(self, canvas: Canvas, moment: Moment, largest: float) -> None:
        """Rods, and ropes coloured by their pull where there is a scale up to ``largest`` [N]."""
        for placed in self._placed:
            joint = placed.joint
            a, b = moment.points[placed.a], moment.points[placed.b]
            if isinstance(joint, Rod):
                canvas.polyline(PIN_RING, (a, b), 4.4)
                canvas.polyline(BACKGROUND, (a, b), 2.0)
            elif isinstance(joint, Rope):
                pull = float(self._reaction[moment.sample, placed.number])
                self._draw_rope(canvas, joint, a, b, tension_colour(pull / largest)
                                if largest > 0 and pull > 0 else ROPE)

    def _draw_rope(self, canvas: Canvas, joint: Rope, a: XY, b: XY,
                   colour: Colour) -> None:
        if joint.shortest > 0:
            middle = ((a[0] + b[0]) / 2, (a[1] + b[1]) / 2)
            canvas.polyline(PIN_RING, (a, middle), 4.4)
            canvas.polyline(BACKGROUND, (a, middle), 2.0)
            canvas.polyline(PIN_RING, (middle, b), 1.6)
            return
        length = joint.longest * canvas.camera.scale
        if math.dist(a, b) > SLACK_SHARE * length:
            canvas.polyline(colour, (a, b), CORD)
            return
        path = sagging(a, b, length)
        canvas.touch_path(path, 2)
        for piece in dashes(path, 5 * canvas.unit, 3 * canvas.unit):
            pygame.draw.line(canvas.surface, ROPE, *piece, canvas.width(1.3))

    def draw_stops(self, canvas: Canvas, moment: Moment) -> None:
        """A wedge at every hinge whose stop acts at this sample, on the side it pushes."""
        for k in np.flatnonzero(self._stop[moment.sample]):
            placed = self._placed[k]
            hinge, a, b = (moment.points[i] for i in (placed.b, placed.far_a, placed.far_b))
            stop_wedge(canvas, hinge, wedge_direction(
                hinge, a, b, self._turn(placed.joint, moment.sample, int(k))))

    def _turn(self, joint: Pin | Slot | Weld | Rod | Rope, sample: int, k: int) -> int:
        sense = -1 if isinstance(joint, Pin) and joint.positive == "clockwise" else 1
        return sense if self._stop[sample, k] > 0 else -sense

    def draw_pins(self, canvas: Canvas, moment: Moment) -> None:
        """Pins of hinges, grooves and rods; a square for a weld."""
        for placed in self._placed:
            a, b = moment.points[placed.a], moment.points[placed.b]
            if isinstance(placed.joint, Weld):
                half = 2.6 * canvas.unit
                pygame.draw.rect(canvas.surface, PIN_RING,
                                 (a[0] - half, a[1] - half, 2 * half, 2 * half))
            elif isinstance(placed.joint, Rod | Rope):
                for end in (a, b):
                    canvas.ring(PIN_FILL, PIN_RING, end, PIN * 0.75, 1.2)
            else:
                canvas.ring(PIN_FILL, PIN_RING, b, PIN, 1.4)


def wedge_direction(hinge: XY, a: XY, b: XY, turn: int) -> float:
    """Pixel angle [rad] of the side on which a stop pushes ``b`` away from ``a``.

    ``turn`` is +1 where the stop turns ``b`` counter-clockwise as seen. It then
    sits in the sector swept from ``a`` to ``b`` in that sense.
    """
    to_a = math.atan2(-(a[1] - hinge[1]), a[0] - hinge[0])
    to_b = math.atan2(-(b[1] - hinge[1]), b[0] - hinge[0])
    sweep = (turn * (to_b - to_a)) % math.tau
    return -(to_a + turn * sweep / 2)


def stop_wedge(canvas: Canvas, at: XY, direction: float, size: float = 13.0) -> None:
    """A filled sector at a hinge, its opening towards ``direction`` (pixel angle)."""
    radius, half = size * canvas.unit, 0.5
    canvas.touch(at, size + 1)
    rim = [direction + half * (k / 4 - 1) for k in range(9)]
    corners = [at, *((at[0] + radius * math.cos(q), at[1] + radius * math.sin(q)) for q in rim)]
    pygame.draw.polygon(canvas.surface, STOP, corners)


def draw_ground(mechanism: Mechanism, canvas: Canvas, moment: Moment,
                spots: list[int]) -> None:
    """The ground symbol under every pin on a fixed body without shapes."""
    for spot in spots:
        ground_symbol(canvas, moment.points[spot])


def ground_spots(mechanism: Mechanism, pool: PointPool) -> list[int]:
    """Pool the anchors on fixed bodies that have nothing else to show for themselves."""
    spots = []
    for i, points in joined_points(mechanism, pulled=False).items():
        if is_fixed(mechanism, i) and not mechanism.bodies[i].shapes:
            kept = pool.add(i, points)
            spots += list(range(kept.start, kept.stop))
    return spots


def ground_symbol(canvas: Canvas, at: XY) -> None:
    """A hatched block below a triangle: fixed here."""
    x, y, u = at[0], at[1], canvas.unit
    style = ROLES["ground"]
    corners = [(x, y), (x - 8 * u, y + 12 * u), (x + 8 * u, y + 12 * u)]
    pygame.draw.polygon(canvas.surface, style.fill, corners)
    pygame.draw.lines(canvas.surface, FAINT_INK, True, corners, canvas.width(1.2))
    base = [(x - 12 * u, y + 12 * u), (x + 12 * u, y + 12 * u), (x + 12 * u, y + 17 * u),
            (x - 12 * u, y + 17 * u)]
    hatch(canvas, base, style)
    pygame.draw.line(canvas.surface, INK, base[0], base[1], canvas.width(1.4))
