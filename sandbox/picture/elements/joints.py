"""Joints: pins, grooves, welds, grounds, stops that act; rods, ropes, actuators, springs, bars."""

from __future__ import annotations

import math
from functools import partial
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.elements.arrays import largest_size
from sandbox.model.joints import slot_points
from sandbox.model.model import NONE
from sandbox.numeric import Array
from sandbox.picture.elements.bodies import beside, joined_points, outer_anchors
from sandbox.picture.geometry import XY
from sandbox.picture.listing import Between, Point, flat, short
from sandbox.picture.palette import ZIGZAG
from sandbox.picture.scales import UNLOADED, bars_of
from sandbox.picture.subject import Subject

FAR_FOOT, PILED = 16.0, 11.0  # distances of ground symbols from shapes, each other [points]
TELLING, SHORT, BESIDE = 12, 36.0, 6.0  # numbers at links: count, minimum length, distance [points]
TUBE, LONGEST_TUBE, STROKE = 0.85, 0.96, 0.88
"""Usual and longest cylinder, longest stroke of one rod [minimum lengths of the actuator]."""
TUBE_WIDTH = 13.0  # of an actuator's cylinder [points]
COIL, COIL_WIDTH = 1.1, [0.09, 3.2, 8.0]  # springs: width of the line [points]; ``w`` of a span
THICK = (0.5, 6.0)  # limits of the shown stiffness of a driven spring [its own stiffness]
BAND = 5.4  # width of a loaded bar's band [points]


def add_joints(s: Subject) -> None:
    """Marks and grooves of joints: a pin or friction at b, a weld at a, ends of links."""
    model, joints = s.run.model, s.run.model.joints
    for k, kind in enumerate(joints.kind):
        (a, b), (on_a, on_b) = joints.bodies[k].tolist(), joints.anchor[k]
        where: dict[str, Any] = {"plane": s.plane(a, b), "shown": s.held(int(model.bonds.joint[k]))}
        if kind.keeps == "groove":
            _groove(s, k, where)
        if k in joints.frictional:
            s.add("pins", "mark", joints.name[k], rank=-1, at=s.on(b, on_b), g=["slides", "rubs"],
                  state=s.steady(s.run.arrays["joint_sticks"][:, k] == 1.0), **where)
        places = [("end", a, on_a), ("end", b, on_b)] if kind.along_line else (
            [("pin", b, on_b)] if kind.keeps == "groove" or kind.angle else
            [("weld", a, on_a)] if kind.keeps == "point" else [])
        for mark, body, at in places:
            s.add("pins", "mark", joints.name[k], at=s.on(body, at), g=mark, **where)


def _groove(s: Subject, k: int, where: dict[str, Any]) -> None:
    """A groove: a slot in its body, or two lines on the ground with a roller or block."""
    model = s.run.model
    (a, b), groove = model.joints.bodies[k].tolist(), slot_points(model, k)
    name, curved = model.joints.name[k], len(groove) > 2
    middle = groove[len(groove) // 2] if curved else groove.mean(axis=0)
    rail = not model.mechanism.bodies[a].shapes or all(  # begins, ends and has its middle beside
        beside(model, a, (float(x), float(y))) for x, y in (groove[0], groove[-1], middle))
    if curved or not (rail and model.bodies.fixed[a]):
        s.add("rails" if rail else "grooves", "path", name, f=a, m=1 if curved else None,
              s=("paper", "pin_ring", 1.1), **where,
              d=[{"c": [*flat(one, two), short(2.0 * s.point)]} for one, two in pairwise(groove)])
        return
    ends = [s.on(a, at) for at in groove]
    place = [s.out.place(end)[0].tolist() for end in ends]
    if place[1] < place[0]:
        ends, place = ends[::-1], place[::-1]
    half, between = 6.5, {"a": ends[0], "b": ends[1], **where}
    s.add("rails", "span", name, s=("", "ink", 1.0), w=[0, half, half], **between,
          t=[0, 1, 1, 1, 1, -1, 0, -1, 0, 1])
    s.add("rails", "span", every=8, s=("", "faint_ink", 0.9), **between,
          t=[0, -half, -5, -half - 5])
    turns = bool(model.joints.turns[k])
    angle = math.atan2(place[1][1] - place[0][1], place[1][0] - place[0][0])
    s.add("links", "mark", name, rank=1, at=s.on(b, model.joints.anchor[k, 1]), **where,
          g="roller" if turns else "block", turn=None if turns else short(angle))


def add_grounds(s: Subject) -> None:
    """A ground symbol at each anchor of a fixed body that has no shape there."""
    model = s.run.model
    found = [(body, at) for body, at, nearest in outer_anchors(model)
             if model.bodies.fixed[body] and math.dist(at, nearest) > FAR_FOOT * s.point]
    found += [(body, at) for body, points in joined_points(model, held=True).items()
              if model.bodies.fixed[body] and not model.mechanism.bodies[body].shapes
              for at in points]
    taken: list[XY] = []
    for body, at in dict.fromkeys(found):
        x, y = s.out.place([body, *at])[0].tolist()
        if all(math.dist((x, y), other) > PILED * s.point for other in taken):
            taken.append((x, y))
            s.add("grounds", "mark", plane=s.plane(body), at=s.on(body, at), g="ground")


def stopping(s: Subject) -> Array:
    """Torques of the stops that act, 0 of others, [n, nj]."""
    torque, stopped = s.run.arrays["joint_stop"], s.run.model.joints.stopped
    acts = np.isin(range(len(torque.T)), stopped) & (np.abs(torque) > 1e-4 * largest_size(torque))
    return np.where(acts, torque, 0.0)


def add_stops(s: Subject) -> None:
    """A wedge at each hinge whose stop acts, on the side that it pushes."""
    joints, torque, centre = s.run.model.joints, stopping(s), s.run.arrays["body_centre"]
    for k in np.flatnonzero(torque.any(axis=0)).tolist():
        a, b = joints.bodies[k].tolist()
        hinge = s.out.place([b, *joints.anchor[k, 1]])
        to_a, to_b = (np.arctan2(way[:, 1], way[:, 0]) for way in (
            s.out.place([body, *centre[body]]) - hinge for body in (a, b)))
        sense = joints.sense[k] * np.sign(torque[:, k])
        middle = to_a + sense * ((sense * (to_b - to_a)) % math.tau) / 2
        s.add("stops", "mark", joints.name[k], plane=s.plane(a, b), g="stop",
              at=s.on(b, joints.anchor[k, 1]), turn=s.steady(middle),
              shown=s.steady(torque[:, k] != 0))


def add_latches(s: Subject) -> None:
    """A diamond at each bond: full while it holds."""
    model, bonds = s.run.model, s.run.model.bonds
    joints, springs, tendons = model.joints, model.springs, model.tendons
    at_joints = list(zip(joints.bodies[:, 0], joints.anchor[:, 0], strict=True))
    at_springs = [(springs.bodies[k, 0], springs.anchor[k, 0]) if straight
                  else at_joints[springs.joint[k]] for k, straight in enumerate(springs.straight)]
    at_tendons = [(tendons.guide_body[k], tendons.guide_at[k])
                  for k in (tendons.guides(i).start for i in range(len(tendons.name)))]
    for bond, (body, at) in zip(np.concatenate([bonds.joint, bonds.spring, bonds.tendon]).tolist(),
                                [*at_joints, *at_springs, *at_tendons], strict=True):
        if bond != NONE:
            s.add("latches", "mark", plane=s.plane(body), at=s.on(body, at),
                  g=["gone", "holds"], state=s.steady(s.run.arrays["held"][:, bond] != 0))


def add_links(s: Subject) -> None:
    """Rods, ropes and actuators, coloured by their load, with numbers if they are few."""
    model, carried = s.run.model, s.carried
    driven = {int(model.drives.target[i]) for i in model.drives.giving("push")}
    sizes = np.abs(carried.links).max(axis=0, initial=0.0)
    loaded = np.flatnonzero(sizes > UNLOADED * carried.largest).tolist()
    for k, kind in enumerate(model.joints.kind):
        if not kind.along_line:
            continue
        link, (low, high) = _Link(s, k), model.joints.reach[k].tolist()
        level = _level(carried.links[:, k], carried.largest)
        if kind.keeps == "distance":
            link.tube(link.ends[0], link.ends[1], level)
        elif kind.line:
            length = s.run.arrays["joint_length"][:, k]
            link.actuator(low or float(length.min(initial=math.inf)),
                          high if math.isfinite(high) else float(length.max(initial=0.0)),
                          "drive" if k in driven else "pin_ring")
        else:
            link.rope(low, high, level)
        if k in loaded and len(loaded) <= TELLING and (float(link.length.max()) > SHORT * s.point):
            values, seen = carried.links[:, k], (level != 0) & (link.length > SHORT * s.point)
            s.number("link_forces", link.name, link.way.at(link.length / 2), values,
                     carried.largest, "N", steady=True, token="ink", rank=4, clear=BESIDE,
                     shown=s.steady(seen & link.holds))


def _level(tension: Array, largest: float) -> Array:
    level = tension / (largest or 1.0)
    return np.where(np.abs(level) <= UNLOADED, 0.0, level)


class _Link:
    """Adds the items of one link."""

    def __init__(self, s: Subject, k: int) -> None:
        joints = s.run.model.joints
        self.s, self.name = s, joints.name[k]
        self.ends = [s.on(*end) for end in zip(joints.bodies[k], joints.anchor[k], strict=True)]
        shown = s.held(int(s.run.model.bonds.joint[k]))
        self.holds: Any = True if shown is None else s.out.columns[shown[0]] != 0
        self.add = partial(s.add, "links", name=self.name, shown=shown,
                           plane=s.plane(*joints.bodies[k].tolist()))
        self.way = Between(s.out, *map(s.out.place, self.ends))
        self.length = self.way.length

    def line(self, points: list[Point], token: str, width: float) -> None:
        self.add("line", p=points, s=("", token, width))

    def loaded(self, points: list[Point], token: str, width: float, level: Array,
               **fields: Any) -> None:
        """A line in the colour of its load, or of a token without load."""
        self.add("line", p=points, s=[("", each, width) for each in (token, "@load")],
                 state=self.s.steady(level != 0), by=self.s.steady(level), **fields)

    def tube(self, start: Point, end: Point, level: Array) -> None:
        self.line([start, end], "pin_ring", 4.4)
        self.loaded([start, end], "paper", 2.6, level)

    def rope(self, shortest: float, longest: float, level: Array) -> None:
        """A taut rope with strands, a slack one dashed; with a minimum length a telescope."""
        s, (a, b) = self.s, self.ends
        if shortest > 0:
            middle = self.way.at(self.length / 2)
            self.tube(a, middle, level)
            self.line([middle, b], "pin_ring", 1.6)
            return
        taut = self.length > 0.998 * longest  # else slack
        if (taut & self.holds).any():
            shown = s.steady(taut & self.holds)
            self.loaded(self.ends, "rope", 4.6, level, shown=shown)
            self.add("span", a=a, b=b, every=6.5, t=[-2.9, -2.9, 2.9, 2.9],
                     s=("", "paper", 1.3), shown=shown)
        if not taut.all():
            depth = np.sqrt(np.maximum(longest - self.length, 0.0) * self.length * 3 / 8)
            self.add("sag", a=a, b=b, s=("", "rope", 1.3, 5),
                     depth=s.out.varying(np.minimum(depth, longest / 2)),
                     shown=s.steady(~taut & self.holds))

    def actuator(self, shortest: float, longest: float, token: str) -> None:
        """A cylinder with its piston in a colour, and a rod of constant length."""
        point = self.s.point
        tube, piston = cylinder(self.length, shortest, longest, 12 * point)
        inset, half = 1.4 * point, 3.0 * point
        middle = np.clip(piston, inset + half, np.maximum(tube - inset - half, inset + half))
        foot, cap, head, block = (self.way.at(far)[0] for far in (0.0, tube, piston, middle))
        self.line([[head, 0, 0], self.ends[1]], "pin_ring", 4.4)
        self.line([[foot, 0, 0], [cap, 0, 0]], "pin_ring", TUBE_WIDTH)
        self.line([[foot, inset, 0], [cap, -inset, 0]], "paper", TUBE_WIDTH - 2.6)
        self.line([[head, 0, 0], [cap, 0, 0]], "pin_ring", 4.4)
        self.line([[block, -half, 0], [block, half, 0]], token, TUBE_WIDTH - 2.6)


def cylinder(length: Array, low: float, high: float, least: float) -> tuple[Array, Array]:
    """Lengths of a cylinder, preferably from ``least``, and its piston's positions [n] m."""
    stroke = high - low
    if stroke <= STROKE * low and TUBE * low >= least:
        tube = min(max(TUBE * low, stroke / STROKE * LONGEST_TUBE), LONGEST_TUBE * low)
        return np.full_like(length, tube), (tube - stroke) / 2 + length - low
    tubes = np.minimum(max(TUBE * low, 0.2 * high, least), 0.9 * length)
    share = (length - low) / stroke if stroke > 0 else np.full_like(length, 0.5)
    return tubes, tubes * (0.14 + 0.72 * np.clip(share, 0.0, 1.0))


def made_stiffer(s: Subject, drive: int, own: float) -> tuple[Array, Array]:
    """How a driven stiffness shows: from -1 to 1, 0 at the element's own; a factor of its width."""
    low, high = THICK
    share = np.maximum(s.run.arrays["drive_value"][:, drive] / own, low)
    level = np.interp(np.log(share), np.log([low, 1.0, high]), [-1.0, 0.0, 1.0])
    return level, 1 + np.where(level > 0, 1.2, 0.3) * level


def add_springs(s: Subject) -> None:
    """Coils between two points, spirals about hinges."""
    model, pose = s.run.model, s.run.arrays["body_pose"]
    springs, joints = model.springs, model.joints
    for k, name in enumerate(springs.name):
        (a, b), joint = springs.bodies[k].tolist(), int(springs.joint[k])
        law, rest = springs.law[k], float(springs.rest[k])
        side = 0 if law is None else law.side
        where: dict[str, Any] = {"plane": s.plane(a, b), "shown": s.held(
            int(model.bonds.spring[k]), int(model.bonds.joint[joint]) if joint >= 0 else NONE)}
        if not springs.straight[k]:
            sense, wind = int(joints.sense[joint]), pose[:, b, 2] - pose[:, a, 2]
            now = sense * wind - joints.zero[joint]
            look = _spring_look(s, k, side * (now - rest) <= 0 if side else None)
            s.add("springs", "spiral", name, at=s.on(b, joints.anchor[joint, 1]), r=[5, 11],
                  start=s.out.varying(pose[:, a, 2]),
                  sweep=s.out.varying(sense * 1.5 * math.tau + wind), **look, **where)
            continue
        ends, apart = [s.on(*end) for end in zip((a, b), springs.anchor[k], strict=True)], None
        if side:
            start, end = map(s.out.place, ends)
            size = np.maximum(np.hypot(*(end - start).T), 1e-12)
            apart = side * (size - rest) <= 0
            if side < 0 and (size > rest).any():  # it does not follow a body that leaves it
                share = np.minimum(1.0, rest / size)[:, None]
                ends[1] = s.out.spot(start + (end - start) * share)
        look = _spring_look(s, k, apart)
        s.add("springs", "span", name, a=ends[0], b=ends[1], t=ZIGZAG, w=COIL_WIDTH, **look,
              **where)
        for at in ends:
            s.add("springs", "mark", at=at, g="dot", **where)


def _spring_look(s: Subject, k: int, apart: Array | None) -> dict[str, Any]:
    """Style of a spring: driven ones by stiffness, grey where a one-sided one has a gap."""
    springs = s.run.model.springs
    drive, own = int(springs.drive[k]), float(springs.stiffness[k])
    look: dict[str, Any] = {"s": ("", "spring", COIL)}
    if drive != NONE and own:
        s.signs.add("stiffer")
        level, wide = made_stiffer(s, drive, own)
        look = {"s": ("", "@stiffness", COIL), "by": s.out.varying(level),
                "wide": s.out.varying(wide)}
    if apart is not None and apart.any():
        look |= {"s": [look["s"], ("", "slack", COIL)], "state": s.steady(apart)}
    return look


def add_bars(s: Subject) -> None:
    """Bands from pin to pin of bodies, in the colour of their load; with a few numbers."""
    bars, carried = bars_of(s.run, s.layers.get("bars", ())), s.carried
    for k, bar in enumerate(bars):
        ends, tension = [s.on(bar.body, at) for at in bar.ends], carried.bars[:, k]
        name, plane = s.run.mechanism.bodies[bar.body].name, s.plane(bar.body)
        s.add("bars", "line", plane=plane, p=ends, s=("", "pin_ring", BAND))
        s.add("bars", "line", name, plane=plane, p=ends, s=("", "@load", BAND - 1.8),
              by=s.steady(_level(tension, carried.largest)))
        if len(bars) <= TELLING and carried.largest > 0 and (
                math.dist(*bar.ends) > SHORT * s.point):
            s.number("bars", "", s.on(bar.body, np.mean(bar.ends, axis=0)), tension,
                     carried.largest, "N", steady=True, token="ink", rank=4, clear=BESIDE)
