"""How objects are held: contacts and pushes of a disc between fingertips, stiffness of a grasp."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.grasp_stiffness import grasp_map, grasp_stiffness, tip_jacobian
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.study.plain_mechanisms import fixed, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

H, R, TIP, N = 5e-4, 0.02, 0.006, 2.0
DISC, FINGERTIP = 0.1, 0.02
"""Masses [kg]."""
SEEN = 1e-9
"""A way of the disc [m] from which on it moves."""
TURNS = np.radians([[110.0, -60.0], [70.0, 60.0]])
LINKS, BASE, SPRING = (0.04, 0.03), 0.03, 0.05


def _held(
    mu: float, around: Sequence[float], *, duration: float, pushed: float = 0.0, rise: float = 0.0,
    direction: float = 0.0,
) -> Recording:
    """A disc between fingertips at angles [deg] round it, each on a guide and pressed with N.

    From 0.1 s on it is pushed in a ``direction`` [deg] by ``pushed`` [N] and more, with ``rise``
    [N/s].
    """
    bodies: list[dict[str, Any]] = [
        fixed("frame"),
        {"name": "disc", "mass": DISC, "role": "object", "material": "rubber",
         "shapes": [{"type": "circle", "radius": R}]}]
    joints, drives = [], []
    for i, degrees in enumerate(around):
        out = np.array([math.cos(math.radians(degrees)), math.sin(math.radians(degrees))])
        bodies.append({"name": f"finger{i}", "at": tuple((R + TIP) * out), "mass": FINGERTIP,
                       "role": "phalanx", "material": "rubber",
                       "shapes": [{"type": "circle", "radius": TIP}]})
        joints.append({"type": "slot", "name": f"guide{i}", "a": "frame", "b": f"finger{i}",
                       "on_b": (0.0, 0.0), "turns": False, "start": tuple(0.2 * R * out),
                       "end": tuple(3 * R * out)})
        drives.append({"type": "force", "name": f"press{i}", "body": f"finger{i}",
                       "direction": tuple(-out), "value": N})
    way = math.radians(direction)
    drives.append({
        "type": "force", "name": "push", "body": "disc", "direction": (math.cos(way),
                                                                       math.sin(way)),
        "value": {"table": [[0.0, 0.0], [0.1, pushed],
                            [duration, pushed + rise * (duration - 0.1)]]}})
    return simulate(mechanism(
        duration=duration, step=H, run={"sample_rate": 1 / H}, bodies=bodies, joints=joints,
        drives=drives, materials={"rubber": {"friction": mu}},
        contacts=[{"between": ("finger*", "finger*"), "collide": False}]))


def _contacts() -> Findings:
    """Closed forms of epsilon, from contacts that a run has recorded."""
    checks = []
    for mu in (0.1, 0.5, 0.9):
        for around, what, expected in (
            ((0.0, 180.0), "two", mu / math.sqrt(2 + mu**2)), ((90.0, 210.0, 330.0), "three", mu),
        ):
            run = _held(mu, around, duration=0.3)
            checks += [
                Check(f"ε, {what} contacts, μ = {mu:g}", "1", expected,
                      float(run["disc.epsilon"][-1]), 1e-9, "rounding of places"),
                Check(f"held, {what} contacts, μ = {mu:g}", "1", 1.0,
                      float(run["disc.held"][-1]), 0.0, "at rest for 0.2 s"),
            ]
    smooth = _held(0.0, (90.0, 210.0, 330.0), duration=0.3)
    checks.append(Check("ε without friction", "1", 0.0, float(smooth["disc.epsilon"][-1]), 0.0,
                        "nothing turns a smooth disc"))
    return Findings(checks)


def _pushes() -> Findings:
    """The push at which a disc between three fingertips begins to move, direction by direction."""
    mu, rise = 0.4, 2.0
    tangents = np.radians([180.0, 300.0, 60.0])
    mass = DISC + 3 * FINGERTIP
    allowed = rise * (H + (6 * mass * SEEN / rise) ** (1 / 3))
    directions = np.array([0.0, 10.0, 20.0, 30.0, 75.0, 100.0, 200.0, 330.0])
    limits = [1.5 * mu * N / float(np.abs(np.cos(np.radians(d) - tangents)).max())
              for d in directions]
    checks, found = [], []
    for d, limit in zip(directions, limits, strict=True):
        run = _held(mu, (90.0, 210.0, 330.0), duration=0.3, pushed=limit - 0.1, rise=rise,
                    direction=float(d))
        moved = np.hypot(run["disc.x"], run["disc.y"]) > SEEN
        found.append(float(run["push.value"][moved.argmax()]) if moved.any() else math.inf)
        checks.append(Check(f"push at {d:g} deg that moves it", "N", limit, found[-1], allowed,
                            f"what it rises by until the disc has come {SEEN:g} m"))
    fine = np.arange(0.0, 361.0)
    curve = 1.5 * mu * N / np.abs(np.cos(np.radians(fine)[:, None] - tangents)).max(axis=1)
    return Findings(checks, [Panel("Pushes that move a disc", "direction [deg]", "push [N]", [
        Curve("3/2 μ N / max |cos|", fine, curve),
        Curve("engine", directions, np.array(found), "points")])])


def _hand() -> tuple[Array, Array]:
    """Hinges [4, 2], finger by finger, and tips [2, 2] of two mirrored fingers."""
    hinges, tips = [], []
    for base, (first, second) in zip((-BASE, BASE), TURNS, strict=True):
        knee = np.array([base, 0.0]) + LINKS[0] * np.array([math.cos(first), math.sin(first)])
        hinges += [np.array([base, 0.0]), knee]
        turned = first + second
        tips.append(knee + LINKS[1] * np.array([math.cos(turned), math.sin(turned)]))
    return np.array(hinges), np.array(tips)


def _pinned(load: Sequence[float]) -> Array:
    """How far a body between the tips of fingers on springs moves under a small load, [3]."""
    hinges, tips = _hand()
    centre = tips.mean(axis=0)
    bodies: list[dict[str, Any]] = [
        fixed("palm"), {"name": "held", "at": tuple(centre), "mass": 1e-3, "inertia": 1e-7}]
    joints, springs = [], []
    for f, (first, second) in enumerate(TURNS):
        names = ["palm", f"proximal{f}", f"distal{f}"]
        for i, (angle, rest) in enumerate(((first, first), (first + second, second))):
            bodies.append({"name": names[i + 1], "at": tuple(hinges[2 * f + i]), "angle": angle,
                           "mass": 1e-3, "inertia": 1e-7})
            joints.append({"type": "pin", "name": f"hinge{f}{i}", "a": names[i],
                           "b": names[i + 1], "on_b": (0.0, 0.0)})
            springs.append({"type": "rotary", "name": f"spring{f}{i}", "joint": f"hinge{f}{i}",
                            "rest_angle": rest, "stiffness": SPRING, "damping": 2e-4})
        joints.append({"type": "pin", "name": f"tip{f}", "a": names[2], "b": "held",
                       "on_a": (LINKS[1], 0.0)})
    parts = (("x", (1.0, 0.0), (0.0, 0.0), load[0]), ("y", (0.0, 1.0), (0.0, 0.0), load[1]),
             ("one", (1.0, 0.0), (0.0, -1.0), load[2] / 2),
             ("other", (-1.0, 0.0), (0.0, 1.0), load[2] / 2))
    run = simulate(mechanism(
        duration=0.9, step=H, run={"sample_rate": 50}, bodies=bodies, joints=joints,
        springs=springs, drives=[
            {"type": "force", "name": name, "body": "held", "at": at, "direction": along,
             "value": size} for name, along, at, size in parts]))
    return np.array([run["held.x"][-1] - centre[0], run["held.y"][-1] - centre[1],
                     run["held.angle"][-1]])


def _stiffness() -> Findings:
    """Half of what opposite loads differ by, in which nothing of second order is left."""
    hinges, tips = _hand()
    K = grasp_stiffness(
        grasp_map(tips, tips.mean(axis=0)),
        tip_jacobian(tips, hinges, [[True, True, False, False], [False, False, True, True]]),
        np.full(4, SPRING))
    checks = []
    for load in ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-5), (5e-4, -1e-3, 8e-6)):
        moved = (_pinned(load) - _pinned([-each for each in load])) / 2
        expected = np.linalg.solve(K, np.array(load))
        name = f"{1e3 * load[0]:g} mN, {1e3 * load[1]:g} mN, {1e6 * load[2]:g} μN m"
        most = float(np.hypot(*expected[:2])) + BASE * abs(float(expected[2]))
        for axis, unit, arm in ((0, "m", 1.0), (1, "m", 1.0), (2, "rad", BASE)):
            if expected[axis] and abs(expected[axis]) * arm > 1e-12:
                checks.append(Check(
                    f"{'xyθ'[axis]} under {name}", unit, float(expected[axis]),
                    float(moved[axis]), 2e-6 * most / arm,
                    "hinges turn by some 1e-3 rad, of which the square is left"))
    return Findings(checks)


CASES = (
    Case("grasp_closure", "Force closure of a held disc", "ε = μ / √(2 + μ²), ε = μ",
         "a disc between two and three fingertips pressed with 2 N, h = 0.5 ms",
         "Ferrari and Canny's measure of recorded contacts; that the disc rests", _contacts),
    Case("grasp_push", "The push that moves a held disc", "F = 3/2 μ N / max |cos(α − αᵢ)|",
         "a disc of 100 g between three fingertips pressed with 2 N, μ = 0.4, h = 0.5 ms",
         "the push at its centre at which it begins to move, in eight directions", _pushes),
    Case("grasp_stiffness", "Stiffness of a grasp", "K = G (J Kq⁻¹ Jᵀ)⁻¹ Gᵀ",
         "a body between two fingers of two joints on springs of 0.05 N m/rad",
         "how far small loads move it", _stiffness),
)
