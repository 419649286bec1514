"""Joints: pins, grooves, welds, grounds, stops that act, friction and what may be let go."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np

from sandbox.elements.arrays import largest_size
from sandbox.elements.joint import JointKind
from sandbox.model.joints import slot_points
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.picture.elements.bodies import beside, far_feet, joined_points
from sandbox.picture.glyphs import glyph
from sandbox.picture.listing import short
from sandbox.picture.subject import Subject

XY = tuple[float, float]
GAUGE = 13.0
"""Distance of the two lines of a groove in the ground [points]."""
FAR_FOOT = 16.0
"""Anchors farther than this beside a fixed body's shapes get a ground symbol [points]."""
PILED = 11.0
"""Ground symbols nearer than this to another one are left out [points]."""


def mark_of(kind: JointKind) -> str:
    """The mark of a kind of joint: ``pin`` at b, ``weld`` at a, ``end`` at both; or none."""
    if kind.along_line:
        return "end"
    if kind.keeps == "groove" or kind.angle:
        return "pin"
    return "weld" if kind.keeps == "point" else ""


def is_rail(model: Model, joint: int) -> bool:
    """Whether a joint's groove begins, ends and has its middle beside its body's shapes."""
    body, points = int(model.joints.bodies[joint, 0]), slot_points(model, joint)
    middle = points.mean(axis=0) if len(points) == 2 else points[len(points) // 2]
    return not model.mechanism.bodies[body].shapes or all(
        beside(model, body, (float(x), float(y))) for x, y in (points[0], points[-1], middle))


def add_joints(s: Subject) -> None:
    """Marks and grooves of all joints."""
    joints, rubbed = s.run.model.joints, set(s.run.model.joints.rubbed.tolist())
    grooved, sticks = set(joints.grooved.tolist()), s.run.arrays["joint_sticks"]
    for k in range(len(joints.name)):
        (a, b), (on_a, on_b) = joints.bodies[k].tolist(), joints.anchor[k]
        name, plane = joints.name[k], s.plane(a, b)
        shown = s.held(int(s.run.model.ties.joint[k]))
        if k in grooved:
            _groove(s, k, plane, shown)
        if k in rubbed:
            s.add("pins", "mark", name, plane=plane, rank=-1, at=s.point_on(b, on_b),
                  g=[glyph(s.out, "slides"), glyph(s.out, "rubs")],
                  state=s.out.varying(sticks[:, k] == 1.0, steady=True), shown=shown)
        mark = mark_of(joints.kind[k])
        places = {"pin": [(b, on_b)], "weld": [(a, on_a)], "end": [(a, on_a), (b, on_b)]}
        for body, at in places.get(mark, []):
            s.add("pins", "mark", name, plane=plane, at=s.point_on(body, at),
                  g=glyph(s.out, mark), shown=shown)


def _groove(s: Subject, k: int, plane: float, shown: list[int] | None) -> None:
    """A groove: a slot in its body, or two lines on the ground with a roller or block."""
    model = s.run.model
    (a, b), groove = model.joints.bodies[k].tolist(), slot_points(model, k)
    name, rail, curved = model.joints.name[k], is_rail(model, k), len(groove) > 2
    if curved or not (rail and model.bodies.fixed[a]):
        chords = [[short(v) for v in (*one, *two)] for one, two in pairwise(groove.tolist())]
        s.add("rails" if rail else "grooves", "path", name, plane=plane, f=a, shown=shown,
              m=1 if curved else None, s=s.style("paper", "pin_ring", 1.1),
              d=[{"c": [*chord, short(2.0 * s.point)]} for chord in chords])
        return
    ends_on = [s.point_on(a, at) for at in groove]
    place = [s.out.place(end)[0].tolist() for end in ends_on]
    if (place[1][0], place[1][1]) < (place[0][0], place[0][1]):
        ends_on, place = ends_on[::-1], place[::-1]
    half = GAUGE / 2
    s.add("rails", "span", name, plane=plane, a=ends_on[0], b=ends_on[1], shown=shown,
          s=s.style("", "ink", 1.0), t=[0, 1, 1, 1, 1, -1, 0, -1, 0, 1], w=[0, half, half])
    s.add("rails", "span", plane=plane, a=ends_on[0], b=ends_on[1], every=8, shown=shown,
          s=s.style("", "faint_ink", 0.9), t=[0, -half, -5, -half - 5])
    angle = math.atan2(place[1][1] - place[0][1], place[1][0] - place[0][0])
    turns = bool(model.joints.turns[k])
    s.add("links", "mark", name, plane=plane, rank=1, shown=shown,
          at=s.point_on(b, model.joints.anchor[k, 1]),
          g=glyph(s.out, "roller" if turns else "block"), turn=None if turns else short(angle))


def add_grounds(s: Subject) -> None:
    """A ground symbol at each anchor of a fixed body that has no shape there."""
    model = s.run.model
    found = far_feet(model, FAR_FOOT * s.point)
    found |= {i: points for i, points in joined_points(model, held=True).items()
              if model.bodies.fixed[i] and not model.mechanism.bodies[i].shapes}
    taken: list[XY] = []
    for body, points in found.items():
        for at in dict.fromkeys(points):
            x, y = s.out.place([body, *at])[0].tolist()
            if all(math.dist((x, y), other) > PILED * s.point for other in taken):
                taken.append((x, y))
                s.add("grounds", "mark", plane=s.plane(body), at=s.point_on(body, at),
                      g=glyph(s.out, "ground"))


def stopping(s: Subject) -> Array:
    """Torques of the stops that act, 0 of others, [n, nj]."""
    torque = s.run.arrays["joint_stop"]
    result = np.zeros(torque.shape)
    stopped = s.run.model.joints.stopped
    result[:, stopped] = torque[:, stopped]
    result[np.abs(result) <= 1e-4 * largest_size(torque)] = 0.0
    return result


def add_stops(s: Subject) -> None:
    """A wedge at each hinge whose stop acts, on the side that it pushes."""
    joints, torque = s.run.model.joints, stopping(s)
    centre = s.run.arrays["body_centre"]
    for k in np.flatnonzero(torque.any(axis=0)).tolist():
        a, b = joints.bodies[k].tolist()
        hinge = s.out.place([b, *joints.anchor[k, 1]])
        to_a, to_b = (np.arctan2(way[:, 1], way[:, 0]) for way in (
            s.out.place([body, *centre[body]]) - hinge for body in (a, b)))
        sense = joints.sense[k] * np.sign(torque[:, k])
        middle = to_a + sense * ((sense * (to_b - to_a)) % math.tau) / 2
        s.add("stops", "mark", joints.name[k], plane=s.plane(a, b),
              at=s.point_on(b, joints.anchor[k, 1]), g=glyph(s.out, "stop"),
              turn=s.out.varying(middle, steady=True),
              shown=s.out.varying(torque[:, k] != 0, steady=True))


def add_latches(s: Subject) -> None:
    """A diamond at what may be let go: full while it holds."""
    model, ties = s.run.model, s.run.model.ties
    joints, springs, tendons = model.joints, model.springs, model.tendons
    places = [(int(ties.joint[k]), int(joints.bodies[k, 0]), joints.anchor[k, 0])
              for k in np.flatnonzero(ties.joint != NONE).tolist()]
    for k in np.flatnonzero(ties.spring != NONE).tolist():
        joint = int(springs.joint[k])
        body, at = (springs.bodies[k, 0], springs.anchor[k, 0]) if springs.straight[k] else (
            joints.bodies[joint, 0], joints.anchor[joint, 0])
        places.append((int(ties.spring[k]), int(body), at))
    for k in np.flatnonzero(ties.tendon != NONE).tolist():
        first = tendons.guides(k).start
        places.append((int(ties.tendon[k]), int(tendons.guide_body[first]),
                       tendons.guide_at[first]))
    for tie, body, at in places:
        s.add("latches", "mark", plane=s.plane(body), at=s.point_on(body, at),
              g=[glyph(s.out, "gone"), glyph(s.out, "holds")],
              state=s.out.varying(s.run.arrays["held"][:, tie] != 0, steady=True))
