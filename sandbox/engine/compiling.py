"""A word to whoever waits, when the inner loop is really compiled: it takes long, and happens once.

Numba announces a compilation, and announces none when it finds in its cache what it compiled
before. Its events are documented but not promised to stay: without them nothing is said.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def on_compiling(tell: Callable[[], None]) -> Iterator[None]:
    """While the context lasts, call ``tell`` when the first function starts to be compiled."""
    try:
        from numba.core.event import Listener, install_listener
    except ImportError:
        yield
        return

    class Once(Listener):
        told = False

        def on_start(self, event: object) -> None:
            if not self.told:
                self.told = True
                tell()

        def on_end(self, event: object) -> None:
            pass

    with install_listener("numba:compile", Once()):
        yield
