"""Room for the last samples of a run that goes on and on: what comes takes the place of what was.

However long it lasts, it takes no more memory than what is handed over at a time.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from sandbox.elements.arrays import CONTACT, IMPACT, Arrays, sizes
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.recording.builder import TIME, RecordingBuilder, Rows
from sandbox.scene.mechanism import Mechanism


class Latest(RecordingBuilder):
    """A builder that holds what :meth:`put` was given last; ``first`` is its first sample."""

    def __init__(
        self, mechanism: Mechanism, statics: Mapping[str, NDArray[Any]], *, model: Model,
    ) -> None:
        super().__init__(mechanism, 0, statics, model=model)
        size = sizes(mechanism, samples=0)
        self.contacts = _LatestRows(self._budget, size, CONTACT)
        self.impacts = _NoRows(self._budget, size, IMPACT)
        self.first = self.count = 0

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays`` be all samples that there are, the first of them number ``first``."""
        super().put(0, arrays)
        self.first, self.count = first, len(arrays["body_pose"])

    def arrays(self, time: Array) -> Arrays:
        """What there is, as a recording of it has it, at its instants [s]; it shares the memory."""
        return {TIME: time, **{key: rows.finished() for key, rows in self._rows.items()},
                **self.contacts.finished(copied=False, scratch=None), **self.statics}


class _LatestRows(Rows):
    """Contact rows whose samples are counted from the first that is held."""

    def replace(self, sample: int, *values: NDArray[Any]) -> None:
        """Put rows in the place of all that there are."""
        self.count = 0
        self.append(values[0] - sample, *values[1:])


class _NoRows(Rows):
    """Rows that are not kept."""

    def append(self, *values: NDArray[Any]) -> None:
        """Drop them."""
