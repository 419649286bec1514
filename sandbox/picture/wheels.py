"""Outlines of gears, racks and rolling circles that show their rotation.

Teeth are only a picture: meshing wheels have teeth of one size, and a tooth of one is in a gap of
the other where they meet at t = 0. The simulation does not use them.
"""

from __future__ import annotations

import math
from itertools import chain
from typing import NamedTuple

import numpy as np

from sandbox.model.joints import meeting
from sandbox.model.model import Model
from sandbox.model.supports import components
from sandbox.numeric import Array
from sandbox.picture.geometry import shape_points
from sandbox.scene.geometry import to_body

FEW, MANY, MAX_TEETH = 14, 30, 400  # teeth of the smallest meshing wheel; maximum of a wheel
TOP, FOOT = 0.26, 0.3  # of a tooth above the pitch circle, of a gap below [pitches]
ALONG, ACROSS = np.array([(-0.34, -FOOT), (-0.12, TOP), (0.12, TOP), (0.34, -FOOT)]).T
"""A tooth: places along the pitch circle, and across [pitches]."""
RIM = 0.9  # of a ring outside its teeth, of a rack below them [pitches]
REACH = 6.0  # of a rack on a body without shapes, to either side of its gear [radii]


class _WheelPlace(NamedTuple):
    """A wheel of a body; the radius of a rack is infinite."""

    body: int
    centre: tuple[float, float]
    radius: float


class WheelPicture(NamedTuple):
    """A wheel in the frame of its body, corners [n, 2] m."""

    rings: list[Array]  # closed: the outline; of a ring its rim, then its teeth as a hole
    pitch_line: Array | None = None
    spoke: Array | None = None  # from the centre outwards
    phase: float = 0.0  # angle of a tooth [rad]


def wheel_pictures(model: Model) -> dict[int, list[WheelPicture]]:
    """The wheels of each body, the largest first."""
    joints, found = model.joints, dict[_WheelPlace, WheelPicture]()
    meshing = {j: _places(model, j) for j in joints.keeping("gear", "rack").tolist()}
    index = {place: k for k, place in enumerate(dict.fromkeys(chain(*meshing.values())))}
    groups = components(len(index), [(index[one], index[two]) for one, two in meshing.values()])
    for group in dict.fromkeys(groups):
        pairs = {j: pair for j, pair in meshing.items() if groups[index[pair[0]]] == group}
        radii = np.array([place.radius for pair in pairs.values() for place in pair
                          if math.isfinite(place.radius)])
        counts = np.arange(FEW, MANY + 1)[:, None] * radii / radii.min()
        off = np.abs(counts - np.round(counts)).max(axis=1) + 1e-3 * np.arange(FEW, MANY + 1)
        pitch = 2 * math.pi * float(radii.min()) / (FEW + int(off.argmin()))
        for j, pair in pairs.items():
            _mesh(model, j, pair, pitch, found)
    for j in joints.keeping("roll").tolist():
        for end, place in enumerate(_places(model, j)):
            around = bool(joints.inside[j]) and place.radius > joints.radii[j, 1 - end]
            found.setdefault(place, _wheel(place, ring=around))
    result: dict[int, list[WheelPicture]] = {}
    for place in sorted(found, key=lambda place: -place.radius):
        result.setdefault(place.body, []).append(found[place])
    return result


def _places(model: Model, j: int) -> tuple[_WheelPlace, _WheelPlace]:
    joints = model.joints
    one, two = (_WheelPlace(int(joints.bodies[j, end]), tuple(joints.anchor[j, end].tolist()),
                            float(joints.radii[j, end])) for end in (0, 1))
    return one, two._replace(radius=math.inf) if joints.kind[j].keeps == "rack" else two


def _mesh(
    model: Model, j: int, pair: tuple[_WheelPlace, _WheelPlace], pitch: float,
    found: dict[_WheelPlace, WheelPicture],
) -> None:
    """Add the teeth of both sides of a joint, those of one in the gaps of the other."""
    one, two = pair
    if two in found and one not in found and math.isfinite(two.radius):
        one, two = two, one
    x, y = (float(v) for v in meeting(model, j, model.bodies.pose))
    inside = bool(model.joints.inside[j])

    def direction(wheel: _WheelPlace) -> float:
        """Of the meeting point, from the wheel's centre, in its body's frame [rad]."""
        bx, by = to_body(model.bodies.pose[wheel.body].tolist(), (x, y))
        return math.atan2(by - wheel.centre[1], bx - wheel.centre[0])

    if one not in found:
        found[one] = _wheel(one, pitch, direction(one), ring=inside and one.radius > two.radius)
    if two in found:
        return
    # how far along its pitch circle, counter-clockwise, a tooth of one is
    own = 2 * math.pi / _count(one.radius, pitch)
    ahead = one.radius * ((found[one].phase - direction(one) + own / 2) % own - own / 2)
    if math.isinf(two.radius):
        found[two] = _rack(model, j, two, x, y, pitch, ahead)
    else:
        phase = direction(two) + (1 if inside else -1) * (ahead + pitch / 2) / two.radius
        found[two] = _wheel(two, pitch, phase, ring=inside and two.radius > one.radius)


def _count(radius: float, pitch: float) -> int:
    return max(3, round(2 * math.pi * radius / pitch))


def _wheel(place: _WheelPlace, pitch: float = 0.0, phase: float = 0.0, *,
           ring: bool = False) -> WheelPicture:
    """A wheel with a tooth at angle ``phase``, or without teeth; those of a ring point inwards."""
    _, centre, radius = place

    def polar(radii: Array | float, angle: Array) -> Array:
        return np.stack([radii * np.cos(angle), radii * np.sin(angle)], axis=1) + centre

    around = np.linspace(0.0, 2 * np.pi, 90, endpoint=False)
    outline, line, rim, spoke = polar(radius, around), None, RIM * pitch or 0.1 * radius, radius
    count = _count(radius, pitch) if pitch else MAX_TEETH + 1
    if count <= MAX_TEETH:
        own, up = 2 * math.pi / count, -1.0 if ring else 1.0
        angle = (phase + own * (np.arange(count)[:, None] + ALONG)).ravel()
        line, outline = outline, polar(radius + up * pitch * np.tile(ACROSS, count), angle)
        rim, spoke = (FOOT + RIM) * pitch, radius - FOOT * pitch
    if ring:
        return WheelPicture([polar(radius + rim, around), outline], line, phase=phase)
    return WheelPicture([outline], line, np.array([[0.0, 0.0], [spoke, 0.0]]) + centre, phase)


def _rack(
    model: Model, j: int, place: _WheelPlace, x: float, y: float, pitch: float, ahead: float,
) -> WheelPicture:
    """A rack as long as the shapes of its body, with a gap where the gear has a tooth."""
    gx, gy = model.joints.along[j].tolist()
    turn = np.array([[gx, gy], [-gy, gx]])
    pose, shapes = model.bodies.pose[place.body].tolist(), model.mechanism.bodies[place.body].shapes
    meets = float(np.subtract(to_body(pose, (x, y)), place.centre) @ turn[0])
    reach = REACH * float(model.joints.radii[j, 0])
    way = (shape_points(*shapes) - place.centre) @ turn[0] if shapes else [
        meets - reach, meets + reach]
    first, last = min(*way, meets - pitch), max(*way, meets + pitch)
    count = max(1, min(math.floor((last - first) / pitch), MAX_TEETH))
    gap = meets + ahead + pitch / 2
    start = gap + pitch * math.ceil((max(first, meets - count * pitch) - gap) / pitch + 0.5)
    along = (start + pitch * (np.arange(count)[:, None] + ALONG)).ravel()
    foot = -(FOOT + RIM) * pitch
    outline = np.column_stack([np.append(along, along[[-1, 0]]),
                               np.append(pitch * np.tile(ACROSS, count), [foot, foot])])
    line = np.array([[along[0], 0.0], [along[-1], 0.0]])
    return WheelPicture([outline @ turn + place.centre], line @ turn + place.centre)
