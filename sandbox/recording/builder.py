"""Collecting a recording while it is simulated.

The engine hands over its samples and contact rows in chunks, in order of time. They stay in
memory within a budget; a recording beyond it goes to files of a temporary directory as it
comes, and is mapped into memory when it is finished. The files go with the recording.
"""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements.arrays import (
    CONTACT,
    IMPACT,
    MEAN,
    MEAN_CONTACT,
    PER_SAMPLE,
    STATIC,
    Arrays,
    dtype_of,
    row_bytes,
    shape_of,
    sizes,
)
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.recording.scratch import Budget, Growing, Scratch
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits

MEMORY = 1 << 26
"""Bytes of samples that are kept in memory before files are used."""
RECORDED_BYTES = Limits.recorded_bytes
"""The most that a run may record, contacts included, unless it is told otherwise."""
FIRST_ROWS = 1024
"""Contact rows that there is room for at first."""
TIME = "time"


class Rows:
    """Rows in the making of arrays that have one for each contact or impact; ``count`` of them.

    They are in order of the first array, or of the first three: (sample, body, other) or
    (time, body, other).
    """

    def __init__(
        self, budget: Budget, size: Mapping[str, int], keys: Iterable[str], by: int = 3,
    ) -> None:
        """``size`` has the lengths of all axes but the first, ``by`` is how many arrays sort."""
        shapes = {key: shape_of(key, size)[1:] for key in keys}
        self._columns = {key: Growing(budget, shape, dtype_of(key), FIRST_ROWS)
                         for key, shape in shapes.items()}
        self._row = 8 * sum(map(math.prod, shapes.values()))
        self.count, self._by = 0, by

    @property
    def bytes(self) -> int:
        """Bytes of all rows."""
        return self.count * self._row

    def append(self, *values: NDArray[Any]) -> None:
        """Add rows, the values of all arrays in their order.

        Those of the first array are not below those that are there.
        """
        count = len(values[0])
        if self._by > 1 and not _in_order(values[2::-1]):
            order = np.lexsort(values[2::-1])
            values = tuple(column[order] for column in values)
        for rows, column in zip(self._columns.values(), values, strict=True):
            rows.put(self.count, column)
        self.count += count

    def replace(self, sample: int, *values: NDArray[Any]) -> None:
        """Put rows, given as to :meth:`append`, in the place of those from ``sample`` on."""
        self.count = self.before(sample)
        self.append(*values)

    def before(self, sample: int) -> int:
        """How many rows come before those of a sample."""
        samples = next(iter(self._columns.values())).finished()[:self.count]
        return int(np.searchsorted(samples, sample))

    def finished(self, *, copied: bool, scratch: Scratch | None) -> Arrays:
        """All rows; see :class:`~sandbox.recording.scratch.Growing`."""
        return {key: rows[:self.count] for key, rows in _finished(
            self._columns, copied=copied, scratch=scratch).items()}


class RecordingBuilder:
    """Room for the samples of a run; ``finish`` makes the :class:`Recording`.

    ``put`` takes what has a row per sample, ``contacts``, ``means``, ``mean_contacts`` and
    ``impacts`` rows of these. ``statics`` are the arrays that do not change (body masses, centres
    and inertias, tendon lengths). ``apart`` is whether samples are several steps apart.
    ``model`` is the mechanism's, if the recording shall not compile its own. Above ``memory``
    bytes, files in ``directory`` (the system's temporary one) are used.

    Raises:
        OutputError: there is no room for the files.
    """

    def __init__(
        self, mechanism: Mechanism, samples: int, statics: Mapping[str, NDArray[Any]], *,
        apart: bool = False, model: Model | None = None, memory: float = MEMORY,
        directory: str | os.PathLike[str] | None = None,
    ) -> None:
        self.mechanism, self._model = mechanism, model
        self.statics: Arrays = {key: np.array(statics[key], dtype=float) for key in STATIC}
        self._sample_bytes = row_bytes(mechanism, PER_SAMPLE)
        fits = samples * self._sample_bytes <= memory
        self._budget, self._directory = Budget(memory if fits else 0, directory), directory
        size = sizes(mechanism, samples=0)
        self._rows = {key: Growing(self._budget, shape_of(key, size)[1:], np.float64, samples)
                      for key in PER_SAMPLE if key != TIME}
        if not fits:
            self._budget.give_back(int(memory))
        self.apart = apart
        self.contacts, self.impacts = (
            Rows(self._budget, size, keys) for keys in (CONTACT, IMPACT))
        self.means, self.mean_contacts = (
            Rows(self._budget, size, keys, by=1) for keys in (MEAN, MEAN_CONTACT))

    @property
    def recorded_bytes(self) -> int:
        """Bytes of what was recorded so far, contact rows and impacts included."""
        return (self._rows["body_pose"].count * self._sample_bytes
                + sum(rows.bytes for rows in (
                    self.contacts, self.means, self.mean_contacts, self.impacts)))

    def blank(self, samples: int) -> Arrays:
        """Every array that :meth:`put` takes, for so many samples, filled with nan."""
        size = sizes(self.mechanism, samples=samples)
        return {key: np.full(shape_of(key, size), np.nan) for key in self._rows}

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays``, as :meth:`blank` gives them, be the samples from number ``first`` on.

        Raises:
            OutputError: the disk is full.
        """
        for key, rows in self._rows.items():
            rows.put(first, arrays[key])

    def finish(self, time: Array, info: Outcome, *, copied: bool = False) -> Recording:
        """The recording of the first samples, as many as ``time`` has instants [s].

        Contact rows beyond are dropped. It shares this memory and these files unless it is
        ``copied``, as it has to be if more is to be written.

        Raises:
            OutputError: the disk is full.
        """
        scratch = self._budget.scratch
        if copied and scratch is not None:
            scratch = Scratch(self._directory)
        arrays = _finished(self._rows, copied=copied, scratch=scratch)
        arrays = {key: array[:len(time)] for key, array in arrays.items()}
        means = (self.means, self.mean_contacts) if self.apart else ()
        for rows in (self.contacts, *means):
            count = rows.before(len(time))
            arrays |= {key: array[:count] for key, array in rows.finished(
                copied=copied, scratch=scratch).items()}
        arrays |= self.impacts.finished(copied=copied, scratch=scratch)
        return Recording(self.mechanism, {TIME: np.array(time), **arrays, **self.statics}, info,
                         model=self._model, scratch=scratch)


def _finished(rows: Mapping[str, Growing], *, copied: bool, scratch: Scratch | None) -> Arrays:
    return {key: each.copied(scratch) if copied else each.finished()
            for key, each in rows.items()}


def _in_order(keys: tuple[Integers, ...]) -> bool:
    """Whether rows are in lexical order of the keys, the last key counting most."""
    later = np.zeros(max(len(keys[0]) - 1, 0), dtype=bool)
    for key in keys:
        step = np.diff(key)
        later = (step > 0) | ((step == 0) & later) if key is not keys[0] else step >= 0
    return bool(np.all(later))


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
