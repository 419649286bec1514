"""The slider-crank with play: a box between two guides, both corners of which hit together."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.verification.benchmarks.pieces import GROUND, G, body, pin
from sandbox.verification.benchmarks.slider_crank import (
    CRANK,
    INERTIAS,
    MASSES,
    ROD,
    crank_and_rod,
)
from tests.hard.trial import AtMost, Measure, Trial, spell
from tests.hard.trials.linkages import SLIDER_CRANK
from tests.hard.truth.clearance import SliderWithPlay

PLAY, RESTITUTION = 1e-3, 0.4
SIZE = (0.1, 0.05)
DURATION = 0.05
TRUTH = SliderWithPlay(replace(SLIDER_CRANK, loops=(), slides=()), PLAY, RESTITUTION)


def guided(step: float) -> Mechanism:
    """The linkage of the ideal slider-crank, its slider free between the guides."""
    slider = body("slider", CRANK + ROD, 0.0, 0.0, MASSES[2], INERTIAS[2], material="steel",
                  shapes=[{"type": "box", "size": SIZE}])
    inner, thick = SIZE[1] / 2 + PLAY, 0.02
    guides = [{"name": name, "motion": "fixed", "material": "steel", "shapes": [
        {"type": "box", "size": (0.8, thick), "at": (0.3, side * (inner + thick / 2))}]}
        for name, side in (("upper", 1.0), ("lower", -1.0))]
    return spell(
        DURATION, step, gravity=(0.0, -G), sample_rate=1e4,
        materials={"steel": {"friction": 0.0, "restitution": RESTITUTION}},
        bodies=[GROUND, *guides, *crank_and_rod(), slider],
        joints=[pin("ground", "crank"), pin("crank", "rod"), pin("rod", "slider")])


@cache
def course(times: tuple[float, ...]) -> np.ndarray:
    """Angles and rates of crank and rod at ``times`` [s]."""
    return TRUTH.motion(np.array(times))[0]


def _guided() -> Trial:
    def tilt(run: Recording) -> float:
        return float(np.abs(run["slider.angle"]).max())

    def crank(run: Recording) -> float:
        return float(np.abs(run["crank.angle"] - course(tuple(run.time.tolist()))[:, 0]).max())

    def height(run: Recording) -> float:
        truth = np.array([TRUTH.height(y)[0] for y in course(tuple(run.time.tolist()))])
        return float(np.abs(run["slider.y"] - truth).max() / PLAY)

    step = 1e-5
    return Trial(
        "play", "slider-crank whose box slider has 1 mm of play, e = 0.4, 0.05 s", guided,
        (Measure("tilt", "rad", tilt), Measure("crank error", "rad", crank),
         Measure("height error", "plays", height)),
        (AtMost("tilt", step, 1e-5, "both corners are hit in one solve: rounding, no more"),
         AtMost("crank error", step, 1e-3, "impacts fall on a step, up to h late"),
         AtMost("height error", step, 0.05, "h of 0.84 m/s is 0.8 % of the play; some impacts")))


def trials() -> list[Trial]:
    return [_guided()]
