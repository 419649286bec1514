"""Checks of tendons, fluid lines, loads, masses, grasp measures, drives and events at t = 0."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from fnmatch import fnmatchcase

import numpy as np

from sandbox.elements.quantities import GRASP
from sandbox.elements.tendons import RIGID, Tendon
from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, groups, linked, look, mm
from sandbox.errors import Problem
from sandbox.model.catalogue import grasp_of
from sandbox.model.loads import motion_of
from sandbox.model.meters import names_read
from sandbox.model.model import NONE, Model
from sandbox.model.tendons import lifted_at_start, passes_by
from sandbox.numeric import Array, Flags
from sandbox.samples.cords import lengths_at_start, rest_lengths, wraps_at_start
from sandbox.samples.grasps import OF_HANDS, of_hand
from sandbox.scene.geometry import Vec, outline, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.values.signals import values
from sandbox.wording import is_pattern, listed, quoted

MOST_STRETCH = 0.1
"""Elongation of an inextensible tendon at t = 0 that is accepted, relative to its length."""


def tendon_problems(model: Model) -> Iterator[Problem]:
    """Errors in the paths of tendons, and tendons without effect."""
    bodies = model.mechanism.bodies
    lengths, rests = lengths_at_start(model).tolist(), rest_lengths(model).tolist()
    off = lifted_at_start(model)
    for i, tendon in enumerate(model.mechanism.tendons):
        path = f"$.tendons[{i}]"
        guided = model.tendons.guide_body[model.tendons.guides(i)]
        points = [to_world(pose_of(bodies[body]), guide.at)
                  for body, guide in zip(guided, tendon.path, strict=True)]
        astray = list(_without_way(tendon, path, points))
        yield from astray
        if not astray:  # otherwise it has no length
            yield from _stretched(model, i, lengths[i], rests[i])
            yield from _off_wheels(model, i, off, points)
        yield from _without_effect(model, i)
        if tendon.closed:
            yield from _loop_problems(model, i)
        if not model.bodies.free[guided].any():
            yield look("no-effect", path, tendon.name, "passes no body that can move freely",
                           "it has no effect")


def _without_way(tendon: Tendon, path: str, points: list[Vec]) -> Iterator[Problem]:
    """Guides without a straight line from one to the next."""
    for k, (p, q) in enumerate(itertools.pairwise(points)):
        if k and len(tendon.guides) == 2:
            break  # the second half of a loop
        after = (k + 1) % len(tendon.guides)
        (ra, rb), gap = (tendon.path[k].radius, tendon.path[k + 1].radius), math.dist(p, q)
        crossed = tendon.path[k].side != tendon.path[k + 1].side
        reach = ra + rb if crossed else abs(ra - rb)
        (small, inner), (large, outer) = sorted(((ra, k), (rb, after)))
        if gap < STRAIGHT:
            yield error("coincident-points", path, tendon.name, f"its guides {k} and {after} "
                        "coincide", "move one of them: the tendon between them has no direction")
        elif gap >= reach:
            continue
        elif not small:
            yield error("bad-tendon-path", path, tendon.name,
                        f"its guide {inner} is inside the wheel of its guide {outer}, {mm(gap)} "
                        f"from its centre and {mm(large - gap)} deep",
                        f"move guide {inner} out by this depth, or make the wheel smaller")
        elif not crossed:
            yield error("bad-tendon-path", path, tendon.name, f"the wheel of its guide {inner} "
                        f"is inside that of its guide {outer}: they are {mm(gap)} apart, a tangent "
                        f"needs {mm(reach)}", f"move one of them {mm(reach - gap)} "
                        f"further out, or make guide {outer} smaller")
        else:
            yield error("bad-tendon-path", path, tendon.name, f"the wheels of its guides {k} and "
                        f"{after} are {mm(gap)} apart, a crossed tangent needs {mm(reach)}",
                        f"put them {mm(reach - gap)} further apart, make one smaller, or give both "
                        "the same 'side'")


def _loop_problems(model: Model, i: int) -> Iterator[Problem]:
    """A loop with a pull drive, or one that crosses itself."""
    tendon, path = model.mechanism.tendons[i], f"$.tendons[{i}]"
    if (drive := int(model.tendons.drive[i])) != NONE:
        yield error("not-settable", f"$.drives[{drive}].tendon", model.drives.name[drive],
                    f"pulls {tendon.name}, which is closed and has no end",
                    "a torque or a motor at a wheel's hinge, or a tendon that is not closed")
    sides = {guide.side for guide in tendon.guides}
    if all(guide.radius for guide in tendon.guides) and len(sides) == 1:
        wraps = [wrap - math.tau * guide.turns
                 for wrap, guide in zip(wraps_at_start(model, i), tendon.guides, strict=True)]
        times = round(sum(wraps) / math.tau)
        if times > 1:
            other = "right" if sides == {"left"} else "left"
            yield look("bad-tendon-path", path, tendon.name,
                       f"crosses itself: this path winds {times} times around",
                       f"{other!r} as the side of its guides, or these in another order")


def _without_effect(model: Model, i: int) -> Iterator[Problem]:
    """Friction and turns without effect, loops that turn no wheel."""
    tendon = model.mechanism.tendons[i]
    wheels = [guide for guide in tendon.guides if guide.radius]
    if tendon.closed and wheels and not any(guide.friction for guide in tendon.guides):
        yield look("no-effect", f"$.tendons[{i}].guides", tendon.name,
                   "it turns no wheel: the loop slides over all its guides without friction",
                   "friction at the wheels that it should turn")
    for k, guide in enumerate(tendon.guides):
        path = f"$.tendons[{i}].guides[{k}]"
        tied = not tendon.closed and k in (0, len(tendon.guides) - 1)
        if guide.friction and tied:
            yield look("no-effect", f"{path}.friction", tendon.name, "its friction of "
                       f"{guide.friction:g} has no effect: the tendon is fixed there",
                       "friction where it slides, at a guide between its ends")
        elif guide.friction and tendon.closed and not tendon.gripping:
            yield look("no-effect", f"{path}.friction", tendon.name, "its friction of "
                       f"{guide.friction:g} has no effect: no other guide holds the loop",
                       "friction at another guide, too")
        if guide.begins and k not in tendon.lifting:
            yield look("no-effect", f"{path}.begins", tendon.name, f"its {guide.begins!r} has "
                       "no effect: the tendon can only leave a wheel between its ends that has no "
                       "friction and no turns", f"no {guide.begins!r}")
        if guide.turns and not guide.radius:
            yield look("no-effect", f"{path}.turns", tendon.name, f"its {guide.turns} turns have "
                       "no effect: it has no wheel", "a radius, or no turns")
        elif guide.turns and tied:
            yield look("no-effect", f"{path}.turns", tendon.name, f"its {guide.turns} turns have "
                       "no effect: the tendon is fixed there", "no turns")


def _off_wheels(model: Model, i: int, off: Flags, points: list[Vec]) -> Iterator[Problem]:
    """Wheels that a tendon passes without contact at t = 0, unless ``begins`` is ``"off"``."""
    tendon, begin = model.mechanism.tendons[i], int(model.tendons.first[i])
    for k in tendon.lifting:
        begins = tendon.guides[k].begins
        if off[begin + k] != (begins == "off"):
            other = "right" if tendon.guides[k].side == "left" else "left"
            before = max(j for j in range(k) if not off[begin + j])
            after = min(j for j in range(k + 1, len(points)) if not off[begin + j])
            three = [before, k, after]
            radii = model.tendons.guide_radius[begin + np.array(three)].tolist()
            far = passes_by([points[j] for j in three], radii)
            path = f"$.tendons[{i}].guides[{k}]"
            if begins == "off":
                yield error("bad-tendon-path", f"{path}.begins", tendon.name, "cannot begin off "
                            f"its wheel: the straight line passes {mm(-far)} inside the wheel",
                            f"the wheel this much further out, or the other side, {other!r}")
                continue
            yield look("bad-tendon-path", path, tendon.name, "begins off its wheel: it passes "
                       f"the wheel {mm(far)} away", "\"begins\": \"off\", if it is to meet "
                       f"the wheel later; side {other!r}, if the wheel is to bend it")


def _stretched(model: Model, i: int, length: float, rest: float) -> Iterator[Problem]:
    """A tendon with too large an elongation at t = 0, from its rest length or pretension."""
    tendon, path = model.mechanism.tendons[i], f"$.tendons[{i}]"
    if rest <= 0.0 and tendon.pretension is not None:
        yield error("tendon-length", path, tendon.name,
                    f"a pretension of {tendon.pretension:g} N is too large for a tendon of "
                    f"{tendon.stiffness:g} N/m on a path of {mm(length)}",
                    f"less than {tendon.stiffness * length:.3g} N, or a stiffer tendon")
    elif tendon.stiffness >= RIGID and length > (1 + MOST_STRETCH) * rest:
        yield look("tendon-length", path, tendon.name,
                   f"is shorter than its path, which is {mm(length)} long at t = 0: it begins with "
                   f"{tendon.stiffness * (length - rest):.3g} N",
                   f"a rest_length near {mm(length)}, or a pretension")


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
        if model.bodies.free[lines.bodies[chambers]].any():
            continue
        joined = bool((model.valves.lines == i).any())
        if not joined:
            yield look("no-effect", path, name, "moves no body that can move freely",
                       "it has no effect")
        if not joined and i in fed and not np.isfinite(lines.most[i]):
            yield look("bad-fluid", path, name, "has a pump but no relief and no outlet",
                       "its pressure grows without limit; give it a relief")


PLACES = ("[0]", "[1]", "")


def load_problems(model: Model) -> Iterator[Problem]:
    """Laws without a value at t = 0, which are errors; buoyancy without an area."""
    given, loads = model.mechanism.loads, model.loads
    for i in range(len(loads.name)):
        load, body = given[loads.load[i]], model.mechanism.bodies[loads.body[i]]
        path, law = f"$.loads[{loads.load[i]}]", loads.law[i]
        if law is None:
            if not len(loads.outline(i)) and body.name in load.bodies:
                yield look("no-effect", path, load.name, f"{body.name!r} has no area that a liquid "
                           "could lift", "give it a shape")
            continue
        motion = motion_of(model, i, *_start(model, int(loads.body[i])), np.zeros((3, 1)),
                           np.zeros(1))
        for k, value in enumerate(law.at(motion)[:, 0]):
            part = law.parts[k]
            if part is not None and not np.isfinite(value):
                field = ("torque" if k == 2 else
                         "acceleration" if loads.per_mass[i] else "force")
                there = ", ".join(f"{name} = {float(motion[name][0]):.4g}"
                                  for name in sorted(part.names))
                yield error(
                    "undefined-law", f"{path}.{field}{PLACES[k]}", load.name,
                    f"has no finite value on {body.name!r} at t = 0" + (there and f", {there}"),
                    "a division by zero, or out of range")


def _start(model: Model, i: int) -> tuple[Array, Array]:
    """Pose of a body's centre of mass, and its velocity, at t = 0, [3, 1]."""
    body, centre = model.mechanism.bodies[i], model.bodies.centre[i]
    x, y = to_world(pose_of(body), (float(centre[0]), float(centre[1])))
    return (np.array([[x], [y], [body.angle]]),
            np.array([[body.velocity[0]], [body.velocity[1]], [body.angular_velocity]]))


UNLIKE = 1e6
"""Mass ratio up to which the accuracy of the engine is tested."""
WRONG = 1e10
"""Mass ratio from which forces may be wrong."""
SLENDER = 10.0
"""Largest 1 + m r^2/I of ordinary bodies: a rod pushed at its end has 4."""


def mass_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Connected bodies with a mass ratio above :data:`UNLIKE`.

    ``allowed`` are the pairs that may touch, [nb, nb].
    """
    bodies, free = model.bodies, np.flatnonzero(model.bodies.free)
    reach = _reaches(model)
    share = np.ones(len(bodies.name))
    share[free] += reach[free] ** 2 * bodies.mass[free] / bodies.inertia[free]
    lightest = np.where(share > SLENDER, bodies.mass / share, bodies.mass)
    if not len(free) or bodies.mass[free].max() <= UNLIKE * lightest[free].min():
        return
    for group in groups(model, linked(model, contacts=allowed)):
        light = int(group[lightest[group].argmin()])
        others = group[group != light]
        if not len(others):
            continue
        heavy = int(others[bodies.mass[others].argmax()])
        ratio = float(bodies.mass[heavy] / lightest[light])
        if ratio > UNLIKE:
            turned = "" if share[light] <= SLENDER else (
                f", but with {bodies.inertia[light]:.4g} kg m^2 answers a push at "
                f"{mm(float(reach[light]))} from its centre as {lightest[light]:.2g} kg would,")
            yield look(
                "mass-ratio", f"$.bodies[{light}]", bodies.name[light],
                f"has {bodies.mass[light]:.4g} kg{turned} where {quoted(bodies.name[heavy])} has "
                f"{bodies.mass[heavy]:.4g} kg: connected masses differ by 1 : {ratio:.2g}; "
                f"rounding errors show beyond 1 : {UNLIKE:.0e}",
                f"forces are right to {1e-15 * ratio:.0e} of the largest" if ratio < WRONG else
                "forces may be wrong: make the two more alike")


def _reaches(model: Model) -> Array:
    """Largest distance of a point of attack from the centre of mass [m], [nb]."""
    bodies, joints, tendons = model.bodies, model.joints, model.tendons
    reach = np.zeros(len(bodies.name))
    for on, points in ((joints.bodies.ravel(), joints.anchor.reshape(-1, 2)),
                       (tendons.guide_body, tendons.guide_at)):
        off = points - bodies.centre[on]
        np.fmax.at(reach, on, np.hypot(off[:, 0], off[:, 1]))
    for body, spec in enumerate(model.mechanism.bodies):
        for shape in spec.shapes:
            off = np.array(outline(shape)) - bodies.centre[body]
            reach[body] = max(reach[body], float(np.hypot(off[:, 0], off[:, 1]).max()))
    return reach


def grasp_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Grasp measures of bodies that no hand can touch; ``allowed`` pairs may touch, [nb, nb]."""
    mechanism = model.mechanism
    hand = np.array([bool(of_hand(body) and body.shapes) for body in mechanism.bodies], dtype=bool)
    alone = {body.name for i, body in enumerate(mechanism.bodies)
             if grasp_of(body) and not (allowed[i] & hand).any()}
    for path, name in _quantities_read(mechanism) if alone else ():
        body, _, quantity = name.rpartition(".")
        for each in sorted(alone) if is_pattern(body) else [body] if body in alone else []:
            if fnmatchcase(each, body) and any(fnmatchcase(one, quantity) for one in GRASP):
                yield look("no-effect", path, each, f"measures the grasp of {each}, but no part of "
                           "a hand can touch it", "a body that moves, or one with a role such as "
                           f"{listed(OF_HANDS[:2])}, and contact rules that let it")
                break


def _quantities_read(mechanism: Mechanism) -> Iterator[tuple[str, str]]:
    """Names and patterns that expectations and meters read, with their paths."""
    for i, expect in enumerate(mechanism.expect):
        yield f"$.expect[{i}].{expect.key}", expect.quantity
    for i, meter in enumerate(mechanism.meters):
        for name in sorted(names_read(meter)):
            yield f"$.meters[{i}].value", name


INSTANTS = 257
"""Instants of a run at which the target of a drive is checked."""


def idle_problems(model: Model) -> Iterator[Problem]:
    """Drives and events without effect, or outside of limits."""
    yield from _taken_up(model)
    yield from _released(model)
    for i, kind in enumerate(model.drives.kind):
        target = int(model.drives.target[i])
        if kind.gives == "surface" and not model.mechanism.bodies[target].shapes:
            yield look("no-effect", f"$.drives[{i}].body", model.drives.name[i],
                       f"{model.bodies.name[target]} has no shapes, so it has no surface to drive",
                       "a shape of that body")
        if kind.gives == "push" and kind.places:
            yield from _stroke(model, i)
        if kind.gives == "torque" and kind.places:
            yield from _turn(model, i)


def _taken_up(model: Model) -> Iterator[Problem]:
    """Events that take up an element that is never released."""
    ties, events = model.ties, model.mechanism.events
    loose = {ties.name[tie] for tie in np.flatnonzero(
        ~ties.held | np.isfinite(ties.breaks_at) | (ties.drive >= 0))}
    loose |= {name for event in events for name in event.release}
    for i, event in enumerate(events):
        for j, name in enumerate(event.take_up):
            if name not in loose:
                yield look("no-effect", f"$.events[{i}].take_up[{j}]", event.name,
                           f"takes up {name}, which no event releases",
                           "an event or drive that releases it, 'breaks_at' or 'released'")


def _released(model: Model) -> Iterator[Problem]:
    """Drives of joints that are released all the time."""
    ties, drives = model.ties, model.drives
    taken = {name for event in model.mechanism.events
             for name in (*event.take_up, *(event.release if event.lasts is not None else ()))}
    for i, kind in enumerate(drives.kind):
        if kind.target.among != "joints":
            continue
        tie = int(ties.joint[drives.target[i]])
        if not ties.begins(tie) and ties.drive[tie] < 0 and ties.name[tie] not in taken:
            yield look("no-effect", f"$.drives[{i}]", drives.name[i],
                       f"acts on {ties.name[tie]}, which is released from the start and never "
                       "taken up", "an event or a drive that takes it up")


def _stroke(model: Model, i: int) -> Iterator[Problem]:
    """A target length outside of the stroke."""
    joint, target = int(model.drives.target[i]), _requested(model, i)
    name, (shortest, longest) = model.joints.name[joint], model.joints.reach[joint].tolist()
    for length, bound, beyond, end in ((target.max(), longest, 1.0, "most"),
                                       (target.min(), shortest, -1.0, "least")):
        if beyond * (length - bound) > NEGLIGIBLE:
            yield look("outside-limits", f"$.drives[{i}].value", model.drives.name[i],
                       f"sets {name} to {mm(length)}, but it is {mm(bound)} long at {end}",
                       "a length within its stroke")


def _turn(model: Model, i: int) -> Iterator[Problem]:
    """A target angle outside of the limits of its hinge."""
    joint, target = int(model.drives.target[i]), _requested(model, i)
    low, high = model.joints.stops[joint].tolist()
    for angle, over in ((target.max(), target.max() - high), (target.min(), low - target.min())):
        if over > NEGLIGIBLE:
            unit = (f"; a number by itself is in rad: for degrees write \"{angle:.4g} deg\""
                    if abs(angle) > math.tau else "")
            yield look("outside-limits", f"$.drives[{i}].value", model.drives.name[i],
                       f"sets {model.joints.name[joint]} to {deg(angle)}, but its limits are "
                       f"[{deg(low)}, {deg(high)}]", f"an angle within them{unit}")


def _requested(model: Model, i: int) -> Array:
    """Values of a drive at some instants of the run, in the unit of its value."""
    mechanism = model.mechanism
    return values(mechanism.drives[i].signal(mechanism),
                  np.linspace(0.0, mechanism.run.duration, INSTANTS), mechanism.functions)
