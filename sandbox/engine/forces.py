"""All forces of one step in one call: drives, springs, dampers, tendons.

They are computed at the predicted pose x + h v, the pose at which pymunk will
apply them, and handed over in one batch write.

Dampers of hinges follow an incremental, linearly implicit rule: with D the map
from body rates to hinge rates, omega = D v, C the coefficients and
A = D M^-1 D^T of the free bodies,

    ( I + h/2 C A ) ( tau_n - tau_(n-1) ) = - C ( 1.5 omega_n - 0.5 omega_(n-1) ) - tau_(n-1)

The right side is the damping torque at mid-step, second order; the matrix acts
on its change only, so it steadies without costing that order. A is constant.
Dampers of linear springs follow the same rule one by one.

The tendon network asks for the velocities that all other forces lead to. What
joints and contacts will do is not known before pymunk has solved them, so a
running mean of what they did is used. At rest it is exact: a tendon then
stretches by T / k and no more. Taking the last step alone would be exact
sooner, and is unstable; leaving it out is stable too, but makes a stiff tendon
as soft as the light bodies it is tied to: 3.3 mm of stretch instead of 0.04 mm
for the four-finger hand at h = 1 ms.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.network import ELASTIC, PULL, add_force, elastic_tension, measure, solve

Array = NDArray[np.float64]

FOLLOW = 0.1
"""Share of the newest step in the running estimate of what joints and contacts do."""
Records = NDArray[Any]
Integers = NDArray[np.int64]

# A straight spring between points of two bodies (relative to their centres of mass); `drive` is
# the drive that sets its stiffness, -1 for `k` itself.
SPRING = np.dtype([
    ("drive", np.int64),
    ("a", np.int64), ("ax", float), ("ay", float), ("b", np.int64), ("bx", float), ("by", float),
    ("k", float), ("c", float), ("rest", float), ("share", float),
    ("length", float), ("force", float), ("damping", float),
    ("ux", float), ("uy", float), ("ta", float), ("tb", float), ("work", float), ("gain", float),
])
# A damped hinge: its bodies and its number; `block` is its row's start in the list of inverse
# matrices and `first`, `size` the dampers that share that matrix.
DAMPER = np.dtype([
    ("a", np.int64), ("b", np.int64), ("c", float), ("joint", np.int64),
    ("block", np.int64), ("first", np.int64), ("size", np.int64),
    ("torque", float), ("rhs", float), ("work", float), ("gain", float),
])
# A force or torque of a drive; `b` is -1 for a force, else the second body of the hinge. `spring`
# is -1, or a rotary spring whose stiffness the drive sets and `rest` where that is at rest: the
# turn of `b` against `a` [rad]. `motor` is 0, or the address of the impulse of a motor or brake:
# what that does pymunk works out in its step.
ACTION = np.dtype([
    ("drive", np.int64), ("a", np.int64), ("b", np.int64), ("x", float), ("y", float),
    ("spring", np.int64), ("rest", float), ("motor", np.int64),
    ("dx", float), ("dy", float), ("turns", np.int64), ("sign", float),
    ("fx", float), ("fy", float), ("torque", float), ("work", float), ("gain", float),
])


@njit(cache=True)
def _actions(actions: Records, drive: Array, pose: Array, out: Array) -> None:
    for i in range(len(actions)):
        action = actions[i]
        value, a = drive[action["drive"]], action["a"]
        if action["motor"]:
            continue
        if action["b"] >= 0:
            action["torque"] = action["sign"] * value
            if action["spring"] >= 0:
                turned = pose[action["b"], 2] - pose[a, 2]
                action["torque"] = -max(value, 0.0) * (turned - action["rest"])
            out[action["b"], 2] += action["torque"]
            out[a, 2] -= action["torque"]
            continue
        c, s = math.cos(pose[a, 2]), math.sin(pose[a, 2])
        fx, fy = value * action["dx"], value * action["dy"]
        if action["turns"]:
            fx, fy = c * fx - s * fy, s * fx + c * fy
        rx, ry = c * action["x"] - s * action["y"], s * action["x"] + c * action["y"]
        action["fx"], action["fy"], action["torque"] = fx, fy, rx * fy - ry * fx
        out[a, 0] += fx
        out[a, 1] += fy
        out[a, 2] += action["torque"]


@njit(cache=True)
def _springs(
    h: float, springs: Records, drive: Array, pose: Array, state: Array, before: Array,
    inverse_mass: Array, out: Array,
) -> None:
    for i in range(len(springs)):
        s = springs[i]
        a, b = s["a"], s["b"]
        ca, sa = math.cos(pose[a, 2]), math.sin(pose[a, 2])
        cb, sb = math.cos(pose[b, 2]), math.sin(pose[b, 2])
        ax, ay = ca * s["ax"] - sa * s["ay"], sa * s["ax"] + ca * s["ay"]
        bx, by = cb * s["bx"] - sb * s["by"], sb * s["bx"] + cb * s["by"]
        dx, dy = pose[b, 0] + bx - pose[a, 0] - ax, pose[b, 1] + by - pose[a, 1] - ay
        length = math.hypot(dx, dy)
        ux, uy = (dx / length, dy / length) if length > 0.0 else (0.0, 0.0)
        ta, tb = ax * uy - ay * ux, bx * uy - by * ux
        k = s["k"] if s["drive"] < 0 else max(drive[s["drive"]], 0.0)
        force = k * (length - s["rest"])
        if s["c"] > 0.0:
            now = (
                ux * (state[b, 3] - state[a, 3]) + uy * (state[b, 4] - state[a, 4])
                + tb * state[b, 5] - ta * state[a, 5]
            )
            then = (
                ux * (before[b, 0] - before[a, 0]) + uy * (before[b, 1] - before[a, 1])
                + tb * before[b, 2] - ta * before[a, 2]
            )
            free = (
                inverse_mass[a, 0] + inverse_mass[b, 0]
                + inverse_mass[a, 1] * ta * ta + inverse_mass[b, 1] * tb * tb
            )
            change = s["c"] * (1.5 * now - 0.5 * then) - s["damping"]
            s["damping"] += change / (1.0 + 0.5 * h * s["c"] * free * s["share"])
            force += s["damping"]
        s["length"], s["force"] = length, force
        s["ux"], s["uy"], s["ta"], s["tb"] = ux, uy, ta, tb
        out[a, 0] += ux * force
        out[a, 1] += uy * force
        out[a, 2] += ta * force
        out[b, 0] -= ux * force
        out[b, 1] -= uy * force
        out[b, 2] -= tb * force


@njit(cache=True)
def _dampers(
    dampers: Records, blocks: Array, state: Array, before: Array, out: Array,
) -> None:
    for i in range(len(dampers)):
        d = dampers[i]
        now = state[d["b"], 5] - state[d["a"], 5]
        then = before[d["b"], 2] - before[d["a"], 2]
        d["rhs"] = -d["c"] * (1.5 * now - 0.5 * then) - d["torque"]
    for i in range(len(dampers)):
        d = dampers[i]
        for j in range(d["size"]):
            d["torque"] += blocks[d["block"] + j] * dampers[d["first"] + j]["rhs"]
        out[d["b"], 2] += d["torque"]
        out[d["a"], 2] -= d["torque"]


def _compiled(sources: str) -> Any:
    @njit(cache=True)
    def apply_forces(
        h: float, state: Array, before: Array, pose: Array, out: Array, drive: Array,
        inverse_mass: Array, held: Array, actions: Records, springs: Records, dampers: Records,
        blocks: Array, spans: Records, nodes: Records, rows: Integers, pairs: Integers,
        starts: Integers, columns: Integers, work: Array,
    ) -> None:
        """Fill ``out`` [nb, 3] with force and torque on every body.

        ``state`` [nb, 6] is x, y, angle, vx, vy, omega as pymunk has them before the
        step; ``before`` [nb, 3] the velocities one step earlier, replaced by the
        current ones; ``pose`` [nb, 3] is filled with the predicted pose; ``drive``
        [nd] the values of the drives at the step's instant; ``held`` [nb, 3] the
        change of velocity per step that is not of our doing (joints, stops,
        contacts, gravity), a running mean. ``out`` still holds the forces of the
        last step.
        """
        assert sources  # see sandbox.engine.fingerprint
        count = len(state)
        applied = out.copy()
        velocity = np.empty((count, 3))
        for i in range(count):
            for j in range(3):
                pose[i, j] = state[i, j] + h * state[i, 3 + j]
                out[i, j] = 0.0
        _actions(actions, drive, pose, out)
        _springs(h, springs, drive, pose, state, before, inverse_mass, out)
        _dampers(dampers, blocks, state, before, out)
        for e in range(len(spans)):
            span = spans[e]
            span["length"] = measure(span, nodes, pose, False)
            if span["kind"] == PULL:
                span["tension"] = max(drive[span["drive"]], 0.0)
                add_force(span, nodes, span["tension"], out)
            elif span["kind"] == ELASTIC:
                span["tension"] = elastic_tension(h, span, nodes, state, before)
                add_force(span, nodes, span["tension"], out)
        if len(rows):
            for i in range(count):
                for j in range(3):
                    gain = h * inverse_mass[i, 1 if j == 2 else 0]
                    change = state[i, 3 + j] - before[i, j] - gain * applied[i, j]
                    held[i, j] += FOLLOW * (change - held[i, j])
                    velocity[i, j] = state[i, 3 + j] + held[i, j] + gain * out[i, j]
            solve(h, spans, nodes, rows, pairs, starts, columns, inverse_mass, velocity, work)
            for i in range(len(rows)):
                add_force(spans[rows[i]], nodes, spans[rows[i]]["tension"], out)
        for i in range(count):
            for j in range(3):
                before[i, j] = state[i, 3 + j]

    return apply_forces


apply_forces = _compiled(KERNELS)


def damper_blocks(
    h: float, bodies: list[tuple[int, int]], coefficients: list[float], inverse_inertia: Array,
) -> Array:
    """Inverse of I + h/2 C A for dampers that share bodies, row by row, shape [n * n]."""
    count = len(bodies)
    D = np.zeros((count, len(inverse_inertia)))
    for i, (a, b) in enumerate(bodies):
        D[i, b] += 1.0
        D[i, a] -= 1.0
    A = D @ (inverse_inertia[:, None] * D.T)
    C = np.array(coefficients)[:, None]
    return np.asarray(np.linalg.inv(np.eye(count) + 0.5 * h * C * A).ravel(), dtype=np.float64)
