"""Checks of joints, overlaps, tendons, fluid lines, loads and masses at t = 0.

Involute teeth mesh at other distances of the centres, too, with the pressure angle a' given by
cos a' = (r_a + r_b) cos a / distance. Beyond cos a' = 1 the base circles have no common tangent,
and no step can be made.

At most :data:`MAX_PAIRS` pairs of shapes are compared; the report says if there are more.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from fnmatch import fnmatchcase

import numpy as np
import pymunk

from sandbox.elements.quantities import GRASP
from sandbox.elements.tendons import RIGID, Tendon
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.catalogue import grasp_of
from sandbox.model.joints import place_in_slot, slot_length
from sandbox.model.loads import motion_of
from sandbox.model.model import NONE, Model
from sandbox.model.supports import parting_wheels, shared_joints
from sandbox.numeric import Flags, Integers, connected_components
from sandbox.samples.cables import (
    lengths_at_start,
    lifted_at_start,
    passes_by,
    rest_lengths,
    wraps_at_start,
)
from sandbox.samples.grasps import OF_HANDS, of_hand
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import Vec, outline, pose_of, solids, to_body
from sandbox.values.expressions import names_in
from sandbox.wording import listed, quoted

NEGLIGIBLE = 1e-5  # accepted gaps and overlaps [m]: scenes may be written in hundredths of a mm
STRAIGHT = 1e-9  # two points nearer than this coincide [m]


def error(code: str, path: str, element: str, message: str, advice: str) -> Problem:
    """An error: the scene cannot be simulated."""
    return Problem(code, message, path, element=element, advice=advice)


def look(code: str, path: str, element: str, message: str, advice: str = "") -> Problem:
    """A warning: the scene can be simulated, but probably not as intended."""
    return Problem(code, message, path, element=element, advice=advice, severity="warning")


def mm(length: float) -> str:
    """A length [m] in millimetres."""
    return f"{length * 1e3:.4g} mm"


def fitting(length: float) -> str:
    """A length [m] in millimetres with enough digits to be copied into a scene."""
    return f"{length * 1e3:.8g} mm"


def deg(angle: float) -> str:
    """An angle [rad] in degrees."""
    return f"{math.degrees(angle):.4g} deg"


def groups(model: Model, *, springs: bool = False, contacts: Flags | None = None) -> list[Integers]:
    """Groups of free bodies that joints, tendons, and optionally springs and contacts connect."""
    tendons, free = model.tendons, np.flatnonzero(model.bodies.free)
    found = np.zeros((len(model.bodies.name),) * 2, dtype=bool)
    for pairs in (model.joints.bodies, *([model.springs.bodies] if springs else [])):
        found[pairs[:, 0], pairs[:, 1]] = found[pairs[:, 1], pairs[:, 0]] = True
    for tendon in range(len(tendons.name)):
        guides = tendons.guide_body[tendons.guides(tendon)]
        found[np.ix_(guides, guides)] = True
    if contacts is not None:
        shaped = np.array([bool(body.shapes) for body in model.mechanism.bodies])
        found |= contacts & shaped & shaped[:, None]
    return [free[group] for group in connected_components(found[np.ix_(free, free)])]


def joint_problems(model: Model) -> Iterator[Problem]:
    """Joints that contradict the poses at t = 0; those without a direction are errors."""
    joints = model.joints
    for i, name in enumerate(joints.name):
        distance, keeps = math.dist(*model.ends(i)), joints.kind[i].keeps
        directionless = (keeps == "distance" and distance < STRAIGHT) or (
            keeps == "groove" and slot_length(model, i) < STRAIGHT)
        if not (directionless or model.bonds.begins(int(model.bonds.joint[i]))):
            continue
        message, advice = _apart(model, i, distance)
        if message:
            report = error if directionless else look
            yield report("not-assembled", f"$.joints[{i}]", name, "not assembled at t = 0: "
                         f"{message}", f"move a body or an anchor, or {advice}")
        low, high = joints.stops[i].tolist()
        if joints.start[i] < low - 1e-9 or joints.start[i] > high + 1e-9:
            yield look("outside-limits", f"$.joints[{i}]", name, f"starts at "
                       f"{deg(joints.start[i])}, outside its limits [{deg(low)}, {deg(high)}]",
                       "turn a body, or set 'zero'")


def shared_problems(model: Model) -> Iterator[Problem]:
    """Redundant joints, whose shares of the load statics does not determine."""
    shared = sorted(shared_joints(model, model.bodies.pose).joints)
    if shared and all(model.bonds.begins(int(model.bonds.joint[j])) for j in shared):
        names = listed([model.joints.name[j] for j in shared])
        yield look("overconstrained", "$.joints", "", f"{names} are overconstrained: statics does "
                   "not determine each reaction; the smallest that balance are recorded",
                   "remove one, or give it a degree of freedom, to determine them")
    for j in shared:
        if model.joints.coefficient[j] > 0:
            yield look("overconstrained", f"$.joints[{j}].friction_coefficient",
                       model.joints.name[j], "its friction depends on a reaction that statics does "
                       "not determine", "give 'friction' as a number, or remove redundant joints")


def _apart(model: Model, joint: int, distance: float) -> tuple[str, str]:
    """The error of a joint's anchors at t = 0, and how to change the joint; empty without one."""
    (shortest, longest), keeps = model.joints.reach[joint].tolist(), model.joints.kind[joint].keeps
    if keeps == "groove":
        length, word = slot_length(model, joint), "path" if model.joints.path[joint] else "groove"
        advice = f"move the {word} to the point"
        if length < STRAIGHT:
            return "the ends of its groove coincide, so it has no direction", advice
        place = place_in_slot(model, joint, model.bodies.pose)
        beyond = max(-float(place.along), float(place.along) - length, 0.0)
        off = math.hypot(float(place.across), beyond)
        return (f"its point is {mm(off)} off the {word}" if off > NEGLIGIBLE else ""), advice
    field = "length" if keeps == "distance" else "longest" if distance > longest else "shortest"
    advice = ("leave one anchor out" if keeps not in ("distance", "range") or distance < STRAIGHT
              else f"make {field!r} {fitting(distance)}")
    match keeps:
        case "point" if distance > NEGLIGIBLE:
            return f"its anchors are {mm(distance)} apart", advice
        case "distance" if shortest <= NEGLIGIBLE:
            return "its ends coincide, so it has no direction: use a pin", advice
        case "distance" if abs(distance - shortest) > NEGLIGIBLE:
            return f"its ends are {mm(distance)} apart, its length is {mm(shortest)}", advice
        case "range" if not shortest - NEGLIGIBLE <= distance <= longest + NEGLIGIBLE:
            return (f"its ends are {mm(distance)} apart, it allows {mm(shortest)} to {mm(longest)}",
                    advice)
    return "", advice


def wheel_problems(model: Model) -> Iterator[Problem]:
    """Gears, racks and rolling circles that do not meet, or whose centres are not held."""
    joints, springs = model.joints, model.springs
    for i in joints.keeping("gear", "roll", "rack").tolist():
        yield from (_rack if joints.kind[i].keeps == "rack" else _circles)(model, i)
    bound = {*springs.bodies[springs.straight].ravel().tolist(), *model.tendons.guide_body.tolist()}
    for i in sorted(parting_wheels(model, model.bodies.pose)):
        path, name, bodies = f"$.joints[{i}]", joints.name[i], joints.bodies[i].tolist()
        whose = "its rack at the gear" if joints.kind[i].keeps == "rack" else "its wheels together"
        if not bound & set(bodies):
            one, other = (model.bodies.name[body] for body in bodies)
            yield look("bad-mesh", path, name, f"no joint holds {whose}: teeth push {one!r} and "
                       f"{other!r} apart", "give each a bearing: a pin on the ground or on a "
                       "carrier, of a rack a slot along its pitch line, 'along'")
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
    joints, pitch = model.joints, float(model.joints.radii[joint, 0])
    rack = model.mechanism.bodies[joints.bodies[joint, 1]]
    x, y = to_body(pose_of(rack), model.ends(joint)[0])
    (bx, by), (gx, gy) = joints.anchor[joint, 1].tolist(), joints.along[joint].tolist()
    off = float(gx * (y - by) - gy * (x - bx))  # of the gear's centre from the pitch line
    if abs(off - pitch) > NEGLIGIBLE:
        instead = f", or make 'radius' {fitting(off)}" if off > NEGLIGIBLE else ""
        yield look("bad-mesh", f"$.joints[{joint}]", joints.name[joint], "does not mesh at t = 0: "
                   f"its pitch line is {mm(off)} from the gear's centre, the pitch circle has a "
                   f"radius of {mm(pitch)}",
                   f"move the rack or its 'on_b' by {fitting(abs(off - pitch))}{instead}")


MAX_PAIRS = 20_000  # of compared shapes
MAX_REPORTED = 100  # maximum number of reported overlaps; further ones are counted


def overlaps(model: Model, allowed: Flags) -> tuple[list[Problem], int]:
    """Overlaps of ``allowed`` pairs of bodies at t = 0; the number of pairs with common boxes."""
    space, owner = placed_shapes(model.mechanism.bodies)
    number = {piece: k for k, piece in enumerate(owner)}
    compared, depths = 0, dict[tuple[int, int], float]()
    for piece, i in owner.items():
        others = [other for other in space.bb_query(piece.bb, pymunk.ShapeFilter())
                  if number[other] > number[piece] and allowed[i, owner[other]]]
        for other in others[:MAX_PAIRS - compared]:
            depth = 0.0
            with suppress(AssertionError):  # pymunk raises it if there is no point
                points = piece.shapes_collide(other).points
                depth = max((abs(point.distance) for point in points), default=0.0)
            depths[i, owner[other]] = max(depth, depths.get((i, owner[other]), 0.0))
        compared += len(others)
        if compared > MAX_PAIRS:
            break
    names = model.bodies.name
    found = [(pair, depth) for pair, depth in sorted(depths.items()) if depth > NEGLIGIBLE]
    problems = [look("overlap", f"$.bodies[{a}]", names[a], f"overlaps {names[b]!r} by {mm(depth)} "
                     "at t = 0", "move one of them, or add a contact rule with \"collide\": false")
                for (a, b), depth in found[:MAX_REPORTED]]
    if compared > MAX_PAIRS:
        problems.append(look("overlap", "$.bodies", "bodies", "further bodies may overlap at t = 0",
                             f"{MAX_PAIRS} pairs of shapes were compared"))
    elif len(found) > MAX_REPORTED:
        problems.append(look("overlap", "$.bodies", "bodies",
                             f"{len(found) - MAX_REPORTED} more bodies overlap at t = 0"))
    return problems, len(depths)


def placed_shapes(bodies: Iterable[Body]) -> tuple[pymunk.Space, dict[pymunk.Shape, int]]:
    """A space with the shapes at t = 0, which it keeps alive; the index of the body of each."""
    space, owner = pymunk.Space(), dict[pymunk.Shape, int]()
    for i, body in enumerate(bodies):
        holder = pymunk.Body(body_type=pymunk.Body.STATIC)
        holder.position, holder.angle = body.at, body.angle
        pieces = [make_shape(holder, piece, (0.0, 0.0))
                  for shape in body.shapes for piece, _ in solids(shape)]
        owner |= dict.fromkeys(pieces, i)
        space.add(holder, *pieces)
    return space, owner


OPPOSITE = {"left": "right", "right": "left"}
MAX_STRETCH = 0.1  # accepted elongation of an inextensible tendon at t = 0, relative


def tendon_problems(model: Model) -> Iterator[Problem]:
    """Errors in the paths of tendons, and tendons without effect."""
    lengths, rests = lengths_at_start(model).tolist(), rest_lengths(model).tolist()
    off = lifted_at_start(model)
    for i, tendon in enumerate(model.mechanism.tendons):
        path = f"$.tendons[{i}]"
        guided = model.tendons.guide_body[model.tendons.guides(i)]
        points = [model.at_start(body, guide.at)
                  for body, guide in zip(guided, tendon.path, strict=True)]
        astray = list(_without_way(tendon, path, points))
        yield from astray
        if not astray:  # otherwise it has no length
            if rests[i] <= 0.0 and tendon.pretension is not None:
                yield error("tendon-length", path, tendon.name,
                            f"a pretension of {tendon.pretension:g} N is too large for a tendon of "
                            f"{tendon.stiffness:g} N/m on a path of {mm(lengths[i])}",
                            f"less than {tendon.stiffness * lengths[i]:.3g} N, or a stiffer tendon")
            elif tendon.stiffness >= RIGID and lengths[i] > (1 + MAX_STRETCH) * rests[i]:
                yield look("tendon-length", path, tendon.name, "is shorter than its path, which is "
                           f"{mm(lengths[i])} long at t = 0: it begins with "
                           f"{tendon.stiffness * (lengths[i] - rests[i]):.3g} N",
                           f"a rest_length near {mm(lengths[i])}, or a pretension")
            yield from _off_wheels(model, i, off, points)
        yield from _without_effect(tendon, path)
        if tendon.closed:
            yield from _loop_problems(model, i)
        if not model.bodies.free[guided].any():
            yield look("no-effect", path, tendon.name, "passes no body that can move freely")


def _without_way(tendon: Tendon, path: str, points: list[Vec]) -> Iterator[Problem]:
    """Guides without a straight line from one to the next."""
    for k, (p, q) in enumerate(itertools.pairwise(points)):
        if k and len(tendon.guides) == 2:
            break  # the second half of a loop
        after, gap = (k + 1) % len(tendon.guides), math.dist(p, q)
        radii = tendon.path[k].radius, tendon.path[k + 1].radius
        crossed = tendon.path[k].side != tendon.path[k + 1].side
        reach = sum(radii) if crossed else max(radii) - min(radii)
        if gap < STRAIGHT:
            yield error("coincident-points", path, tendon.name, f"its guides {k} and {after} "
                        "coincide", "move one of them: the tendon between them has no direction")
        elif gap < reach:
            inside = "" if min(radii) and crossed else ", as one is inside the wheel of the other"
            yield error("bad-tendon-path", path, tendon.name, f"its guides {k} and {after} are "
                        f"{mm(gap)} apart, a {'crossed ' if crossed and min(radii) else ''}tangent "
                        f"needs {mm(reach)}{inside}", f"put them {mm(reach - gap)} further apart, "
                        "or make a wheel smaller"
                        + (", or give both the same 'side'" if crossed and min(radii) else ""))


def _loop_problems(model: Model, i: int) -> Iterator[Problem]:
    tendon, path = model.mechanism.tendons[i], f"$.tendons[{i}]"
    if (drive := int(model.tendons.drive[i])) != NONE:
        yield error("not-settable", f"$.drives[{drive}].tendon", model.drives.name[drive],
                    f"pulls {tendon.name}, which is closed and has no end",
                    "a torque or a motor at a wheel's hinge, or a tendon that is not closed")
    side, *others = {guide.side for guide in tendon.guides}
    if all(guide.radius for guide in tendon.guides) and not others:
        turns = sum(guide.turns for guide in tendon.guides)
        times = round(sum(wraps_at_start(model, i)) / math.tau - turns)
        if times > 1:
            yield look("bad-tendon-path", path, tendon.name,
                       f"crosses itself: this path winds {times} times around",
                       f"{OPPOSITE[side]!r} as the side of its guides, or these in another order")


def _without_effect(tendon: Tendon, path: str) -> Iterator[Problem]:
    last, frictions = len(tendon.guides) - 1, [guide.friction for guide in tendon.guides]
    if tendon.closed and any(guide.radius for guide in tendon.guides) and not any(frictions):
        yield look("no-effect", f"{path}.guides", tendon.name,
                   "it turns no wheel: the loop slides over all its guides without friction",
                   "friction at the wheels that it should turn")
    for k, guide in enumerate(tendon.guides):
        tied, fixed = not tendon.closed and k in (0, last), "the tendon is fixed there"
        friction, turns = f"friction of {guide.friction:g} has", f"{guide.turns} turns have"
        for useless, field, what, why, advice in (
            (guide.friction and tied, "friction", friction, fixed,
             "friction where it slides, at a guide between its ends"),
            (guide.friction and tendon.closed and not tendon.gripping, "friction", friction,
             "no other guide holds the loop", "friction at another guide, too"),
            (guide.begins and k not in tendon.lifting, "begins", f"{guide.begins!r} has",
             "the tendon can only leave a wheel between its ends that has no friction and no turns",
             f"no {guide.begins!r}"),
            (guide.turns and not guide.radius, "turns", turns, "it has no wheel",
             "a radius, or no turns"),
            (guide.turns and guide.radius and tied, "turns", turns, fixed, "no turns")):
            if useless:
                yield look("no-effect", f"{path}.guides[{k}].{field}", tendon.name,
                           f"its {what} no effect: {why}", advice)


def _off_wheels(model: Model, i: int, off: Flags, points: list[Vec]) -> Iterator[Problem]:
    """Wheels that a tendon passes without contact at t = 0, unless ``begins`` is ``"off"``."""
    tendon, first = model.mechanism.tendons[i], int(model.tendons.first[i])
    for k in tendon.lifting:
        begins, path = tendon.guides[k].begins, f"$.tendons[{i}].guides[{k}]"
        if off[first + k] == (begins == "off"):
            continue
        other = OPPOSITE[tendon.guides[k].side]
        three = [max(j for j in range(k) if not off[first + j]), k,
                 min(j for j in range(k + 1, len(points)) if not off[first + j])]
        far = passes_by([points[j] for j in three],
                        model.tendons.guide_radius[first + np.array(three)].tolist())
        if begins == "off":
            yield error("bad-tendon-path", f"{path}.begins", tendon.name, "cannot begin off "
                        f"its wheel: the straight line passes {mm(-far)} inside the wheel",
                        f"the wheel this much further out, or the other side, {other!r}")
        else:
            yield look("bad-tendon-path", path, tendon.name, "begins off its wheel: it passes "
                       f"the wheel {mm(far)} away", "\"begins\": \"off\", if it is to meet "
                       f"the wheel later; side {other!r}, if the wheel is to bend it")


def line_problems(model: Model) -> Iterator[Problem]:
    """Cylinders without a direction, which are errors; lines without effect."""
    lines, drives = model.lines, model.drives
    fed = {int(drives.target[i]) for i in drives.giving("flow", "pressure")}
    for i, name in enumerate(lines.name):
        path, chambers = f"$.lines[{i}]", lines.chambers(i)
        for k, n in enumerate(range(chambers.start, chambers.stop)):
            if lines.joint[n] == NONE and lines.start[n] < STRAIGHT:
                yield error("coincident-points", f"{path}.chambers[{k}]", name,
                            f"the two points of its cylinder {k} coincide",
                            "move one of them: the force between has no direction")
        if model.bodies.free[lines.bodies[chambers]].any() or (model.valves.lines == i).any():
            continue
        yield look("no-effect", path, name, "moves no body that can move freely")
        if i in fed and not np.isfinite(lines.most[i]):
            yield look("bad-fluid", path, name, "has a pump but no relief and no outlet",
                       "its pressure grows without limit; give it a relief")


def load_problems(model: Model) -> Iterator[Problem]:
    """Laws without a value at t = 0, which are errors; buoyancy without an area."""
    loads = model.loads
    for i, law in enumerate(loads.law):
        n = int(loads.body[i])
        load, body = model.mechanism.loads[loads.load[i]], model.mechanism.bodies[n]
        path = f"$.loads[{loads.load[i]}]"
        if law is None:
            if not len(loads.outline(i)) and body.name in load.bodies:
                yield look("no-effect", path, load.name, f"{body.name!r} has no area that a liquid "
                           "could lift", "give it a shape")
            continue
        motion = motion_of(
            model, i, np.array([[*model.at_start(n, model.bodies.centre[n]), body.angle]]).T,
            np.array([[*body.velocity, body.angular_velocity]]).T, np.zeros((3, 1)), np.zeros(1))
        force = "acceleration" if loads.per_mass[i] else "force"
        for part, value, field in zip(law.parts, law.at(motion)[:, 0], (
                f"{force}[0]", f"{force}[1]", "torque"), strict=True):
            if part is not None and not np.isfinite(value):
                there = "".join(f", {name} = {float(motion[name][0]):.4g}"
                                for name in sorted(part.names))
                yield error("undefined-law", f"{path}.{field}", load.name, "has no finite value on "
                            f"{body.name!r} at t = 0{there}", "a division by zero, or out of range")


UNLIKE = 1e6  # mass ratio up to which the accuracy of the engine is tested
UNRELIABLE = 1e10  # mass ratio from which forces may be wrong
SLENDER = 10.0  # largest 1 + m r^2/I of ordinary bodies: a rod pushed at its end has 4


def mass_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Connected bodies with a mass ratio above :data:`UNLIKE`; ``allowed`` pairs may touch."""
    bodies, free = model.bodies, np.flatnonzero(model.bodies.free)
    reach = np.zeros(len(bodies.name))  # largest distance of a point of attack from the centre
    shaped = [(i, point) for i, body in enumerate(model.mechanism.bodies)
              for shape in body.shapes for point in outline(shape)]
    for on, points in ((model.joints.bodies, model.joints.anchor),
                       (model.tendons.guide_body, model.tendons.guide_at),
                       ([i for i, _ in shaped], np.array([p for _, p in shaped]).reshape(-1, 2))):
        which = np.asarray(on, dtype=np.int64)
        np.fmax.at(reach, which, np.linalg.norm(points - bodies.centre[which], axis=-1))
    share = np.ones(len(bodies.name))
    share[free] += reach[free] ** 2 * bodies.mass[free] / bodies.inertia[free]
    lightest = np.where(share > SLENDER, bodies.mass / share, bodies.mass)
    if not len(free) or bodies.mass[free].max() <= UNLIKE * lightest[free].min():
        return
    for group in groups(model, contacts=allowed):
        light = int(group[lightest[group].argmin()])
        heavy = int(group[np.where(group == light, 0.0, bodies.mass[group]).argmax()])
        ratio = float(bodies.mass[heavy] / lightest[light])
        if heavy != light and ratio > UNLIKE:
            turned = "" if share[light] <= SLENDER else (
                f", but with {bodies.inertia[light]:.4g} kg m^2 answers a push at "
                f"{mm(float(reach[light]))} from its centre as {lightest[light]:.2g} kg would,")
            yield look(
                "mass-ratio", f"$.bodies[{light}]", bodies.name[light],
                f"has {bodies.mass[light]:.4g} kg{turned} where {quoted(bodies.name[heavy])} has "
                f"{bodies.mass[heavy]:.4g} kg: connected masses differ by 1 : {ratio:.2g}; "
                f"rounding errors show beyond 1 : {UNLIKE:.0e}",
                f"forces are right to {1e-15 * ratio:.0e} of the largest" if ratio < UNRELIABLE else
                "forces may be wrong: make the two more alike")


def grasp_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Grasp measures of bodies that no hand can touch; ``allowed`` pairs may touch, [nb, nb]."""
    mechanism = model.mechanism
    hand = np.array([bool(of_hand(body) and body.shapes) for body in mechanism.bodies], dtype=bool)
    alone = sorted(body.name for i, body in enumerate(mechanism.bodies)
                   if grasp_of(body) and not (allowed[i] & hand).any())
    read = [*((f"$.expect[{i}].{expect.key}", expect.quantity)
              for i, expect in enumerate(mechanism.expect)),
            *((f"$.meters[{i}].value", name) for i, meter in enumerate(mechanism.meters)
              for name in sorted(names_in(meter.value)))]
    for path, name in read if alone else ():
        body, _, quantity = name.rpartition(".")
        each = next((one for one in alone if fnmatchcase(one, body)), "")
        if each and any(fnmatchcase(one, quantity) for one in GRASP):
            yield look("no-effect", path, each, f"measures the grasp of {each}, but no part of a "
                       "hand can touch it", "a body that moves, or one with a role such as "
                       f"{listed(OF_HANDS[:2])}, and contact rules that let it")
