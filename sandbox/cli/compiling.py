"""Two lines on stderr when the engine's inner loop is compiled, as in the first run ever."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sandbox.cli.console import Console

TAKES = "one to two minutes of one processor"
"""How long compiling takes; the pages say it in these words."""
COMPILING = f"compiling the inner loop: once for each installation, and it takes a while ({TAKES})"
NOT_KEPT = (f"compiling the inner loop ({TAKES}), as each run has to: neither the installation nor "
            "a cache of the user's can be written to; NUMBA_CACHE_DIR can name one that can")


@contextmanager
def told_if_compiling(console: Console) -> Iterator[None]:
    """Say when anything is compiled in this context, and when it is, terminal or not; not if quiet.

    So a log without a terminal has a line at once, and one with the seconds when it goes on.
    """
    from sandbox.engine.compiling import on_compiling

    with told_if_workers_compile(console), \
            on_compiling(lambda: _began(console), lambda seconds: _ended(console, seconds)):
        yield


@contextmanager
def told_if_workers_compile(console: Console) -> Iterator[None]:
    """The same of what worker processes do, without loading the engine here."""
    from sandbox.engine.compiling import on_compiling_elsewhere

    with on_compiling_elsewhere(lambda: _began(console), lambda seconds: _ended(console, seconds)):
        yield


def _began(console: Console) -> None:
    from sandbox.engine.advance import advance
    from sandbox.engine.kernel import can_keep

    console.warn(COMPILING if can_keep(advance) else NOT_KEPT)


def _ended(console: Console, seconds: float) -> None:
    console.warn(compiled_in(seconds))


def compiled_in(seconds: float) -> str:
    """The line when it is done.

    >>> compiled_in(61.7)
    'compiled in 62 s'
    """
    return f"compiled in {seconds:.0f} s" if seconds >= 1 else f"compiled in {seconds:.1g} s"
