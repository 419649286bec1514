"""Controllers: pull and stiffness of a finger, servos and a cylinder."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.optimize import brentq

from sandbox.elements.controllers.pid import PidController
from sandbox.engine.simulate import simulate
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.targets import BAND, settling_time
from sandbox.scene.expand import expand
from sandbox.scene.read.load import load_scene
from tests.support.reference import SET_A

from .case import Check, case
from .test_fingers import rest_angles

JOINTS = ("mcp", "pip", "dip")
TARGET = np.radians([5.0, 10.0, 15.0])
"""Pose of the paper's Table 2 [rad]."""
ROUTE, SPRINGS = route(SET_A.guides, SET_A.lengths), spring_set(SET_A.before, SET_A.after)


def per_pull(theta: Array) -> Array:
    """Stiffness that holds a pose by pull, h / (Δlm hm) [1/m], shape [..., 3]."""
    return np.asarray(ROUTE.arms(theta) / (SPRINGS.elongations(theta) * SPRINGS.arms(theta)))


MIN_PULL = float((0.5 * np.array(SET_A.stiffness) / per_pull(TARGET)).max())
"""Pull at which the softest spring of a joint, half of Table 2's, still holds the pose [N]."""


def controlled(scene: str, duration: float, **overrides: float) -> Recording:
    return simulate(load_scene(scene, overrides={
        "run.duration": duration, "run.step": 4e-4, "expect": [],
        **{key.replace("__", "."): value for key, value in overrides.items()}}))


def angles(run: Recording) -> Array:
    """Final joint angles [rad]."""
    return np.array([run[f"finger.{name}.angle"][-1] for name in JOINTS])


@case("Pull control: Figure 18", "T hᵢ = kᵢ Δlmᵢ hmᵢ, (17)–(19), (29)",
      "the scene `finger_force_control`, 12 s, h = 0.4 ms")
def test_pull_control() -> Iterator[Check]:
    shortening = float(ROUTE.shortening(TARGET))
    pull = float(brentq(lambda pull: float(ROUTE.shortening(rest_angles(SET_A, pull))) - shortening,
                        0.0, 5.0, xtol=1e-12))
    run = simulate(load_scene("finger_force_control", overrides={
        "run.duration": 12.0, "run.step": 4e-4, "run.sample_rate": 50, "expect": [],
        "controllers[0].target": shortening}))
    degrees, why = np.degrees(rest_angles(SET_A, pull)), "the integral after 12 s: e⁻¹⁶ is left"
    yield Check("pull", "N", pull, run["pull.value"][-1], 1e-5 * pull, why)
    yield Check("joint angles", "deg", degrees, np.degrees(angles(run)), 1e-5 * degrees, why)


@case("Stiffness control: Figures 19 and 20", "kᵢ = T hᵢ / (Δlmᵢ hmᵢ)",
      "the scene `finger_stiffness_15N` at 8 to 20 N, 12 s, h = 0.4 ms")
def test_stiffness_control() -> Iterator[Check]:
    for pull in (8.0, 15.0, 20.0):
        run = controlled("finger_stiffness_15N", 12.0, parameters__pull=pull, run__sample_rate=50)
        k = pull * per_pull(TARGET)
        yield Check(f"stiffnesses at {pull:g} N", "N/m", k,
                    [run[f"k{i}.value"][-1] for i in (1, 2, 3)], 1e-5 * k,
                    "the integral after 12 s: e⁻¹⁶ is left, and rounding")


@case("Least pull that holds a pose", "T_min = maxᵢ kᵢ,min Δlmᵢ hmᵢ / hᵢ",
      "the scene `finger_stiffness_15N`, 6 s, 10 mN below and 5 mN above")
def test_least_pull() -> Iterator[Check]:
    """At 0.01 N below T_min the knuckle is 1.8e-3 short of its 5 deg."""
    for off, expected in ((-0.01, 0.0), (0.005, 1.0)):
        run = controlled("finger_stiffness_15N", 6.0, parameters__pull=MIN_PULL + off,
                         run__sample_rate=100)
        reached = float((np.abs(angles(run) / TARGET - 1) < 1e-3).all())
        yield Check(f"whether T_min {1e3 * off:+g} mN reaches the pose", "1", expected, reached,
                    0.0, "all joints within 1e-3 of their angles")


def settling(pull: float) -> float:
    """Settling time of the slowest joint by quadrature of its slow motion [s].

    Each joint stays where T g(theta) = k with k = k0 + Kp e + KI ∫e dt, from the first rest (where
    the integral is still 0) into the band around the target.
    """
    loops = [each for each in expand(load_scene("finger_stiffness_10N")).controllers
             if isinstance(each, PidController) and each.limits]
    times = [0.0]
    for joint, (loop, k0) in enumerate(zip(loops, SET_A.stiffness, strict=True)):
        kp, ki, target = -loop.kp, -loop.ki, float(TARGET[joint])

        def needed(theta: Array, joint: int = joint) -> Array:
            pose = np.tile(TARGET, (len(theta), 1))
            pose[:, joint] = theta
            return per_pull(pose)[:, joint]

        theta = np.linspace(1e-3, np.radians(75.0), 4000)
        k = np.clip(k0 + kp * (theta - target), *loop.limits)
        over = pull * needed(theta) - k
        i = np.flatnonzero((over[:-1] > 0) & (over[1:] <= 0))[0]
        away = (theta[i] + (theta[i + 1] - theta[i]) * over[i] / (over[i] - over[i + 1])) - target
        if abs(away) > BAND * target:
            e = np.sign(away) * np.geomspace(BAND * target, abs(away), 400)
            slope = np.gradient(needed(target + e), e, edge_order=2)
            times.append(float(np.trapezoid((kp - pull * slope) / (ki * e), e)))
    return max(times)


@case("Settling of controlled stiffness", "ė = −KI e / (Kp − T g′), g = h/(Δlm hm)",
      "the scene `finger_stiffness_10N` at 7.5 to 22 N, 4 s, h = 0.4 ms")
def test_slow_motion() -> Iterator[Check]:
    for pull in (7.5, 15.0, 22.0):
        run = controlled("finger_stiffness_10N", 4.0, parameters__pull=pull)
        slowest = max(
            settling_time(run.time, run[f"finger.{name}.angle"], np.full(len(run), target))
            for name, target in zip(JOINTS, TARGET, strict=True))
        yield Check(f"settling time at {pull:g} N", "s", settling(pull), slowest, 0.1,
                    "the first swings, which the slow motion leaves out, last 0.1 s")


@case("Servos and a cylinder at their targets", "k (u − q) = m g l cos q, F d = Σ m g x",
      "the scenes `servo_arm` and `linear_actuator`, h = 0.5 ms")
def test_servos() -> Iterator[Check]:
    arms, crane = simulate(load_scene("servo_arm")), simulate(load_scene("linear_actuator"))
    goal, weight, k = np.pi / 3, 2.0 * 9.81 * 0.3, 40.0
    yield Check("angle with a stiffness", "rad", brentq(
        lambda q: k * (goal - q) - weight * np.cos(q), 0.0, goal), arms["left.angle"][-1], 1e-6,
        "e^(−t k / c) of the way is left after 3 s")
    yield Check("angles of the rigid servo and of the crane's boom", "rad", [goal, np.pi / 4],
                [arms["right.angle"][-1], crane["foot.angle"][-1]], 1e-9, "the solver's rounding")
    yield Check("torque of the rigid servo", "N m", weight * np.cos(goal),
                arms["stiff.torque"][-1], 1e-8, "the same")
    yield Check("its overshoot", "rad", 0.0, max((arms["right.angle"] - goal).max(), 0.0),
                5e-4**2 * 12.0 / (2.0 * 0.3**2 + 0.0016) / 8, "a h² / 8")
    x = y = 0.6 * math.sqrt(0.5)
    arm = (0.4 * y + 0.5 * x) / math.hypot(x - 0.4, y + 0.5)
    yield Check("force of the cylinder", "N", (100.0 + 30.0 / 2) * 9.81 * math.sqrt(0.5) / arm,
                crane["lift.force"][-1], 10.0, "the load still swings by some thousandths")
