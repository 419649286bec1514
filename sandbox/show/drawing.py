"""What the page's script is given of drives, fluids, wheels and symbols: points and constants."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sandbox.elements.arrays import largest_size
from sandbox.model.model import NONE, Model
from sandbox.numeric import Array
from sandbox.picture.elements.bodies import styles
from sandbox.picture.elements.drives import signs_of
from sandbox.picture.elements.links import has_ropes
from sandbox.picture.palette import ROLES, WHEEL, WHEEL_EDGE, Style
from sandbox.picture.points import PointPool
from sandbox.picture.run_data import RunData
from sandbox.picture.scales import ForceScale
from sandbox.samples.contacts import OBJECT
from sandbox.scene.bodies import Circle

XY = tuple[float, float]
EDGE, HAIR, PIN, COLLAR, GAUGE = 1.3, 0.5, 3.6, 6.4, 13.0
CORD, WOUND, COIL, THICK, SHORT = 2.4, 1.5, 1.1, (0.5, 6.0), 36.0
FINE, LABELLED, MOST_LABELS, HINGE = ((4.4, 11), (2.4, 10)), 0.12, 24, 5.0
"""Widths and sizes in points; the wound end of a cord in radians; shares."""


SLIM, BLOCK = ((5.4, 12), (3.4, 11)), ((9.0, 20), (7.0, 17))
"""Shaft's and head's width of a drive's arrow, its rim's and its own [units of the canvas]."""


COMPARABLE = 0.2
"""Share of the contact forces' reference from which a force is drawn to their scale: an arrow of a
smaller one would be too short to see."""


TELLING = 6
"""Values of drives and of loads are written of no more than so many."""


@dataclass(frozen=True)
class Arrow:
    """Where a drive's arrow begins and which way it points while the drive's value is positive."""

    at: int
    """The pooled point at its tail, or that a bent one goes round."""
    line: tuple[int, int]
    """Two pooled points: the arrow points from the first to the second."""
    direction: XY = (0.0, 0.0)
    """Where it points if no body turns it."""
    bent: int = 0
    """About a hinge: +1 where it is counter-clockwise as seen, else -1; 0 of a straight one."""
    radius: float = 0.0
    """Of the wheel that the line begins on [m], positive where it lies right of the way."""
    to_scale: bool = False
    """Whether it is drawn to the scale of the contact forces, where there are any."""


def _force(model: Model, drive: int, pool: PointPool) -> Arrow:
    drives = model.drives
    body, at, direction = int(drives.target[drive]), drives.at[drive], drives.direction[drive]
    if drives.turning[drive]:
        tail = pool.add(body, np.array([at, at + 1e-3 * direction])).start
        return Arrow(tail, (tail, tail + 1), to_scale=True)
    tail = pool.add(body, at).start
    return Arrow(tail, (tail, tail), (float(direction[0]), float(direction[1])), to_scale=True)


def _pull(model: Model, drive: int, pool: PointPool) -> Arrow:
    """On from the tendon's last guide."""
    tendons = model.tendons
    last = tendons.guides(int(model.drives.target[drive])).stop - 1
    at, before = (pool.add(int(tendons.guide_body[i]), tendons.guide_at[i]).start
                  for i in (last, last - 1))
    return Arrow(at, (before, at), radius=float(tendons.guide_radius[last - 1]))


def _push(model: Model, drive: int, pool: PointPool) -> Arrow:
    """On its body ``b``, away from ``a``."""
    joints, joint = model.joints, int(model.drives.target[drive])
    a, b = (pool.add(int(joints.bodies[joint, k]), joints.anchor[joint, k]).start for k in (0, 1))
    return Arrow(b, (a, b), to_scale=True)


def _torque(model: Model, drive: int, pool: PointPool) -> Arrow:
    at = _hinge(model, drive, pool)
    return Arrow(at, (at, at), bent=_sense(model, drive))


def _hinge(model: Model, drive: int, pool: PointPool) -> int:
    """The pooled point of the hinge that a drive acts on."""
    joints, joint = model.joints, model.drives.target[drive]
    where = pool.add(int(joints.bodies[joint, 1]), joints.anchor[joint, 1])
    return int(where.start)


def _sense(model: Model, drive: int) -> int:
    """+1 where a positive value of a drive on a hinge turns it counter-clockwise, else -1."""
    return int(model.joints.sense[model.drives.target[drive]])


@dataclass(frozen=True)
class _Told:
    """A drive whose torque or force the solve works out, which is written beside it."""

    number: int
    name: str
    unit: str
    ends: tuple[int, int]
    """Pooled points: of an actuator its two, of a hinge one twice."""
    decimals: int
    """Of the value: three digits of the largest of the run."""


def told_drives(run: RunData, pool: PointPool) -> list[_Told]:
    """Of a few such drives, those that give anything in the run."""
    model, found = run.model, []
    joints = model.joints
    limited = [k for k, kind in enumerate(model.drives.kind) if kind.limited]
    for k in limited if len(limited) <= TELLING else ():
        largest = float(np.nanmax(np.abs(run.arrays["drive_torque"][:, k]), initial=0.0))
        if not largest > 0:
            continue
        joint, line = int(model.drives.target[k]), model.drives.kind[k].target.line
        a, b = (pool.add(int(joints.bodies[joint, i]), joints.anchor[joint, i]).start
                for i in (0, 1))
        decimals = min(max(2 - math.floor(math.log10(largest)), 0), 6)
        found.append(_Told(k, model.drives.name[k], "N" if line else "N m",
                           (a, b) if line else (b, b), decimals))
    return found


def reaches(arrow: Arrow, usual: float, scale: ForceScale) -> bool:
    """Whether an arrow of such a force is drawn to the scale of the contact forces."""
    return arrow.to_scale and scale.metres > 0 and usual >= COMPARABLE * scale.reference


def arrow_sign(bent: int, scaled: bool) -> str:
    """What the legend says of a drive's arrow, of :data:`SYMBOLS`."""
    return "torque" if bent else "scaled" if scaled else "driven"


SPARE = 0.04
"""Of a cylinder's largest length: room left before and behind its piston."""


LEAST_TUBE, MOST_TUBE = 0.55, 0.95
"""Of a cylinder's least length: the least and largest length of its tube. Where its stroke has no
room in that it is drawn shorter than it is."""


@dataclass(frozen=True)
class Tube:
    """A cylinder: pooled points of its two ends; lengths [m]."""

    line: int
    a: int
    b: int
    tube: float
    longest: float
    """Of the cylinder, where its piston is at ``end`` of the tube."""
    end: float
    slope: float
    """How far the piston moves, as drawn, for 1 m that the cylinder grows."""
    pulls: bool


def tubes_of(run: RunData, pool: PointPool) -> list[Tube]:
    """Cylinders, their tubes as long as the run lets them be."""
    lines, found = run.model.lines, []
    own = PointPool()
    which = np.flatnonzero(lines.joint == NONE).tolist()
    for n in which:
        for end in (0, 1):
            own.add(int(lines.bodies[n, end]), lines.anchor[n, end])
    own.close()
    world: Array = own.world(run.arrays["body_pose"])
    for k, n in enumerate(which):
        lengths = np.hypot(*(world[:, 2 * k + 1] - world[:, 2 * k]).T)
        least, most = float(lengths.min()), float(lengths.max())
        spare = SPARE * most
        tube = min(max(most - least + 2 * spare, LEAST_TUBE * least), MOST_TUBE * least)
        stroke = min(most - least, max(tube - 2 * spare, 0.0))
        slope = stroke / (most - least) if most > least else 1.0
        a, b = (pool.add(int(lines.bodies[n, end]), lines.anchor[n, end]).start for end in (0, 1))
        found.append(Tube(int(lines.of[n]), a, b, tube, most, tube - spare, slope,
                           bool(lines.gain[n] < 0)))
    return found


def ports_of(
    model: Model, tubes: list[Tube], vanes: list[tuple[int, int]],
) -> list[list[tuple[Tube | None, int]]]:
    """Of every line its chambers, in their order: a cylinder, or the pooled point of a vane."""
    lines = model.lines
    ports: list[list[tuple[Tube | None, int]]] = [[] for _ in lines.name]
    cylinders, hinges = iter(tubes), iter(vanes)
    for line, joint in zip(lines.of.tolist(), lines.joint.tolist(), strict=True):
        ports[line].append((next(cylinders), NONE) if joint == NONE
                           else (None, next(hinges)[1]))
    return ports


BARE = Style(WHEEL, WHEEL_EDGE)
"""Of wheels that are no circles of their bodies."""


@dataclass(frozen=True)
class _Wheel:
    """A disc about a guide: its centre, and a point at angle 0 of its body."""

    centre: int
    radius: float
    """[m]"""
    style: Style
    marked: bool
    """Whether a line from the centre shows how it is turned."""


def wheels_of(model: Model, pool: PointPool) -> list[_Wheel]:
    """The wheels of guides that no circle of their body shows, on every shaft the largest first.

    A circle that such a wheel would cover is drawn again above it.
    """
    shafts: dict[tuple[int, XY], list[float]] = {}
    for tendon in model.mechanism.tendons:
        for guide in tendon.guides:
            if guide.radius > 0:
                shafts.setdefault((model.names.body[guide.body], guide.at), []).append(guide.radius)
    found = []
    drives = model.drives
    swelling = {(int(drives.target[k]), int(drives.shape[k])) for k in drives.giving("radius")}
    for (body, at), radii in shafts.items():
        spec = model.mechanism.bodies[body]
        circles = [s.radius for k, s in enumerate(spec.shapes)
                   if isinstance(s, Circle) and s.at == at and (body, k) not in swelling]
        missing = {r for r in radii if not any(math.isclose(r, c) for c in circles)}
        steps = {r: BARE for r in missing}
        steps |= {c: ROLES[spec.role] for c in circles if c < max(missing, default=0.0)}
        for radius in sorted(steps, reverse=True):
            centre = pool.add(body, [at, (at[0] + radius, at[1])]).start
            found.append(_Wheel(centre, radius, steps[radius], marked=len(steps) > 1))
    return found


class Symbol(NamedTuple):
    """One line of a legend."""

    layer: str
    """With which it goes."""
    width: float
    """Of the symbol [points]."""
    words: str
    """After it; ``{}`` stands for a number with its unit."""
    before: str = ""


SYMBOLS: Mapping[str, Symbol] = {
    "cut": Symbol("contacts", 34, "larger, cut short"),
    "patch": Symbol("pressure", 22, "force per length"),
    "bars": Symbol("bars", 96, "{} pull", "bars push {}"),
    "both": Symbol("tensions", 96, "{} pulls", "pushes {}"),
    "pull": Symbol("tensions", 64, "{}", "tension 0"),
    "pressure": Symbol("tendons", 64, "{}", "pressure 0"),
    "vane": Symbol("tendons", 16, "turned by pressure"),
    "rope": Symbol("joints", 30, "rope"),
    "slack": Symbol("tendons", 26, "slack"),
    "spring": Symbol("springs", 36, "spring"),
    "stiffer": Symbol("drives", 36, "made stiffer"),
    "braked": Symbol("drives", 12, "brake holds"),
    "unbraked": Symbol("drives", 12, "free"),
    "motor": Symbol("drives", 20, "way a motor turns"),
    "belt": Symbol("drives", 16, "surface runs"),
    "servo": Symbol("drives", 30, "servo"),
    "wider": Symbol("drives", 22, "wider: made stiffer"),
    "rubs": Symbol("drives", 14, "friction holds"),
    "slides": Symbol("drives", 14, "slips"),
    "scaled": Symbol("drives", 30, "driving force"),
    "driven": Symbol("drives", 30, "driving force, not to scale"),
    "torque": Symbol("drives", 22, "driving torque"),
    "holds": Symbol("joints", 18, "may let go"),
    "gone": Symbol("joints", 18, "let go"),
    "open": Symbol("tendons", 15, "valve open"),
    "shut": Symbol("tendons", 15, "shut"),
    "stop": Symbol("joints", 16, "joint stop"),
    "trace": Symbol("traces", 30, "trace, marked every {}"),
    "fixed": Symbol("bodies", 22, "fixed"),
}
"""By name, most important first; before them stand the scales of lengths and arrows."""


def signs_in(run: RunData) -> set[str]:
    """The symbols of what is in a run, but those that hang on what is shown of it.

    Left out are the scales of tensions and pressures, what is cut short, arrows of drives, cords
    that hang, traces, and fixed bodies.
    """
    model = run.model
    there = {"rope": has_ropes(model), "spring": _springs_seen(model),
             "vane": bool((model.lines.joint != NONE).any()), "holds": bool(model.ties.name),
             "gone": bool(model.ties.name), "open": len(model.valves.lines) > 0,
             "shut": len(model.valves.lines) > 0,
             "stop": largest_size(run.arrays["joint_stop"]) > 0}
    return {name for name, found in there.items() if found} | signs_of(model)


def _springs_seen(model: Model) -> bool:
    """Whether there is a spring that no vane on its hinge covers."""
    springs = model.springs
    covered = ~springs.straight & np.isin(springs.joint, model.lines.joint)
    return bool((~covered).any())


def fixed_style(run: RunData, bodies: Iterable[int]) -> Style | None:
    """That of most of the fixed ones among some bodies; None where none of them is seen.

    What is held counts only if nothing else is fixed.
    """
    looks, all_of = styles(run.model), run.mechanism.bodies
    seen = [i for i in bodies if all_of[i].motion == "fixed" and all_of[i].shapes]
    found = Counter(looks[i] for i in seen if all_of[i].role != OBJECT) or Counter(
        looks[i] for i in seen)
    return found.most_common(1)[0][0] if found else None


class StandOff(NamedTuple):
    """Where a text is looked for that finds no room beside what it tells of."""

    nearest: float
    """From there to the nearest point of the text, the least [points]."""
    farthest: float
    further: float
    """Steps between the two."""
    ways: int
    """Directions, upwards first."""


OF_NUMBERS = StandOff(16.0, 88.0, 9.0, ways=16)


OF_FINGERS = StandOff(14.0, 150.0, 8.0, ways=24)


RIM = 1.5
"""A line begins so far from its text [points],"""


TIP, HINGE = 2.5, 5.0
"""and ends so far before the end of an arrow, and before a hinge [points]."""


ARROWS: Mapping[str, Callable[[Model, int, PointPool], Arrow]] = {
    "force": _force, "torque": _torque, "pull": _pull, "push": _push,
}
"""The arrows of drives, by type."""
