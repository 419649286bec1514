"""Notices about the compilation of the engine, which takes seconds in the first run.

Nothing is reported if all code is in the cache. Worker processes report what they compile to the
process that started them, which passes it on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


class _Listener:
    """Callbacks for one compilation; ``ended`` is only called after ``began``."""

    def __init__(
        self, began: Callable[[], None], ended: Callable[[float], None],
        progress: Callable[[float], None],
    ) -> None:
        self._began, self._ended, self._progress = began, ended, progress
        self._active = self._over = False

    def begin(self) -> None:
        if not self._active and not self._over:
            self._active = True
            self._began()

    def advance(self, fraction: float) -> None:
        if self._active:
            self._progress(fraction)

    def end(self, seconds: float) -> None:
        if self._active:
            self._active, self._over = False, True
            self._ended(seconds)


_listeners: list[_Listener] = []
_worker_listeners: list[_Listener] = []


@contextmanager
def on_compiling(
    began: Callable[[], None], ended: Callable[[float], None],
    progress: Callable[[float], None] = lambda fraction: None, *, in_workers: bool = False,
) -> Iterator[None]:
    """Call back within this context when the engine is compiled.

    Args:
        began: called once, before anything is compiled.
        ended: called once with the seconds that it took.
        progress: called in between with the fraction done, 0 to 1.
        in_workers: listen to worker processes instead of this one.
    """
    listeners = _worker_listeners if in_workers else _listeners
    listener = _Listener(began, ended, progress)
    listeners.append(listener)
    try:
        yield
    finally:
        listeners.remove(listener)


def report_began() -> None:
    """Report that something is compiled."""
    for listener in _listeners:
        listener.begin()


def report_progress(fraction: float) -> None:
    """Report the fraction of the entry points that are ready, 0 to 1."""
    for listener in _listeners:
        listener.advance(fraction)


def report_compiled(seconds: float) -> None:
    """Report that the entry points are ready, compiled or loaded, and how long that took."""
    for listener in _listeners:
        listener.end(seconds)


def report_worker_compilation(seconds: float | None = None) -> None:
    """Report that a worker process compiles, or the seconds that it took."""
    for listener in _worker_listeners:
        listener.begin() if seconds is None else listener.end(seconds)
