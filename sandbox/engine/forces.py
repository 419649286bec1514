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

from sandbox.engine.fingerprint import KERNELS
from sandbox.engine.network import add_force, elastic_tension, measure, solve
from sandbox.engine.state import ELASTIC, PULL, Constants, Result, State
from sandbox.numeric import Array

FOLLOW = 0.1
"""Fraction of the newest step in the running mean of what joints and contacts do."""


@njit(cache=True)
def _actions(constants: Constants, state: State, result: Result, drive: Array) -> None:
    pose, out = result.pose, state.force
    for i in range(len(constants.actions)):
        action, action_result = constants.actions[i], result.actions[i]
        value, a = drive[action["drive"]], action["a"]
        if action["motor"]:
            continue
        if action["b"] >= 0:
            action_result["torque"] = action["sense"] * value
            if action["spring"] >= 0:
                angle = pose[action["b"], 2] - pose[a, 2]
                action_result["torque"] = -value * (angle - action["rest"])
            out[action["b"], 2] += action_result["torque"]
            out[a, 2] -= action_result["torque"]
            continue
        c, s = math.cos(pose[a, 2]), math.sin(pose[a, 2])
        fx, fy = value * action["dx"], value * action["dy"]
        if action["turning"]:
            fx, fy = c * fx - s * fy, s * fx + c * fy
        rx, ry = c * action["x"] - s * action["y"], s * action["x"] + c * action["y"]
        action_result["fx"], action_result["fy"] = fx, fy
        action_result["torque"] = rx * fy - ry * fx
        out[a, 0] += fx
        out[a, 1] += fy
        out[a, 2] += action_result["torque"]


@njit(cache=True)
def _springs(constants: Constants, state: State, result: Result, drive: Array) -> None:
    h, inverse_mass = constants.h, constants.inverse_mass
    pose, body, before, out = result.pose, state.body, state.before, state.force
    for i in range(len(constants.springs)):
        s, memory, spring_result = constants.springs[i], state.springs[i], result.springs[i]
        a, b = s["a"], s["b"]
        ca, sa = math.cos(pose[a, 2]), math.sin(pose[a, 2])
        cb, sb = math.cos(pose[b, 2]), math.sin(pose[b, 2])
        ax, ay = ca * s["ax"] - sa * s["ay"], sa * s["ax"] + ca * s["ay"]
        bx, by = cb * s["bx"] - sb * s["by"], sb * s["bx"] + cb * s["by"]
        dx, dy = pose[b, 0] + bx - pose[a, 0] - ax, pose[b, 1] + by - pose[a, 1] - ay
        length = math.hypot(dx, dy)
        ux, uy = (dx / length, dy / length) if length > 0.0 else (0.0, 0.0)
        ta, tb = ax * uy - ay * ux, bx * uy - by * ux
        k = s["k"] if s["drive"] < 0 else drive[s["drive"]]
        force = k * (length - s["rest"])
        if s["c"] > 0.0:
            now = (
                ux * (body[b, 3] - body[a, 3]) + uy * (body[b, 4] - body[a, 4])
                + tb * body[b, 5] - ta * body[a, 5]
            )
            then = (
                ux * (before[b, 0] - before[a, 0]) + uy * (before[b, 1] - before[a, 1])
                + tb * before[b, 2] - ta * before[a, 2]
            )
            free = (
                inverse_mass[a, 0] + inverse_mass[b, 0]
                + inverse_mass[a, 1] * ta * ta + inverse_mass[b, 1] * tb * tb
            )
            change = s["c"] * (1.5 * now - 0.5 * then) - memory["damping"]
            memory["damping"] += change / (1.0 + 0.5 * h * s["c"] * free * s["sharing"])
            force += memory["damping"]
        spring_result["length"], spring_result["force"] = length, force
        spring_result["ux"], spring_result["uy"] = ux, uy
        spring_result["ta"], spring_result["tb"] = ta, tb
        out[a, 0] += ux * force
        out[a, 1] += uy * force
        out[a, 2] += ta * force
        out[b, 0] -= ux * force
        out[b, 1] -= uy * force
        out[b, 2] -= tb * force


@njit(cache=True)
def _dampers(constants: Constants, state: State, result: Result) -> None:
    body, before, out = state.body, state.before, state.force
    for i in range(len(constants.dampers)):
        d = constants.dampers[i]
        now = body[d["b"], 5] - body[d["a"], 5]
        then = before[d["b"], 2] - before[d["a"], 2]
        result.dampers[i]["wanted"] = (
            -d["c"] * (1.5 * now - 0.5 * then) - state.dampers[i]["torque"])
    for i in range(len(constants.dampers)):
        d, memory = constants.dampers[i], state.dampers[i]
        for j in range(d["size"]):
            memory["torque"] += (
                constants.damper_inverse[d["block"] + j] * result.dampers[d["first"] + j]["wanted"])
        out[d["b"], 2] += memory["torque"]
        out[d["a"], 2] -= memory["torque"]


def _compiled(sources: int) -> Any:
    @njit(cache=True)
    def apply_forces(constants: Constants, state: State, result: Result, drive: Array) -> None:
        """Fill ``state.force`` with the force and torque on every body for the coming step.

        ``drive`` [nd] holds the values of the drives at the step's instant. The
        memories in ``state`` go on by one step meanwhile, and ``result`` is filled.
        """
        assert sources != 0  # see sandbox.engine.fingerprint
        h, inverse_mass = constants.h, constants.inverse_mass
        body, before, held, out = state.body, state.before, state.held, state.force
        count = len(body)
        applied = out.copy()
        velocity = np.empty((count, 3))
        for i in range(count):
            for j in range(3):
                result.pose[i, j] = body[i, j] + h * body[i, 3 + j]
                out[i, j] = 0.0
        _actions(constants, state, result, drive)
        _springs(constants, state, result, drive)
        _dampers(constants, state, result)
        for e in range(len(constants.cords)):
            cord, cord_result = constants.cords[e], result.cords[e]
            cord_result["length"] = measure(
                cord, constants.guides, state.guides, result.guides, result.pose, False)
            if cord["kind"] == PULL:
                cord_result["tension"] = drive[cord["drive"]]
                add_force(constants, result, e, out)
            elif cord["kind"] == ELASTIC:
                cord_result["tension"] = elastic_tension(constants, state, result, e)
                add_force(constants, result, e, out)
        if len(constants.rows):
            for i in range(count):
                for j in range(3):
                    # change of velocity in a step for 1 N or 1 N m
                    per_force = h * inverse_mass[i, 1 if j == 2 else 0]
                    change = body[i, 3 + j] - before[i, j] - per_force * applied[i, j]
                    held[i, j] += FOLLOW * (change - held[i, j])
                    velocity[i, j] = body[i, 3 + j] + held[i, j] + per_force * out[i, j]
            solve(constants, state, result, velocity)
            for i in range(len(constants.rows)):
                add_force(constants, result, constants.rows[i], out)
        for i in range(count):
            for j in range(3):
                before[i, j] = body[i, 3 + j]

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
