"""Tendons in recorded poses: the stretches between guides, and the length along them.

A guide is a circle of radius r >= 0. Walking along u with left normal n, a
wheel whose centre lies right of the path has s = +1, left s = -1; the cord
touches it at c + s r n, and n . (c2 - c1) = s1 r1 - s2 r2 for a stretch. A plain
eye has r = 0. On a wheel between two stretches lies r times the angle of wrap;
one at an end winds the cord up, or pays it out, as it turns.

Where a cord is off a wheel, both stretches beside it are halves of the straight way past it: they
have one direction, and pull the wheel by nothing.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from sandbox.elements.element import GRAZE
from sandbox.model.model import Model, Tendons
from sandbox.model.tendons import CordSpan, lifted_at_start
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.frames import Frames, Places
from sandbox.scene.geometry import pose_of, to_world


class Stretches(NamedTuple):
    """Straight pieces of all cords, [m, n], as :class:`sandbox.model.model.Tendons` counts them."""

    length: Array
    """[m]"""
    x: Array
    """Unit vector along it."""
    y: Array
    start: Places
    """The guides' centres where the stretches begin and end."""
    end: Places


def stretches(frames: Frames) -> Stretches:
    """All stretches in all samples."""
    tendons = frames.model.tendons
    start, end = (frames.places(tendons.guide_body[nodes], tendons.guide_at[nodes])
                  for nodes in (tendons.stretch_first, tendons.stretch_first + 1))
    return _past(_straight(start, end, tendons), tendons, off_wheels(frames.run.arrays))


def off_wheels(arrays: Mapping[str, Array]) -> Flags:
    """Whether cords are off their wheels, [n, nw]; not in what was recorded before they could."""
    return np.asarray(arrays["guide_lifted"] > 0)


def _past(cords: Stretches, tendons: Tendons, off: Flags) -> Stretches:
    """The same where cords are off some of their wheels, ``off`` [n, nw], and go straight past."""
    for tendon in np.flatnonzero(np.diff(tendons.first)).tolist() if off.any() else ():
        loose = tendons.loose(tendon)
        own, begin = np.flatnonzero(tendons.stretch_tendon == tendon), int(tendons.first[tendon])
        for pattern in np.unique(off[:, loose], axis=0):
            if not pattern.any():
                continue
            when = np.flatnonzero((off[:, loose] == pattern).all(axis=1))
            on = np.setdiff1d(np.arange(len(own) + 1), tendons.wheels[loose[pattern]] - begin)
            for i, j in itertools.pairwise(on.tolist()):
                if j > i + 1:
                    _lay_straight(cords, tendons, own[i:j], begin + np.array([i, j]), when)
    return cords


def _lay_straight(
    cords: Stretches, tendons: Tendons, pieces: Integers, ends: Integers, when: Integers,
) -> None:
    """Put the straight way between two guides in the place of all ``pieces`` between them."""
    dx = cords.end.x[pieces[-1], when] - cords.start.x[pieces[0], when]
    dy = cords.end.y[pieces[-1], when] - cords.start.y[pieces[0], when]
    length, x, y = _tangent(dx, dy, float(np.subtract(*tendons.guide_radius[ends])))
    rows = np.ix_(pieces, when)
    cords.length[rows], cords.x[rows], cords.y[rows] = length / len(pieces), x, y


def _tangent(dx: Array, dy: Array, offset: Array | float) -> tuple[Array, Array, Array]:
    """Length and direction of a stretch between wheels that far apart, of radii that differ so."""
    square = dx * dx + dy * dy
    length = np.sqrt(np.maximum(square - offset * offset, 1e-24))
    square = length * length + offset * offset
    return length, (length * dx + offset * dy) / square, (length * dy - offset * dx) / square


def _straight(start: Places, end: Places, tendons: Tendons) -> Stretches:
    dx, dy = end.x - start.x, end.y - start.y
    square = dx * dx + dy * dy
    radius, first = tendons.guide_radius, tendons.stretch_first
    if not radius.any():
        length = np.sqrt(square)
        safe = np.where(length > 0, length, 1.0)
        return Stretches(length, dx / safe, dy / safe, start, end)
    return Stretches(*_tangent(dx, dy, (radius[first] - radius[first + 1])[:, None]), start, end)


def lengths(frames: Frames, cords: Stretches) -> Array:
    """Length of every tendon along its path [m], [nt, n], as the poses have it.

    How often a cord goes round its wheels is counted from t = 0 through all
    samples, between which no stretch may turn by half a turn.
    """
    tendons = frames.model.tendons
    total = np.zeros((len(tendons.name), frames.samples))
    for row, tendon in enumerate(tendons.stretch_tendon):
        total[tendon] += cords.length[row]
    if tendons.guide_radius.any():
        first = _at_start(frames.model)
        for tendon in range(len(tendons.name)):
            if tendons.guide_radius[tendons.guides(tendon)].any():
                total[tendon] += _on_wheels(frames, cords, first, tendon)
    return total


class Pulls(NamedTuple):
    """What 1 N in every cord does at t = 0."""

    length: Array
    """Along the path [m], [nt]."""
    does: list[dict[int, Array]]
    """Of every cord: force x, y and moment about the centre of mass, [3], by body."""

    def parts(self, tendon: int) -> list[tuple[int, Array]]:
        """Bodies that a cord pulls, and how."""
        return list(self.does[tendon].items())


def pulls_at_start(model: Model) -> Pulls:
    """The cords in the scene's poses."""
    tendons, first = model.tendons, _at_start(model)
    does: list[dict[int, Array]] = [{} for _ in tendons.name]
    for row, tendon in enumerate(tendons.stretch_tendon.tolist()):
        u = np.array([first.x[row, 0], first.y[row, 0]])
        one = int(tendons.stretch_first[row])
        for node, sign in ((one, 1.0), (one + 1, -1.0)):
            body = int(tendons.guide_body[node])
            centre = to_world(tuple(model.bodies.pose[body]), tuple(model.bodies.centre[body]))
            at = to_world(tuple(model.bodies.pose[body]), tuple(tendons.guide_at[node]))
            arm = np.subtract(at, centre)
            moment = arm[0] * u[1] - arm[1] * u[0] - tendons.guide_radius[node]  # n x u = -1
            does[tendon][body] = does[tendon].get(body, np.zeros(3)) + sign * np.array([*u, moment])
    return Pulls(lengths_at_start(model), does)


def _at_start(model: Model) -> Stretches:
    """The stretches at t = 0, [m, 1]."""
    bodies, tendons = model.mechanism.bodies, model.tendons
    at = np.array([to_world(pose_of(bodies[body]), (float(x), float(y)))
                   for body, (x, y) in zip(tendons.guide_body, tendons.guide_at, strict=True)]
                  ).reshape(-1, 2)
    nothing = np.zeros((len(tendons.stretch_first), 1))
    ends = [Places(at[nodes, :1], at[nodes, 1:], nothing, nothing)
            for nodes in (tendons.stretch_first, tendons.stretch_first + 1)]
    off = lifted_at_start(model)[tendons.wheels]
    return _past(_straight(ends[0], ends[1], tendons), tendons, off[None])


def bends(frames: Frames, cords: Stretches, grip: int) -> Array:
    """By how much a cord bends at a guide that holds it [rad], [n]; below 0 off its wheel."""
    tendons = frames.model.tendons
    guide = int(tendons.grips[grip])
    tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
    path, place = tendons.guides(tendon), guide - int(tendons.first[tendon])
    if place == 0:
        place = path.stop - path.start - 1
    if tendons.guide_radius[guide]:
        return _wrap(frames, cords, tendon, place)
    own = np.flatnonzero(tendons.stretch_tendon == tendon)
    one, two = own[place - 1], own[place % len(own)]
    across = cords.x[one] * cords.y[two] - cords.y[one] * cords.x[two]
    along = cords.x[one] * cords.x[two] + cords.y[one] * cords.y[two]
    return np.asarray(np.abs(np.arctan2(across, along)))


def _wrap(frames: Frames, cords: Stretches, tendon: int, place: int) -> Array:
    """The angle by which a cord lies on the wheel at one of its places [rad], [n]."""
    radius = float(frames.model.tendons.guide_radius[frames.model.tendons.guides(tendon)][place])
    angle = _angles(frames, cords, _at_start(frames.model), tendon)
    return np.asarray(_on_wheel(frames, angle, tendon, place)[1:] / abs(radius))


def lying(frames: Frames, cords: Stretches, wheel: int) -> tuple[Array, Array]:
    """How a cord lies on a wheel that it can lift off, or passes it.

    The angle by which it lies on it [rad], [n], 0 where it is off; and how far it passes it [m],
    [n]: below 0 if the wheel is in its way, inf beyond an end of the straight piece, nan where it
    is on. Wheels are those of :attr:`sandbox.model.model.Tendons.wheels`.
    """
    tendons, off = frames.model.tendons, off_wheels(frames.run.arrays)
    guide = int(tendons.wheels[wheel])
    tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
    path, own = tendons.guides(tendon), np.flatnonzero(tendons.stretch_tendon == tendon)
    place, n = guide - path.start, np.arange(frames.samples)
    u = cords.x[own] + 1j * cords.y[own]
    start, end = (part.x[own] + 1j * part.y[own] for part in (cords.start, cords.end))
    radius = tendons.guide_radius[path.start:path.start + len(own) + 1, None]
    on = np.ones((len(own) + 1, frames.samples), dtype=bool)
    for k in np.flatnonzero((tendons.wheels >= path.start) & (tendons.wheels < path.stop)):
        on[tendons.wheels[k] - path.start] = ~off[:, k]
    # the straight piece is between the nearest guides that the cord lies on
    begin = (start + 1j * radius[:-1] * u)[place - 1 - on[:place][::-1].argmax(axis=0), n]
    finish = (end + 1j * radius[1:] * u)[place + on[place + 1:].argmax(axis=0), n]
    before, after = ((start[place] - begin) / u[place], (finish - start[place]) / u[place])
    clear = -np.sign(radius[place]) * before.imag - np.abs(radius[place])
    passes = np.where((before.real > 0) & (after.real > 0), clear, np.inf)
    return _wrap(frames, cords, tendon, place), np.where(off[:, wheel], passes, np.nan)


def span_length(frames: Frames, cords: Stretches, span: CordSpan) -> tuple[Array, Array]:
    """Length of a span [m], [1 + n], from t = 0: as if it were tied to both its guides, and free.

    The first counts what wheels there have wound up since t = 0.
    """
    tendons, first = frames.model.tendons, _at_start(frames.model)
    begin = int(tendons.first[span.tendon])
    angle = _angles(frames, cords, first, span.tendon)
    own = np.flatnonzero(tendons.stretch_tendon == span.tendon)
    places = [guide - begin for guide in span.guides]
    total = np.zeros(1 + frames.samples)
    for place in places[:-1]:
        total += np.concatenate([first.length[own[place]], cords.length[own[place]]])
    for place in places[1:-1]:
        if tendons.guide_radius[begin + place]:
            total += _on_wheel(frames, angle, span.tendon, place or len(own))
    wound = np.zeros(1 + frames.samples)
    for place, piece, sign in ((places[0], places[0], -1.0), (places[-1], places[-1] - 1, 1.0)):
        body = int(tendons.guide_body[begin + place])
        radius = sign * float(tendons.guide_radius[begin + place])
        wound += radius * _turned(frames, angle[piece % len(own)], body)
    return total + wound, total


def piece_tensions(
    model: Model, arrays: Mapping[str, Array], pieces: Integers | None = None,
) -> Array:
    """Tension of every straight piece [N], [m, n]; of some ``pieces`` only, by their numbers.

    Behind a guide that holds its cord by friction it is larger than before it by what is recorded.
    """
    tendons = model.tendons
    of = np.arange(len(tendons.stretch_tendon)) if pieces is None else np.asarray(pieces)
    found = arrays["tendon_tension"].T[tendons.stretch_tendon[of]]
    for k, guide in enumerate(tendons.grips.tolist()):
        tendon = int(np.searchsorted(tendons.first, guide, side="right")) - 1
        before = (tendons.stretch_tendon[of] == tendon) & (tendons.stretch_first[of] < guide)
        found[before] -= arrays["guide_friction"][:, k]
    return found


def lengths_at_start(model: Model) -> Array:
    """Length of every tendon at t = 0, as the scene's poses have it [m], [nt]."""
    tendons = model.tendons
    total, first = np.zeros(len(tendons.name)), _at_start(model)
    np.add.at(total, tendons.stretch_tendon, first.length[:, 0])
    for tendon in range(len(tendons.name)):
        radii = np.abs(tendons.guide_radius[tendons.guides(tendon)])
        if radii.any():
            wraps = _wraps(model, first, tendon)
            total[tendon] += radii[:len(wraps)] @ wraps
    return total


def wraps_at_start(model: Model, tendon: int) -> Array:
    """By how much a cord lies on each of its wheels at t = 0 [rad], 0 on eyes and where it is tied.

    Of a loop its first guide counts, and does not come last again.
    """
    return _wraps(model, _at_start(model), tendon)


def _wraps(model: Model, first: Stretches, tendon: int) -> Array:
    """The same, with all stretches at t = 0 at hand."""
    tendons = model.tendons
    guides = tendons.guides(tendon)
    own = np.flatnonzero(tendons.stretch_tendon == tendon)
    wraps = np.zeros(len(own) if tendons.closed[tendon] else len(own) + 1)
    for place in np.flatnonzero(tendons.guide_radius[guides.start:guides.start + len(wraps)]):
        if tendons.closed[tendon] or 0 < place < len(own):
            rows = own[[place - 1, place]]
            angle = np.arctan2(first.x[rows, 0], -first.y[rows, 0])
            guide = guides.start + place
            wraps[place] = _first_wrap(np.sign(tendons.guide_radius[guide]) * (
                angle[0] - angle[1]), int(tendons.guide_turns[guide]))
    return wraps


def rest_lengths(model: Model) -> Array:
    """Up to which length every tendon hangs slack [m], [nt]; without one said that of t = 0."""
    tendons = model.tendons
    length = lengths_at_start(model)
    rest: Array = np.where(np.isnan(tendons.rest), length, tendons.rest)
    pulled = length - tendons.pretension / tendons.stiffness
    return np.where(np.isnan(tendons.pretension), rest + tendons.slack, pulled)


def wound_up(frames: Frames, cords: Stretches, tendon: int, *, last: bool = False) -> Array:
    """Length of cord that the wheels at a tendon's ends have wound up since t = 0 [m], [n].

    With ``last`` only that at its last guide.
    """
    end = len(frames.model.tendons.guide_radius[frames.model.tendons.guides(tendon)]) - 1
    angle = _angles(frames, cords, _at_start(frames.model), tendon)
    places = (end,) if last else (0, end)
    return np.asarray(sum(_on_wheel(frames, angle, tendon, place)[1:] for place in places))


def _on_wheels(frames: Frames, cords: Stretches, first: Stretches, tendon: int) -> Array:
    """Length of cord on the wheels of one tendon [m], [n]; of those at its ends what they wound up.

    ``first`` are the stretches at t = 0.
    """
    radii = frames.model.tendons.guide_radius[frames.model.tendons.guides(tendon)]
    angle = _angles(frames, cords, first, tendon)
    result = np.zeros(frames.samples)
    for place in np.flatnonzero(radii):
        if place == 0 and frames.model.tendons.closed[tendon]:
            continue  # it comes last again
        result += _on_wheel(frames, angle, tendon, int(place))[1:]
    return result


def _angles(frames: Frames, cords: Stretches, first: Stretches, tendon: int) -> Array:
    """Angles of the left normals of a tendon's stretches [rad], [stretches, 1 + n], from t = 0."""
    rows = np.flatnonzero(frames.model.tendons.stretch_tendon == tendon)
    return np.concatenate([np.arctan2(s.x[rows], -s.y[rows]) for s in (first, cords)], axis=1)


def _on_wheel(frames: Frames, angle: Array, tendon: int, place: int) -> Array:
    """Length of cord on the wheel at one place of a tendon [m], at an end what it wound up.

    [1 + n], from t = 0.
    """
    tendons = frames.model.tendons
    guide = int(tendons.first[tendon]) + place
    radius, body = float(tendons.guide_radius[guide]), tendons.guide_body[guide]
    if 0 < place < len(angle) or tendons.closed[tendon]:
        wrap = np.sign(radius) * (angle[place - 1] - angle[place % len(angle)])
        wrap[0] = _first_wrap(wrap[0], int(tendons.guide_turns[guide]))
        return np.asarray(abs(radius) * np.unwrap(wrap))
    return (-1.0 if place == 0 else 1.0) * radius * _turned(frames, angle[0 if place == 0 else -1],
                                                            int(body))


def _first_wrap(wrap: float, turns: int) -> float:
    """By how much a cord lies on a wheel at t = 0 [rad], where it turns by ``wrap`` or more."""
    return float((wrap + GRAZE) % (2 * np.pi) - GRAZE + 2 * np.pi * turns)


def _turned(frames: Frames, angle: Array, body: int) -> Array:
    """How far the point where a cord leaves a body's wheel has gone since t = 0 [rad], [1 + n]."""
    own = np.concatenate([frames.model.bodies.pose[body, 2:], frames.angle[body]])
    turned = np.unwrap(angle) - own
    return np.asarray(turned - turned[0])
