"""Checks of tendons, fluid lines, loads, masses, grasp measures, drives and events at t = 0."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from fnmatch import fnmatchcase

import numpy as np

from sandbox.elements.quantities import GRASP
from sandbox.elements.tendons import RIGID, Tendon
from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, deg, error, groups, look, mm
from sandbox.errors import Problem
from sandbox.model.catalogue import grasp_of
from sandbox.model.loads import motion_of
from sandbox.model.meters import names_read
from sandbox.model.model import NONE, Model
from sandbox.model.tendons import lifted_at_start, passes_by
from sandbox.numeric import Array, Flags
from sandbox.samples.cables import lengths_at_start, rest_lengths, wraps_at_start
from sandbox.samples.grasps import OF_HANDS, of_hand
from sandbox.scene.geometry import Vec, outline
from sandbox.values.signals import values
from sandbox.wording import listed, quoted

MOST_STRETCH = 0.1
"""Elongation of an inextensible tendon at t = 0 that is accepted, relative to its length."""


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
            yield from _stretched(tendon, path, lengths[i], rests[i])
            yield from _off_wheels(model, i, off, points)
        yield from _without_effect(tendon, path)
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
            continue
        if gap >= reach:
            continue
        if not small:
            message = (f"its guide {inner} is inside the wheel of its guide {outer}, {mm(gap)} "
                       f"from its centre and {mm(large - gap)} deep")
            advice = f"move guide {inner} out by this depth, or make the wheel smaller"
        elif not crossed:
            message = (f"the wheel of its guide {inner} is inside that of its guide {outer}: they "
                       f"are {mm(gap)} apart, a tangent needs {mm(reach)}")
            advice = (f"move one of them {mm(reach - gap)} further out, or make guide {outer} "
                      "smaller")
        else:
            message = (f"the wheels of its guides {k} and {after} are {mm(gap)} apart, a crossed "
                       f"tangent needs {mm(reach)}")
            advice = (f"put them {mm(reach - gap)} further apart, make one smaller, or give both "
                      "the same 'side'")
        yield error("bad-tendon-path", path, tendon.name, message, advice)


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


def _without_effect(tendon: Tendon, path: str) -> Iterator[Problem]:
    """Friction and turns without effect, loops that turn no wheel."""
    last, frictions = len(tendon.guides) - 1, [guide.friction for guide in tendon.guides]
    if tendon.closed and any(guide.radius for guide in tendon.guides) and not any(frictions):
        yield look("no-effect", f"{path}.guides", tendon.name,
                   "it turns no wheel: the loop slides over all its guides without friction",
                   "friction at the wheels that it should turn")
    for k, guide in enumerate(tendon.guides):
        tied, found = not tendon.closed and k in (0, last), list[tuple[str, str, str, str]]()
        friction, turns = f"friction of {guide.friction:g} has", f"{guide.turns} turns have"
        if guide.friction and tied:
            found.append(("friction", friction, "the tendon is fixed there",
                          "friction where it slides, at a guide between its ends"))
        elif guide.friction and tendon.closed and not tendon.gripping:
            found.append(("friction", friction, "no other guide holds the loop",
                          "friction at another guide, too"))
        if guide.begins and k not in tendon.lifting:
            found.append(("begins", f"{guide.begins!r} has", "the tendon can only leave a wheel "
                          "between its ends that has no friction and no turns",
                          f"no {guide.begins!r}"))
        if guide.turns and not guide.radius:
            found.append(("turns", turns, "it has no wheel", "a radius, or no turns"))
        elif guide.turns and tied:
            found.append(("turns", turns, "the tendon is fixed there", "no turns"))
        for field, what, why, advice in found:
            yield look("no-effect", f"{path}.guides[{k}].{field}", tendon.name,
                       f"its {what} no effect: {why}", advice)


def _off_wheels(model: Model, i: int, off: Flags, points: list[Vec]) -> Iterator[Problem]:
    """Wheels that a tendon passes without contact at t = 0, unless ``begins`` is ``"off"``."""
    tendon, first = model.mechanism.tendons[i], int(model.tendons.first[i])
    for k in tendon.lifting:
        begins, path = tendon.guides[k].begins, f"$.tendons[{i}].guides[{k}]"
        if off[first + k] == (begins == "off"):
            continue
        other = "right" if tendon.guides[k].side == "left" else "left"
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


def _stretched(tendon: Tendon, path: str, length: float, rest: float) -> Iterator[Problem]:
    """A tendon with too large an elongation at t = 0, from its rest length or pretension."""
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
                there = ", ".join(f"{name} = {float(motion[name][0]):.4g}"
                                  for name in sorted(part.names))
                yield error(
                    "undefined-law", f"{path}.{field}", load.name,
                    f"has no finite value on {body.name!r} at t = 0" + (there and f", {there}"),
                    "a division by zero, or out of range")


UNLIKE = 1e6  # mass ratio up to which the accuracy of the engine is tested
WRONG = 1e10  # mass ratio from which forces may be wrong
SLENDER = 10.0  # largest 1 + m r^2/I of ordinary bodies: a rod pushed at its end has 4


def mass_problems(model: Model, allowed: Flags) -> Iterator[Problem]:
    """Connected bodies with a mass ratio above :data:`UNLIKE`; ``allowed`` pairs may touch."""
    bodies, free = model.bodies, np.flatnonzero(model.bodies.free)
    reach = _reaches(model)
    share = np.ones(len(bodies.name))
    share[free] += reach[free] ** 2 * bodies.mass[free] / bodies.inertia[free]
    lightest = np.where(share > SLENDER, bodies.mass / share, bodies.mass)
    if not len(free) or bodies.mass[free].max() <= UNLIKE * lightest[free].min():
        return
    for group in groups(model, contacts=allowed):
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
    alone = sorted(body.name for i, body in enumerate(mechanism.bodies)
                   if grasp_of(body) and not (allowed[i] & hand).any())
    read = [(f"$.expect[{i}].{expect.key}", expect.quantity)
            for i, expect in enumerate(mechanism.expect)]
    read += [(f"$.meters[{i}].value", name) for i, meter in enumerate(mechanism.meters)
             for name in sorted(names_read(meter))]
    for path, name in read if alone else ():
        body, _, quantity = name.rpartition(".")
        if any(fnmatchcase(one, quantity) for one in GRASP):
            for each in itertools.islice((one for one in alone if fnmatchcase(one, body)), 1):
                yield look("no-effect", path, each, f"measures the grasp of {each}, but no part of "
                           "a hand can touch it", "a body that moves, or one with a role such as "
                           f"{listed(OF_HANDS[:2])}, and contact rules that let it")


def unmoved(model: Model) -> Iterator[Problem]:
    """Forces, torques and pulls on bodies that cannot move freely."""
    drives, tendons = model.drives, model.tendons
    for i in drives.giving("force", "torque", "tension").tolist():
        kind, target = drives.kind[i], int(drives.target[i])
        moved = (np.array([target]) if kind.gives == "force" else
                 model.joints.bodies[target] if kind.gives == "torque" else
                 tendons.guide_body[tendons.guides(target)])
        if not kind.limited and not model.bodies.free[moved].any():
            yield look("no-effect", f"$.drives[{i}]", drives.name[i],
                       f"acts on {model.bodies.name[moved[0]]!r}, which cannot move freely",
                       "it changes nothing")


INSTANTS = 257  # instants of a run at which the target of a drive is checked


def idle_problems(model: Model) -> Iterator[Problem]:
    """Drives and events without effect, or outside of limits."""
    bonds, drives, joints, events = model.bonds, model.drives, model.joints, model.mechanism.events
    loose = {bonds.name[bond] for bond in np.flatnonzero(
        ~bonds.held | np.isfinite(bonds.breaks_at) | (bonds.drive >= 0))}
    loose |= {name for event in events for name in event.release}
    for i, event in enumerate(events):
        for j, name in enumerate(event.take_up):
            if name not in loose:
                yield look("no-effect", f"$.events[{i}].take_up[{j}]", event.name,
                           f"takes up {name}, which no event releases",
                           "an event or drive that releases it, 'breaks_at' or 'released'")
    taken = {name for event in events
             for name in (*event.take_up, *(event.release if event.lasts is not None else ()))}
    for i, (kind, name) in enumerate(zip(drives.kind, drives.name, strict=True)):
        path, target = f"$.drives[{i}]", int(drives.target[i])
        bond = int(bonds.joint[target]) if kind.target.among == "joints" else NONE
        if not bonds.begins(bond) and bonds.drive[bond] < 0 and bonds.name[bond] not in taken:
            yield look("no-effect", path, name, f"acts on {bonds.name[bond]}, which is released "
                       "from the start and never taken up", "an event or a drive that takes it up")
        if kind.gives == "surface" and not model.mechanism.bodies[target].shapes:
            yield look("no-effect", f"{path}.body", name, f"{model.bodies.name[target]} has no "
                       "shapes, so it has no surface to drive", "a shape of that body")
        if not kind.places:
            continue
        set_to = values(model.mechanism.drives[i].signal(model.mechanism), np.linspace(
            0.0, model.mechanism.run.duration, INSTANTS), model.mechanism.functions)
        turns = bool(joints.angle[target])
        low, high = (joints.stops if turns else joints.reach)[target].tolist()
        for value, over, bound, end in ((set_to.max(), set_to.max() - high, high, "most"),
                                        (set_to.min(), low - set_to.min(), low, "least")):
            if not over > NEGLIGIBLE:
                continue
            if not turns:
                fault, advice = f"it is {mm(bound)} long at {end}", "a length within its stroke"
            else:
                fault, advice = f"its limits are [{deg(low)}, {deg(high)}]", "an angle within them"
                if abs(value) > math.tau:
                    advice += ("; a number by itself is in rad: for degrees write "
                               f"\"{value:.4g} deg\"")
            yield look("outside-limits", f"{path}.value", name, f"sets {joints.name[target]} to "
                       f"{deg(value) if turns else mm(value)}, but {fault}", advice)
