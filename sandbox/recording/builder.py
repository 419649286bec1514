"""Collecting a recording while it is simulated.

The engine hands over its samples and contact rows in chunks, in order of time. They stay in
memory within a budget; a recording beyond it goes to files of a temporary directory as it
comes, and is mapped into memory when it is finished. The files go with the recording.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.kinds.arrays import (
    CONTACT,
    CONTACT_BYTES,
    PER_SAMPLE,
    STATIC,
    Arrays,
    dtype_of,
    sample_bytes,
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


class ContactRows:
    """Contact rows in the making, in order of (sample, body, other); ``count`` of them."""

    def __init__(self, budget: Budget) -> None:
        size = {"m": FIRST_ROWS}
        self._columns = {key: Growing(budget, shape_of(key, size)[1:], dtype_of(key), FIRST_ROWS)
                         for key in CONTACT}
        self.count = 0

    def append(
        self, sample: int | Integers, body: Integers, other: Integers, point: Array, force: Array,
        normal: Array, gap: Array, merged: Array, twist: Array,
    ) -> None:
        """Add touching pairs: shapes [r], [r], [r, 2], [r, 2], [r, 2], [r], [r], [r].

        They are those of one sample, or ``sample`` tells each row's own, shape [r]; of no sample
        that comes before those which are there.
        """
        of = np.broadcast_to(np.asarray(sample, dtype=np.int64), body.shape)
        values: tuple[NDArray[Any], ...] = (
            of, body, other, point, force, normal, gap, merged, twist)
        if not _in_order((other, body, of)):
            order = np.lexsort((other, body, of))
            values = tuple(column[order] for column in values)
        for rows, column in zip(self._columns.values(), values, strict=True):
            rows.put(self.count, column)
        self.count += len(body)

    def replace(self, first: int, **rows: Any) -> None:
        """Put rows, given as to :meth:`append`, in the place of those from sample ``first`` on."""
        samples = self._columns["contact_sample"].finished()[:self.count]
        self.count = int(np.searchsorted(samples, first))
        self.append(**rows)

    def finished(self, *, copied: bool, scratch: Scratch | None) -> Arrays:
        """All rows; see :class:`~sandbox.recording.scratch.Growing`."""
        return _finished(self._columns, copied=copied, scratch=scratch)


class RecordingBuilder:
    """Room for the samples of a run; ``finish`` makes the :class:`Recording`.

    ``put`` takes what has a row per sample, ``contacts`` the contact rows. ``statics`` are the
    arrays that do not change (body masses, centres and inertias, tendon lengths). ``model`` is
    the mechanism's, if the recording shall not compile its own. Above ``memory`` bytes, files in
    ``directory`` (the system's temporary one) are used.

    Raises:
        OutputError: there is no room for the files.
    """

    def __init__(
        self, mechanism: Mechanism, samples: int, statics: Mapping[str, NDArray[Any]], *,
        model: Model | None = None, memory: float = MEMORY,
        directory: str | os.PathLike[str] | None = None,
    ) -> None:
        self.mechanism, self._model = mechanism, model
        self.statics: Arrays = {key: np.array(statics[key], dtype=float) for key in STATIC}
        self._sample_bytes = sample_bytes(mechanism)
        fits = samples * self._sample_bytes <= memory
        self._budget, self._directory = Budget(memory if fits else 0, directory), directory
        size = sizes(mechanism, samples=0)
        self._rows = {key: Growing(self._budget, shape_of(key, size)[1:], np.float64, samples)
                      for key in PER_SAMPLE if key != TIME}
        if not fits:
            self._budget.give_back(int(memory))
        self.contacts = ContactRows(self._budget)

    @property
    def recorded_bytes(self) -> int:
        """Bytes of what was recorded so far, contact rows included."""
        count = self._rows["body_pose"].count
        return count * self._sample_bytes + self.contacts.count * CONTACT_BYTES

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
        contacts = self.contacts.finished(copied=copied, scratch=scratch)
        count = int(np.searchsorted(contacts["contact_sample"][:self.contacts.count], len(time)))
        arrays |= {key: array[:count] for key, array in contacts.items()}
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
