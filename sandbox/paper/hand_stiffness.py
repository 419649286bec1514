"""Figure 22: one hand and one pull, first with equal springs, then with some lowered and raised.

A tree of equal arms gives every finger T = F / n. A free finger then rests where at each joint
the torque of its tendon is that of its spring,

    T h_i(theta_i) = k_i (lm_i - lm_i0) hm_i(theta_i)

with the lengths and arms of equations (17) and (29): one equation for each joint by itself, since
lt_i and lm_i depend on theta_i alone. Where no rotation within the limits solves it, the joint
rests on its stop. The engine's poses are held against this.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple, dataclass, fields
from pathlib import Path

import numpy as np

from sandbox.atomic_files import write_atomic
from sandbox.comma import comma_separated
from sandbox.draw.film.side_by_side import Mark, draw_ends
from sandbox.engine.simulate import simulate
from sandbox.mechanics.springs import SpringSet, spring_set
from sandbox.mechanics.tendon import TendonRoute, route
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene

SCENES = ("stiffness_uniform", "stiffness_varied")
PICTURE, NUMBERS, TABLE = "hand_stiffness.png", "hand_stiffness.csv", "hand_stiffness.md"
LOWERED, RAISED = Mark("L"), Mark("I", strong=True)
GRID = 1000
"""Rotations looked at for the first balance; then the one found is halved in."""
HALVINGS = 60


@dataclass(frozen=True)
class FreeFinger:
    """What decides the resting pose of a finger that touches nothing."""

    hinges: tuple[str, ...]
    tendon: TendonRoute
    springs: SpringSet
    stiffness: Array
    """k_i [N/m], shape [n]; the springs are slack at rotation 0."""
    limits: Array
    """Lowest and highest rotation [rad], shape [n, 2]."""

    def net_torque(self, theta: Array, tension: float) -> Array:
        """T h - k (lm - lm_0) hm [N m], closing positive, shape [..., n]."""
        back = self.stiffness * self.springs.elongations(theta) * self.springs.arms(theta)
        return np.asarray(tension * self.tendon.arms(theta) - back)

    def rest(self, tension: float) -> Array:
        """Rotations [rad], shape [n], at which it stops when closed slowly from 0 by ``tension``.

        The first balance from the lowest rotation up, or the highest rotation where there is none.
        """
        fraction = np.linspace(0.0, 1.0, GRID + 1)[:, None]
        grid = self.limits[:, 0] + fraction * (self.limits[:, 1] - self.limits[:, 0])
        balanced = self.net_torque(grid, tension) <= 0
        first = np.where(balanced.any(axis=0), balanced.argmax(axis=0), GRID)
        columns = np.arange(len(self.hinges))
        low, high = grid[np.maximum(first - 1, 0), columns], grid[first, columns]
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            closing = self.net_torque(middle, tension) > 0
            low, high = np.where(closing, middle, low), np.where(closing, high, middle)
        return np.asarray(np.where(balanced.any(axis=0), high, self.limits[:, 1]))


@dataclass(frozen=True)
class Row:
    """One joint in both hands; angles in rad, stiffness in N/m."""

    finger: str
    joint: str
    k_uniform: float
    k_varied: float
    theta_uniform: float
    theta_varied: float
    difference: float
    closed_uniform: float
    closed_varied: float
    error_uniform: float
    error_varied: float


UNITS = {"k": "N_per_m", "theta": "rad", "difference": "rad", "closed": "rad", "error": "rad"}


def free_fingers(model: Model) -> dict[str, FreeFinger]:
    """The fingers of a hand whose tendons end at their tips, by name.

    Raises:
        ValueError: a finger without a linear spring over every hinge, or without stops; or one
            whose springs have another rest length than that at rotation 0.
    """
    return {group.name: _free_finger(model, group.name)
            for group in model.mechanism.groups if group.kind == "finger"}


def _free_finger(model: Model, name: str) -> FreeFinger:
    joints, springs, tendons = model.joints, model.springs, model.tendons
    pins = [j for j in joints.hinges.tolist() if joints.name[j].startswith(f"{name}.")]
    straight = {(a, b): k for k, (a, b) in enumerate(springs.bodies.tolist())
                if springs.straight[k]}
    ends = [(a, b) for a, b in joints.bodies[pins].tolist()]
    found, limits = [straight[pair] for pair in ends if pair in straight], joints.stops[pins]
    if len(found) != len(pins) or not np.isfinite(limits).all():
        raise ValueError(f"{name} must have a linear spring and stops at each of its hinges")
    hinges = joints.anchor[pins, 0]
    near, far = springs.anchor[found, 0] - hinges, springs.anchor[found, 1]
    path = tendons.guides(model.names.tendon[f"{name}.tendon"])
    # a palm's first guide is V_0
    at = dict(zip(tendons.guide_body[path][::-1].tolist(), tendons.guide_at[path][::-1],
                  strict=True))
    guides = np.array([at[ends[0][0]], *(at[b] for _, b in ends)])
    guides[0] -= hinges[0]
    # a finger that closes counterclockwise is the mirror image of one that closes clockwise
    side = np.array([1.0, -joints.sense[pins[0]]])
    set_ = spring_set(near * side, far * side)
    if (np.abs(springs.rest[found] - set_.lengths(np.zeros(len(pins)))) > 1e-9).any():
        raise ValueError(f"the springs of {name} must be slack at rotation 0")
    # on the last phalanx no hinge follows: its length matters to no triangle
    lengths = [*np.abs(hinges[1:, 0]), 1.0]
    return FreeFinger(tuple(joints.name[j] for j in pins), route(guides * side, lengths), set_,
                      springs.stiffness[found], limits)


def compare(uniform: Recording, varied: Recording, pull: float) -> list[Row]:
    """Every joint of two runs of one hand at their ends, and the closed form of each.

    Args:
        uniform: the run with equal springs.
        varied: the run with others.
        pull: F of the actuator [N], shared equally by the fingers.
    """
    first, second = free_fingers(uniform.model), free_fingers(varied.model)
    tension = pull / len(first)
    rows = []
    for name, finger in first.items():
        other = second[name]
        closed = finger.rest(tension), other.rest(tension)
        for i, hinge in enumerate(finger.hinges):
            was, now = (float(run[f"{hinge}.angle"][-1]) for run in (uniform, varied))
            closed_was, closed_now = (float(rotation[i]) for rotation in closed)
            rows.append(Row(
                name, hinge.rpartition(".")[2], float(finger.stiffness[i]),
                float(other.stiffness[i]), was, now, now - was, closed_was, closed_now,
                was - closed_was, now - closed_now))
    return rows


def run(directory: Path, *, progress: Callable[[float], None] | None = None) -> str:
    """Run both hands, write the picture and the table; a few lines on what came out.

    Raises:
        OutputError: a file cannot be written.
    """
    runs = []
    for k, name in enumerate(SCENES):
        runs.append(simulate(load_scene(name), progress=_part(progress, k / 2)))
    uniform, varied = runs
    pull = float(uniform["actuator.value"][-1])
    rows = compare(uniform, varied, pull)
    _draw(directory / PICTURE, uniform, varied, rows, pull)
    _write(directory / NUMBERS, _csv(rows))
    _write(directory / TABLE, markdown(rows))
    if progress is not None:
        progress(1.0)
    return summary(rows, pull)


def _part(progress: Callable[[float], None] | None, done: float) -> Callable[[float], None] | None:
    return None if progress is None else lambda fraction: progress(done + fraction / 2)


def _draw(path: Path, uniform: Recording, varied: Recording, rows: list[Row],
          pull: float) -> None:
    marks = {}
    for row in rows:
        if row.k_varied != row.k_uniform:
            spring = f"{row.finger}.{row.joint}_spring"
            marks[spring] = LOWERED if row.k_varied < row.k_uniform else RAISED
    key = [(mark, f"{stiffness:g} N/m") for mark, stiffness in _stiffness_of(rows).items()]
    draw_ends([uniform, varied],
              ["All springs have the same stiffness",
               "Springs marked L are softer, springs marked I are stiffer"],
              [{}, marks], path, key=key,
              note=f"all other springs {rows[0].k_uniform:g} N/m; the actuator pulls with "
                   f"{pull:g} N in both", width=720, columns=1)


def _stiffness_of(rows: list[Row]) -> Mapping[Mark, float]:
    """The lowered and the raised stiffness [N/m]."""
    values = {row.k_varied for row in rows if row.k_varied != row.k_uniform}
    return {LOWERED: min(values), RAISED: max(values)}


def _write(path: Path, text: str) -> None:
    write_atomic(path, text)


def _csv(rows: list[Row]) -> str:
    """All numbers in SI."""
    names = [field.name for field in fields(Row)]
    units = [UNITS.get(name.partition("_")[0], "") for name in names]
    return comma_separated(
        [f"{name}_{unit}" if unit else name for name, unit in zip(names, units, strict=True)],
        map(astuple, rows))


def markdown(rows: list[Row]) -> str:
    """The table to read: degrees, and errors of the engine in 1e-3 degrees."""
    lines = ["| finger | joint | k equal [N/m] | k varied [N/m] | θ equal | θ varied | difference "
             "| closed form | error [10⁻³ °] |", "|---|---|---|---|---|---|---|---|---|"]
    lines += list(_lines(rows))
    return "\n".join(lines) + "\n"


def _lines(rows: list[Row]) -> Iterator[str]:
    for row in rows:
        mark = {-1: " L", 0: "", 1: " I"}[int(np.sign(row.k_varied - row.k_uniform))]
        angles = np.degrees([row.theta_uniform, row.theta_varied, row.difference,
                             row.closed_uniform, row.closed_varied])
        # + 0.0 makes of -0 a 0
        errors = np.round(1e3 * np.degrees([row.error_uniform, row.error_varied]), 2) + 0.0
        yield (f"| {row.finger} | {row.joint} | {row.k_uniform:g} | {row.k_varied:g}{mark} "
               f"| {angles[0]:.3f}° | {angles[1]:.3f}° | {angles[2]:+.3f}° "
               f"| {angles[3]:.3f}°, {angles[4]:.3f}° | {errors[0]:+.2f}, {errors[1]:+.2f} |")


def summary(rows: list[Row], pull: float) -> str:
    """What came out, in three lines."""
    change = np.degrees([row.difference for row in rows])
    errors = np.degrees([[row.error_uniform, row.error_varied] for row in rows])
    most = rows[int(np.abs(change).argmax())]
    return (
        f"Pull {pull:g} N in both hands; only the stiffness of springs differs.\n"
        f"Rotations differ by {change.min():+.1f} to {change.max():+.1f} deg, most at "
        f"{most.finger}.{most.joint}: {np.degrees(most.theta_uniform):.1f} and "
        f"{np.degrees(most.theta_varied):.1f} deg.\n"
        f"Largest difference from T h = k (lm - lm_0) hm with T = F / n: "
        f"{np.abs(errors).max():.4f} deg.")
