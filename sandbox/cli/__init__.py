"""The command line: the only package that prints.

Every command is thin: it reads its options, calls the same public functions
that a script would, and tells what came of it. Modules here import nothing
heavy at the top, so that ``sandbox --version`` and completion answer at once.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> None:
    """Run a command of ``argv`` (by default the process's own) and exit with its code."""
    try:
        from sandbox.cli.entry import invoke

        code = int(invoke(sys.argv[1:] if argv is None else argv))
    except KeyboardInterrupt:  # so early that there is nothing to tell
        code = 130
    sys.exit(code)
