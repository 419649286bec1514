"""Pendulum, springs with force laws, loads by laws of motion, and equilibria."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from scipy.optimize import brentq
from scipy.special import ellipk

from sandbox.equilibria.branches import rest_along
from sandbox.equilibria.rest import rest
from sandbox.mechanics.springs import spring_set
from sandbox.mechanics.statics import joint_torques
from sandbox.mechanics.tendon import route
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.scene.read.load import load_scene, read_scene
from tests.support.mechanisms import G, Json, fixed, mass, mechanism, pin, simulated, spring
from tests.support.reference import SET_G

from .case import Check, case

NEWTON = "Newton's method ends where a step is less than 10⁻¹¹ of the size"


def crossings(time: Array, value: Array) -> Array:
    """Instants [s] at which ``value`` passes 0, by straight lines between samples."""
    i = np.flatnonzero(np.diff(np.sign(value)))
    return np.asarray(time[i] - value[i] * (time[i + 1] - time[i]) / (value[i + 1] - value[i]))


def oscillation(x: float, duration: float, g: float = 0.0, **law: object) -> Recording:
    """Mass of 1 kg released at a stretch x [m] of a spring along x; ``g`` acts along x."""
    return simulated(
        duration, 5e-4, gravity_x=g, bodies=[fixed("wall"), mass("bob", 1.0, (1.0 + x, 0.0))],
        springs=[spring("spring", "wall", "bob", rest_length=1.0, **law)], every_step=True)


@case("Period of a hardening spring (Duffing)", "T = 4 K(m) / ω, ω² = k₁ + k₃ A², m = k₃ A² / 2ω²",
      "1 kg on F = k₁ s + k₃ s³, four amplitudes, h = 0.5 ms")
def test_duffing() -> Iterator[Check]:
    k1, k3 = 100.0, 2e4
    for amplitude in (0.02, 0.05, 0.1, 0.2):
        square = k1 + k3 * amplitude**2
        period = 4 * float(ellipk(k3 * amplitude**2 / (2 * square))) / math.sqrt(square)
        run = oscillation(amplitude, 3.3 * period, force=f"={k1} * stretch + {k3} * stretch ** 3")
        zeros = crossings(run.time, run["bob.x"] - 1.0)[::2]
        yield Check(f"period at {1e3 * amplitude:g} mm", "s", period, np.diff(zeros).mean(),
                    period * 3 * square * 5e-4**2 / 24,
                    "the leapfrog's (ω h)²/24 with the largest slope, k₁ + 3 k₃ A² ≤ 3 ω²")


@case("Springs that only pull, or only push", "m g (L + s) = k s² / 2",
      "a bungee jump of 0.4 m; a mass that meets a bump stop at 1 m/s; h = 0.5 ms")
def test_one_sided_springs() -> Iterator[Check]:
    free, k, h = 0.4, 200.0, 5e-4
    run = oscillation(-free, 2.0, g=G, stiffness=k, only="pull")
    deepest = (G + math.sqrt(G * G + 2 * k * G * free)) / k
    allowed = deepest * k * h**2 + G * h * h
    yield Check("lowest point, below the cord's length", "m", deepest, run["bob.x"].max() - 1.0,
                allowed, "(ω h)² of it, and the fall in a step before the cord is taut")
    yield Check("largest pull", "N", k * deepest, run["spring.force"].max(), k * allowed,
                "the same times k")
    yield Check("minimum force", "N", 0.0, run["spring.force"].min(), 0.0, "a cord never pushes")
    speed, stop = 1.0, 1e4
    run = simulated(
        0.2, h, every_step=True,
        bodies=[fixed("wall"), mass("bob", 1.0, (1.05, 0.0), velocity=(-speed, 0.0))],
        springs=[spring("spring", "wall", "bob", rest_length=1.0, stiffness=stop, only="push")])
    yield Check("speed after a bump stop", "m/s", speed, run["bob.vx"][-1],
                speed * math.sqrt(stop) * h / 2,
                "first and last step are each off by up to h v of the way, ω h / 2 of the speed")


def loaded(load: Mapping[str, object], duration: float, g: float = 0.0, h: float = 1e-3,
           **body: object) -> Recording:
    """Body of 1 kg at the origin under a load."""
    return simulated(duration, h, g=g, every_step=True, loads=[dict(load)],
                     bodies=[{**mass("bob", 1.0, (0.0, 0.0)), **body}])


@case("Drag of a body", "x = v/k (1 − e^(−k t)), v = −u tanh(g t / u)",
      "a throw with linear drag, a fall with quadratic drag, and drag that stops it at once")
def test_drag() -> Iterator[Check]:
    k, vx, vy, h = 1.5, 3.0, 4.0, 1e-3
    run = loaded({"type": "drag", "name": "air", "linear": k}, 2.0, G, velocity=(vx, vy))
    rises = 1 - np.exp(-k * run.time)
    for axis, fastest, truth in (("x", vx, vx / k * rises), (
            "y", vy + G / k, (vy + G / k) / k * rises - G * run.time / k)):
        yield Check(f"{axis} of a throw", "m", truth, run[f"bob.{axis}"],
                    fastest / k * (h * k)**2,
                    "(h k)² of midpoint rule and leapfrog, of the remaining way")
    speed = math.sqrt(2 * G / (1.2 * 0.5))
    fall = loaded({"type": "drag", "name": "air", "area": 0.5}, 3.0, G)
    yield Check("speed of a fall", "m/s", -speed * np.tanh(G * fall.time / speed), fall["bob.vy"],
                speed * (h * G / speed)**2, "(h g / u)² of the terminal speed u")
    slow = math.sqrt(2 * G / 1.2e6)
    for h in (1e-2, 1e-3):
        stiff = loaded({"type": "drag", "name": "mud", "area": 1e6}, 1.0, G, h,
                       velocity=(100.0, 50.0))
        yield Check(f"terminal speed in mud, h = {1e3 * h:g} ms", "m/s", -slow, stiff["bob.vy"][-1],
                    1e-9 * slow, "the force at the step's end follows the law to 1e-10")


@case("Orbit in a central field", "r = a (1 − e²) / (1 + e cos φ), T = 2π √(a³/μ)",
      "one turn round an ellipse of e = 0.5 by a law of acceleration, h = 1 ms")
def test_orbit() -> Iterator[Check]:
    e, h = 0.5, 1e-3
    law = {"type": "law", "name": "sun",
           "acceleration": ["=-x / hypot(x, y) ** 3", "=-y / hypot(x, y) ** 3"]}
    run = loaded(law, 2 * math.pi, at=(1 - e, 0.0), velocity=(0.0, math.sqrt((1 + e) / (1 - e))))
    x, y, vx, vy = (run[f"bob.{name}"] for name in ("x", "y", "vx", "vy"))
    fastest = (1 - e)**-3  # square of the largest rate, at the near end
    why = "the leapfrog's (h ω)² with the fastest rate ω"
    yield Check("largest less least areal velocity", "m²/s", 0.0, np.ptp(x * vy - y * vx), 1e-11,
                "no step gives a moment: rounding of 6000 of them")
    yield Check("mean energy", "J/kg", -0.5, ((vx**2 + vy**2) / 2 - 1 / np.hypot(x, y)).mean(),
                fastest * h**2, why)
    yield Check("far end of the ellipse", "m", -1 - e, x.min(), 2 * fastest * h**2,
                "twice that of the longer half axis")
    yield Check("x after one period", "m", 1 - e, x[-1], fastest * h**2, why)


@case("Buoyancy", "F = ρ g A, ω² = g / d, GM = b² / 12 d + KB − KG",
      "a box that heaves, a tilted one, a disc partly under water")
def test_floating() -> Iterator[Check]:
    width, height, thick, tilt, h = 0.6, 0.2, 0.1, 0.1, 1e-3
    m, draught, rate = 500 * width * height * thick, height / 2, math.sqrt(2 * G / height)
    box: Json = {"mass": m, "inertia": 1.0, "thickness": thick,
                 "shapes": [{"type": "box", "size": (width, height)}]}
    water = {"type": "buoyancy", "name": "water"}
    run = loaded(water, 2.0, G, at=(0.0, 0.02), **box)
    yield Check("heave of a box", "m", 0.02 * np.cos(rate * run.time), run["bob.y"],
                0.02 * 2 * (rate * h)**2, "the leapfrog's (ω h)²/24 of the phase, over two seconds")
    arm = width**2 / (12 * draught) * (1 + math.tan(tilt)**2 / 2) + draught / 2 - height / 2
    yield Check("righting moment at 0.1 rad", "N m", -m * G * arm * math.sin(tilt),
                loaded(water, 2e-3, G, angle=tilt, **box)["water.bob.torque"][0],
                1e-4 * m * G * arm * tilt, "it has moved for half a step")
    r = 0.2
    disc = loaded(water, 2e-3, G, at=(0.0, 0.05), thickness=thick, inertia=1.0,
                  shapes=[{"type": "circle", "radius": r}])
    d = float(disc["bob.y"][0])
    yield Check("lift of a disc", "N", 1000 * G * thick * (
        r * r * math.acos(d / r) - d * math.sqrt(r * r - d * d)), disc["water.bob.fy"][0], 1e-9,
        "rounding")


@case("Laws of velocity and acceleration", "r = m v / q B, a = g / (1 + s)",
      "a body in a magnetic field, and with an added mass")
def test_fields() -> Iterator[Check]:
    rate, h = 5.0, 1e-3
    run = loaded({"type": "law", "name": "coil", "force": [f"={rate} * vy", f"=-{rate} * vx"]},
                 2.0, velocity=(1.0, 0.0))
    turn = rate * run.time
    yield Check("distance from the circle", "m", 0.0, np.hypot(
        run["bob.x"] - np.sin(turn) / rate, run["bob.y"] - (np.cos(turn) - 1) / rate),
        2 * (rate * h)**2, "(ω h)²/12 of the phase over two seconds, and the sagitta of a step")
    yield Check("work of the field", "J", 0.0, run["coil.bob.work"], 1e-11, "rounding")
    for share in (0.5, 10.0):
        heavy = loaded({"type": "law", "name": "water", "force": [0, f"=-{share} * mass * ay"]},
                       0.1, G)
        yield Check(f"fall with an added mass of {share:g} m", "m/s²", -G / (1 + share),
                    heavy["bob.ay"][-1], 1e-8, "1e-10 of the force, and rounding")


@case("Truss that snaps through", "F = 2 k (L₀ / L − 1) y, folds at y² = L₀^(2/3) b^(4/3) − b²",
      "equilibria of the scene `snap_through` for loads from −1.5 to 1.5 N")
def test_rest_snap_through() -> Iterator[Check]:
    half, rise = 0.1, 0.03
    rest_length = math.hypot(half, rise)

    def load(y: float) -> float:
        return 2 * 1000.0 * (rest_length / math.hypot(half, y) - 1) * y

    top = math.sqrt(rest_length**(2 / 3) * half**(4 / 3) - half**2)
    branch, = rest_along(lambda value: read_scene(
        "snap_through", overrides={"parameters.load": value}).mechanism, -1.5, 1.5, 9)
    yield Check("load of every point", "N", [load(stop.rest["node.y"]) for stop in branch.stops],
                [stop.value for stop in branch.stops], 1e-8, f"{NEWTON}, up to 10⁴ N/m")
    wrong = [stop for stop in branch.stops if not stop.fold and
             (stop.rest.stability == "stable") != (abs(stop.rest["node.y"]) > top)]
    yield Check("points of wrong stability", "1", 0, len(wrong), 0,
                "stable where |y| is above that of the fold")
    yield Check("loads of the two folds", "N", [load(top), -load(top)],
                [fold.value for fold in branch.folds], 1e-9,
                "the square of how far the fold is missed")
    yield Check("their heights", "m", [top, -top], [fold.rest["node.y"] for fold in branch.folds],
                1e-8, "there the load changes by 10⁻⁷ of the way along the branch")


@case("Pendulum held up by a weak spring", "k a = m g l sin a, ω² = (k − m g l cos a) / I",
      "equilibria of a bob of 200 g on 100 mm, k = 0.05 N m/rad, from three angles")
def test_rest_upright() -> Iterator[Check]:
    m, arm, k = 0.2, 0.1, 0.05
    inertia = m * arm**2 + 1e-5
    upright, one, other = rest(mechanism(
        duration=1.0, step=1e-3, gravity=(0.0, -G),
        bodies=[fixed("wall"), mass("bob", m, (0.0, arm))],
        joints=[pin("hinge", "wall", "bob", on_b=(0.0, -arm))],
        springs=[{"type": "rotary", "name": "spring", "joint": "hinge", "stiffness": k,
                  "rest_angle": 0.0}]), starts=[{"hinge.angle": a} for a in (0.0, 0.5, -0.5)]).rests
    aside = float(brentq(lambda a: k * a - m * G * arm * math.sin(a), 1.0, 3.0, xtol=1e-14))
    yield Check("angles", "rad", [aside, -aside], [one["hinge.angle"], other["hinge.angle"]], 1e-9,
                NEWTON)
    yield Check("ω² upright and at the side", "1/s^2",
                [(k - m * G * arm * c) / inertia for c in (1.0, math.cos(aside))],
                [upright.modes[0], one.modes[0]], 1e-4,
                "slopes of forces are differences over 10⁻⁷, good to some 10⁻⁷")


@case("Finger at rest on its springs", "T hᵢ = kᵢ Δlᵢ hmᵢ, from (17), (29)",
      "equilibrium of the scene `single_finger`, the disc out of reach, 0.1 N")
def test_rest_finger() -> Iterator[Check]:
    found, = rest(load_scene("single_finger", overrides={
        "bodies[0].at": [1.0, 1.0], "parameters.pull": 0.1})).rests
    theta = np.array([found[f"finger.{name}.angle"] for name in ("mcp", "pip", "dip")])
    springs = spring_set(SET_G.before, SET_G.after)
    yield Check("moments about the hinges", "N m", 0.0, joint_torques(
        0.1, route(SET_G.guides, SET_G.lengths).arms(theta), np.full(3, 300.0),
        springs.elongations(theta), springs.arms(theta)), 1e-12,
        f"{NEWTON}, of springs with 10⁻² N m/rad")
