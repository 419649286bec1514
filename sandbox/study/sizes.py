"""How large a scene's quantities are: what their errors are measured against.

A size is a mean over time and not a peak, which one blow would set, and the least of all runs
that came to their end: a run that explodes must not excuse itself. Where all quantities of a unit
are as good as nothing, as the turns of a pulley that stays as it is, what masses, lengths and the
duration of the scene make of that unit stands in: a radian for an angle, M L / T² for a force.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sandbox.numeric import Array
from sandbox.recording.recording import Recording

DIMENSIONS: Mapping[str, tuple[int, int, int]] = {
    "1": (0, 0, 0), "": (0, 0, 0), "rad": (0, 0, 0), "rad/s": (0, 0, -1), "rad/s^2": (0, 0, -2),
    "m": (0, 1, 0), "m/s": (0, 1, -1), "m/s^2": (0, 1, -2), "N": (1, 1, -2),
    "N m": (1, 2, -2), "J": (1, 2, -2), "N/m": (1, 0, -2), "N m/rad": (1, 2, -2),
}
"""Of a unit: exponents of mass, length and time; another unit has no size of its own."""


class SceneSizes:
    """The sizes of a scene's quantities in some of its runs, each worked out once."""

    def __init__(self, runs: Sequence[Recording]) -> None:
        self._runs = runs
        self._found: dict[str, float] = {}

    def of_unit(self, unit: str) -> float:
        """Of the largest quantity of a unit, pairs left out, and at least what is natural."""
        if unit not in self._found:
            self._found[unit] = max(self._measured(unit), self._natural(unit))
        return self._found[unit]

    def _measured(self, unit: str) -> float:
        return min((max((usual(run[name]) for name in run.names() if run.unit(name) == unit),
                        default=0.0) for run in self._runs), default=0.0)

    def _natural(self, unit: str) -> float:
        if unit not in DIMENSIONS or not self._runs:
            return 0.0
        run = self._runs[0]
        masses = run.arrays["body_mass"]
        mass, length, time = DIMENSIONS[unit]
        return float(masses[np.isfinite(masses)].max(initial=0.0)**mass
                     * self._measured("m")**length * run.mechanism.run.duration**time)


def usual(values: Array) -> float:
    """Mean size of a quantity's values, samples without one left out; 0 where there is none."""
    sizes = np.abs(values[np.isfinite(values)])
    return float(sizes.mean()) if len(sizes) else 0.0
