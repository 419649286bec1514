"""The finger under control, and the brake that locks a hinge."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene
from sandbox.study.plain_mechanisms import fixed, mechanism
from sandbox.study.reference_fingers import SET_A
from sandbox.verification.cases.case import Case, Check, Findings

REST = 12.0
"""Of a run to its rest [s]: the slowest pole of the loops is at 1.4/s, e^-16 is left."""
LEFT = 1e-5
"""What may be left of a difference after that, as a fraction."""
INERTIA, HEAVY = 2e-4, 0.05
"""Of an arm [kg m^2], and a load on it [N m]."""


def _at_rest(scene: str, **overrides: float) -> Recording:
    return simulate(load_scene(scene, overrides={
        "run.duration": REST, "run.step": 4e-4, "run.sample_rate": 50, "expect": [],
        **{f"parameters.{key}": value for key, value in overrides.items()}}))


HINGES, TARGET = ("mcp", "pip", "dip"), np.radians([5.0, 10.0, 15.0])
LIMITS = (0.5, 6.0)
"""Of the controlled stiffness, in shares of Set A's."""
TENDON, SPRINGS = route(SET_A.guides, SET_A.lengths), spring_set(SET_A.before, SET_A.after)


def _per_pull(theta: Array) -> Array:
    """H / (dlm hm): the stiffness per pull that holds a pose [1/m], shape [..., 3]."""
    return np.asarray(TENDON.arms(theta) / (SPRINGS.elongations(theta) * SPRINGS.arms(theta)))


def _rest(pull: float) -> Array:
    """Where Set A's springs hold a pull, below the folds [rad], shape [3]."""
    def torque(angle: float, joint: int) -> float:
        theta = np.full(3, angle)
        back = SPRINGS.elongations(theta) * SPRINGS.arms(theta)
        return float((pull * TENDON.arms(theta) - np.array(SET_A.stiffness) * back)[joint])

    return np.array([brentq(torque, 0.0, np.radians(30.0), args=(joint,), xtol=1e-14)
                     for joint in range(3)])


def _stiffness() -> Findings:
    checks: list[Check] = []
    pulls, found = (8.0, 10.0, 15.0, 20.0), []
    for pull in pulls:
        run = _at_rest("finger_stiffness_15N", pull=pull)
        ends = [float(run[f"k{i}.value"][-1]) for i in (1, 2, 3)]
        found.append(ends)
        checks += [
            Check(f"stiffness over the {hinge} at {pull:g} N", "N/m", float(k), end,
                  LEFT * float(k), f"the integral after {REST:g} s: e^-16 and rounding")
            for hinge, k, end in zip(HINGES, pull * _per_pull(TARGET), ends, strict=True)]
    fine = np.linspace(7.0, 22.5, 60)
    lines = fine[:, None] * _per_pull(TARGET)
    curves = []
    for i, hinge in enumerate(HINGES):
        curves += [Curve(f"{hinge}, T h / (Δlm hm)", fine, lines[:, i]),
                   Curve(f"{hinge}, engine", np.array(pulls), np.array(found)[:, i], "points")]
    return Findings(checks, [Panel("Stiffness that holds 5/10/15 deg", "pull [N]",
                                   "stiffness [N/m]", curves)])


def _pull() -> Findings:
    """The pull and pose at which the tendon is as much shorter as at the target."""
    checks = []
    shortening = float(TENDON.shortening(TARGET))
    pull = brentq(lambda pull: float(TENDON.shortening(_rest(pull))) - shortening, 3.0, 4.9,
                  xtol=1e-12)
    pose = _rest(pull)
    run = simulate(load_scene("finger_force_control", overrides={
        "run.duration": REST, "run.step": 4e-4, "run.sample_rate": 50, "expect": [],
        "controllers[0].target": shortening}))
    why = f"the integral after {REST:g} s"
    checks.append(Check("pull", "N", pull, float(run["pull.value"][-1]), LEFT * pull, why))
    checks += [Check(f"rotation of the {hinge}", "deg", float(np.degrees(angle)),
                     float(np.degrees(run[f"finger.{hinge}.angle"][-1])),
                     LEFT * float(np.degrees(angle)), why)
               for hinge, angle in zip(HINGES, pose, strict=True)]
    return Findings(checks)


def _least() -> Findings:
    """Bisection between a pull that does not lead all joints to the target and one that does."""
    low, high = 6.5, 7.2
    while high - low > 0.01:
        middle = (low + high) / 2
        run = simulate(load_scene("finger_stiffness_15N", overrides={
            "parameters.pull": middle, "run.duration": 6.0, "run.step": 4e-4,
            "run.sample_rate": 100, "expect": []}))
        ends = np.array([run[f"finger.{hinge}.angle"][-1] for hinge in HINGES])
        reached = bool((np.abs(ends / TARGET - 1) < 1e-3).all())
        low, high = (low, middle) if reached else (middle, high)
    least = float((LIMITS[0] * np.array(SET_A.stiffness) / _per_pull(TARGET)).max())
    return Findings([Check(
        "least pull", "N", least, (low + high) / 2, (high - low) / 2 + 0.006,
        "half of the last interval, and 1e-3 of 5 deg at 0.92 deg/N")])


def _brake() -> Findings:
    step, checks = 5e-4, []
    for hold in (0.0, 0.02, 0.04, 0.06):
        run = simulate(mechanism(
            duration=0.3, step=step, bodies=[
                fixed("base"), {"name": "arm", "mass": 0.1, "inertia": INERTIA}],
            joints=[{"type": "pin", "name": "axle", "a": "base", "b": "arm", "on_a": (0.0, 0.0)}],
            drives=[{"type": "torque", "name": "load", "joint": "axle", "value": HEAVY},
                    {"type": "brake", "name": "brake", "joint": "axle", "value": hold}]))
        a = float(run["arm.alpha"][-1])
        checks += [
            Check(f"acceleration, brake of {hold:g} N m", "rad/s^2",
                  max(0.0, HEAVY - hold) / INERTIA, a, 1e-9 * HEAVY / INERTIA,
                  "a constant torque: the scheme is exact"),
            Check(f"its torque, brake of {hold:g} N m", "N m", 0.0 - min(hold, HEAVY),
                  float(run["brake.torque"][-1]), 1e-9 * HEAVY, "the solver's impulse")]
    return Findings(checks)


def _servos() -> Findings:
    """The two arms and the crane of the scenes."""
    arms, crane = simulate(load_scene("servo_arm")), simulate(load_scene("linear_actuator"))
    goal, weight, k = np.pi / 3, 2.0 * 9.81 * 0.3, 40.0
    sags = brentq(lambda q: k * (goal - q) - weight * np.cos(q), 0.0, goal)
    angle, boom = float(crane["foot.angle"][-1]), 100.0 + 30.0 / 2
    px, py = 0.6 * np.cos(np.pi / 4), 0.6 * np.sin(np.pi / 4)
    length = float(np.hypot(px - 0.4, py + 0.5))
    gone = float((arms["right.angle"] - goal).max())
    step = 5e-4 * 5e-4 * 12.0 / (2.0 * 0.3**2 + 0.0016) / 8
    return Findings([
        Check("angle with a stiffness", "rad", sags, float(arms["left.angle"][-1]), 1e-6,
              "e^(-t k / c) of the way is left after 3 s"),
        Check("angle of the rigid one", "rad", goal, float(arms["right.angle"][-1]), 1e-9,
              "held to the solver's rounding"),
        Check("its torque", "N m", weight * np.cos(goal), float(arms["stiff.torque"][-1]), 1e-8,
              "the same"),
        Check("how far it went beyond", "rad", 0.0, max(gone, 0.0), step, "a h² / 8"),
        Check("the crane's boom", "rad", np.pi / 4, angle, 1e-9, "the same, of a length"),
        Check("force of its cylinder", "N", boom * 9.81 * np.cos(np.pi / 4) / (
            (0.4 * py + 0.5 * px) / length), float(crane["lift.force"][-1]), 10.0,
            "the load swings by some thousandths still"),
    ])


CASES = (
    Case("pull_control", "The pull controlled: Figure 18", "T hᵢ = kᵢ Δlmᵢ hmᵢ, (17)–(19), (29)",
         "finger_force_control, h = 0.4 ms", "pull and rotations with the closed form's", _pull),
    Case("stiffness_control", "The stiffness controlled: Figures 19 and 20",
         "kᵢ = T hᵢ / (Δlmᵢ hmᵢ)", "finger_stiffness_15N at 8 to 20 N, h = 0.4 ms",
         "stiffnesses at rest with the closed form's", _stiffness),
    Case("least_pull", "The least pull that holds a pose", "T_min = maxᵢ kᵢ,min Δlmᵢ hmᵢ / hᵢ",
         "finger_stiffness_15N, halving between 6.5 and 7.2 N", "with the closed form", _least),
    Case("brake", "A brake holds, or slips", "I α = max(0, τ − τ_brake)",
         "an arm under 0.05 N m with brakes of 0 to 0.06 N m, h = 0.5 ms",
         "acceleration and the brake's torque", _brake),
    Case("servos", "Servos and a cylinder go to their places",
         "k (u − q) = m g l cos q, F d = Σ m g x",
         "servo_arm and linear_actuator, h = 0.5 ms", "angles, torques, force at rest", _servos),
)
