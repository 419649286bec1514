"""Drives: arrows of forces and pulls, bent arrows of torques, marks of motors, surfaces that run.

A radius shows in its circle, an actuator in its cylinder, a stiffness in the line of its spring or
cord, pumps and valves beside their lines of fluid.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.picture.geometry import shape_points
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import Point
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import LONGEST, ForceScale, prefixed, typical
from sandbox.picture.subject import Subject
from sandbox.scene.bodies import Circle

XY = tuple[float, float]
LENGTH = 0.07
"""Length of a drive's arrow at its typical large value as a fraction of the picture's width."""
SLIM, BLOCK = [3.4, 11], [7.0, 17]
"""Shaft's and head's width of arrows that are to scale, and of others [points]."""
COMPARABLE = 0.2
"""A force that is typically larger than this share of the contact forces has their scale."""
TELLING = 6
"""Numbers of motors, brakes, servos and actuators are written of at most so many."""
NAMED = 4
"""Arrows of more drives than this have their values only."""
SHORTEST = 0.5
"""Length of the arrow of a drive near 0, as a fraction of its typical length."""
TURN, WIDER = 15.0, 6.0
"""Radius of a torque's arrow, and by how much one about the same hinge is wider [points]."""
SWEEP = (0.9, 3.4)
"""Angle of a torque's arrow near 0, and what a typical torque adds [rad]."""
NEGLIGIBLE = 5e-3
"""Drives below this share of their typical value are not painted."""
LARGE = 90.0
"""Radius of wheels on which, not beside which, numbers stand [points]."""
APART = 34.0
"""Distance of the marks of a running surface along its outline, more or less [points]."""


@dataclass(frozen=True)
class Arrow:
    """An arrow's tail and direction [n, 2] for positive values; ``bent`` about a hinge."""

    tail: Array
    direction: Array
    at: Point
    bent: int = 0
    """1 where a positive value turns counter-clockwise, else -1; 0 of a straight arrow."""
    to_scale: bool = False
    """Whether it may have the scale of contact forces."""


def _force(s: Subject, drive: int) -> Arrow:
    drives = s.run.model.drives
    body, at = int(drives.target[drive]), drives.at[drive]
    way = np.tile(drives.direction[drive], (len(s.run.time), 1))
    point = s.point_on(body, at)
    if drives.turning[drive]:
        way = s.out.place([body, *(at + drives.direction[drive])]) - s.out.place([body, *at])
    return Arrow(s.out.place([body, *at]), way, point, to_scale=True)


def _pull(s: Subject, drive: int) -> Arrow:
    """On from the tendon's last guide."""
    tendons = s.run.model.tendons
    last = tendons.guides(int(s.run.model.drives.target[drive])).stop - 1
    at, before = (s.out.place([int(tendons.guide_body[i]), *tendons.guide_at[i]])
                  for i in (last, last - 1))
    way, radius = at - before, float(tendons.guide_radius[last - 1])
    size = np.hypot(*way.T)
    if radius and (size > abs(radius)).all():  # the cord leaves the wheel along a tangent
        turned = (way[:, 0] + 1j * way[:, 1]) / (np.sqrt(size**2 - radius**2) + 1j * radius)
        way = np.column_stack((turned.real, turned.imag))
    point = s.point_on(int(tendons.guide_body[last]), tendons.guide_at[last])
    return Arrow(at, way, point)


def _push(s: Subject, drive: int) -> Arrow:
    """On its body ``b``, away from ``a``."""
    joints, joint = s.run.model.joints, int(s.run.model.drives.target[drive])
    a, b = (s.out.place([int(joints.bodies[joint, k]), *joints.anchor[joint, k]]) for k in (0, 1))
    return Arrow(b, b - a, _hinge(s.run.model, drive), to_scale=True)


def _torque(s: Subject, drive: int) -> Arrow:
    at = _hinge(s.run.model, drive)
    place = s.out.place(at)
    return Arrow(place, np.zeros_like(place), at, bent=_sense(s.run.model, drive))


def _hinge(model: Model, drive: int) -> Point:
    """Point ``b`` of the joint that a drive acts on."""
    joints, joint = model.joints, int(model.drives.target[drive])
    x, y = joints.anchor[joint, 1].tolist()
    return [int(joints.bodies[joint, 1]), x, y]


def _sense(model: Model, drive: int) -> int:
    return int(model.joints.sense[model.drives.target[drive]])


@dataclass(frozen=True)
class DriveLook:
    """How drives of a kind look."""

    arrow: Callable[[Subject, int], Arrow] | None = None
    mark: str = ""
    """About its hinge: ``brake``, ``motor`` or ``servo``."""
    signs: tuple[str, ...] = ()
    """Its rows of the legend."""


DRIVES: Mapping[str, DriveLook] = {
    "force": DriveLook(_force),
    "torque": DriveLook(_torque),
    "pull": DriveLook(_pull),
    "push": DriveLook(_push),
    "extend": DriveLook(), "length": DriveLook(),
    "radius": DriveLook(),
    "flow": DriveLook(), "pressure": DriveLook(), "opening": DriveLook(),
    "hold": DriveLook(),
    "stiffness": DriveLook(signs=("stiffer",)),
    "brake": DriveLook(mark="brake", signs=("braked", "unbraked")),
    "motor": DriveLook(mark="motor", signs=("motor",)),
    "surface": DriveLook(signs=("belt",)),
    "servo": DriveLook(mark="servo", signs=("servo",)),
}
"""By the type of a drive."""


def signs_of(model: Model) -> set[str]:
    """Rows of the legend for drives and for dry friction."""
    cords = set(np.flatnonzero([kind.gives == "stiffness" and kind.target.among == "tendons"
                                for kind in model.drives.kind]).tolist())
    found = {name for i, drive in enumerate(model.mechanism.drives) if i not in cords
             for name in DRIVES[drive.type].signs}
    rubs = model.joints.rubbed.size or model.tendons.grips.size
    return found | ({"wider"} if cords else set()) | ({"rubs", "slides"} if rubs else set())


def usual(run: RunData, name: str) -> float:
    """The typical large value of a drive in a run; 0 of a drive that it does not have."""
    if (k := run.model.names.drive.get(name)) is None:
        return 0.0
    return typical(np.abs(run.arrays["drive_value"][:, k]), run.time)


def reaches(to_scale: bool, size: float, scale: ForceScale) -> bool:
    """Whether the arrow of a force of such a size has the scale of the contact forces."""
    return to_scale and scale.metres > 0 and size >= COMPARABLE * scale.reference


def drive_tie(model: Model, drive: int) -> int:
    """The tie of the joint or cord that a drive acts on, or -1."""
    numbers = {"joints": model.ties.joint, "tendons": model.ties.tendon}
    own = numbers.get(model.drives.kind[drive].target.among)
    return -1 if own is None else int(own[model.drives.target[drive]])


def add_drives(s: Subject) -> None:
    """Arrows with values, and marks about hinges."""
    model = s.run.model
    about: list[Point] = []
    straight = sum(1 for drive in s.run.mechanism.drives
                   if DRIVES[drive.type].arrow not in (None, _torque))
    for k, drive in enumerate(s.run.mechanism.drives):
        look = DRIVES[drive.type]
        if look.mark:
            _mark(s, k, look.mark)
        if look.arrow is None:
            continue
        size = max(usual(run, drive.name) for run in (s.run, *s.beside))
        arrow, value = look.arrow(s, k), s.run.arrays["drive_value"][:, k]
        tie = drive_tie(model, k)
        there = np.abs(value) > NEGLIGIBLE * size
        if tie >= 0:
            there &= s.run.arrays["held"][:, tie] != 0
        if not there.any() and not s.out.fixed_columns:
            continue
        if arrow.bent:
            _bent(s, k, arrow, value, size, there, sum(other == arrow.at for other in about))
            about.append(arrow.at)
        else:
            _straight(s, k, arrow, value, size, there, named=straight <= NAMED)
    s.signs |= signs_of(model) if "drives" in s.layers else set()
    _numbers(s)


def _straight(s: Subject, k: int, arrow: Arrow, value: Array, size: float, there: Array, *,
              named: bool) -> None:
    """A straight arrow: slim to the scale of contact forces, or a block with its own length."""
    scaled = reaches(arrow.to_scale, size, s.force)
    unit_way = arrow.direction / np.maximum(np.hypot(*arrow.direction.T), 1e-12)[:, None]
    if scaled:
        metres, most, vector = s.force.metres, s.force.longest, value[:, None] * unit_way
    else:
        share = np.abs(value) / (size or 1.0)
        length = LENGTH * s.width
        metres, most = 1.0, length * (SHORTEST + (1 - SHORTEST) * LONGEST)
        vector = (np.sign(value) * length * (SHORTEST + (1 - SHORTEST) * share))[:, None] * unit_way
    name, unit = s.run.model.drives.name[k], s.run.model.drives.kind[k].unit
    rows = np.flatnonzero(there)
    s.out.tables[f"drive {name}"] = np.column_stack([
        rows, np.full(len(rows), k), arrow.tail[rows], vector[rows], np.abs(value[rows])])
    factor, written, decimals = prefixed(size, unit)
    s.add("drives", "arrows", name, t=f"drive {name}", metres=metres, most=most,
          size=SLIM if scaled else BLOCK, least=0, s=s.style("drive", "paper", 2.0),
          factor=factor, unit=written, decimals=decimals, names={k: name} if named else None,
          rank=0)
    if "drives" in s.layers:
        s.signs.add("scaled" if scaled else "driven")


def _bent(s: Subject, k: int, arrow: Arrow, value: Array, size: float, there: Array,
          others: int) -> None:
    """A bent arrow about a hinge, longer for a larger torque."""
    radius = TURN + WIDER * others
    share = np.minimum(np.abs(value) / (size or 1.0), LONGEST)
    sweep = arrow.bent * np.sign(value) * (SWEEP[0] + SWEEP[1] * share)
    name = s.run.model.drives.name[k]
    shown = None if there.all() else s.out.varying(there, steady=True)
    s.add("drives", "spiral", name, at=arrow.at, r=[radius, radius], head=12,
          s=s.style("", "drive", 3.2), sweep=s.out.varying(sweep, steady=True),
          start=s.out.varying(math.pi / 2 - sweep / 2, steady=True), shown=shown)
    factor, unit, decimals = prefixed(size, s.run.model.drives.kind[k].unit)
    s.add("drives", "text", name, at=arrow.at, words=name, value=s.out.column(value),
          factor=factor, unit=unit, decimals=decimals, s=s.style("", "drive"), rank=0,
          clear=max(radius, rim(s, arrow.at)), shown=shown)
    if "drives" in s.layers:
        s.signs.add("torque")


def _mark(s: Subject, k: int, mark: str) -> None:
    """The mark of a brake, motor or servo about its hinge."""
    at, value = _hinge(s.run.model, k), s.run.arrays["drive_value"][:, k]
    states: dict[str, tuple[list[str], Any]] = {
        "brake": (["unbraked", "braked"], value > 0),
        "motor": (["motor_back", "motor_rest", "motor"],
                  np.sign(_sense(s.run.model, k) * value) + 1),
        "servo": (["servo"], None)}
    names, state = states[mark]
    s.add("marks", "mark", s.run.model.drives.name[k], plane=s.plane(int(at[0])), at=at,
          g=[glyph(s.out, name) for name in names],
          state=None if state is None else s.out.varying(state, steady=True))


def _numbers(s: Subject) -> None:
    """What a few motors, brakes, servos and actuators give."""
    model = s.run.model
    limited = [k for k, kind in enumerate(model.drives.kind) if kind.limited]
    for k in limited if len(limited) <= TELLING else ():
        torque = s.run.arrays["drive_torque"][:, k]
        size = float(np.nanmax(np.abs(torque), initial=0.0))
        if not size > 0 and not s.out.fixed_columns:
            continue
        joint, line = int(model.drives.target[k]), model.drives.kind[k].target.line
        factor, unit, decimals = prefixed(size, "N" if line else "N m")
        at = _hinge(model, k)
        if line:
            other = s.out.place([int(model.joints.bodies[joint, 0]),
                                 *model.joints.anchor[joint, 0]])
            at = s.out.spot((s.out.place(at) + other) / 2)
        s.add("drives", "text", model.drives.name[k], at=at, words=model.drives.name[k],
              value=s.out.column(torque, steady=True), factor=factor, unit=unit,
              clear=12.0 if line else max(12.0, rim(s, at)), decimals=decimals,
              s=s.style("", "drive"), rank=2)


def rim(s: Subject, at: Point) -> float:
    """The radius of the largest wheel about a hinge [points]; 0 without one that is not large."""
    model, (body, x, y) = s.run.model, at
    radii = [shape.radius for shape in model.mechanism.bodies[body].shapes
             if isinstance(shape, Circle) and math.dist(shape.at, (x, y)) < 1e-9]
    wheels = model.joints.keeping("gear", "rack", "roll").tolist()
    radii += [float(model.joints.radii[k, end]) for k in wheels
              for end in (0, 1) if model.joints.bodies[k, end] == body
              and math.dist(model.joints.anchor[k, end], (x, y)) < 1e-9]
    found = max((r / s.point for r in radii if math.isfinite(r)), default=0.0)
    return found + 4.0 if found < LARGE else 0.0


def add_belts(s: Subject) -> None:
    """Marks that go along the outlines of surfaces that run."""
    drives, arrays = s.run.model.drives, s.run.arrays
    travel = arrays.get("drive_travel")  # of a run that goes on
    if travel is None:
        steps = np.diff(s.run.time, prepend=0.0)
        travel = np.cumsum(steps[:, None] * arrays["drive_value"], axis=0)
    for drive in drives.giving("surface").tolist():
        speed, gone = float(drives.sense[drive]) * np.stack(
            (arrays["drive_value"][:, drive], travel[:, drive]))
        body = int(drives.target[drive])
        back, marks = s.out.varying(speed < 0, steady=True), ["belt", "belt_back"]
        pose = arrays["body_pose"][:, body, None]
        c, sine = np.cos(pose[..., 2]), np.sin(pose[..., 2])
        for shape in s.run.mechanism.bodies[body].shapes:
            points = shape_points(shape)
            corners = np.vstack([points, points[:1]])
            step = np.diff(corners, axis=0)
            along = np.concatenate([[0.0], np.cumsum(np.hypot(*step.T))])
            step /= np.maximum(np.diff(along), 1e-12)[:, None]
            count = max(3, min(200, round(float(along[-1]) / (APART * s.point))))
            at = (gone[:, None] + along[-1] * np.arange(count) / count) % along[-1]
            side = np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(step) - 1)
            x, y = np.moveaxis(corners[side] + (at - along[side])[..., None] * step[side], -1, 0)
            turn = np.unwrap(np.arctan2(step[side, 1], step[side, 0]), axis=0) + pose[..., 2]
            for frame in np.moveaxis(np.stack([
                    pose[..., 0] + c * x - sine * y, pose[..., 1] + sine * x + c * y, turn]), 2, 0):
                s.add("belts", "mark", plane=s.plane(body), at=s.out.spot(frame[:2].T, frame[2]),
                      turn=s.out.varying(frame[2]), g=[glyph(s.out, name) for name in marks],
                      state=back)
