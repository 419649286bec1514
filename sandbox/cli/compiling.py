"""Notices on stderr when the engine is compiled, as in the first run after an installation."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sandbox.cli.console import Console
from sandbox.cli.progress import Progress

TAKES = "about 10 seconds of one processor"
"""How long compiling takes; the docs say it in these words."""
COMPILING = f"compiling the engine for this kind of scene (first run only, {TAKES})"
NOT_CACHED = (f"compiling the engine ({TAKES}) in every run, since neither the installation nor "
              "the user's cache can be written to; set NUMBA_CACHE_DIR to a folder that can")


@contextmanager
def compilation_notices(console: Console) -> Iterator[None]:
    """Print a line when the engine is compiled in this context, and one at the end.

    On a terminal a progress bar stands between them. Nothing is printed when quiet.
    """
    from sandbox.engine.compiling import on_compiling

    with (worker_compilation_notices(console),
          Progress("compile", shown=console.shows_progress) as bar):
        def ended(seconds: float) -> None:
            bar.clear()
            _ended(console, seconds)

        with on_compiling(lambda: _began(console), ended, bar):
            yield


@contextmanager
def worker_compilation_notices(console: Console) -> Iterator[None]:
    """Print the same lines when worker processes compile, without loading the engine here."""
    from sandbox.engine.compiling import on_compiling

    with on_compiling(lambda: console.warn(COMPILING),
                      lambda seconds: _ended(console, seconds), in_workers=True):
        yield


def _began(console: Console) -> None:
    from sandbox.engine.advance import advance

    console.warn(COMPILING if advance.cached else NOT_CACHED)


def _ended(console: Console, seconds: float) -> None:
    console.warn(compiled_in(seconds))


def compiled_in(seconds: float) -> str:
    """The line when it is done.

    >>> compiled_in(11.7)
    'compiled in 12 s'
    """
    return f"compiled in {seconds:.0f} s" if seconds >= 1 else f"compiled in {seconds:.1g} s"
