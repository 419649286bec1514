"""Collecting a recording while it is simulated.

The engine gives its samples and contact rows in chunks, in order of time. Arrays that do not fit a
memory budget are mapped from temporary files, which are removed with the recording.
"""

from __future__ import annotations

import math
import os
import tempfile
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.elements import arrays as layout
from sandbox.elements.arrays import Arrays
from sandbox.errors import OutputError
from sandbox.model.model import Model
from sandbox.numeric import Array
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism
from sandbox.scene.read.limits import Limits

MEMORY = 1 << 26  # Bytes of samples that are kept in memory before files are used
RECORDED_BYTES = Limits.recorded_bytes  # The default limit of a recording, contacts included
FIRST_ROWS = 1024  # Contact rows that there is room for at first
TIME = "time"
ZEROS = bytes(1 << 20)


class Room:
    """A budget of memory [bytes], and temporary files without a name for arrays beyond it."""

    def __init__(self, memory: float) -> None:
        self.left = memory

    def array(
        self, shape: tuple[int, ...], dtype: Any, old: NDArray[Any] | None = None,
    ) -> NDArray[Any]:
        """A new array, or a longer one in place of ``old`` that begins with its rows."""
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if size <= self.left and not isinstance(old, np.memmap):
            self.left -= size
            made: NDArray[Any] = np.empty(shape, dtype)
        else:
            try:
                with tempfile.TemporaryFile() as file:
                    # allocate its blocks: a full disk is an error only here
                    if hasattr(os, "posix_fallocate"):
                        os.posix_fallocate(file.fileno(), 0, size)
                    while (lacking := size - file.seek(0, os.SEEK_END)) > 0:
                        file.write(ZEROS[:lacking])
                    made = np.memmap(file, dtype, "r+", shape=shape)
            except OSError as error:
                raise OutputError(f"no room for {size / 1e9:.3g} GB of samples in "
                                  f"{tempfile.gettempdir()}: {error.strerror or error}",
                                  code="out-of-memory") from None
        if old is not None:
            made[:len(old)] = old
            self.left += 0 if isinstance(old, np.memmap) else old.nbytes
        return made


class Rows:
    """Arrays that grow by rows, sorted by the first ``by`` arrays; ``count`` of them are used."""

    def __init__(
        self, room: Room, size: Mapping[str, int], keys: Iterable[str], *,
        planned: int = FIRST_ROWS, by: int = 3,
    ) -> None:
        self._columns: Arrays = {
            key: room.array((planned, *layout.shape_of(key, size)[1:]), layout.dtype_of(key))
            for key in keys}
        self.count, self._room, self._by = 0, room, by

    @property
    def bytes(self) -> int:
        """Bytes of all rows."""
        return sum(column[:self.count].nbytes for column in self._columns.values())

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays`` be the last rows, the first of them number ``first`` <= ``count``."""
        end = first
        for key, column in self._columns.items():
            end = first + len(arrays[key])
            if end > len(column):
                column = self._columns[key] = self._room.array(
                    (max(end, 2 * len(column)), *column.shape[1:]), column.dtype, column)
            column[first:end] = arrays[key]
        self.count = end

    def append(self, *values: NDArray[Any]) -> None:
        """Add rows, the values of all arrays in their order, not below those that are there."""
        order = np.lexsort(values[self._by - 1::-1])
        if (np.diff(order) < 0).any():
            values = tuple(column[order] for column in values)
        self.put(self.count, dict(zip(self._columns, values, strict=True)))

    def replace(self, sample: int, *values: NDArray[Any]) -> None:
        """Put rows, given as to :meth:`append`, in the place of those from ``sample`` on."""
        self.count = self.before(sample)
        self.append(*values)

    def before(self, sample: int) -> int:
        """Number of rows before those of a sample."""
        samples = next(iter(self._columns.values()))[:self.count]
        return int(np.searchsorted(samples, sample))

    def finished(self, count: int, copies: Room | None = None) -> Arrays:
        """The first rows; with ``copies`` copied into that room, in memory or in files as here."""
        found = {key: column[:count] for key, column in self._columns.items()}
        return found if copies is None else {
            key: copies.array(rows.shape, rows.dtype, rows) for key, rows in found.items()}


class RecordingBuilder:
    """Room for the samples of a run, above :data:`MEMORY` bytes in temporary files.

    ``statics`` are the arrays that do not change; ``apart``: samples are several steps apart.
    """

    def __init__(
        self, mechanism: Mechanism, samples: int, statics: Mapping[str, NDArray[Any]], *,
        apart: bool = False, model: Model | None = None,
    ) -> None:
        self.mechanism, self._model, self.apart = mechanism, model, apart
        self.statics: Arrays = {key: np.array(statics[key], dtype=float) for key in layout.STATIC}
        fits = samples * layout.row_bytes(mechanism, layout.PER_SAMPLE) <= MEMORY
        self._room = Room(MEMORY if fits else 0)
        size = layout.sizes(mechanism, n=0)
        self.samples = Rows(self._room, size, [key for key in layout.PER_SAMPLE if key != TIME],
                            planned=samples)
        if not fits:
            self._room.left = MEMORY
        self.contacts, self.impacts = (
            Rows(self._room, size, keys) for keys in (layout.CONTACT, layout.IMPACT))
        self.means, self.mean_contacts = (
            Rows(self._room, size, keys, by=1) for keys in (layout.MEAN, layout.MEAN_CONTACT))

    @property
    def recorded_bytes(self) -> int:
        """Bytes of what was recorded so far, contact rows and impacts included."""
        return 8 * self.samples.count + sum(rows.bytes for rows in (
            self.samples, self.contacts, self.means, self.mean_contacts, self.impacts))

    def blank(self, samples: int) -> Arrays:
        """Every array that :meth:`put` takes, for so many samples, filled with nan."""
        size = layout.sizes(self.mechanism, n=samples)
        return {key: np.full(layout.shape_of(key, size), np.nan)
                for key in layout.PER_SAMPLE if key != TIME}

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays``, as :meth:`blank` gives them, be the samples from number ``first`` on."""
        self.samples.put(first, arrays)

    def finish(self, time: Array, info: Outcome, *, copied: bool = False) -> Recording:
        """The recording at these first instants [s]; it shares this memory unless ``copied``."""
        copies, n = Room(math.inf) if copied else None, len(time)
        arrays = {TIME: np.array(time), **self.statics, **self.samples.finished(n, copies),
                  **self.impacts.finished(self.impacts.count, copies)}
        for rows in (self.contacts, *((self.means, self.mean_contacts) if self.apart else ())):
            arrays |= rows.finished(rows.before(n), copies)
        return Recording(self.mechanism, arrays, info, model=self._model)


class Latest(RecordingBuilder):
    """A builder that holds what :meth:`put` was given last; ``first`` is its first sample."""

    first = 0

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays`` be all samples that there are, the first of them number ``first``."""
        super().put(0, arrays)
        self.first, self.contacts.count, self.impacts.count = first, 0, 0

    def arrays(self, time: Array) -> Arrays:
        """All arrays of a recording at these instants [s]; they share the memory."""
        rows = self.contacts.finished(self.contacts.count)
        rows["contact_sample"] = rows["contact_sample"] - self.first
        return {TIME: time, **self.samples.finished(self.samples.count), **rows, **self.statics}
