"""A progress bar with the remaining time, for anything that takes over a second."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import TracebackType
from typing import Self

import click

PATIENCE = 1.0
"""Seconds before a bar appears."""
REFRESH = 0.1
"""Seconds between two drawings of the bar."""
EVERY = 30.0
"""Seconds between two lines of progress where no terminal shows a bar."""
WIDTH = 30
"""Of the bar, in characters."""


class Progress:
    """Call it with the fraction done, 0 to 1; use it as a context so that the line is cleared.

    Says nothing unless stderr is a terminal.
    """

    def __init__(
        self, label: str, *, shown: bool | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._label = label
        self._shown = sys.stderr.isatty() if shown is None else shown
        self._clock = clock
        self._began = clock()
        self._drawn = self._began + PATIENCE - REFRESH
        self._on_screen = 0

    def __call__(self, fraction: float) -> None:
        """Take note of the fraction done, and draw the bar if it is time."""
        now = self._clock()
        if not self._shown or now - self._drawn < REFRESH:
            return
        self._drawn = now
        line = self._line(min(max(fraction, 0.0), 1.0), now - self._began)
        self._on_screen = len(line)
        click.echo(f"\r{line}", err=True, nl=False)

    def _line(self, fraction: float, elapsed: float) -> str:
        filled = round(fraction * WIDTH)
        bar = "#" * filled + "-" * (WIDTH - filled)
        left = f"{clock_time(elapsed * (1 - fraction) / fraction)} left" if fraction > 0 else ""
        return f"{self._label:<9} [{bar}] {fraction:4.0%}  {left:<14}"

    def clear(self) -> None:
        """Remove the bar from the screen."""
        if self._on_screen:
            click.echo(f"\r{' ' * self._on_screen}\r", err=True, nl=False)
            self._on_screen = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.clear()


class NowAndThen:
    """When to say something of what has no known end.

    On a terminal after 1, 3, 7, … s, elsewhere every :data:`EVERY` seconds.
    """

    def __init__(self, *, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._began = clock, clock()
        self._every = PATIENCE if sys.stderr.isatty() else EVERY
        self._next = self._every

    @property
    def seconds(self) -> float:
        """Since it began."""
        return self._clock() - self._began

    def due(self) -> bool:
        """Whether it is time; asked once, it is not for a while."""
        if self.seconds < self._next:
            return False
        self._every = min(2 * self._every, EVERY)
        self._next = self.seconds + self._every
        return True


def clock_time(seconds: float) -> str:
    """A duration to read at a glance.

    >>> clock_time(7.4), clock_time(75), clock_time(3700)
    ('7 s', '1 min 15 s', '1 h 01 min')
    """
    whole = round(seconds)
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60} min {whole % 60:02d} s"
    return f"{whole // 3600} h {whole % 3600 // 60:02d} min"
