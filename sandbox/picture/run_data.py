"""What pictures need of a recording."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from sandbox.model.catalogue import Catalogue
from sandbox.model.meters import is_expression, worked_out
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism


class RunData(Protocol):
    """What pictures are drawn from."""

    @property
    def mechanism(self) -> Mechanism:
        """What was run."""

    @property
    def model(self) -> Model:
        """The same with its names worked out."""

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """Recorded arrays by key."""

    @property
    def time(self) -> Array:
        """Times of the samples [n] s."""


class MeteredRun(RunData, Protocol):
    """What meters in a picture need besides."""

    @property
    def catalogue(self) -> Catalogue:
        """Its quantities."""

    def __getitem__(self, name: str) -> Array:
        """A quantity over time [n]."""

    def unit(self, name: str) -> str:
        """Its SI unit."""


def read_curve(run: MeteredRun, name: str) -> Array:
    """A quantity, or what an expression gives, over time [n]."""
    if not is_expression(name):
        return np.asarray(run[name], dtype=float)
    value = worked_out(name, run.mechanism, lambda each: run.time if each == "t" else run[each])
    return np.broadcast_to(value, run.time.shape)
