"""Linkages with loops, redundant ones among them."""

from __future__ import annotations

import numpy as np

from sandbox.recording.recording import Recording
from sandbox.verification.benchmarks import four_bars
from sandbox.verification.benchmarks.pieces import G
from tests.hard.measures import GAP, closed, energy
from tests.hard.trial import AtMost, Measure, Order, Target, Trial, built
from tests.hard.trials.chains import SECOND_ORDER
from tests.hard.truth.loops import parallelogram


def _tips(loops: int) -> Measure:
    def of(run: Recording) -> float:
        angle = parallelogram(run.time, loops)[0]
        truth = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        return max(float(np.linalg.norm(np.stack(
            [run[f"tip{i}_x"], run[f"tip{i}_y"]], axis=1) - truth, axis=1).max())
            for i in (0, loops))

    return Measure("tip error", "m", of)


def _a02(loops: int) -> Trial:
    cranks = loops + 1
    start = cranks * (1 / 6 + G / 2) + loops * (1 / 2 + G)
    span = start + G * (cranks / 2 + loops)  # from the lowest pose on

    def off(run: Recording) -> float:
        return float(np.abs(energy(run) - start).max() / span)

    targets: list[Target] = [
        AtMost("tip error", 1e-3, 5e-3, "asked over 10 s; 1e-3 m is the aim"),
        AtMost("energy error", 1e-3, 1e-3, "asked, of all that weight can give"), closed(1e-3)]
    if loops == 2:
        targets.append(Order("tip error", (1e-3, 5e-4), 1.8, SECOND_ORDER))
    if loops == 10:
        targets.append(AtMost("tip error", 4e-4, 1e-4, "second order from 2e-5 m at 1 ms; steps "
                              "that end within 1e-5 rad of the singular pose are no others"))
    return Trial(
        f"a02_{loops}", f"IFToMM A02, {loops} four-bar(s) in a row through their singular pose",
        lambda step: built(four_bars.a02(step, loops), sample_rate=100.0),
        (_tips(loops), Measure("energy error", "", off), GAP), tuple(targets))


def trials() -> list[Trial]:
    return [_a02(loops) for loops in (1, 2, 10, 40)]
