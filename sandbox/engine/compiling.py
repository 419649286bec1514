"""A word to whoever waits, when the inner loop is really compiled: it takes long, and happens once.

Numba announces a compilation, and announces none when it finds in its cache what it compiled
before. Its events are documented but not promised to stay: without them nothing is said. What
worker processes compile they tell whoever started them, and this passes it on.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

LONG = 10.0
"""What takes longer [s] is the inner loop: all else that is compiled is small."""
_waiting: list[tuple[Callable[[], None], Callable[[float], None]]] = []
"""Who wants to know what other processes compile."""


@contextmanager
def on_compiling_elsewhere(
    began: Callable[[], None], ended: Callable[[float], None],
) -> Iterator[None]:
    """While the context lasts, tell when a worker process starts to compile, and the end.

    Args:
        began: called before anything is compiled.
        ended: called with the seconds that it took.
    """
    _waiting.append((began, ended))
    try:
        yield
    finally:
        _waiting.pop()


def compiling_elsewhere(seconds: float | None = None) -> None:
    """Pass on what a worker process says: that it compiles, or in how many seconds it did."""
    for began, ended in _waiting:
        began() if seconds is None else ended(seconds)


@contextmanager
def on_compiling(
    began: Callable[[], None], ended: Callable[[float], None], *,
    clock: Callable[[], float] = time.perf_counter,
) -> Iterator[None]:
    """While the context lasts, tell when the first function starts to be compiled, and the end.

    Args:
        began: called once, before anything is compiled.
        ended: called once with the seconds since then that went into compiling: when the inner
            loop is compiled, or else at the end of the context.
        clock: what the time is [s].
    """
    try:
        from numba.core.event import Listener, install_listener
    except ImportError:
        yield
        return

    class Once(Listener):
        depth = 0
        """Functions compile those that they call."""
        since = spent = 0.0
        told = over = False

        def on_start(self, event: object) -> None:
            if not self.told:
                self.told = True
                began()
            if not self.depth:
                self.since = clock()
            self.depth += 1

        def on_end(self, event: object) -> None:
            self.depth -= 1
            if self.depth:
                return
            took = clock() - self.since
            self.spent += took
            if took > LONG:
                self.close()

        def close(self) -> None:
            if self.told and not self.over:
                self.over = True
                ended(self.spent)

    once = Once()
    with install_listener("numba:compile", once):
        yield
    once.close()
