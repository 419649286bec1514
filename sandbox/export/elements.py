"""Joints, springs, tendons and drives of a MuJoCo model."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from dataclasses import dataclass

from sandbox.elements.element import GRAZE
from sandbox.elements.tendons import RIGID
from sandbox.export.document import MAX_FORCE, Draft, add, element
from sandbox.export.tree import anchors, angle_sum, pose, stops, vec
from sandbox.model.model import NONE
from sandbox.model.tendons import lifted_at_start, passes_by
from sandbox.scene.geometry import Vec

FAR = 1e6
"""A length that no spring reaches [m], as MuJoCo needs closed ranges."""


def add_links(draft: Draft) -> None:
    """Add rods and ropes, then the joints that close loops."""
    straight = (joint for joint, kind in enumerate(draft.model.joints.kind) if kind.along_line)
    for joint in (*straight, *draft.tree.loops):
        if draft.model.joints.kind[joint].along_line:
            _distance(draft, joint)
        else:
            _close(draft, joint)


def route(draft: Draft, cord: ET.Element, name: str, ends: tuple[tuple[int, Vec], ...]) -> None:
    """Route a spatial tendon through points of bodies."""
    for i, (body, at) in enumerate(ends):
        add(cord, "site", site=draft.site(body, f"{name}.{i}", at))


def _distance(draft: Draft, joint: int) -> None:
    """Add a tendon of fixed, limited or free length: a rod, a rope or an actuator."""
    name = draft.model.joints.name[joint]
    a, b = draft.model.joints.bodies[joint].tolist()
    on_a, on_b = anchors(draft.model, joint)
    low, high = draft.model.joints.reach[joint].tolist()
    stiff, free = low == high, low == 0.0 and high == math.inf
    cord = add(draft.sections["tendon"], "spatial", name=name,
               range=None if stiff or free else (low, min(high, FAR)), width=0.0005)
    route(draft, cord, name, ((a, on_a), (b, on_b)))
    draft.sense("tendonpos", f"{name}.length", tendon=name)
    if stiff:
        start = math.dist(draft.assembled(a, on_a), draft.assembled(b, on_b))
        add(draft.sections["equality"], "tendon", name=name, tendon1=name,
            polycoef=(high - start, 0, 0, 0, 0))
    elif not free:
        draft.sense("tendonlimitfrc", f"{name}.reaction", tendon=name)


def _close(draft: Draft, joint: int) -> None:
    """Add an equality constraint of two sites; of a weld that on ``a`` is rotated."""
    turns = draft.model.joints.turns[joint]
    name = draft.model.joints.name[joint]
    a, b = draft.model.joints.bodies[joint].tolist()
    on_a, on_b = anchors(draft.model, joint)
    angle = 0.0 if turns else pose(draft.model, b)[2] - pose(draft.model, a)[2]
    more = {"euler": f"0 0 {angle:.12g}"} if angle else {}
    add(draft.sections["equality"], "connect" if turns else "weld", name=name,
        site1=draft.site(a, f"{name}.a", on_a, **more), site2=draft.site(b, f"{name}.b", on_b))


def hinge_law(draft: Draft, joint: int) -> dict[str, float]:
    """Stiffness, rest angle, damping and friction of a pin with its springs and brake.

    Parallel springs add up: k = sum(k_i), rest = sum(k_i rest_i) / k.
    """
    hinge, springs = draft.hinges[joint], draft.model.springs
    laws = [(float(springs.stiffness[i]), float(springs.rest[i]), float(springs.damping[i]))
            for i in hinge.springs]
    law: dict[str, float] = {}
    if stiffness := sum(k for k, _, _ in laws):
        law["stiffness"] = stiffness
        law["springref"] = sum(k * rest for k, rest, _ in laws) / stiffness
    if damping := float(draft.model.joints.damping[joint]) + sum(c for _, _, c in laws):
        law["damping"] = damping
    loss = float(draft.model.joints.friction[joint]) + max(hinge.brake or 0.0, 0.0)
    if loss > 0:
        law["frictionloss"] = loss
    return law


def add_closing_angles(draft: Draft) -> None:
    """Add the springs, stops and drives of pins that close loops, on a sum of other hinges."""
    for joint in draft.tree.loops:
        if draft.model.joints.angle[joint]:
            _add_closing_angle(draft, joint)


def _add_closing_angle(draft: Draft, joint: int) -> None:
    """Add a fixed tendon with the spring, damper, brake and stops of a pin, if it has any."""
    law, limits = hinge_law(draft, joint), stops(draft.model, joint)
    angle = angle_sum(draft.model, joint, draft.tree, draft.moves)
    if not angle.factors or not (law or draft.hinges[joint].driven or limits):
        return
    rest = law.pop("springref", None)
    cord = add(draft.sections["tendon"], "fixed", name=draft.model.joints.name[joint], **law,
               springlength=None if rest is None else rest - angle.offset,
               range=None if limits is None else tuple(x - angle.offset for x in limits))
    for name, factor in angle.factors:
        add(cord, "joint", joint=name, coef=factor)


FRACTION = 0.2
"""Largest time step, relative to 1 / omega of an elastic tendon between its free bodies."""
WHEEL = "0.45 0.6 0.75 0.4"


def add_springs(draft: Draft) -> None:
    """Add all springs; those of hinges are kept until their hinge is written."""
    for index, straight in enumerate(draft.model.springs.straight):
        if straight:
            _between_points(draft, index)
        else:
            draft.hinges[int(draft.model.springs.joint[index])].springs.append(index)


def _between_points(draft: Draft, spring: int) -> None:
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
    """The length without force, or its range for a spring that only pulls or pushes."""
    law, rest = draft.model.springs.law[spring], float(draft.model.springs.rest[spring])
    if law is None:
        return rest
    return (0.0, rest) if law.side > 0 else (rest, FAR)


def add_tendons(draft: Draft) -> float:
    """Add all tendons; return the largest time step for the elastic ones [s]."""
    tendons, step, stiff = draft.model.tendons, math.inf, []
    for tendon, name in enumerate(tendons.name):
        law: dict[str, float | tuple[float, float]] = {}
        if tendons.drive[tendon] == NONE:
            rest, stiffness = rest_length(draft, tendon), float(tendons.stiffness[tendon])
            if stiffness >= RIGID:  # an inextensible tendon
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
    """The length up to which a tendon is slack [m]."""
    rest = float(draft.model.tendons.rest[tendon])
    if math.isnan(rest):
        rest = path_length(draft, tendon)
    return rest + float(draft.model.tendons.slack[tendon])


def _pulling_only(draft: Draft, tendon: int, rest: float) -> None:
    """Add an actuator with T = max(k (L - L0) + c L', 0), which a tendon's own law cannot have.

    Its length is -L, so that its force is T.
    """
    name = draft.model.tendons.name[tendon]
    stiffness, damping = (float(row[tendon]) for row in (
        draft.model.tendons.stiffness, draft.model.tendons.damping))
    add(draft.sections["actuator"], "general", name=name, tendon=name, gear=-1.0,
        gainprm=0.0, biastype="affine", biasprm=(-stiffness * rest, -stiffness, -damping),
        ctrlrange=(0.0, 1.0), forcerange=(0.0, MAX_FORCE))
    draft.controls.append(0.0)  # it has no input
    draft.sense("actuatorfrc", f"{name}.tension", actuator=name)


def _guides(draft: Draft, tendon: int) -> list[tuple[int, Vec, float]]:
    """Body, point [m] and radius, positive right of the path, of every guide."""
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
    """Length of a tendon at t = 0 [m]; each pulley lies between two via points."""
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
    """J M^-1 J^T of a tendon [1/kg] with free bodies, and pulleys as via points."""
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


@dataclass(frozen=True)
class Wrap:
    """The contact of a tendon with a pulley; points in the world [m]."""

    on: Vec
    """Point where the tendon meets the pulley."""
    off: Vec
    """Point where it leaves the pulley."""
    middle: float
    """Direction from the centre to the middle of the arc [rad]."""
    angle: float
    """Angle of the arc [rad]."""
    crosses: bool
    """Whether the two straight parts cross."""


def wrap_round(
    before: Vec, centre: Vec, after: Vec, radius: float, *, past: bool = False,
) -> Wrap | None:
    """The arc of a tendon from ``before`` around a pulley at ``centre`` to ``after`` (world, [m]).

    None if one of the points lies in the pulley. A tendon that passes straight by (``past``) has an
    arc of zero at the nearest point. With the left normal n of a straight part, a pulley of
    ``radius`` r, positive right of the path, is touched at c + r n.
    """
    sign = math.copysign(1.0, radius)
    if past:
        x, y = _normal(before, after, 0.0)
        far = sign * (passes_by([before, centre, after], [0.0, radius, 0.0]) + abs(radius))
        foot = centre[0] + far * x, centre[1] + far * y
        return Wrap(foot, foot, math.atan2(sign * y, sign * x), 0.0, crosses=False)
    if min(math.dist(before, centre), math.dist(after, centre)) <= abs(radius):
        return None
    n_on = _normal(before, centre, -radius)
    n_off = _normal(centre, after, radius)
    on = centre[0] + radius * n_on[0], centre[1] + radius * n_on[1]
    off = centre[0] + radius * n_off[0], centre[1] + radius * n_off[1]
    between = math.atan2(n_on[1], n_on[0]) - math.atan2(n_off[1], n_off[0])
    angle = (sign * between + GRAZE) % (2 * math.pi) - GRAZE  # a touch is no full turn
    middle = math.atan2(on[1] - centre[1], on[0] - centre[0]) - sign * angle / 2
    return Wrap(on, off, middle, angle, _cross(before, on, off, after))


def _normal(start: Vec, end: Vec, offset: float) -> Vec:
    """Left normal n of a straight part, with n . (end - start) = offset."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    straight = math.sqrt(dx * dx + dy * dy - offset * offset)
    square = dx * dx + dy * dy
    return (offset * dx - straight * dy) / square, (straight * dx + offset * dy) / square


def _cross(a: Vec, b: Vec, c: Vec, d: Vec) -> bool:
    """Whether the segments ab and cd cross."""
    def side(p: Vec, q: Vec, r: Vec) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0


def add_drives(draft: Draft) -> None:
    """Add all drives; note every controller and event, which MuJoCo lacks."""
    for steering in (*draft.mechanism.controllers, *draft.mechanism.events):
        draft.notes.append(f"{steering.name}: MuJoCo has no controllers and no events; the drives "
                           "keep their own signals")
    for i, drive in enumerate(draft.mechanism.drives):
        drive.write_mujoco(draft, i)


def add_start(draft: Draft) -> None:
    """Add the keyframe ``start``: pose and speeds at t = 0, controls at the end of the run."""
    moves = draft.coordinates()
    if not moves and not draft.controls:
        return
    add(draft.sections["keyframe"], "key", name="start",
        qpos=[move.start for move in moves] if moves else None,
        qvel=[move.rate for move in moves] if any(move.rate for move in moves) else None,
        ctrl=draft.controls or None)
