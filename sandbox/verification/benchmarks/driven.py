"""Slotted links that a crank drives at a constant rate: a quick return, and pegs in slots."""

from __future__ import annotations

import math

from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    spelled,
)
from sandbox.verification.benchmarks.pieces import GROUND, pin

RATE = 10.0
"""Of every crank here [rad/s]."""
STEPS = (2e-3, 1e-3, 5e-4)
READ = 0.0235
"""Of the cubic between samples: 9/384, of the fourth derivative times h^4."""


def _read(fourth: float) -> float:
    """Floor of what is exact but for the joints' gaps and for reading it between samples.

    ``fourth`` is the fourth derivative by the crank's angle.
    """
    return 1e-8 + READ * fourth * (RATE * STEPS[0])**4


RADIUS, APART, INERTIA = 0.08, 0.2, 2e-3
POSES = {
    0: (21.8014095, -1.37931034, -24.970273, 0.215406592, 0.74278135),
    30: (16.1021138, -2.30769231, -11.956958, 0.249799920, 0.55470020),
    90: (0.0, -2.85714286, 0.0, 0.28, 0.0),
    270: (0.0, 6.66666667, 0.0, 0.12, 0.0),
}
"""By the crank's angle [deg]: the lever's from upright [deg], its rate and acceleration [rad/s],
[rad/s^2], from its pivot to the pin [m], and how fast that grows [m/s]."""
SWING, PIN_FORCE, CRANK_TORQUE = 23.5781785, 0.0957322824, 0.0055185961
"""Largest angle of the lever [deg]; at 30 deg [N], [N m]."""
FURTHEST = math.tau - math.asin(RADIUS / APART)
"""Of the crank [rad], where it stands across the lever."""
LEVER = RATE * RADIUS / (APART - RADIUS)
"""Fastest rate of the lever [rad/s]."""
BEND = RADIUS * APART * (APART + RADIUS) / (APART - RADIUS)**3
"""Largest third derivative of its angle by the crank's, where it is fastest."""


def lever(step: float) -> Json:
    """A motor turns the crank, whose pin slides in the lever."""
    turn = math.tau / RATE
    begun = math.radians(POSES[0][0]), POSES[0][1]
    return spelled(
        turn + math.radians(30) / RATE, step,
        bodies=[GROUND,
                {"name": "crank", "mass": 0.1, "inertia": 1e-4, "angular_velocity": RATE},
                {"name": "lever", "at": [0.0, -APART], "angle": -begun[0], "mass": 0.5,
                 "inertia": INERTIA, "angular_velocity": -begun[1]}],
        joints=[pin("ground", "crank"), pin("ground", "lever"),
                {"type": "slot", "name": "groove", "a": "lever", "b": "crank",
                 "on_b": [RADIUS, 0.0], "start": [0.0, 0.05], "end": [0.0, 0.35]}],
        drives=[{"type": "motor", "name": "motor", "joint": "ground_crank", "value": RATE,
                 "torque": 1.0}],
        meters=[
            {"name": "phi", "value": "=-lever.angle", "unit": "rad"},
            {"name": "phi_rate", "value": "=-lever.omega", "unit": "rad/s"},
            {"name": "phi_rate_rate", "value": "=-lever.alpha", "unit": "rad/s^2"},
            {"name": "rho", "unit": "m", "value": f"={RADIUS} * sin(crank.angle - lever.angle) + "
             f"{APART} * cos(lever.angle)"},
            {"name": "slide", "unit": "m/s",
             "value": f"={RADIUS} * crank.omega * cos(crank.angle - lever.angle)"}])


def _poses(quantity: str, column: int, factor: float = 1.0) -> list[Digit]:
    """At 30, 90 and 270 deg, and at 0 and 30 deg of the second turn."""
    return [at(quantity, math.radians(angle) / RATE, factor * POSES[angle % 360][column],
               f"{quantity} at {angle} deg") for angle in (30, 90, 270, 360, 390)]


KEPT = "kept by joints and motor; the cubic between samples at the coarsest step"
QUICK_RETURN = Benchmark(
    "quick_return", "Quick return",
    "A crank of 80 mm at 10 rad/s whose pin slides in a lever that turns about a pivot 200 mm "
    "below: the lever returns 1.71 times faster than it goes.",
    "A textbook's mechanism with numbers of our own. Digits by the closed form tan φ = r cos θ / "
    "(d + r sin θ), its derivatives, and statics.",
    "Nothing: the crank is turned by a motor, the lever is balanced on its pivot.",
    lever, STEPS,
    (Criterion("rates of the lever", "rad/s", _poses("phi_rate", 1), RATE * BEND, RATE,
               "third derivative of its angle times h²: means over half a step", floor=5e-9),
     Criterion("angle of the lever", "rad",
               [*_poses("phi", 0, math.pi / 180),
                at("phi", FURTHEST / RATE, math.radians(SWING), "largest phi")],
               0.0, RATE, KEPT, EXACT, _read(3 * BEND)),
     Criterion("acceleration of the lever", "rad/s^2", _poses("phi_rate_rate", 2), LEVER**2,
               LEVER, "ω² times (h ω)²"),
     Criterion("from pivot to pin", "m", _poses("rho", 3), 0.0, RATE, KEPT, EXACT,
               _read(RADIUS)),
     Criterion("speed of the pin in the lever", "m/s", _poses("slide", 4), 0.0, RATE, KEPT, EXACT,
               _read(RADIUS * RATE)),
     Criterion("force on the pin", "N",
               [at("groove.reaction", math.radians(390) / RATE, PIN_FORCE, "at 390 deg")],
               INERTIA * LEVER**2 / (APART - RADIUS), LEVER, "I ω² / ρ times (h ω)²"),
     Criterion("torque on the crank", "N m",
               [at("motor.torque", math.radians(390) / RATE, CRANK_TORQUE, "at 390 deg")],
               INERTIA * LEVER**2, LEVER, "I ω² times (h ω)²")),
    {"bodies[lever].inertia": 1.01 * INERTIA}, drawn="quick return")

CENTRES = 0.05
"""Of driver and wheel [m]."""
PEGS = {
    4: ((10, 22.018003, 1.83053472), (20, 35.782907, 0.96135632), (0, 0.0, 2.41421356)),
    6: ((10, 9.706481, 0.91406849), (20, 17.877987, 0.70847916), (0, 0.0, 1.0)),
}
"""By the number of slots: the driver's angle from the line of centres [deg], the wheel's [deg],
and the ratio of their rates."""


def wheel(step: float, slots: int) -> Json:
    """From the peg's entry to its exit; the driver is on a schedule."""
    radius, entry = CENTRES * math.sin(math.pi / slots), math.pi / 2 - math.pi / slots
    far = CENTRES * math.cos(math.pi / slots)
    return spelled(
        2 * entry / RATE, step, parameters={"radius": radius},
        bodies=[GROUND,
                {"name": "driver", "motion": "scheduled",
                 "path": {"angle": f"={RATE} * t - {entry!r}"}},
                {"name": "wheel", "at": [CENTRES, 0.0], "angle": math.pi / slots, "mass": 0.05,
                 "inertia": 1e-5}],
        joints=[pin("ground", "wheel"),
                {"type": "slot", "name": "peg", "a": "wheel", "b": "driver",
                 "on_b": ["=radius", 0.0], "start": [-1.1 * far, 0.0],
                 "end": [-0.5 * (CENTRES - radius), 0.0]}],
        meters=[{"name": "turned", "value": "=-wheel.angle", "unit": "rad"},
                {"name": "ratio", "value": f"=-wheel.omega / {RATE}", "unit": "1"}])


def _peg(slots: int) -> Benchmark:
    entry = 90 - 180 // slots
    ratio = math.sin(math.pi / slots)
    bend = ratio * (1 + ratio) / (1 - ratio)**3

    def instant(angle: float) -> float:
        return math.radians(entry + angle) / RATE

    angles = [at("turned", instant(angle), math.radians(turned), f"wheel at {angle} deg")
              for angle, turned, _ in PEGS[slots]]
    angles.append(at("turned", instant(entry), math.pi / slots, f"wheel at {entry} deg"))
    ratios = [at("ratio", instant(angle), rates, f"ratio at {angle} deg")
              for angle, _, rates in PEGS[slots]]
    ratios.append(at("ratio", instant(entry), 0.0, f"ratio at {entry} deg"))
    return Benchmark(
        f"geneva_{slots}", f"Peg in one of {slots} slots",
        f"A Geneva wheel of {slots} slots, 50 mm from its driver, which turns at 10 rad/s: from "
        f"where the peg enters, at −{entry}°, to where it leaves.",
        "A textbook's mechanism with numbers of our own. Digits by the closed form λ (cos α − λ) / "
        "(1 − 2 λ cos α + λ²), λ = sin(π/n).",
        "The slot is a joint without play, and there is no locking disc: the wheel is looked at "
        "while the peg is in it.",
        lambda step: wheel(step, slots), STEPS,
        (Criterion("ratio of the rates", "1", ratios, bend, RATE,
                   "its second derivative by the driver's angle, λ (1 + λ) / (1 − λ)³ at most, "
                   "times (h ω)²: means over half a step", floor=5e-9),
         Criterion("angle of the wheel", "rad", angles, 0.0, RATE,
                   "kept by the joints; the cubic between samples at the coarsest step", EXACT,
                   _read(3 * bend / (1 - ratio)))),
        {"parameters.radius": 1.01 * CENTRES * math.sin(math.pi / slots)})


BENCHMARKS = (QUICK_RETURN, *(_peg(slots) for slots in PEGS))
