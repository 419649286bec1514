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

from sandbox.engine.inspect_drives import largest_stiffness
from sandbox.engine.inspect_groups import groups, linked
from sandbox.engine.inspect_words import STRAIGHT, look
from sandbox.engine.stiffness import stiff_cords, too_stiff
from sandbox.errors import Problem
from sandbox.model.model import NONE, Model
from sandbox.model.supports import MOST, RANK, about_centre, joint_rows
from sandbox.numeric import Array, Flags, Integers
from sandbox.samples.cords import pulls_at_start, rest_lengths
from sandbox.scene.elements.tendons import RIGID

PERIODS = 15
"""After so many an oscillation should have died to :data:`LEFT`."""
LEFT = 0.01
ENOUGH = -math.log(LEFT) / (2 * math.pi * PERIODS)
"""The damping ratio at which it has: 5 %."""


def ringing_problems(model: Model) -> Iterator[Problem]:
    """Stiff cords that take most of a mode that is damped less than :data:`ENOUGH`."""
    free = np.asarray(model.tendons.drive == NONE)
    now = free & ~_slack(model)
    ringing = _ringing(model, now)
    later = {} if (now == free).all() else _ringing(model, free)
    for cord, mode in sorted((later | ringing).items()):
        periods = -math.log(LEFT) / (2 * math.pi * mode.ratio)
        yield look(
            f"$.tendons[{cord}]", model.tendons.name[cord],
            f"rings at {mode.omega / (2 * math.pi):.3g} Hz"
            f"{'' if cord in ringing else ' once all cords are taut'}: of a jolt it has "
            f"{100 * LEFT:.0f} % left after {periods:.3g} periods, "
            f"{2 * math.pi * periods / mode.omega:.2g} s",
            f"with 'damping' {mode.damping:.3g} N s/m it would take {PERIODS}")


def _ringing(model: Model, taut: Flags) -> dict[int, _Mode]:
    """Of every cord the worst mode that it takes most of, if that rings; some cords being taut."""
    rigid = taut & (model.tendons.stiffness >= RIGID)
    worst: dict[int, _Mode] = {}
    for bodies in groups(model, linked(model, springs=True)) if rigid.any() else ():
        if 3 * len(bodies) <= MOST:
            for mode in _modes(model, bodies, taut, rigid):
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


def _slack(model: Model) -> Flags:
    """Cords that are longer than their way at t = 0, [nt]."""
    start = pulls_at_start(model).length
    return np.asarray(start < rest_lengths(model) - STRAIGHT)


def _modes(model: Model, bodies: Integers, taut: Flags, rigid: Flags) -> Iterator[_Mode]:
    """Those of a group of bodies."""
    rows, stiffness, damping, cord = _elements(model, bodies, taut)
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
    for joint in np.flatnonzero(np.isin(model.joints.bodies, bodies).any(axis=1)).tolist():
        for row in joint_rows(model, pose, joint):
            line = np.zeros(len(weight))
            for body, wrench in row:
                if body in place:
                    line[place[body]:place[body] + 3] += about_centre(model, pose, body, wrench)
            found.append(line / weight)
    if not found:
        return np.eye(len(weight))
    _, values, right = np.linalg.svd(np.array(found))
    rank = int(np.count_nonzero(values > RANK * values.max(initial=0.0)))
    motions: Array = right[rank:].T
    return motions


def _elements(
    model: Model, bodies: Integers, taut: Flags,
) -> tuple[Array, Array, Array, Integers]:
    """Springs, taut cords and dampers of a group: rows [n, 3 nb], stiffness, damping, which cord.

    What is solved at the end of a step has h k more damping; -1 is no cord.
    """
    h, springs, tendons = model.mechanism.run.step, model.springs, model.tendons
    place = {body: 3 * i for i, body in enumerate(bodies.tolist())}
    rows: list[Array] = []
    numbers: list[tuple[float, float, int]] = []

    def add(parts: list[tuple[int, Array]], k: float, c: float, cord: int = NONE) -> None:
        line = np.zeros(3 * len(bodies))
        for body, wrench in parts:
            if body in place:
                line[place[body]:place[body] + 3] += wrench
        if line.any():
            rows.append(line)
            numbers.append((k, c, cord))

    pulls, at_end = pulls_at_start(model), stiff_cords(model, h)
    for i in np.flatnonzero(taut).tolist():
        k, c = float(tendons.stiffness[i]), float(tendons.damping[i])
        add(pulls.parts(i), k, c + (h * k if at_end[i] else 0.0), i)
    largest, springs_at_end = largest_stiffness(model), too_stiff(model, h)
    for i, straight in enumerate(springs.straight):
        parts = (_along(model, i) if straight else _about(model, int(springs.joint[i])))
        k, c = float(largest[i]), float(springs.damping[i])
        add(parts, k, c + (h * k if springs_at_end[i] else 0.0))
    for j in np.flatnonzero(model.joints.damping > 0).tolist():
        add(_about(model, j), 0.0, float(model.joints.damping[j]))
    table = np.array(numbers).reshape(-1, 3)
    return np.array(rows), table[:, 0], table[:, 1], table[:, 2].astype(np.int64)


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
