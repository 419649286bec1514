"""Cords that guides hold by friction: capstan, pulley, belts, a band brake, a guide that swings.

And one that is made stiffer.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sandbox.draw.figure.panels import Curve, Panel
from sandbox.engine.simulate import simulate
from sandbox.numeric import Array
from sandbox.samples.samples import Samples
from sandbox.study.independent import ATOL, RTOL, solve_ivp
from sandbox.study.plain_mechanisms import G, fixed, mass, mechanism
from sandbox.verification.cases.case import Case, Check, Findings

TIGHT = 1e7
SWING, SPRING = 5e-3, 0.2


OWN, MORE, WEIGHT, AT = 40.0, 70.0, 0.1, 0.1
"""Stiffnesses of a cord before and after an instant, and what hangs on it."""


def _guide(body: str, at: tuple[float, float] = (0.0, 0.0), radius: float = 0.0,
           side: str = "left", friction: float = 0.0) -> dict[str, Any]:
    return {"body": body, "at": at, "radius": radius, "side": side, "friction": friction}


def _pin(name: str, body: str, x: float = 0.0) -> dict[str, Any]:
    return {"type": "pin", "name": name, "a": "ground", "b": body, "on_a": (x, 0.0),
            "on_b": (0.0, 0.0)}


def _capstan() -> Findings:
    """A weight over a quarter of a bar, pulled by more and more."""
    mu, ramp, h = 0.3, 40.0, 5e-4
    e = math.exp(mu * math.pi / 2)
    run = simulate(mechanism(
        duration=0.5, step=h, gravity=(0.0, -G),
        bodies=[fixed("ground"), mass("load", 1.0, (0.05, -1.0))],
        tendons=[{"name": "rope", "stiffness": TIGHT, "pretension": G, "guides": [
            _guide("load"), _guide("ground", radius=0.05, friction=mu),
            _guide("ground", (-1.0, 0.05))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "rope", "value": f"={G} + {ramp} * t"}]))
    begins = G * (e - 1) / ramp
    late = np.maximum(run.time - begins, 0.0)
    speed = ramp * late**2 / 2 / e
    first = float(run.time[np.flatnonzero(run["rope.slip_1"] > 1e-12)[0]])
    return Findings([
        Check("instant at which it first slides", "s", begins, first, 2 * h,
              "a step, and one sample after it"),
        Check("speed of the weight, largest difference", "m/s", 0.0,
              float(np.abs(run["load.vy"] - speed).max()), ramp * h * h,
              "it begins to slide within a step"),
        Check("tension behind by that before", "1", e,
              float(run["rope.tension_1"][-1] / run["rope.tension_0"][-1]), 1e-10, "rounding"),
    ], [Panel("A weight that is drawn up", "time [ms]", "speed [m/s]", [
        Curve("closed form", 1e3 * run.time, speed),
        Curve("engine", 1e3 * run.time, run["load.vy"])])])


def _pulley() -> Findings:
    """1 kg and 2 kg over a free disc of 2 kg; the rope grips, and slides."""
    r, checks, curves = 0.05, [], []
    for mu in (0.5, 0.05):
        run = simulate(mechanism(
            duration=0.4, gravity=(0.0, -G), bodies=[
                fixed("ground"), {"name": "wheel", "mass": 2.0, "inertia": r**2},
                mass("one", 1.0, (-r, -0.5)), mass("two", 2.0, (r, -0.5))],
            joints=[_pin("axle", "wheel")],
            tendons=[{"name": "rope", "stiffness": 1e6, "pretension": 12.0, "damping": 200.0,
                      "guides": [_guide("one"), _guide("wheel", (0.0, 0.0), r, "right", mu),
                                 _guide("two")]}]))
        e = math.exp(mu * math.pi)
        fall = G / 4 if mu == 0.5 else (2 * G - e * G) / (2 + e)
        turn = fall if mu == 0.5 else (2 * (G - fall) - (G + fall))
        word = "grips" if mu == 0.5 else "slides"
        why = "the strain of the rope, T/EA < 2·10⁻⁵"
        checks += [
            Check(f"{word}: acceleration of the weights", "m/s^2", fall,
                  -float(run["two.ay"][-1]), 2e-5 * G, why),
            Check(f"{word}: of the disc's rim", "m/s^2", turn, -r * float(run["wheel.alpha"][-1]),
                  2e-5 * G, why)]
        curves.append(Curve(f"{word}: the rim", 1e3 * run.time, -r * run["wheel.omega"]))
        curves.append(Curve(f"{word}: the weights", 1e3 * run.time, -run["two.vy"]))
    return Findings(checks, [Panel("A rope over a heavy disc", "time [ms]", "speed [m/s]", curves)])


def _belt() -> Findings:
    """A torque that rises on the small wheel of a belt, open and crossed."""
    small, large, apart, mu, start, rise, h = 0.05, 0.1, 0.3, 0.3, 50.0, 10.0, 5e-4
    checks, curves = [], []
    for crossed in (False, True):
        run = simulate(mechanism(
            duration=0.3, step=h, bodies=[
                fixed("ground"), {"name": "small", "mass": 1.0, "inertia": 1e-3},
                {"name": "large", "mass": 1.0, "inertia": 1e6, "at": (apart, 0.0)}],
            joints=[_pin("one", "small"), _pin("two", "large", apart)],
            tendons=[{"name": "belt", "closed": True, "stiffness": 1e5, "pretension": start,
                      "guides": [_guide("small", radius=small, friction=mu),
                                 _guide("large", (0.0, 0.0), large,
                                        "right" if crossed else "left", mu)]}],
            drives=[{"type": "torque", "name": "m", "joint": "one", "value": f"={rise} * t"}]))
        over = large + small if crossed else small - large
        phi = math.pi + 2 * math.asin(over / apart)
        most = 2 * start * math.tanh(mu * phi / 2)
        drawn = np.abs(run["belt.tension_0"] - run["belt.tension_1"])
        slides = int(np.flatnonzero(np.abs(run["belt.slip_0"]) > 1e-7)[0])
        word = "crossed" if crossed else "open"
        given = rise * float(run.time[slides]) - 1e-3 * float(run["small.alpha"][slides])
        checks += [
            Check(f"{word}: largest difference of the tensions", "N", most, float(drawn[-1]),
                  most * 2 * start / (1e5 * 0.8),
                  "the strain of the belt, by which the sum of its tensions changes"),
            Check(f"{word}: torque at which it slides", "N m", most * small, given,
                  2 * rise * h, "two steps of the torque")]
        curves.append(Curve(word, 1e3 * run.time, drawn))
    return Findings(checks, [Panel("What a belt carries", "time [ms]", "T₁ − T₂ [N]", curves)])


def _brake() -> Findings:
    """20 N on one end of a band, the other tied, round a wheel that turns either way."""
    mu, r, inertia, pull, start = 0.25, 0.1, 0.02, 20.0, 50.0
    e = math.exp(mu * math.pi)
    checks, curves = [], []
    for sense, word in ((1.0, "leading"), (-1.0, "trailing")):
        torque = pull * r * (e - 1 if sense > 0 else 1 - 1 / e)
        stops = inertia * start / torque
        run = simulate(mechanism(
            duration=1.2 * stops, bodies=[
                fixed("ground"), {"name": "drum", "mass": 1.0, "inertia": inertia,
                                  "angular_velocity": sense * start}],
            joints=[_pin("axle", "drum")],
            tendons=[{"name": "band", "stiffness": 1e6, "damping": 1e3, "guides": [
                _guide("ground", (r, -0.3)), _guide("drum", (0.0, 0.0), r, "left", mu),
                _guide("ground", (-r, -0.3))]}],
            drives=[{"type": "pull", "name": "pull", "tendon": "band", "value": pull}]))
        half = int(np.searchsorted(run.time, 0.5 * stops))
        checks += [
            Check(f"{word} end pulled: torque", "N m", torque,
                  -sense * inertia * float(run["drum.alpha"][half]), 1e-6 * torque,
                  "the band's winding up has died away"),
            Check(f"{word} end pulled: rate after 1.2 stopping times", "rad/s", 0.0,
                  float(run["drum.omega"][-1]), 1e-3 * start, "it rings on the band")]
        curves.append(Curve(word, 1e3 * run.time, np.abs(run["drum.omega"])))
    return Findings(checks, [Panel("A wheel that is braked", "time [ms]", "[rad/s]", curves)])


def _swinging(h: float) -> Samples:
    """A link with an eye on it, over which a pull draws a block that slides on a table."""
    return simulate(mechanism(
        duration=0.12, step=h, gravity=(0.0, 0.0), bodies=[
            fixed("ground"), {"name": "link", "mass": 0.5, "inertia": SWING, "at": (0.0, 0.0)},
            mass("block", 0.2, (-0.3, 0.25))],
        joints=[_pin("hinge", "link"), {
            "type": "slot", "name": "rail", "a": "ground", "b": "block", "start": (-0.5, 0.25),
            "end": (0.0, 0.25), "on_b": (0.0, 0.0), "turns": False}],
        springs=[{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": SPRING}],
        tendons=[{"name": "cord", "stiffness": TIGHT, "damping": 1e3, "pretension": 5.0, "guides": [
            _guide("block"), _guide("link", (0.0, 0.2), friction=0.25),
            _guide("ground", (0.1, 0.0))]}],
        drives=[{"type": "pull", "name": "pull", "tendon": "cord", "value": 5.0}]))


def _truth(_t: float, state: Array) -> list[float]:
    """Of the angle and the block's place, and their rates, as the cord slides over the eye."""
    angle, place, rate, speed = state
    eye = 0.2 * np.array([-math.sin(angle), math.cos(angle)])
    back, on = np.array([place, 0.25]) - eye, np.array([0.1, 0.0]) - eye
    back, on = back / np.hypot(*back), on / np.hypot(*on)
    bend = math.pi - math.acos(float(back @ on))
    tension = 5.0 * math.exp(-0.25 * bend)
    push = tension * back + 5.0 * on
    moment = eye[0] * push[1] - eye[1] * push[0] - SPRING * angle
    return [rate, speed, float(moment / SWING), float(-tension * back[0] / 0.2)]


def _swings() -> Findings:
    truth = solve_ivp(_truth, (0, 0.12), [0, -0.3, 0, 0], rtol=RTOL, atol=ATOL, dense_output=True,
                      method="DOP853")
    off, curves, checks = [], [], []
    for h in (1e-3, 5e-4):
        run = _swinging(h)
        angle, place = truth.sol(run.time)[:2]
        error = np.abs(run["hinge.angle"] - angle)
        off.append(float(error.max()))
        curves.append(Curve(f"h = {1e3 * h:g} ms", 1e3 * run.time, error))
        bends = h * h / 8 * np.abs([_truth(0.0, state)[2:] for state in truth.sol(run.time).T])
        why = "h²/8 of its acceleration: the height of the arc over a step's chord"
        checks += [
            Check(f"angle of the link at h = {1e3 * h:g} ms, largest difference", "rad", 0.0,
                  off[-1], float(bends[:, 0].max()), why),
            Check(f"place of the block at h = {1e3 * h:g} ms, largest difference", "m", 0.0,
                  float(np.abs(run["block.x"] - place).max()), float(bends[:, 1].max()), why)]
    checks.append(Check("error of the angle at 1 ms by that at 0.5 ms", "1", 4.0, off[0] / off[1],
                        0.4, "second order, a tenth for the next term"))
    return Findings(checks, [Panel("Error of the link's angle", "time [ms]", "[rad]", curves)])


def _stiffened() -> Findings:
    """A weight that hangs at rest on a cord until that is made stiffer."""
    h, short, rests = 5e-4, WEIGHT * G / OWN, WEIGHT * G / MORE
    run = simulate(mechanism(
        duration=0.6, step=h, run={"sample_rate": 1 / h}, gravity=(0.0, -G),
        bodies=[fixed("ground"), mass("load", WEIGHT, (0.0, -0.5))],
        tendons=[{"name": "cord", "stiffness": OWN, "pretension": WEIGHT * G,
                  "guides": [_guide("ground"), _guide("load")]}],
        drives=[{"type": "stiffness", "name": "k", "tendon": "cord",
                 "value": {"table": [(0.0, OWN), (AT, MORE)], "between": "step"}}]))
    pace, t = math.sqrt(MORE / WEIGHT), np.maximum(run.time - AT, 0.0)
    x = np.where(run.time > AT, rests + (short - rests) * np.cos(pace * t), short)
    swing, late = short - rests, (h * pace) ** 2 / 8
    allowed = swing * late * (1 + pace * float(t[-1]) / 3)
    k = np.where(run.time > AT, MORE, OWN)
    return Findings([
        Check("stretch, largest difference", "m", 0.0,
              float(np.abs(run["cord.length"] - 0.5 + short - x).max()), allowed,
              "a leapfrog's: (h w)²/8 of its height, (h w)²/24 of its phase"),
        Check("tension, largest difference", "N", 0.0,
              float(np.abs(run["cord.tension"] - k * x).max()), MORE * allowed, "k times that"),
        Check("work of the cord up to where the weight turns", "J",
              MORE / 2 * (short**2 - (2 * rests - short) ** 2),
              float(run["cord.work"][int(np.argmin(x))]), WEIGHT * G * swing * (h * pace) ** 2,
              "the sample is within half a step of it, and the height as above"),
    ], [Panel("A weight whose cord is made stiffer", "time [ms]", "stretch [mm]", [
        Curve("closed form", 1e3 * run.time, 1e3 * x),
        Curve("engine", 1e3 * run.time, 1e3 * (run["cord.length"] - 0.5 + short), "points")])])


CASES = (
    Case("capstan", "A rope over a bar", "T₂ = T₁ e^(μφ); m v' = T₂ e^(−μφ) − m g",
         "1 kg over a quarter of a fixed bar, μ = 0.3, pulled by 40 N/s more",
         "instant of sliding, speed and ratio of the tensions with Euler's", _capstan),
    Case("heavy_pulley", "A rope on a heavy pulley",
         "a = g (m₂ − m₁)/(m₁ + m₂ + I/r²); T₂ = T₁ e^(μπ)",
         "1 kg and 2 kg over a free disc of 2 kg, with μ = 0.5 and 0.05",
         "accelerations of the weights and of the rim with the closed forms", _pulley),
    Case("belt", "What a belt carries", "M = 2 T₀ r tanh(μφ/2)",
         "a torque that rises by 10 N m/s on one wheel of an open and of a crossed belt",
         "largest torque and difference of the tensions with Eytelwein's", _belt),
    Case("band_brake", "A band brake", "M = T r (e^(μφ) − 1), M = T r (1 − e^(−μφ))",
         "a band over half a wheel, one end tied, 20 N on the other, either sense",
         "torque and standstill with the closed forms", _brake),
    Case("swinging_guide", "A cord over an eye that swings",
         "I θ'' = moment of T e^(−μφ) and T − k θ; m x'' = T e^(−μφ) cos",
         "a pull draws a block over an eye on a sprung link, μ = 0.25",
         "angle and place with an integration of order 8", _swings),
    Case("stiffened_cord", "A weight whose cord is made stiffer",
         "x = m g/k₂ + (m g/k₁ − m g/k₂) cos √(k₂/m) t",
         "100 g at rest on a cord of 40 N/m that a drive makes 70 N/m, h = 0.5 ms",
         "stretch, tension and work with the closed form", _stiffened),
)
