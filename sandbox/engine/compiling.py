"""The number of processors, and notices about the compilation of the engine in the first run.

Nothing is reported if all code is in the cache. Worker processes report what they compile to the
process that started them, which passes it on.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass


def processors() -> int:
    """Processors that this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # not on every system
        return os.cpu_count() or 1


@dataclass
class _Listener:
    began: Callable[[], None]  # called once, before anything is compiled
    ended: Callable[[float], None]  # called once with the seconds that it took
    progress: Callable[[float], None]  # called in between with the fraction done, 0 to 1
    in_workers: bool
    active: bool = False
    over: bool = False


_listeners: list[_Listener] = []


@contextmanager
def on_compiling(
    began: Callable[[], None], ended: Callable[[float], None],
    progress: Callable[[float], None] = lambda fraction: None, *, in_workers: bool = False,
) -> Iterator[None]:
    """Call back in this context when this process, or a worker process, compiles the engine."""
    listener = _Listener(began, ended, progress, in_workers)
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def report_began(*, in_workers: bool = False) -> None:
    """Report that something is compiled."""
    for one in _listeners:
        if one.in_workers == in_workers and not (one.active or one.over):
            one.active = True
            one.began()


def report_progress(fraction: float) -> None:
    """Report the fraction of the entry points that are ready, 0 to 1."""
    for one in _listeners:
        if one.active and not one.in_workers:
            one.progress(fraction)


def report_compiled(seconds: float, *, in_workers: bool = False) -> None:
    """Report that the entry points are ready, compiled or loaded, and how long that took."""
    for one in _listeners:
        if one.in_workers == in_workers and one.active:
            one.active, one.over = False, True
            one.ended(seconds)
