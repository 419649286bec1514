"""What the command's exit codes mean."""

from __future__ import annotations

from enum import IntEnum


class Exit(IntEnum):
    """Exit codes of every ``sandbox`` command."""

    DONE = 0
    """Done, and every expectation held."""
    FAILED = 1
    """An expectation failed."""
    INPUT = 2
    """The input is wrong: a scene, an option, a file, a directory."""
    DIVERGED = 3
    """The simulation diverged."""
    BUG = 70
    """A fault of sandbox itself (EX_SOFTWARE of sysexits.h): none of the above."""
    INTERRUPTED = 130
    """Ctrl-C (128 + SIGINT)."""
