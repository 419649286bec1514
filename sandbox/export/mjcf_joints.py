"""Joints of a MuJoCo model besides its tree: rods, ropes, loops, and what acts in a hinge."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable, Mapping

from sandbox.export.freedoms import angle_sum, stops
from sandbox.export.mjcf_document import Draft
from sandbox.export.tree import anchors, pose
from sandbox.export.xmltext import add
from sandbox.scene.geometry import Vec

FAR = 1e6
"""No spring is as long as this [m]; MuJoCo wants its ranges closed."""


def add_links(draft: Draft) -> None:
    """Rods and ropes, then the joints that close loops."""
    straight = (joint for joint, kind in enumerate(draft.model.joints.kind) if kind.along_line)
    for joint in (*straight, *draft.tree.loops):
        LINKS[draft.mechanism.joints[joint].type](draft, joint)


def route(draft: Draft, cord: ET.Element, name: str, ends: tuple[tuple[int, Vec], ...]) -> None:
    """Lead a spatial tendon through points of bodies."""
    for i, (body, at) in enumerate(ends):
        add(cord, "site", site=draft.site(body, f"{name}.{i}", at))


def _distance(draft: Draft, joint: int) -> None:
    """A rod, rope or actuator: a tendon of one length, of a length in a range, or of any."""
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


def _connect(draft: Draft, joint: int) -> None:
    _close(draft, joint, "connect", 0.0)


def _weld(draft: Draft, joint: int) -> None:
    a, b = draft.model.joints.bodies[joint].tolist()
    _close(draft, joint, "weld", pose(draft.model, b)[2] - pose(draft.model, a)[2])


def _close(draft: Draft, joint: int, kind: str, angle: float) -> None:
    """An equality constraint between sites; that on ``a`` is turned by ``angle`` [rad]."""
    name = draft.model.joints.name[joint]
    a, b = draft.model.joints.bodies[joint].tolist()
    on_a, on_b = anchors(draft.model, joint)
    more = {"euler": f"0 0 {angle:.12g}"} if angle else {}
    add(draft.sections["equality"], kind, name=name,
        site1=draft.site(a, f"{name}.a", on_a, **more), site2=draft.site(b, f"{name}.b", on_b))


LINKS: Mapping[str, Callable[[Draft, int], None]] = {
    "pin": _connect, "weld": _weld, "rod": _distance, "rope": _distance,
    "actuator": _distance}
"""By kind of joint: writes one that carries no body."""


def hinge_law(draft: Draft, joint: int) -> dict[str, float]:
    """Stiffness, angle at rest, damping and friction of a pin and of all that acts in it.

    Springs side by side are one: k = sum(k_i), rest = sum(k_i rest_i) / k.
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
    """What acts in the pins that close loops: on the sum of the other hinges."""
    for joint in draft.tree.loops:
        if draft.model.joints.angle[joint]:
            _add_closing_angle(draft, joint)


def _add_closing_angle(draft: Draft, joint: int) -> None:
    """Stops, spring, damper, brake and torque; nothing of a pin that has none of them."""
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
