"""Notices about the compilation of the engine, which takes seconds in the first run.

Numba announces a compilation, and announces none when it finds the code in its cache. Its events
are documented but may change; without them nothing is reported. Worker processes report what they
compile to the process that started them, which passes it on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import NamedTuple


class _Elsewhere(NamedTuple):
    began: Callable[[], None]
    ended: Callable[[float], None]


class _Here(NamedTuple):
    progress: Callable[[float], None]
    ended: Callable[[float], None]


_elsewhere: list[_Elsewhere] = []
_here: list[_Here] = []


@contextmanager
def on_compiling_elsewhere(
    began: Callable[[], None], ended: Callable[[float], None],
) -> Iterator[None]:
    """While the context lasts, tell when a worker process starts to compile, and the end.

    Args:
        began: called before anything is compiled.
        ended: called with the seconds that it took.
    """
    _elsewhere.append(_Elsewhere(began, ended))
    try:
        yield
    finally:
        _elsewhere.pop()


def compiling_elsewhere(seconds: float | None = None) -> None:
    """Pass on that a worker process compiles, or in how many seconds it did."""
    for began, ended in _elsewhere:
        began() if seconds is None else ended(seconds)


def report_progress(fraction: float) -> None:
    """Report the share of the entry points that are ready, 0 to 1."""
    for listener in _here:
        listener.progress(fraction)


def report_compiled(seconds: float) -> None:
    """Report that the entry points are ready, compiled or loaded, and how long that took."""
    for listener in _here:
        listener.ended(seconds)


@contextmanager
def on_compiling(
    began: Callable[[], None], ended: Callable[[float], None],
    progress: Callable[[float], None] = lambda fraction: None,
) -> Iterator[None]:
    """While the context lasts, tell when the engine starts to be compiled, and the end.

    Args:
        began: called once, before anything is compiled.
        ended: called once with the seconds that it took.
        progress: called in between with the fraction done, 0 to 1.
    """
    try:
        from numba.core.event import Listener, install_listener
    except ImportError:
        yield
        return

    class Compilation(Listener):
        began = over = False

        def on_start(self, event: object) -> None:
            if not self.began:
                self.began = True
                began()

        def on_end(self, event: object) -> None:
            pass

        def advance(self, fraction: float) -> None:
            if self.began and not self.over:
                progress(fraction)

        def finish(self, seconds: float) -> None:
            if self.began and not self.over:
                self.over = True
                ended(seconds)

    listener = Compilation()
    _here.append(_Here(listener.advance, listener.finish))
    try:
        with install_listener("numba:compile", listener):
            yield
    finally:
        _here.pop()
