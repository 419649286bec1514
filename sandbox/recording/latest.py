"""Room for the last samples of a run that goes on and on: what comes takes the place of what was.

However long it lasts, it takes no more memory than what is handed over at a time.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.kinds.arrays import Arrays
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.recording.builder import TIME, ContactRows, RecordingBuilder
from sandbox.scene.mechanism import Mechanism


class Latest(RecordingBuilder):
    """A builder that holds what :meth:`put` was given last; ``first`` is its first sample."""

    def __init__(
        self, mechanism: Mechanism, statics: Mapping[str, NDArray[Any]], *, model: Model,
    ) -> None:
        super().__init__(mechanism, 0, statics, model=model)
        self.contacts: ContactRows = _LatestRows(self._budget)
        self.first = self.count = 0

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays`` be all samples that there are, the first of them number ``first``."""
        super().put(0, arrays)
        self.first, self.count = first, len(arrays["body_pose"])

    def arrays(self, time: Array) -> Arrays:
        """What there is, as a recording of it has it, at its instants [s]; it shares the memory."""
        return {TIME: time, **{key: rows.finished() for key, rows in self._rows.items()},
                **{key: rows[:self.contacts.count] for key, rows in self.contacts.finished(
                    copied=False, scratch=None).items()}, **self.statics}


class _LatestRows(ContactRows):
    """Contact rows whose samples are counted from the first that is held."""

    def replace(self, first: int, **rows: Any) -> None:
        """Put rows in the place of all that there are."""
        self.count = 0
        self.append(**{**rows, "sample": np.asarray(rows["sample"]) - first})
