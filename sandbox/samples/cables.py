"""Points of bodies and tendons in recorded poses: stretches between guides, lengths along them.

A guide is a circle of radius r >= 0, an eye has r = 0. Along a direction u with left normal n, a
wheel whose centre is right of the path has s = +1, left s = -1; the tendon touches it at c + s r n,
and n . (c2 - c1) = s1 r1 - s2 r2 for a stretch. On a wheel between two stretches lies r times the
angle of wrap; one at an end winds the tendon up as it turns. Where a tendon is off a wheel, both
stretches beside it are halves of the straight way past it.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from sandbox.elements.element import GRAZE
from sandbox.model.joints import Place, place_in_slot
from sandbox.model.model import Model, Tendons
from sandbox.numeric import Array, Flags, Integers
from sandbox.scene.geometry import Vec


class Places(NamedTuple):
    """Points of bodies over time, all [k, n] in m."""

    x: Array  # In the world
    y: Array
    arm_x: Array  # From the body's centre of mass, along the world's axes
    arm_y: Array


class Frames:
    """Poses of all bodies in some samples of a recording, and points of theirs."""

    def __init__(self, model: Model, arrays: Mapping[str, Array]) -> None:
        self.model, self.arrays = model, arrays
        self.pose, self.velocity, self.acceleration = (
            np.ascontiguousarray(arrays[f"body_{key}"].transpose(2, 1, 0))
            for key in ("pose", "velocity", "acceleration"))
        """Of the bodies' frames, and of their centres of mass, [3, nb, n] m, m, rad."""
        x, y, angle = self.pose
        self.samples = x.shape[1]
        c, s = self.cos, self.sin = np.cos(angle), np.sin(angle)
        self._centre = local = arrays["body_centre"]
        self.centre = np.stack([x + c * local[:, :1] - s * local[:, 1:],
                                y + s * local[:, :1] + c * local[:, 1:], angle])
        """Poses of the centres of mass, [3, nb, n] m, m, rad."""
        self.off_wheels: Flags = arrays["guide_lifted"] > 0  # Tendons off their wheels, [n, nw]

    @classmethod
    def at_start(cls, model: Model) -> Frames:
        """The poses at t = 0 as the scene gives them, a single sample at rest."""
        rest = np.zeros((1, len(model.bodies.name), 3))
        return cls(model, {
            "body_pose": model.bodies.pose[None], "body_velocity": rest, "body_acceleration": rest,
            "body_centre": model.bodies.centre,
            "guide_lifted": lifted_at_start(model)[None, model.tendons.wheels].astype(np.float64)})

    def places(self, bodies: Integers | Sequence[int], points: Array) -> Places:
        """Points given in the frames of ``bodies`` [k], as [k, 2] m."""
        on = np.asarray(bodies, dtype=np.int64)
        local = points.reshape(-1, 2) - self._centre[on]
        c, s = self.cos[on], self.sin[on]
        arm_x = c * local[:, :1] - s * local[:, 1:]
        arm_y = s * local[:, :1] + c * local[:, 1:]
        return Places(self.centre[0, on] + arm_x, self.centre[1, on] + arm_y, arm_x, arm_y)

    @cached_property
    def anchors(self) -> tuple[Places, Places]:
        """Anchors of all joints, on ``a`` and on ``b``, [nj, n]."""
        joints = self.model.joints
        return (self.places(joints.bodies[:, 0], joints.anchor[:, 0]),
                self.places(joints.bodies[:, 1], joints.anchor[:, 1]))

    def place_in_slot(self, joint: int) -> Place:
        """The place of a slot's point along its groove or path, [n] each."""
        a = self.arrays
        return place_in_slot(self.model, joint, a["body_pose"], a["joint_length"][:, joint])

    @cached_property
    def guides(self) -> Places:
        """The centres of all guides of tendons, [ng, n]."""
        return self.places(self.model.tendons.guide_body, self.model.tendons.guide_at)

    @cached_property
    def ends(self) -> tuple[Integers, Integers]:
        """The guides that each piece of a tendon is straight between, past wheels, [m, n] each."""
        tendons = self.model.tendons
        on = np.ones((len(tendons.guide_body), self.samples), dtype=bool)
        on[tendons.wheels] = ~self.off_wheels.T
        number = np.arange(len(on))[:, None]
        before = np.maximum.accumulate(np.where(on, number, 0), axis=0)
        after = np.minimum.accumulate(np.where(on, number, len(on))[::-1], axis=0)[::-1]
        return before[tendons.stretch_first], after[tendons.stretch_first + 1]

    @cached_property
    def cables(self) -> Stretches:
        """The straight pieces of all tendons."""
        (before, after), radius = self.ends, self.model.tendons.guide_radius
        dx, dy = (at[after, np.arange(self.samples)] - at[before, np.arange(self.samples)]
                  for at in self.guides[:2])
        length, x, y = _tangent(dx, dy, radius[before] - radius[after])
        first = self.model.tendons.stretch_first
        start, end = (Places(*(part[k] for part in self.guides)) for k in (first, first + 1))
        return Stretches(length / (after - before), x, y, start, end)

    @cached_property
    def first(self) -> Frames:
        """The poses at t = 0."""
        return Frames.at_start(self.model)

    @cached_property
    def lengths(self) -> Array:
        """Length of every tendon along its path [m], [nt, n]; turns are counted from t = 0."""
        tendons = self.model.tendons
        total = np.zeros((len(tendons.name), self.samples))
        np.add.at(total, tendons.stretch_tendon, self.cables.length)
        for tendon in range(len(tendons.name)):
            if not tendons.guide_radius[tendons.guides(tendon)].any():
                continue
            course, on_wheels = _Course(self, tendon), np.zeros(self.samples)
            for place in np.flatnonzero(course.radii).tolist():
                if place or not course.closed:  # else it comes last again
                    on_wheels += course.on_wheel(place)[1:]
            total[tendon] += on_wheels
        return total

    @cached_property
    def gaps(self) -> Array:
        """Between the two anchors of every joint [m], [nj, n]."""
        a, b = self.anchors
        return np.hypot(b.x - a.x, b.y - a.y)


class Stretches(NamedTuple):
    """Straight pieces of all tendons, [m, n], in the order of the model's ``tendons``."""

    length: Array  # [m]; past wheels the way is shared out evenly
    x: Array  # Unit vector along it
    y: Array
    start: Places  # The guides' centres where the stretches begin and end
    end: Places


def _tangent(dx: Array, dy: Array, offset: Array | float) -> tuple[Array, Array, Array]:
    """Length and direction of a stretch between wheels that far apart, of radii that differ so."""
    square = dx * dx + dy * dy
    length = np.sqrt(np.maximum(square - offset * offset, 1e-24))
    square = length * length + offset * offset
    return length, (length * dx + offset * dy) / square, (length * dy - offset * dx) / square


class CableSpan(NamedTuple):
    """A piece of a tendon from one guide that holds it to the next, or to an end."""

    tendon: int
    guides: tuple[int, ...]  # numbers in order; the first and the last one hold it, or are ends
    into: int  # which of Tendons.grips feeds it; -1 at an end
    out_of: int  # which of them takes from it; -1 at an end


def spans_of(tendons: Tendons, tendon: int) -> list[CableSpan]:
    """The spans of a tendon in its order, of a loop from its first guide that holds it; or none."""
    grips = tendons.gripped(tendon).tolist()
    if not grips:
        return []
    path, held = tendons.guides(tendon), tendons.grips[grips].tolist()
    marks = list(zip(held, grips, strict=True))
    if not tendons.closed[tendon]:
        marks = [(path.start, -1), *marks, (path.stop - 1, -1)]
    spans = [CableSpan(tendon, tuple(range(a, b + 1)), into, out_of)
             for (a, into), (b, out_of) in itertools.pairwise(marks)]
    if tendons.closed[tendon]:
        on = (*range(held[-1], path.stop - 1), *range(path.start, held[0] + 1))
        spans.append(CableSpan(tendon, on, grips[-1], grips[0]))
    return spans


def lifted_at_start(model: Model) -> Flags:
    """Of every guide whether its tendon is off it at t = 0, [ng].

    By default it is off a wheel that is clear of the straight path, a loop is on its wheels.
    """
    tendons = model.tendons
    off = np.zeros(len(tendons.guide_body), dtype=bool)
    for tendon in range(len(tendons.name)):
        path, guides = tendons.guides(tendon), model.mechanism.tendons[tendon].guides
        default = "on" if tendons.closed[tendon] else "off"
        loose = [g for g in tendons.wheels[tendons.loose(tendon)].tolist()
                 if (guides[g - path.start].begins or default) == "off"]
        at = {g: model.at_start(tendons.guide_body[g], tendons.guide_at[g])
              for g in range(path.start, path.stop)} if loose else {}
        found = True
        while found:
            found = False
            for wheel in loose:
                before = max(g for g in range(path.start, wheel) if not off[g])
                after = min(g for g in range(wheel + 1, path.stop) if not off[g])
                three = [before, wheel, after]
                if not off[wheel] and passes_by(
                        [at[g] for g in three], tendons.guide_radius[three].tolist()
                        ) > GRAZE * abs(tendons.guide_radius[wheel]):
                    off[wheel] = found = True
    return off


def passes_by(centres: list[Vec], radii: Sequence[float]) -> float:
    """Gap of a tendon of two wheels and one between them [m], < 0 where it bends; signed radii."""
    (ax, ay), (cx, cy), (bx, by) = centres
    dx, dy, offset = bx - ax, by - ay, radii[0] - radii[2]
    square = dx * dx + dy * dy
    if square <= offset * offset:
        return -math.inf
    straight = math.sqrt(square - offset * offset)
    ux, uy = (straight * dx + offset * dy) / square, (straight * dy - offset * dx) / square
    across = ux * (cy - ay) - uy * (cx - ax) - radii[0]
    return float(-math.copysign(1.0, radii[1]) * across - abs(radii[1]))


class _Course:
    """One tendon at t = 0 and in all samples, [1 + n]."""

    def __init__(self, frames: Frames, tendon: int) -> None:
        self.frames, self.tendons = frames, frames.model.tendons
        self.path = self.tendons.guides(tendon)
        self.closed = bool(self.tendons.closed[tendon])
        self.radii = self.tendons.guide_radius[self.path].tolist()
        self.own = np.flatnonzero(self.tendons.stretch_tendon == tendon)
        both = [each.cables for each in (frames.first, frames)]
        self.length = np.concatenate([each.length[self.own] for each in both], axis=1)
        """Of its stretches [m], [stretches, 1 + n]."""
        self.angle = np.concatenate(
            [np.arctan2(each.x[self.own], -each.y[self.own]) for each in both], axis=1)
        """Of their left normals [rad]."""

    def inner(self, place: int) -> bool:
        """Whether the tendon passes the guide at a place, and does not end there."""
        return self.closed or 0 < place < len(self.own)

    def wrap(self, place: int) -> Array:
        """The angle by which the tendon lies on an inner wheel [rad], [1 + n]."""
        wrap = np.sign(self.radii[place]) * (
            self.angle[place - 1] - self.angle[place % len(self.angle)])
        turns = int(self.tendons.guide_turns[self.path.start + place])
        wrap[0] = (wrap[0] + GRAZE) % (2 * np.pi) - GRAZE + 2 * np.pi * turns
        return np.unwrap(wrap)

    def wound(self, place: int, piece: int, sign: float) -> Array:
        """Length that a wheel at an end of some pieces has wound up since t = 0 [m], [1 + n]."""
        frames, body = self.frames, int(self.tendons.guide_body[self.path.start + place])
        angle = np.unwrap(self.angle[piece]) - np.append(
            frames.first.pose[2, body], frames.pose[2, body])
        return np.asarray(sign * self.radii[place] * (angle - angle[0]))

    def on_wheel(self, place: int) -> Array:
        """Length on the wheel at a place [m], at an end the length wound up, [1 + n]."""
        if self.inner(place):
            return np.asarray(abs(self.radii[place]) * self.wrap(place))
        return self.wound(place, -1 if place else 0, 1.0 if place else -1.0)


def _tendon_of(tendons: Tendons, guide: int) -> int:
    return int(np.searchsorted(tendons.first, guide, side="right")) - 1


def bends(frames: Frames, grip: int) -> Array:
    """By how much a tendon bends at a guide with friction [rad], [n]; below 0 off its wheel."""
    tendons = frames.model.tendons
    guide = int(tendons.grips[grip])
    course = _Course(frames, _tendon_of(tendons, guide))
    place = (guide - course.path.start) or len(course.radii) - 1
    if tendons.guide_radius[guide]:
        return np.asarray(course.wrap(place)[1:])
    turn = course.angle[place - 1, 1:] - course.angle[place % len(course.own), 1:]
    return np.asarray(np.abs(np.arctan2(np.sin(turn), np.cos(turn))))


def lying(frames: Frames, wheel: int) -> tuple[Array, Array]:
    """Angle of wrap [rad] and clearance [m] of one of the wheels that a tendon can lift off, [n].

    ``wheel`` counts :attr:`sandbox.model.model.Tendons.wheels`. The angle is 0 where the tendon is
    off; the clearance is negative where the wheel is in its way, nan where the tendon is on.
    A wheel that is beyond an end of the straight piece is not in its way.
    """
    tendons, cables = frames.model.tendons, frames.cables
    guide = int(tendons.wheels[wheel])
    course = _Course(frames, _tendon_of(tendons, guide))
    place = guide - course.path.start
    piece, radius = course.own[place], tendons.guide_radius
    way, at = cables.x[piece] + 1j * cables.y[piece], frames.guides.x + 1j * frames.guides.y
    ends = [at[nodes[piece], np.arange(frames.samples)] + 1j * radius[nodes[piece]] * way
            for nodes in frames.ends]
    before, after = (way.conj() * each for each in (at[guide] - ends[0], ends[1] - at[guide]))
    clear = -np.sign(radius[guide]) * before.imag - abs(radius[guide])
    beside = (before.real > 0) & (after.real > 0)
    return course.wrap(place)[1:], np.where(
        frames.off_wheels[:, wheel], np.where(beside, clear, np.inf), np.nan)


def span_length(frames: Frames, span: CableSpan) -> tuple[Array, Array]:
    """Length of a span [m], [1 + n], from t = 0: as if fixed to both its guides, and free."""
    course = _Course(frames, span.tendon)
    places = [guide - course.path.start for guide in span.guides]
    total = np.zeros(1 + frames.samples)
    for place in places[:-1]:
        total += course.length[place]
    for place in places[1:-1]:
        if course.radii[place]:
            total += course.on_wheel(place or len(course.own))
    wound = course.wound(places[0], places[0] % len(course.own), -1.0)
    return total + (wound + course.wound(
        places[-1], (places[-1] - 1) % len(course.own), 1.0)), total


def piece_tensions(
    model: Model, arrays: Mapping[str, Array], pieces: Integers | None = None,
) -> Array:
    """Tension of every straight piece [N], [m, n]; of some ``pieces`` only, by their numbers."""
    tendons = model.tendons
    of = np.arange(len(tendons.stretch_tendon)) if pieces is None else np.asarray(pieces)
    found = arrays["tendon_tension"].T[tendons.stretch_tendon[of]]
    for k, guide in enumerate(tendons.grips.tolist()):
        before = (tendons.stretch_tendon[of] == _tendon_of(tendons, guide)) & (
            tendons.stretch_first[of] < guide)
        found[before] -= arrays["guide_friction"][:, k]
    return found


def lengths_at_start(model: Model) -> Array:
    """Length of every tendon at t = 0, as the scene's poses have it [m], [nt]."""
    return Frames.at_start(model).lengths[:, 0]


def wraps_at_start(model: Model, tendon: int) -> Array:
    """Angle of wrap of a tendon on each wheel at t = 0 [rad]; 0 on eyes and at its ends."""
    course = _Course(Frames.at_start(model), tendon)
    count = len(course.own) if course.closed else len(course.radii)
    return np.array([float(course.wrap(place)[0]) if radius and course.inner(place) else 0.0
                     for place, radius in enumerate(course.radii[:count])])


def rest_lengths(model: Model) -> Array:
    """Rest length of every tendon [m], [nt]; by default the length at t = 0."""
    tendons = model.tendons
    length = lengths_at_start(model)
    rest: Array = np.where(np.isnan(tendons.rest), length, tendons.rest)
    pulled = length - tendons.pretension / tendons.stiffness
    return np.where(np.isnan(tendons.pretension), rest + tendons.slack, pulled)


def wound_up(frames: Frames, tendon: int, *, last: bool = False) -> Array:
    """Length wound up by the wheels at both ends, or the ``last``, since t = 0 [m], [n]."""
    course = _Course(frames, tendon)
    end = len(course.radii) - 1
    return np.asarray(sum(course.on_wheel(place)[1:] for place in ((end,) if last else (0, end))))
