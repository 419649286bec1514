"""Balls that touch and are struck together: one after the other, the fastest approach first."""

from __future__ import annotations

from functools import partial

from sandbox.recording.recording import Recording
from sandbox.scene.mechanism import Mechanism
from tests.hard.trial import AtMost, Measure, Trial, spell
from tests.hard.truth.contacts import struck_in_sequence

RADIUS, SPEED, WAY = 0.01, 1.0, 0.01


def row(balls: int, restitution: float, step: float) -> Mechanism:
    """A ball that runs into others, which touch, on a plane without weight."""
    bodies = [{"name": f"ball{i}", "mass": 0.1, "material": "hard",
               "at": (2 * RADIUS * i - (0.0 if i else WAY), 0.0),
               "velocity": (0.0 if i else SPEED, 0.0),
               "shapes": [{"type": "circle", "radius": RADIUS}]} for i in range(balls)]
    return spell(0.03, step, bodies=bodies,
                 materials={"hard": {"friction": 0.0, "restitution": restitution}})


def _cradle(balls: int, restitution: float) -> Trial:
    truth = struck_in_sequence([SPEED, *[0.0] * (balls - 1)], restitution)

    def off(run: Recording) -> float:
        return float(max(abs(run[f"ball{i}.vx"][-1] - truth[i]) for i in range(balls)))

    shown = ", ".join(f"{v:.3g}" for v in truth)
    return Trial(
        f"cradle_{balls}_e{restitution:g}", f"{balls} balls, e = {restitution:g}: {shown} m/s",
        partial(row, balls, restitution), (Measure("speed error", "m/s", off),), tuple(
            AtMost("speed error", step, 1e-6, "impacts in sequence, whatever the step")
            for step in (1e-3, 5e-4)))


def trials() -> list[Trial]:
    return [_cradle(balls, e) for e in (1.0, 0.9) for balls in (2, 3, 5)]
