"""The finished runs of a directory: one line of JSON each, appended and never rewritten.

A line is written at once when its run is finished. A process that is killed loses only the runs
that were under way; a line that was cut off is removed.
"""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from sandbox.atomic_files import locked, output_errors
from sandbox.errors import OutputError
from sandbox.sweeps.job import SweepRow

LINES_PER_FILE = 10_000
FOLDER = "rows"
FLUSH_INTERVAL = 1.0
"""Seconds after which lines are on the disk, even if the machine loses power."""


class Log:
    """The rows of a directory, as a context in which no other process adds to them.

    Args:
        directory: of the sweep.

    Raises:
        OutputError: the directory cannot be written, or is locked by another process.
    """

    def __init__(self, directory: Path) -> None:
        self.folder = directory / FOLDER
        self._stack = contextlib.ExitStack()
        self._file: IO[bytes] | None = None
        self._lines = 0
        self._flushed = 0.0

    def __enter__(self) -> Log:
        with output_errors(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
            mark = self.folder / ".lock"
            mark.touch()
            if self._stack.enter_context(locked(mark)) is False:
                raise OutputError(f"{self.folder.parent}: another process is at these runs",
                                  code="runs-in-use")
        return self

    def __exit__(self, *_: object) -> None:
        self._close()
        self._stack.close()

    def rows(self) -> Iterator[SweepRow]:
        """The rows so far, in the order in which they were finished."""
        return read_rows(self.folder)

    def clear(self) -> None:
        """Remove all rows."""
        self._close()
        with output_errors(self.folder):
            for path in row_files(self.folder):
                path.unlink()

    def add(self, row: SweepRow) -> None:
        """Append a finished run."""
        with output_errors(self.folder):
            file = self._file = self._file or self._open()
            file.write(row.to_json())
            self._lines += 1
            if (now := time.monotonic()) - self._flushed > FLUSH_INTERVAL:
                self._flushed = now
                os.fsync(file.fileno())
            if self._lines >= LINES_PER_FILE:
                self._close()

    def _open(self) -> IO[bytes]:
        files = row_files(self.folder)
        path = files[-1] if files else self.folder / "00000.jsonl"
        content = path.read_bytes() if files else b""
        if not content.endswith(b"\n"):  # remove a line that was cut off
            content = content[:content.rfind(b"\n") + 1]
            if files:
                os.truncate(path, len(content))
        self._lines = content.count(b"\n")
        if self._lines >= LINES_PER_FILE:
            path = self.folder / f"{int(path.stem) + 1:05d}.jsonl"
            self._lines = 0
        return path.open("ab", buffering=0)

    def _close(self) -> None:
        if self._file is not None:
            with contextlib.suppress(OSError):
                os.fsync(self._file.fileno())
            self._file.close()
        self._file, self._lines = None, 0


def row_files(folder: Path) -> list[Path]:
    """The files of rows, in their order."""
    return sorted(path for path in folder.glob("*.jsonl") if path.stem.isdigit())


def read_rows(folder: Path) -> Iterator[SweepRow]:
    """The rows of a folder, in the order in which they were finished.

    Raises:
        OutputError: a file cannot be read, or a complete line is no row.
    """
    for path in row_files(folder):
        with output_errors(path), path.open("rb") as file:
            for number, line in enumerate(file, start=1):
                if not line.endswith(b"\n"):
                    break  # being written, or cut off
                try:
                    row = SweepRow.from_json(line)
                except (KeyError, TypeError, ValueError, AttributeError):
                    raise OutputError(f"{path}:{number}: this line is no row of a sweep; take it "
                                      "away, and its run is done again",
                                      code="run-damaged") from None
                yield row
