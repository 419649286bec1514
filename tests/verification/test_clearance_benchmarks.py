"""Published benchmarks with loss of contact and clearance: Painlevé, cams, a slider, a toy."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from tests.support.mechanisms import G, Json

from .case import (
    GROUND,
    Criterion,
    Digit,
    Problem,
    at,
    benchmark,
    body,
    event,
    exact,
    hinge,
    spelled,
)
from .test_linkages import CRANK, FLORES, INERTIAS, MASSES, ROD, crank_and_rod


@benchmark("Painlevé's rod",
           "A rod of 1 m and 1 kg at an angle φ from the floor, at rest but for its tip's sliding, "
           "away from its centre. With A = 1 + 3 cos φ (cos φ − μ sin φ) the floor gives m g/A, "
           "which is unbounded; where A < 0 there is no force, but an impact without a collision: "
           "the tip is caught and sticks, ω = 3 v sin φ/(2 l).",
           "Painlevé (1895), Génot and Brogliato (1999); Newton's and Euler's laws, solved for N "
           "and the accelerations.",
           steps=(1e-3, 5e-4, 2.5e-4), fault={"contacts[3].friction": 1.301})
def test_painleve() -> Problem:
    slide = ((45.0, 0.5), (60.0, 0.5), (60.0, 1.0), (60.0, 1.3))
    caught = ((60.0, 1.6), (45.0, 2.0))
    after = 4
    force, ax, ay, turn, steep, stuck, held, jerk = [], [], [], [], [], [], [], 0.0
    bodies: list[Json] = [{"name": "floor", "motion": "fixed", "shapes": [
        {"type": "box", "size": [30.0, 0.2], "at": [7.5, -0.1]}]}]
    rules = []
    for i, (degrees, mu) in enumerate((*slide, *caught)):
        angle, name, speed = float(np.radians(degrees)), f"rod{i + 1}", 5.0 if i < 4 else 1.0
        c, s = np.cos(angle), np.sin(angle)
        bodies.append({
            "name": name, "mass": 1.0, "inertia": 1 / 12, "at": [3.0 * i, 0.0], "angle": angle,
            "centre": [0.5, 0.0], "velocity": [-speed, 0.0], "shapes": [
                {"type": "polygon", "points": [[0.0, 0.0], [0.2, 0.002], [0.2, -0.002]]}]})
        rules.append({"between": [name, "floor"], "friction": mu})
        if i < len(slide):
            # unknown N, x″, y″, φ″; the last law keeps the tip on the floor
            n, x, y, phi = np.linalg.solve(
                [[-mu, 1, 0, 0], [-1, 0, 1, 0], [(c - mu * s) / 2, 0, 0, 1 / 12],
                 [0, 0, 1, -c / 2]], [0.0, -G, 0.0, 0.0])
            for digits, value, key, unit in (
                    (force, n / G, f"{name}/floor.normal", G), (ax, x, f"{name}.ax", 1.0),
                    (ay, y, f"{name}.ay", 1.0), (turn, phi, f"{name}.alpha", 1.0)):
                digits.append(Digit(float(value), lambda run, key=key, unit=unit: float(
                    run[key][0] / unit)))
            slope = -6 * c * s - 3 * mu * (c**2 - s**2)
            steep.append(abs(slope * n / G * phi) / 8 + phi**2 * s / (8 * G))
            continue
        w, phi = 1.5 * s * speed, -1.5 * G * c
        stuck.append(Digit(w, lambda run, name=name, phi=phi: float(
            run[f"{name}.omega"][after] - phi * run.time[after])))
        held.append(Digit(1 + (phi * c - w**2 * s) / (2 * G), lambda run, name=name: float(
            run[f"{name}/floor.normal"][after] / G)))
        jerk = max(jerk, 3 * abs(w * phi) / G)
    i = int(np.argmax(steep))
    why = ("in half a step, to the first sample, the rod of μ = 1.3 turns by φ″ h²/8, which "
           "changes A, and reaches φ″ h/2, whose centripetal force is not 0")
    rate = steep[i]**0.5
    return lambda step: spelled(4 * step, step, gravity=[0.0, -G], bodies=bodies, contacts=rules), [
        Criterion("N at the start", "weights", force, why, force[i].expected, rate, floor=2e-6),
        Criterion("accelerations of the centre", "m/s²", [*ax, *ay], why, ax[i].expected, rate,
                  floor=2e-5),
        Criterion("angular accelerations", "rad/s²", turn, why, turn[i].expected, rate, floor=6e-5),
        event("rates after an impact without collision", "rad/s", stuck, 1.5 * G,
              "the impact is in the first step: φ″ h"),
        event("N after that", "weights", held, 5 * jerk,
              "of a rod that turns about its tip, N′ = 3 ω φ″ m l at most, in five steps")]


class Cam(NamedTuple):
    """Cam, stiffness of its follower's spring [N/m], its rate [rad/s]."""

    name: str
    stiffness: float
    rate: float


@benchmark("Eccentric cam with a flat follower",
           "A disc turns about a point 10 mm beside its centre and lifts a flat follower of 200 g, "
           "with a spring of 500 N/m or without one. The contact is lost from ω² = (m g + k (p + 2 "
           "e))/(m e) on: 85.035 rad/s with the spring, 31.321 without. Run at half that rate, at "
           "0.99 and at 1.1 of it.",
           "Textbook; closed form.",
           steps=(5e-4, 2.5e-4, 1.25e-4), fault={"bodies[sprung_follower].mass": 1.01 * 0.2})
def test_cam() -> Problem:
    e, m, radius, pressed, length = 0.01, 0.2, 0.03, 0.005, 0.3

    def limit(stiffness: float) -> float:
        return float(np.sqrt((m * G + stiffness * (pressed + 2 * e)) / (m * e)))

    cams = [Cam(f"{name}{word}", k, share * limit(k)) for word, share in (
        ("", 0.5), ("_below", 0.99), ("_above", 1.1)) for name, k in (("sprung", 500.0),
                                                                      ("bare", 0.0))]

    def force(cam: Cam, sine: float) -> float:
        """Of the contact, at the sine of the cam's angle from level [N]."""
        return m * (G - e * cam.rate**2 * sine) + cam.stiffness * (pressed + e * (1 + sine))

    def scene(step: float) -> Json:
        bodies: list[Json] = [{"name": "frame", "motion": "fixed"}]
        joints, springs = [], []
        for i, cam in enumerate(cams):
            x, follower = 0.3 * i, f"{cam.name}_follower"
            bodies += [
                {"name": cam.name, "motion": "scheduled", "at": [x, 0.0], "material": "smooth",
                 "path": {"angle": f"={cam.rate!r} * t"},
                 "shapes": [{"type": "circle", "radius": radius, "at": [e, 0.0]}]},
                {"name": follower, "mass": m, "inertia": 1e-4, "at": [x, radius],
                 "velocity": [0.0, e * cam.rate], "material": "smooth",
                 "shapes": [{"type": "box", "size": [0.1, 0.01], "at": [0.0, 0.005]}]}]
            joints.append({"type": "slot", "name": f"{cam.name}_guide", "a": "frame",
                           "b": follower, "start": [x, 0.0], "end": [x, 0.2], "turns": False})
            if cam.stiffness:
                springs.append({
                    "type": "linear", "name": f"{cam.name}_spring", "a": "frame", "b": follower,
                    "on_a": [x, radius + length], "stiffness": cam.stiffness,
                    "rest_length": length + pressed + e})
        return spelled(4 * np.pi / cams[1].rate, step, gravity=[0.0, -G], bodies=bodies,
                       joints=joints, springs=springs, materials={"smooth": {"friction": 0.0}})

    def normal(cam: Cam) -> str:
        return f"{cam.name}_follower/{cam.name}.normal"

    def least(cam: Cam, run: Recording) -> float:
        turn = 2 * np.pi / cam.rate
        return float(run[normal(cam)][(run.time > turn / 2) & (run.time < 2 * turn)].min())

    def lifts(cam: Cam, run: Recording) -> float:
        k = int(np.argmax(run[normal(cam)] <= 0))
        return float(cam.rate * (run.time[k - 1] + run.time[k]) / 2)

    def lift_off(cam: Cam) -> float:
        held = m * G + cam.stiffness * (pressed + e)
        return float(np.arcsin(held / (m * e * cam.rate**2 - cam.stiffness * e)))

    swing = m * e * limit(500.0)**2
    return scene, [
        Criterion("forces at top and bottom, half rate", "N",
                  [at(normal(cam), turn * 2 * np.pi / cam.rate, force(cam, sine))
                   for cam in cams[:2] for turn, sine in ((1.25, 1.0), (1.75, -1.0))],
                  "m e ω² (h ω)², at half of 85 rad/s", swing / 4, cams[0].rate),
        Criterion("least force at 0.99 of the rate", "N",
                  [Digit(force(cam, 1.0), partial(least, cam)) for cam in cams[2:4]],
                  "m e ω² (h ω)²; and the top lies between two samples", swing, limit(500.0),
                  falls=False),
        event("angles of lift-off at 1.1 of it", "rad",
              [Digit(lift_off(cam), partial(lifts, cam)) for cam in cams[4:]],
              max(cam.rate for cam in cams), "the step in which it happens: ω h")]


PLAY, RESTITUTION = 1e-3, 0.4


def slider(until: float, step: float, *, friction: float = 0.0, turning: float = 0.0) -> Json:
    """Crank, rod, and a box between two guides that turns at a rate [rad/s] at the start."""
    block = body("slider", CRANK + ROD, 0.0, 0.0, MASSES[2], INERTIAS[2], material="steel",
                 angular_velocity=turning, shapes=[{"type": "box", "size": [0.1, 0.05]}])
    guides = [{"name": name, "motion": "fixed", "material": "steel", "shapes": [
        {"type": "box", "size": [0.8, 0.02], "at": [0.3, side * (0.025 + PLAY + 0.01)]}]}
        for name, side in (("upper", 1.0), ("lower", -1.0))]
    return spelled(
        until, step, gravity=[0.0, -G],
        materials={"steel": {"friction": friction, "restitution": RESTITUTION}},
        bodies=[GROUND, *guides, *crank_and_rod(), block],
        joints=[hinge("ground", "crank"), hinge("crank", "rod"), hinge("rod", "slider")],
        meters=[{"name": "turns", "value": "=crank.angle / tau", "unit": "1"},
                {"name": "height", "value": f"=slider.y / {PLAY}", "unit": "1"}])


COURSE = {
    0.005: (0.091701364, 85.68325, 0.873660), 0.01: (0.150936703, 67.53226, 1.0),
    0.02: (0.256959909, 71.79971, 0.840285), 0.05: (0.763801205, 68.55594, 0.999746),
    0.1: (1.439425897, 138.90377, -1.0), 0.2: (2.892929370, 77.73675, -0.992588),
}
"""Turns of the crank, its rate [rad/s], height of the slider in plays."""
HITS, SPEEDS = (0.0026925028, 0.0056077979, 0.0074656352), (0.841612322, 0.247894253, 0.084250616)
"""The first impacts, all at the upper guide: when [s], and at what speed [m/s]."""
LEAVES = {"upper": (0.015020309,),
          "lower": (0.034298095, 0.068179394, 0.102786504, 0.136945428, 0.171841573)}
"""When it leaves a guide on which it rested [s]."""


@benchmark("Slider-crank with clearance",
           "The slider of 100 × 50 mm has 1 mm of play on either side in its guide and is "
           "reflected with e = 0.4: free flight, impacts that come ever faster, rest on a guide.",
           f"{FLORES}. Digits by an integration of order 8 from impact to impact. Differs: no "
           "friction, and the slider does not turn at the start, so that both corners hit "
           "together; as published, corner after corner chatters to rest within 2 μs. Approaches "
           "below 1 cm/s are plastic.",
           steps=(5e-5, 2e-5, 1e-5), fault={"materials.steel.restitution": 0.45})
def test_slider_with_play() -> Problem:
    """The third impact is up to ``early`` steps early: each comes up to h early, v h from the
    guide, and leaves 1 + e times that way less to the next, approached at that one's speed.
    """
    early = 1 + sum(1 + (1 + RESTITUTION) * a / b for a, b in pairwise(SPEEDS))
    changes, slowest, steepest, faint = 37.3, 68.0, 1.7e4, RESTITUTION * 0.01
    shift = changes * early

    def left(guide: str, instant: float, run: Recording) -> float:
        pressed = (run[f"slider/{guide}.normal"] > 0) & (np.abs(run.time - instant) < 2e-3)
        return float(run.time[np.flatnonzero(pressed)[-1]] + run.info.step / 2)

    def hit(i: int, run: Recording) -> float:
        return float(run.time[np.flatnonzero(run["slider/upper.normal"] > 0)[i]])

    return lambda step: slider(0.2, step), [
        event("turns of the crank", "1", [at("turns", t, row[0]) for t, row in COURSE.items()],
              1.0, f"impacts change the crank's rate by {changes:g} rad/s in all, each of them up "
              f"to {early:.0f} h early", scale=shift / (2 * np.pi)),
        event("rate of the crank", "rad/s",
              [at("crank.omega", t, row[1]) for t, row in COURSE.items()], 1.0,
              "so late is the crank, with up to 1.7 · 10⁴ rad/s²; and the rebounds below 1 cm/s",
              scale=steepest * shift / slowest, floor=3.5 * faint),
        event("height of the slider", "plays",
              [at("height", t, row[2]) for t, row in COURSE.items()], 1.0,
              f"an impact {early:.0f} h early, at the speed after the first one; and the rebounds "
              "below 1 cm/s, pressed on by at least 24 m/s²",
              scale=early * RESTITUTION * SPEEDS[0] / PLAY, floor=faint**2 / (2 * 24.0) / PLAY),
        event("first impacts", "s", [Digit(t, partial(hit, i)) for i, t in enumerate(HITS)], early,
              "v h early, and 1 + e times that less to go to the next one"),
        event("instants at which it leaves a guide", "s",
              [Digit(t, partial(left, guide, t)) for guide, times in LEAVES.items()
               for t in times], 1.0 + shift / slowest, "the step, and the delay of the crank"),
        exact("tilt of the slider", "rad",
              [Digit(0.0, lambda run: float(np.abs(run["slider.angle"]).max()))], 1e-12,
              "both corners are reflected in one solve: rounding")]


@benchmark("First touch of the slider with clearance",
           "The slider turns by −0.01 rad/s at the start and μ = 0.01, so one corner hits the "
           "guide before the other: the impact, slip, and its effect on the three bodies.",
           f"{FLORES}. Digits by an integration of order 8. Run up to just before the next corner "
           "hits, 1.35 μs later.",
           steps=(4e-7, 2e-7, 1e-7), fault={"materials.steel.friction": 0.02})
def test_first_touch() -> Problem:
    before = {"crank": 109.58016850, "rod": -49.345789362}
    after = {"crank": 109.5706813989, "rod": -49.3858196402, "slider": 23.2874476872}
    angles = {"crank": 0.355129243, "rod": -0.171430644, "slider": -2.6909e-5}
    impulse, slows = 1.26440154e-3, 1.5e4

    def struck(run: Recording) -> int:
        return int(np.argmax(run["slider/upper.normal"] > 0))

    def read(quantity: str, samples: int, run: Recording) -> float:
        return float(run[quantity][struck(run) + samples])

    def given(key: str, run: Recording) -> float:
        return abs(read(f"slider/upper.{key}", 0, run)) * run.info.step

    def rates(values: dict[str, float], samples: int) -> list[Digit]:
        return [Digit(rate, partial(read, f"{name}.omega", samples))
                for name, rate in values.items()]

    return lambda step: slider(0.0026920 - 4 * step, step, friction=0.01, turning=-0.01), [
        event("instant", "s", [Digit(0.0026909036, lambda run: float(run.time[struck(run)]))], 1.0,
              "the step in which it happens"),
        event("angles", "rad", [Digit(angle, partial(read, f"{name}.angle", 0))
                                for name, angle in angles.items()], 125.0, "ω h of the crank",
              floor=1e-9),
        event("rates before", "rad/s", rates(before, -1), slows,
              "of the last sample before the impact, two steps early at most", scale=2.0),
        event("rates after", "rad/s", rates(after, 1), slows,
              "of the first sample after it, two steps late at most", scale=2.0),
        event("impulses", "N s", [Digit(impulse, partial(given, "normal")),
                                  Digit(0.01 * impulse, partial(given, "tangential"))], 1.0,
              "h of 400 m/s², by which the corner approaches the guide at 0.84 m/s more slowly",
              scale=1.4 * 400.0 / 0.84 * impulse)]


POLE, HOLE, HALF = 0.0025, 0.0031, 0.0058
"""Radius of the pole, of the hole in the sleeve; half the sleeve's height [m]."""
ARM, TAIL, BEAK = 0.010, 0.015, (-0.0201, 0.02)
"""From the sleeve to the spring, from there to the bird's centre, from there to the beak [m]."""
TOY_MASSES, TOY_INERTIAS = (3e-4, 4.5e-3), (5e-9, 7e-7)
"""Of sleeve and bird."""
STIFFNESS, FRICTION, PECK = 0.0056, 0.3, 0.5
"""Of the spring [N m/rad]; friction of all contacts; restitution of the beak."""
START, SPEED, RATE = (-0.1034, -0.2788), -0.3411, -7.4583
"""Angles of sleeve and bird [rad], speed of the sleeve [m/s], rate of the bird [rad/s]."""
CYCLE = (0.13075, -0.014500)
"""Period [s] and way down in it [m]."""


def cycles(time: Array, height: Array, angle: Array) -> Array:
    """When the bird's angle passes 0 upwards [s], and the sleeve's height then [m], [2, n]."""
    k = np.flatnonzero((angle[:-1] < 0) & (angle[1:] >= 0))
    share = -angle[k] / (angle[k + 1] - angle[k])
    return np.stack([x[k] + share * (x[k + 1] - x[k]) for x in (time, height)])


@benchmark("Woodpecker toy",
           "A sleeve with play slides down a pole; a bird on a spring tilts it, so that it jams by "
           "friction at its edges, swings back, hits the pole with its beak, and shakes it loose.",
           "Pfeiffer and Glocker; data of Siconos' example Woodpecker. Differs: there gaps and "
           "arms are of first order in the angles, with a limit cycle of 0.14607 s and 19.476 mm; "
           "with real corners it has 0.13075 s and 14.50 mm, by Moreau's time stepping at 1 μs, a "
           "program that with gaps of first order gives 0.1460 s and 19.45 mm.",
           steps=(1e-4, 5e-5, 2e-5),
           fault={"materials.wood.friction": 0.29, "materials.metal.friction": 0.29})
def test_woodpecker() -> Problem:
    """Four impacts a cycle: the beak, the sleeve twice, and when it comes loose."""
    sleeve, bird = START
    along = np.array([np.cos(bird), np.sin(bird)])
    centre = ARM * np.array([np.cos(sleeve), np.sin(sleeve)]) + TAIL * along
    moved = np.array([0.0, SPEED]) + TAIL * RATE * np.array([-along[1], along[0]])
    x, y = BEAK

    def mean(row: int, run: Recording) -> float:
        passed = cycles(run.time, run["sleeve.y"], run["bird.angle"])[row, -5:]
        return float((passed[-1] - passed[0]) / 4)

    def extreme(quantity: str, of: Callable[[Array], float], run: Recording) -> float:
        return float(of(run[quantity][run.time > 0.6]))

    return lambda step: spelled(
        1.2, step, gravity=[0.0, -G],
        materials={"wood": {"friction": FRICTION, "restitution": PECK},
                   "metal": {"friction": FRICTION, "restitution": 0.0}},
        bodies=[
            {"name": "pole", "motion": "fixed", "material": "wood",
             "shapes": [{"type": "box", "size": [2 * POLE, 1.0], "at": [0.0, -0.4]}]},
            {"name": "line", "motion": "fixed"},
            {"name": "sleeve", "mass": TOY_MASSES[0], "inertia": TOY_INERTIAS[0],
             "centre": [0.0, 0.0], "angle": sleeve, "velocity": [0.0, SPEED], "material": "metal",
             "shapes": [{"type": "box", "size": [0.002, 2 * HALF], "at": [HOLE + 0.001, 0.0]}]},
            {"name": "bird", "mass": TOY_MASSES[1], "inertia": TOY_INERTIAS[1],
             "centre": [0.0, 0.0], "at": centre.tolist(), "angle": bird,
             "velocity": moved.tolist(), "angular_velocity": RATE, "material": "wood", "shapes": [
                 {"type": "polygon",
                  "points": [[x, y], [x + 0.003, y + 0.001], [x + 0.003, y - 0.001]]}]}],
        joints=[{"type": "slot", "name": "guide", "a": "line", "b": "sleeve",
                 "start": [0.0, -1.0], "end": [0.0, 0.5]},
                {"type": "pin", "name": "tail", "a": "sleeve", "b": "bird",
                 "on_a": [ARM, 0.0], "on_b": [-TAIL, 0.0]}],
        springs=[{"type": "rotary", "name": "spring", "joint": "tail", "stiffness": STIFFNESS,
                  "rest_angle": 0.0}]), [
            event("period", "s", [Digit(CYCLE[0], partial(mean, 0))], 4,
                  "four impacts a cycle, each within its step", floor=1e-5),
            event("way down in a cycle", "m", [Digit(CYCLE[1], partial(mean, 1))], 4,
                  "the same, at up to 0.5 m/s", scale=0.5, floor=1e-6),
            event("angles in the cycle", "rad",
                  [Digit(-0.47797, partial(extreme, "bird.angle", np.min)),
                   Digit(0.09466, partial(extreme, "sleeve.angle", np.max))], 16.0,
                  "an impact within its step, at up to 16 rad/s", floor=1e-5)]
