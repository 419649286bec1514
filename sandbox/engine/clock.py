"""The clock. Time comes from the step's index, never from repeated addition.

pymunk moves positions first, then velocities: after step k the poses, and the
forces of step k that acted there, belong to t = (k - 1/2) h, the velocities to
t = k h. Labelled so, the scheme is a leapfrog and its error is second order.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sandbox.numeric import Array, Integers


@dataclass(frozen=True)
class Clock:
    """Step h [s], number of steps, and every how many steps a sample is kept."""

    step: float
    steps: int
    every: int

    @property
    def samples(self) -> int:
        """Number of samples in a whole run."""
        return self.steps // self.every

    def force_time(self, k: Integers | int) -> Array:
        """Instant [s] of the poses and forces of a step, counted k = 1, 2, and so on."""
        return (np.asarray(k, dtype=float) - 0.5) * self.step

    def sample_step(self, i: Integers | int) -> Integers:
        """The step that sample i = 0, 1, … records."""
        return (np.asarray(i, dtype=np.int64) + 1) * self.every


def make_clock(duration: float, step: float, sample_rate: float) -> Clock:
    """A clock for a run of ``duration`` [s]: at least one step and one sample."""
    steps = max(1, math.ceil(duration / step - 1e-9))
    every = min(steps, max(1, round(1 / (sample_rate * step))))
    return Clock(step, steps, every)
