"""The elements that carry force, each with a motion whose exact course is known.

Positions [m] and angles [rad] are compared at every sample. The scheme is a
leapfrog of second order. Constant accelerations it follows to rounding, and so it does where a
body comes to rest on a stop or on the ground: what is left of the way is made in the step in
which it ends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.mechanism import Mechanism
from sandbox.study.independent import (
    damped_spring,
    oscillation,
    slide_and_roll,
    stick_slip,
    trajectory,
)
from sandbox.study.orders import EXACT, STEPS, ExactMotion
from sandbox.study.plain_mechanisms import G, cord, fixed, mass, mechanism

INERTIA = 2e-5
SPEED = 0.5
PHASES = 16
"""Bodies that meet an obstacle, spread evenly over the coarsest step: the worst of them counts."""
COARSEST = max(STEPS)
ROUNDING = 2.0**-52
SMOOTH = "the leapfrog is of second order where the force is smooth"


def _worst(quantity: str, truth: Callable[[Array], Array]) -> Callable[[Recording], float]:
    """Largest difference of a recorded quantity from its exact course."""
    return lambda run: float(np.abs(run[quantity] - truth(run.time)).max())


def _wheel(duration: float, **more: Any) -> Callable[[float], Mechanism]:
    """A wheel on a pin in its centre."""
    body = {"name": "wheel", "mass": 0.05, "inertia": INERTIA, **more.pop("wheel", {})}
    pin = {"type": "pin", "name": "pin", "a": "wall", "b": "wheel", "on_a": (0.0, 0.0),
           **more.pop("pin", {})}
    return lambda step: mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), body], joints=[pin], **more)


def _load(duration: float, kilograms: float, **more: Any) -> Callable[[float], Mechanism]:
    """A mass and a wall with its frame at the origin."""
    load = mass("load", kilograms, more.pop("at", (0.05, 0.0)),
                velocity=more.pop("velocity", (0.0, 0.0)))
    return lambda step: mechanism(
        duration=duration, step=step, bodies=[fixed("wall"), load], **more)


def rotary_spring() -> ExactMotion:
    """A wheel on a torsion spring."""
    omega, start = 60.0, 0.3
    return ExactMotion(
        "rotary spring", _wheel(0.3, wheel={"angle": start}, springs=[
            {"type": "rotary", "name": "spring", "joint": "pin",
             "stiffness": INERTIA * omega**2}]),
        _worst("pin.angle", lambda t: start * np.cos(omega * t)), "rad", 2,
        "I θ'' = −k θ: θ = θ₀ cos ωt", SMOOTH)


def linear_spring() -> ExactMotion:
    """A mass on a straight spring, along its line."""
    return ExactMotion(
        "linear spring", _load(0.3, 0.05, at=(0.06, 0.0), springs=[
            {"type": "linear", "name": "spring", "a": "wall", "b": "load", "stiffness": 200.0,
             "rest_length": 0.05}]),
        _worst("load.x", lambda t: 0.05 + damped_spring(t, 0.05, 200.0, 0.0, 0.01)), "m", 2,
        "m x'' = −k x: x = x₀ cos ωt", SMOOTH)


def rotary_damper() -> ExactMotion:
    """A wheel that a hinge's friction stops."""
    rate, decay = 20.0, 50.0
    return ExactMotion(
        "rotary damper", _wheel(0.1, wheel={"angular_velocity": rate},
                                pin={"damping": INERTIA * decay}),
        _worst("pin.angle", lambda t: rate / decay * (1 - np.exp(-decay * t))), "rad", 2,
        "I θ'' = −c θ': θ = ω₀ (I/c) (1 − exp(−c t/I))",
        "the damper's torque is that of mid-step, solved together with the velocity")


def linear_damper() -> ExactMotion:
    """A mass that a damper stops."""
    decay = 50.0
    return ExactMotion(
        "linear damper", _load(0.1, 0.05, at=(0.1, 0.0), velocity=(SPEED, 0.0), springs=[
            {"type": "linear", "name": "damper", "a": "wall", "b": "load", "stiffness": 0.0,
             "damping": 0.05 * decay}]),
        _worst("load.x", lambda t: 0.1 + SPEED / decay * (1 - np.exp(-decay * t))), "m", 2,
        "m x'' = −c x': x = v₀ (m/c) (1 − exp(−c t/m))", "as the rotary damper")


def gravity() -> ExactMotion:
    """A pendulum of large swing, so that gravity's torque is far from linear."""
    length, kilograms, start = 0.1, 0.05, 2.0
    pivot = INERTIA + kilograms * length**2
    return ExactMotion(
        "gravity (pendulum)", lambda step: mechanism(
            duration=0.8, step=step, gravity=(0.0, -G),
            bodies=[fixed("wall"), {"name": "rod", "mass": kilograms, "inertia": INERTIA,
                                    "angle": start, "centre": (0.0, -length)}],
            joints=[{"type": "pin", "name": "pin", "a": "wall", "b": "rod", "on_a": (0.0, 0.0)}]),
        _worst("pin.angle", lambda t: trajectory(
            t, lambda _, x, v: -kilograms * G * length / pivot * np.sin(x), [start])[:, 0]),
        "rad", 2, "I_pin θ'' = −m g l sin θ (DOP853)", SMOOTH)


def pulled_tendon() -> ExactMotion:
    """A mass on the middle of a cord of constant tension."""
    pull, half, start, kilograms = 2.0, 0.05, 0.04, 0.05
    return ExactMotion(
        "pulled tendon", _load(
            0.3, kilograms, at=(start, 0.0),
            tendons=[cord("cord", ("wall", (0.0, half)), ("load",), ("wall", (0.0, -half)))],
            drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": pull}]),
        _worst("load.x", lambda t: trajectory(
            t, lambda _, x, v: -2 * pull / kilograms * x / np.hypot(x, half), [start])[:, 0]),
        "m", 2, "m x'' = −2 T x/√(x² + b²) (DOP853)", SMOOTH)


def elastic_tendon() -> ExactMotion:
    """A weight that falls into a soft cord and bounces, never slack."""
    kilograms, stiffness = 0.05, 200.0
    omega, sag = np.sqrt(stiffness / kilograms), kilograms * G / stiffness
    return ExactMotion(
        "elastic tendon", _load(
            0.3, kilograms, at=(0.0, -0.1), gravity=(0.0, -G),
            tendons=[cord("cord", ("load",), ("wall", (0.0, 0.0)), stiffness=stiffness)]),
        _worst("load.y", lambda t: -0.1 - sag * (1 - np.cos(omega * t))), "m", 2,
        "m y'' = k s − m g: s = (m g/k)(1 − cos ωt)",
        "a cord softer than 100 kN/m is a spring that only pulls, its tension that of the pose")


def damped_tendon() -> ExactMotion:
    """The same cord with a damper of its own."""
    kilograms, stiffness, damping = 0.05, 200.0, 0.8
    sag = kilograms * G / stiffness
    return ExactMotion(
        "elastic tendon with damper", _load(
            0.3, kilograms, at=(0.0, -0.1), gravity=(0.0, -G),
            tendons=[cord("cord", ("load",), ("wall", (0.0, 0.0)), stiffness=stiffness,
                          damping=damping)]),
        _worst("load.y", lambda t: -0.1 - sag + damped_spring(
            t, kilograms, stiffness, damping, sag)), "m", 2,
        "m y'' = k s + c s' − m g, under-damped", "as the linear damper")


def stiff_tendon() -> ExactMotion:
    """Atwood's machine on a cord as good as rigid.

    Its floor: each step may round poses of less than 1 m by 1 ulp.
    """
    masses, stiffness, duration = (0.2, 0.12), RIGID, 0.3
    tension = 2 * masses[0] * masses[1] * G / sum(masses)
    a = (masses[0] - masses[1]) / sum(masses) * G

    def error(run: Recording) -> float:
        settled = run.time > 0.2
        fall = -0.5 - run["heavy.y"] - (a * run.time**2 / 2 + tension / stiffness
                                        * masses[1] / sum(masses))
        return float(np.abs(fall[settled]).max())

    return ExactMotion(
        "stiff tendon", lambda step: mechanism(
            duration=duration, step=step, gravity=(0.0, -G),
            bodies=[fixed("beam"), mass("heavy", masses[0], (0.0, -0.5)),
                    mass("light", masses[1], (0.1, -0.9))],
            tendons=[cord("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)),
                          ("light",), stiffness=stiffness)]),
        error, "m", EXACT, "a = (m₁ − m₂) g/(m₁ + m₂), the cord stretched by T/k",
        "the acceleration is constant once the cord's own ringing has died, after 0.2 s; each "
        "step may round by an ulp of 1 m", floor=duration / min(STEPS) * ROUNDING)


def stop() -> ExactMotion:
    """Wheels that a hard stop holds up, each at another moment of its step.

    Its floor: impulses are held to those of the step before by 1e-10 of their effect, which
    leaves a wheel that share of its speed, for as long as the run lasts.
    """
    rate, limit, duration = 5.0, 0.4, 0.15
    starts = rate * COARSEST * np.arange(PHASES) / PHASES
    wheels = [{"name": f"wheel{i}", "mass": 0.05, "inertia": INERTIA, "at": (0.1 * i, 0.0),
               "angular_velocity": rate} for i in range(PHASES)]
    pins = [{"type": "pin", "name": f"pin{i}", "a": "wall", "b": f"wheel{i}", "on_b": (0.0, 0.0),
             "limits": (-1.0, limit - starts[i])} for i in range(PHASES)]

    def error(run: Recording) -> float:
        return max(float(np.abs(run[f"pin{i}.angle"] - np.minimum(
            rate * run.time, limit - starts[i])).max()) for i in range(PHASES))

    return ExactMotion(
        "hard stop", lambda step: mechanism(
            duration=duration, step=step, bodies=[fixed("wall"), *wheels], joints=pins),
        error, "rad", EXACT, "θ = min(ω t, limit), nothing thrown back",
        "a wheel makes what is left of its way in the step in which that ends; it may keep 1e-10 "
        "of its speed, what impulses are held by to those of the step before",
        floor=1e-10 * rate * duration)


def _plane(duration: float, friction: float, bodies: list[dict[str, Any]],
           ) -> Callable[[float], Mechanism]:
    """Bodies on a level plane, side by side."""
    return lambda step: mechanism(
        duration=duration, step=step, gravity=(0.0, -G),
        materials={"rough": {"friction": friction}},
        bodies=[fixed("plane", material="rough", shapes=[
            {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}]),
            *({"mass": 0.2, "material": "rough", **body} for body in bodies)])


def _sliding(
    name: str, friction: float, shape: dict[str, Any], slowing: float,
    path: Callable[[Array, float], Array], solution: str, why: str,
) -> ExactMotion:
    """Bodies that slide on a plane until something changes, each at another moment of its step.

    Args:
        name: of the motion.
        friction: coefficient.
        shape: of the bodies, 10 mm high over the plane.
        slowing: by how much more speed the change comes later [m/s^2].
        path: way made after times [s] from a speed [m/s].
        solution: the equation.
        why: where the order comes from.
    """
    speeds = SPEED + slowing * COARSEST * np.arange(PHASES) / PHASES
    starts = 0.2 * (np.arange(PHASES) - PHASES / 2)
    bodies = [{"name": f"body{i}", "at": (float(starts[i]), 0.01), "shapes": [shape],
               "velocity": (float(speeds[i]), 0.0)} for i in range(PHASES)]

    def error(run: Recording) -> float:
        return max(float(np.abs(run[f"body{i}.x"] - starts[i] - path(run.time, speeds[i])).max())
                   for i in range(PHASES))

    return ExactMotion(name, _plane(0.25, friction, bodies), error, "m", 2, solution, why)


DISC = {"type": "circle", "radius": 0.01}
HEIGHT = 0.02


def landing() -> ExactMotion:
    """Discs that drop on a plane, each at another moment of its step.

    Its floor: a gap of 1e-13 m is none to the engine, and poses of some 0.03 m in 600 steps
    round by less than a tenth of that.
    """
    speed = float(np.sqrt(2 * G * HEIGHT))
    heights = HEIGHT + speed * COARSEST * np.arange(PHASES) / PHASES
    discs = [{"name": f"body{i}", "mass": 0.2, "material": "smooth", "shapes": [DISC],
              "at": (0.05 * i, 0.01 + float(heights[i]))} for i in range(PHASES)]
    plane = fixed("plane", material="smooth", shapes=[
        {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}])

    def error(run: Recording) -> float:
        return max(float(np.abs(run[f"body{i}.y"] - np.maximum(
            0.01 + heights[i] - G * run.time**2 / 2, 0.01)).max()) for i in range(PHASES))

    return ExactMotion(
        "contact: the landing", lambda step: mechanism(
            duration=0.15, step=step, gravity=(0.0, -G),
            materials={"smooth": {"friction": 0.0}}, bodies=[plane, *discs]),
        error, "m", EXACT, "y = max(y₀ − g t²/2, r), nothing thrown back",
        "a fall's acceleration is constant, and a disc makes what is left of its way in the step "
        "in which that ends; a gap of 1e-13 m is none", floor=1.1e-13)


def rolling() -> ExactMotion:
    """Discs that slip on a plane until they roll."""
    return _sliding(
        "contact: slip, then rolling", 0.3, DISC, 3 * 0.3 * G,
        lambda t, speed: slide_and_roll(t, speed, 0.3, G),
        solution="x'' = −μ g, r θ'' = −2 μ g until v = r ω = 2 v₀/3",
        why="constant forces on either side; the change is spread over its step: up to "
            "μ g h²/8 in position")


def slipping() -> ExactMotion:
    """Blocks that friction brings to rest."""
    slowing = 0.4 * G

    def path(t: Array, speed: float) -> Array:
        slips = np.minimum(t, speed / slowing)
        return speed * slips - slowing * slips**2 / 2

    return _sliding(
        "contact: slip to rest", 0.4, {"type": "box", "size": (0.06, 0.02)}, slowing, path,
        solution="x'' = −μ g until x' = 0", why="as slip, then rolling")


def _dragged(name: str, block: dict[str, Any], **more: Any) -> ExactMotion:
    """Blocks that springs drag, sticking and slipping, each at another moment of its step.

    Args:
        name: of the motion.
        block: what the blocks have besides, 1 m apart on a plane 10 mm below their centres.
        more: of the mechanism.
    """
    speed, stiffness, weight = 0.1, 100.0, 1.0 * G
    ahead = COARSEST * np.arange(PHASES) / PHASES
    plane = fixed("plane", material="rough", shapes=[
        {"type": "box", "size": (2.0 * PHASES + 2.0, 0.02), "at": (0.0, -0.01)}])
    hand = {"name": "hand", "motion": "scheduled", "path": {"x": f"={speed} * t"}}
    blocks = [{"name": f"block{i}", "mass": 1.0, "at": (float(i), 0.01), **block}
              for i in range(PHASES)]
    springs = [{"type": "linear", "name": f"spring{i}", "a": f"block{i}", "b": "hand",
                "on_b": (i + 0.3 + float(speed * ahead[i]), 0.01), "rest_length": 0.3,
                "stiffness": stiffness} for i in range(PHASES)]

    def error(run: Recording) -> float:
        return max(float(np.abs(run[f"block{i}.x"] - i - stick_slip(
            run.time + ahead[i], 1.0, stiffness, speed, 0.48 * weight, 0.3 * weight)).max())
            for i in range(PHASES))

    return ExactMotion(
        name, lambda step: mechanism(
            duration=3.0, step=step, gravity=(0.0, -G), bodies=[plane, hand, *blocks],
            springs=springs, **more),
        error, "m", 2, "m x'' = k (v t − x) − 0.3 m g while it slips; it sticks up to 0.48 m g",
        "in the step in which a block breaks away friction has the share of either coefficient")


def stick_slip_joint() -> ExactMotion:
    """Blocks in grooves that hold with more than they slide with."""
    return _dragged("joint: stick-slip", {"inertia": 1e-3}, joints=[
        {"type": "slot", "name": f"slot{i}", "a": "plane", "b": f"block{i}", "turns": False,
         "start": (i - 0.1, 0.01), "end": (i + 0.5, 0.01), "friction_coefficient": 0.3,
         "static": 1.6} for i in range(PHASES)], materials={"rough": {}})


def stick_slip_contact() -> ExactMotion:
    """Blocks on a plane that holds with more than they slide with."""
    return _dragged(
        "contact: stick-slip", {"material": "rough", "shapes": [
            {"type": "box", "size": (0.06, 0.02)}]},
        materials={"rough": {"friction": 0.3, "static": 1.6}})


def after_landing() -> ExactMotion:
    """A disc on a spring along the plane, after it has dropped on the plane."""
    omega, start = 40.0, 0.02
    drop = _plane(0.3, 0.0, [
        {"name": "body", "at": (0.1 + start, 0.01 + HEIGHT), "shapes": [DISC]}])
    touch = float(np.sqrt(2 * HEIGHT / G))

    def machine(step: float) -> Mechanism:
        plain = drop(step).model_dump(by_alias=True)
        far = 1e4  # so far away that the spring's line stays level
        plain["springs"] = [{"type": "linear", "name": "spring", "a": "plane", "b": "body",
                             "on_a": (-far, 0.01), "stiffness": 0.2 * omega**2,
                             "rest_length": far + 0.1}]
        return Mechanism.model_validate(plain)

    def error(run: Recording) -> float:
        landed = run.time > touch + 0.01
        return float(np.abs(run["body.x"] - 0.1 - oscillation(run.time, omega, start))[
            landed].max())

    return ExactMotion(
        "contact: sliding after the landing", machine, error, "m", 2,
        "m x'' = −k x on a smooth plane, from 10 ms after the touch",
        "a plane without friction has no part in the motion along it")


def over_a_disc() -> ExactMotion:
    """A disc that slides, without friction, over a fixed one."""
    radius, start, duration = 0.06, 0.2, 0.1

    def truth(t: Array) -> Array:
        return trajectory(t, lambda _, x, v: G / radius * np.sin(x), [start])[:, 0]

    def machine(step: float) -> Mechanism:
        return mechanism(
            duration=duration, step=step, gravity=(0.0, -G),
            materials={"smooth": {"friction": 0.0}},
            bodies=[fixed("hill", material="smooth", shapes=[{"type": "circle", "radius": 0.05}]),
                    {"name": "body", "mass": 0.2, "material": "smooth", "shapes": [DISC],
                     "at": (radius * np.sin(start), radius * np.cos(start))}])

    def error(run: Recording) -> float:
        return float(np.abs(np.arctan2(run["body.x"], run["body.y"]) - truth(run.time)).max())

    return ExactMotion(
        "contact: over a curved body", machine, error, "rad", 2,
        "θ'' = (g/(R + r)) sin θ while pressed on (DOP853)", SMOOTH)


def elements() -> list[ExactMotion]:
    """All of them, in the order of the report."""
    return [make() for make in (
        gravity, linear_spring, rotary_spring, linear_damper, rotary_damper, pulled_tendon,
        elastic_tendon, damped_tendon, stiff_tendon, stop, landing, after_landing, over_a_disc,
        slipping, rolling, stick_slip_joint, stick_slip_contact)]
