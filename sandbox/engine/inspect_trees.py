"""How far differentials can go: until a rocker turns over, or a pivot's slot ends.

The ends of a rocker with arms a and b, at a tilt theta from across the pull, are (a + b) sin(theta)
apart along it. So the two strings of one rocker can have gone different ways by a + b and no
more: there the rocker lies along the pull, and beyond it no longer divides it. A wheel winds its
strings on and turns as far as they want.

Before that the strings slant: the end on the arm a has come in by a (1 - cos(theta)), which is
atan(a (1 - cos(theta)) / l) over a string of length l, and the torques about the pivot balance with

    T1 a cos(theta + slant1) = T2 b cos(theta - slant2)

where 1 is the string that lags. The longer the strings, the better T1 a = T2 b.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.engine.inspect_travel import StringEnd, strings_of, ways
from sandbox.engine.inspect_words import NEGLIGIBLE, STRAIGHT, mm
from sandbox.model.model import Model
from sandbox.scene.geometry import to_body, to_world
from sandbox.wording import listed

OFF = 0.01
"""The error of a rocker's shares that is told."""


def reaches(model: Model) -> Iterator[str]:
    """A line for every tree of rockers or pulleys: ``tree: …``."""
    for group in model.mechanism.groups:
        if group.kind not in ("rocker_tree", "pulley_tree"):
            continue
        words = [*_rockers(model, group.bodies), *_slots(model, group.bodies)]
        if words:
            yield f"{group.name}: {'; '.join(words)}"


def _rockers(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    told: dict[str, list[str]] = {}
    strings = strings_of(model, names)
    for name in names:
        ends = [end for end in strings[model.names.body[name]] if not end.radius]
        if len(ends) == 2:
            one, two = ends
            width = float(np.hypot(*(one.at - two.at)))
            told.setdefault(f"by {mm(_off(one, two))} and {mm(width)}", []).append(name)
    if told:
        where = ", ".join(f"{way} ({listed(named, most=4)})" for way, named in told.items())
        yield (f"a rocker's shares are {100 * OFF:g} % off, and it turns over, where its strings "
               f"have gone differently far, {where}")


def _off(one: StringEnd, two: StringEnd) -> float:
    """How differently far the strings have gone where the shares are :data:`OFF` off [m]."""
    a, b = one.arm, two.arm
    k, m = (max(end.length, STRAIGHT) for end in (one, two))
    least, most = 0.0, math.pi / 2
    for _ in range(50):  # halvings: to rounding
        tilt = (least + most) / 2
        if max(_error(tilt, a, b, k, m), _error(tilt, b, a, m, k)) > OFF:
            most = tilt
        else:
            least = tilt
    return (a + b) * math.sin(least)


def _error(tilt: float, a: float, b: float, lags: float, leads: float) -> float:
    """Of T1 / T2 against b / a, where the string of ``a`` lags.

    Of a string that ends in an eye the last stretch grows, and it slants less.
    """
    slant1 = math.atan2(a * (1 - math.cos(tilt)), lags)
    slant2 = math.atan2(b * (1 - math.cos(tilt)), leads)
    carries = math.cos(tilt + slant1)
    return math.cos(tilt - slant2) / carries - 1 if carries > 0 else math.inf


def _slots(model: Model, names: tuple[str, ...]) -> Iterator[str]:
    rooms = {name: room for name in names if (room := _room(model, model.names.body[name]))}
    if rooms:
        ahead, behind = (min(way) for way in zip(*rooms.values(), strict=True))
        yield f"its slots end after {mm(ahead)} along the pull and {mm(behind)} against it"
        short = {name: way for name, way in ways(model, names).items()
                 if name in rooms and way > rooms[name][0] + NEGLIGIBLE}
        if short:
            most = max(short, key=lambda name: short[name] - rooms[name][0])
            yield (f"to close on nothing, until its fingers are at their stops, {most!r} would go "
                   f"{mm(short[most])}")


def _room(model: Model, body: int) -> tuple[float, float] | None:
    """How far a pivot can go in its slot from where it starts, on and back [m]."""
    joints, pose = model.joints, model.bodies.pose
    for joint in joints.keeping("groove"):
        frame, slider = joints.bodies[joint].tolist()
        if slider == body:
            start, end = joints.groove[joint]
            point = to_world(tuple(pose[slider]), tuple(joints.anchor[joint, 1]))
            length = float(np.hypot(*(end - start)))
            gone = float((to_body(tuple(pose[frame]), point) - start) @ (end - start)) / length
            return length - gone, gone
    return None
