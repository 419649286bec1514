"""The Recording: samples that can be saved with a verdict and an audit, and loaded again."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Self

from sandbox.audit.audit import audit
from sandbox.recording import store
from sandbox.samples.expectations import verdicts
from sandbox.samples.samples import Samples
from sandbox.whole_files import place


class Recording(Samples):
    """A run: the mechanism, its samples read by name, its files."""

    def save(
        self, directory: str | os.PathLike[str], *, parameters: Mapping[str, float] | None = None
    ) -> None:
        """Judge and audit the run and write all its files; see :mod:`sandbox.recording.store`.

        An earlier run in the directory stays whole until all of this one is on the disk.

        Raises:
            OutputError: no path, or it cannot be written, or another run is being written there.
        """
        folder = place(directory, "a recording")
        store.save(self, folder, verdicts=verdicts(self), figures=audit(self),
                   parameters=parameters)

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Self:
        """The recording that was saved into ``directory``; incomplete if it has no ``run.json``.

        Raises:
            OutputError: no path, or there is none, it cannot be read, or its files are of two runs.
        """
        return cls(*store.load(place(directory, "a recording")))
