"""Rows of arrays in the making: in memory while there is room, then in files.

A run appends to its arrays and never looks back, so what does not fit a memory budget is
written to a file as it comes and mapped into memory when it is finished: however long a
run is, it holds no more than the budget and what is on its way.
"""

from __future__ import annotations

import contextlib
import math
import os
import tempfile
import weakref
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from sandbox.atomic_files import remove_stale, temporary_path
from sandbox.errors import OutputError

PIECE = 1 << 20
"""Bytes that are copied at a time."""


class Scratch:
    """A temporary directory of array files, removed when nothing refers to it any more.

    What killed processes left of theirs is removed when the next one is made.

    Raises:
        OutputError: it cannot be made.
    """

    def __init__(self, directory: str | os.PathLike[str] | None = None) -> None:
        held = contextlib.ExitStack()
        try:
            place = Path(directory or tempfile.gettempdir())
            remove_stale(place)
            self.path = temporary_path(place / "sandbox", held, directory=True)
        except OSError as error:
            raise OutputError(f"cannot make a temporary directory: {error.strerror}",
                              code="out-of-memory") from None
        self.remove = weakref.finalize(self, held.close)
        self._made = 0

    def file(self, size: int = 0) -> Path:
        """A new file with room for ``size`` bytes, which are zeros.

        Raises:
            OutputError: no room for it, told before anything is computed in vain.
        """
        self._made += 1
        try:
            path = self.path / f"{self._made}.bin"
            with path.open("wb") as file:
                if size and hasattr(os, "posix_fallocate"):
                    os.posix_fallocate(file.fileno(), 0, size)
        except OSError as error:
            raise self.full(size, error) from None
        return path

    def full(self, size: int, error: OSError) -> OutputError:
        """What to say where there is no room for ``size`` bytes more."""
        return OutputError(f"no room for {size / 1e9:.3g} GB of samples in {self.path}: "
                           f"{error.strerror or error}", code="out-of-memory")


class Budget:
    """So many bytes of memory for what is recorded, and a scratch directory for the rest."""

    def __init__(self, memory: float, directory: str | os.PathLike[str] | None = None) -> None:
        self._left, self._directory = memory, directory
        self.scratch: Scratch | None = None
        """Made when memory is spent."""

    def take(self, size: int) -> bool:
        """Whether there are ``size`` bytes of memory left, which are taken then."""
        if size > self._left:
            return False
        self._left -= size
        return True

    def give_back(self, size: int) -> None:
        """Memory that is no longer needed."""
        self._left += size

    def files(self) -> Scratch:
        """Where files go.

        Raises:
            OutputError: no directory can be made.
        """
        self.scratch = self.scratch or Scratch(self._directory)
        return self.scratch


class Growing:
    """An array that grows row by row.

    Args:
        budget: where it may be kept.
        shape: of a row.
        dtype: of its elements.
        planned: rows that will come, if that is known; there is room for them from the start.

    Raises:
        OutputError: there is no room for the planned rows.
    """

    def __init__(
        self, budget: Budget, shape: tuple[int, ...], dtype: type[Any], planned: int,
    ) -> None:
        self.count = 0
        """Rows that were put in."""
        self._budget, self._shape, self._dtype = budget, shape, np.dtype(dtype)
        self._row = math.prod(shape) * self._dtype.itemsize
        self._memory = np.empty((0, *shape), dtype)
        self._file: Path | None = None
        if budget.take(planned * self._row):
            self._memory = np.empty((planned, *shape), dtype)
        else:
            self._file = budget.files().file(planned * self._row)

    def put(self, first: int, values: NDArray[Any]) -> None:
        """Let ``values`` be the last rows, the first of them number ``first`` <= :attr:`count`.

        Raises:
            OutputError: the disk is full.
        """
        end = first + len(values)
        if self._file is None and end > len(self._memory):
            self._grow(end)
        if self._file is None:
            self._memory[first:end] = values
        else:
            self._write(self._file, first, values)
        self.count = end

    def _write(self, path: Path, first: int, values: NDArray[Any]) -> None:
        if not values.size:
            return
        try:
            with path.open("r+b", buffering=0) as file:
                file.seek(first * self._row)
                left = np.ascontiguousarray(values, self._dtype).data.cast("B")
                while left:
                    left = left[file.write(left):]
        except OSError as error:
            raise self._budget.files().full(values.nbytes, error) from None

    def _grow(self, rows: int) -> None:
        """Room for so many rows: twice the memory as long as there is some, then a file."""
        old, rows = self._memory, max(rows, 2 * len(self._memory))
        # the old is there until the new is whole: Ctrl-C may fall anywhere
        if self._budget.take(rows * self._row):
            grown = np.empty((rows, *self._shape), self._dtype)
            grown[:self.count] = old[:self.count]
            self._memory = grown
        else:
            file = self._budget.files().file()
            self._write(file, 0, old[:self.count])
            self._file, self._memory = file, old[:0].copy()
        self._budget.give_back(old.nbytes)

    def finished(self) -> NDArray[Any]:
        """The rows that were put in; those in a file cannot be written to.

        Raises:
            OutputError: the disk is full.
        """
        return self._memory[:self.count] if self._file is None else self._mapped(self._file)

    def copied(self, scratch: Scratch | None) -> NDArray[Any]:
        """The same, apart from what is put in later; what is in a file gets one in ``scratch``.

        Raises:
            OutputError: the disk is full.
        """
        if self._file is None or scratch is None:
            return self._memory[:self.count].copy()
        size, source = self.count * self._row, self._file
        copy = scratch.file(size)
        try:
            with source.open("rb") as one, copy.open("r+b") as other:
                for first in range(0, size, PIECE):
                    other.write(one.read(min(PIECE, size - first)))
        except OSError as error:
            raise scratch.full(size, error) from None
        return self._mapped(copy)

    def _mapped(self, path: Path) -> NDArray[Any]:
        shape = (self.count, *self._shape)
        try:
            return (np.memmap(path, self._dtype, "r", shape=shape) if math.prod(shape)
                    else np.empty(shape, self._dtype))
        except OSError as error:
            raise self._budget.files().full(self.count * self._row, error) from None
