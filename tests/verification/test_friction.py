"""Dry friction of contacts, joints and brakes; motors, conveyors, and joints that break or form."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json, fixed, force, pin, simulated

from .case import Check, case

H = 5e-4
CONSTANT = "a constant force: the scheme is exact"


def on_plane(degrees: float, friction: float, speed: float = 0.0) -> Recording:
    """Block of 200 g at rest on a plane falling toward +x, or with a speed along it [m/s]."""
    slope = math.radians(degrees)
    c, s = math.cos(slope), math.sin(slope)
    return simulated(
        0.5, H, g=G, materials={"rough": {"friction": friction}},
        bodies=[fixed("plane", angle=-slope, material="rough", shapes=[
            {"type": "box", "size": (4.0, 0.02), "at": (0.0, -0.01)}]),
            {"name": "block", "mass": 0.2, "at": (0.01 * s, 0.01 * c), "angle": -slope,
             "material": "rough", "shapes": [{"type": "box", "size": (0.06, 0.02)}],
             "velocity": (speed * c, -speed * s)}])


@case("Block on a slope", "a = max(0, g (sin − μ cos))", "planes of 5 to 40°, μ = 0.4, h = 0.5 ms")
def test_incline() -> Iterator[Check]:
    for degrees in (5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0):
        run = on_plane(degrees, 0.4)
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        speed = np.hypot(run["block.vx"], run["block.vy"])
        yield Check(f"acceleration at {degrees:g}°", "m/s^2", max(0.0, G * (s - 0.4 * c)),
                    (speed[-1] - speed[100]) / (run.time[-1] - run.time[100]), 1e-8 * G, CONSTANT)
        normal, friction = (run[f"block.contact.{key}"][-1] for key in ("normal", "tangential"))
        yield Check(f"normal force and friction at {degrees:g}°", "N",
                    [0.2 * G * c, 0.2 * G * min(0.4 * c, s)], [normal, abs(friction)],
                    1e-8 * 0.2 * G * c, "the law itself: two corners, solved together")
        if s < 0.4 * c:
            yield Check(f"creep at {degrees:g}°", "m", 0.0,
                        np.hypot(*(run[f"block.{key}"][-1] - run[f"block.{key}"][100]
                                   for key in "xy")), 1e-9, "it sticks: 1 nm in 0.4 s")


def pinned(body: Json, *drives: Json, duration: float, **more: Any) -> Recording:
    return simulated(duration, H, g=G, bodies=[fixed("ground"), body], drives=list(drives),
                     joints=[pin("p", "ground", body["name"], on_a=(0.0, 0.0), **more)])


@case("Pendulum with dry friction in its pin", "m g l sin α = τ α",
      "an arm of 0.5 kg released level, h = 0.5 ms")
def test_pin_friction() -> Iterator[Check]:
    m, arm, inertia = 0.5, 0.08, 1e-3
    weight = m * G * arm
    body = {"name": "arm", "mass": m, "inertia": inertia, "at": (arm, 0.0)}
    for degrees in (90.0, 120.0, 150.0):
        turn = math.radians(degrees)
        run = pinned(body, duration=0.6, positive="clockwise",
                     friction=weight * math.sin(turn) / turn)
        yield Check(f"turning point, τ for {degrees:g}°", "rad", turn, run["p.angle"].max(),
                    2.0 * weight / (inertia + m * arm**2) * H**2, "α h²: the step of the turn")
    held = pinned(body, duration=0.2, friction=1.001 * weight)
    yield Check("held by a little more than its weight", "rad", 0.0, held["p.angle"], 1e-12,
                "rounding: nothing creeps")
    yield Check("torque of friction that holds it", "N m", weight, held["p.friction"][-1],
                1e-9 * weight, "as much as needed")


@case("Journal with friction by its load", "α = μ R N / I",
      "a flywheel of 2 kg on a pin of 10 mm, μ = 0.15, h = 0.5 ms")
def test_journal() -> Iterator[Check]:
    mu, journal, m, spin = 0.15, 0.01, 2.0, 3.0
    inertia = m * 0.07**2 / 2
    run = pinned({"name": "wheel", "mass": m, "inertia": inertia, "angular_velocity": spin},
                 duration=0.7, friction_coefficient=mu, pin_radius=journal)
    alpha = mu * journal * m * G / inertia
    slows = run.time < spin / alpha - H
    yield Check("angular acceleration", "rad/s^2", -alpha, run["wheel.alpha"][slows].mean(),
                1e-9 * alpha, "rounding")
    yield Check("angle at standstill", "rad", spin**2 / (2 * alpha), run["wheel.angle"][-1],
                alpha * H**2 / 2, "α h²/2: the step in which it stops")
    yield Check("friction circle: arm of the reaction", "m", mu * journal,
                np.abs(run["p.friction"] / run["p.reaction"])[slows].max(), 1e-9 * journal,
                "friction follows the reaction that closely")


@case("Dry friction along a slot", "a = max(0, g (sin − μ cos))",
      "a block on slots of 5 to 45°, μ = 0.3; one that a rising force breaks away")
def test_groove_friction() -> Iterator[Check]:
    def block(duration: float, end: tuple[float, float], g: float, drives: list[Json],
              **friction: float) -> Recording:
        return simulated(
            duration, H, g=g, drives=drives,
            bodies=[fixed("ground"), {"name": "block", "mass": 1.0, "inertia": 1e-3}],
            joints=[{"type": "slot", "name": "s", "a": "ground", "b": "block",
                     "start": (-end[0], -end[1]), "end": end, **friction}])

    mu = 0.3
    for degrees in (5.0, 10.0, 15.0, 16.5, 17.0, 20.0, 30.0, 45.0):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        run = block(0.2, (c, s), G, [], friction_coefficient=mu)
        yield Check(f"acceleration at {degrees:g}°", "m/s^2", max(0.0, G * (s - mu * c)),
                    -(c * run["block.ax"][-1] + s * run["block.ay"][-1]), 1e-8 * G, CONSTANT)
    rise, slides, static = 8.0, 2.0, 1.5
    run = block(0.6, (1, 0), 0.0, [force("push", "block", (1, 0), f"={rise} * t")],
                friction=slides, static=static)
    yield Check("instant at which a rising force breaks it away", "s", static * slides / rise,
                run.time[np.flatnonzero(run["s.sticks"] == 0.0)[0]], 2 * H,
                "a step, and one sample after it")
    yield Check("friction from then on", "N", slides, -run["s.friction"][-1], 1e-12, "rounding")


@case("Motors with a torque-speed line", "ω = ω₀ (1 − e^(−t/τ))",
      "a flywheel of 0.002 kg m², stall torque 0.4 N m, 50 rad/s without load, h = 0.5 ms")
def test_motor_line() -> Iterator[Check]:
    stall, free, inertia = 0.4, 50.0, 2e-3
    lag = inertia * free / stall
    for what, more in (("full", {}), ("half the torque", {"torque": stall / 2}),
                       ("reversed", {"value": f"={free} if t < 0.5 else -{free}"})):
        run = pinned({"name": "wheel", "mass": 1.0, "inertia": inertia},
                     {"type": "motor", "name": "m", "joint": "p", "stall": stall, "no_load": free,
                      **more}, duration=1.0)
        t = run.time
        truth = free * (1 - np.exp(-t / lag))
        if what == "half the torque":
            truth = np.where(t < lag, free / 2 * t / lag,
                             free * (1 - np.exp(-np.maximum(t - lag, 0.0) / lag) / 2))
        if what == "reversed":
            top = free * (1 - math.exp(-0.5 / lag))
            truth = np.where(t < 0.5, truth,
                             -free + (top + free) * np.exp(-np.maximum(t - 0.5, 0.0) / lag))
        yield Check(f"{what}: speed", "rad/s", truth, run["p.rate"],
                    free * (H / lag)**2 / 7 * (2 if what == "reversed" else 1),
                    "a sample is the mean of two speeds, off by ω″ h²/8; twice that if reversed")


@case("Brake that holds or slips", "I α = max(0, τ − τ_brake)",
      "an arm under 0.05 N m with brakes of 0 to 0.06 N m, h = 0.5 ms")
def test_brake() -> Iterator[Check]:
    inertia, load = 2e-4, 0.05
    for hold in (0.0, 0.02, 0.04, 0.06):
        run = simulated(
            0.3, H, bodies=[fixed("base"), {"name": "arm", "mass": 0.1, "inertia": inertia}],
            joints=[pin("axle", "base", "arm", on_a=(0.0, 0.0))],
            drives=[{"type": "torque", "name": "load", "joint": "axle", "value": load},
                    {"type": "brake", "name": "brake", "joint": "axle", "value": hold}])
        yield Check(f"acceleration, brake of {hold:g} N m", "rad/s^2",
                    max(0.0, load - hold) / inertia, run["arm.alpha"][-1], 1e-9 * load / inertia,
                    CONSTANT)
        yield Check(f"its torque, brake of {hold:g} N m", "N m", -min(hold, load),
                    run["brake.torque"][-1], 1e-9 * load, "the solver's impulse")


WEIGHT = {"name": "weight", "mass": 1.0, "inertia": 0.01, "at": (0.0, -0.5)}


@case("Rod that breaks at a load", "v = g (t − t_b) + dF/dt (t² − t_b²) / (2 m)",
      "1 kg under a pull of 30 N/s on a rod that breaks at 15 N, four steps")
def test_breaking() -> Iterator[Check]:
    breaks, grows = 15.0, 30.0
    broke = (breaks - G) / grows
    for h in (1e-3, 0.53e-3, 0.25e-3, 0.13e-3):
        run = simulated(
            0.5, h, g=G, bodies=[fixed("frame"), WEIGHT],
            joints=[{"type": "rod", "name": "rod", "a": "frame", "b": "weight",
                     "breaks_at": breaks}],
            drives=[force("pull", "weight", (0.0, -1.0), f"={grows} * t")])
        ends = run.time[-1] + np.array([-h, h]) / 2
        yield Check(f"speed, h = {1e3 * h:g} ms", "m/s",
                    np.mean(G * (ends - broke) + grows * (ends**2 - broke**2) / 2),
                    -run["weight.vy"][-1], h**2 * grows,
                    "h² dT/dt / m: of the last impulse; without it up to h T / (2 m)")


@case("Pin that catches a falling body", "x = (d + (u + d / T) t) exp(−t / T)",
      "1 kg that fell for 0.1 s, taken up with T = 20 ms, three steps")
def test_taking_up() -> Iterator[Check]:
    over, caught = 0.02, 0.1
    d, u = G * caught**2 / 2, G * caught
    for h in (1e-3, 0.5e-3, 0.25e-3):
        run = simulated(
            0.4, h, g=G, every_step=True, bodies=[fixed("frame"), {**WEIGHT, "at": (0.0, 0.0)}],
            joints=[pin("hook", "frame", "weight", on_a=(0.0, 0.0), released=True,
                        takes_up_in=over)],
            events=[{"name": "catch", "at": caught, "take_up": "hook"}])
        t = run.time - caught
        gap = np.where(t < 0, G * run.time**2 / 2, (d + (u + d / over) * t) * np.exp(-t / over))
        yield Check(f"height, h = {1e3 * h:g} ms", "m", -gap, run["weight.y"], h * (u + d / over),
                    "h (u + d / T): the instant of an event is known to a step")
        yield Check(f"largest force, h = {1e3 * h:g} ms", "N", G + 2 * u / over + d / over**2,
                    run["hook.reaction_y"].max(), h * 3 * (u + d / over) / over**2,
                    "h times the first fall of the force, 3 u / T² + 2 d / T³, rounded up")


@case("Boxes on conveyors", "v = g (μ cos − sin) t, up to the belt's",
      "a box put down on belts at 0, 10 and 15°, μ = 0.4, h = 1 ms")
def test_conveyor() -> Iterator[Check]:
    mu, m, v, h = 0.4, 2.0, 1.0, 1e-3
    for slope in (0.0, 10.0, 15.0):
        angle = math.radians(slope)
        c, s = math.cos(angle), math.sin(angle)
        run = simulated(
            1.5, h, g=G, materials={"rough": {"friction": mu}},
            bodies=[fixed("belt", angle=angle, material="rough",
                          shapes=[{"type": "box", "size": (6.0, 0.1)}]),
                    {"name": "box", "mass": m, "angle": angle, "material": "rough",
                     "at": (-2.0 * c - 0.1 * s, -2.0 * s + 0.1 * c),
                     "shapes": [{"type": "box", "size": (0.2, 0.1)}]}],
            drives=[{"type": "surface", "name": "run", "body": "belt", "positive": "clockwise",
                     "value": v}])
        a, end = G * (mu * c - s), float(run.time[-1])
        yield Check(f"travel at {slope:g}°", "m", v * end - v**2 / (2 * a),
                    c * run["box.x"][-1] + s * run["box.y"][-1] + 2.0, a * h**2,
                    "a h²: exact but for the step in which it sticks")
        yield Check(f"power at {slope:g}°", "W", mu * m * G * c * v, run["run.power"][50],
                    1e-8 * m * G, "friction times speed")
        yield Check(f"work at {slope:g}°", "J",
                    mu * m * G * c * v * v / a + m * G * s * v * (end - v / a),
                    run["run.work"][-1], m * G * v * h, "friction of one step at most")
