"""Looks wheels over: gears that do not mesh, circles that do not touch, centres that nothing holds.

Teeth of involutes mesh at other distances, too, with another pressure angle: cos a' = (r_a + r_b)
cos a / distance. Where that is beyond 1 their base circles have no common tangent, and no step can
be made.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, look, mm
from sandbox.errors import Problem
from sandbox.model.model import Model
from sandbox.model.supports import parting_wheels
from sandbox.scene.geometry import Vec, pose_of, to_body, to_world


def wheel_problems(model: Model) -> Iterator[Problem]:
    """Gears, racks and rolling circles that are not where they meet, or that nothing holds."""
    look_at = {"gear": _gear, "rack": _rack, "roll": _roll}
    for i, kind in enumerate(model.joints.kind):
        if kind.keeps in look_at:
            yield from look_at[kind.keeps](model, i)
    tied = _tied(model)
    for i in sorted(parting_wheels(model, model.bodies.pose)):
        path, name = f"$.joints[{i}]", model.joints.name[i]
        whose = ("its rack at the gear" if model.joints.kind[i].keeps == "rack"
                 else "its wheels together")
        if not tied & set(model.joints.bodies[i].tolist()):
            yield look(path, name, f"no joint holds {whose}: teeth push {_name(model, i, 0)} and "
                       f"{_name(model, i, 1)} apart",
                       "give each a bearing: a pin on the ground or on a carrier, of a rack a slot")
        elif not model.joints.play[i] > 0:
            yield look(path, name, f"only springs or cords hold {whose}: teeth without play are "
                       "pulled back into mesh where they change over to the other flank",
                       "give it a 'backlash', 0.01 mm say")


def _tied(model: Model) -> set[int]:
    """Bodies that springs or cords pull at, which may hold wheels together."""
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
    """Distance of two centres at t = 0, where their circles touch, and both radii [m]."""
    ra, rb = model.joints.radii[joint].tolist()
    right = abs(ra - rb) if model.joints.inside[joint] else ra + rb
    return math.dist(*_at(model, joint)), right, ra, rb


def _advice(model: Model, joint: int) -> str:
    """Where the centres should be, or what the second radius should be instead."""
    distance, right, ra, rb = _radii(model, joint)
    other = distance - ra
    if model.joints.inside[joint]:
        other = ra - distance if ra > rb else ra + distance
    instead = f", or make 'radius_b' {mm(other)}" if other > NEGLIGIBLE else ""
    return f"put them {mm(right)} apart{instead}"


def _gear(model: Model, joint: int) -> Iterator[Problem]:
    distance, right, *_ = _radii(model, joint)
    if abs(distance - right) <= NEGLIGIBLE:
        return
    path, name = f"$.joints[{joint}]", model.joints.name[joint]
    apart = f"its centres are {mm(distance)} apart, its pitch circles touch at {mm(right)}"
    share = right * math.cos(model.joints.pressure[joint]) / max(distance, STRAIGHT)
    if share >= 1:
        yield error(path, name, f"its teeth lie in one another at t = 0: {apart}",
                    _advice(model, joint))
        return
    yield look(path, name, f"does not mesh as it should at t = 0: {apart}; teeth would push at "
               f"{deg(math.acos(share))} instead of {deg(model.joints.pressure[joint])}",
               _advice(model, joint))


def _roll(model: Model, joint: int) -> Iterator[Problem]:
    distance, right, *_ = _radii(model, joint)
    if abs(distance - right) <= NEGLIGIBLE:
        return
    told = error if distance < STRAIGHT else look
    yield told(f"$.joints[{joint}]", model.joints.name[joint],
               f"not assembled at t = 0: its centres are {mm(distance)} apart, its circles touch "
               f"at {mm(right)}", _advice(model, joint))


def _rack(model: Model, joint: int) -> Iterator[Problem]:
    right, off = float(model.joints.radii[joint, 0]), _from_pitch_line(model, joint)
    if abs(off - right) > NEGLIGIBLE:
        instead = f", or make 'radius' {mm(off)}" if off > NEGLIGIBLE else ""
        yield look(f"$.joints[{joint}]", model.joints.name[joint],
                   f"does not mesh at t = 0: its pitch line is {mm(off)} from the gear's centre, "
                   f"the pitch circle has a radius of {mm(right)}",
                   f"move the rack or its 'on_b' by {mm(abs(off - right))}{instead}")


def _from_pitch_line(model: Model, joint: int) -> float:
    """Distance at t = 0 [m] of a gear's centre from the pitch line of its rack."""
    joints = model.joints
    x, y = to_body(pose_of(model.mechanism.bodies[joints.bodies[joint, 1]]), _at(model, joint)[0])
    bx, by = joints.anchor[joint, 1].tolist()
    gx, gy = joints.along[joint].tolist()
    return float(gx * (y - by) - gy * (x - bx))
