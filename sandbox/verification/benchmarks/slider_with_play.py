"""The slider-crank whose slider has play in its guide: impacts, chatter, rest on a guide."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.study.orders import EXACT
from sandbox.verification.benchmarks.benchmark import (
    Benchmark,
    Criterion,
    Digit,
    Json,
    at,
    spelled,
)
from sandbox.verification.benchmarks.pieces import GROUND, G, body, pin
from sandbox.verification.benchmarks.slider_crank import (
    CRANK,
    INERTIAS,
    MASSES,
    ROD,
    crank_and_rod,
)

PLAY, RESTITUTION, SIZE, THICK = 1e-3, 0.4, (0.1, 0.05), 0.02
COURSE = {
    0.005: (0.091701364, 85.68325, 0.873660), 0.01: (0.150936703, 67.53226, 1.0),
    0.02: (0.256959909, 71.79971, 0.840285), 0.05: (0.763801205, 68.55594, 0.999746),
    0.1: (1.439425897, 138.90377, -1.0), 0.2: (2.892929370, 77.73675, -0.992588),
}
"""Turns of the crank, its rate [rad/s], height of the slider in plays."""
HITS = (0.0026925028, 0.0056077979, 0.0074656352)
SPEEDS = (0.841612322, 0.247894253, 0.084250616)
"""The first impacts, all at the upper guide: when [s], and at what speed [m/s]."""
LEAVES = {"upper": (0.015020309,),
          "lower": (0.034298095, 0.068179394, 0.102786504, 0.136945428, 0.171841573)}
"""When it leaves a guide that it has come to rest on [s]."""


def machine(until: float, step: float, *, friction: float = 0.0, turning: float = 0.0) -> Json:
    """Crank, rod, and a box between two guides, turning at a rate [rad/s] at the start."""
    slider = body("slider", CRANK + ROD, 0.0, 0.0, MASSES[2], INERTIAS[2], material="steel",
                  angular_velocity=turning, shapes=[{"type": "box", "size": list(SIZE)}])
    inner = SIZE[1] / 2 + PLAY
    guides = [{"name": name, "motion": "fixed", "material": "steel", "shapes": [
        {"type": "box", "size": [0.8, THICK], "at": [0.3, side * (inner + THICK / 2)]}]}
        for name, side in (("upper", 1.0), ("lower", -1.0))]
    return spelled(
        until, step, gravity=[0.0, -G],
        materials={"steel": {"friction": friction, "restitution": RESTITUTION}},
        bodies=[GROUND, *guides, *crank_and_rod(), slider],
        joints=[pin("ground", "crank"), pin("crank", "rod"), pin("rod", "slider")],
        meters=[{"name": "turns", "value": "=crank.angle / tau", "unit": "1"},
                {"name": "height", "value": f"=slider.y / {PLAY}", "unit": "1"}])


def scene(step: float) -> Json:
    """Without friction, the slider not turning: both of its corners always hit together."""
    return machine(0.2, step)


def _hit(i: int) -> Digit:
    def found(run: Recording) -> float:
        struck = np.flatnonzero(run["slider/upper.normal"] > 0)
        return float(run.time[struck[i]])

    return Digit(f"impact {i + 1}", HITS[i], found)


def _left(guide: str, instant: float) -> Digit:
    """Half a step after the last sample with a force in which it does."""
    def found(run: Recording) -> float:
        pressed = (run[f"slider/{guide}.normal"] > 0) & (np.abs(run.time - instant) < 2e-3)
        return float(run.time[np.flatnonzero(pressed)[-1]] + run.info.step / 2)

    return Digit(f"leaves the {guide} guide", instant, found)


def _level(run: Recording) -> float:
    return float(np.abs(run["slider.angle"]).max())


def _early() -> float:
    """By how many steps the third impact may be early.

    An impact comes up to h early, v h from the guide, and is left with 1 + e times that way less
    to go to the next one, which it nears at that one's speed.
    """
    late = 1.0
    for before, after in pairwise(SPEEDS):
        late += 1 + (1 + RESTITUTION) * before / after
    return late


EARLY, BLOWS, SLOWEST, STEEPEST = _early(), 37.3, 68.0, 1.7e4
"""Sum of what the impacts change of the crank's rate [rad/s]; its least rate [rad/s]; the largest
angular acceleration [rad/s^2]."""
SHIFT = BLOWS * EARLY
FAINT, LIFT, SHARE = RESTITUTION * 0.01, 24.0, 3.5
"""The rebound of 1 cm/s [m/s]; what presses the slider on at least [m/s^2]; change of the crank's
rate by an impact, to the slider's [1/m]."""
SLIDER_WITH_PLAY = Benchmark(
    "slider_with_play", "Slider-crank with clearance",
    "The slider of 100 × 50 mm has 1 mm of play on either side in its guide and is reflected with "
    "e = 0.4: free flight, impacts that come ever faster, rest on a guide, again and again.",
    "Flores, Leine and Glocker (2010), with the numbers of Siconos' example SliderCrank. Digits by "
    "an integration of order 8 from impact to impact.",
    "No friction, and the slider does not turn at the start, so that both corners hit together. "
    "As published it turns by −0.01 rad/s, and corner after corner chatters to rest within 2 μs: "
    "after the first touch no digit is the problem's own. Approaches below 1 cm/s give nothing "
    "back.",
    scene, (5e-5, 2e-5, 1e-5),
    (Criterion("turns of the crank", "1",
               [at("turns", t, row[0]) for t, row in COURSE.items()], SHIFT / (2 * np.pi), 1.0,
               f"impacts change the crank's rate by {BLOWS:g} rad/s in all, each of them up to "
               f"{EARLY:.0f} h early", 1.0, steady=False),
     Criterion("rate of the crank", "rad/s",
               [at("crank.omega", t, row[1]) for t, row in COURSE.items()],
               STEEPEST * SHIFT / SLOWEST, 1.0,
               "so late is the crank, with up to 1.7 · 10⁴ rad/s²; and the rebounds below 1 cm/s",
               1.0, floor=SHARE * FAINT, steady=False),
     Criterion("height of the slider", "plays",
               [at("height", t, row[2]) for t, row in COURSE.items()],
               EARLY * RESTITUTION * SPEEDS[0] / PLAY, 1.0,
               f"an impact {EARLY:.0f} h early, at the speed after the first one; and the height "
               "of the rebounds below 1 cm/s", 1.0, floor=FAINT**2 / (2 * LIFT) / PLAY,
               steady=False),
     Criterion("first impacts", "s", [_hit(i) for i in range(3)], 1.0, EARLY,
               "v h early, and 1 + e times that less to go to the next one", 1.0, steady=False),
     Criterion("when it leaves a guide", "s",
               [_left(guide, t) for guide, times in LEAVES.items() for t in times],
               1.0, 1.0 + SHIFT / SLOWEST, "the step, and by how much the crank is late", 1.0,
               steady=False),
     Criterion("tilt of the slider", "rad", [Digit("largest tilt", 0.0, _level)], 1.0, 1.0,
               "both corners are reflected in one solve: rounding", EXACT, 1e-12)),
    {"materials.steel.restitution": 0.45}, quick=(5e-5, 2e-5))
BENCHMARKS = (SLIDER_WITH_PLAY,)
