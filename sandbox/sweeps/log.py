"""What is done of a sweep, on the disk: a line for each finished run, and never rewritten.

A line is written in one piece when its run is finished, so a process that is killed loses the
runs that were under way and nothing else; a line that a machine's end cut off is taken away. Lines
are in files of :data:`LINES` each: a million runs are a hundred files of some megabytes.
"""

from __future__ import annotations

import contextlib
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from sandbox.atomic_files import locked, output_errors
from sandbox.errors import OutputError
from sandbox.sweeps.job import SweepRow, read_row, row_data

LINES = 10_000
"""Of one file."""
FOLDER = "rows"
FLUSHED = 1.0
"""Seconds after which lines are on the disk, whatever becomes of the machine."""


class Log:
    """The finished runs of a directory, as a context in which nobody else adds to them.

    Args:
        directory: of the sweep.

    Raises:
        OutputError: it cannot be written, another process adds to it, or a line in it is no row.
    """

    def __init__(self, directory: Path) -> None:
        self.folder = directory / FOLDER
        self._held = contextlib.ExitStack()
        self._file: IO[bytes] | None = None
        self._lines = 0
        self._flushed = 0.0

    def __enter__(self) -> Log:
        with output_errors(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            mark = self.folder / ".lock"
            mark.touch()
            if self._held.enter_context(locked(mark)) is False:
                raise OutputError(f"{self.folder.parent}: another process is at these runs",
                                  code="runs-in-use")
        return self

    def __exit__(self, *_: object) -> None:
        self._close()
        self._held.close()

    def rows(self) -> Iterator[SweepRow]:
        """The rows so far; what is left of a line that was cut off is taken away first."""
        return rows_in(self.folder)

    def clear(self) -> None:
        """Take away all rows."""
        self._close()
        with output_errors(self.folder):
            for path in files_in(self.folder):
                path.unlink()

    def add(self, row: SweepRow) -> None:
        """Add a finished run."""
        with output_errors(self.folder):
            if self._file is None:
                self._open()
            assert self._file is not None
            self._file.write(json.dumps(row_data(row), allow_nan=False).encode() + b"\n")
            self._lines += 1
            if (now := time.monotonic()) - self._flushed > FLUSHED:
                self._flushed = now
                os.fsync(self._file.fileno())
            if self._lines >= LINES:
                self._close()

    def _open(self) -> None:
        files = files_in(self.folder)
        path = files[-1] if files else self.folder / "00000.jsonl"
        if files:
            _mend(path)
            self._lines = path.read_bytes().count(b"\n")
            if self._lines >= LINES:
                path = self.folder / f"{int(path.stem) + 1:05d}.jsonl"
                self._lines = 0
        self._file = path.open("ab", buffering=0)

    def _close(self) -> None:
        if self._file is not None:
            with contextlib.suppress(OSError):
                os.fsync(self._file.fileno())
            self._file.close()
        self._file, self._lines = None, 0


def files_in(folder: Path) -> list[Path]:
    """The files of rows, in their order."""
    return sorted(path for path in folder.glob("*.jsonl") if path.stem.isdigit())


def rows_in(folder: Path) -> Iterator[SweepRow]:
    """The rows of a folder, in the order in which they were finished.

    Raises:
        OutputError: it cannot be read, or a line that is whole is no row.
    """
    for path in files_in(folder):
        with output_errors(path), path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if not line.endswith(b"\n"):
                    break  # being written, or cut off
                try:
                    row = read_row(json.loads(line))
                except (KeyError, TypeError, ValueError, AttributeError):
                    raise OutputError(f"{path}:{number}: this line is no row of a sweep; take it "
                                      "away, and its run is done again",
                                      code="run-damaged") from None
                yield row


def _mend(path: Path) -> None:
    """Take away what is left of a line that was cut off."""
    content = path.read_bytes()
    if content and not content.endswith(b"\n"):
        with path.open("r+b") as file:
            file.truncate(content.rfind(b"\n") + 1)
