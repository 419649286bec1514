"""Tendons: pulleys and rockers that share a pull, friction at guides, lifting off a pulley."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from sandbox.elements.tendons import RIGID
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, cable, fixed, guide, mass, pin, simulated, spring
from tests.support.reference import integrate

from .case import Check, case

SECOND = "second order, a tenth for the next term"


@case("Wheel that winds its cord", "x₁ = x_A + θ R, x₂ = x_A − θ R, (1)–(3)",
      "a wheel of 20 mm turned by 1.5 rad lifts 100 g")
def test_pulley_wheel() -> Iterator[Check]:
    radius, angle, m = 0.02, 1.5, 0.1
    run = simulated(
        1.2, g=G, bodies=[
            {"name": "wheel", "motion": "scheduled",
             "path": {"angle": {"expression": f"=-{angle} * (1 - cos(pi * clip(t, 0, 1))) / 2"}}},
            mass("load", m, (radius, -0.5))],
        tendons=[cable("cord", ("wheel", (0.0, 0.0), radius, "right"), ("load",), stiffness=RIGID,
                      damping=20.0)])
    yield Check("lift of the load", "m", radius * angle,
                abs(run["load.y"][-1] + 0.5 + m * G / RIGID), 2e-6,
                "the stretch T / k differs by m a / k < 1 μm between start and end")
    yield Check("tension at the end", "N", m * G, run["cord.tension"][-1], 1e-3 * m * G,
                "the load hangs still but for what is left of the ramp")


@case("Rocker with unequal arms", "T₁ = F b / (a + b), T₂ = F a / (a + b)",
      "a rocker, pulled by 8 N, on two elastic cords of 900 and 700 N/m")
def test_rocker_arms() -> Iterator[Check]:
    pull = 8.0
    for a, b in ((0.03, 0.03), (0.025, 0.03), (0.02, 0.03), (0.015, 0.03)):
        run = simulated(
            2.0, bodies=[fixed("wall"),
                         {"name": "rocker", "mass": 0.05, "inertia": 2e-5, "at": (0.0, 0.5)}],
            springs=[spring(f"damper{i}", "wall", "rocker", on_a=far, stiffness=0.0, damping=6.0)
                     for i, far in enumerate([(1.0, 0.5), (0.0, 1.5)])],
            tendons=[cable("main", ("rocker",), ("wall", (0.0, 1.0))),
                     *(cable(name, ("rocker", (x, 0.0)), ("wall", (x, 0.0)), stiffness=k,
                            damping=3.0)
                       for name, x, k in (("first", -a, 900.0), ("second", b, 700.0)))],
            drives=[{"type": "pull", "name": "pull", "tendon": "main", "value": pull}])
        x, y, angle = (float(run[f"rocker.{key}"][-1]) for key in ("x", "y", "angle"))
        found = [float(run[f"{name}.tension"][-1]) for name in ("first", "second")]
        lean = (a + b) * (1 - np.cos(angle)) / 0.5
        arms = f"arms of {1e3 * a:g} and {1e3 * b:g} mm"
        yield Check(f"tensions, {arms}", "N", [pull * b / (a + b), pull * a / (a + b)], found,
                    pull * (max(lean, 1e-7) + abs(x) / 0.5),
                    "pull times the lean of cords of 0.5 m as the rocker tilts")
        turn = np.exp(1j * angle)
        pins, walls = turn * np.array([-a, b]), np.array([-a, b]) - complex(x, y)
        along = (walls - pins) / abs(walls - pins)
        moments = np.abs((np.conj(pins) * along).imag)[::-1]
        exact = pull * moments / abs(moments @ along)
        yield Check(f"moment balance at the tilt, {arms}", "N", exact, found, 1e-9 * exact,
                    "e⁻²⁰ of the motion is left after two seconds")


def acceleration(run: Recording, name: str, start: float) -> float:
    """Of a straight fall [m/s^2], fitted to y(t) from ``start`` [s] on."""
    late = run.time > start
    return float(2 * np.polyfit(run.time[late], run[f"{name}.y"][late], 2)[0])


@case("Atwood's machine", "T = 2 m₁ m₂ g / (m₁ + m₂), a = (m₁ − m₂) g / (m₁ + m₂)",
      "200 g and 40 to 160 g on a cord over two eyes")
def test_atwood() -> Iterator[Check]:
    for m in (0.04, 0.08, 0.12, 0.16):
        run = simulated(
            0.3, g=G, bodies=[fixed("beam"), mass("heavy", 0.2, (0.0, -0.5)),
                              mass("light", m, (0.1, -0.9))],
            tendons=[cable("cord", ("heavy",), ("beam", (0.0, 0.0)), ("beam", (0.1, 0.0)),
                          ("light",), stiffness=RIGID)])
        tension, a = 2 * 0.2 * m * G / (0.2 + m), (0.2 - m) * G / (0.2 + m)
        yield Check(f"tension with {1e3 * m:g} g", "N", tension, run["cord.tension"][-1],
                    1e-6 * tension, "the cord's ringing has decayed to 1e-6 after 0.2 s")
        yield Check(f"accelerations with {1e3 * m:g} g", "m/s^2", [-a, a],
                    [acceleration(run, name, 0.2) for name in ("heavy", "light")], 1e-5 * G,
                    "a parabola fitted to positions")


@case("Movable pulley", "2 T − W g = W a / 2, m (g − a) = T",
      "150 g on a movable wheel, or eye, and 100 g at the end of its cord")
def test_movable_pulley() -> Iterator[Check]:
    """Both strands of the eye lean: 4 mm apart 0.8 m up, cos(0.0025) = 1 - 3e-6."""
    for radius, word in ((0.02, "wheel"), (0.0, "eye")):
        gap = radius or 0.002
        run = simulated(
            0.25, g=G, bodies=[fixed("beam"), mass("pulley", 0.15, (0.0, -0.8)),
                               mass("weight", 0.1, (0.3, -0.4))],
            tendons=[cable("cord", ("beam", (-gap, 0.0)), ("pulley", (0.0, 0.0), radius, "left"),
                          ("beam", (gap, 0.0)), ("beam", (0.3, 0.0)), ("weight",),
                          stiffness=RIGID)])
        a = (0.1 - 0.15 / 2) / (0.1 + 0.15 / 4) * G
        yield Check(f"{word}: tension", "N", 0.1 * (G - a), run["cord.tension"][-100:],
                    2e-6 * (G - a), "ringing after 0.2 s, and the lean of the strands")
        yield Check(f"{word}: accelerations", "m/s^2", [-a, a / 2],
                    [acceleration(run, name, 0.05) for name in ("weight", "pulley")], 2e-5 * a,
                    "a parabola fitted to positions, and the lean")


@case("Rope over a bar", "T₂ = T₁ e^(μφ), m v′ = T₂ e^(−μφ) − m g",
      "1 kg over a quarter of a fixed bar, μ = 0.3, pulled by 40 N/s more")
def test_capstan() -> Iterator[Check]:
    mu, ramp, h = 0.3, 40.0, 5e-4
    e = math.exp(mu * math.pi / 2)
    run = simulated(
        0.5, h, g=G, bodies=[fixed("ground"), mass("load", 1.0, (0.05, -1.0))],
        tendons=[{"name": "rope", "stiffness": 1e7, "pretension": G, "guides": [
            guide("load"), guide("ground", radius=0.05, friction=mu),
            guide("ground", (-1.0, 0.05))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "rope", "value": f"={G} + {ramp} * t"}])
    begins = G * (e - 1) / ramp
    yield Check("instant of first slip", "s", begins,
                run.time[np.flatnonzero(run["rope.slip_1"] > 1e-12)[0]], 2 * h,
                "a step, and one sample after it")
    yield Check("speed of the weight", "m/s", ramp * np.maximum(run.time - begins, 0.0)**2 / 2 / e,
                run["load.vy"], ramp * h * h, "slip begins within a step")
    yield Check("ratio of the tensions", "1", e,
                run["rope.tension_1"][-1] / run["rope.tension_0"][-1], 1e-10, "rounding")


@case("Rope on a heavy pulley", "a = g (m₂ − m₁) / (m₁ + m₂ + I/r²), or T₂ = T₁ e^(μπ)",
      "1 kg and 2 kg over a free disc of 2 kg, with μ = 0.5 (grips) and 0.05 (slides)")
def test_heavy_pulley() -> Iterator[Check]:
    r = 0.05
    for mu in (0.5, 0.05):
        run = simulated(
            0.4, g=G, bodies=[
                fixed("ground"), {"name": "wheel", "mass": 2.0, "inertia": r**2},
                mass("one", 1.0, (-r, -0.5)), mass("two", 2.0, (r, -0.5))],
            joints=[pin("axle", "ground", "wheel")],
            tendons=[{"name": "rope", "stiffness": 1e6, "pretension": 12.0, "damping": 200.0,
                      "guides": [guide("one"), guide("wheel", (0.0, 0.0), r, "right", mu),
                                 guide("two")]}])
        e = math.exp(mu * math.pi)
        fall = G / 4 if mu == 0.5 else (2 * G - e * G) / (2 + e)
        rim = fall if mu == 0.5 else 2 * (G - fall) - (G + fall)
        yield Check(f"accelerations of weights and rim, μ = {mu:g}", "m/s^2", [fall, rim],
                    [-run["two.ay"][-1], -r * run["wheel.alpha"][-1]], 2e-5 * G,
                    "the strain of the rope, T/EA < 2·10⁻⁵")


@case("Capacity of a belt", "M = 2 T₀ r tanh(μφ/2)",
      "a torque that rises by 10 N m/s on one wheel of an open and of a crossed belt")
def test_belt() -> Iterator[Check]:
    small, large, apart, mu, start, rise, h = 0.05, 0.1, 0.3, 0.3, 50.0, 10.0, 5e-4
    for crossed in (False, True):
        run = simulated(
            0.3, h, bodies=[fixed("ground"), {"name": "small", "mass": 1.0, "inertia": 1e-3},
                            {"name": "large", "mass": 1.0, "inertia": 1e6, "at": (apart, 0.0)}],
            joints=[pin("one", "ground", "small"), pin("two", "ground", "large")],
            tendons=[{"name": "belt", "closed": True, "stiffness": 1e5, "pretension": start,
                      "guides": [guide("small", radius=small, friction=mu),
                                 guide("large", (0.0, 0.0), large,
                                       "right" if crossed else "left", mu)]}],
            drives=[{"type": "torque", "name": "m", "joint": "one", "value": f"={rise} * t"}])
        phi = math.pi + 2 * math.asin((large + small if crossed else small - large) / apart)
        most = 2 * start * math.tanh(mu * phi / 2)
        slides = int(np.flatnonzero(np.abs(run["belt.slip_0"]) > 1e-7)[0])
        word = "crossed" if crossed else "open"
        yield Check(f"{word}: largest difference of the tensions", "N", most,
                    abs(run["belt.tension_0"] - run["belt.tension_1"])[-1],
                    most * 2 * start / (1e5 * 0.8),
                    "the strain of the belt, by which the sum of its tensions changes")
        yield Check(f"{word}: torque at which it slides", "N m", most * small,
                    rise * run.time[slides] - 1e-3 * run["small.alpha"][slides], 2 * rise * h,
                    "two steps of the torque")


@case("Band brake", "M = T r (e^(μφ) − 1) or T r (1 − e^(−μφ))",
      "a band over half a wheel, one end fixed, 20 N on the other, either sense of rotation")
def test_band_brake() -> Iterator[Check]:
    mu, r, inertia, pull, start = 0.25, 0.1, 0.02, 20.0, 50.0
    e = math.exp(mu * math.pi)
    for sense, word in ((1.0, "leading"), (-1.0, "trailing")):
        torque = pull * r * (e - 1 if sense > 0 else 1 - 1 / e)
        stops = inertia * start / torque
        run = simulated(
            1.2 * stops, bodies=[
                fixed("ground"), {"name": "drum", "mass": 1.0, "inertia": inertia,
                                  "angular_velocity": sense * start}],
            joints=[pin("axle", "ground", "drum")],
            tendons=[{"name": "band", "stiffness": 1e6, "damping": 1e3, "guides": [
                guide("ground", (r, -0.3)), guide("drum", (0.0, 0.0), r, "left", mu),
                guide("ground", (-r, -0.3))]}],
            drives=[{"type": "pull", "name": "pull", "tendon": "band", "value": pull}])
        half = int(np.searchsorted(run.time, 0.5 * stops))
        yield Check(f"{word} end pulled: torque", "N m", torque,
                    -sense * inertia * run["drum.alpha"][half], 1e-6 * torque,
                    "the ringing of the band has decayed")
        yield Check(f"{word} end pulled: rate after 1.2 stopping times", "rad/s", 0.0,
                    run["drum.omega"][-1], 1e-3 * start, "it rings on the band")


def swinging_guide(_t: float, state: Array) -> list[float]:
    """Derivative of the link's angle, the block's position and their rates, cord sliding."""
    angle, place, rate, speed = state
    eye = 0.2 * np.array([-math.sin(angle), math.cos(angle)])
    back, on = np.array([place, 0.25]) - eye, np.array([0.1, 0.0]) - eye
    back, on = back / np.hypot(*back), on / np.hypot(*on)
    tension = 5.0 * math.exp(-0.25 * (math.pi - math.acos(float(back @ on))))
    push = tension * back + 5.0 * on
    moment = eye[0] * push[1] - eye[1] * push[0] - 0.2 * angle
    return [rate, speed, float(moment / 5e-3), float(-tension * back[0] / 0.2)]


@case("Cord over an eye that swings",
      "I θ″ = moment of T e^(−μφ) and T − k θ; m x″ = T e^(−μφ) cos",
      "a pull of 5 N draws a block over an eye on a sprung link, μ = 0.25; integration of order 8")
def test_swinging_guide() -> Iterator[Check]:
    off = []
    for h in (1e-3, 5e-4):
        run = simulated(
            0.12, h, bodies=[fixed("ground"), {"name": "link", "mass": 0.5, "inertia": 5e-3},
                             mass("block", 0.2, (-0.3, 0.25))],
            joints=[pin("hinge", "ground", "link"), {
                "type": "slot", "name": "rail", "a": "ground", "b": "block", "turns": False,
                "start": (-0.5, 0.25), "end": (0.0, 0.25), "on_b": (0.0, 0.0)}],
            springs=[{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": 0.2}],
            tendons=[{"name": "cord", "stiffness": 1e7, "damping": 1e3, "pretension": 5.0,
                      "guides": [guide("block"), guide("link", (0.0, 0.2), friction=0.25),
                                 guide("ground", (0.1, 0.0))]}],
            drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": 5.0}])
        truth = integrate(swinging_guide, [0, -0.3, 0, 0], run.time)
        bends = h * h / 8 * np.abs([swinging_guide(0.0, state)[2:] for state in truth]).max(axis=0)
        off.append(np.abs(run["hinge.angle"] - truth[:, 0]).max())
        for name, unit, i in (("hinge.angle", "rad", 0), ("block.x", "m", 1)):
            yield Check(f"{name}, h = {1e3 * h:g} ms", unit, truth[:, i], run[name], bends[i],
                        "h²/8 of its acceleration: the height of the arc over a step's chord")
    yield Check("error of the angle at 1 ms by that at 0.5 ms", "1", 4.0, off[0] / off[1], 0.4,
                SECOND)


@case("Weight whose cord becomes stiffer", "x = m g/k₂ + (m g/k₁ − m g/k₂) cos √(k₂/m) t",
      "100 g at rest on a cord of 40 N/m that a drive changes to 70 N/m")
def test_stiffened_cable() -> Iterator[Check]:
    own, more, m, begins, h = 40.0, 70.0, 0.1, 0.1, 5e-4
    short, rests = m * G / own, m * G / more
    run = simulated(
        0.6, h, g=G, every_step=True, bodies=[fixed("ground"), mass("load", m, (0.0, -0.5))],
        tendons=[{"name": "cord", "stiffness": own, "pretension": m * G,
                  "guides": [guide("ground"), guide("load")]}],
        drives=[{"type": "stiffness", "name": "k", "tendon": "cord",
                 "value": {"table": [(0.0, own), (begins, more)], "between": "step"}}])
    pace, t, late = math.sqrt(more / m), np.maximum(run.time - begins, 0.0), run.time > begins
    x = np.where(late, rests + (short - rests) * np.cos(pace * t), short)
    swing, square = short - rests, (h * pace)**2
    allowed = swing * square / 8 * (1 + pace * float(t[-1]) / 3)
    yield Check("stretch", "m", x, run["cord.length"] - 0.5 + short, allowed,
                "leapfrog: (h ω)²/8 of its height, (h ω)²/24 of its phase")
    yield Check("tension", "N", np.where(late, more, own) * x, run["cord.tension"], more * allowed,
                "k times that")
    yield Check("work of the cord until the weight turns", "J",
                more / 2 * (short**2 - (2 * rests - short)**2),
                run["cord.work"][int(np.argmin(x))], m * G * swing * square,
                "the sample is within half a step of it, and the height as above")


@case("Wheel pushed into a cord", "T = T₀ + k (2 √(a² + y² − r²) + r φ − 2 a), φ ≥ 0",
      "a wheel of 40 mm comes down on a straight cord twice and leaves it again")
def test_pushed_wheel() -> Iterator[Check]:
    k, start, half, r = 2000.0, 20.0, 0.3, 0.04
    run = simulated(
        2.0, run={"sample_rate": 2000.0}, bodies=[
            fixed("ground"), {"name": "wheel", "motion": "scheduled", "at": (0.0, 0.06),
                              "path": {"y": "=0.06 - 0.12 * sin(pi * t) ** 2"}}],
        tendons=[{"name": "cord", "stiffness": k, "pretension": start, "guides": [
            guide("ground", (-half, 0.0)), guide("wheel", radius=r),
            guide("ground", (half, 0.0))]}])
    y = 0.06 - 0.12 * np.sin(math.pi * run.time)**2
    away = np.hypot(half, y)
    phi = np.maximum(2 * (np.arcsin(r / away) - np.arctan2(y, half)), 0.0)
    bent = 2 * np.sqrt(away**2 - r**2) + r * phi - 2 * half
    tension = start + k * np.where(phi > 0, bent, 0.0)
    yield Check("tension", "N", tension, run["cord.tension"], 1e-9 * tension.max(), "rounding")
    yield Check("tension at the end", "N", start, run["cord.tension"][-1], 1e-9 * start, "rounding")
    yield Check("whether it is off the wheel", "1", y >= r, run["cord.lifted_1"], 0.0, "exact")


def interrupted(depth: float, start: float, duration: float) -> Recording:
    """Pendulum of 0.5 m released at an angle [rad], a peg of 10 mm ``depth`` [m] below."""
    return simulated(
        duration, 2.5e-4, g=G, every_step=True, bodies=[
            fixed("ground"), mass("bob", 1.0, (0.5 * math.sin(start), -0.5 * math.cos(start)))],
        tendons=[{"name": "cord", "stiffness": 1e7, "guides": [
            guide("ground"), guide("ground", (-0.01, -depth), 0.01, "right"), guide("bob")]}])


@case("Pendulum that meets a peg", "v² = 2 g Δh, T = m v² / (l − d − r φ) + m g cos φ",
      "released at 40° and level, a peg of 10 mm 300, 320 and 250 mm below")
def test_galileo() -> Iterator[Check]:
    length, r, low, high, h = 0.5, 0.01, 0.32, 0.25, 2.5e-4
    swing = interrupted(0.3, math.radians(40), 1.3)
    height = -length * math.cos(math.radians(40))
    yield Check("height beyond the peg", "m", height,
                swing["bob.y"][(swing.time > 0.3) & (swing.time < 0.8)].max(), 1e-4 * length,
                "damping of a cord of 10⁷ N/m as it takes up the curve")
    yield Check("height back, off the peg", "m", height, swing["bob.y"][swing.time > 0.9].max(),
                2e-4 * length, "twice that")
    loop, fall = (interrupted(depth, math.pi / 2, 0.8) for depth in (low, high))
    arm, late = length - low - math.pi * r, loop.time > 0.4
    top = int(np.flatnonzero(late)[np.argmax(loop["bob.y"][late])])
    yield Check("top of the full turn", "m", arm - low, loop["bob.y"][top],
                max(6 * G * h**2, 1e-4 * length), "the same")
    yield Check("tension there, by the weight", "1", 2 * (low - arm) / arm - 1,
                loop["cord.tension"][top] / G, 2e-3, "the speed, from the energy's loss")

    def pull(phi: float) -> float:  # tension by m g where the cord has bent by phi
        free = length - high - r * phi
        return 2 * (high + r * math.sin(phi) + free * math.cos(phi)) / free + math.cos(phi)

    phi, beyond = math.pi / 2, math.pi
    while beyond - phi > 1e-12:
        middle = (phi + beyond) / 2
        phi, beyond = (middle, beyond) if pull(middle) > 0 else (phi, middle)
    free = length - high - r * phi
    slack = int(np.flatnonzero((fall["cord.tension"] == 0) & (fall.time > 0.4))[0])
    yield Check("where the cord falls slack, x and y", "m",
                [-r + r * math.cos(phi) - free * math.sin(phi),
                 -high - r * math.sin(phi) - free * math.cos(phi)],
                [fall["bob.x"][slack], fall["bob.y"][slack]],
                3 * h * math.hypot(fall["bob.vx"][slack], fall["bob.vy"][slack]),
                "motion in three steps")
