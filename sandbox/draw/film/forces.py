"""Forces: contact arrows to one scale, drives as block arrows, values beside them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pygame
from numpy.typing import NDArray

from sandbox.draw.film.camera import Box
from sandbox.draw.film.canvas import Canvas, Label, Moment, Run
from sandbox.draw.film.geometry import arrow
from sandbox.draw.film.palette import BACKGROUND, DRIVE, FORCE
from sandbox.draw.film.points import PointPool, anchors, index_of_bodies
from sandbox.scene.elements.drives import ForceDrive, PullDrive, TorqueDrive
from sandbox.scene.elements.joints import Pin
from sandbox.scene.mechanism import Mechanism

Array = NDArray[np.float64]
XY = tuple[float, float]

REFERENCE = 0.085
"""Length of the reference force's arrow as a share of the picture's width."""
LONGEST = 1.5
"""Arrows are cut at this many times the reference and marked with a bar."""
LABELLED = 0.12
"""Forces above this share of the reference get their value written beside them."""
MOST_LABELS = 24
DRIVE_LENGTH = 0.07
"""Length of a drive's arrow at its largest value as a share of the picture's width."""
SLIM, BLOCK = ((5.4, 12), (3.4, 11)), ((9.0, 20), (7.0, 17))
"""Shaft's and head's width of a drive's arrow, its rim's and its own [units of the canvas]."""
SHORTEST_DRIVE = 0.5
"""Length of the arrow of a drive near 0, as a share of that: an arrow still needs its head."""


@dataclass(frozen=True)
class ForceScale:
    """How long an arrow is."""

    metres: float
    """Length of a 1 N arrow [m]; 0 where there are no forces."""
    reference: float
    """[N] A force that is typical of the large ones of the run."""

    @property
    def longest(self) -> float:
        """[N] Forces above are cut."""
        return self.reference * LONGEST


def force_scale(run: Run, box: Box, aspect: float) -> ForceScale:
    """The scale the view asks for, or one fitted to the run.

    The reference is the largest force of the last tenth of the run or the 95 %
    quantile of all, whichever is larger: impacts last a sample and would shrink
    everything else. ``aspect`` is the picture's width over its height.
    """
    sizes = np.hypot(*run.arrays["contact_force"].reshape(-1, 2).T)
    if not sizes.size or not sizes.max() > 0:
        return ForceScale(0.0, 0.0)
    late = sizes[run.arrays["contact_sample"] >= 0.9 * len(run.time)]
    reference = max(float(np.quantile(sizes, 0.95)), float(late.max(initial=0.0)))
    if run.mechanism.view.force_scale > 0:
        return ForceScale(run.mechanism.view.force_scale, reference)
    width = max(box.width, box.height * aspect, 1e-3)
    return ForceScale(REFERENCE * width / reference, reference)


def number(value: float, reference: float) -> str:
    """A value with as many decimals as its scale deserves: three digits at ``reference``."""
    decimals = 2 if reference < 10 else 1 if reference < 100 else 0
    return f"{value:.{decimals}f}"


class ContactDrawer:
    """Draws the force on the moving body of every touching pair."""

    def __init__(self, run: Run, scale: ForceScale) -> None:
        self._scale = scale
        arrays = run.arrays
        self._point, self._force = arrays["contact_point"], arrays["contact_force"]
        self._first = np.searchsorted(arrays["contact_sample"], np.arange(len(run.time) + 1))

    def arrows(self, sample: int) -> tuple[Array, Array, Array]:
        """Tails, tips [k, 2] m and sizes [k] N of a sample, the largest force first."""
        rows = slice(self._first[sample], self._first[sample + 1])
        force, point = self._force[rows], self._point[rows]
        size = np.hypot(force[:, 0], force[:, 1])
        order = np.argsort(-size, kind="stable")
        force, point, size = force[order], point[order], size[order]
        cut = np.minimum(1.0, self._scale.longest / np.maximum(size, 1e-30))
        return point, point + force * (cut * self._scale.metres)[:, None], size

    def key(self, canvas: Canvas, moment: Moment) -> bytes:
        """Equal for moments whose arrows and values look the same."""
        tails, tips, sizes = self.arrows(moment.sample)
        ends = canvas.camera.to_pixels(np.concatenate((tails, tips)))
        return ends.astype(np.int32).tobytes() + np.round(sizes, 2).tobytes()

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows; their values go to the canvas as labels."""
        if self._scale.metres == 0:
            return
        tails, tips, sizes = self.arrows(moment.sample)
        tails, tips = canvas.camera.to_pixels(tails), canvas.camera.to_pixels(tips)
        for k in reversed(range(len(sizes))):
            tail, tip = tuple(tails[k].tolist()), tuple(tips[k].tolist())
            if math.dist(tail, tip) < 2.5 * canvas.unit:
                continue
            force_arrow(canvas, tail, tip, cut=sizes[k] > self._scale.longest)
            self._busy(canvas, tail, tip)
        for k in range(min(len(sizes), MOST_LABELS)):
            if sizes[k] >= LABELLED * self._scale.reference:
                text = f"{number(float(sizes[k]), self._scale.reference)} N"
                canvas.labels.append(Label(
                    text, label_spots(canvas, tuple(tails[k]), tuple(tips[k]), text), FORCE))

    @staticmethod
    def _busy(canvas: Canvas, tail: XY, tip: XY) -> None:
        """Keep labels off the outer half of an arrow."""
        side = round(3 * canvas.unit / canvas.enlarged)
        for share in (0.55, 0.75, 1.0):
            x = (tail[0] + share * (tip[0] - tail[0])) / canvas.enlarged
            y = (tail[1] + share * (tip[1] - tail[1])) / canvas.enlarged
            canvas.busy.append(pygame.Rect(round(x) - side, round(y) - side, 2 * side, 2 * side))


def force_arrow(canvas: Canvas, tail: XY, tip: XY, *, cut: bool = False) -> None:
    """A contact force: a slim arrow with a white rim; a white bar where its length was cut."""
    canvas.touch_path((tail, tip), 7)
    pygame.draw.polygon(canvas.surface, BACKGROUND,
                        arrow(tail, tip, 4.4 * canvas.unit, 11 * canvas.unit))
    pygame.draw.polygon(canvas.surface, FORCE,
                        arrow(tail, tip, 2.4 * canvas.unit, 10 * canvas.unit))
    if cut:
        for share in (0.40, 0.50):
            x, y = tail[0] + share * (tip[0] - tail[0]), tail[1] + share * (tip[1] - tail[1])
            length = math.dist(tail, tip)
            nx, ny = -(tip[1] - tail[1]) / length, (tip[0] - tail[0]) / length
            ux, uy = ny, -nx
            reach, lean = 4.5 * canvas.unit, 2 * canvas.unit
            pygame.draw.line(canvas.surface, BACKGROUND,
                             (x - nx * reach - ux * lean, y - ny * reach - uy * lean),
                             (x + nx * reach + ux * lean, y + ny * reach + uy * lean),
                             canvas.width(1.8))


def label_spots(canvas: Canvas, tail: XY, tip: XY, text: str) -> Iterator[XY]:
    """Places for a text beside an arrow's tip [pixels of the finished picture], best first."""
    length = math.dist(tail, tip) or 1.0
    ux, uy = (tip[0] - tail[0]) / length, (tip[1] - tail[1]) / length
    u = canvas.unit / canvas.enlarged
    x, y = tip[0] / canvas.enlarged, tip[1] / canvas.enlarged
    half_x, half_y = 2.9 * u * len(text), 8 * u
    for turn in (0.0, 0.6, -0.6, 1.1, -1.1, 1.6, -1.6, 2.2, -2.2):
        c, s = math.cos(turn), math.sin(turn)
        dx, dy = c * ux - s * uy, s * ux + c * uy
        # the text's middle lies where its box just clears the tip
        reach = min(half_x / max(abs(dx), 1e-6), half_y / max(abs(dy), 1e-6)) + 3 * u
        yield x + dx * reach, y + dy * reach


@dataclass(frozen=True)
class _Driven:
    number: int
    name: str
    kind: str
    at: int
    toward: int
    """A second point: the arrow points from ``at`` to it, or away from it for a pull."""
    direction: XY
    sense: int
    largest: float


class DriveDrawer:
    """Draws forces, pulls and torques from outside, with their values.

    Forces are drawn to the scale of the contact forces where there are any, so
    that the two can be compared; pulls, often far larger, each to its own.
    """

    def __init__(self, run: Run, pool: PointPool, length: float, scale: ForceScale) -> None:
        """``length`` of an arrow with a scale of its own [m]."""
        self._length = length
        self._scale = scale
        self._values = run.arrays["drive_value"]
        self._driven = [found for k in range(len(run.mechanism.drives))
                        if (found := self._find(run.mechanism, k, pool)) is not None]

    def _find(self, mechanism: Mechanism, k: int, pool: PointPool) -> _Driven | None:
        drive = mechanism.drives[k]
        index = index_of_bodies(mechanism)
        largest = float(np.abs(self._values[:, k]).max(initial=0.0))
        if isinstance(drive, ForceDrive):
            body = index[drive.body]
            ahead = (drive.at[0] + drive.direction[0], drive.at[1] + drive.direction[1])
            kept = pool.add(body, [drive.at, drive.at])
            direction = drive.direction if drive.frame == "world" else (0.0, 0.0)
            if drive.frame == "body":
                norm = math.hypot(*drive.direction)
                ahead = (drive.at[0] + 1e-3 * drive.direction[0] / norm,
                         drive.at[1] + 1e-3 * drive.direction[1] / norm)
                kept = pool.add(body, [drive.at, ahead])
            return _Driven(k, drive.name, "force", kept.start, kept.start + 1, direction, 1,
                           largest)
        if isinstance(drive, PullDrive):
            tendon = next((t for t in mechanism.tendons if t.name == drive.tendon), None)
            if tendon is None:
                return None
            last, before = tendon.guides[-1], tendon.guides[-2]
            at = pool.add(index[last.body], [last.at]).start
            away = pool.add(index[before.body], [before.at]).start
            return _Driven(k, drive.name, "pull", at, away, (0.0, 0.0), 1, largest)
        if isinstance(drive, TorqueDrive):
            pin = next((j for j in mechanism.joints if j.name == drive.joint), None)
            if not isinstance(pin, Pin):
                return None
            at = pool.add(index[pin.b], [anchors(mechanism, pin)[1]]).start
            return _Driven(k, drive.name, "torque", at, at, (0.0, 0.0),
                           -1 if pin.positive == "clockwise" else 1, largest)
        return None

    def ends(self, world: Array, values: Array) -> list[tuple[_Driven, XY, XY]]:
        """Every straight arrow's tail and tip [m] for pooled points and drive values."""
        found = []
        for driven in self._driven:
            value = float(values[driven.number])
            at, toward = world[driven.at], world[driven.toward]
            d = np.array(driven.direction)
            if driven.kind == "pull":
                d = at - toward
            elif not d.any():
                d = toward - at
            d = d / max(float(np.hypot(*d)), 1e-12) * self._reach(driven, abs(value))
            tip = at + (d if value >= 0 else -d)
            found.append((driven, (float(at[0]), float(at[1])), (float(tip[0]), float(tip[1]))))
        return found

    def _to_scale(self, driven: _Driven) -> bool:
        return driven.kind == "force" and self._scale.metres > 0

    def _reach(self, driven: _Driven, value: float) -> float:
        """Length of an arrow [m]."""
        if self._to_scale(driven):
            return min(value, self._scale.longest) * self._scale.metres
        share = value / driven.largest if driven.largest > 0 else 0.0
        return self._length * (SHORTEST_DRIVE + (1 - SHORTEST_DRIVE) * share)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """The arrows with their names and values."""
        for driven, at, tip in self.ends(moment.world, moment.drives):
            value = float(moment.drives[driven.number])
            if abs(value) <= 5e-3 * driven.largest:
                continue
            tail_px, tip_px = canvas.camera.to_pixels(np.array([at, tip])).tolist()
            if driven.kind == "torque":
                turn_arrow(canvas, tail_px, driven.sense if value > 0 else -driven.sense)
                tip_px = [tail_px[0], tail_px[1] + 17 * canvas.unit]
            else:
                canvas.touch_path((tail_px, tip_px), 12)
                shapes = (arrow(tail_px, tip_px, w * canvas.unit, h * canvas.unit)
                          for w, h in (SLIM if self._to_scale(driven) else BLOCK))
                pygame.draw.polygon(canvas.surface, BACKGROUND, next(shapes))
                pygame.draw.polygon(canvas.surface, DRIVE, next(shapes))
            unit = "N m" if driven.kind == "torque" else "N"
            shown = f"{value:.3g}" if driven.kind == "torque" else number(
                abs(value), driven.largest)
            text = f"{driven.name} {shown} {unit}"
            canvas.labels.append(Label(
                text, label_spots(canvas, tuple(tail_px), tuple(tip_px), text), DRIVE,
                required=True))


def turn_arrow(canvas: Canvas, at: XY, sense: int) -> None:
    """A bent arrow about a hinge; ``sense`` +1 is counter-clockwise as seen."""
    radius = 15 * canvas.unit
    canvas.touch(at, 22)
    angles = [math.radians(a) for a in range(-50, 201, 10)]
    if sense < 0:
        angles = [math.pi - a for a in angles]
    path = [(at[0] + radius * math.cos(a), at[1] - radius * math.sin(a)) for a in angles]
    canvas.polyline(DRIVE, path[:-3], 3.2)
    pygame.draw.polygon(canvas.surface, DRIVE, arrow(
        path[-4], path[-1], 3.2 * canvas.unit, 12 * canvas.unit))
