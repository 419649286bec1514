"""The command line: the only package that prints.

Every command is thin: it reads its options, calls the same public functions
that a script would, and tells what came of it. Modules here import nothing
heavy at the top, so that ``sandbox --version`` and completion answer at once.
"""

from __future__ import annotations

import gc
import os
import sys
import warnings
from collections.abc import Sequence

from sandbox.cli.interrupts import leave, take_over

__all__ = ["main"]

SELDOM = (100_000, 50, 100)
"""How often the collector looks for rings of objects: importing and compiling make hundreds of
thousands that all stay, and by default each batch of 700 is looked through."""


def main(argv: Sequence[str] | None = None) -> None:
    """Run a command of ``argv`` (by default the process's own) and exit with its code.

    The collector is set for a process that ends with its command: rarely asked, and at the end
    not at all, since the system takes all memory back. Warnings of libraries, which are no lines
    of a command's, are off unless ``SANDBOX_DEBUG`` is set. A program that calls this and goes
    on has to undo these (``gc.set_threshold``, ``gc.unfreeze``, ``warnings.resetwarnings``).
    Ctrl-C is taken over (:mod:`sandbox.cli.interrupts`).
    """
    gc.set_threshold(*SELDOM)
    if not os.environ.get("SANDBOX_DEBUG"):
        warnings.simplefilter("ignore")
    take_over()
    try:
        from sandbox.cli.entry import invoke

        code = int(invoke(sys.argv[1:] if argv is None else argv))
    except KeyboardInterrupt:  # so early that there is nothing to tell
        code = 130
    if code == 130:
        leave(code)
    gc.freeze()
    sys.exit(code)
