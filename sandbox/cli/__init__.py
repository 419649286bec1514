"""The command line: the only package that prints.

Each command reads its options, calls the public functions that a script would call, and prints
the results. ``sandbox --version`` and shell completion import nothing heavy.
"""

from __future__ import annotations

import atexit
import contextlib
import gc
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from types import FrameType

__all__ = ["main"]

RETRY = 0.02  # seconds until a Ctrl-C that came during an import is handled again


def main(argv: Sequence[str] | None = None) -> None:
    """Run a command of ``argv`` (by default the process's own) and exit with its code.

    Garbage collection is rare: importing and compiling make hundreds of thousands of objects that
    stay. Warnings of libraries are off unless ``SANDBOX_DEBUG`` is set.
    """
    gc.set_threshold(100_000, 50, 100)
    if not os.environ.get("SANDBOX_DEBUG"):
        warnings.simplefilter("ignore")
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _interrupt)
    try:
        from sandbox.cli.commands import invoke
        code = int(invoke(sys.argv[1:] if argv is None else argv))
    except KeyboardInterrupt:  # before the command began
        code = 130
    if code == 130:  # after an interrupt within ``exec``, sys.exit would end by the signal
        atexit._run_exitfuncs()
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError, AttributeError):  # full, closed, missing
                stream.flush()
        os._exit(code)
    gc.freeze()
    sys.exit(code)


def _interrupt(_number: int, frame: FrameType | None) -> None:
    """Handle Ctrl-C, but not in the middle of an import or of :func:`_retry`.

    Modules that are being imported may turn a ``KeyboardInterrupt`` into another error
    (extensions report an ``ImportError``), and finalizers lose it with a traceback.
    """
    while frame is not None:
        code = frame.f_code
        if code.co_filename.startswith("<frozen importlib") or code is _retry.__code__:
            _retry()
            return
        frame = frame.f_back
    sys.unraisablehook = lambda lost: (  # a finalizer lost it; its other errors are ignored
        _retry() if lost.exc_type is KeyboardInterrupt else None)
    raise KeyboardInterrupt


def _retry() -> None:
    import _thread
    import threading
    timer = threading.Timer(RETRY, _thread.interrupt_main)
    timer.daemon = True
    timer.start()
