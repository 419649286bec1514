"""Collecting a recording while it is simulated.

The number of samples is known beforehand, so every array has its final place
from the start and the engine writes rows into it; nothing is held twice. A
recording that would not fit a memory budget lives in files of a temporary
directory instead, mapped into memory and removed with the recording.
"""

from __future__ import annotations

import math
import os
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.errors import OutputError
from sandbox.kinds.arrays import (
    CONTACT,
    PER_SAMPLE,
    STATIC,
    Arrays,
    dtype_of,
    shape_of,
    sizes,
)
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
from sandbox.recording.recording import Recording
from sandbox.samples.outcome import Outcome
from sandbox.scene.mechanism import Mechanism

MEMORY = 1 << 30
"""Bytes of samples that are kept in memory before files are used."""
FIRST_ROWS = 1024


class Scratch:
    """A temporary directory of array files, removed when nothing refers to it any more."""

    def __init__(self, directory: str | os.PathLike[str] | None = None) -> None:
        try:
            self.path = Path(tempfile.mkdtemp(prefix="sandbox-", dir=directory))
        except OSError as error:
            raise OutputError(f"cannot make a temporary directory: {error.strerror}") from None
        self.remove = weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)
        self._made = 0

    def array(self, shape: tuple[int, ...], dtype: type[Any]) -> NDArray[Any]:
        """An array in a file of its own.

        Raises:
            OutputError: no room for it. (Room is taken here: a mapped file that
                cannot grow would end the whole process later.)
        """
        size = math.prod(shape) * np.dtype(dtype).itemsize
        path = self.path / f"{self._made}.bin"
        self._made += 1
        try:
            with path.open("wb") as file:
                if hasattr(os, "posix_fallocate"):
                    os.posix_fallocate(file.fileno(), 0, size)
                else:
                    file.truncate(size)
        except OSError as error:
            raise OutputError(
                f"no room for {size / 1e9:.3g} GB of samples in {self.path}: {error.strerror}"
            ) from None
        return np.memmap(path, dtype=dtype, mode="r+", shape=shape)


class _Storage:
    """Hands out arrays in memory until the budget is spent, then in files."""

    def __init__(self, memory: float, directory: str | os.PathLike[str] | None) -> None:
        self.left, self.directory = memory, directory
        self.scratch: Scratch | None = None

    def array(self, shape: tuple[int, ...], dtype: type[Any]) -> NDArray[Any]:
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if size <= self.left:
            self.left -= size
            return np.empty(shape, dtype)
        self.scratch = self.scratch or Scratch(self.directory)
        return self.scratch.array(shape, dtype)

    def give_back(self, array: NDArray[Any]) -> None:
        if not isinstance(array, np.memmap):
            self.left += array.nbytes


class ContactRows:
    """Contact rows in the making; room doubles when it runs out.

    ``columns`` are the arrays, ``count`` the rows in use; a kernel may write
    rows itself after :meth:`reserve` and then raise ``count``.
    """

    def __init__(self, storage: _Storage) -> None:
        self.count = 0
        self._storage = storage
        self._room = 0
        self.columns: Arrays = {}
        self.reserve(FIRST_ROWS)

    def reserve(self, rows: int) -> None:
        """Make room for ``rows`` more; ``columns`` may be new arrays afterwards."""
        if self.count + rows <= self._room:
            return
        self._room = max(self.count + rows, 2 * self._room)
        size = {"m": self._room}
        for key in CONTACT:
            grown = self._storage.array(shape_of(key, size), dtype_of(key))
            if key in self.columns:
                old = self.columns[key]
                grown[:self.count] = old[:self.count]
                self._storage.give_back(old)
            self.columns[key] = grown
        (self._sample, self._body, self._other, self._point, self._force, self._normal,
         self._gap, self._merged) = (self.columns[key] for key in CONTACT)

    def append(
        self, sample: int | Integers, body: Integers, other: Integers, point: Array, force: Array,
        normal: Array, gap: Array, merged: Array,
    ) -> None:
        """Add touching pairs: shapes [r], [r], [r, 2], [r, 2], [r, 2], [r], [r].

        They are those of one sample, or ``sample`` tells each row's own, shape [r].
        """
        start = self.count
        end = start + len(body)
        if end > self._room:
            self.reserve(end - start)
        self._sample[start:end] = sample
        self._body[start:end] = body
        self._other[start:end] = other
        self._point[start:end] = point
        self._force[start:end] = force
        self._normal[start:end] = normal
        self._gap[start:end] = gap
        self._merged[start:end] = merged
        self.count = end

    def replace(self, first: int, **rows: Any) -> None:
        """Put rows, given as to :meth:`append`, in the place of those from sample ``first`` on."""
        self.count = int(np.searchsorted(self._sample[:self.count], first))
        self.append(**rows)

    def finished(self) -> Arrays:
        """The rows, in order of (sample, body, other)."""
        columns = {key: array[:self.count] for key, array in self.columns.items()}
        keys = columns["contact_other"], columns["contact_body"], columns["contact_sample"]
        if not _in_order(keys):
            order = np.lexsort(keys)
            for key in columns:
                columns[key] = columns[key][order]
        return columns


class RecordingBuilder:
    """Room for the samples of a run; ``finish`` makes the :class:`Recording`.

    ``arrays`` holds every array that has a row per sample, at its final size
    and filled with nan, for the engine to write into; ``contacts`` takes the
    contact rows. ``statics`` are the arrays that do not change (body masses,
    centres and inertias, tendon lengths). ``model`` is the mechanism's, if the
    recording shall not compile its own. Above ``memory`` bytes, files in
    ``directory`` (the system's temporary one) are used.

    Raises:
        OutputError: there is no room for the files.
    """

    def __init__(
        self, mechanism: Mechanism, samples: int, statics: Mapping[str, NDArray[Any]], *,
        model: Model | None = None, memory: float = MEMORY,
        directory: str | os.PathLike[str] | None = None,
    ) -> None:
        self.mechanism, self.samples, self._model = mechanism, samples, model
        self.statics: Arrays = {key: np.array(statics[key], dtype=float) for key in STATIC}
        self._storage = _Storage(memory, directory)
        size = sizes(mechanism, samples=samples)
        self.arrays: Arrays = {
            key: self._storage.array(shape_of(key, size), np.float64) for key in PER_SAMPLE}
        for array in self.arrays.values():
            array.fill(np.nan)
        self.contacts = ContactRows(self._storage)

    def finish(self, samples: int, info: Outcome, *, copied: bool = False) -> Recording:
        """The recording of the first ``samples`` samples; contact rows beyond are dropped.

        It shares this memory unless it is ``copied``, as it has to be if more is to be written.
        """
        arrays = {key: array[:samples] for key, array in self.arrays.items()}
        contacts = self.contacts.finished()
        rows = int(np.searchsorted(contacts["contact_sample"], samples))
        arrays |= {key: array[:rows] for key, array in contacts.items()}
        if copied:
            arrays = {key: array.copy() for key, array in arrays.items()}
        return Recording(self.mechanism, {**arrays, **self.statics}, info, model=self._model,
                         scratch=None if copied else self._storage.scratch)


def _in_order(keys: tuple[Integers, ...]) -> bool:
    """Whether rows are in lexical order of the keys, the last key counting most."""
    later = np.zeros(max(len(keys[0]) - 1, 0), dtype=bool)
    for key in keys:
        step = np.diff(key)
        later = (step > 0) | ((step == 0) & later) if key is not keys[0] else step >= 0
    return bool(np.all(later))
