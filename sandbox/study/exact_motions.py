"""The elements that carry force, each with a motion whose exact course is known.

Positions [m] and angles [rad] are compared at every sample. The scheme is a
leapfrog of second order; first order remains where something happens at an
instant that the step cannot know (a touch, a stop).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.elements.tendons import RIGID
from sandbox.scene.mechanism import Mechanism
from sandbox.study.independent import damped_spring, oscillation, slide_and_roll, trajectory
from sandbox.study.orders import STEPS, ExactMotion
from sandbox.study.plain_mechanisms import G, cord, fixed, mass, mechanism

INERTIA = 2e-5
SPEED = 0.5
PHASES = 16
"""Bodies that meet an obstacle, spread evenly over the coarsest step: the worst of them counts."""
COARSEST = max(STEPS)
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
        "torque extrapolated to mid-step; the matrix that steadies it acts on its change alone")


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
    """Atwood's machine on a cord as good as rigid."""
    masses, stiffness = (0.2, 0.12), RIGID
    tension = 2 * masses[0] * masses[1] * G / sum(masses)
    a = (masses[0] - masses[1]) / sum(masses) * G

    def error(run: Recording) -> float:
        settled = run.time > 0.2
        fall = -0.5 - run["heavy.y"] - (a * run.time**2 / 2 + tension / stiffness
                                        * masses[1] / sum(masses))
        return float(np.abs(fall[settled]).max())

    return ExactMotion(
        "stiff tendon", lambda step: mechanism(
            duration=0.3, step=step, gravity=(0.0, -G),
            bodies=[fixed("beam"), mass("heavy", masses[0], (0.0, -0.5)),
                    mass("light", masses[1], (0.1, -0.9))],
            tendons=[cord("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)),
                          ("light",), stiffness=stiffness)]),
        error, "m", 2, "a = (m₁ − m₂) g/(m₁ + m₂), the cord stretched by T/k", SMOOTH)


def stop() -> ExactMotion:
    """Wheels that a hard stop holds up, each at another moment of its step."""
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
        error, "rad", 1, "θ = min(ω t, limit), nothing thrown back",
        "the stop is noticed at the end of the step in which it is passed, up to ω h too late, "
        "and the overrun is brought back within 5 ms: a rebound of up to ω h / 5 ms")


def _plane(duration: float, friction: float, body: dict[str, Any]) -> Callable[[float], Mechanism]:
    return lambda step: mechanism(
        duration=duration, step=step, gravity=(0.0, -G),
        materials={"rough": {"friction": friction}},
        bodies=[fixed("plane", material="rough", shapes=[
            {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}]),
            {"name": "body", "mass": 0.2, "material": "rough", **body}])


DISC = {"type": "circle", "radius": 0.01}
HEIGHT = 0.02


def landing() -> ExactMotion:
    """Discs that drop on a plane, each at another moment of its step."""
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
        error, "m", 1, "y = max(y₀ − g t²/2, r), nothing thrown back",
        "the touch is noticed at the end of its step: up to v h too late")


def rolling() -> ExactMotion:
    """A disc that slips on a plane until it rolls."""
    return ExactMotion(
        "contact: slip, then rolling", _plane(
            0.25, 0.3, {"at": (0.0, 0.01), "shapes": [DISC], "velocity": (SPEED, 0.0)}),
        _worst("body.x", lambda t: slide_and_roll(t, SPEED, 0.3, G)), "m", 2,
        "x'' = −μ g, r θ'' = −2 μ g until v = r ω = 2 v₀/3",
        "constant forces on either side; the change falls short of its step by O(h²) in position")


def slipping() -> ExactMotion:
    """A block that friction brings to rest."""
    friction = 0.4
    end = SPEED / (friction * G)
    return ExactMotion(
        "contact: slip to rest", _plane(
            0.25, friction, {"at": (0.0, 0.01), "velocity": (SPEED, 0.0),
                             "shapes": [{"type": "box", "size": (0.06, 0.02)}]}),
        _worst("body.x", lambda t: SPEED * np.minimum(t, end)
               - friction * G * np.minimum(t, end)**2 / 2), "m", 2,
        "x'' = −μ g until x' = 0", "as slip, then rolling")


def after_landing() -> ExactMotion:
    """A disc on a spring along the plane, after it has dropped on the plane."""
    omega, start = 40.0, 0.02
    drop = _plane(0.3, 0.0, {"at": (0.1 + start, 0.01 + HEIGHT), "shapes": [DISC]})
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
        slipping, rolling)]
