"""Looks joints over: whether they are assembled, have a direction, and share what they hold."""

from __future__ import annotations

import math
from collections.abc import Iterator

from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, fitting, look, mm
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.model.supports import shared_joints
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
            told = error if directionless else look
            yield told("not-assembled", f"$.joints[{i}]", name, "not assembled at t = 0: "
                       f"{message}", f"move a body or an anchor, or {_advice(model, i)}")
        low, high = joints.stops[i].tolist()
        if joints.start[i] < low - 1e-9 or joints.start[i] > high + 1e-9:
            yield look("outside-limits", f"$.joints[{i}]", name,
                       f"starts at {deg(joints.start[i])}, outside its limits [{deg(low)}, "
                       f"{deg(high)}]", "turn a body, or set 'zero'")


def shared_problems(model: Model) -> Iterator[Problem]:
    """Joints that hold what others hold already, so that their shares are not decided."""
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
    """Whether a joint holds at t = 0."""
    return model.ties.begins(int(model.ties.joint[joint]))


def _distance(model: Model, joint: int) -> tuple[float, Vec]:
    """Between a joint's anchors at t = 0 [m], and the one of ``b`` in the frame of ``a``."""
    joints, mechanism = model.joints, model.mechanism
    a, b = (pose_of(mechanism.bodies[body]) for body in joints.bodies[joint])
    on_a, on_b = ((float(x), float(y)) for x, y in joints.anchor[joint])
    at_b = to_world(b, on_b)
    return math.dist(to_world(a, on_a), at_b), to_body(a, at_b)


def _groove(model: Model, joint: int) -> tuple[Vec, Vec]:
    start, end = ((float(x), float(y)) for x, y in model.joints.groove[joint])
    return start, end


def _directionless(model: Model, joint: int) -> bool:
    """Whether a joint that acts along a line has none: no step can be made then."""
    match model.joints.kind[joint].keeps:
        case "groove":
            return math.dist(*_groove(model, joint)) < STRAIGHT
        case "distance":
            return _distance(model, joint)[0] < STRAIGHT
        case _:
            return False


def _apart(model: Model, joint: int) -> str:
    """How a joint's anchors contradict it at t = 0; empty when they do not."""
    distance, point = _distance(model, joint)
    least, most = model.joints.reach[joint].tolist()
    match model.joints.kind[joint].keeps:
        case "point":
            return f"its anchors are {mm(distance)} apart" if distance > NEGLIGIBLE else ""
        case "groove":
            start, end = _groove(model, joint)
            if math.dist(start, end) < STRAIGHT:
                return "its groove begins and ends in one place, where it has no direction"
            off = _from_segment(point, start, end)
            return f"its point is {mm(off)} off the groove" if off > NEGLIGIBLE else ""
        case "gear" | "rack" | "roll":  # sandbox.engine.inspect_wheels
            return ""
        case "distance":
            if least <= NEGLIGIBLE:
                return "its ends are in one place, where it has no direction: that is a pin"
            return (f"its ends are {mm(distance)} apart, its length is {mm(least)}"
                    if abs(distance - least) > NEGLIGIBLE else "")
        case "range":
            return ("" if least - NEGLIGIBLE <= distance <= most + NEGLIGIBLE else
                    f"its ends are {mm(distance)} apart, it allows {mm(least)} to {mm(most)}")


def _advice(model: Model, joint: int) -> str:
    """The length that would do where a joint has one, or that one of its anchors would follow."""
    keeps, most = model.joints.kind[joint].keeps, float(model.joints.reach[joint, 1])
    distance = _distance(model, joint)[0]
    if keeps == "groove":
        return "put the groove where the point is"
    if keeps not in ("distance", "range") or distance < STRAIGHT:
        return "leave one anchor out"
    field = "length" if keeps == "distance" else "longest" if distance > most else "shortest"
    return f"make {field!r} {fitting(distance)}"


def _from_segment(point: Vec, start: Vec, end: Vec) -> float:
    """Distance [m] of a point from a segment that has a length."""
    along = (end[0] - start[0], end[1] - start[1])
    square = along[0] ** 2 + along[1] ** 2
    fraction = ((point[0] - start[0]) * along[0] + (point[1] - start[1]) * along[1]) / square
    fraction = min(max(fraction, 0.0), 1.0)
    return math.dist(point, (start[0] + fraction * along[0], start[1] + fraction * along[1]))
