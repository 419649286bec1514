"""Published benchmarks of smooth motion: pendulum, four-bars, squeezer, slider-crank, Geneva."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable

from tests.support.mechanisms import G, Json

from .case import (
    GROUND,
    Criterion,
    Digit,
    Problem,
    at,
    benchmark,
    body,
    exact,
    hinge,
    lag,
    point,
    spelled,
)

IFTOMM = "IFToMM library of computational benchmark problems"
IVP = "Test Set for IVP Solvers (Mazzia and Magherini, Bari)"
FLORES = "Flores, Leine and Glocker (2010), with the numbers of Siconos' example SliderCrank"


def bar(name: str, near: complex, angle: float, length: float, **more: object) -> Json:
    """Uniform bar of 1 kg whose frame sits at its near end."""
    return body(name, near, angle, length / 2, 1.0, length**2 / 12, **more)


def point_mass(name: str, kilograms: float, place: complex, **more: object) -> Json:
    """Point mass; nothing turns its inertia."""
    return {"name": name, "at": point(place), "mass": kilograms, "inertia": 1e-3 * kilograms,
            **more}


def rod(name: str, a: str, b: str, **more: object) -> Json:
    return {"type": "rod", "name": name, "a": a, "b": b, **more}


@benchmark("Simple pendulum (A01)",
           "A point mass of 1 kg on a massless rod of 1 m, released level, for 10 s.",
           f"{IFTOMM}, A01. Digits by Jacobi's elliptic functions.",
           steps=(2e-3, 1e-3, 5e-4), fault={"bodies[bob].at[0]": -1.01})
def test_a01() -> Problem:
    """sin(theta/2) = k sn(K - t sqrt(g/l), k), k = sin 45 deg."""
    places = {
        1.0: (0.986291751132, -0.165010853126), 2.0: (-0.793566195343, -0.608483930444),
        4.0: (0.577563628249, -0.816345671468), 10.0: (-0.275087462576, -0.961419205099)}
    fastest = math.sqrt(2 * G)
    return lambda step: spelled(
        10.0, step, gravity=[0.0, -G], bodies=[GROUND, point_mass("bob", 1.0, -1.0)],
        joints=[rod("rod", "ground", "bob")]), [
            Criterion("place of the mass", "m",
                      [at(f"bob.{axis}", t, x) for t, row in places.items()
                       for axis, x in zip("xy", row, strict=True)],
                      "way at full speed for 10 s, ω² = 2 g/l", fastest * 10.0, fastest)]


TIPS = {
    1: ((-0.260712675184, -0.965416439159), (0.077085471788, 0.997024488184),
        (0.158955504240, 0.987285747730), (0.478385057653, 0.878150178850)),
    2: ((-0.195020301950, -0.980799205662), (0.057815795763, 0.998327267864),
        (0.117616102360, 0.993059138453), (0.328458111447, 0.944518538211)),
    10: ((-0.129306015052, -0.991604737015), (0.038567666593, 0.999255990772),
         (0.077711926434, 0.996975855520), (0.204353560920, 0.978897145843)),
    40: ((-0.115356880633, -0.993324111300), (0.034466307297, 0.999405860330),
         (0.069342032214, 0.997592944326), (0.180512226618, 0.983572740595)),
}
"""By the number of loops: tip of a crank from its hinge [m] at 1, 2, 4 and 10 s."""


def four_bars(loops: int) -> Callable[[str], None]:
    def scene(step: float) -> Json:
        bodies, joints = [GROUND], []
        for i in range(loops + 1):
            bodies.append(bar(f"crank{i}", i, math.pi / 2, 1.0, velocity=[0.5, 0.0],
                              angular_velocity=-1.0))
            joints.append(hinge("ground", f"crank{i}"))
        for i in range(loops):
            bodies.append({**bar(f"coupler{i}", i + 1j, 0.0, 1.0, velocity=[1.0, 0.0]),
                           "mass": "=coupler"})
            joints += [hinge(f"crank{i}", f"coupler{i}"),
                       hinge(f"crank{i + 1}", f"coupler{i}", 1.0)]
        meters = [{"name": f"tip{i}_{axis}", "unit": "m",
                   "value": f"=crank{i}.{axis} - {start} + {of}(crank{i}.angle)"}
                  for i in (0, loops) for axis, of, start in (("x", "cos", i), ("y", "sin", 0))]
        return spelled(10.0, step, sample_rate=200.0, gravity=[0.0, -G],
                       parameters={"coupler": 1.0}, bodies=bodies, joints=joints, meters=meters)

    def define() -> Problem:
        """The tips make five turns, 32 m; cranks are fastest at the bottom."""
        fastest = math.sqrt(1 + 4 * ((loops + 1) / 2 + loops) / ((loops + 1) / 3 + loops) * G)
        criteria = [Criterion(
            "tips of the first and the last crank", "m",
            [at(f"tip{i}_{axis}", t, x) for i in (0, loops)
             for t, row in zip((1.0, 2.0, 4.0, 10.0), TIPS[loops], strict=True)
             for axis, x in zip("xy", row, strict=True)],
            "the tip's way in 10 s times (h ω)², ω that of the cranks at the bottom", 32.0,
            fastest)]
        if loops == 2:
            criteria.append(Criterion(
                "rate of the cranks", "rad/s", [at("crank0.omega", 10.0, -1.506642180572)],
                "the same, ω times as fast", fastest * 32.0, fastest))
        return scene, criteria

    define.__name__ = f"test_a02_{loops}"
    return benchmark(
        f"Four-bars in a row (A02), N = {loops}",
        f"Cranks: {loops + 1}, couplers: {loops}, of 1 m and 1 kg, upright at the start, tips at "
        "1 m/s, for 10 s. With the cranks level all links are in line: the pose is singular, and "
        "is passed ten times.",
        f"{IFTOMM}, A02. Digits by an integration of order 8 in one coordinate, ((N+1)/3 + N) θ″ = "
        "−((N+1)/2 + N) g cos θ.",
        steps=(2e-3, 1e-3, 5e-4), fault={"parameters.coupler": 1.01})(define)


test_a02_1, test_a02_2, test_a02_10, test_a02_40 = map(four_bars, TIPS)


@benchmark("Four-bar with point masses",
           "Two masses of 3 kg at (0, 2) and (4, 5) m, on massless rods of 2, 5 and 5 m from (0, "
           "0) by both to (4, 0), both at 4 m/s along x, under their weight for 2 s.",
           "EXUDYN's test fourBarMechanismTest. Digits by an integration of order 8. Differs: "
           "there the second mass starts with 10 m/s, which the coupler does not allow.",
           steps=(2e-3, 1e-3, 5e-4), fault={"bodies[p2].mass": 3.03})
def test_point_masses() -> Problem:
    paths = {("p1", 0.25): (1.08786343, 1.67825897), ("p1", 0.5): (1.92043143, 0.55851867),
             ("p1", 1.0): (1.48871891, -1.33555832), ("p1", 2.0): (-0.47326910, 1.94319746),
             ("p2", 2.0): (3.50253442, 4.97519125)}
    top = math.sqrt(16.0 + 2 * G * 4.0)
    return lambda step: spelled(
        2.0, step, gravity=[0.0, -G],
        bodies=[GROUND, *(point_mass(name, 3.0, z, velocity=[4.0, 0.0])
                          for name, z in (("p1", 2j), ("p2", 4 + 5j)))],
        joints=[rod("crank", "ground", "p1", on_a=[0.0, 0.0]),
                rod("coupler", "p1", "p2", on_a=[0.0, 0.0]),
                rod("rocker", "ground", "p2", on_a=[4.0, 0.0])]), [
            Criterion("places of both masses", "m",
                      [at(f"{name}.{axis}", t, x) for (name, t), row in paths.items()
                       for axis, x in zip("xy", row, strict=True)],
                      "way in 2 s at the speed of a fall through 4 m times (h ω)², ω that speed on "
                      "the crank's 2 m", 2.0 * top, top / 2.0, floor=1e-8)]


@benchmark("Andrews' squeezer",
           "Seven bodies of some centimetres in three loops, a spring of 4530 N/m, and a torque of "
           "33 mN m that turns the crank two and a half times within 30 ms, up to 1140 rad/s.",
           f"Schiehlen (1990); {IVP}. All digits are the test set's.",
           steps=(4e-6, 2e-6, 1e-6), quick=(1e-5, 5e-6), fault={"bodies[k5].mass": 1.01 * 0.07050})
def test_andrews() -> Problem:
    """K1 turns about O, K2 leads from its end to E; K3 (about B), K4 on K5, K6 on K7 hold E.

    Bodies turn by beta, beta + theta, gamma, phi + delta, delta, omega + epsilon, epsilon.
    """
    a, b = -0.06934 - 0.00227j, -0.03635 + 0.03273j
    start = (-0.0617138900142764496358948458001, -0.0617138900142764496358948458001,
             0.455279819163070380255912382449,
             0.222668390165885884674473185609 + 0.487364979543842550225598953530,
             0.487364979543842550225598953530,
             -0.222668390165885884674473185609 + 1.23054744454982119249735015568,
             1.23054744454982119249735015568)
    masses = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
    inertias = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
    kept = {"k1.angle": 15.81077119629904, "k2.angle - k1.angle": -15.75637105984298,
            "k3.angle": 0.04082224013073101, "k4.angle - k5.angle": -0.5347301163226948,
            "k5.angle": 0.5244099658805304, "k6.angle - k7.angle": 0.5347301163226948,
            "k7.angle": 1.048080741042263}
    turned = [cmath.exp(1j * angle) for angle in start]
    places = (0.0, 7e-3 * turned[0], b, a + 4e-2 * turned[4], a, a - 4e-2j * turned[6], a)
    centres = (92e-5, -115e-4, 1043e-5 - 1874e-5j, -1j * (2e-2 - 1421e-5), 916e-5 - 2308e-5j,
               2e-2 - 1421e-5, -449e-5 - 1228e-5j)
    bodies = [body(f"k{i + 1}", places[i], start[i], centres[i], masses[i], inertias[i])
              for i in range(7)]
    joints = [
        hinge("ground", "k1"), hinge("k1", "k2"), hinge("ground", "k3"), hinge("ground", "k5"),
        hinge("ground", "k7"), hinge("k5", "k4"), hinge("k7", "k6"), hinge("k2", "k3", -35e-3j),
        hinge("k2", "k4", -2e-2j), hinge("k2", "k6", 2e-2)]
    return lambda step: spelled(
        0.03, step, bodies=[GROUND, *bodies], joints=joints,
        springs=[{"type": "linear", "name": "spring", "a": "ground", "b": "k3",
                  "on_a": [0.014, 0.072], "on_b": [2e-2, -18e-3], "stiffness": 4530.0,
                  "rest_length": 0.07785}],
        drives=[{"type": "torque", "name": "motor", "joint": "ground_k1", "value": 0.033}],
        meters=[{"name": f"angle{i}", "value": f"={of}", "unit": "rad"}
                for i, of in enumerate(kept)]), [
            Criterion("the seven angles", "rad",
                      [at(f"angle{i}", 0.03, x) for i, x in enumerate(kept.values())],
                      "the crank's way times (h ω)², ω the crank's at the end", kept["k1.angle"],
                      1200.0)]


@benchmark("Car axis",
           "A massless axle rocks about its left end, y_r = 0.1 sin 10 t at its right; two masses "
           "of 0.5 g, 1 m apart, stand on it on springs of 1 N/m, the left one guided along the "
           "axle's normal. A differential-algebraic problem of index 3.",
           f"{IVP}. Digits at 3 s are the test set's, the others those of an integration of order "
           "8 that meets them to ten digits.",
           steps=(1e-3, 5e-4, 2.5e-4), fault={"bodies[right].mass": 1.01 * 5e-4})
def test_car_axis() -> Problem:
    m, rate = 5e-4, (1.0 / 5e-4)**0.5
    places = {
        0.5: (0.047887818062, 0.497089687181, 1.043577149976, 0.404338653155),
        1.0: (0.027182095440, 0.498911552629, 1.024548795970, 0.426388006981),
        2.0: (-0.045604483643, 0.497445343219, 0.951740760593, 0.570263361597),
        3.0: (0.0493455784275, 0.496989460230, 1.041742524885, 0.373911027265)}
    velocities = (-0.0770583684041, 0.0074468665872, 0.0175568157537, 0.7703410437793)
    why = "ω² = k/m: after ω t the phase of 0.1 m is (h ω)² ω t / 24 off"
    return lambda step: spelled(
        3.0, step, gravity=[0.0, -1.0],
        bodies=[{"name": "axle", "motion": "scheduled",
                 "path": {"angle": "=asin(0.1 * sin(10 * t))"}},
                *(point_mass(name, m, z, velocity=[-0.5, 0.0])
                  for name, z in (("left", 0.5j), ("right", 1.0 + 0.5j)))],
        joints=[{"type": "slot", "name": "slide", "a": "axle", "b": "left",
                 "start": [0.0, 0.2], "end": [0.0, 0.8]}, rod("body", "left", "right", length=1.0)],
        springs=[{"type": "linear", "name": f"{name}_spring", "a": "axle", "b": name,
                  "on_a": [x, 0.0], "stiffness": 1.0, "rest_length": 0.5}
                 for name, x in (("left", 0.0), ("right", 1.0))]), [
            Criterion("places of both masses", "m",
                      [at(q, t, x) for t, row in places.items()
                       for q, x in zip(("left.x", "left.y", "right.x", "right.y"), row,
                                       strict=True)], why, lag(0.1, rate, 3.0), rate),
            Criterion("velocities of both masses", "m/s",
                      [at(q, 3.0, v) for q, v in zip(
                          ("left.vx", "left.vy", "right.vx", "right.vy"), velocities,
                          strict=True)], why, rate * lag(0.1, rate, 3.0), rate)]


CRANK, ROD = 0.153, 0.306
MASSES, INERTIAS = (0.038, 0.038, 0.076), (7.4e-5, 5.9e-4, 2.7e-6)
"""Of crank, rod and slider."""
RATES = (150.0, -75.0)
"""Of crank and rod at the start, both level [rad/s]."""


def crank_and_rod() -> list[Json]:
    """Both level at the start, the crank at 150 rad/s."""
    speed = [0.0, CRANK * RATES[0] / 2]
    return [body("crank", 0.0, 0.0, CRANK / 2, MASSES[0], INERTIAS[0], velocity=speed,
                 angular_velocity=RATES[0]),
            body("rod", CRANK, 0.0, ROD / 2, MASSES[1], INERTIAS[1], velocity=speed,
                 angular_velocity=RATES[1])]


@benchmark("Slider-crank without clearance",
           "A crank of 153 mm at 150 rad/s, a rod of 306 mm, a slider on the x axis, nothing "
           "drives it; weight, 0.2 s.",
           f"{FLORES}. Digits by an integration of order 8 in one coordinate. Differs: no "
           "clearance, so that the motion is smooth.",
           steps=(2e-4, 1e-4, 5e-5), fault={"bodies[slider].mass": 1.01 * MASSES[2]})
def test_slider_crank() -> Problem:
    course = {0.01: (0.1508818943, 67.562263), 0.02: (0.2571128030, 72.282978),
              0.05: (0.7654140217, 68.749509), 0.1: (1.4547004378, 144.406332),
              0.2: (2.9275677994, 97.139411)}
    fastest = 2 * RATES[0]
    slider = body("slider", CRANK + ROD, 0.0, 0.0, MASSES[2], INERTIAS[2])
    why = "three turns times (2 h ω)²: energy goes to the slider and back twice a turn"
    return lambda step: spelled(
        0.2, step, gravity=[0.0, -G], bodies=[GROUND, *crank_and_rod(), slider],
        joints=[hinge("ground", "crank"), hinge("crank", "rod"), hinge("rod", "slider"),
                {"type": "slot", "name": "groove", "a": "ground", "b": "slider", "turns": False,
                 "start": [0.1, 0.0], "end": [0.6, 0.0]}],
        meters=[{"name": "turns", "value": "=crank.angle / tau", "unit": "1"}]), [
            Criterion("turns of the crank", "1",
                      [at("turns", t, x) for t, (x, _) in course.items()],
                      why, 3.0, fastest, floor=1e-9),
            Criterion("rate of the crank", "rad/s",
                      [at("crank.omega", t, x) for t, (_, x) in course.items()],
                      f"2 ω of {why}", fastest * math.tau * 3.0, fastest, floor=1e-6)]


DRIVEN = 10.0
"""Rate of the driving cranks [rad/s]."""


def between_samples(fourth: float) -> float:
    """Floor of exact results: gaps of joints, and the cubic between samples at 2 ms.

    Its error is 9/384 of the fourth derivative times h^4; ``fourth`` is that by the crank's angle.
    """
    return 1e-8 + 0.0235 * fourth * (DRIVEN * 2e-3)**4


KEPT = "joints and motor keep it; the cubic between samples at the coarsest step"


@benchmark("Quick return",
           "A crank of 80 mm at 10 rad/s whose pin slides in a lever that turns about a pivot 200 "
           "mm below: the lever returns 1.71 times faster than it goes.",
           "A textbook's mechanism with numbers of our own. Digits by the closed form tan φ = r "
           "cos θ / (d + r sin θ), its derivatives, and statics.",
           steps=(2e-3, 1e-3, 5e-4), fault={"bodies[lever].inertia": 1.01 * 2e-3})
def test_quick_return() -> Problem:
    """Poses by the crank's angle [deg]: angle [deg], rate and acceleration of the lever, distance
    from its pivot to the pin [m] and its rate [m/s].
    """
    r, d, inertia = 0.08, 0.2, 2e-3
    poses = {0: (21.8014095, -1.37931034, -24.970273, 0.215406592, 0.74278135),
             30: (16.1021138, -2.30769231, -11.956958, 0.249799920, 0.55470020),
             90: (0.0, -2.85714286, 0.0, 0.28, 0.0), 270: (0.0, 6.66666667, 0.0, 0.12, 0.0)}
    fast, bend = DRIVEN * r / (d - r), r * d * (d + r) / (d - r)**3
    begun = math.radians(poses[0][0]), poses[0][1]

    def read(quantity: str, column: int, factor: float = 1.0) -> list[Digit]:
        return [at(quantity, math.radians(angle) / DRIVEN, factor * poses[angle % 360][column])
                for angle in (30, 90, 270, 360, 390)]

    def last(quantity: str, expected: float) -> list[Digit]:
        return [at(quantity, math.radians(390) / DRIVEN, expected)]

    largest = at("phi", (math.tau - math.asin(r / d)) / DRIVEN, math.radians(23.5781785))
    return lambda step: spelled(
        math.radians(390) / DRIVEN, step,
        bodies=[GROUND, {"name": "crank", "mass": 0.1, "inertia": 1e-4, "angular_velocity": DRIVEN},
                {"name": "lever", "at": [0.0, -d], "angle": -begun[0], "mass": 0.5,
                 "inertia": inertia, "angular_velocity": -begun[1]}],
        joints=[hinge("ground", "crank"), hinge("ground", "lever"),
                {"type": "slot", "name": "groove", "a": "lever", "b": "crank", "on_b": [r, 0.0],
                 "start": [0.0, 0.05], "end": [0.0, 0.35]}],
        drives=[{"type": "motor", "name": "motor", "joint": "ground_crank", "value": DRIVEN,
                 "torque": 1.0}],
        meters=[{"name": name, "value": f"={value}", "unit": unit} for name, value, unit in (
            ("phi", "-lever.angle", "rad"), ("phi_rate", "-lever.omega", "rad/s"),
            ("phi_rate_rate", "-lever.alpha", "rad/s^2"),
            ("rho", f"{r} * sin(crank.angle - lever.angle) + {d} * cos(lever.angle)", "m"),
            ("slide", f"{r} * crank.omega * cos(crank.angle - lever.angle)", "m/s"))]), [
            Criterion("rates of the lever", "rad/s", read("phi_rate", 1),
                      "third derivative of its angle times h²: means over half a step",
                      DRIVEN * bend, DRIVEN, floor=5e-9),
            exact("angle of the lever", "rad", [*read("phi", 0, math.pi / 180), largest],
                  between_samples(3 * bend), KEPT),
            Criterion("acceleration of the lever", "rad/s^2", read("phi_rate_rate", 2),
                      "ω² times (h ω)²", fast**2, fast),
            exact("distance from pivot to pin", "m", read("rho", 3), between_samples(r), KEPT),
            exact("speed of the pin in the lever", "m/s", read("slide", 4),
                  between_samples(r * DRIVEN), KEPT),
            Criterion("force on the pin", "N", last("groove.reaction", 0.0957322824),
                      "I ω² / ρ times (h ω)²", inertia * fast**2 / (d - r), fast),
            Criterion("torque on the crank", "N m", last("motor.torque", 0.0055185961),
                      "I ω² times (h ω)²", inertia * fast**2, fast)]


def geneva(slots: int) -> Callable[[str], None]:
    def define() -> Problem:
        """Digits at the driver's angle from the line of centres: wheel [rad], ratio of rates."""
        ratio = math.sin(math.pi / slots)
        entry, bend = math.pi / 2 - math.pi / slots, ratio * (1 + ratio) / (1 - ratio)**3
        radius, far = 0.05 * ratio, 0.05 * math.cos(math.pi / slots)
        angles, ratios = [], []
        for alpha in (*map(math.radians, (10, 20, 0)), entry):
            c, s = math.cos(alpha), math.sin(alpha)
            angles.append(at("turned", (entry + alpha) / DRIVEN,
                             math.atan2(ratio * s, 1 - ratio * c)))
            ratios.append(at("ratio", (entry + alpha) / DRIVEN,
                             ratio * (c - ratio) / (1 - 2 * ratio * c + ratio**2)))
        return lambda step: spelled(
            2 * entry / DRIVEN, step, parameters={"radius": radius},
            bodies=[GROUND, {"name": "driver", "motion": "scheduled",
                             "path": {"angle": f"={DRIVEN} * t - {entry!r}"}},
                    {"name": "wheel", "at": [0.05, 0.0], "angle": math.pi / slots, "mass": 0.05,
                     "inertia": 1e-5}],
            joints=[hinge("ground", "wheel"),
                    {"type": "slot", "name": "peg", "a": "wheel", "b": "driver",
                     "on_b": ["=radius", 0.0], "start": [-1.1 * far, 0.0],
                     "end": [-0.5 * (0.05 - radius), 0.0]}],
            meters=[{"name": "turned", "value": "=-wheel.angle", "unit": "rad"},
                    {"name": "ratio", "value": f"=-wheel.omega / {DRIVEN}", "unit": "1"}]), [
                Criterion("ratio of the rates", "1", ratios,
                          "its second derivative by the driver's angle, λ (1 + λ) / (1 − λ)³ at "
                          "most, times (h ω)²: means over half a step", bend, DRIVEN, floor=5e-9),
                exact("angle of the wheel", "rad", angles,
                      between_samples(3 * bend / (1 - ratio)), KEPT)]

    define.__name__ = f"test_geneva_{slots}"
    return benchmark(
        f"Geneva wheel of {slots} slots",
        f"A wheel of {slots} slots, 50 mm from its driver, which turns at 10 rad/s: from where the "
        "peg enters to where it leaves.",
        "A textbook's mechanism with numbers of our own; closed form λ (cos α − λ) / (1 − 2 λ cos "
        "α + λ²), λ = sin(π/n). The slot is a joint without play, and there is no locking disc.",
        steps=(2e-3, 1e-3, 5e-4), fault={
            "parameters.radius": 1.01 * 0.05 * math.sin(math.pi / slots)})(define)


test_geneva_4, test_geneva_6 = map(geneva, (4, 6))


@benchmark("String over a disc",
           "Length of a string from (−0.10, −0.05) over the top of a disc of 30 mm at the origin "
           "to (0.08, −0.12) m, whose right end is then led upwards.",
           "MuJoCo's tendon wrapping, which gives the same 15 digits, 0.3065998890546526 m; closed "
           "form: two tangents and the arc between them.",
           steps=(2e-3, 1e-3, 5e-4), fault={"tendons[string].guides[1].radius": 1.01 * 0.03})
def test_wrapping() -> Problem:
    radius, left, right = 0.03, -0.10 - 0.05j, 0.08 - 0.12j

    def wrapped(end: complex) -> float:
        a, b = abs(left), abs(end)
        between = math.pi + math.atan2(-end.imag, end.real) + math.atan2(-left.imag, -left.real)
        arc = between - math.acos(radius / a) - math.acos(radius / b)
        return math.sqrt(a * a - radius**2) + math.sqrt(b * b - radius**2) + radius * arc

    return lambda step: spelled(
        1.0, step,
        bodies=[GROUND, {"name": "end", "motion": "scheduled", "at": point(right),
                         "path": {"y": "=-0.12 + 0.04 * t"}}],
        tendons=[{"name": "string", "guides": [
            {"body": "ground", "at": point(left)},
            {"body": "ground", "radius": radius, "side": "right"}, {"body": "end"}]}]), [
            exact("length of the string", "m",
                  [at("string.length", 0.0, 0.3065998890546526),
                   *(at("string.length", t, wrapped(right + 0.04j * t)) for t in (0.5, 1.0))],
                  2e-12, "geometry: rounding, and 1e-12 of the cubic between samples")]
