"""Orders of accuracy: how fast the error of each element falls as the step is halved.

With errors e(h) = C h^p at h, h/2, h/4 against an exact solution, p = log2(e(h) / e(h/2)). Motions
that the scheme makes exactly have rounding errors only, which are compared with a floor. Events
within a step are met by 16 bodies that reach them at different moments of the coarsest step.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json, cable, fixed, mass, pin, simulated, spring
from tests.support.reference import integrate, stick_slip

from .case import STEPS, Check, case, order_check

INERTIA, SPEED, PHASES = 2e-5, 0.5, 16
AHEAD = max(STEPS) * np.arange(PHASES) / PHASES
"""By which the bodies are ahead of each other [s]."""
RUN = "errors of the motion at h = 1, 0.5 and 0.25 ms; theory: "
SMOOTH = f"{RUN}order 2, as the leapfrog has for smooth forces"
Run = Callable[[float], Recording]
Truth = Callable[[Array], Array]


def errors(run: Run, truths: dict[str, Truth], after: float = 0.0) -> list[float]:
    """Largest errors of quantities at every step, later than ``after`` [s]."""
    found = []
    for step in STEPS:
        recording = run(step)
        late = recording.time > after
        found.append(max(float(np.abs(recording[name] - truth(recording.time))[late].max())
                         for name, truth in truths.items()))
    return found


def second_order(run: Run, truths: dict[str, Truth], after: float = 0.0) -> Iterator[Check]:
    for (h, k), (a, b) in zip(pairwise(STEPS), pairwise(errors(run, truths, after)), strict=True):
        yield order_check("the motion", 2, h, k, a, b)


def rounding_only(run: Run, truths: dict[str, Truth], unit: str, floor: float, why: str,
                  after: float = 0.0) -> Iterator[Check]:
    yield Check("largest errors at the three steps", unit, 0.0, errors(run, truths, after), floor,
                why)


def cosine(omega: float, start: float) -> Truth:
    return lambda t: start * np.cos(omega * t)


def damped(m: float, stiffness: float, damping: float, start: float) -> Truth:
    """Position of m x'' + c x' + k x = 0 from rest at ``start``, under-damped."""
    decay = damping / (2 * m)
    omega = np.sqrt(stiffness / m - decay**2)
    return lambda t: start * np.exp(-decay * t) * (
        np.cos(omega * t) + decay / omega * np.sin(omega * t))


def oscillated(acceleration: Callable[[float], float], start: float) -> Truth:
    """Position of x'' = acceleration(x) from rest at ``start``, by an integration of order 8."""
    return lambda t: integrate(lambda _, y: [y[1], acceleration(y[0])], [start, 0.0], t)[:, 0]


def wheel(duration: float, body: Json, joint: Json, **more: Any) -> Run:
    """Wheel on a pin in its centre."""
    return lambda step: simulated(
        duration, step, bodies=[fixed("wall"), {
            "name": "wheel", "mass": 0.05, "inertia": INERTIA, **body}],
        joints=[pin("pin", "wall", "wheel", on_a=(0.0, 0.0), **joint)], **more)


def load(duration: float, at: tuple[float, float], g: float = 0.0, speed: float = 0.0,
         **more: Any) -> Run:
    """Mass of 50 g and a wall with its frame at the origin."""
    return lambda step: simulated(
        duration, step, g=g,
        bodies=[fixed("wall"), mass("load", 0.05, at, velocity=(speed, 0.0))], **more)


@case("Order of accuracy: gravity (pendulum)", "I_pin θ″ = −m g l sin θ", SMOOTH)
def test_order_gravity_pendulum() -> Iterator[Check]:
    length, m, start = 0.1, 0.05, 2.0
    pull = m * G * length / (INERTIA + m * length**2)
    yield from second_order(lambda step: simulated(
        0.8, step, g=G, bodies=[fixed("wall"), {
            "name": "rod", "mass": m, "inertia": INERTIA, "angle": start,
            "centre": (0.0, -length)}], joints=[pin("pin", "wall", "rod", on_a=(0.0, 0.0))]),
        {"pin.angle": oscillated(lambda x: -pull * float(np.sin(x)), start)})


@case("Order of accuracy: linear spring", "m x″ = −k x: x = x₀ cos ωt", SMOOTH)
def test_order_linear_spring() -> Iterator[Check]:
    swing = damped(0.05, 200.0, 0.0, 0.01)
    yield from second_order(load(0.3, (0.06, 0.0), springs=[spring(
        "spring", "wall", "load", stiffness=200.0, rest_length=0.05)]),
        {"load.x": lambda t: 0.05 + swing(t)})


@case("Order of accuracy: rotary spring", "I θ″ = −k θ: θ = θ₀ cos ωt", SMOOTH)
def test_order_rotary_spring() -> Iterator[Check]:
    yield from second_order(wheel(0.3, {"angle": 0.3}, {}, springs=[
        {"type": "rotary", "name": "spring", "joint": "pin", "stiffness": INERTIA * 60.0**2}]),
        {"pin.angle": cosine(60.0, 0.3)})


DAMPED = f"{RUN}order 2: the damper acts with the velocity of mid-step, solved together with it"


def linear_damper() -> Run:
    return load(0.1, (0.1, 0.0), speed=SPEED, springs=[spring(
        "damper", "wall", "load", stiffness=0.0, damping=0.05 * 50.0)])


@case("Order of accuracy: linear damper", "m x″ = −c x′: x = v₀ (m/c) (1 − e^(−c t/m))", DAMPED)
def test_order_linear_damper() -> Iterator[Check]:
    yield from second_order(linear_damper(), {
        "load.x": lambda t: 0.1 + SPEED / 50.0 * (1 - np.exp(-50.0 * t))})


@case("Order of accuracy: rotary damper", "I θ″ = −c θ′: θ = ω₀ (I/c) (1 − e^(−c t/I))", DAMPED)
def test_order_rotary_damper() -> Iterator[Check]:
    rate, decay = 20.0, 50.0
    yield from second_order(
        wheel(0.1, {"angular_velocity": rate}, {"damping": INERTIA * decay}),
        {"pin.angle": lambda t: rate / decay * (1 - np.exp(-decay * t))})


@case("Order of accuracy: pulled tendon", "m x″ = −2 T x/√(x² + b²)", SMOOTH)
def test_order_pulled_tendon() -> Iterator[Check]:
    pull, half, start = 2.0, 0.05, 0.04
    yield from second_order(load(
        0.3, (start, 0.0),
        tendons=[cable("cord", ("wall", (0.0, half)), ("load",), ("wall", (0.0, -half)))],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": pull}]),
        {"load.x": oscillated(lambda x: -2 * pull / 0.05 * x / float(np.hypot(x, half)), start)})


def on_cable(damping: float) -> tuple[Run, dict[str, Truth]]:
    """Weight that falls into a soft cord and bounces, never slack."""
    k, sag = 200.0, 0.05 * G / 200.0
    swing = damped(0.05, k, damping, sag)
    return load(0.3, (0.0, -0.1), g=G, tendons=[cable(
        "cord", ("load",), ("wall", (0.0, 0.0)), stiffness=k, damping=damping)]), {
            "load.y": lambda t: -0.1 - sag + swing(t)}


@case("Order of accuracy: elastic tendon", "m y″ = k s − m g: s = (m g/k)(1 − cos ωt)",
      f"{RUN}order 2: a cord softer than 100 kN/m is a spring that only pulls")
def test_order_elastic_tendon() -> Iterator[Check]:
    yield from second_order(*on_cable(0.0))


@case("Order of accuracy: elastic tendon with damper", "m y″ = k s + c s′ − m g, under-damped",
      DAMPED)
def test_order_elastic_tendon_with_damper() -> Iterator[Check]:
    yield from second_order(*on_cable(0.8))


@case("Order of accuracy: joint limit", "θ = min(ω t, limit), no rebound",
      f"{RUN}exact: a wheel makes the rest of its way in the step in which that ends")
def test_order_hard_stop() -> Iterator[Check]:
    rate, limit, duration = 5.0, 0.4, 0.15
    limits = limit - rate * AHEAD
    yield from rounding_only(lambda step: simulated(
        duration, step, bodies=[fixed("wall"), *(
            {"name": f"wheel{i}", "mass": 0.05, "inertia": INERTIA, "at": (0.1 * i, 0.0),
             "angular_velocity": rate} for i in range(PHASES))],
        joints=[pin(f"pin{i}", "wall", f"wheel{i}", limits=(-1.0, limits[i]))
                for i in range(PHASES)]),
        {f"pin{i}.angle": lambda t, i=i: np.minimum(rate * t, limits[i])  # type: ignore[misc]
         for i in range(PHASES)}, "rad", 1e-10 * rate * duration,
        "a wheel may keep 1e-10 of its speed, the accuracy of impulses")


DISC = {"type": "circle", "radius": 0.01}
BOX = {"type": "box", "size": (0.06, 0.02)}


def plane(duration: float, friction: Json, bodies: list[Json], width: float = 4.0, **more: Any,
          ) -> Run:
    """Bodies on a level plane, their material too."""
    return lambda step: simulated(
        duration, step, g=G, materials={"rough": friction}, bodies=[
            fixed("plane", material="rough", shapes=[
                {"type": "box", "size": (width, 0.02), "at": (0.0, -0.01)}]),
            *({"mass": 0.2, "material": "rough", **body} for body in bodies)], **more)


@case("Order of accuracy: landing", "y = max(y₀ − g t²/2, r), no rebound",
      f"{RUN}exact: a disc makes the rest of its way in the step in which that ends")
def test_order_contact_the_landing() -> Iterator[Check]:
    heights = 0.02 + np.sqrt(2 * G * 0.02) * AHEAD
    yield from rounding_only(plane(0.15, {"friction": 0.0}, [
        {"name": f"body{i}", "shapes": [DISC], "at": (0.05 * i, 0.01 + float(heights[i]))}
        for i in range(PHASES)]),
        {f"body{i}.y": lambda t, i=i: np.maximum(  # type: ignore[misc]
            0.01 + heights[i] - G * t**2 / 2, 0.01) for i in range(PHASES)}, "m", 1.1e-13,
        "a gap of 1e-13 m is none; poses of 0.03 m in 600 steps round by a tenth of that")


@case("Order of accuracy: sliding after the landing",
      "m x″ = −k x on a smooth plane, from 10 ms after the touch",
      f"{RUN}order 2: a plane without friction does not act along it")
def test_order_contact_sliding_after_the_landing() -> Iterator[Check]:
    omega, start, far = 40.0, 0.02, 1e4  # so far that the spring stays level
    swing = cosine(omega, start)
    yield from second_order(plane(
        0.3, {"friction": 0.0}, [{"name": "body", "at": (0.1 + start, 0.03), "shapes": [DISC]}],
        springs=[spring("spring", "plane", "body", on_a=(-far, 0.01), stiffness=0.2 * omega**2,
                        rest_length=far + 0.1)]),
        {"body.x": lambda t: 0.1 + swing(t)}, after=float(np.sqrt(2 * 0.02 / G)) + 0.01)


def sliding(friction: float, shape: Json, slowing: float, path: Callable[[Array, float], Array],
            ) -> Iterator[Check]:
    """Bodies that slide until something changes, ``slowing`` [m/s^2] times their phase later."""
    speeds, starts = SPEED + slowing * AHEAD, 0.2 * (np.arange(PHASES) - PHASES / 2)
    yield from second_order(plane(0.25, {"friction": friction}, [
        {"name": f"body{i}", "at": (float(starts[i]), 0.01), "shapes": [shape],
         "velocity": (float(speeds[i]), 0.0)} for i in range(PHASES)]),
        {f"body{i}.x": lambda t, i=i: starts[i] + path(t, speeds[i])  # type: ignore[misc]
         for i in range(PHASES)})


SPREAD = f"{RUN}order 2: constant forces, the change is spread over its step, up to μ g h²/8"


@case("Order of accuracy: slip to rest", "x″ = −μ g until x′ = 0", SPREAD)
def test_order_contact_slip_to_rest() -> Iterator[Check]:
    def path(t: Array, speed: float) -> Array:
        slips = np.minimum(t, speed / (0.4 * G))
        return speed * slips - 0.4 * G * slips**2 / 2

    yield from sliding(0.4, BOX, 0.4 * G, path)


@case("Order of accuracy: slip, then rolling", "x″ = −μ g, r θ″ = −2 μ g until v = r ω = 2 v₀/3",
      SPREAD)
def test_order_contact_slip_then_rolling() -> Iterator[Check]:
    def path(t: Array, speed: float) -> Array:
        change = speed / (3 * 0.3 * G)
        slips = np.minimum(t, change)
        return (speed * slips - 0.3 * G * slips**2 / 2 + 2 * speed / 3 * np.maximum(t - change, 0))

    yield from sliding(0.3, DISC, 3 * 0.3 * G, path)


def dragged(friction: Json, block: Json, **more: Any) -> Iterator[Check]:
    """Blocks of 1 kg that springs drag, sticking and slipping, 1 m apart."""
    speed, k = 0.1, 100.0
    blocks = [{"name": "hand", "motion": "scheduled", "path": {"x": f"={speed} * t"}}, *(
        {"name": f"block{i}", "mass": 1.0, "at": (float(i), 0.01), **block}
        for i in range(PHASES))]
    yield from second_order(plane(
        3.0, friction, blocks, 2.0 * PHASES + 2.0, springs=[spring(
            f"spring{i}", f"block{i}", "hand", rest_length=0.3, stiffness=k,
            on_b=(i + 0.3 + float(speed * AHEAD[i]), 0.01)) for i in range(PHASES)], **more),
        {f"block{i}.x": lambda t, i=i: i + stick_slip(  # type: ignore[misc]
            t + AHEAD[i], 1.0, k, speed, 0.48 * G, 0.3 * G) for i in range(PHASES)})


STICK = "m x″ = k (v t − x) − 0.3 m g while it slips; it sticks up to 0.48 m g"
SHARE = f"{RUN}order 2: where a block breaks away, each friction acts for its share of the step"


@case("Order of accuracy: stick-slip in a slot", STICK, SHARE)
def test_order_joint_stick_slip() -> Iterator[Check]:
    yield from dragged({}, {"inertia": 1e-3}, joints=[
        {"type": "slot", "name": f"slot{i}", "a": "plane", "b": f"block{i}", "turns": False,
         "start": (i - 0.1, 0.01), "end": (i + 0.5, 0.01), "friction_coefficient": 0.3,
         "static": 1.6} for i in range(PHASES)])


@case("Order of accuracy: stick-slip of a contact", STICK, SHARE)
def test_order_contact_stick_slip() -> Iterator[Check]:
    yield from dragged({"friction": 0.3, "static": 1.6}, {"shapes": [BOX]})
