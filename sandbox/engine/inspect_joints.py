"""Checks of joints at t = 0: assembly, directions, overconstraint, gears, racks, rolling circles.

Involute teeth mesh at other distances of the centres, too, with the pressure angle a' given by
cos a' = (r_a + r_b) cos a / distance. Beyond cos a' = 1 the base circles have no common tangent,
and no step can be made.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, fitting, look, mm
from sandbox.errors import Problem
from sandbox.model.joints import place_in_slot, slot_length
from sandbox.model.model import Model
from sandbox.model.supports import parting_wheels, shared_joints
from sandbox.scene.geometry import Vec, pose_of, to_body, to_world
from sandbox.wording import listed


def joint_problems(model: Model) -> Iterator[Problem]:
    """Joints that contradict the poses at t = 0; those without a direction are errors."""
    joints = model.joints
    for i, name in enumerate(joints.name):
        directionless = _directionless(model, i)
        if not (directionless or _begins(model, i)):
            continue
        if message := _apart(model, i):
            report = error if directionless else look
            yield report("not-assembled", f"$.joints[{i}]", name, "not assembled at t = 0: "
                       f"{message}", f"move a body or an anchor, or {_advice(model, i)}")
        low, high = joints.stops[i].tolist()
        if joints.start[i] < low - 1e-9 or joints.start[i] > high + 1e-9:
            yield look("outside-limits", f"$.joints[{i}]", name,
                       f"starts at {deg(joints.start[i])}, outside its limits [{deg(low)}, "
                       f"{deg(high)}]", "turn a body, or set 'zero'")


def shared_problems(model: Model) -> Iterator[Problem]:
    """Redundant joints, whose shares of the load statics does not determine."""
    shared = sorted(shared_joints(model, model.bodies.pose).joints)
    if shared and all(_begins(model, j) for j in shared):
        names = listed([model.joints.name[j] for j in shared])
        yield look("overconstrained", "$.joints", "", f"{names} are overconstrained: statics does "
                   "not determine each reaction; the smallest that balance are recorded",
                   "remove one, or give it a degree of freedom, to determine them")
    for j in shared:
        if model.joints.rubbing[j] > 0:
            yield look("overconstrained", f"$.joints[{j}].friction_coefficient",
                       model.joints.name[j], "its friction depends on a reaction that statics does "
                       "not determine", "give 'friction' as a number, or remove redundant joints")


def _begins(model: Model, joint: int) -> bool:
    """Whether a joint is closed at t = 0."""
    return model.ties.begins(int(model.ties.joint[joint]))


def _distance(model: Model, joint: int) -> float:
    """Between a joint's anchors at t = 0 [m]."""
    joints, mechanism = model.joints, model.mechanism
    a, b = (pose_of(mechanism.bodies[body]) for body in joints.bodies[joint])
    on_a, on_b = ((float(x), float(y)) for x, y in joints.anchor[joint])
    return math.dist(to_world(a, on_a), to_world(b, on_b))


def _directionless(model: Model, joint: int) -> bool:
    """Whether a joint has no line of action; then no step can be made."""
    match model.joints.kind[joint].keeps:
        case "groove":
            return slot_length(model, joint) < STRAIGHT
        case "distance":
            return _distance(model, joint) < STRAIGHT
        case _:
            return False


def _apart(model: Model, joint: int) -> str:
    """The error of a joint's anchors at t = 0 in words; empty if there is none."""
    distance = _distance(model, joint)
    least, most = model.joints.reach[joint].tolist()
    match model.joints.kind[joint].keeps:
        case "point":
            return f"its anchors are {mm(distance)} apart" if distance > NEGLIGIBLE else ""
        case "groove":
            word = "path" if model.joints.path[joint] else "groove"
            length = slot_length(model, joint)
            if length < STRAIGHT:
                return "the ends of its groove coincide, so it has no direction"
            place = place_in_slot(model, joint, model.bodies.pose)
            beyond = max(-float(place.along), float(place.along) - length, 0.0)
            off = math.hypot(float(place.across), beyond)
            return f"its point is {mm(off)} off the {word}" if off > NEGLIGIBLE else ""
        case "gear" | "rack" | "roll":  # sandbox.engine.inspect_joints
            return ""
        case "distance":
            if least <= NEGLIGIBLE:
                return "its ends coincide, so it has no direction: use a pin"
            return (f"its ends are {mm(distance)} apart, its length is {mm(least)}"
                    if abs(distance - least) > NEGLIGIBLE else "")
        case "range":
            return ("" if least - NEGLIGIBLE <= distance <= most + NEGLIGIBLE else
                    f"its ends are {mm(distance)} apart, it allows {mm(least)} to {mm(most)}")


def _advice(model: Model, joint: int) -> str:
    """Advice: the right length of the joint, or to leave an anchor out."""
    keeps, most = model.joints.kind[joint].keeps, float(model.joints.reach[joint, 1])
    distance = _distance(model, joint)
    if keeps == "groove":
        return f"move the {'path' if model.joints.path[joint] else 'groove'} to the point"
    if keeps not in ("distance", "range") or distance < STRAIGHT:
        return "leave one anchor out"
    field = "length" if keeps == "distance" else "longest" if distance > most else "shortest"
    return f"make {field!r} {fitting(distance)}"


ASKEW = 1e-4
"""Sine of the smallest reported angle between the pitch line of a rack and its groove: 0.1 mm in a
travel of 1 m."""


def wheel_problems(model: Model) -> Iterator[Problem]:
    """Gears, racks and rolling circles that do not meet, or whose centres are not held."""
    look_at = {"gear": _gear, "rack": _rack, "roll": _roll}
    for i, kind in enumerate(model.joints.kind):
        if kind.keeps in look_at:
            yield from look_at[kind.keeps](model, i)
    tied = _tied(model)
    askew = {i for i, kind in enumerate(model.joints.kind)
             if kind.keeps == "rack" and _slide(model, i)}
    for i in sorted(parting_wheels(model, model.bodies.pose) - askew):
        path, name = f"$.joints[{i}]", model.joints.name[i]
        whose = ("its rack at the gear" if model.joints.kind[i].keeps == "rack"
                 else "its wheels together")
        if not tied & set(model.joints.bodies[i].tolist()):
            yield look("bad-mesh", path, name, f"no joint holds {whose}: teeth push "
                       f"{_name(model, i, 0)} and {_name(model, i, 1)} apart", "give each a "
                       "bearing: a pin on the ground or on a carrier, of a rack a slot")
        elif not model.joints.play[i] > 0:
            yield look("bad-mesh", path, name, f"only springs or tendons hold {whose}: without "
                       "backlash the teeth get an impact when the other flank takes over",
                       "give it a 'backlash', for example 0.01 mm")


def _tied(model: Model) -> set[int]:
    """Bodies with springs or tendons, which may hold wheels together."""
    springs, tendons = model.springs, model.tendons
    return {*springs.bodies[springs.straight].ravel().tolist(), *tendons.guide_body.tolist()}


def _name(model: Model, joint: int, end: int) -> str:
    return repr(model.bodies.name[model.joints.bodies[joint, end]])


def _at(model: Model, joint: int) -> tuple[Vec, Vec]:
    """The centre on ``a`` in the world and, of ``b``, its anchor, at t = 0 [m]."""
    bodies, anchors = model.joints.bodies[joint].tolist(), model.joints.anchor[joint].tolist()
    one, two = (to_world(pose_of(model.mechanism.bodies[body]), (x, y))
                for body, (x, y) in zip(bodies, anchors, strict=True))
    return one, two


def _radii(model: Model, joint: int) -> tuple[float, float, float, float]:
    """Distance of two centres at t = 0, that at which their circles touch, both radii [m]."""
    ra, rb = model.joints.radii[joint].tolist()
    right = abs(ra - rb) if model.joints.inside[joint] else ra + rb
    return math.dist(*_at(model, joint)), right, ra, rb


def _wheel_advice(model: Model, joint: int) -> str:
    """Advice: the right distance of the centres, or the right second radius."""
    distance, right, ra, rb = _radii(model, joint)
    other = distance - ra
    if model.joints.inside[joint]:
        other = ra - distance if ra > rb else ra + distance
    instead = f", or make 'radius_b' {fitting(other)}" if other > NEGLIGIBLE else ""
    if model.joints.inside[joint]:
        inside, fits = "leave 'inside' out", ra + rb
    else:
        inside, fits = 'write "inside": true', abs(ra - rb)
    as_they_are = (f", or {inside}: then they fit as they are"
                   if ra != rb and abs(distance - fits) <= NEGLIGIBLE else "")
    return f"put them {fitting(right)} apart{instead}{as_they_are}"


def _gear(model: Model, joint: int) -> Iterator[Problem]:
    distance, right, *_ = _radii(model, joint)
    if abs(distance - right) <= NEGLIGIBLE:
        return
    path, name = f"$.joints[{joint}]", model.joints.name[joint]
    apart = f"its centres are {mm(distance)} apart, its pitch circles touch at {mm(right)}"
    share = right * math.cos(model.joints.pressure[joint]) / max(distance, STRAIGHT)
    if share >= 1:
        yield error("bad-mesh", path, name, f"its teeth overlap at t = 0: {apart}",
                    _wheel_advice(model, joint))
        return
    yield look("bad-mesh", path, name, f"does not mesh as it should at t = 0: {apart}; teeth would "
               f"push at {deg(math.acos(share))} instead of {deg(model.joints.pressure[joint])}",
               _wheel_advice(model, joint))


def _roll(model: Model, joint: int) -> Iterator[Problem]:
    distance, right, *_ = _radii(model, joint)
    if abs(distance - right) <= NEGLIGIBLE:
        return
    report = error if distance < STRAIGHT else look
    yield report("not-assembled", f"$.joints[{joint}]", model.joints.name[joint],
               f"not assembled at t = 0: its centres are {mm(distance)} apart, its circles touch "
               f"at {mm(right)}", _wheel_advice(model, joint))


def _rack(model: Model, joint: int) -> Iterator[Problem]:
    right, off = float(model.joints.radii[joint, 0]), _from_pitch_line(model, joint)
    path, name = f"$.joints[{joint}]", model.joints.name[joint]
    if slide := _slide(model, joint):
        slot, (x, y) = slide
        off = abs(_from_pitch_line(model, joint, (x, y)))
        move = ("" if abs(off - right) <= NEGLIGIBLE else
                f", and move the rack or its 'on_b' by {fitting(abs(off - right))}")
        gx, gy = model.joints.along[joint].tolist()
        yield look("bad-mesh", f"{path}.along", name, "its pitch line is turned by "
                   f"{deg(math.acos(min(abs(gx * x + gy * y), 1.0)))} from the groove of "
                   f"{model.joints.name[slot]!r}, in which its rack slides: its teeth leave the "
                   "gear, or jam", f"make 'along' [{x + 0.0:.6g}, {y + 0.0:.6g}]{move}")
    elif abs(off - right) > NEGLIGIBLE:
        instead = f", or make 'radius' {fitting(off)}" if off > NEGLIGIBLE else ""
        yield look("bad-mesh", path, name, f"does not mesh at t = 0: its pitch line is {mm(off)} "
                   f"from the gear's centre, the pitch circle has a radius of {mm(right)}",
                   f"move the rack or its 'on_b' by {fitting(abs(off - right))}{instead}")


def _slide(model: Model, joint: int) -> tuple[int, Vec] | None:
    """A slot in which a rack slides in another direction than its pitch line, and the direction.

    The slot prevents rotation and is fixed to the same body as the gear's centre. The direction is
    that of the groove in the rack's frame, of length 1.
    """
    joints, free = model.joints, model.bodies.free
    gear, rack = joints.bodies[joint].tolist()
    holders = {gear, *(end for i in np.flatnonzero([each.keeps == "point" for each in joints.kind])
                       if gear in (pair := joints.bodies[i].tolist()) for end in pair)} - {rack}
    for i, kind in enumerate(joints.kind):
        pair = joints.bodies[i].tolist()
        if kind.keeps != "groove" or joints.path[i] or joints.turns[i] or rack not in pair:
            continue
        other = pair[1 - pair.index(rack)]
        if other not in holders and (free[other] or free[sorted(holders)].all()):
            continue
        start, end = (to_world(pose_of(model.mechanism.bodies[pair[0]]), (float(x), float(y)))
                      for x, y in joints.groove[i])
        turned = pose_of(model.mechanism.bodies[rack])[2]
        x, y = to_body((0.0, 0.0, turned), (end[0] - start[0], end[1] - start[1]))
        length, (gx, gy) = math.hypot(x, y), joints.along[joint].tolist()
        if length > STRAIGHT and abs(gx * y - gy * x) > ASKEW * length:
            return i, (x / length, y / length)
    return None


def _from_pitch_line(model: Model, joint: int, along: Vec | None = None) -> float:
    """Distance at t = 0 [m] of a gear's centre from the pitch line of its rack.

    ``along`` takes the place of the line's own direction, with the gear to its left.
    """
    joints = model.joints
    x, y = to_body(pose_of(model.mechanism.bodies[joints.bodies[joint, 1]]), _at(model, joint)[0])
    bx, by = joints.anchor[joint, 1].tolist()
    gx, gy = joints.along[joint].tolist() if along is None else along
    return float(gx * (y - by) - gy * (x - bx))
