"""Looks cords over: whether each has a direction, is long enough, and pulls something."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

from sandbox.elements.tendons import RIGID, Tendon
from sandbox.engine.inspect_words import STRAIGHT, error, look, mm
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.model.tendons import lifted_at_start, passes_by
from sandbox.numeric import Flags
from sandbox.samples.cords import lengths_at_start, rest_lengths, wraps_at_start
from sandbox.scene.geometry import Vec, pose_of, to_world

MOST_STRETCH = 0.1
"""Share of its length by which a cord as good as rigid may be stretched at t = 0 without a word."""


def tendon_problems(model: Model) -> Iterator[Problem]:
    """Cords without a direction, which are errors, and those that pull on nothing."""
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
                           "it pulls on nothing")


def _without_way(tendon: Tendon, path: str, points: list[Vec]) -> Iterator[Problem]:
    """Guides with no straight way from the one to the next."""
    for k, (p, q) in enumerate(itertools.pairwise(points)):
        if k and len(tendon.guides) == 2:
            break  # a loop's way back
        after = (k + 1) % len(tendon.guides)
        (ra, rb), gap = (tendon.path[k].radius, tendon.path[k + 1].radius), math.dist(p, q)
        crossed = tendon.path[k].side != tendon.path[k + 1].side
        reach = ra + rb if crossed else abs(ra - rb)
        (small, inner), (large, outer) = sorted(((ra, k), (rb, after)))
        if gap < STRAIGHT:
            yield error("coincident-points", path, tendon.name, f"its guides {k} and {after} "
                        "coincide", "move one of them: the cord between has no direction")
        elif gap >= reach:
            continue
        elif not small:
            yield error("bad-tendon-path", path, tendon.name,
                        f"its guide {inner} lies in the wheel of its guide {outer}, {mm(gap)} from "
                        f"its centre and {mm(large - gap)} deep",
                        f"move guide {inner} so much further out, or make the wheel smaller")
        elif not crossed:
            yield error("bad-tendon-path", path, tendon.name, f"the wheel of its guide {inner} "
                        f"lies in that of its guide {outer}: they are {mm(gap)} apart, the cord "
                        f"between them needs {mm(reach)}", f"move one of them {mm(reach - gap)} "
                        f"further out, or make guide {outer} smaller")
        else:
            yield error("bad-tendon-path", path, tendon.name, f"the wheels of its guides {k} and "
                        f"{after} are {mm(gap)} apart, the cord that crosses between them needs "
                        f"{mm(reach)}", f"put them {mm(reach - gap)} further apart, make one "
                        "smaller, or give both the same 'side'")


def _loop_problems(model: Model, i: int) -> Iterator[Problem]:
    """A loop that is pulled at an end that it has not, or that runs round its wheels inside out."""
    tendon, path = model.mechanism.tendons[i], f"$.tendons[{i}]"
    if (drive := int(model.tendons.drive[i])) != NONE:
        yield error("not-settable", f"$.drives[{drive}].tendon", model.drives.name[drive],
                    f"pulls {tendon.name}, a loop, which has no end to pull at",
                    "a torque or a motor at a wheel's hinge, or a cord that is not closed")
    sides = {guide.side for guide in tendon.guides}
    if all(guide.radius for guide in tendon.guides) and len(sides) == 1:
        wraps = [wrap - math.tau * guide.turns
                 for wrap, guide in zip(wraps_at_start(model, i), tendon.guides, strict=True)]
        times = round(sum(wraps) / math.tau)
        if times > 1:
            other = "right" if sides == {"left"} else "left"
            yield look("bad-tendon-path", path, tendon.name,
                       f"crosses itself: on this path it goes {times} times round",
                       f"{other!r} as the side of its guides, or these in another order")


def _without_effect(model: Model, i: int) -> Iterator[Problem]:
    """Friction and turns where a cord has no use for them, loops that turn no wheel."""
    tendon = model.mechanism.tendons[i]
    wheels = [guide for guide in tendon.guides if guide.radius]
    if tendon.closed and wheels and not any(guide.friction for guide in tendon.guides):
        yield look("no-effect", f"$.tendons[{i}].guides", tendon.name,
                   "it turns no wheel: the loop slides over all its guides without friction",
                   "friction at the wheels that are to turn with it")
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
            yield look("no-effect", f"{path}.begins", tendon.name, f"its {guide.begins!r} does "
                       "nothing: the cord cannot lift off there, only off a wheel between its ends "
                       "that has no friction and no turns", f"to leave {guide.begins!r} out")
        if guide.turns and not guide.radius:
            yield look("no-effect", f"{path}.turns", tendon.name, f"its {guide.turns} turns do "
                       "nothing: it goes round no wheel", "a radius, or no turns")
        elif guide.turns and tied:
            yield look("no-effect", f"{path}.turns", tendon.name, f"its {guide.turns} turns do "
                       "nothing: the cord is tied there", "no turns")


def _off_wheels(model: Model, i: int, off: Flags, points: list[Vec]) -> Iterator[Problem]:
    """Wheels that a cord goes straight past at t = 0 without being told to, or in vain told to."""
    tendon, begin = model.mechanism.tendons[i], int(model.tendons.first[i])
    for k in tendon.lifting:
        told = tendon.guides[k].begins
        if off[begin + k] != (told == "off"):
            other = "right" if tendon.guides[k].side == "left" else "left"
            before = max(j for j in range(k) if not off[begin + j])
            after = min(j for j in range(k + 1, len(points)) if not off[begin + j])
            three = [before, k, after]
            radii = model.tendons.guide_radius[begin + np.array(three)].tolist()
            far = passes_by([points[j] for j in three], radii)
            path = f"$.tendons[{i}].guides[{k}]"
            if told == "off":
                yield error("bad-tendon-path", f"{path}.begins", tendon.name, "cannot begin off "
                            f"its wheel, which the straight way past it would have {mm(-far)} deep "
                            "in it", f"the wheel so much further out, or the other side, {other!r}")
                continue
            yield look("bad-tendon-path", path, tendon.name, "begins off its wheel: it goes "
                       f"straight past it, {mm(far)} away", "\"begins\": \"off\", if it is to meet "
                       f"the wheel later; side {other!r}, if the wheel is to bend it")


def _stretched(model: Model, i: int, length: float, rest: float) -> Iterator[Problem]:
    """A cord that its length at rest, or its pretension, stretches by more than cords can."""
    tendon, path = model.mechanism.tendons[i], f"$.tendons[{i}]"
    if rest <= 0.0 and tendon.pretension is not None:
        yield error("tendon-length", path, tendon.name,
                    f"a pretension of {tendon.pretension:g} N leaves nothing of a cord of "
                    f"{tendon.stiffness:g} N/m on a path of {mm(length)}",
                    f"less than {tendon.stiffness * length:.3g} N, or a stiffer cord")
    elif tendon.stiffness >= RIGID and length > (1 + MOST_STRETCH) * rest:
        yield look("tendon-length", path, tendon.name,
                   f"is shorter than its path, which is {mm(length)} long at t = 0: it begins with "
                   f"{tendon.stiffness * (length - rest):.3g} N",
                   f"a rest_length near {mm(length)}, or a pretension")
