"""What pictures need of a recording."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sandbox.model.meters import is_expression, worked_out
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.samples.samples import Samples
from sandbox.scene.mechanism import Mechanism


class RunData(Protocol):
    """Samples of a run."""

    @property
    def mechanism(self) -> Mechanism:
        """The simulated mechanism."""

    @property
    def model(self) -> Model:
        """Its compiled model."""

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """Recorded arrays by key."""

    @property
    def time(self) -> Array:
        """Times of the samples [n] s."""


def read_curve(run: Samples, name: str) -> Array:
    """A quantity or the value of an expression over time [n]."""
    if not is_expression(name):
        return np.asarray(run[name], dtype=float)
    value = worked_out(name, run.mechanism, lambda each: run.time if each == "t" else run[each])
    return np.broadcast_to(value, run.time.shape)


def nearest(time: Array, moments: Sequence[float]) -> Integers:
    """The samples nearest to some moments [s]."""
    return np.unique(np.abs(time[:, None] - np.asarray(moments)).argmin(axis=0))
