"""Figures of geometry: lengths, poses and gaps against closed forms, in recorded poses."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from sandbox.audit.evidence import Evidence
from sandbox.audit.figures import ROUNDING, Figure, Worst
from sandbox.kinds.arrays import Array
from sandbox.mechanics.springs import spring_length
from sandbox.mechanics.tendon import segment_length
from sandbox.samples.cords import lengths
from sandbox.samples.frames import Layout
from sandbox.scene.elements.joints import Pin, Rod, Rope, Slot
from sandbox.scene.elements.springs import LinearSpring
from sandbox.scene.geometry import Vec

STOP_SLOP = 1e-6
"""How far a hinge may rest beyond its stop [rad]."""


def geometry_figures(evidence: Evidence) -> Iterator[Figure]:
    """Poses, lengths of tendons and springs, drift of joints, stops."""
    few = evidence.few
    yield _poses(few)
    yield _tendon_paths(few)
    yield _tendon_triangles(few)
    yield _spring_triangles(few)
    yield _drift(few)
    yield _stops(evidence)


def _poses(evidence: Evidence) -> Figure:
    """Equation (31): every body that hangs on pins from a fixed one, from the recorded angles."""
    name, source = "poses", "(31)"
    layout, frames, a = evidence.layout, evidence.loads.frames, evidence.run.arrays
    placed: dict[int, tuple[Array, Array, Array, Array]] = {
        i: (frames.x[i], frames.y[i], frames.angle[i], np.zeros(frames.samples))
        for i, body in enumerate(layout.mechanism.bodies) if body.motion != "dynamic"}
    worst, waiting = Worst(), list(layout.pins)
    while ready := [j for j in waiting
                    if sum(int(body) in placed for body in layout.joint_bodies[j]) == 1]:
        j = ready[0]
        waiting.remove(j)
        inward, outward = (int(body) for body in layout.joint_bodies[j])
        ends, way = (layout.on_a[j], layout.on_b[j]), 1.0
        if inward not in placed:
            inward, outward, ends, way = outward, inward, ends[::-1], -1.0
        joint = layout.mechanism.joints[j]
        assert isinstance(joint, Pin)  # these are pins
        x, y, angle, allowed = placed[inward]
        turned = layout.sense[j] * (a["joint_angle"][:, j] + joint.zero)
        own = angle + way * turned
        hinge = _moved(x, y, angle, ends[0])
        back = _moved(np.zeros_like(x), np.zeros_like(y), own, ends[1])
        found = hinge[0] - back[0], hinge[1] - back[1]
        allowed = allowed + evidence.joint_slack[j] + evidence.shift + ROUNDING
        error = np.hypot(found[0] - frames.x[outward], found[1] - frames.y[outward])
        worst.add(layout.names[outward], error, allowed)
        turn = np.abs(own - frames.angle[outward])
        worst.add(f"angle of {layout.names[outward]}", turn, ROUNDING * (1 + np.abs(own)))
        placed[outward] = (*found, own, allowed)
    return worst.figure(
        name, "m", source=source, none="no body hangs on hinges from a fixed one",
        why="bodies placed from hinge angles, {count} comparisons, worst: {where}; what hinges may "
            "drift in a step, h² ω² r / 2 each, is allowed")


def _moved(x: Array, y: Array, angle: Array, point: Vec) -> tuple[Array, Array]:
    c, s = np.cos(angle), np.sin(angle)
    return x + c * point[0] - s * point[1], y + s * point[0] + c * point[1]


def _tendon_paths(evidence: Evidence) -> Figure:
    """The path through all guides in the recorded poses against the recorded length."""
    worst = Worst()
    mechanism, loads = evidence.layout.mechanism, evidence.loads
    if mechanism.tendons:
        found = lengths(loads.frames, loads.guides, loads.cords)
        recorded = evidence.run.arrays["tendon_length"].T
        for i, tendon in enumerate(mechanism.tendons):
            allowed = ROUNDING + len(tendon.guides) * evidence.shift
            worst.add(tendon.name, np.abs(found[i] - recorded[i]), allowed)
    return worst.figure(
        "tendon.path", "m", source="(17), (19)", none="there is no tendon",
        why="length along all guides in the recorded poses, {count} tendons, worst: {where}")


def _tendon_triangles(evidence: Evidence) -> Figure:
    """Equations (16)-(19): shortening from the hinge angles alone."""
    layout, loads = evidence.layout, evidence.loads
    slack = evidence.joint_slack
    errors: dict[int, Array] = {}
    allowed: dict[int, Array] = {}
    guides = loads.guides
    for row, (tendon, first) in enumerate(zip(guides.tendon, guides.first, strict=True)):
        if guides.radius[first] or guides.radius[first + 1]:
            continue
        ends = [(int(guides.body[k]), (float(guides.at[k, 0]), float(guides.at[k, 1])))
                for k in (first, first + 1)]
        pin = _pin_between(layout, ends[0][0], ends[1][0])
        if pin is None:
            continue
        length = _across(evidence, pin, ends, tendon=True)
        error = length - loads.cords.length[row]
        key = int(tendon)
        errors[key] = errors.get(key, 0.0) + error
        # the recorded length answers for its share of the path, too
        allowed[key] = allowed.get(key, ROUNDING + evidence.shift) + slack[pin] + evidence.shift
    worst = Worst()
    if errors:
        path = lengths(loads.frames, guides, loads.cords)
        recorded = evidence.run.arrays["tendon_length"].T
        for key, error in errors.items():
            total = np.abs(error + path[key] - recorded[key])
            worst.add(layout.mechanism.tendons[key].name, total, allowed[key])
    return worst.figure(
        "tendon.shortening", "m", source="(16)-(19)",
        none="no tendon crosses a hinge by plain eyes",
        why="stretches across hinges from the hinge angles, {count} tendons, worst: {where}; the "
            "drift of each hinge is allowed")


def _spring_triangles(evidence: Evidence) -> Figure:
    """Equations (28)-(30): length from the hinge angle; others from the poses."""
    worst, frames = Worst(), evidence.loads.frames
    for i, spring in enumerate(evidence.layout.mechanism.springs):
        if not isinstance(spring, LinearSpring):
            continue
        number = evidence.layout.number
        ends = [(number[spring.a], spring.on_a), (number[spring.b], spring.on_b)]
        pin = _pin_between(evidence.layout, ends[0][0], ends[1][0])
        allowed = ROUNDING + 2 * evidence.shift
        if pin is None:
            at = [frames.places([body], [point]) for body, point in ends]
            length = np.hypot(at[1].x[0] - at[0].x[0], at[1].y[0] - at[0].y[0])
        else:
            length = _across(evidence, pin, ends, tendon=False)
            allowed = allowed + evidence.joint_slack[pin]
        worst.add(spring.name, np.abs(length - evidence.run.arrays["spring_length"][:, i]), allowed)
    return worst.figure(
        "spring.length", "m", source="(28)-(30)", none="there is no straight spring",
        why="lengths from hinge angles, of springs that cross no hinge from the poses, {count} "
            "springs, worst: {where}")


def _pin_between(layout: Layout, one: int, two: int) -> int | None:
    for j in layout.pins:
        if {one, two} == set(layout.joint_bodies[j].tolist()):
            return j
    return None


def _across(
    evidence: Evidence, pin: int, ends: list[tuple[int, Vec]], *, tendon: bool,
) -> Array:
    """Distance of two points on either side of a hinge, by the cosine rule from its angle, [n].

    Two sides at the hinge never change; the angle between them changes with the hinge's.
    """
    layout = evidence.layout
    a = int(layout.joint_bodies[pin, 0])
    on = {a: layout.on_a[pin], int(layout.joint_bodies[pin, 1]): layout.on_b[pin]}
    sides = {body: np.subtract(point, on[body]) for body, point in ends}
    one, two = (sides.pop(a), *sides.values())
    joint = layout.mechanism.joints[pin]
    assert isinstance(joint, Pin)  # the number is one of the pins
    turned = layout.sense[pin] * (evidence.run.arrays["joint_angle"][:, pin] + joint.zero)
    between = np.arctan2(two[1], two[0]) - np.arctan2(one[1], one[0]) + turned
    folded = np.arccos(np.cos(between))
    rule = segment_length if tendon else spring_length
    lengths_of = float(np.hypot(*one)), float(np.hypot(*two))
    try:
        return np.asarray(rule(lengths_of[0], lengths_of[1], folded))
    except ValueError:  # in line with the hinge, where the closed forms stop
        square = lengths_of[0]**2 + lengths_of[1]**2
        return np.asarray(np.sqrt(square - 2 * lengths_of[0] * lengths_of[1] * np.cos(between)))


def _drift(evidence: Evidence) -> Figure:
    """How far apart the two sides of a joint are, but for ropes, which are free."""
    worst, layout, frames = Worst(), evidence.layout, evidence.loads.frames
    for j, joint in enumerate(layout.mechanism.joints):
        if isinstance(joint, Rope) or not layout.free[layout.joint_bodies[j]].any():
            continue
        gap = frames.gaps[j]
        if isinstance(joint, Slot):
            gap = _across_groove(evidence, j, joint)
        elif isinstance(joint, Rod):
            gap = np.abs(gap - (joint.length if joint.length is not None else gap[0]))
        worst.add(joint.name, gap, evidence.joint_slack[j] + evidence.shift + ROUNDING)
    return worst.figure(
        "joint.drift", "m", source="h² ω² r / 2", none="there is no joint that could drift",
        why="gap between the two sides of {count} joints, worst against what turning on for a step "
            "allows: {where}")


def _across_groove(evidence: Evidence, j: int, joint: Slot) -> Array:
    frames, a = evidence.loads.frames, evidence.layout.joint_bodies[j, 0]
    at = frames.anchors[1]
    gx, gy = np.subtract(joint.end, joint.start) / np.hypot(*np.subtract(joint.end, joint.start))
    dx, dy = at.x[j] - frames.x[a], at.y[j] - frames.y[a]
    c, s = frames.cos[a], frames.sin[a]
    along, across = c * dx + s * dy - joint.start[0], c * dy - s * dx - joint.start[1]
    return np.asarray(np.abs(across * gx - along * gy))


def _stops(evidence: Evidence) -> Figure:
    """How far hinges went beyond their stops, and which stops were touched."""
    a, layout = evidence.run.arrays, evidence.layout
    worst, touched = Worst(), []
    for j in layout.pins:
        joint = layout.mechanism.joints[j]
        if not isinstance(joint, Pin) or joint.limits is None:
            continue
        angle, rate, torque = (a[f"joint_{key}"][:, j] for key in ("angle", "rate", "stop"))
        over = np.maximum(joint.limits[0] - angle, angle - joint.limits[1])
        allowed = STOP_SLOP + evidence.h * float(np.abs(rate).max(initial=0.0))
        worst.add(joint.name, np.maximum(over, 0.0), allowed + evidence.shift / evidence.shortest)
        if (on := np.abs(torque) > 0).any():
            first, most = int(np.argmax(on)), float(np.abs(torque).max())
            began = evidence.run.time[first]
            touched.append(f"{joint.name} from {began:.3g} s, up to {most:.3g} N m")
    told = "; ".join(touched[:4]) + (f" and {len(touched) - 4} more" if len(touched) > 4 else "")
    return worst.figure(
        "stop.overrun", "rad", source="h ω", none="no hinge has stops",
        why=f"{'touched: ' + told if told else 'no stop was touched'}; one step's turn is allowed")

