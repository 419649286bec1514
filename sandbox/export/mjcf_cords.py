"""Springs and tendons of a MuJoCo model."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping

from sandbox.export.mjcf_document import Draft
from sandbox.export.mjcf_joints import FAR, route
from sandbox.export.tree import vec
from sandbox.export.wheels import Wrap, wrap_round
from sandbox.export.xmltext import add, element
from sandbox.model.lifts import lifted_at_start
from sandbox.model.model import NONE
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.geometry import Vec

FRACTION = 0.2
"""The time step is at most this fraction of 1 / omega of an elastic tendon and its free ends."""
WHEEL = "0.45 0.6 0.75 0.4"
FORCE = 1e6
"""No tension reaches this [N]; MuJoCo wants its ranges closed."""


def add_springs(draft: Draft) -> None:
    """All springs; what acts in a hinge is kept until the hinge is written."""
    for number, spring in enumerate(draft.mechanism.springs):
        SPRINGS[spring.type](draft, number)


def _between_points(draft: Draft, spring: int) -> None:
    """A spatial tendon."""
    springs = draft.model.springs
    name, (a, b) = springs.name[spring], springs.bodies[spring].tolist()
    on_a, on_b = springs.anchor[spring]
    cord = add(draft.sections["tendon"], "spatial", name=name,
               springlength=_free_lengths(draft, spring),
               stiffness=float(springs.stiffness[spring]) or None,
               damping=float(springs.damping[spring]) or None,
               rgba="0.6 0.6 0.3 1", width=0.0005)
    route(draft, cord, name, ((a, vec(on_a)), (b, vec(on_b))))
    draft.sense("tendonpos", f"{name}.length", tendon=name)


def _free_lengths(draft: Draft, spring: int) -> float | tuple[float, float]:
    """The length at which a spring gives no force; of a one-sided one from where to where."""
    law, rest = draft.model.springs.law[spring], float(draft.model.springs.rest[spring])
    if law is None:
        return rest
    return (0.0, rest) if law.side > 0 else (rest, FAR)


def _in_hinge(draft: Draft, spring: int) -> None:
    draft.hinges[int(draft.model.springs.joint[spring])].springs.append(spring)


SPRINGS: Mapping[str, Callable[[Draft, int], None]] = {
    "linear": _between_points, "rotary": _in_hinge}
"""By kind of spring: writes one."""


def add_tendons(draft: Draft) -> float:
    """All tendons; the largest time step that the elastic ones allow [s]."""
    tendons, step, stiff = draft.model.tendons, math.inf, []
    for tendon, name in enumerate(tendons.name):
        law: dict[str, float | tuple[float, float]] = {}
        if tendons.drive[tendon] == NONE:
            rest, stiffness = rest_length(draft, tendon), float(tendons.stiffness[tendon])
            if stiffness >= RIGID:  # such a cord stands for one that does not stretch
                stiff.append(name)
                law["range"] = (0.0, rest)
                draft.sense("tendonlimitfrc", f"{name}.tension", tendon=name)
            else:
                step = min(step, FRACTION / math.sqrt(stiffness * yielding(draft, tendon)))
                if tendons.damping[tendon]:
                    _pulling_only(draft, tendon, rest)
                else:
                    law["stiffness"], law["springlength"] = stiffness, (0.0, rest)
        cord = add(draft.sections["tendon"], "spatial", name=name, width=0.0005,
                   rgba="0.75 0.25 0.2 1", **law)
        _thread(draft, cord, tendon)
        draft.sense("tendonpos", f"{name}.length", tendon=name)
    if stiff:
        draft.notes.append(
            f"tendons of {RIGID:g} N/m and more do not stretch here: {', '.join(stiff)}")
    return step


def rest_length(draft: Draft, tendon: int) -> float:
    """Up to which a tendon is slack [m]."""
    rest = float(draft.model.tendons.rest[tendon])
    if math.isnan(rest):
        rest = path_length(draft, tendon)
    return rest + float(draft.model.tendons.slack[tendon])


def _pulling_only(draft: Draft, tendon: int, rest: float) -> None:
    """T = max(k (L - L0) + c L', 0): a damper in a spring would push when the cord is slack.

    The actuator counts its length as -L, so that its force is T.
    """
    name = draft.model.tendons.name[tendon]
    stiffness, damping = (float(row[tendon]) for row in (
        draft.model.tendons.stiffness, draft.model.tendons.damping))
    add(draft.sections["actuator"], "general", name=name, tendon=name, gear=-1.0,
        gainprm=0.0, biastype="affine", biasprm=(-stiffness * rest, -stiffness, -damping),
        ctrlrange=(0.0, 1.0), forcerange=(0.0, FORCE))
    draft.controls.append(0.0)  # it has no input
    draft.sense("actuatorfrc", f"{name}.tension", actuator=name)


def _guides(draft: Draft, tendon: int) -> list[tuple[int, Vec, float]]:
    """Of every guide its body, its place there [m] and its radius, positive right of the path."""
    tendons = draft.model.tendons
    path = tendons.guides(tendon)
    return [(body, vec(at), radius) for body, at, radius in zip(
        tendons.guide_body[path].tolist(), tendons.guide_at[path],
        tendons.guide_radius[path].tolist(), strict=True)]


def _points(draft: Draft, tendon: int) -> list[Vec]:
    return [draft.world(body, at) for body, at, _ in _guides(draft, tendon)]


def _wrap(draft: Draft, tendon: int, points: list[Vec], i: int, radius: float) -> Wrap:
    off = bool(lifted_at_start(draft.model)[int(draft.model.tendons.first[tendon]) + i])
    wrap = wrap_round(points[i - 1], points[i], points[i + 1], radius, past=off)
    assert wrap is not None  # refused before
    return wrap


def _thread(draft: Draft, cord: ET.Element, tendon: int) -> None:
    points, own = _points(draft, tendon), draft.model.tendons.name[tendon]
    for i, (body, at, signed) in enumerate(_guides(draft, tendon)):
        name, radius = f"{own}.{i}", abs(signed)
        if not radius:
            add(cord, "site", site=draft.site(body, name, at))
            continue
        wrap = _wrap(draft, tendon, points, i, signed)
        middle = wrap.middle - float(draft.model.bodies.pose[body, 2])
        beside = (at[0] + 1.5 * radius * math.cos(middle), at[1] + 1.5 * radius * math.sin(middle))
        wheel = draft.names.made("geom", name)
        draft.on_body[body].append(element(
            "geom", name=wheel, type="cylinder", size=(radius, radius / 4),
            pos=(*at, 0.0), rgba=WHEEL))
        add(cord, "geom", geom=wheel, sidesite=draft.site(body, f"{name}.side", beside))


def path_length(draft: Draft, tendon: int) -> float:
    """Of a tendon at t = 0 [m]; its wheels stand between eyes."""
    points = _points(draft, tendon)
    length, place = 0.0, points[0]
    for i, (_, _, radius) in enumerate(_guides(draft, tendon)[1:], start=1):
        if not radius:
            length += math.dist(place, points[i])
            place = points[i]
            continue
        wrap = _wrap(draft, tendon, points, i, radius)
        length += math.dist(place, wrap.on) + abs(radius) * wrap.angle
        place = wrap.off
    return length


def yielding(draft: Draft, tendon: int) -> float:
    """J M^-1 J^T of a tendon [1/kg], its bodies taken as free, wheels as eyes."""
    bodies, points = draft.model.bodies, _points(draft, tendon)
    pulls: dict[int, list[float]] = {}
    for i, (body, _, _) in enumerate(_guides(draft, tendon)):
        if not bodies.free[body]:
            continue
        row = pulls.setdefault(body, [0.0, 0.0, 0.0])
        centre = draft.world(body, vec(bodies.centre[body]))
        for other in points[max(i - 1, 0):i] + points[i + 1:i + 2]:
            length = math.dist(points[i], other) or math.inf
            ux, uy = (points[i][0] - other[0]) / length, (points[i][1] - other[1]) / length
            row[0] += ux
            row[1] += uy
            row[2] += (points[i][0] - centre[0]) * uy - (points[i][1] - centre[1]) * ux
    total = 0.0
    for body, (x, y, moment) in pulls.items():
        total += (x * x + y * y) / float(bodies.mass[body])
        total += moment * moment / float(bodies.inertia[body])
    return total or 1e-12
