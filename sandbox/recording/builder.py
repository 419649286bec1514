"""Collecting a recording while it is simulated.

The engine gives its samples and contact rows in chunks, in order of time. Arrays that do not fit a
memory budget are mapped from files of a temporary directory, which is removed with the recording.
"""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import weakref
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.atomic_files import remove_stale, temporary_path
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
from sandbox.errors import OutputError
from sandbox.model.model import Model
from sandbox.numeric import Array, Integers
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
    """A budget of memory [bytes], and files for arrays beyond it.

    The files are in a temporary directory, which is removed with the last reference to the room.

    Raises:
        OutputError: there is no room for an array, or no directory can be made.
    """

    def __init__(self, memory: float, directory: str | os.PathLike[str] | None) -> None:
        self.left = memory
        self._directory, self._made = directory, 0
        self._path: Path | None = None

    def array(
        self, shape: tuple[int, ...], dtype: Any, old: NDArray[Any] | None = None,
    ) -> NDArray[Any]:
        """A new array, or a longer one in place of ``old`` that begins with its rows."""
        size = math.prod(shape) * np.dtype(dtype).itemsize
        if isinstance(old, np.memmap):
            return self._mapped(Path(str(old.filename)), shape, dtype, size)
        if size <= self.left:
            self.left -= size
            made: NDArray[Any] = np.empty(shape, dtype)
        else:
            self._made += 1
            made = self._mapped(self._folder() / f"{self._made}.bin", shape, dtype, size)
        if old is not None:
            made[:len(old)] = old
            self.left += old.nbytes
        return made

    def _mapped(
        self, path: Path, shape: tuple[int, ...], dtype: Any, size: int,
    ) -> NDArray[Any]:
        """An array in a file whose blocks are allocated, as a full disk is an error only here."""
        try:
            with path.open("ab") as file:
                if hasattr(os, "posix_fallocate"):
                    os.posix_fallocate(file.fileno(), 0, size)
                while (lacking := size - file.seek(0, os.SEEK_END)) > 0:
                    file.write(ZEROS[:lacking])
            return np.memmap(path, dtype, "r+", shape=shape)
        except OSError as error:
            raise OutputError(f"no room for {size / 1e9:.3g} GB of samples in {path.parent}: "
                              f"{error.strerror or error}", code="out-of-memory") from None

    def _folder(self) -> Path:
        """The directory; what killed processes left beside it is removed first."""
        if self._path is None:
            held = contextlib.ExitStack()
            try:
                place = Path(self._directory or tempfile.gettempdir())
                remove_stale(place)
                self._path = temporary_path(place / "sandbox", held, directory=True)
            except OSError as error:
                raise OutputError(f"cannot make a temporary directory: {error.strerror}",
                                  code="out-of-memory") from None
            weakref.finalize(self, held.close)
        return self._path


class Growing:
    """An array in a room that grows row by row.

    Args:
        room: where it is kept.
        shape: of a row.
        dtype: of its elements.
        planned: rows that there is room for from the start.
    """

    def __init__(self, room: Room, shape: tuple[int, ...], dtype: type[Any], planned: int) -> None:
        self.count = 0  # Rows that were put in
        self._room, self._rows = room, room.array((planned, *shape), dtype)

    def put(self, first: int, values: NDArray[Any]) -> None:
        """Let ``values`` be the last rows, the first of them number ``first`` <= :attr:`count`."""
        end, rows = first + len(values), self._rows
        if end > len(rows):
            self._rows = self._room.array(
                (max(end, 2 * len(rows)), *rows.shape[1:]), rows.dtype, rows)
        self._rows[first:end] = values
        self.count = end

    def finished(self, copies: Room | None = None) -> NDArray[Any]:
        """The rows that were put in; with ``copies`` copied into that room, as they are here."""
        rows = self._rows[:self.count]
        if copies is None:
            return rows
        copies.left = 0 if isinstance(rows, np.memmap) else rows.nbytes
        copy = copies.array(rows.shape, rows.dtype)
        copy[...] = rows
        return copy


class Rows:
    """Rows in the making of arrays that have one for each contact or impact; ``count`` of them.

    They are in order of the first array, or of the first three: (sample, body, other) or
    (time, body, other).
    """

    def __init__(
        self, room: Room, size: Mapping[str, int], keys: Iterable[str], by: int = 3,
    ) -> None:
        """``size`` has the lengths of all axes but the first, ``by`` is how many arrays sort."""
        self._columns = {key: Growing(room, shape_of(key, size)[1:], dtype_of(key), FIRST_ROWS)
                         for key in keys}
        self.count, self._by = 0, by

    @property
    def bytes(self) -> int:
        """Bytes of all rows."""
        return sum(column.finished().nbytes for column in self._columns.values())

    def append(self, *values: NDArray[Any]) -> None:
        """Add rows, the values of all arrays in their order.

        Those of the first array are not below those that are there.
        """
        if self._by > 1 and not _in_order(values[2::-1]):
            order = np.lexsort(values[2::-1])
            values = tuple(column[order] for column in values)
        for rows, column in zip(self._columns.values(), values, strict=True):
            rows.put(self.count, column)
        self.count += len(values[0])

    def replace(self, sample: int, *values: NDArray[Any]) -> None:
        """Put rows, given as to :meth:`append`, in the place of those from ``sample`` on."""
        self.count = self.before(sample)
        self.append(*values)

    def before(self, sample: int) -> int:
        """How many rows come before those of a sample."""
        samples = next(iter(self._columns.values())).finished()
        return int(np.searchsorted(samples, sample))

    def finished(self, copies: Room | None = None) -> Arrays:
        """All rows; see :class:`Growing`."""
        return {key: rows.finished(copies) for key, rows in self._columns.items()}


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
        self._room, self._directory = Room(memory if fits else 0, directory), directory
        size = sizes(mechanism, samples=0)
        self._rows = {key: Growing(self._room, shape_of(key, size)[1:], np.float64, samples)
                      for key in PER_SAMPLE if key != TIME}
        if not fits:
            self._room.left = memory
        self.apart = apart
        self.contacts, self.impacts = (Rows(self._room, size, keys) for keys in (CONTACT, IMPACT))
        self.means, self.mean_contacts = (
            Rows(self._room, size, keys, by=1) for keys in (MEAN, MEAN_CONTACT))

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
        ``copied``, which is required if more is written.

        Raises:
            OutputError: the disk is full.
        """
        copies = Room(0, self._directory) if copied else None
        arrays = {key: rows.finished(copies)[:len(time)] for key, rows in self._rows.items()}
        means = (self.means, self.mean_contacts) if self.apart else ()
        for rows in (self.contacts, *means):
            count = rows.before(len(time))
            arrays |= {key: array[:count] for key, array in rows.finished(copies).items()}
        arrays |= self.impacts.finished(copies)
        return Recording(self.mechanism, {TIME: np.array(time), **arrays, **self.statics}, info,
                         model=self._model, scratch=copies or self._room)


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
        self.contacts = _LatestRows(self._room, size, CONTACT)
        self.impacts = _LatestRows(self._room, size, IMPACT)
        self.first = self.count = 0

    def put(self, first: int, arrays: Mapping[str, NDArray[Any]]) -> None:
        """Let ``arrays`` be all samples that there are, the first of them number ``first``."""
        super().put(0, arrays)
        self.first, self.count = first, len(arrays["body_pose"])

    def arrays(self, time: Array) -> Arrays:
        """What there is, as a recording of it has it, at its instants [s]; it shares the memory."""
        return {TIME: time, **{key: rows.finished() for key, rows in self._rows.items()},
                **self.contacts.finished(), **self.statics}


class _LatestRows(Rows):
    """Contact rows whose samples are counted from the first that is held; no impacts."""

    def replace(self, sample: int, *values: NDArray[Any]) -> None:
        """Put rows in the place of all that there are."""
        self.count = 0
        super().append(values[0] - sample, *values[1:])

    def append(self, *values: NDArray[Any]) -> None:
        """Drop them."""
