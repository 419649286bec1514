"""What pictures are drawn from."""

from __future__ import annotations

from typing import Any, Protocol

from numpy.typing import NDArray

from sandbox.model.catalogue import Catalogue
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.scene.mechanism import Mechanism


class Filmed(Protocol):
    """What pictures need of a recording."""

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
    def catalogue(self) -> Catalogue:
        """Its quantities."""

    def __getitem__(self, name: str) -> Array:
        """A quantity over time [n]."""

    def unit(self, name: str) -> str:
        """Its SI unit."""

    @property
    def time(self) -> Array:
        """Times of the samples [n] s."""
