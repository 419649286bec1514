"""Drives: arrows of forces and pulls, bent arrows of torques, marks of motors, surfaces that run.

A radius shows in its circle, an actuator in its cylinder, a stiffness in the line of its spring or
tendon, pumps and valves beside their lines of fluid.
"""

from __future__ import annotations

import math

import numpy as np

from sandbox.model.joints import placed, rotated
from sandbox.model.model import Model, held_of
from sandbox.numeric import Array, Flags
from sandbox.picture.geometry import shape_points
from sandbox.picture.listing import Point
from sandbox.picture.scales import LONGEST, typical
from sandbox.picture.subject import Subject
from sandbox.samples.cables import Frames
from sandbox.scene.bodies import Circle

SLIM, BLOCK = [3.4, 11], [7.0, 17]  # shaft and head of arrows to scale, and others [points]
TELLING, NAMED = 6, 4  # maximum numbers of drives with written efforts, and of arrows with names
SHORTEST = 0.5  # length of the arrow of a drive near 0, as a fraction of its typical length
TURN, WIDER = 15.0, 6.0  # radius of a torque's arrow, and increment on a shared hinge [points]
SWEEP = (0.9, 3.4)  # angle of a torque's arrow near 0, and increment of a typical torque [rad]
ARROWS = ("force", "tension", "push")  # quantities of drives with a straight arrow


def _arrow(s: Subject, drive: int, gives: str) -> tuple[Array, Array]:
    """Tail and direction [n, 2] of a drive's arrow for positive values."""
    drives, tendons = s.run.model.drives, s.run.model.tendons
    target = int(drives.target[drive])
    if gives == "push":  # on body b, away from a
        a, b = (s.out.place(_hinge(s.run.model, drive, end)) for end in (0, 1))
        return b, b - a
    if gives == "force":
        angle = s.run.arrays["body_pose"][:, target, 2] * drives.turning[drive]
        return s.out.place([target, *drives.at[drive]]), rotated(drives.direction[drive], angle)
    last = tendons.guides(target).stop - 1  # on from the last guide of a tendon
    cables = Frames(s.run.model, s.run.arrays).cables
    piece = np.flatnonzero(tendons.stretch_tendon == target)[-1]
    return (s.out.place([int(tendons.guide_body[last]), *tendons.guide_at[last]]),
            np.column_stack((cables.x[piece], cables.y[piece])))


def _hinge(model: Model, drive: int, end: int = 1) -> Point:
    """Point ``b``, or ``a``, of the joint that a drive acts on."""
    joints, joint = model.joints, int(model.drives.target[drive])
    return [int(joints.bodies[joint, end]), *joints.anchor[joint, end].tolist()]


def add_drives(s: Subject) -> None:
    """Arrows with values, and marks about hinges."""
    model, about = s.run.model, list[Point]()
    named = sum(kind.gives in ARROWS and not kind.limited for kind in model.drives.kind) <= NAMED
    for k, kind in enumerate(model.drives.kind):
        name, value = model.drives.name[k], s.run.arrays["drive_value"][:, k]
        if kind.limited and not kind.target.line:
            at, sense = _hinge(model, k), int(model.joints.sense[model.drives.target[k]])
            marks, state = ["motor_back", "motor_rest", "motor"], np.sign(sense * value) + 1
            if kind.sole == "brake":
                marks, state = ["unbraked", "braked"], value > 0
            elif kind.places:
                marks, state = ["servo"], None
            s.add("marks", "mark", name, plane=s.plane(at[0]), at=at, g=marks,
                  state=None if state is None else s.steady(state))
        if kind.limited or kind.gives not in (*ARROWS, "torque"):
            continue
        values = [(run, run.model.names.drive.get(name)) for run in (s.run, *s.beside)]
        size = max(typical(np.abs(run.arrays["drive_value"][:, at]), run.time)
                   for run, at in values if at is not None)
        bonds = {"joints": model.bonds.joint, "tendons": model.bonds.tendon}.get(kind.target.among)
        there = np.abs(value) > 5e-3 * size  # others are negligible
        if bonds is not None:
            there &= held_of(int(bonds[model.drives.target[k]]), s.run.arrays["held"])
        if not there.any() and not s.out.fixed_columns:
            continue
        if kind.gives == "torque":
            _bent(s, k, size, there, about.count(_hinge(model, k)))
            about.append(_hinge(model, k))
        else:
            _straight(s, k, size, there, named=named)
    _add_efforts(s)


def _straight(s: Subject, k: int, size: float, there: Flags, *, named: bool) -> None:
    """A straight arrow: slim on the scale of contact forces, or a block with its own length."""
    value, name = s.run.arrays["drive_value"][:, k], s.run.model.drives.name[k]
    kind, rows = s.run.model.drives.kind[k], np.flatnonzero(there)
    tail, way = _arrow(s, k, kind.gives)
    way = way / np.maximum(np.hypot(*way.T), 1e-12)[:, None]
    metres, most, long = s.force.metres, s.force.longest, value
    scaled = kind.gives != "tension" and metres > 0 and size >= 0.2 * s.force.reference
    if not scaled:
        length = 0.07 * s.width  # of the arrow of a typical large value [picture widths]
        metres, most = 1.0, length * (SHORTEST + (1 - SHORTEST) * LONGEST)
        long = np.sign(value) * length * (
            SHORTEST + (1 - SHORTEST) * (np.abs(value) / (size or 1.0)))
    s.out.tables[f"drive {name}"] = np.column_stack([
        rows, np.full(len(rows), k), tail[rows], (long[:, None] * way)[rows], np.abs(value[rows])])
    s.add("drives", "arrows", name, t=f"drive {name}", metres=metres, most=most,
          size=SLIM if scaled else BLOCK, least=0, s=("drive", "paper", 2.0),
          written=(size, kind.unit), names={k: name} if named else None)
    if scaled:
        s.arrows["drives"] = "drive", "N", "driving force", SLIM, s.force
    else:
        s.signs.add("driven")


def _bent(s: Subject, k: int, size: float, there: Flags, others: int) -> None:
    model, value, at = s.run.model, s.run.arrays["drive_value"][:, k], _hinge(s.run.model, k)
    radius, name = TURN + WIDER * others, model.drives.name[k]
    share = np.minimum(np.abs(value) / (size or 1.0), LONGEST)
    sweep = int(model.joints.sense[model.drives.target[k]]) * np.sign(value) * (
        SWEEP[0] + SWEEP[1] * share)
    shown = s.during(there)
    s.add("drives", "spiral", name, at=at, r=[radius, radius], head=12, shown=shown,
          s=("", "drive", 3.2), sweep=s.steady(sweep),
          start=s.steady(math.pi / 2 - sweep / 2))
    s.number("drives", name, at, value, size, model.drives.kind[k].unit, words=name,
             clear=max(radius + WIDER, rim(s, at)), shown=shown)
    s.signs.add("torque")


def _add_efforts(s: Subject) -> None:
    """What a few motors, brakes, servos and actuators give."""
    model = s.run.model
    limited = [k for k, kind in enumerate(model.drives.kind) if kind.limited]
    for k in limited if len(limited) <= TELLING else ():
        torque, name = s.run.arrays["drive_torque"][:, k], model.drives.name[k]
        size = float(np.nanmax(np.abs(torque), initial=0.0))
        if not size > 0 and not s.out.fixed_columns:
            continue
        at, line = _hinge(model, k), model.drives.kind[k].target.line
        if line:
            at = s.out.spot((s.out.place(at) + s.out.place(_hinge(model, k, 0))) / 2)
        s.number("drives", name, at, torque, size, "N" if line else "N m", steady=True, words=name,
                 rank=2, clear=12.0 if line else max(12.0, rim(s, at)))


def rim(s: Subject, at: Point) -> float:
    """The radius of the largest wheel about a hinge [points]; 0 without one that is not large."""
    model, (body, x, y) = s.run.model, at
    radii = [shape.radius for shape in model.mechanism.bodies[body].shapes
             if isinstance(shape, Circle) and math.dist(shape.at, (x, y)) < 1e-9]
    radii += [float(model.joints.radii[k, end])
              for k in model.joints.keeping("gear", "rack", "roll").tolist()
              for end in (0, 1) if model.joints.bodies[k, end] == body
              and math.dist(model.joints.anchor[k, end], (x, y)) < 1e-9]
    found = max((r / s.point for r in radii if math.isfinite(r)), default=0.0)
    return found + 4.0 if found < 90.0 else 0.0  # numbers stand on larger wheels


def add_belts(s: Subject) -> None:
    """Marks that go along the outlines of surfaces that run."""
    drives, arrays = s.run.model.drives, s.run.arrays
    travel = arrays.get("drive_travel")  # of a live run
    if travel is None:
        steps = np.diff(s.run.time, prepend=0.0)
        travel = np.cumsum(steps[:, None] * arrays["drive_value"], axis=0)
    for drive in drives.giving("surface").tolist():
        speed, gone = float(drives.sense[drive]) * np.stack(
            (arrays["drive_value"][:, drive], travel[:, drive]))
        body, back = int(drives.target[drive]), s.steady(speed < 0)
        pose = arrays["body_pose"][:, body, None]
        for shape in s.run.mechanism.bodies[body].shapes:
            points = shape_points(shape)
            corners = np.vstack([points, points[:1]])
            step = np.diff(corners, axis=0)
            along = np.concatenate([[0.0], np.cumsum(np.hypot(*step.T))])
            count = max(3, min(200, round(float(along[-1]) / (34.0 * s.point))))
            at = (gone[:, None] + along[-1] * np.arange(count) / count) % along[-1]
            side = np.clip(np.searchsorted(along, at, side="right") - 1, 0, len(step) - 1)
            place = placed(pose, np.stack([np.interp(at, along, v) for v in corners.T], axis=-1))
            turn = np.unwrap(np.arctan2(step[side, 1], step[side, 0]), axis=0) + pose[..., 2]
            for k in range(count):
                s.add("belts", "mark", plane=s.plane(body), at=s.out.spot(place[:, k], turn[:, k]),
                      turn=s.out.varying(turn[:, k]), g=["belt", "belt_back"], state=back)
