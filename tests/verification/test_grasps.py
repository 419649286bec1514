"""Held objects: force closure, the push that moves a disc, the stiffness of a grasp."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from sandbox.mechanics.grasp_stiffness import grasp_map, grasp_stiffness, tip_jacobian
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import Json, fixed, force, pin, simulated

from .case import Check, case

H, R, TIP, PRESS = 5e-4, 0.02, 0.006, 2.0
DISC, FINGERTIP = 0.1, 0.02
"""Masses [kg]."""


def held(mu: float, around: Sequence[float], pushed: float = 0.0, rise: float = 0.0,
         direction: float = 0.0) -> Recording:
    """Disc between fingertips at angles [deg], each on a guide and pressed with 2 N, for 0.3 s.

    From 0.1 s on it is pushed in a direction [deg] by ``pushed`` [N], rising by ``rise`` [N/s].
    """
    bodies: list[Json] = [fixed("frame"), {
        "name": "disc", "mass": DISC, "role": "object", "material": "rubber",
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
        drives.append(force(f"press{i}", f"finger{i}", (-out[0], -out[1]), PRESS))
    way = math.radians(direction)
    drives.append(force("push", "disc", (math.cos(way), math.sin(way)), {
        "table": [[0.0, 0.0], [0.1, pushed], [0.3, pushed + rise * 0.2]]}))
    return simulated(
        0.3, H, every_step=True, bodies=bodies, joints=joints, drives=drives,
        materials={"rubber": {"friction": mu}},
        contacts=[{"between": ("finger*", "finger*"), "collide": False}])


@case("Force closure of a held disc", "ε = μ / √(2 + μ²), ε = μ",
      "Ferrari and Canny's measure of a disc between two and three fingertips pressed with 2 N")
def test_grasp_closure() -> Iterator[Check]:
    for mu in (0.1, 0.5, 0.9):
        for around, expected in (((0.0, 180.0), mu / math.sqrt(2 + mu**2)),
                                 ((90.0, 210.0, 330.0), mu)):
            run, what = held(mu, around), f"contacts {len(around)}, μ = {mu:g}"
            yield Check(f"ε, {what}", "1", expected, run["disc.epsilon"][-1], 1e-9,
                        "rounding of positions")
            yield Check(f"held, {what}", "1", 1.0, run["disc.held"][-1], 0.0, "at rest for 0.2 s")
    yield Check("ε without friction", "1", 0.0,
                held(0.0, (90.0, 210.0, 330.0))["disc.epsilon"][-1], 0.0,
                "nothing turns a smooth disc")


@case("Push that moves a held disc", "F = 3/2 μ N / max |cos(α − αᵢ)|",
      "a disc of 100 g between three fingertips pressed with 2 N, μ = 0.4, eight directions")
def test_grasp_push() -> Iterator[Check]:
    mu, rise, seen = 0.4, 2.0, 1e-9
    tangents = np.radians([180.0, 300.0, 60.0])
    allowed = rise * (H + (6 * (DISC + 3 * FINGERTIP) * seen / rise)**(1 / 3))
    for degrees in (0.0, 10.0, 20.0, 30.0, 75.0, 100.0, 200.0, 330.0):
        limit = 1.5 * mu * PRESS / float(np.abs(np.cos(np.radians(degrees) - tangents)).max())
        run = held(mu, (90.0, 210.0, 330.0), limit - 0.1, rise, degrees)
        moved = np.hypot(run["disc.x"], run["disc.y"]) > seen
        yield Check(f"push at {degrees:g}°", "N", limit,
                    run["push.value"][moved.argmax()] if moved.any() else math.inf, allowed,
                    f"its rise until the disc has moved {seen:g} m")


LINKS, BASE, SPRING = (0.04, 0.03), 0.03, 0.05


def two_fingers() -> tuple[Array, Array, Array]:
    """Joint angles, hinges [4, 2], finger by finger, and tips [2, 2] of two mirrored fingers."""
    turns = np.radians([[110.0, -60.0], [70.0, 60.0]])
    base = np.array([-BASE, BASE], dtype=complex)
    knee = base + LINKS[0] * np.exp(1j * turns[:, 0])
    tips = knee + LINKS[1] * np.exp(1j * turns.sum(axis=1))
    hinges = np.stack([base, knee], axis=1).ravel()
    return turns, np.column_stack([hinges.real, hinges.imag]), np.column_stack(
        [tips.real, tips.imag])


def displaced(load: Sequence[float]) -> Array:
    """Displacement (x, y, angle) of a body between the tips of sprung fingers under a load."""
    turns, hinges, tips = two_fingers()
    centre = tips.mean(axis=0)
    bodies = [fixed("palm"), {"name": "held", "at": tuple(centre), "mass": 1e-3, "inertia": 1e-7}]
    joints, springs = [], []
    for f, (first, second) in enumerate(turns):
        names = ["palm", f"proximal{f}", f"distal{f}"]
        for i, (angle, rest) in enumerate(((first, first), (first + second, second))):
            bodies.append({"name": names[i + 1], "at": tuple(hinges[2 * f + i]), "angle": angle,
                           "mass": 1e-3, "inertia": 1e-7})
            joints.append(pin(f"hinge{f}{i}", names[i], names[i + 1]))
            springs.append({"type": "rotary", "name": f"spring{f}{i}", "joint": f"hinge{f}{i}",
                            "rest_angle": rest, "stiffness": SPRING, "damping": 2e-4})
        joints.append(pin(f"tip{f}", names[2], "held", on_a=(LINKS[1], 0.0)))
    couple = [{**force(name, "held", (sign, 0.0), load[2] / 2), "at": (0.0, -sign)}
              for name, sign in (("one", 1.0), ("other", -1.0))]
    run = simulated(
        0.9, H, run={"sample_rate": 50}, bodies=bodies, joints=joints, springs=springs,
        drives=[force("x", "held", (1.0, 0.0), load[0]), force("y", "held", (0.0, 1.0), load[1]),
                *couple])
    return np.array([run["held.x"][-1] - centre[0], run["held.y"][-1] - centre[1],
                     run["held.angle"][-1]])


@case("Stiffness of a grasp", "K = G (J Kq⁻¹ Jᵀ)⁻¹ Gᵀ",
      "a body between two fingers of two joints on springs of 0.05 N m/rad, small loads")
def test_grasp_stiffness() -> Iterator[Check]:
    """Half the difference of opposite loads has no second-order term."""
    _, hinges, tips = two_fingers()
    K = grasp_stiffness(
        grasp_map(tips, tips.mean(axis=0)),
        tip_jacobian(tips, hinges, [[True, True, False, False], [False, False, True, True]]),
        np.full(4, SPRING))
    arms = np.array([1.0, 1.0, BASE])
    for load in ((1e-3, 0.0, 0.0), (0.0, 1e-3, 0.0), (0.0, 0.0, 1e-5), (5e-4, -1e-3, 8e-6)):
        moved = (displaced(load) - displaced([-each for each in load])) / 2
        expected = np.linalg.solve(K, np.array(load))
        size = np.hypot(*expected[:2]) + BASE * abs(expected[2])
        yield Check(f"displacement in m (angle times 30 mm) under {1e3 * load[0]:g} mN, "
                    f"{1e3 * load[1]:g} mN, {1e6 * load[2]:g} μN m", "m", expected * arms,
                    moved * arms, 2e-6 * size, "the square of turns of some 1e-3 rad")
