"""What the tables of a run hold before its first step, to go back to without making them anew."""

from __future__ import annotations

import numpy as np

from sandbox.engine.tables import WORKSPACE, Tables


class Beginning:
    """The numbers of tables that were just made.

    Args:
        tables: of a run that has made no step.
    """

    def __init__(self, tables: Tables) -> None:
        self._tables = tables
        self._kept = [
            (array, array.copy()) for part in (tables.constants, tables.state, tables.result)
            for name, array in part._asdict().items()
            if isinstance(array, np.ndarray) and array.flags.writeable and name not in WORKSPACE]

    def restored(self) -> Tables:
        """The tables as they were, in the memory that they were made in."""
        for array, value in self._kept:
            array[...] = value
        return self._tables
