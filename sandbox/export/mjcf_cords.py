"""Everything of a MuJoCo model that acts along a line: springs, tendons, rods, ropes."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET

from sandbox.export.freedoms import turn_of
from sandbox.export.mjcf_bodies import hinge_law
from sandbox.export.mjcf_document import Draft
from sandbox.export.wheels import wrap_round
from sandbox.export.xmltext import add, element
from sandbox.scene.elements.drives import PullDrive, TorqueDrive
from sandbox.scene.elements.joints import Pin, Rod, Rope, Weld
from sandbox.scene.elements.springs import LinearSpring
from sandbox.scene.elements.tendons import Tendon
from sandbox.scene.geometry import Vec, anchors, mass_properties

RIGID: float = Tendon.model_fields["stiffness"].default
"""From this stiffness on [N/m], that of a tendon which says nothing of it, a cord is written as
one that does not stretch."""
PART = 0.2
"""The time step is at most this share of 1 / omega of an elastic tendon and its free ends."""
WHEEL = "0.45 0.6 0.75 0.4"
FORCE = 1e6
"""No tension reaches this [N]; MuJoCo wants its ranges closed."""


def add_springs(draft: Draft) -> None:
    """A spatial tendon for each linear spring."""
    for spring in draft.mechanism.springs:
        if not isinstance(spring, LinearSpring):
            continue
        ends = ((spring.a, spring.on_a), (spring.b, spring.on_b))
        rest = spring.rest_length
        if rest is None:
            rest = math.dist(*(draft.world(body, at) for body, at in ends))
        cord = add(draft.sections["tendon"], "spatial", name=spring.name, springlength=rest,
                   stiffness=spring.stiffness or None, damping=spring.damping or None,
                   rgba="0.6 0.6 0.3 1", width=0.0005)
        _route(draft, cord, spring.name, ends)
        draft.sense("tendonpos", f"{spring.name}.length", tendon=spring.name)


def _route(draft: Draft, cord: ET.Element, name: str, ends: tuple[tuple[str, Vec], ...]) -> None:
    for i, (body, at) in enumerate(ends):
        add(cord, "site", site=draft.site(body, f"{name}.{i}", at))


def add_links(draft: Draft) -> None:
    """Rods, ropes, and the joints that close loops."""
    for joint in draft.mechanism.joints:
        if not isinstance(joint, (Rod, Rope)):
            continue
        a, b = draft.bodies[joint.a], draft.bodies[joint.b]
        on_a, on_b = anchors(joint, a, b)
        start = math.dist(draft.world(joint.a, on_a), draft.world(joint.b, on_b))
        low, high = ((joint.shortest, joint.longest) if isinstance(joint, Rope)
                     else (joint.length or start,) * 2)
        stiff = low == high
        cord = add(draft.sections["tendon"], "spatial", name=joint.name,
                   range=None if stiff else (low, high), width=0.0005)
        _route(draft, cord, joint.name, ((joint.a, on_a), (joint.b, on_b)))
        draft.sense("tendonpos", f"{joint.name}.length", tendon=joint.name)
        if stiff:
            add(draft.sections["equality"], "tendon", name=joint.name, tendon1=joint.name,
                polycoef=(high - _length_at_start(draft, joint, on_a, on_b), 0, 0, 0, 0))
        else:
            draft.sense("tendonlimitfrc", f"{joint.name}.reaction", tendon=joint.name)
    for loop in draft.tree.loops:
        if isinstance(loop, (Pin, Weld)):
            _close(draft, loop)
        if isinstance(loop, Pin):
            _turn(draft, loop)


def _length_at_start(draft: Draft, rod: Rod | Rope, on_a: Vec, on_b: Vec) -> float:
    """Of a rod [m] where MuJoCo starts: with the tree's joints assembled."""
    return math.dist(draft.assembled(rod.a, on_a), draft.assembled(rod.b, on_b))


def _close(draft: Draft, joint: Pin | Weld) -> None:
    a, b = draft.bodies[joint.a], draft.bodies[joint.b]
    on_a, on_b = anchors(joint, a, b)
    turn = b.angle - a.angle if isinstance(joint, Weld) else 0.0
    more = {"euler": f"0 0 {turn:.12g}"} if turn else {}
    add(draft.sections["equality"], "weld" if isinstance(joint, Weld) else "connect",
        name=joint.name, site1=draft.site(joint.a, f"{joint.name}.a", on_a, **more),
        site2=draft.site(joint.b, f"{joint.name}.b", on_b))


def _turn(draft: Draft, pin: Pin) -> None:
    """Stops, spring, damper and torque of a pin that closes a loop: on the sum of other hinges."""
    law = hinge_law(draft, pin)
    driven = any(isinstance(d, TorqueDrive) and d.joint == pin.name
                 for d in draft.mechanism.drives)
    turn = turn_of(pin, draft.tree, draft.bodies, draft.moves)
    if not turn.shares or not (law or driven or pin.limits):
        return
    rest = law.pop("springref", None)
    limits = pin.limits
    draft.turns.add(pin.name)
    cord = add(draft.sections["tendon"], "fixed", name=pin.name, **law,
               springlength=None if rest is None else rest - turn.offset,
               range=None if limits is None else tuple(x - turn.offset for x in limits))
    for name, share in turn.shares:
        add(cord, "joint", joint=name, coef=share)


def add_tendons(draft: Draft) -> float:
    """All tendons; the largest time step that the elastic ones allow [s]."""
    pulled = {d.tendon for d in draft.mechanism.drives if isinstance(d, PullDrive)}
    step, stiff = math.inf, []
    for tendon in draft.mechanism.tendons:
        law: dict[str, float | tuple[float, float]] = {}
        if tendon.name not in pulled:
            start = path_length(draft, tendon)
            rest = (start if tendon.rest_length is None else tendon.rest_length) + tendon.slack
            if tendon.stiffness >= RIGID:
                stiff.append(tendon.name)
                law["range"] = (0.0, rest)
                draft.sense("tendonlimitfrc", f"{tendon.name}.tension", tendon=tendon.name)
            else:
                step = min(step, PART / math.sqrt(tendon.stiffness * yielding(draft, tendon)))
                if tendon.damping:
                    _pulling_only(draft, tendon, rest)
                else:
                    law["stiffness"], law["springlength"] = tendon.stiffness, (0.0, rest)
        cord = add(draft.sections["tendon"], "spatial", name=tendon.name, width=0.0005,
                   rgba="0.75 0.25 0.2 1", **law)
        _thread(draft, cord, tendon)
        draft.sense("tendonpos", f"{tendon.name}.length", tendon=tendon.name)
    if stiff:
        draft.notes.append(
            f"tendons of {RIGID:g} N/m and more do not stretch here: {', '.join(stiff)}")
    return step


def _pulling_only(draft: Draft, tendon: Tendon, rest: float) -> None:
    """T = max(k (L - L0) + c L', 0): a damper in a spring would push when the cord is slack.

    The actuator counts its length as -L, so that its force is T.
    """
    add(draft.sections["actuator"], "general", name=tendon.name, tendon=tendon.name, gear=-1.0,
        gainprm=0.0, biastype="affine",
        biasprm=(-tendon.stiffness * rest, -tendon.stiffness, -tendon.damping),
        ctrlrange=(0.0, 1.0), forcerange=(0.0, FORCE))
    draft.sense("actuatorfrc", f"{tendon.name}.tension", actuator=tendon.name)


def _points(draft: Draft, tendon: Tendon) -> list[Vec]:
    return [draft.world(guide.body, guide.at) for guide in tendon.guides]


def _thread(draft: Draft, cord: ET.Element, tendon: Tendon) -> None:
    points = _points(draft, tendon)
    for i, guide in enumerate(tendon.guides):
        name = f"{tendon.name}.{i}"
        if not guide.radius:
            add(cord, "site", site=draft.site(guide.body, name, guide.at))
            continue
        wrap = wrap_round(points[i - 1], points[i], points[i + 1], guide)
        assert wrap is not None  # refused before
        middle = wrap.middle - draft.bodies[guide.body].angle
        beside = (guide.at[0] + 1.5 * guide.radius * math.cos(middle),
                  guide.at[1] + 1.5 * guide.radius * math.sin(middle))
        wheel = draft.names.made("geom", name)
        draft.held[guide.body].append(element(
            "geom", name=wheel, type="cylinder", size=(guide.radius, guide.radius / 4),
            pos=(*guide.at, 0.0), rgba=WHEEL))
        add(cord, "geom", geom=wheel, sidesite=draft.site(guide.body, f"{name}.side", beside))
        draft.notes.append(
            f"{tendon.name}: MuJoCo lets the cord lift off its wheel on {guide.body!r}")


def path_length(draft: Draft, tendon: Tendon) -> float:
    """Of a tendon at t = 0 [m]; its wheels stand between eyes."""
    points = _points(draft, tendon)
    length, place = 0.0, points[0]
    for i, guide in enumerate(tendon.guides[1:], start=1):
        if not guide.radius:
            length += math.dist(place, points[i])
            place = points[i]
            continue
        wrap = wrap_round(points[i - 1], points[i], points[i + 1], guide)
        assert wrap is not None  # refused before
        length += math.dist(place, wrap.on) + guide.radius * wrap.angle
        place = wrap.off
    return length


def yielding(draft: Draft, tendon: Tendon) -> float:
    """J M^-1 J^T of a tendon [1/kg], its bodies taken as free, wheels as eyes."""
    points = _points(draft, tendon)
    pulls: dict[str, list[float]] = {}
    for i, guide in enumerate(tendon.guides):
        body = draft.bodies[guide.body]
        if body.motion != "dynamic":
            continue
        row = pulls.setdefault(guide.body, [0.0, 0.0, 0.0])
        centre = draft.world(body.name, mass_properties(body).centre)
        for other in points[max(i - 1, 0):i] + points[i + 1:i + 2]:
            length = math.dist(points[i], other) or math.inf
            ux, uy = (points[i][0] - other[0]) / length, (points[i][1] - other[1]) / length
            row[0] += ux
            row[1] += uy
            row[2] += (points[i][0] - centre[0]) * uy - (points[i][1] - centre[1]) * ux
    total = 0.0
    for name, (x, y, turn) in pulls.items():
        own = mass_properties(draft.bodies[name])
        total += (x * x + y * y) / own.mass + turn * turn / own.inertia
    return total or 1e-12
