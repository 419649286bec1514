"""Where words go: results to stdout, everything else to stderr.

What is printed may be a stranger's: a title, a reason, a file's name. The one way to the
terminal is by lines, and a line is one line (:func:`sandbox.wording.printable`): no word of a
scene can move the cursor, give the terminal a command or forge a line of its own.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import click

from sandbox.errors import OutputError
from sandbox.wording import printable


class StdoutError(OutputError):
    """Stdout cannot be written to: there is only stderr left to say so."""


@dataclass(frozen=True)
class Console:
    """Prints for one command.

    ``as_json`` keeps stdout for one JSON object; ``quiet`` leaves only results
    that were asked for, and errors.
    """

    as_json: bool = False
    quiet: bool = False

    @property
    def shows_progress(self) -> bool:
        """Whether a progress bar may be drawn: somebody is looking at stderr."""
        return not self.quiet and sys.stderr.isatty()

    def say(self, *lines: str) -> None:
        """Print lines for a person to stdout; nothing when quiet, to stderr with ``--json``."""
        if not self.quiet:
            _write(_lines(lines), to_stderr=self.as_json)

    def warn(self, *lines: str) -> None:
        """Print lines to stderr, unless quiet, or there are none."""
        if lines and not self.quiet:
            _write(_lines(lines), to_stderr=True)

    def result(self, *lines: str) -> None:
        """Print lines that the command was asked for to stdout."""
        _write(_lines(lines))

    def result_json(self, value: Any) -> None:
        """Print what the command was asked for to stdout, as JSON."""
        self.document(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))

    def document(self, text: str) -> None:
        """Print a whole file to stdout: JSON, or one that has only words of our own.

        What does not print, or not in this encoding, is escaped as JSON escapes it.
        """
        try:
            text.encode(getattr(sys.stdout, "encoding", None) or "utf-8")
        except UnicodeEncodeError:
            plain = str.isascii
        else:
            plain = str.isprintable
        _write("".join(char if plain(char) or char in "\n\t" else json.dumps(char)[1:-1]
                       for char in text))

    def error(self, *lines: str) -> None:
        """Print errors to stderr, however quiet."""
        _write(_lines(lines), to_stderr=True)


def _lines(lines: Sequence[str]) -> str:
    return "\n".join(printable(line) for line in lines)


def _write(text: str, *, to_stderr: bool = False) -> None:
    """Print; a reader that has gone away (``| head``) takes nothing from the work or its exit code.

    Nor does a stderr that cannot be written to, since there is nowhere left to say so.

    Raises:
        StdoutError: stdout goes to a file on a full disk.
    """
    stream = sys.stderr if to_stderr else sys.stdout
    encoding = getattr(stream, "encoding", None) or "utf-8"
    try:
        click.echo(text.encode(encoding, "backslashreplace").decode(encoding), err=to_stderr)
    except OSError as error:
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())  # or what is left in the buffer fails once more at exit
        os.close(nowhere)
        if not to_stderr and not isinstance(error, BrokenPipeError):
            raise StdoutError(f"cannot write to stdout: {error.strerror or error}") from None


def table(
    head: Sequence[str], rows: Sequence[Sequence[str]], *, right: str = "",
) -> list[str]:
    r"""Rows under their heads in columns two spaces apart; ``right`` marks columns with ``>``.

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
