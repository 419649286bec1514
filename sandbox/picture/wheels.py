"""Toothed wheels, racks and circles that roll: outlines that show how they turn.

Teeth are a picture: their number is chosen so that wheels which mesh have teeth of one size, and
one stands in a gap of the other where they meet at t = 0. What pushes whom, and where, has
nothing to do with them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import meeting
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.picture.geometry import shape_points
from sandbox.scene.geometry import to_body, to_world

FEW, MANY, MOST = 14, 30, 400
"""Teeth of the smallest of the wheels that mesh; a wheel that would have more than the last is
drawn without."""
TOP, FOOT = 0.26, 0.3  # of a tooth above the pitch circle, of a gap below, as shares of the pitch
ALONG, ACROSS = np.array([(-0.34, -FOOT), (-0.12, TOP), (0.12, TOP), (0.34, -FOOT)]).T
"""A tooth as shares of the pitch: places along the pitch circle, and across."""
RIM = 0.9  # of a ring beyond the feet of its teeth, of a rack below them, as a share of the pitch
REACH = 6.0  # of a rack on a body without shapes, either way from where it meets its gear, in radii
SIDES = 90  # of a circle


class _WheelPlace(NamedTuple):
    """A wheel of a body; of a rack the radius is infinite."""

    body: int
    centre: tuple[float, float]
    radius: float


class WheelPicture(NamedTuple):
    """What a body shows of one of its wheels; corners in the body's frame less the centre [m]."""

    centre: tuple[float, float]
    outline: Array  # closed, [n, 2]; of a ring its teeth, which point inwards
    rim: Array | None = None  # around a ring, [k, 2]
    pitch_line: Array | None = None  # of what has teeth, [k, 2]
    spoke: Array | None = None  # from the centre outwards, [2, 2]; a rack and a ring have none


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
            found.setdefault(place, _plain(place, 0.1 * place.radius if around else 0.0))
    result: dict[int, list[WheelPicture]] = {}
    for place in sorted(found, key=lambda place: -place.radius):
        result.setdefault(place.body, []).append(found[place])
    return result


def _places(model: Model, j: int) -> tuple[_WheelPlace, _WheelPlace]:
    joints = model.joints
    one, two = (_WheelPlace(int(joints.bodies[j, end]), tuple(joints.anchor[j, end].tolist()),
                            float(joints.radii[j, end])) for end in (0, 1))
    return one, two._replace(radius=math.inf) if joints.kind[j].keeps == "rack" else two


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
    shares = np.array(radii) / min(radii)

    def off(count: int) -> float:
        return float(np.abs(shares * count - np.round(shares * count)).max()) + 1e-3 * count

    return 2 * math.pi * min(radii) / min(range(FEW, MANY + 1), key=off)


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
    if two in phases:
        return
    # how far along its pitch circle, counter-clockwise, a tooth of one is
    own = 2 * math.pi / _count(one.radius, pitch)
    turn = (phases[one] - _direction(model, one, x, y) + own / 2) % own - own / 2
    ahead = one.radius * turn
    if math.isinf(two.radius):
        phases[two] = 0.0
        found[two] = _rack(model, j, two, x, y, pitch, ahead)
        return
    turned = 1.0 if inside else -1.0
    phases[two] = _direction(model, two, x, y) + turned * (ahead + pitch / 2) / two.radius
    found[two] = _gear(two, pitch, phases[two], ring=inside and two.radius > one.radius)


def _direction(model: Model, wheel: _WheelPlace, x: float, y: float) -> float:
    """Of a place of the world at t = 0, from a wheel's centre, in its body's frame [rad]."""
    pose = model.bodies.pose[wheel.body].tolist()
    cx, cy = to_world(pose, wheel.centre)
    return math.atan2(y - cy, x - cx) - float(pose[2])


def _count(radius: float, pitch: float) -> int:
    return max(3, round(2 * math.pi * radius / pitch))


def _polar(radius: Array | float, angle: Array) -> Array:
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)


def _circle(radius: float) -> Array:
    return _polar(radius, np.linspace(0.0, 2 * np.pi, SIDES, endpoint=False))


def _spoke(length: float) -> Array:
    """At angle 0 of the body, as of a plain circle, so that all on one shaft show one turn."""
    return np.array([[0.0, 0.0], [length, 0.0]])


def _plain(place: _WheelPlace, rim: float) -> WheelPicture:
    """A wheel without teeth; with a rim a ring."""
    if rim:
        return WheelPicture(place.centre, _circle(place.radius), _circle(place.radius + rim))
    return WheelPicture(place.centre, _circle(place.radius), spoke=_spoke(place.radius))


def _gear(place: _WheelPlace, pitch: float, phase: float, *, ring: bool) -> WheelPicture:
    """A wheel with a tooth at angle ``phase``; the teeth of a ring point inwards."""
    count, radius = _count(place.radius, pitch), place.radius
    if count > MOST:
        return _plain(place, RIM * pitch if ring else 0.0)
    own, up = 2 * math.pi / count, -1.0 if ring else 1.0
    angle = (phase + own * (np.arange(count)[:, None] + ALONG)).ravel()
    outline = _polar(radius + up * pitch * np.tile(ACROSS, count), angle)
    if ring:
        return WheelPicture(place.centre, outline, _circle(radius + (FOOT + RIM) * pitch),
                            _circle(radius))
    return WheelPicture(place.centre, outline, pitch_line=_circle(radius),
                        spoke=_spoke(radius - FOOT * pitch))


def _rack(
    model: Model, j: int, place: _WheelPlace, x: float, y: float, pitch: float, ahead: float,
) -> WheelPicture:
    """Where the shapes of its body reach along the pitch line, a gap where the gear has a tooth."""
    gx, gy = model.joints.along[j].tolist()
    dx, dy = to_body(model.bodies.pose[place.body].tolist(), (x, y))
    meets = (dx - place.centre[0]) * gx + (dy - place.centre[1]) * gy
    reach = REACH * float(model.joints.radii[j, 0])
    first, last = meets - reach, meets + reach
    if shapes := model.mechanism.bodies[place.body].shapes:
        way = (shape_points(*shapes) - place.centre) @ (gx, gy)
        first, last = min(float(way.min()), meets - pitch), max(float(way.max()), meets + pitch)
    count = max(1, min(math.floor((last - first) / pitch), MOST))
    gap = meets + ahead + pitch / 2
    start = gap + pitch * math.ceil((max(first, meets - count * pitch) - gap) / pitch + 0.5)
    along = (start + pitch * (np.arange(count)[:, None] + ALONG)).ravel()
    foot = -(FOOT + RIM) * pitch
    outline = np.column_stack([np.append(along, along[[-1, 0]]),
                               np.append(pitch * np.tile(ACROSS, count), [foot, foot])])
    turn = np.array([[gx, gy], [-gy, gx]])
    return WheelPicture(place.centre, outline @ turn,
                        pitch_line=np.array([[along[0], 0.0], [along[-1], 0.0]]) @ turn)
