"""Checks of joints and of overlaps at t = 0.

Involute teeth mesh at other distances of the centres, too, with the pressure angle a' given by
cos a' = (r_a + r_b) cos a / distance. Beyond cos a' = 1 the base circles have no common tangent,
and no step can be made.

Shapes are sorted along the longer axis, and compared with those whose boxes overlap. At most
:data:`MAX_PAIRS` pairs of shapes (and :data:`MAX_BOXES` pairs of boxes) are compared; the report
says if this is not all of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

import numpy as np
import pymunk

from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, fitting, look, mm
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.joints import place_in_slot, slot_length
from sandbox.model.model import Model
from sandbox.model.supports import parting_wheels, shared_joints
from sandbox.numeric import Flags, Integers
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import Vec, pose_of, solids, to_body
from sandbox.wording import listed


def joint_problems(model: Model) -> Iterator[Problem]:
    """Joints that contradict the poses at t = 0; those without a direction are errors."""
    joints = model.joints
    for i, name in enumerate(joints.name):
        distance, keeps = math.dist(*model.ends(i)), joints.kind[i].keeps
        directionless = (keeps == "distance" and distance < STRAIGHT) or (
            keeps == "groove" and slot_length(model, i) < STRAIGHT)
        if not (directionless or model.bonds.begins(int(model.bonds.joint[i]))):
            continue
        if message := _apart(model, i, distance):
            report = error if directionless else look
            advice = _advice(model, i, distance)
            yield report("not-assembled", f"$.joints[{i}]", name, "not assembled at t = 0: "
                         f"{message}", f"move a body or an anchor, or {advice}")
        low, high = joints.stops[i].tolist()
        if joints.start[i] < low - 1e-9 or joints.start[i] > high + 1e-9:
            yield look("outside-limits", f"$.joints[{i}]", name,
                       f"starts at {deg(joints.start[i])}, outside its limits [{deg(low)}, "
                       f"{deg(high)}]", "turn a body, or set 'zero'")


def shared_problems(model: Model) -> Iterator[Problem]:
    """Redundant joints, whose shares of the load statics does not determine."""
    shared = sorted(shared_joints(model, model.bodies.pose).joints)
    if shared and all(
            model.bonds.begins(int(model.bonds.joint[j])) for j in shared):
        names = listed([model.joints.name[j] for j in shared])
        yield look("overconstrained", "$.joints", "", f"{names} are overconstrained: statics does "
                   "not determine each reaction; the smallest that balance are recorded",
                   "remove one, or give it a degree of freedom, to determine them")
    for j in shared:
        if model.joints.coefficient[j] > 0:
            yield look("overconstrained", f"$.joints[{j}].friction_coefficient",
                       model.joints.name[j], "its friction depends on a reaction that statics does "
                       "not determine", "give 'friction' as a number, or remove redundant joints")


def _apart(model: Model, joint: int, distance: float) -> str:
    """The error of a joint's anchors at t = 0 in words; empty if there is none."""
    least, most = model.joints.reach[joint].tolist()
    match model.joints.kind[joint].keeps:
        case "point" if distance > NEGLIGIBLE:
            return f"its anchors are {mm(distance)} apart"
        case "groove":
            length = slot_length(model, joint)
            if length < STRAIGHT:
                return "the ends of its groove coincide, so it has no direction"
            place = place_in_slot(model, joint, model.bodies.pose)
            beyond = max(-float(place.along), float(place.along) - length, 0.0)
            off = math.hypot(float(place.across), beyond)
            word = "path" if model.joints.path[joint] else "groove"
            return f"its point is {mm(off)} off the {word}" if off > NEGLIGIBLE else ""
        case "distance" if least <= NEGLIGIBLE:
            return "its ends coincide, so it has no direction: use a pin"
        case "distance" if abs(distance - least) > NEGLIGIBLE:
            return f"its ends are {mm(distance)} apart, its length is {mm(least)}"
        case "range" if not least - NEGLIGIBLE <= distance <= most + NEGLIGIBLE:
            return f"its ends are {mm(distance)} apart, it allows {mm(least)} to {mm(most)}"
    return ""


def _advice(model: Model, joint: int, distance: float) -> str:
    """The right length of the joint, or to leave an anchor out."""
    keeps, most = model.joints.kind[joint].keeps, float(model.joints.reach[joint, 1])
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
    joints, springs = model.joints, model.springs
    askew = set()
    for i in joints.keeping("gear", "roll", "rack").tolist():
        if joints.kind[i].keeps != "rack":
            yield from _circles(model, i)
        elif slide := _slide(model, i):
            askew.add(i)
            yield _askew(model, i, *slide)
        else:
            yield from _rack(model, i)
    tied = {*springs.bodies[springs.straight].ravel().tolist(), *model.tendons.guide_body.tolist()}
    for i in sorted(parting_wheels(model, model.bodies.pose) - askew):
        path, name, bodies = f"$.joints[{i}]", joints.name[i], joints.bodies[i].tolist()
        whose = "its rack at the gear" if joints.kind[i].keeps == "rack" else "its wheels together"
        if not tied & set(bodies):
            one, other = (model.bodies.name[body] for body in bodies)
            yield look("bad-mesh", path, name, f"no joint holds {whose}: teeth push {one!r} and "
                       f"{other!r} apart", "give each a bearing: a pin on the ground or on a "
                       "carrier, of a rack a slot")
        elif not joints.play[i] > 0:
            yield look("bad-mesh", path, name, f"only springs or tendons hold {whose}: without "
                       "backlash the teeth get an impact when the other flank takes over",
                       "give it a 'backlash', for example 0.01 mm")


def _circles(model: Model, joint: int) -> Iterator[Problem]:
    """Gears or rolling circles at another distance; errors where no step can be made."""
    joints, path, name = model.joints, f"$.joints[{joint}]", model.joints.name[joint]
    (ra, rb), inside = joints.radii[joint].tolist(), bool(joints.inside[joint])
    distance, sum_, difference = math.dist(*model.ends(joint)), ra + rb, abs(ra - rb)
    right, fits = (difference, sum_) if inside else (sum_, difference)
    if abs(distance - right) <= NEGLIGIBLE:
        return
    other = distance - ra if not inside else ra - distance if ra > rb else ra + distance
    instead = f", or make 'radius_b' {fitting(other)}" if other > NEGLIGIBLE else ""
    if ra != rb and abs(distance - fits) <= NEGLIGIBLE:
        word = "leave 'inside' out" if inside else 'write "inside": true'
        instead += f", or {word}: then they fit as they are"
    advice = f"put them {fitting(right)} apart{instead}"
    apart = f"its centres are {mm(distance)} apart, its {{}} touch at {mm(right)}"
    if joints.kind[joint].keeps == "roll":
        report = error if distance < STRAIGHT else look
        yield report("not-assembled", path, name,
                     f"not assembled at t = 0: {apart.format('circles')}", advice)
        return
    apart, pressure = apart.format("pitch circles"), joints.pressure[joint]
    share = right * math.cos(pressure) / max(distance, STRAIGHT)
    if share >= 1:
        yield error("bad-mesh", path, name, f"its teeth overlap at t = 0: {apart}", advice)
    else:
        yield look("bad-mesh", path, name, f"does not mesh as it should at t = 0: {apart}; teeth "
                   f"would push at {deg(math.acos(share))} instead of {deg(pressure)}", advice)


def _rack(model: Model, joint: int) -> Iterator[Problem]:
    """A rack whose pitch line is not at the pitch circle."""
    right, off = float(model.joints.radii[joint, 0]), _from_pitch_line(model, joint)
    if abs(off - right) > NEGLIGIBLE:
        instead = f", or make 'radius' {fitting(off)}" if off > NEGLIGIBLE else ""
        yield look("bad-mesh", f"$.joints[{joint}]", model.joints.name[joint], "does not mesh at "
                   f"t = 0: its pitch line is {mm(off)} from the gear's centre, the pitch circle "
                   f"has a radius of {mm(right)}",
                   f"move the rack or its 'on_b' by {fitting(abs(off - right))}{instead}")


def _askew(model: Model, joint: int, slot: int, way: Vec) -> Problem:
    """A rack that slides in a slot along ``way``, in another direction than its pitch line."""
    (x, y), (gx, gy) = way, model.joints.along[joint].tolist()
    off = abs(abs(_from_pitch_line(model, joint, way)) - float(model.joints.radii[joint, 0]))
    move = f", and move the rack or its 'on_b' by {fitting(off)}" if off > NEGLIGIBLE else ""
    return look("bad-mesh", f"$.joints[{joint}].along", model.joints.name[joint], "its pitch line "
                f"is turned by {deg(math.acos(min(abs(gx * x + gy * y), 1.0)))} from the groove of "
                f"{model.joints.name[slot]!r}, in which its rack slides: its teeth leave the "
                "gear, or jam", f"make 'along' [{x + 0.0:.6g}, {y + 0.0:.6g}]{move}")


def _slide(model: Model, joint: int) -> tuple[int, Vec] | None:
    """A slot in which a rack slides in another direction than its pitch line, and the direction."""
    joints, free = model.joints, model.bodies.free
    gear, rack = joints.bodies[joint].tolist()
    pins = joints.bodies[joints.keeping("point")]
    holders = {gear, *pins[(pins == gear).any(axis=1)].ravel().tolist()} - {rack}
    for i in joints.keeping("groove").tolist():
        pair = joints.bodies[i].tolist()
        if joints.path[i] or joints.turns[i] or rack not in pair:
            continue
        other = pair[1 - pair.index(rack)]
        if other not in holders and (free[other] or free[sorted(holders)].all()):
            continue
        start, end = (model.at_start(pair[0], point) for point in joints.groove[i])
        turned = pose_of(model.mechanism.bodies[rack])[2]
        x, y = to_body((0.0, 0.0, turned), (end[0] - start[0], end[1] - start[1]))
        length, (gx, gy) = math.hypot(x, y), joints.along[joint].tolist()
        if length > STRAIGHT and abs(gx * y - gy * x) > ASKEW * length:
            return i, (x / length, y / length)
    return None


def _from_pitch_line(model: Model, joint: int, along: Vec | None = None) -> float:
    """Distance at t = 0 [m] of a gear's centre from the pitch line of its rack."""
    joints = model.joints
    x, y = to_body(pose_of(model.mechanism.bodies[joints.bodies[joint, 1]]), model.ends(joint)[0])
    bx, by = joints.anchor[joint, 1].tolist()
    gx, gy = joints.along[joint].tolist() if along is None else along
    return float(gx * (y - by) - gy * (x - bx))


MAX_PAIRS, MAX_BOXES = 20_000, 50_000_000
"""Maximum numbers of compared pairs of shapes, and of boxes."""
MAX_REPORTED = 100  # maximum number of reported overlaps; further ones are counted


def overlaps(model: Model, allowed: Flags) -> tuple[list[Problem], int]:
    """Overlaps of ``allowed`` pairs of bodies at t = 0; the number of pairs with common boxes."""
    holders, pieces, owner = placed_shapes(model.mechanism.bodies)
    if not pieces:
        return [], 0
    boxes = np.array([(box.left, box.bottom, box.right, box.top)
                      for box in (piece.bb for piece in pieces)])
    axis = int(np.ptp(boxes[:, 1] + boxes[:, 3]) > np.ptp(boxes[:, 0] + boxes[:, 2]))
    order = np.argsort(boxes[:, axis], kind="stable")
    low, high = boxes[order, :2], boxes[order, 2:]
    ends = np.searchsorted(low[:, axis], high[:, axis], side="right")
    looked, seen, whole, depths = 0, 0, True, dict[tuple[int, int], float]()
    for place, end in enumerate(ends.tolist()):
        i, later = int(order[place]), slice(place + 1, min(end, place + 1 + MAX_BOXES - seen))
        meets = ((low[later, 1 - axis] <= high[place, 1 - axis])
                 & (high[later, 1 - axis] >= low[place, 1 - axis])
                 & allowed[owner[i], owner[order[later]]])
        others = order[later][meets]
        whole = later.stop >= end and len(others) <= MAX_PAIRS - looked
        seen += max(end - place - 1, 0)
        for j in others[:MAX_PAIRS - looked].tolist():
            pair = (int(min(owner[i], owner[j])), int(max(owner[i], owner[j])))
            depths[pair] = max(_depth(pieces[i], pieces[j]), depths.get(pair, 0.0))
        looked = min(looked + len(others), MAX_PAIRS)
        if not whole:
            break
    del holders  # which keep the pieces alive
    names = model.bodies.name
    found = [(pair, depth) for pair, depth in sorted(depths.items()) if depth > NEGLIGIBLE]
    problems = [look("overlap", f"$.bodies[{a}]", names[a], f"overlaps {names[b]!r} by {mm(depth)} "
                     "at t = 0", "move one of them, or add a contact rule with \"collide\": false")
                for (a, b), depth in found[:MAX_REPORTED]]
    if not whole:
        problems.append(look("overlap", "$.bodies", "bodies", "further bodies may overlap at t = 0",
                             f"{looked} pairs of shapes were compared"))
    elif len(found) > MAX_REPORTED:
        problems.append(look("overlap", "$.bodies", "bodies",
                             f"{len(found) - MAX_REPORTED} more bodies overlap at t = 0"))
    return problems, len(depths)


def placed_shapes(
    bodies: Iterable[Body],
) -> tuple[list[pymunk.Body], list[pymunk.Shape], Integers]:
    """Objects that keep the shapes alive; the shapes at t = 0; the index of each one's body."""
    holders, pieces, owner = [], [], []
    for i, body in enumerate(bodies):
        holder = pymunk.Body(body_type=pymunk.Body.STATIC)
        holder.position, holder.angle = body.at, body.angle
        holders.append(holder)
        for shape in body.shapes:
            for piece, _ in solids(shape):
                pieces.append(make_shape(holder, piece, (0.0, 0.0)))
                pieces[-1].cache_bb()
                owner.append(i)
    return holders, pieces, np.array(owner, dtype=np.int64)


def _depth(one: pymunk.Shape, other: pymunk.Shape) -> float:
    """Depth of the overlap of two shapes [m]; 0 if there is none."""
    try:
        points = one.shapes_collide(other).points
    except AssertionError:  # pymunk raises it if there is no point
        return 0.0
    return max((abs(point.distance) for point in points), default=0.0)
