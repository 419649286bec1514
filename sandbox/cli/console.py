"""Output of the commands: results to stdout, notices, progress and errors to stderr.

Titles, reasons and file names may come from an untrusted scene. All output is printed line by
line, and :func:`sandbox.wording.printable` escapes control characters, so that a scene cannot
move the cursor or forge a line.
"""

from __future__ import annotations

import json
import os
import sys
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import click

from sandbox.errors import OutputError
from sandbox.wording import printable

if TYPE_CHECKING:
    from click._termui_impl import ProgressBar

BAR_AFTER = 1.0
"""Seconds before a progress bar appears."""
LINE_EVERY = 30.0
"""Longest time between two lines of progress [s]."""
COMPILE_TIME = "10 to 30 s"
"""Time that compiling takes; the docs quote it."""
COMPILING = f"Compiling the solver (first run only, {COMPILE_TIME}) …"
NOT_CACHED = (f"Compiling the solver ({COMPILE_TIME}) in every run, since neither the installation "
              "nor the user's cache is writable. Set NUMBA_CACHE_DIR to a writable folder.")


class StdoutError(OutputError):
    """Stdout cannot be written to. The error is reported on stderr, with ``--json`` too."""


@dataclass(frozen=True)
class Console:
    """Output of one command.

    ``as_json`` reserves stdout for one JSON object; ``quiet`` suppresses all but errors and
    requested results.
    """

    as_json: bool = False
    quiet: bool = False

    @property
    def shows_progress(self) -> bool:
        """Whether a progress bar may be drawn, because stderr is a terminal."""
        return not self.quiet and sys.stderr.isatty()

    def say(self, *lines: str) -> None:
        """Print lines to stdout; to stderr with ``--json``, nothing with ``--quiet``."""
        if not self.quiet:
            _write(_joined(lines), to_stderr=self.as_json)

    def warn(self, *lines: str) -> None:
        """Print lines to stderr, unless quiet."""
        if lines and not self.quiet:
            _write(_joined(lines), to_stderr=True)

    def result(self, *lines: str) -> None:
        """Print requested lines to stdout, even when quiet."""
        _write(_joined(lines))

    def result_json(self, value: Any) -> None:
        """Print the JSON object of a command to stdout."""
        self.document(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))

    def document(self, text: str) -> None:
        """Print a whole file to stdout; characters that cannot be printed are escaped."""
        try:
            text.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
        except UnicodeEncodeError:
            plain = str.isascii
        else:
            plain = str.isprintable
        _write("".join(char if plain(char) or char in "\n\t" else json.dumps(char)[1:-1]
                       for char in text))

    def error(self, *lines: str) -> None:
        """Print errors to stderr."""
        _write(_joined(lines), to_stderr=True)


def _joined(lines: Sequence[str]) -> str:
    return "\n".join(printable(line) for line in lines)


def _write(text: str, *, to_stderr: bool = False) -> None:
    """Print text. A closed pipe (``| head``) or an unwritable stderr is ignored.

    Raises:
        StdoutError: stdout goes to a file on a full disk.
    """
    stream = sys.stderr if to_stderr else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    try:
        click.echo(text.encode(encoding, "backslashreplace").decode(encoding), err=to_stderr)
    except OSError as error:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # or the buffer fails once more at exit
        os.close(nowhere)
        if not to_stderr and not isinstance(error, BrokenPipeError):
            raise StdoutError(f"cannot write to stdout: {error.strerror or error}") from None


def table(
    head: Sequence[str], rows: Sequence[Sequence[str]], *, right: str = "",
) -> list[str]:
    r"""Format rows as columns two spaces apart; ``right`` marks right-aligned columns by ``>``.

    >>> print(*table(["name", "N"], [["a", "1.5"], ["long", "10"]], right="<>"), sep="\n")
    name    N
    a     1.5
    long   10
    """
    lines = [[printable(cell) for cell in line] for line in (head, *rows)]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    sides = right.ljust(len(head), "<")
    return [
        "  ".join(f"{cell:{side}{width}}" for cell, side, width
                  in zip(line, sides, widths, strict=True)).rstrip()
        for line in lines
    ]


class Progress:
    """Progress bar on stderr that appears after a second; call it with the fraction done, 0 to 1.

    Use it as a context. Without a terminal nothing is drawn.
    """

    def __init__(self, label: str, *, shown: bool | None = None) -> None:
        self._label = label
        self._shown = sys.stderr.isatty() if shown is None else shown
        self._start = time.monotonic()
        self._bar: ProgressBar[int] | None = None

    def __call__(self, fraction: float) -> None:
        """Draw the bar at a fraction, with the remaining time."""
        if not self._shown or time.monotonic() - self._start < BAR_AFTER:
            return
        if self._bar is None:
            self._bar = click.progressbar(length=1000, label=self._label, file=sys.stderr)
            self._bar.render_progress()
        self._bar.update(round(1000 * min(max(fraction, 0.0), 1.0)) - self._bar.pos)

    def clear(self) -> None:
        """End the line of the bar."""
        if self._bar is not None:
            self._bar.render_finish()
            self._bar = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.clear()


class Heartbeat:
    """Schedule of progress lines for work of unknown length.

    On a terminal a line is due after 1, 3, 7, … s, elsewhere every :data:`LINE_EVERY` seconds.
    """

    def __init__(self) -> None:
        self._start = time.monotonic()
        self._interval = BAR_AFTER if sys.stderr.isatty() else LINE_EVERY
        self._next = self._interval

    @property
    def seconds(self) -> float:
        """Time since the start [s]."""
        return time.monotonic() - self._start

    def due(self) -> bool:
        """Whether a line is due; the next one is scheduled."""
        if self.seconds < self._next:
            return False
        self._interval = min(2 * self._interval, LINE_EVERY)
        self._next = self.seconds + self._interval
        return True


def format_duration(seconds: float) -> str:
    """Format a duration.

    >>> format_duration(7.4), format_duration(75), format_duration(3700)
    ('7 s', '1 min 15 s', '1 h 01 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"


@contextmanager
def resume_notice(folder: Path, console: Console) -> Iterator[None]:
    """After Ctrl-C, print that finished runs are kept and the same command resumes."""
    try:
        yield
    except KeyboardInterrupt:
        console.warn(f"stopped; finished runs are kept in {folder}, and the same command resumes")
        raise


@contextmanager
def compilation_notices(console: Console) -> Iterator[None]:
    """Print a line before and after the solver is compiled, with a progress bar on a terminal."""
    from sandbox.engine.compiling import on_compiling

    with (worker_compilation_notices(console),
          Progress("Compiling", shown=console.shows_progress) as bar):
        def began() -> None:
            from sandbox.engine.advance import advance

            console.warn(COMPILING if advance.cached else NOT_CACHED)

        def ended(seconds: float) -> None:
            bar.clear()
            console.warn(_compiled(seconds))

        with on_compiling(began, ended, bar):
            yield


@contextmanager
def worker_compilation_notices(console: Console) -> Iterator[None]:
    """Print the same lines for worker processes, without loading the solver here."""
    from sandbox.engine.compiling import on_compiling

    with on_compiling(lambda: console.warn(COMPILING),
                      lambda seconds: console.warn(_compiled(seconds)), in_workers=True):
        yield


def _compiled(seconds: float) -> str:
    return f"Compiled in {seconds:.0f} s" if seconds >= 1 else f"Compiled in {seconds:.1g} s"
