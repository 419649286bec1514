"""Rows of four-bars: IFToMM's A02 with N loops, and two rods with point masses."""

from __future__ import annotations

import math

from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    spelled,
)
from sandbox.verification.benchmarks.pieces import GROUND, G, bar, mass, pin

DURATION, SPEED = 10.0, 1.0
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
"""By the number of loops: a crank's tip from its hinge, x and y [m], at :data:`INSTANTS`."""
INSTANTS = (1.0, 2.0, 4.0, 10.0)
LAST_RATE = -1.506642180572
"""Of the cranks of two loops at 10 s [rad/s]."""
TURNED = 32.0
"""A tip's way in 10 s [m]: just over five turns."""


def a02(step: float, loops: int) -> Json:
    """Cranks upright beside each other, their tips moving at 1 m/s."""
    bodies, joints = [GROUND], []
    for i in range(loops + 1):
        bodies.append(bar(f"crank{i}", i, math.pi / 2, 1.0, 1.0,
                          velocity=[SPEED / 2, 0.0], angular_velocity=-SPEED))
        joints.append(pin("ground", f"crank{i}"))
    for i in range(loops):
        bodies.append({**bar(f"coupler{i}", i + 1j, 0.0, 1.0, 1.0, velocity=[SPEED, 0.0]),
                       "mass": "=coupler"})
        joints += [pin(f"crank{i}", f"coupler{i}"), pin(f"crank{i + 1}", f"coupler{i}", 1.0)]
    meters = [{"name": f"tip{i}_{axis}", "unit": "m",
               "value": f"=crank{i}.{axis} - {start} + {of}(crank{i}.angle)"}
              for i in (0, loops) for axis, of, start in (("x", "cos", i), ("y", "sin", 0))]
    return spelled(DURATION, step, sample_rate=200.0, gravity=[0.0, -G],
                   parameters={"coupler": 1.0}, bodies=bodies, joints=joints, meters=meters)


def _fastest(loops: int) -> float:
    """Rate of the cranks at the bottom [rad/s]: what the weight gives, and 1 rad/s at the top."""
    ratio = ((loops + 1) / 2 + loops) / ((loops + 1) / 3 + loops) * G
    return math.sqrt(SPEED**2 + 4 * ratio)


def _rows(loops: int) -> Benchmark:
    digits = [at(f"tip{i}_{axis}", t, x) for i in (0, loops)
              for t, row in zip(INSTANTS, TIPS[loops], strict=True)
              for axis, x in zip("xy", row, strict=True)]
    fastest = _fastest(loops)
    why = "the tip's way in 10 s times (h ω)², ω that of the cranks at the bottom"
    criteria = [Criterion("tips of the first and the last crank", "m", digits, TURNED, fastest,
                          why)]
    if loops == 2:
        last: list[Digit] = [at("crank0.omega", DURATION, LAST_RATE)]
        criteria.append(Criterion("rate of the cranks", "rad/s", last, fastest * TURNED, fastest,
                                  "the same, ω times as fast"))
    pairs = f"{loops} four-bars side by side" if loops > 1 else "One four-bar"
    return Benchmark(
        f"a02_{loops}", f"Four-bars in a row (A02), N = {loops}",
        f"{pairs}: {loops + 1} cranks and {loops} coupler{'s' * (loops > 1)} of 1 m and 1 kg, "
        "upright at the start, tips at 1 m/s, for 10 s. With the cranks level all links are in "
        "line: the pose is singular, and is passed through ten times.",
        "IFToMM library of computational benchmark problems, A02. Digits by an integration of "
        "order 8 in one coordinate, ((N+1)/3 + N) θ″ = −((N+1)/2 + N) g cos θ, in which all "
        "cranks stay parallel" + ("; another program's for h → 0, 0.32846 and 0.94452 at 10 s, "
                                  "are the same." if loops == 2 else "."),
        "Nothing; the tips of the first and of the last crank are compared at four instants of the "
        "ten seconds.",
        lambda step: a02(step, loops), (2e-3, 1e-3, 5e-4), criteria,
        {"parameters.coupler": 1.01}, drawn=f"four-bars A02, N = {loops}" if loops == 2 else "")


POINTS, KILOGRAMS, RELEASED = (2j, 4 + 5j), 3.0, 4.0
PATHS = {
    ("p1", 0.25): (1.08786343, 1.67825897), ("p1", 0.5): (1.92043143, 0.55851867),
    ("p1", 1.0): (1.48871891, -1.33555832), ("p1", 2.0): (-0.47326910, 1.94319746),
    ("p2", 2.0): (3.50253442, 4.97519125),
}
"""x and y of the masses [m], to eight digits."""


def points(step: float) -> Json:
    """Two masses on three massless rods, both at 4 m/s along x."""
    def rod(name: str, a: str, b: str, x: float = 0.0) -> Json:
        return {"type": "rod", "name": name, "a": a, "b": b, "on_a": [x, 0.0]}

    return spelled(
        2.0, step, gravity=[0.0, -G],
        bodies=[GROUND, *(mass(name, KILOGRAMS, z, velocity=[RELEASED, 0.0])
                          for name, z in zip(("p1", "p2"), POINTS, strict=True))],
        joints=[rod("crank", "ground", "p1"), rod("coupler", "p1", "p2"),
                rod("rocker", "ground", "p2", 4.0)])


TOP = math.sqrt(RELEASED**2 + 2 * G * 4.0)
"""Of a mass that has fallen through the crank's 4 m [m/s]."""
POINT_MASSES = Benchmark(
    "point_masses", "Four-bar with point masses",
    "Two masses of 3 kg at (0, 2) and (4, 5) m, on massless rods of 2, 5 and 5 m from (0, 0) by "
    "both to (4, 0), both at 4 m/s along x, under their weight for 2 s.",
    "The four-bar of EXUDYN's test suite (fourBarMechanismTest). Digits by an integration of "
    "order 8 in one coordinate.",
    "The start: there the second mass has 10 m/s, which the coupler does not let it have, so what "
    "that test keeps is its integrator's and no reference. With 4 m/s for both no rod is broken.",
    points, (2e-3, 1e-3, 5e-4),
    (Criterion("places of both masses", "m",
               [at(f"{name}.{axis}", t, x, f"{name}.{axis} at {t:g} s")
                for (name, t), row in PATHS.items() for axis, x in zip("xy", row, strict=True)],
               2.0 * TOP, TOP / 2.0, "way in 2 s at the speed of a fall through 4 m times (h ω)², "
               "ω that speed on the crank's 2 m", floor=1e-8),),
    {"bodies[p2].mass": 1.01 * KILOGRAMS}, drawn="point masses")
BENCHMARKS = (*(_rows(loops) for loops in TIPS), POINT_MASSES)
