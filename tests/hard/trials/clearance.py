"""The slider-crank with play: a box between two guides, both corners of which hit together."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from sandbox.verification.benchmarks import slider_with_play
from tests.hard.trial import AtMost, Measure, Trial, built
from tests.hard.trials.linkages import SLIDER_CRANK
from tests.hard.truth.clearance import SliderWithPlay

PLAY = slider_with_play.PLAY
TRUTH = SliderWithPlay(
    replace(SLIDER_CRANK, loops=(), slides=()), PLAY, slider_with_play.RESTITUTION)


def guided(step: float) -> Mechanism:
    """The linkage of the ideal slider-crank, its slider free between the guides, for 0.05 s."""
    return built(slider_with_play.machine(0.05, step), sample_rate=1e4)


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
