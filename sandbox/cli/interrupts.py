"""Ctrl-C that comes out whole: not in the middle of an import, and told once.

What a ``KeyboardInterrupt`` is raised in may turn it into something else. Modules that are being
loaded do (extensions report an ``ImportError``), and finalizers lose it with a traceback.
"""

from __future__ import annotations

import atexit
import contextlib
import os
import signal
import sys
from collections.abc import Iterator
from pathlib import Path
from types import FrameType
from typing import TYPE_CHECKING, NoReturn

if TYPE_CHECKING:
    from sys import UnraisableHookArgs

    from sandbox.cli.console import Console

AGAIN = 0.02
"""Seconds after which a Ctrl-C that came in an import is looked at again."""


def take_over() -> None:
    """Let this process be interrupted so, unless it was started to ignore Ctrl-C."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, _pressed)


@contextlib.contextmanager
def told_how_to_go_on(folder: Path, console: Console) -> Iterator[None]:
    """Say at Ctrl-C that runs are kept, of what does many and goes on where it was stopped."""
    try:
        yield
    except KeyboardInterrupt:
        console.warn(f"stopped; all runs that were finished are in {folder}, and the same command "
                     "goes on with the others")
        raise


def leave(code: int) -> NoReturn:
    """End an interrupted process with ``code``.

    Python itself would end by the signal, whatever the code, if the interrupt once passed
    through an ``exec`` of a text, as dataclasses and compilers have them.
    """
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):  # full, closed, not there
            stream.flush()
    os._exit(code)


def _pressed(_number: int, frame: FrameType | None) -> None:
    if _importing(frame):
        _again()
        return
    sys.unraisablehook = _unraisable
    raise KeyboardInterrupt


def _importing(frame: FrameType | None) -> bool:
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            return True
        frame = frame.f_back
    return False


def _again() -> None:
    import _thread
    import threading

    timer = threading.Timer(AGAIN, _thread.interrupt_main)
    timer.daemon = True
    timer.start()


def _unraisable(lost: UnraisableHookArgs, /) -> None:
    """Nothing that an interrupt leaves half made is worth a word; one that is lost comes again."""
    if lost.exc_type is KeyboardInterrupt:
        _again()
