"""Cords as good as rigid that ring on and on.

What hangs on a cord of stiffness k swings on it. A cord from :data:`RIGID` on is solved at the end
of a step h, which acts as a damper h k along it, besides its own c: of a mode of w the damping
ratio is zeta = (c + h k) w / (2 k), much where little hangs on it and little where much does. No
default could do for both: k times 1 ms takes the peak of a 0.5 kg weight that is let go from 2 to
1.5 weights, and leaves 20 kg ringing for 1.8 s.

Modes are those of the pose at t = 0 with joints held, every spring and taut cord that no drive
pulls in them, and all dampers; contacts are left out, and what gravity adds. Cords that begin slack
get the jolt that makes others ring: modes are looked for once more with all cords taut.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.engine.inspect_drives import largest_stiffness
from sandbox.engine.inspect_groups import groups, linked
from sandbox.engine.inspect_words import STRAIGHT, look
from sandbox.engine.stiffness import stiff_cords, too_stiff
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.model.supports import LARGEST_GROUP, RANK, about_centre, joint_rows
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import Pulls, pulls_at_start, rest_lengths

PERIODS = 15
"""After so many an oscillation should have died to :data:`LEFT`."""
LEFT = 0.01
ENOUGH = -math.log(LEFT) / (2 * math.pi * PERIODS)
"""The damping ratio at which it has: 5 %."""


def ringing_problems(model: Model) -> Iterator[Problem]:
    """Stiff cords that take most of a mode that is damped less than :data:`ENOUGH`."""
    free = np.asarray(model.tendons.drive == NONE)
    pulls = pulls_at_start(model)
    now = free & ~np.asarray(pulls.length < rest_lengths(model) - STRAIGHT)
    if not (free & (model.tendons.stiffness >= RIGID)).any():
        return
    elements = _elements(model, pulls)
    ringing = _ringing(model, elements, now)
    later = {} if (now == free).all() else _ringing(model, elements, free)
    for cord, mode in sorted((later | ringing).items()):
        periods = -math.log(LEFT) / (2 * math.pi * mode.ratio)
        yield look("undamped", f"$.tendons[{cord}]", model.tendons.name[cord], "vibrates at "
                   f"{mode.omega / (2 * math.pi):.3g} "
                   f"Hz{'' if cord in ringing else ' once all cords are taut'}: of a jolt, "
                   f"{100 * LEFT:.0f} % remain after {periods:.3g} periods, "
                   f"{2 * math.pi * periods / mode.omega:.2g} s", "with 'damping' "
                   f"{mode.damping:.3g} N s/m it would take {PERIODS}")


def _ringing(model: Model, elements: list[_Element], taut: Flags) -> dict[int, _Mode]:
    """Of every cord the worst mode that it takes most of, if that rings; some cords being taut."""
    rigid = taut & (model.tendons.stiffness >= RIGID)
    at: dict[int, dict[int, _Element]] = {}
    for i, element in enumerate(elements):
        if element.cord == NONE or taut[element.cord]:
            for body, _ in element.parts:
                at.setdefault(body, {})[i] = element
    worst: dict[int, _Mode] = {}
    for bodies in groups(model, linked(model, springs=True)) if rigid.any() else ():
        if 3 * len(bodies) <= LARGEST_GROUP:
            here = {i: each for body in bodies.tolist() for i, each in at.get(body, {}).items()}
            for mode in _modes(model, bodies, [here[i] for i in sorted(here)], rigid):
                worst[mode.cord] = min(worst.get(mode.cord, mode), mode)
    return {cord: mode for cord, mode in worst.items() if mode.ratio < ENOUGH}


class _Mode(NamedTuple):
    """A motion that stiff cords take most of; the least damped comes first."""

    ratio: float
    """Of its damping to what would be critical."""
    omega: float
    """[rad/s]"""
    cord: int
    """The one that takes most of it."""
    damping: float
    """That this cord would have to have [N s/m] for :data:`ENOUGH`."""


class _Element(NamedTuple):
    """A spring, cord or damper: bodies and what 1 N or 1 N m in it does to them."""

    parts: list[tuple[int, Array]]
    stiffness: float
    damping: float
    """What is solved at the end of a step h has h k more."""
    cord: int = NONE


def _modes(
    model: Model, bodies: Integers, elements: list[_Element], rigid: Flags,
) -> Iterator[_Mode]:
    """Those of a group of bodies and of what acts on them."""
    rows, stiffness, damping, cord = _table(bodies, elements)
    if not len(rows) or not rigid[cord[cord >= 0]].any():
        return
    weight = np.sqrt(np.stack([model.bodies.mass[bodies], model.bodies.mass[bodies],
                               model.bodies.inertia[bodies]], axis=1).ravel())
    motions = _motions(model, bodies, weight)
    rows = (rows / weight) @ motions
    squares, shapes = np.linalg.eigh((rows * stiffness[:, None]).T @ rows)
    least = RANK * max(float(squares.max(initial=0.0)), 1e-300)
    stiff = np.array([c >= 0 and bool(rigid[c]) for c in cord])
    for square, shape in zip(squares, shapes.T, strict=True):
        if square <= least:
            continue
        moved = (rows @ shape) ** 2
        share = np.where(stiff, stiffness * moved, 0.0) / square
        if share.sum() > 0.5:
            omega, most = math.sqrt(float(square)), int(share.argmax())
            ratio = float(damping @ moved) / (2 * omega)
            more = max(ENOUGH - ratio, 0.0) * 2 * omega / float(moved[most])
            number = int(cord[most])
            yield _Mode(ratio, omega, number, float(model.tendons.damping[number]) + more)


def _motions(model: Model, bodies: Integers, weight: Array) -> Array:
    """A basis of the motions that joints allow, by the roots of the masses, [3 n, freedoms]."""
    place = {body: 3 * i for i, body in enumerate(bodies.tolist())}
    pose, found = model.bodies.pose, []
    for joint in sorted({joint for body in place for joint, _ in model.neighbours[body]}):
        for row in joint_rows(model, pose, joint, flank=int(model.joints.play[joint] == 0)):
            line = np.zeros(len(weight))
            for body, wrench in row:
                if body in place:
                    line[place[body]:place[body] + 3] += about_centre(model, pose, body, wrench)
            found.append(line / weight)
    if not found:
        return np.eye(len(weight))
    lines = np.array(found)
    if len(lines) > lines.shape[1]:  # as many as say the same: the left vectors are not asked for
        lines = np.asarray(np.linalg.qr(lines, mode="r"))
    _, values, right = np.linalg.svd(lines)
    rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
    motions: Array = right[rank:].T
    return motions


def _elements(model: Model, pulls: Pulls) -> list[_Element]:
    """All springs, cords and dampers, in this order."""
    h, springs, tendons = model.mechanism.run.step, model.springs, model.tendons
    found, at_end = [], stiff_cords(model, h)
    for i, stiffness in enumerate(tendons.stiffness.tolist()):
        more = h * stiffness if at_end[i] else 0.0
        found.append(_Element(pulls.parts(i), stiffness, float(tendons.damping[i]) + more, i))
    largest, springs_at_end = largest_stiffness(model), too_stiff(model, h)
    for i, straight in enumerate(springs.straight):
        parts = _along(model, i) if straight else _about(model, int(springs.joint[i]))
        k, c = float(largest[i]), float(springs.damping[i])
        found.append(_Element(parts, k, c + (h * k if springs_at_end[i] else 0.0)))
    for j in np.flatnonzero(model.joints.damping > 0).tolist():
        found.append(_Element(_about(model, j), 0.0, float(model.joints.damping[j])))
    return found


def _table(
    bodies: Integers, elements: list[_Element],
) -> tuple[Array, Array, Array, Integers]:
    """Elements of a group: rows [n, 3 nb], stiffness, damping, which cord; -1 is no cord."""
    place = {body: 3 * i for i, body in enumerate(bodies.tolist())}
    rows: list[Array] = []
    kept: list[_Element] = []
    for element in elements:
        line = np.zeros(3 * len(bodies))
        for body, wrench in element.parts:
            if body in place:
                line[place[body]:place[body] + 3] += wrench
        if line.any():
            rows.append(line)
            kept.append(element)
    return (np.array(rows), np.array([each.stiffness for each in kept]),
            np.array([each.damping for each in kept]),
            np.array([each.cord for each in kept], dtype=np.int64))


def _about(model: Model, joint: int) -> list[tuple[int, Array]]:
    a, b = model.joints.bodies[joint].tolist()
    turn = np.array([0.0, 0.0, 1.0])
    return [(a, -turn), (b, turn)]


def _along(model: Model, spring: int) -> list[tuple[int, Array]]:
    """What a straight spring's unit pull does at t = 0; nothing where its ends are in one place."""
    pose, springs = model.bodies.pose, model.springs
    arms = []
    for body, point in zip(springs.bodies[spring].tolist(), springs.anchor[spring], strict=True):
        c, s = np.cos(pose[body, 2]), np.sin(pose[body, 2])
        arms.append((body, np.array([c * point[0] - s * point[1], s * point[0] + c * point[1]])))
    (a, on_a), (b, on_b) = arms
    way = pose[b, :2] + on_b - pose[a, :2] - on_a
    length = float(np.hypot(*way))
    if length < STRAIGHT:
        return []
    u = way / length
    return [(body, about_centre(model, pose, body, sign * np.array(
        [*u, arm[0] * u[1] - arm[1] * u[0]]))) for body, arm, sign in ((a, on_a, 1.0),
                                                                      (b, on_b, -1.0))]
