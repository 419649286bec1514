"""Toothed wheels, racks and circles that roll, drawn so that one sees them turn.

Teeth are a picture: their number is chosen so that wheels which mesh have teeth of one size, and
one stands in a gap of the other where they meet at t = 0. What pushes whom, and where, has
nothing to do with them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sandbox.draw.film.canvas import Canvas, Moment
from sandbox.draw.film.palette import WHEEL_EDGE
from sandbox.draw.film.points import PointPool
from sandbox.model.model import Model
from sandbox.model.wheels import meeting
from sandbox.numeric import Array

FEW, MANY = 14, 30
"""Teeth of the smallest wheel."""
HEIGHT = 0.22
"""Of a tooth above the pitch circle, and of a gap below, as a share of the pitch."""
FLANKS = ((-0.36, -1.0), (-0.16, 1.0), (0.16, 1.0), (0.36, -1.0))
"""A tooth: places along the pitch, and whether at its top or its foot."""
SIDES = 72
"""Of a circle that rolls."""


class _JointWheel(NamedTuple):
    """A wheel of a body; of a rack the radius is infinite."""

    body: int
    centre: tuple[float, float]
    radius: float


class WheelDrawer:
    """Draws the wheels of all joints that have some, each once."""

    def __init__(self, model: Model, pool: PointPool) -> None:
        self._paths: list[slice] = []
        self._model, self._pool = model, pool
        self._pose = model.bodies.pose
        joints = model.joints
        toothed = joints.keeping("gear", "rack").tolist()
        pitch = _pitch([float(r) for j in toothed for r in joints.radii[j] if math.isfinite(r)])
        phases: dict[_JointWheel, float] = {}
        for j in toothed:
            self._mesh(j, pitch, phases)
        for j in joints.keeping("roll").tolist():
            for wheel in self._wheels(j):
                angle = np.linspace(0.0, 2 * np.pi, SIDES + 1)
                path = wheel.radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
                # a spoke shows how it turns
                self._keep(wheel, np.concatenate([path, [[0.0, 0.0]]]))

    def _wheels(self, j: int) -> list[_JointWheel]:
        joints = self._model.joints
        return [_JointWheel(int(joints.bodies[j, end]), tuple(joints.anchor[j, end].tolist()),
                       float(joints.radii[j, end])) for end in (0, 1)]

    def _keep(self, wheel: _JointWheel, path: Array) -> None:
        self._paths.append(self._pool.add(wheel.body, path + wheel.centre))

    def _mesh(self, j: int, pitch: float, phases: dict[_JointWheel, float]) -> None:
        """The teeth of both sides of a joint, those of the second in the gaps of the first."""
        one, two = self._wheels(j)
        joints = self._model.joints
        x, y = (float(v) for v in meeting(self._model, j, self._pose))
        rack = joints.kind[j].keeps == "rack"
        ahead = 0.0  # how far along its pitch circle, counter-clockwise, a tooth of one is
        if one not in phases:
            phases[one] = self._direction(one, x, y)
            self._keep(one, _teeth(one.radius, pitch, phases[one]))
        else:
            own = 2 * math.pi / _count(one.radius, pitch)
            ahead = one.radius * ((phases[one] - self._direction(one, x, y) + own / 2) % own
                                  - own / 2)
        if rack:
            if two not in phases:
                phases[two] = 0.0
                self._keep(two, self._rack(j, x, y, pitch, ahead))
            return
        if two in phases:
            return
        turned = -1.0 if not joints.inside[j] else 1.0
        phases[two] = (self._direction(two, x, y)
                       + turned * (ahead + pitch / 2) / two.radius)
        self._keep(two, _teeth(two.radius, pitch, phases[two]))

    def _direction(self, wheel: _JointWheel, x: float, y: float) -> float:
        """Of a place of the world at t = 0, from a wheel's centre, in its body's frame [rad]."""
        px, py, angle = self._pose[wheel.body].tolist()
        c, s = math.cos(angle), math.sin(angle)
        cx, cy = px + c * wheel.centre[0] - s * wheel.centre[1], (
            py + s * wheel.centre[0] + c * wheel.centre[1])
        return math.atan2(y - cy, x - cx) - float(angle)

    def _rack(self, j: int, x: float, y: float, pitch: float, ahead: float) -> Array:
        """A rack's teeth, where its body's shapes reach along the pitch line; relative to it."""
        joints, body = self._model.joints, int(self._model.joints.bodies[j, 1])
        gx, gy = joints.along[j].tolist()
        px, py, angle = self._pose[body].tolist()
        c, s = math.cos(angle), math.sin(angle)
        bx, by = joints.anchor[j, 1].tolist()
        dx, dy = c * (x - px) + s * (y - py) - bx, c * (y - py) - s * (x - px) - by
        meets = dx * gx + dy * gy
        radius = float(joints.radii[j, 0])
        first, last = meets - 6 * radius, meets + 6 * radius
        gap = meets + ahead + pitch / 2
        numbers = np.arange(math.ceil((first - gap) / pitch), math.floor((last - gap) / pitch) + 1)
        along = np.concatenate([gap + pitch * (k + np.array([f[0] for f in FLANKS]))
                                for k in numbers])
        up = np.tile([f[1] for f in FLANKS], len(numbers)) * HEIGHT * pitch
        return np.stack([along * gx - up * gy, along * gy + up * gx], axis=1)

    def draw(self, canvas: Canvas, moment: Moment) -> None:
        """All outlines."""
        for path in self._paths:
            canvas.polyline(WHEEL_EDGE, [(x, y) for x, y in moment.points[path]], 1.2)


def _pitch(radii: list[float]) -> float:
    """The pitch by which all wheels come nearest to whole numbers of teeth [m]."""
    if not radii:
        return 1.0
    least = min(radii)
    shares = np.array(radii) / least

    def off(count: int) -> float:
        return float(np.abs(shares * count - np.round(shares * count)).max()) + 1e-3 * count

    return 2 * math.pi * least / min(range(FEW, MANY + 1), key=off)


def _count(radius: float, pitch: float) -> int:
    return max(3, round(2 * math.pi * radius / pitch))


def _teeth(radius: float, pitch: float, phase: float) -> Array:
    """A closed outline of teeth about a centre, one of them at angle ``phase``, [n, 2] m."""
    count = _count(radius, pitch)
    own = 2 * math.pi / count
    angle = (phase + own * (np.arange(count)[:, None] + np.array([f[0] for f in FLANKS]))).ravel()
    r = radius + HEIGHT * pitch * np.tile([f[1] for f in FLANKS], count)
    path = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
    return np.concatenate([path, path[:1]])
