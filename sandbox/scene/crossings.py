"""What crosses a hinge: a stretch of tendon and a spring, as seen from the hinge at rotation 0.

The frames are those of the paper's section 4: x along the straight finger, the
joint closing clockwise, so that a joint that counts counter-clockwise is
mirrored.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from sandbox.elements.controllers import EquilibriumController
from sandbox.elements.element_drives import StiffnessDrive
from sandbox.elements.points import Pin
from sandbox.elements.springs import LinearSpring, Spring
from sandbox.elements.tendons import Guide, Tendon
from sandbox.errors import Problem
from sandbox.scene.bodies import Body
from sandbox.scene.geometry import Vec, anchors, pose_of, to_world
from sandbox.scene.mechanism import Mechanism
from sandbox.wording import NearMisses, listed, quoted


@dataclass(frozen=True)
class Crossing:
    """One hinge with its stretch of tendon and its spring, points from the hinge [m]."""

    guide_before: Vec
    """V_(i-1), in the frame of the body before the hinge."""
    guide_after: Vec
    """V_i, in the frame of the body after it."""
    spring_before: Vec
    """M''."""
    spring_after: Vec
    """M'."""
    rest: float
    """Length of the slack spring [m]."""


class Fingers:
    """What laws of equilibrium are about, by name."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.bodies = {body.name: body for body in mechanism.bodies}
        self.tendons = {tendon.name: tendon for tendon in reversed(mechanism.tendons)}
        self.pins = {joint.name: joint for joint in mechanism.joints if isinstance(joint, Pin)}
        self._springs = {spring.name: spring for spring in reversed(mechanism.springs)}
        self._drives = {drive.name: drive for drive in mechanism.drives}
        self._near = NearMisses()

    def spring_of(self, drive: str) -> Spring | None:
        """The spring whose stiffness a drive sets."""
        found = self._drives.get(drive)
        return (self._springs.get(found.spring)
                if isinstance(found, StiffnessDrive) and found.spring is not None else None)

    def crossings(self, spec: EquilibriumController) -> list[Crossing]:
        """What crosses the joints of a controller that has no :meth:`problems`."""
        found = []
        for name, drive in zip(spec.joints, spec.writes, strict=True):
            pin, spring = self.pins[name], self.spring_of(drive)
            guides = _guides(self.tendons[spec.tendon], pin)
            if guides is None or not isinstance(spring, LinearSpring):
                raise ValueError(f"no guides or no linear spring across {name}")
            found.append(_seen_from(self.bodies, pin, guides, spring))
        return found

    def problems(self, spec: EquilibriumController, path: str) -> Iterator[Problem]:
        """Joints, tendon and springs that are not there, or do not belong to each other."""
        tendons, pins, near = self.tendons, self.pins, self._near
        if spec.tendon not in tendons:
            yield Problem("name-not-found",
                          f"there is no tendon named {quoted(spec.tendon)}", f"{path}.tendon",
                          allowed=listed(tendons) or "none: the scene has no tendons",
                          hint=near(spec.tendon, tendons))
        for i, (name, drive) in enumerate(zip(spec.joints, spec.writes, strict=False)):
            if name not in pins:
                yield Problem("name-not-found",
                              f"there is no hinge named {quoted(name)}", f"{path}.joints[{i}]",
                              allowed=listed(pins) or "none: the scene has no hinges",
                              hint=near(name, pins))
                continue
            guides = _guides(tendons[spec.tendon], pins[name]) if spec.tendon in tendons else ()
            if guides is None or any(guide.radius for guide in guides):
                yield Problem("bad-control-law", f"the tendon {quoted(spec.tendon)} does not run "
                              f"straight from a guide on one side of {quoted(name)} to a guide on "
                              "the other", f"{path}.joints[{i}]")
            spring = self.spring_of(drive)
            if drive in self._drives and (
                    not isinstance(spring, LinearSpring)
                    or {spring.a, spring.b} != {pins[name].a, pins[name].b}):
                yield Problem("bad-control-law", f"{quoted(drive)} does not set the stiffness of a "
                              f"linear spring across {quoted(name)}", f"{path}.writes[{i}]",
                              allowed="a stiffness drive for each joint, in the joints' order")


def _guides(tendon: Tendon, pin: Pin) -> tuple[Guide, Guide] | None:
    """The guides that the tendon runs between across a hinge: before it, after it."""
    for one, other in pairwise(tendon.guides):
        for before, after in ((one, other), (other, one)):
            if (before.body, after.body) == (pin.a, pin.b):
                return before, after
    return None


def _seen_from(
    bodies: Mapping[str, Body], pin: Pin, guides: tuple[Guide, Guide], spring: LinearSpring,
) -> Crossing:
    on_a, on_b = anchors(pin, bodies[pin.a], bodies[pin.b])
    side = 1.0 if pin.positive == "clockwise" else -1.0
    c, s = math.cos(pin.zero), math.sin(pin.zero)

    def before(point: Vec) -> Vec:
        x, y = point[0] - on_a[0], side * (point[1] - on_a[1])
        # at rotation 0 the frame after the hinge is turned by ``zero`` the joint's way
        return c * x - s * y, s * x + c * y

    def after(point: Vec) -> Vec:
        return point[0] - on_b[0], side * (point[1] - on_b[1])

    ends = {spring.a: spring.on_a, spring.b: spring.on_b}
    rest = spring.rest_length
    if rest is None:
        rest = math.dist(*(to_world(pose_of(bodies[name]), at) for name, at in ends.items()))
    return Crossing(before(guides[0].at), after(guides[1].at), before(ends[pin.a]),
                    after(ends[pin.b]), rest)
