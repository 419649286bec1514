"""Looks a mechanism over before it runs: what a simulation would do, but its author hardly meant.

Everything is judged at t = 0, from the mechanism alone; nothing is stepped.

- **Assembly**: joints whose anchors do not meet, bodies that lie in each other.
- **Step**: a spring of stiffness k between two bodies vibrates with
  w = sqrt(k s), s the response of the two to a unit push (1/m_a + 1/m_b for
  two points); a leapfrog of step h follows it while h w < 2 and is off by
  (h w)^2 / 24 in frequency. A damper c settles in 1 / (c s). Of the joints
  only a hinge between the two is counted: the others could only make the
  response smaller. Tendons are solved at the step's end and are not bound.
- **Over centre**: a straight spring across a hinge C has no arm when its ends
  and C are in line with C between; beyond, it turns the hinge the other way
  (rho_0 + w_0 of equations (22)-(23)).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import pymunk

from sandbox.engine.clock import make_clock
from sandbox.engine.contact_rules import allowed_pairs
from sandbox.engine.inspect_control import beyond_stops, control_problems
from sandbox.engine.inspect_drives import largest_stiffness
from sandbox.engine.world import make_shape
from sandbox.errors import Problem
from sandbox.model.catalogue import check_quantities
from sandbox.model.compile import compile_mechanism
from sandbox.scene.elements.bodies import Body, Box, Circle, Polygon, Shape
from sandbox.scene.elements.drives import ForceDrive, PullDrive, TorqueDrive
from sandbox.scene.elements.joints import Joint, Pin, Rod, Slot, Weld
from sandbox.scene.elements.springs import LinearSpring
from sandbox.scene.geometry import (
    Vec,
    anchors,
    corners,
    joint_angle_sign,
    mass_properties,
    pose_of,
    to_body,
    to_world,
)
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.values.signals import values

UNSTABLE = 2.0
"""h w at which a leapfrog blows up."""
COARSE = 0.5
"""h w at which the frequency is 1 % off: (0.5)^2 / 24."""
OVERDAMPED = 5.0
"""Step over a damper's settling time beyond which the step hides the motion."""
NEGLIGIBLE = 1e-5
"""Gaps and overlaps up to this [m] are what a scene written in hundredths of a mm may have."""
STRAIGHT = 1e-9
"""Two points nearer than this are one [m]."""


def inspect(mechanism: Mechanism) -> list[Problem]:
    """All that is to be said of ``mechanism``, errors first, otherwise in its elements' order.

    Paths are those of the mechanism; what belongs to an element is told by its name.
    """
    bodies = {body.name: body for body in mechanism.bodies}
    problems = [
        *_joints(mechanism, bodies), *_overlaps(mechanism), *_tendons(mechanism, bodies),
        *_strength(mechanism, bodies), *_straight(mechanism, bodies), *_drives(mechanism, bodies),
        *_paths(mechanism), *check_quantities(mechanism), *control_problems(mechanism),
        *beyond_stops(mechanism), *_sampling(mechanism), *_window(mechanism),
    ]
    return sorted(problems, key=lambda problem: problem.severity != "error")


def _error(path: str, element: str, message: str, advice: str, *, blocks: bool = False) -> Problem:
    return Problem(message, path, element=element, advice=advice, blocks=blocks)


def _warning(path: str, element: str, message: str, advice: str = "") -> Problem:
    return Problem(message, path, element=element, advice=advice, severity="warning",
                   blocks=False)


def _mm(length: float) -> str:
    return f"{length * 1e3:.4g} mm"


def _deg(angle: float) -> str:
    return f"{math.degrees(angle):.4g} deg"


# --- joints


def _joints(mechanism: Mechanism, bodies: dict[str, Body]) -> Iterator[Problem]:
    for i, joint in enumerate(mechanism.joints):
        path = f"$.joints[{i}]"
        a, b = bodies[joint.a], bodies[joint.b]
        on_a, on_b = anchors(joint, a, b)
        at_a, at_b = to_world(pose_of(a), on_a), to_world(pose_of(b), on_b)
        if message := _apart(joint, a, at_a, at_b, max(mechanism.run.slop, NEGLIGIBLE)):
            yield _error(path, joint.name, f"not assembled at t = 0: {message}",
                         "move a body or an anchor, or leave one anchor out")
        if isinstance(joint, Pin) and joint.limits is not None:
            angle = joint_angle_sign(joint) * (b.angle - a.angle) - joint.zero
            low, high = joint.limits
            if not low - 1e-9 <= angle <= high + 1e-9:
                yield _error(
                    path, joint.name, f"starts at {_deg(angle)}, outside its limits "
                    f"[{_deg(low)}, {_deg(high)}]", "turn a body, or set 'zero'")


def _apart(joint: Joint, a: Body, at_a: Vec, at_b: Vec, slop: float) -> str:
    """How a joint's anchors contradict it at t = 0; empty when they do not."""
    distance = math.dist(at_a, at_b)
    if isinstance(joint, (Pin, Weld)):
        return f"its anchors are {_mm(distance)} apart" if distance > slop else ""
    if isinstance(joint, Slot):
        off = _from_segment(to_body(pose_of(a), at_b), joint.start, joint.end)
        return f"its point is {_mm(off)} off the groove" if off > slop else ""
    if isinstance(joint, Rod):
        length = distance if joint.length is None else joint.length
        off = abs(distance - length)
        return (f"its ends are {_mm(distance)} apart, its length is {_mm(length)}"
                if off > slop else "")
    if not joint.shortest - slop <= distance <= joint.longest + slop:
        return (f"its ends are {_mm(distance)} apart, it allows {_mm(joint.shortest)} "
                f"to {_mm(joint.longest)}")
    return ""


def _from_segment(point: Vec, start: Vec, end: Vec) -> float:
    """Distance [m] of a point from a segment."""
    along = (end[0] - start[0], end[1] - start[1])
    square = along[0] ** 2 + along[1] ** 2
    share = 0.0
    if square:
        share = ((point[0] - start[0]) * along[0] + (point[1] - start[1]) * along[1]) / square
        share = min(max(share, 0.0), 1.0)
    return math.dist(point, (start[0] + share * along[0], start[1] + share * along[1]))


# --- overlapping bodies


def _overlaps(mechanism: Mechanism) -> Iterator[Problem]:
    """Pairs that may touch and are deeper in each other than the slop."""
    allowed = allowed_pairs(compile_mechanism(mechanism))
    space = pymunk.Space()
    owner: dict[pymunk.Shape, int] = {}
    for i, body in enumerate(mechanism.bodies):
        holder = pymunk.Body(body_type=pymunk.Body.STATIC)
        holder.position, holder.angle = body.at, body.angle
        space.add(holder)
        for shape in body.shapes:
            solid = make_shape(holder, shape, (0.0, 0.0))
            space.add(solid)
            owner[solid] = i
    depths: dict[tuple[int, int], float] = {}
    for solid, i in owner.items():
        if mechanism.bodies[i].motion == "fixed":
            continue
        for hit in space.shape_query(solid):
            j = owner[hit.shape] if hit.shape is not None else i
            if not allowed[i, j]:
                continue
            depth = max((-p.distance for p in hit.contact_point_set.points), default=0.0)
            pair = (min(i, j), max(i, j))
            depths[pair] = max(depth, depths.get(pair, 0.0))
    for (i, j), depth in sorted(depths.items()):
        if depth > max(mechanism.run.slop, NEGLIGIBLE):
            first, second = mechanism.bodies[i].name, mechanism.bodies[j].name
            yield _error(f"$.bodies[{i}]", first,
                         f"overlaps {second!r} by {_mm(depth)} at t = 0",
                         "move one of them, or add a contact rule with \"collide\": false")


# --- tendons


def _tendons(mechanism: Mechanism, bodies: dict[str, Body]) -> Iterator[Problem]:
    for i, tendon in enumerate(mechanism.tendons):
        path = f"$.tendons[{i}]"
        points = [to_world(pose_of(bodies[g.body]), g.at) for g in tendon.guides]
        for k, (p, q) in enumerate(itertools.pairwise(points)):
            first, second = tendon.guides[k], tendon.guides[k + 1]
            gap = math.dist(p, q)
            reach = (first.radius + second.radius if first.side != second.side
                     else abs(first.radius - second.radius))
            if gap < STRAIGHT:
                yield _error(path, tendon.name, f"its guides {k} and {k + 1} coincide",
                             "move one of them: the cord between has no direction", blocks=True)
            elif gap < reach:
                yield _error(
                    path, tendon.name, f"the wheels of its guides {k} and {k + 1} are "
                    f"{_mm(gap)} apart, the cord between them needs {_mm(reach)}",
                    "move one of them, or make it smaller", blocks=True)
        if all(bodies[g.body].motion != "dynamic" for g in tendon.guides):
            yield _warning(path, tendon.name, "passes no body that can move freely",
                           "it pulls on nothing")


# --- springs


@dataclass(frozen=True)
class _Push:
    """A force [N] at a point of the world, or a torque [N m], on a body."""

    body: Body
    point: Vec = (0.0, 0.0)
    force: Vec = (0.0, 0.0)
    torque: float = 0.0


def _softness(first: _Push, second: _Push, hinge: Vec | None) -> float:
    """How far two opposite pushes set their points in motion: l^T W l [1/kg or 1/(kg m^2)].

    W is the inverse mass matrix of the two bodies, less what a hinge between
    them at ``hinge`` takes from it: W - W J^T (J W J^T)^-1 J W.
    """
    free, slip = 0.0, [0.0, 0.0]
    xx = xy = yy = 0.0
    for push, sign in ((first, 1.0), (second, -1.0)):
        if push.body.motion != "dynamic":
            continue
        weight = mass_properties(push.body)
        m, i, (fx, fy) = weight.mass, weight.inertia, push.force
        cx, cy = to_world(pose_of(push.body), weight.centre)
        spin = push.torque + (push.point[0] - cx) * fy - (push.point[1] - cy) * fx
        free += (fx**2 + fy**2) / m + spin**2 / i
        if hinge is not None:
            dx, dy = hinge[0] - cx, hinge[1] - cy
            slip[0] += sign * (fx / m - dy * spin / i)
            slip[1] += sign * (fy / m + dx * spin / i)
            xx, xy, yy = xx + 1 / m + dy**2 / i, xy - dx * dy / i, yy + 1 / m + dx**2 / i
    if hinge is None or not free:
        return free
    x, y = slip
    return max(free - (yy * x * x - 2 * xy * x * y + xx * y * y) / (xx * yy - xy * xy), 0.0)


def _hinge_softness(pin: Pin, bodies: dict[str, Body]) -> float:
    a, b = bodies[pin.a], bodies[pin.b]
    at = to_world(pose_of(a), anchors(pin, a, b)[0])
    return _softness(_Push(a, torque=-1.0), _Push(b, torque=1.0), at)


def _straight_softness(spring: LinearSpring, pin: Pin | None, bodies: dict[str, Body]) -> float:
    a, b = bodies[spring.a], bodies[spring.b]
    p, q = to_world(pose_of(a), spring.on_a), to_world(pose_of(b), spring.on_b)
    length = math.dist(p, q)
    ux, uy = ((q[0] - p[0]) / length, (q[1] - p[1]) / length) if length > STRAIGHT else (1.0, 0.0)
    at = None
    if pin is not None:
        first, second = bodies[pin.a], bodies[pin.b]
        at = to_world(pose_of(first), anchors(pin, first, second)[0])
    return _softness(_Push(a, p, (ux, uy)), _Push(b, q, (-ux, -uy)), at)


def _strength(mechanism: Mechanism, bodies: dict[str, Body]) -> Iterator[Problem]:
    """Springs and dampers, those of hinges too, against the step."""
    h = mechanism.run.step
    pins = {joint.name: joint for joint in mechanism.joints if isinstance(joint, Pin)}
    across = {frozenset((pin.a, pin.b)): pin for pin in pins.values()}
    elements: list[tuple[str, str, float, float, float]] = []
    driven = largest_stiffness(mechanism)
    for i, spring in enumerate(mechanism.springs):
        if isinstance(spring, LinearSpring):
            pin = across.get(frozenset((spring.a, spring.b)))
            softness = _straight_softness(spring, pin, bodies)
        else:
            softness = _hinge_softness(pins[spring.joint], bodies)
        k = driven.get(spring.name, spring.stiffness)
        elements.append((f"$.springs[{i}]", spring.name, max(k, 0.0), spring.damping, softness))
    for i, hinge in enumerate(mechanism.joints):
        if isinstance(hinge, Pin):
            softness = _hinge_softness(hinge, bodies)
            elements.append((f"$.joints[{i}]", hinge.name, 0.0, hinge.damping, softness))
    for path, name, k, c, softness in elements:
        pace, rate = math.sqrt(k * softness), c * softness
        if h * pace > UNSTABLE:
            yield _warning(path, name, f"too stiff for the step: h w = {h * pace:.3g}, the "
                           f"simulation may blow up above {UNSTABLE:g}",
                           f"a step of {COARSE / pace:.2g} s would do")
        elif h * pace > COARSE:
            yield _warning(path, name, f"stiff for the step: h w = {h * pace:.3g}, its "
                           f"vibration is over {100 * COARSE**2 / 24:.0f} % off above {COARSE:g}",
                           f"a step of {COARSE / pace:.2g} s would do")
        if h * rate > OVERDAMPED:
            yield _warning(path, name, "the damper is too strong for the step: alone it "
                           f"would settle in {1 / rate:.2g} s, the step is {h:.2g} s",
                           f"a step of {OVERDAMPED / rate:.2g} s would do")


def _straight(mechanism: Mechanism, bodies: dict[str, Body]) -> Iterator[Problem]:
    """Straight springs without a direction, or that can snap over a hinge's centre."""
    pins = {frozenset((joint.a, joint.b)): joint
            for joint in mechanism.joints if isinstance(joint, Pin)}
    for i, spring in enumerate(mechanism.springs):
        if not isinstance(spring, LinearSpring) or spring.a == spring.b:
            continue
        at = [to_world(pose_of(bodies[name]), point)
              for name, point in ((spring.a, spring.on_a), (spring.b, spring.on_b))]
        if math.dist(*at) < STRAIGHT and spring.rest_length:
            yield _warning(f"$.springs[{i}]", spring.name, "its ends coincide at t = 0",
                           "it pushes in no direction until they part")
        pin = pins.get(frozenset((spring.a, spring.b)))
        if pin is not None and (angle := over_centre(spring, pin, bodies)) is not None:
            bound = "the hinge has no limits" if pin.limits is None else "within its limits"
            yield _warning(f"$.springs[{i}]", spring.name,
                           f"snaps over the centre of {pin.name!r} at {_deg(angle)} ({bound})",
                           "limit the hinge below that, or move the spring's ends")


def over_centre(spring: LinearSpring, pin: Pin, bodies: dict[str, Body]) -> float | None:
    """The hinge's angle [rad] at which a straight spring across it is stretched over its centre.

    The one nearest to the start, if the hinge's limits let it get there; None
    otherwise, or when an end lies on the hinge.
    """
    a, b = bodies[pin.a], bodies[pin.b]
    hinge = to_world(pose_of(a), anchors(pin, a, b)[0])
    ends = {spring.a: spring.on_a, spring.b: spring.on_b}
    turned = []
    for body in (a, b):
        x, y = to_world(pose_of(body), ends[body.name])
        if math.dist((x, y), hinge) < STRAIGHT:
            return None
        turned.append(math.atan2(y - hinge[1], x - hinge[0]))
    sign = joint_angle_sign(pin)
    start = sign * (b.angle - a.angle) - pin.zero
    nearest = start + sign * (math.pi - (turned[1] - turned[0]))
    low, high = pin.limits or (-math.inf, math.inf)
    angles = [angle for k in (-2, -1, 0, 1, 2) if low < (angle := nearest + 2 * math.pi * k) < high]
    return min(angles, key=lambda angle: abs(angle - start), default=None)


# --- drives, quantities, sampling, picture


def _drives(mechanism: Mechanism, bodies: dict[str, Body]) -> Iterator[Problem]:
    guides = {tendon.name: [g.body for g in tendon.guides] for tendon in mechanism.tendons}
    ends = {joint.name: [joint.a, joint.b] for joint in mechanism.joints}
    for i, drive in enumerate(mechanism.drives):
        moved: list[str] = []
        if isinstance(drive, ForceDrive):
            moved = [drive.body]
        elif isinstance(drive, TorqueDrive):
            moved = ends.get(drive.joint, [])
        elif isinstance(drive, PullDrive):
            moved = guides.get(drive.tendon, [])
        if moved and all(bodies[name].motion != "dynamic" for name in moved):
            yield _warning(f"$.drives[{i}]", drive.name,
                           f"acts on {moved[0]!r}, which cannot move freely", "it changes nothing")


def _paths(mechanism: Mechanism) -> Iterator[Problem]:
    """Scheduled bodies that are elsewhere at t = 0 than their path says."""
    for i, body in enumerate(mechanism.bodies):
        if body.path is None:
            continue
        for axis, start, show in (("x", body.at[0], _mm), ("y", body.at[1], _mm),
                                  ("angle", body.angle, _deg)):
            signal = getattr(body.path, axis)
            if signal is None:
                continue
            first = float(values(signal, np.zeros(1))[0])
            if abs(first - start) > max(mechanism.run.slop, NEGLIGIBLE):
                yield _warning(
                    f"$.bodies[{i}].path.{axis}", body.name,
                    f"begins at {axis} = {show(start)}, its path at {show(first)}: it jumps there "
                    "in the first step",
                    "let 'at' and 'angle' be where the path begins")


def _sampling(mechanism: Mechanism) -> Iterator[Problem]:
    run = mechanism.run
    clock = make_clock(run.duration, run.step, run.sample_rate)
    actual = 1 / (clock.every * run.step)
    if abs(actual - run.sample_rate) > 1e-6 * run.sample_rate:
        yield _warning("$.run", "run", f"the step {run.step:g} s does not divide the sampling "
                       f"interval {1 / run.sample_rate:g} s",
                       f"samples come at {actual:.6g} Hz instead of {run.sample_rate:g} Hz")
    if run.duration < run.step:
        yield _warning("$.run", "run", f"the duration {run.duration:g} s is shorter than a step",
                       "one step is made")


def _window(mechanism: Mechanism) -> Iterator[Problem]:
    view = mechanism.view
    if view.start >= mechanism.run.duration:
        yield _warning("$.view", "view", f"starts at {view.start:g} s, after the end of the run")
    if view.centre is None or view.width is None or not mechanism.bodies:
        return
    half = (view.width / 2, view.width / 2 * view.size[1] / view.size[0])
    for body in mechanism.bodies:
        points = [to_world(pose_of(body), p) for shape in body.shapes for p in _outline(shape)]
        low = [min(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        high = [max(p[k] for p in points or [body.at]) - view.centre[k] for k in (0, 1)]
        if all(low[k] <= half[k] and high[k] >= -half[k] for k in (0, 1)):
            return
    yield _warning("$.view", "view", "no body lies in the window at t = 0",
                   "leave 'centre' or 'width' out to have it fitted")


def _outline(shape: Shape) -> list[Vec]:
    """Points whose bounds hold the shape, in the body's frame."""
    if isinstance(shape, (Box, Polygon)):
        return corners(shape)
    centres = [shape.at] if isinstance(shape, Circle) else [shape.start, shape.end]
    r = shape.radius
    return [(x + dx, y + dy) for x, y in centres for dx in (-r, r) for dy in (-r, r)]
