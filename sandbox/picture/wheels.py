"""Toothed wheels, racks and circles that roll: outlines that show how they turn.

Teeth are a picture: their number is chosen so that wheels which mesh have teeth of one size, and
one stands in a gap of the other where they meet at t = 0. What pushes whom, and where, has
nothing to do with them.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sandbox.model.model import Model
from sandbox.model.wheels import meeting
from sandbox.numeric import Array
from sandbox.picture.geometry import shape_points

FEW, MANY = 14, 30
"""Teeth of the smallest of the wheels that mesh."""
MOST = 400
"""Teeth of one; a wheel that would have more is drawn without."""
TOP, FOOT = 0.26, 0.3
"""Of a tooth above the pitch circle, of a gap below, as shares of the pitch."""
FLANKS = ((-0.34, -FOOT), (-0.12, TOP), (0.12, TOP), (0.34, -FOOT))
"""A tooth as shares of the pitch: places along the pitch circle, and across."""
RIM = 0.9
"""Of a ring beyond the feet of its teeth, of a rack below them, as a share of the pitch."""
REACH = 6.0
"""Of a rack on a body without shapes, either way from where it meets its gear, in radii."""
SIDES = 90
"""Of a circle."""


class _WheelPlace(NamedTuple):
    """A wheel of a body; of a rack the radius is infinite."""

    body: int
    centre: tuple[float, float]
    radius: float


@dataclass(frozen=True)
class WheelPicture:
    """What a body shows of one of its wheels; corners in the body's frame less the centre [m]."""

    centre: tuple[float, float]
    outline: Array
    """Closed, [n, 2]; of a ring its teeth, which point inwards."""
    rim: Array | None = None
    """Around a ring, [k, 2]."""
    pitch_line: Array | None = None
    """Of what has teeth, [k, 2]."""
    spoke: Array | None = None
    """From the centre outwards, [2, 2]; a rack and a ring have none."""


def wheel_pictures(model: Model) -> dict[int, list[WheelPicture]]:
    """The wheels of each body that has some, the largest first."""
    found: dict[_WheelPlace, WheelPicture] = {}
    joints = model.joints
    for group in _meshing(model):
        pitch = _pitch([place.radius for j in group for place in _places(model, j)
                        if math.isfinite(place.radius)])
        phases: dict[_WheelPlace, float] = {}
        for j in group:
            _mesh(model, j, pitch, phases, found)
    for j in joints.keeping("roll").tolist():
        for end, place in enumerate(_places(model, j)):
            around = bool(joints.inside[j]) and place.radius > joints.radii[j, 1 - end]
            if place not in found and not around:
                found[place] = _roller(place.centre, place.radius)
            elif place not in found:
                found[place] = _ring(place, _circle(place.radius), 0.1 * place.radius)
    result: dict[int, list[WheelPicture]] = {}
    for place in sorted(found, key=lambda place: -place.radius):
        result.setdefault(place.body, []).append(found[place])
    return result


def _places(model: Model, j: int) -> tuple[_WheelPlace, _WheelPlace]:
    joints = model.joints
    one, two = (_WheelPlace(int(joints.bodies[j, end]), tuple(joints.anchor[j, end].tolist()),
                       float(joints.radii[j, end])) for end in (0, 1))
    if joints.kind[j].keeps == "rack":
        two = two._replace(radius=math.inf)
    return one, two


def _meshing(model: Model) -> list[list[int]]:
    """Joints of teeth, gathered by the wheels that they share, in their order."""
    groups: list[tuple[set[_WheelPlace], list[int]]] = []
    for j in model.joints.keeping("gear", "rack").tolist():
        wheels, members = set(_places(model, j)), [j]
        for group in [group for group in groups if group[0] & wheels]:
            wheels, members = wheels | group[0], group[1] + members
            groups.remove(group)
        groups.append((wheels, members))
    return [members for _, members in groups]


def _pitch(radii: list[float]) -> float:
    """The pitch by which all wheels come nearest to whole numbers of teeth [m]."""
    least = min(radii)
    shares = np.array(radii) / least

    def off(count: int) -> float:
        return float(np.abs(shares * count - np.round(shares * count)).max()) + 1e-3 * count

    return 2 * math.pi * least / min(range(FEW, MANY + 1), key=off)


def _mesh(
    model: Model, j: int, pitch: float, phases: dict[_WheelPlace, float],
    found: dict[_WheelPlace, WheelPicture],
) -> None:
    """The teeth of both sides of a joint, those of one in the gaps of the other."""
    one, two = _places(model, j)
    if two in phases and one not in phases and math.isfinite(two.radius):
        one, two = two, one
    x, y = (float(v) for v in meeting(model, j, model.bodies.pose))
    inside = bool(model.joints.inside[j])
    if one not in phases:
        phases[one] = _direction(model, one, x, y)
        found[one] = _gear(one, pitch, phases[one], ring=inside and one.radius > two.radius)
    # how far along its pitch circle, counter-clockwise, a tooth of one is
    own = 2 * math.pi / _count(one.radius, pitch)
    ahead = one.radius * _rest(phases[one] - _direction(model, one, x, y), own)
    if two in phases:
        return
    if math.isinf(two.radius):
        phases[two] = 0.0
        found[two] = _rack(model, j, two, x, y, pitch, ahead)
        return
    turned = 1.0 if inside else -1.0
    phases[two] = _direction(model, two, x, y) + turned * (ahead + pitch / 2) / two.radius
    found[two] = _gear(two, pitch, phases[two], ring=inside and two.radius > one.radius)


def _rest(angle: float, period: float) -> float:
    return (angle + period / 2) % period - period / 2


def _direction(model: Model, wheel: _WheelPlace, x: float, y: float) -> float:
    """Of a place of the world at t = 0, from a wheel's centre, in its body's frame [rad]."""
    px, py, angle = model.bodies.pose[wheel.body].tolist()
    c, s = math.cos(angle), math.sin(angle)
    cx, cy = px + c * wheel.centre[0] - s * wheel.centre[1], (
        py + s * wheel.centre[0] + c * wheel.centre[1])
    return math.atan2(y - cy, x - cx) - float(angle)


def _count(radius: float, pitch: float) -> int:
    return max(3, round(2 * math.pi * radius / pitch))


def _circle(radius: float) -> Array:
    angle = np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False)
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _roller(centre: tuple[float, float], radius: float) -> WheelPicture:
    spoke = np.array([[0.0, 0.0], [radius, 0.0]])
    return WheelPicture(centre, _circle(radius), spoke=spoke)


def _ring(place: _WheelPlace, outline: Array, rim: float) -> WheelPicture:
    return WheelPicture(place.centre, outline, rim=_circle(place.radius + rim))


def _gear(place: _WheelPlace, pitch: float, phase: float, *, ring: bool) -> WheelPicture:
    """A wheel with a tooth at angle ``phase``; the teeth of a ring point inwards."""
    count, radius = _count(place.radius, pitch), place.radius
    if count > MOST:
        return (_ring(place, _circle(radius), RIM * pitch) if ring
                else _roller(place.centre, radius))
    own, up = 2 * math.pi / count, -1.0 if ring else 1.0
    angle = (phase + own * (np.arange(count)[:, None] + np.array([f[0] for f in FLANKS]))).ravel()
    r = radius + up * pitch * np.tile([f[1] for f in FLANKS], count)
    outline = np.stack([r * np.cos(angle), r * np.sin(angle)], axis=1)
    if ring:
        picture = _ring(place, outline, (FOOT + RIM) * pitch)
        return WheelPicture(picture.centre, outline, picture.rim, _circle(radius))
    # at angle 0 of the body, as of a plain circle, so that all on one shaft show one turn
    spoke = np.array([[0.0, 0.0], [radius - FOOT * pitch, 0.0]])
    return WheelPicture(place.centre, outline, pitch_line=_circle(radius), spoke=spoke)


def _rack(
    model: Model, j: int, place: _WheelPlace, x: float, y: float, pitch: float, ahead: float,
) -> WheelPicture:
    """Where the shapes of its body reach along the pitch line, a gap where the gear has a tooth."""
    gx, gy = model.joints.along[j].tolist()
    px, py, angle = model.bodies.pose[place.body].tolist()
    c, s = math.cos(angle), math.sin(angle)
    dx = c * (x - px) + s * (y - py) - place.centre[0]
    dy = c * (y - py) - s * (x - px) - place.centre[1]
    meets = dx * gx + dy * gy
    reach = REACH * float(model.joints.radii[j, 0])
    first, last = meets - reach, meets + reach
    shapes = model.mechanism.bodies[place.body].shapes
    if shapes:
        way = (np.concatenate([shape_points(shape) for shape in shapes]) - place.centre) @ (gx, gy)
        first, last = min(float(way.min()), meets - pitch), max(float(way.max()), meets + pitch)
    count = min(math.floor((last - first) / pitch), MOST)
    gap = meets + ahead + pitch / 2
    start = gap + pitch * math.ceil((max(first, meets - count * pitch) - gap) / pitch + 0.5)
    along = np.concatenate([start + pitch * (k + np.array([f[0] for f in FLANKS]))
                            for k in range(max(count, 1))])
    up = pitch * np.tile([f[1] for f in FLANKS], max(count, 1))
    foot = -(FOOT + RIM) * pitch
    along = np.concatenate([along, [along[-1], along[0]]])
    up = np.concatenate([up, [foot, foot]])
    line = np.array([[along[0], 0.0], [along[-2], 0.0]])
    turn = np.array([[gx, gy], [-gy, gx]])
    return WheelPicture(place.centre, np.stack([along, up], axis=1) @ turn,
                        pitch_line=line @ turn)
