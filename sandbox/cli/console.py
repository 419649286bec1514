"""Where words go: results to stdout, everything else to stderr."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import click


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

    def say(self, text: str) -> None:
        """Print a line for a person to stdout; nothing when quiet, to stderr with ``--json``."""
        if not self.quiet:
            _write(text, to_stderr=self.as_json)

    def warn(self, text: str) -> None:
        """Print a line to stderr, unless quiet."""
        if not self.quiet:
            _write(text, to_stderr=True)

    def result(self, text: str) -> None:
        """Print what the command was asked for to stdout."""
        _write(text)

    def result_json(self, value: Any) -> None:
        """Print what the command was asked for to stdout, as JSON."""
        _write(json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False))

    def error(self, text: str) -> None:
        """Print an error to stderr, however quiet."""
        _write(text, to_stderr=True)


def _write(text: str, *, to_stderr: bool = False) -> None:
    """Print; a reader that has gone away (``| head``) takes nothing from the work or its exit code.

    Raises:
        OSError: stdout goes to a file on a full disk.
    """
    try:
        click.echo(text, err=to_stderr)
    except BrokenPipeError:
        stream = sys.stderr if to_stderr else sys.stdout
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)


def table(head: Sequence[str], rows: Sequence[Sequence[str]], *, right: str = "") -> str:
    """Rows under their heads in columns two spaces apart; ``right`` marks columns with ``>``.

    >>> print(table(["name", "N"], [["a", "1.5"], ["long", "10"]], right="<>"))
    name    N
    a     1.5
    long   10
    """
    lines = [list(head), *[list(row) for row in rows]]
    widths = [max(len(line[i]) for line in lines) for i in range(len(head))]
    sides = right.ljust(len(head), "<")
    return "\n".join(
        "  ".join(f"{cell:{side}{width}}" for cell, side, width
                  in zip(line, sides, widths, strict=True)).rstrip()
        for line in lines
    )
