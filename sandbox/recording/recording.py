"""The Recording: samples that can be saved with a verdict and an audit, and loaded again."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path
from typing import Self

from sandbox.audit.audit import audit
from sandbox.recording import archive, store
from sandbox.samples.expectations import verdicts
from sandbox.samples.samples import Samples


class Recording(Samples):
    """A run: the mechanism, its samples read by name, its files."""

    def save(
        self, directory: str | os.PathLike[str], *, parameters: Mapping[str, float] | None = None
    ) -> None:
        """Judge and audit the run and write all its files; see :mod:`sandbox.recording.store`.

        Raises:
            OutputError: it cannot be written.
        """
        store.save(self, Path(directory), verdicts=verdicts(self), figures=audit(self),
                   parameters=parameters)

    @classmethod
    def load(cls, directory: str | os.PathLike[str]) -> Self:
        """The recording that was saved into ``directory``.

        Raises:
            OutputError: there is none, or it cannot be read.
        """
        return cls(*archive.read(store.archive_of(directory)))
